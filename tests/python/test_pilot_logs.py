"""A pilot's logs through the command: the vehicle that the files describe, and files that are damaged, mixed or of two gliders."""

import json
import subprocess
import tomllib

import log_files
import netCDF4
import numpy as np
import pytest
from log_files import OG1, Dive, channel

CALIBRATION = {
    "sg_cal_mass": 52.5,
    "sg_cal_volmax": 51_708.0,
    "sg_cal_hd_a": 0.0038,
    "sg_cal_hd_b": 0.0105,
    "sg_cal_hd_c": 9.85e-6,
    "log_RHO": 1.0275,
    "log_MASS": 52_500.0,
}


def run(glidepolar, *arguments):
    return subprocess.run([glidepolar, *map(str, arguments)], capture_output=True, text=True, check=False)


def dives(folder, count=4, **how):
    """Dives of a glider that flies by the calibration: sink rates of the steady glide are near enough to fit."""
    paths = []
    for number in range(1, count + 1):
        dive = Dive(rows=400, start_s=log_files.START_S + 5000 * number)
        wave = 1 + 0.05 * np.sin(np.arange(dive.rows) / 9 + number)
        dive.values["pressure_dbar"] = dive["pressure_dbar"] * wave
        paths.append(folder / f"p171000{number}.nc")
        log_files.seaglider(paths[-1], dive, number=number, log=CALIBRATION, **how)
    return paths


def test_the_vehicle_is_that_of_the_files(glidepolar, tmp_path):
    paths = dives(tmp_path)
    done = run(glidepolar, "identify", *paths, "--vehicle", "from-file", "--write", tmp_path / "own.toml", "--json", "-")
    assert done.returncode == 0, done.stderr
    text = (tmp_path / "own.toml").read_text(encoding="utf-8")
    assert "Seaglider SG171, from its files" in text
    # The volume at ballast zero is VOLMAX less what C_VBD lies above VBD_MIN.
    volume = 51_708e-6 + (3000 - 500) * -0.2453e-6
    written = tomllib.loads(text)
    assert abs(written["mass"]["displaced_volume_m3"] / volume - 1) < 1e-12
    assert json.loads(done.stdout)["n_glides"] == 8
    printed = run(glidepolar, "identify", *paths, "--vehicle", "from-file").stdout
    for name in ["HD_A", "HD_B", "HD_C", "VOLMAX  ", "C_VBD  "]:
        assert name in printed, printed
    # A vehicle of the user's own that weighs something else is contradicted; the built-in one is nobody's own.
    plain = run(glidepolar, "vehicles", "seaglider").stdout
    (tmp_path / "heavy.toml").write_text(plain.replace("mass_kg = 52.5", "mass_kg = 52.6"), encoding="utf-8")
    said = run(glidepolar, "identify", *paths, "--vehicle", tmp_path / "heavy.toml").stderr
    assert "52.600 kg, the log's files state 52.500 kg" in said
    assert "the log's files state" not in run(glidepolar, "identify", *paths, "--vehicle", "seaglider").stderr


def test_files_that_describe_no_vehicle_are_said_to(glidepolar, tmp_path):
    log_files.time_series(tmp_path / "og1.nc", Dive())
    done = run(glidepolar, "identify", tmp_path / "og1.nc", "--vehicle", "from-file")
    assert done.returncode == 2
    assert "og1.nc" in done.stderr and "--vehicle" in done.stderr
    log_files.seaglider(tmp_path / "p1710001.nc", Dive(), log={})
    done = run(glidepolar, "identify", tmp_path / "p1710001.nc", "--vehicle", "from-file")
    assert done.returncode == 2 and "sg_cal_mass" in done.stderr


def whole(path, kind):
    """A sound file of a kind."""
    if kind == "seaglider":
        log_files.seaglider(path, Dive())
    elif kind == "time series":
        log_files.time_series(path, Dive())
    elif kind == "csv":
        log_files.cells(path, {name: (lambda row, name=name: Dive()[name][row]) for name in Dive().values}, 120)
    elif kind == "dba":
        log_files.dinkum_ascii(path, Dive())
    else:
        log_files.seaexplorer(path, path.with_name("sea035.12.pld1.raw.5"), Dive())
    return path


KINDS = {
    "seaglider": "p1710001.nc",
    "time series": "og1.nc",
    "csv": "log.csv",
    "dba": "amadeus.dba",
    "seaexplorer": "sea035.12.gli.sub.5",
}


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("damage", ["empty", "half of the header", "random bytes", "a folder"])
def test_a_file_of_which_nothing_is_left_is_an_error_that_names_it(glidepolar, tmp_path, kind, damage):
    path = whole(tmp_path / KINDS[kind], kind)
    content = path.read_bytes()
    if damage == "a folder":
        path.unlink()
        path.mkdir()
    elif damage == "random bytes":
        path.write_bytes(np.random.default_rng(1).bytes(5000))
    else:
        path.write_bytes(b"" if damage == "empty" else content[:40])
    done = run(glidepolar, "identify", path, "--vehicle", "seaglider")
    assert done.returncode == 2, (done.stdout, done.stderr)
    assert path.name in done.stderr and "panic" not in done.stderr


@pytest.mark.parametrize("kind", ["dba", "seaexplorer", "csv"])
def test_of_a_file_that_was_cut_off_the_sound_rows_are_kept(log_values, tmp_path, kind):
    path = whole(tmp_path / KINDS[kind], kind)
    content = path.read_bytes()
    path.write_bytes(content[: len(content) * 2 // 3])
    done = subprocess.run([log_values, path], capture_output=True, text=True, check=False)
    assert done.returncode == 0 and len(done.stdout.splitlines()) > 60, done.stderr
    if kind == "csv":
        # A table ends with a row that is not whole: it is left out and said with its line.
        assert "cut off" in done.stderr and "log.csv:" in done.stderr, done.stderr


def test_two_files_put_one_behind_the_other_are_read_or_said(log_values, tmp_path):
    one, two = Dive(), Dive(start_s=log_files.START_S + 5000)
    for number, dive in enumerate([one, two]):
        log_files.dinkum_ascii(tmp_path / f"{number}.dba", dive)
    joined = tmp_path / "joined.dba"
    joined.write_bytes(b"".join((tmp_path / f"{number}.dba").read_bytes() for number in range(2)))
    done = subprocess.run([log_values, joined], capture_output=True, text=True, check=False)
    assert done.returncode == 0 and len(done.stdout.splitlines()) == 241
    assert "such rows are left out" in done.stderr


def test_files_of_two_gliders_in_one_command_are_refused(glidepolar, tmp_path):
    log_files.seaglider(tmp_path / "p1710001.nc", Dive())
    log_files.seaglider(tmp_path / "p5420001.nc", Dive(), glider="SG542")
    done = run(glidepolar, "identify", *tmp_path.glob("p*.nc"), "--vehicle", "seaglider")
    assert done.returncode == 2
    assert all(name in done.stderr for name in ["SG171", "SG542", "give the files of one glider"])


def test_a_damaged_file_among_sound_ones_costs_only_itself(log_values, tmp_path):
    paths = dives(tmp_path)
    paths[1].write_bytes(paths[1].read_bytes()[:3000])
    paths[2].write_bytes(b"")
    done = subprocess.run([log_values, *paths], capture_output=True, text=True, check=False)
    assert done.returncode == 0 and len(done.stdout.splitlines()) == 801
    assert all(f"left out: {path}" in done.stderr for path in paths[1:3])


def test_a_channel_without_a_single_value_is_named(glidepolar, tmp_path):
    for name, of, said in [("VBD_CC", "vbd_cc", "vbd_cc"), ("PITCH", "pitch_deg", "pitch")]:
        nothing = {**channel(of), "of": lambda dive: np.full(dive.rows, np.nan), "unit": OG1[name]["unit"]}
        log_files.time_series(tmp_path / "og1.nc", Dive(), {name: nothing})
        done = run(glidepolar, "identify", tmp_path / "og1.nc", "--vehicle", "seaglider")
        assert done.returncode == 2 and said in done.stderr and "og1.nc" in done.stderr, done.stderr


def test_a_clock_that_jumps_back_loses_no_sound_row(log_values, tmp_path):
    log_files.seaglider(tmp_path / "p1710001.nc", Dive(), one_clock=True)
    with netCDF4.Dataset(tmp_path / "p1710001.nc", "a") as file:
        time = file["time"][:]
        time[60:] -= 400.0
        file["time"][:] = time
    done = subprocess.run([log_values, tmp_path / "p1710001.nc"], capture_output=True, text=True, check=False)
    assert done.returncode == 0 and len(done.stdout.splitlines()) == 121
