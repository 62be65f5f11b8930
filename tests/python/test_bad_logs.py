"""Damaged, foreign and doubtful files of Slocums and SeaExplorers through the command, and a gigabyte of one glider."""

import gzip
import json
import resource
import subprocess

import log_files
import netCDF4
import numpy as np
import pytest
from conftest import long
from log_files import Dive
from test_pilot_logs import run


def values(log_values, *arguments):
    """Rows and messages; none of them ends the program."""
    done = subprocess.run([log_values, *map(str, arguments)], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return len(done.stdout.splitlines()) - 1, done.stderr


def seaexplorer(folder, dive, number=5, glider="sea035"):
    own, payload = folder / f"{glider}.12.gli.sub.{number}", folder / f"{glider}.12.pld1.raw.{number}"
    log_files.seaexplorer(own, payload, dive)
    return [own, payload]


def test_a_list_of_sensors_of_another_file_is_refused_and_named(glidepolar, log_values, tmp_path):
    log_files.slocum(tmp_path / "a.dbd", Dive(), factored=True)
    name = f"{log_files.slocum_crc(log_files.slocum_list())}.cac"
    without = run(glidepolar, "identify", tmp_path / "a.dbd", "--vehicle", "slocum-graver")
    assert without.returncode == 2 and name in without.stderr.lower() and "--cache" in without.stderr, without.stderr
    # The list of a file with more sensors, under this one's name.
    (tmp_path / name).write_bytes(log_files.slocum_list(more=3))
    wrong = run(glidepolar, "identify", tmp_path / "a.dbd", "--vehicle", "slocum-graver")
    assert wrong.returncode == 2 and name in wrong.stderr.lower() and "another" in wrong.stderr, wrong.stderr
    (tmp_path / "cac").mkdir()
    (tmp_path / "cac" / name).write_bytes(log_files.slocum_list())
    (tmp_path / name).unlink()
    rows, _ = values(log_values, "--cache", tmp_path / "cac", tmp_path / "a.dbd")
    # The first of 120 cycles is no reading.
    assert rows == 119


def test_a_binary_file_that_is_cut_off_or_damaged_keeps_what_is_sound(log_values, tmp_path):
    path = tmp_path / "a.dbd"
    cycle = log_files.slocum(path, Dive()).itemsize
    content = path.read_bytes()
    path.write_bytes(content[: -20 * cycle - 7])
    rows, said = values(log_values, path)
    assert rows == 98 and "a.dbd" in said and "cut off" in said, (rows, said)
    damaged = bytearray(content)
    at = len(content) - 1 - 60 * cycle
    damaged[at - 3 * cycle : at] = b"\x55" * (3 * cycle)
    path.write_bytes(damaged)
    rows, said = values(log_values, path)
    assert 115 <= rows <= 117 and "a.dbd" in said and "byte" in said, (rows, said)


@pytest.mark.parametrize("kind", ["slocum", "seaexplorer", "csv"])
def test_a_clock_that_jumps_back_loses_no_row_before_it(log_values, tmp_path, kind):
    dive = Dive()
    dive.values["time_s"] = dive["time_s"] - np.where(np.arange(dive.rows) >= 80, 200.0, 0.0)
    if kind == "slocum":
        log_files.slocum(tmp_path / "a.dbd", dive)
        paths = [tmp_path / "a.dbd"]
    elif kind == "seaexplorer":
        paths = seaexplorer(tmp_path, dive)
    else:
        columns = {name: (lambda row, name=name: dive[name][row]) for name in dive.values}
        log_files.cells(tmp_path / "log.csv", columns, dive.rows)
        paths = [tmp_path / "log.csv"]
    rows, _ = values(log_values, *paths)
    # Times that are there twice are one row.
    assert rows >= 80, rows


@pytest.mark.parametrize("maker", ["slocum", "seaexplorer"])
def test_files_of_two_gliders_of_a_maker_are_refused(glidepolar, tmp_path, maker):
    later = Dive(start_s=log_files.START_S + 5000)
    if maker == "slocum":
        for i, (glider, dive) in enumerate([("amadeus", Dive()), ("sebastian", later)]):
            log_files.slocum(tmp_path / f"{i}.dbd", dive, glider=glider)
        paths, names = sorted(tmp_path.glob("*.dbd")), ["amadeus", "sebastian"]
    else:
        paths = seaexplorer(tmp_path, Dive()) + seaexplorer(tmp_path, later, 6, "sea046")
        names = ["sea035", "sea046"]
    done = run(glidepolar, "identify", *paths, "--vehicle", "seaglider")
    assert done.returncode == 2, done.stderr
    said = done.stderr.lower()
    assert all(name in said for name in names) and "give the files of one glider" in said, done.stderr


def test_files_of_two_makers_are_refused(glidepolar, tmp_path):
    log_files.seaglider(tmp_path / "p1710001.nc", Dive())
    log_files.slocum(tmp_path / "a.dbd", Dive(start_s=log_files.START_S + 5000), glider="amadeus")
    done = run(glidepolar, "identify", tmp_path / "p1710001.nc", tmp_path / "a.dbd", "--vehicle", "seaglider")
    assert done.returncode == 2 and "SG171" in done.stderr and "amadeus" in done.stderr, done.stderr


def test_what_is_no_log_among_logs_costs_only_itself(log_values, tmp_path):
    log_files.seaglider(tmp_path / "p1710001.nc", Dive())
    (tmp_path / "notes.pdf").write_bytes(b"%PDF-1.4\n" + bytes(range(256)) * 4)
    rows, said = values(log_values, tmp_path / "p1710001.nc", tmp_path / "notes.pdf")
    assert rows == 120 and "left out" in said and "notes.pdf" in said, said


@pytest.mark.parametrize("kind", ["slocum", "seaexplorer"])
def test_one_file_behind_another_is_read_on_or_named(log_values, tmp_path, kind):
    later = Dive(start_s=log_files.START_S + 5000)
    if kind == "slocum":
        for i, dive in enumerate([Dive(), later]):
            log_files.slocum(tmp_path / f"{i}.dbd", dive, segment=i)
        joined = [tmp_path / "joined.dbd"]
        joined[0].write_bytes((tmp_path / "0.dbd").read_bytes() + (tmp_path / "1.dbd").read_bytes())
    else:
        pairs = [seaexplorer(tmp_path, Dive()), seaexplorer(tmp_path, later, 6)]
        (tmp_path / "joined").mkdir()
        joined = [tmp_path / "joined" / path.name for path in pairs[0]]
        for path, one, two in zip(joined, *pairs, strict=True):
            path.write_bytes(one.read_bytes() + two.read_bytes())
    rows, said = values(log_values, *joined)
    # The first cycle of a Slocum's file is no reading.
    assert rows == (238 if kind == "slocum" else 240), rows
    if kind == "slocum":
        assert f"byte {(tmp_path / '0.dbd').stat().st_size}" in said and "another file begins here" in said, said


@pytest.mark.parametrize("lacks", ["m_pitch", "m_ballast_pumped"])
def test_a_sensor_without_a_single_value_is_named(glidepolar, tmp_path, lacks):
    log_files.slocum(tmp_path / "a.dbd", Dive(rows=400), lacks=[lacks])
    done = run(glidepolar, "identify", tmp_path / "a.dbd", "--vehicle", "slocum-graver")
    channel = {"m_pitch": "pitch_rad", "m_ballast_pumped": "vbd_cc"}[lacks]
    assert done.returncode == 2 and "a.dbd" in done.stderr and channel in done.stderr, done.stderr


def test_without_a_ctd_the_density_is_asked_for(glidepolar, tmp_path):
    dives = []
    for i in range(4):
        dive = Dive(rows=400, start_s=log_files.START_S + 5000 * i)
        wave = 1 + 0.05 * np.sin(np.arange(dive.rows) / 9 + i)
        dive.values["pressure_dbar"] = dive["pressure_dbar"] * wave
        dives.append(tmp_path / f"{i}.dbd")
        log_files.slocum(dives[-1], dive, lacks=["sci_water_temp", "sci_water_cond"], segment=i)
    arguments = ["identify", *dives, "--vehicle", "slocum-graver"]
    without = run(glidepolar, *arguments)
    assert without.returncode == 2 and "--density" in without.stderr, without.stderr
    assert run(glidepolar, *arguments, "--density", 1025).returncode == 0


def seaexplorer_dives(folder, lacks=()):
    """Four dives of a SeaExplorer; of these channels every value is missing."""
    files = []
    for i in range(4):
        dive = Dive(rows=400, start_s=log_files.START_S + 5000 * i)
        dive.values["pressure_dbar"] = dive["pressure_dbar"] * (1 + 0.05 * np.sin(np.arange(dive.rows) / 9 + i))
        for name in lacks:
            dive.values[name] = np.full(dive.rows, np.nan)
        files.append(seaexplorer(folder, dive, 5 + i))
    return files


def test_a_seaexplorer_without_its_ctd_is_asked_for_the_density(glidepolar, tmp_path):
    """The payload computer was off, or its CTD was: pressure is then the depth of the glider's own computer."""
    files = seaexplorer_dives(tmp_path)
    for paths in ([own for own, _ in files], seaexplorer_flat(seaexplorer_dives(tmp_path, ["conductivity_S_m"]))):
        arguments = ["identify", *paths, "--vehicle", "seaexplorer"]
        without = run(glidepolar, *arguments)
        assert without.returncode == 2 and "--density" in without.stderr and "panic" not in without.stderr, without.stderr
        with_density = run(glidepolar, *arguments, "--density", 1025, "--json", "-")
        assert with_density.returncode == 0, with_density.stderr
        assert json.loads(with_density.stdout)["n_glides"] == 8


def seaexplorer_flat(files):
    return [path for pair in files for path in pair]


@pytest.mark.parametrize(("lacks", "channel"), [("pitch_deg", "pitch_rad"), ("vbd_cc", "vbd_cc")])
@pytest.mark.parametrize("kind", ["seaexplorer", "time series", "csv"])
def test_a_channel_that_is_all_missing_is_named(glidepolar, tmp_path, kind, lacks, channel):
    if kind == "seaexplorer":
        paths = seaexplorer_flat(seaexplorer_dives(tmp_path, [lacks]))
    else:
        dive = Dive(rows=400)
        dive.values[lacks] = np.full(dive.rows, np.nan)
        paths = [tmp_path / ("og1.nc" if kind == "time series" else "log.csv")]
        if kind == "csv":
            log_files.cells(paths[0], {name: (lambda row, name=name: dive[name][row]) for name in dive.values}, dive.rows)
        else:
            log_files.time_series(paths[0], dive)
    for command in ("identify", "diagnose"):
        done = run(glidepolar, command, *paths, "--vehicle", "seaexplorer")
        assert done.returncode == 2 and channel in done.stderr and paths[0].name in done.stderr, done.stderr


@pytest.mark.parametrize("share", [0.3, 0.6, 0.95])
@pytest.mark.parametrize("form", ["NETCDF4", "NETCDF3_CLASSIC"])
def test_netcdf_that_was_cut_off_is_called_damaged(glidepolar, tmp_path, form, share):
    """Not a file without a time: what is missing is its end."""
    path = tmp_path / "og1.nc"
    log_files.time_series(path, Dive(rows=2000), form=form)
    content = path.read_bytes()
    path.write_bytes(content[: int(share * len(content))])
    done = run(glidepolar, "identify", path, "--vehicle", "seaglider")
    assert done.returncode == 2 and "og1.nc" in done.stderr and "expected a variable" not in done.stderr, done.stderr
    assert "damaged" in done.stderr and "cut off" in done.stderr, done.stderr


@pytest.mark.parametrize("maker", ["seaglider", "og1"])
@pytest.mark.parametrize("form", ["NETCDF4", "NETCDF3_CLASSIC"])
def test_gzipped_netcdf_is_read_as_it_is_unpacked(log_values, tmp_path, maker, form):
    path = tmp_path / ("p1710001.nc" if maker == "seaglider" else "og1.nc")
    (log_files.seaglider if maker == "seaglider" else log_files.time_series)(path, Dive(), form=form)
    packed = path.with_name(path.name + ".gz")
    packed.write_bytes(gzip.compress(path.read_bytes()))
    printed = [subprocess.run([log_values, file], capture_output=True, text=True, check=True).stdout for file in (path, packed)]
    assert printed[0] == printed[1] and len(printed[0].splitlines()) > 100
    # The end of the packed file is missing.
    packed.write_bytes(packed.read_bytes()[:-200])
    done = subprocess.run([log_values, packed], capture_output=True, text=True, check=False)
    assert done.returncode == 2 and packed.name in done.stderr and "damaged" in done.stderr, done.stderr


@long
def test_a_gigabyte_of_one_file_passes_through_bounded_memory(glidepolar, tmp_path):
    """Half a year of a cycle in 5 s; a damage in the middle costs the cycles around it, the end is cut off."""
    # A few more than 8000, and what is kept of the samples has been halved just before the end: the fit is shorter.
    dive, repeats = Dive(rows=400), 8400
    one = {name: values.copy() for name, values in dive.values.items()}
    wave = 1 + 0.02 * np.sin(np.arange(dive.rows) / 9)
    one["pressure_dbar"] *= wave
    dive.values = one
    path = tmp_path / "long.dbd"
    cycle = log_files.slocum(path, dive, more=34)
    content = path.read_bytes()
    head, body = content[: -1 - dive.rows * cycle.itemsize], content[-1 - dive.rows * cycle.itemsize : -1]
    cycles = np.frombuffer(body, cycle).copy()
    with open(path, "wb") as file:
        file.write(head)
        for i in range(repeats):
            cycles["m_present_time"] = one["time_s"] + 2100.0 * i
            block = bytearray(cycles.tobytes())
            if i == repeats // 2:
                block[1000:5000] = b"\x55" * 4000
            file.write(block)
    size = path.stat().st_size
    with open(path, "r+b") as file:
        file.truncate(size - 100)
    assert size > 1e9
    done = run(glidepolar, "identify", path, "--vehicle", "slocum-graver")
    peak = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss * 1024
    assert done.returncode == 0, done.stderr
    assert "long.dbd: byte" in done.stderr and "long.dbd: cut off within a cycle" in done.stdout, (done.stdout, done.stderr)
    assert peak < 1e9, f"{peak / 1e6:.0f} MB"


@pytest.mark.parametrize(
    ("density", "hint"), [(1.0271, "--unit density_kg_m3=g/cm3"), (27.1, "--unit density_kg_m3=sigma")]
)
@pytest.mark.parametrize("command", ["identify", "diagnose"])
def test_a_density_in_another_unit_is_recognised_and_can_be_stated(glidepolar, tmp_path, command, density, hint):
    dive = Dive(rows=400)
    columns = {name: (lambda row, name=name: dive[name][row]) for name in ["time_s", "pressure_dbar", "pitch_deg", "vbd_cc"]}
    columns["density_kg_m3"] = lambda _: density
    log_files.cells(tmp_path / "log.csv", columns, dive.rows)
    done = run(glidepolar, command, tmp_path / "log.csv", "--vehicle", "seaglider")
    assert done.returncode == 2 and hint in done.stderr, done.stderr
    stated = run(glidepolar, command, tmp_path / "log.csv", "--vehicle", "seaglider", *hint.split())
    assert "unit of density" not in stated.stderr, stated.stderr


@pytest.mark.parametrize("command", ["identify", "diagnose"])
def test_rows_in_no_order_of_time_are_said_to_be(glidepolar, tmp_path, command):
    """Newest first, as a database may hand them out, and in any order."""
    dive = Dive(rows=400)
    random = np.random.default_rng(3)
    for name, order in [("newest", np.arange(400)[::-1]), ("mixed", random.permutation(400))]:
        columns = {
            column: (lambda row, column=column, order=order: dive[column][order[row]])
            for column in ["time_s", "pressure_dbar", "pitch_deg", "vbd_cc"]
        }
        columns["density_kg_m3"] = lambda _: 1025.0
        log_files.cells(tmp_path / f"{name}.csv", columns, dive.rows)
        done = run(glidepolar, command, tmp_path / f"{name}.csv", "--vehicle", "seaglider")
        assert done.returncode == 2 and "sort them by time" in done.stderr, done.stderr


def test_a_pitch_in_another_unit_than_it_says_is_stated_by_hand(log_values, tmp_path):
    """Radians that are labelled degrees, and the other way round; the column by its name in degrees."""
    dive = Dive()
    radians = {"of": lambda dive: dive["pitch_deg"] * log_files.RAD, "unit": "degrees"}
    log_files.time_series(tmp_path / "og1.nc", dive, {"PITCH": radians})
    for arguments in [["--unit", "pitch_rad=rad"], ["--column", "pitch_rad=PITCH", "--unit", "pitch_deg=rad"]]:
        done = subprocess.run(
            [log_values, *arguments, tmp_path / "og1.nc"], capture_output=True, text=True, check=False
        )
        assert done.returncode == 0, done.stderr
        header, *rows = done.stdout.splitlines()
        pitch = [float(row.split(",")[header.split(",").index("pitch_rad")]) for row in rows]
        assert np.abs(np.array(pitch) - dive["pitch_deg"] * log_files.RAD).max() < 1e-12


def test_files_one_behind_the_other_are_not_read_as_the_first(glidepolar, tmp_path):
    """Two dives joined by `cat`, of NetCDF and of CSV: said with the place at which to take them apart."""
    for i in range(2):
        dive = Dive(rows=400, start_s=log_files.START_S + 5000 * i)
        log_files.seaglider(tmp_path / f"{i}.nc", dive, number=i + 1, form="NETCDF4")
    one, other = ((tmp_path / f"{i}.nc").read_bytes() for i in range(2))
    (tmp_path / "joined.nc").write_bytes(one + other)
    (tmp_path / "joined.nc.gz").write_bytes(gzip.compress(one) + gzip.compress(other))
    for name in ["joined.nc", "joined.nc.gz"]:
        done = run(glidepolar, "track", tmp_path / name, "--vehicle", "seaglider")
        assert done.returncode == 2 and f"begins behind byte {len(one)}" in done.stderr, (name, done.stderr)
    table = "time_s,pressure_dbar,pitch_deg,vbd_cc\n1,2,-20,100\n2,3,-20,100\n"
    (tmp_path / "joined.csv").write_text(table + table, encoding="utf-8")
    done = run(glidepolar, "identify", tmp_path / "joined.csv", "--vehicle", "seaglider", "--density", "1027")
    assert done.returncode == 2 and "joined.csv:4:1" in done.stderr and "names again" in done.stderr, done.stderr


def test_housekeeping_stands_below_the_answer(glidepolar, tmp_path):
    """What was cleaned is no warning: a line below the table, and folded away on the page."""
    paths = []
    for i in range(4):
        dive = Dive(rows=400, start_s=log_files.START_S + 5000 * i)
        dive.values["pressure_dbar"] = dive["pressure_dbar"] * (1 + 0.05 * np.sin(np.arange(dive.rows) / 9 + i))
        dive.values["pitch_deg"][50] = 80.0
        paths.append(tmp_path / f"p171000{i + 1}.nc")
        log_files.seaglider(paths[-1], dive, number=i + 1)
    for command in ["identify", "diagnose"]:
        done = run(glidepolar, command, *paths, "--vehicle", "seaglider", "--out", tmp_path / command)
        assert done.returncode == 0, done.stderr
        lines = done.stdout.splitlines()
        first = next(i for i, line in enumerate(lines) if line.startswith("note: "))
        assert first > 5 and all(line.startswith("note: ") for line in lines[first:]), done.stdout
        assert "spikes" in done.stdout and "spikes" not in done.stderr, (done.stdout, done.stderr)
        page = (tmp_path / command / "report.html").read_text(encoding="utf-8")
        before, _, after = page.rpartition("Reading of the log")
        assert "spikes" in after and "spikes" not in before
        assert "<summary>" in before[-60:], before[-200:]


@pytest.mark.parametrize(
    ("name", "content", "hints"),
    [
        ("log.parquet", b"PAR1" + bytes(200), ["Parquet", "to_csv"]),
        ("log.xlsx", b"PK\x03\x04" + bytes(200), ["Excel", "CSV"]),
        ("log.mat", b"MATLAB 5.0 MAT-file" + b" " * 200 + b"\0\1IM", ["Matlab", "CSV"]),
        ("log.csv", "time_s,pressure_dbar\n1,2\n".encode("utf-16"), ["UTF-16", "UTF-8"]),
        ("log.nc", b"<!DOCTYPE html><html>404</html>", ["download"]),
        ("log.csv", b'Error {\n    code=404;\n    message="Not Found";\n}\n', ["ERDDAP"]),
        ("log.csv", b"My glider\ntime_s,pressure_dbar,pitch_deg,vbd_cc\n1,2,3,4\n", ["title", "#"]),
        ("log.csv", b"time_s pressure_dbar pitch_deg vbd_cc\n1 2 3 4\n", ["blanks"]),
        ("log.csv", b"time_s,pressure_dbar,pitch_deg,vbd_cc\n30/02/2022 18:00:00,2,3,4\n", ["log.csv:2:1", "the day first"]),
    ],
)
def test_what_is_no_log_is_called_what_it_is(glidepolar, tmp_path, name, content, hints):
    path = tmp_path / name
    path.write_bytes(content)
    for command in ["identify", "diagnose", "track"]:
        done = run(glidepolar, command, path, "--vehicle", "seaglider")
        assert done.returncode == 2 and name in done.stderr, done.stderr
        assert all(hint in done.stderr for hint in hints), done.stderr


def test_a_pitch_in_radians_under_a_name_of_degrees_is_refused(glidepolar, tmp_path):
    dive = Dive(rows=400)
    columns = {name: (lambda row, name=name: dive[name][row]) for name in dive.values}
    log_files.cells(tmp_path / "log.csv", {**columns, "pitch_deg": lambda row: dive["pitch_deg"][row] * log_files.RAD}, 400)
    for command in ["identify", "diagnose", "track"]:
        done = run(glidepolar, command, tmp_path / "log.csv", "--vehicle", "seaglider")
        assert done.returncode == 2 and "--unit pitch_rad=rad" in done.stderr, done.stderr
    log_files.cells(tmp_path / "right.csv", columns, 400)
    for log, unit in [("log.csv", ["--unit", "pitch_rad=rad"]), ("right.csv", [])]:
        done = run(glidepolar, "track", tmp_path / log, "--vehicle", "seaglider", *unit)
        assert "no glider glides so" not in done.stderr, done.stderr


@pytest.mark.parametrize("maker", ["seaexplorer", "slocum"])
def test_a_track_takes_the_density_from_the_conductivity(glidepolar, tmp_path, maker):
    dive = Dive(rows=400)
    if maker == "slocum":
        log_files.slocum(tmp_path / "a.dbd", dive)
        paths = [tmp_path / "a.dbd"]
    else:
        paths = seaexplorer(tmp_path, dive)
    done = run(glidepolar, "track", *paths, "--vehicle", "seaexplorer", "--json", "-", "-q")
    assert "density" not in done.stderr, done.stderr


def test_a_grid_of_profiles_is_no_time_series(glidepolar, tmp_path):
    with netCDF4.Dataset(tmp_path / "grid.nc", "w") as file:
        file.createDimension("time", 3)
        file.createDimension("depth", 40)
        log_files.variable(file, "time", ("time",), [1e9, 1.001e9, 1.002e9], "seconds since 1970-01-01")
        for name in ["pressure", "pitch", "vbd_cc"]:
            log_files.variable(file, name, ("depth", "time"), np.ones((40, 3)))
    done = run(glidepolar, "identify", tmp_path / "grid.nc", "--vehicle", "seaglider")
    assert done.returncode == 2 and "grid over depth and time" in done.stderr, done.stderr


def test_netcdf_packed_by_an_add_on_is_not_called_damaged(glidepolar, tmp_path):
    with netCDF4.Dataset(tmp_path / "zstd.nc", "w") as file:
        file.createDimension("N_MEASUREMENTS", 120)
        for name, spec in log_files.OG1.items():
            made = file.createVariable(name, "f8", ("N_MEASUREMENTS",), compression="zstd")
            made.units = spec["unit"]
            made[:] = spec["of"](Dive())
    done = run(glidepolar, "identify", tmp_path / "zstd.nc", "--vehicle", "seaglider")
    assert done.returncode == 2 and "Zstandard" in done.stderr and "damaged" not in done.stderr, done.stderr


def test_an_instrument_without_a_clock_costs_itself_only(log_values, tmp_path):
    log_files.seaglider(tmp_path / "p1710001.nc", Dive(), drop=["ctd_time"])
    rows, said = values(log_values, tmp_path / "p1710001.nc")
    assert rows == 120 and "`temperature` has 117 values and no clock" in said, said


def test_dates_of_a_seaexplorer_in_another_order_are_named(glidepolar, tmp_path):
    files = [tmp_path / "sea035.12.gli.sub.5", tmp_path / "sea035.12.pld1.raw.5"]
    log_files.seaexplorer(*files, Dive(), clock="%m/%d/%Y %H:%M:%S")
    done = run(glidepolar, "identify", *files, "--vehicle", "seaexplorer")
    assert done.returncode == 2 and "06/13/2022" in done.stderr and "DD/MM/YYYY" in done.stderr, done.stderr
