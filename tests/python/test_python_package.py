"""`import glidepolar`: the functions give what the commands give, to the last digit, and say what is wrong as exceptions.

The package is the wheel's, in an environment of its own; pandas, xarray and mypy are the tests'.
"""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from conftest import long

ROOT = Path(__file__).parents[2]
NOTHING_ELSE = {name: value for name, value in os.environ.items() if not name.startswith("GLIDEPOLAR_")}


@pytest.fixture(scope="session")
def flight(glidepolar, tmp_path_factory) -> Path:
    """The log of a simulated mission."""
    folder = tmp_path_factory.mktemp("flight")
    mission = ROOT / "missions/rising-seabed.toml"
    command = [glidepolar, "simulate", "slocum-049", "--mission", mission, "--log", "flight.csv", "--quiet"]
    subprocess.run(command, cwd=folder, check=True)
    return folder / "flight.csv"


def in_python(programs: Path, code: str, *arguments, cwd: Path, timeout: float = 250, environment: dict = {}) -> str:
    command = [programs / "python", "-W", "error", "-c", code, *arguments]
    variables = {**NOTHING_ELSE, **environment}
    done = subprocess.run(list(map(str, command)), cwd=cwd, capture_output=True, text=True, env=variables, timeout=timeout)
    assert done.returncode == 0, done.stderr
    return done.stdout


def by_command(program: Path, *arguments, cwd: Path) -> str:
    return subprocess.check_output([program, *map(str, arguments), "--json", "-"], cwd=cwd, text=True, stderr=subprocess.DEVNULL)


def test_identify_on_a_data_frame_is_the_commands_json_to_the_last_digit(programs, flight, tmp_path):
    said = in_python(
        programs,
        """if True:
        import sys, glidepolar, numpy, pandas
        frame = pandas.read_csv(sys.argv[1], comment="#")
        of_frame = glidepolar.identify(frame, "slocum-049")
        assert of_frame.to_json() == glidepolar.identify(sys.argv[1], "slocum-049").to_json()
        # Columns of a table of numbers lie apart in memory, and a mapping of arrays does as well.
        table = numpy.ascontiguousarray(frame.to_numpy(dtype=float))
        apart = {name: table[:, i] for i, name in enumerate(frame.columns)}
        assert glidepolar.identify(apart, glidepolar.Vehicle("slocum-049")).to_json() == of_frame.to_json()
        # What was read and given back is the same log.
        again = glidepolar.identify(glidepolar.read(sys.argv[1]).to_pandas(), "slocum-049")
        assert again.to_dict()["parameters"] == of_frame.to_dict()["parameters"]
        assert of_frame.parameters["b"].value == of_frame["parameters"]["b"]["value"]
        print(of_frame.to_json(), end="")
        """,
        flight,
        cwd=tmp_path,
    )
    assert said == by_command(programs / "glidepolar", "identify", flight, "--vehicle", "slocum-049", cwd=tmp_path)
    assert json.loads(said)["schema"] == "glidepolar.identify/1"


@pytest.mark.parametrize(
    "call, arguments",
    [
        ("glide('rogue', net_mass_kg=0.3)", ["glide", "rogue", "--net-mass-kg", "0.3"]),
        ("turn('seaglider', roll_mass_deg=40, pitch_deg=-20)", ["turn", "seaglider", "--roll-mass-deg=40", "--pitch-deg=-20"]),
        ("plan('seaglider', depth_m=1000, battery_Wh=2700)", ["plan", "seaglider", "--depth-m=1000", "--battery-Wh=2700"]),
        ("compare('slocum-049', glidepolar.Vehicle('seaglider'))", ["compare", "slocum-049", "seaglider"]),
        ("simulate('slocum-graver', stop_s=50)", ["simulate", "slocum-graver", "--stop=50"]),
        ("diagnose(FLIGHT, 'slocum-049')", ["diagnose", "FLIGHT", "--vehicle", "slocum-049"]),
        ("tank.reduce(POINTS, HULL)", ["tank-reduce", "POINTS", "--hull", "HULL", "--quiet"]),
    ],
    ids=lambda value: value[0] if isinstance(value, list) else "",
)
def test_a_functions_result_is_the_commands(programs, flight, tmp_path, call, arguments):
    places = {"FLIGHT": flight, "POINTS": ROOT / "tank/data/suboff_roddy1990.csv", "HULL": ROOT / "tank/data/suboff.toml"}
    for name, place in places.items():
        call = call.replace(name, repr(str(place)))
    said = in_python(programs, f"import glidepolar; print(glidepolar.{call}.to_json(), end='')", cwd=tmp_path)
    words = [places.get(word, word) for word in arguments]
    of_tank = words[0] == "tank-reduce"
    program = programs / ("tank-reduce" if of_tank else "glidepolar")
    assert said == by_command(program, *(words[1:] if of_tank else words), cwd=tmp_path)


def test_results_lead_on_to_vehicles_fmus_and_pages(programs, flight, tmp_path):
    in_python(
        programs,
        """if True:
        import sys, pathlib, subprocess, zipfile, glidepolar
        from glidepolar import Vehicle
        found = glidepolar.identify(sys.argv[1], "slocum-049")
        saved = found.vehicle.save("identified.toml")
        subprocess.run([sys.argv[2], "identify", sys.argv[1], "--vehicle", "slocum-049", "--write", "command.toml", "-q"])
        assert saved.read_text() == pathlib.Path("command.toml").read_text() and Vehicle(saved)["hydro.b"] > 0
        assert zipfile.ZipFile(found.fmu("Identified.fmu", fmi_version=2)).testzip() is None
        page = found.report("pages").read_text(encoding="utf-8")
        assert "<h1>" in page and "glidepolar identify" in page and "python" not in page.split('id="repeat"')[1]
        frame = glidepolar.read(sys.argv[1]).to_pandas()
        page = glidepolar.identify(frame, "slocum-049").report("of-frame").read_text(encoding="utf-8")
        assert "in memory" in page
        assert "<table>" in found._repr_html_() and "<table>" in Vehicle("rogue")._repr_html_()
        data = glidepolar.read(sys.argv[1]).to_xarray()
        assert data.sizes["time_s"] == len(frame) and "pitch_rad" in data
        rough = Vehicle("slocum-graver").with_values({"hydro.b": 0.3})
        slow, fast = (glidepolar.glide(v, net_mass_kg=0.25, pitch_deg=-26).to_pandas() for v in (rough, "slocum-graver"))
        assert slow["speed_m_s"][0] < fast["speed_m_s"][0]
        flown = glidepolar.simulate("slocum-graver", stop_s=20, interval_s=10).to_pandas()
        assert list(flown["time"]) == [0.0, 10.0, 20.0]
        assert len(glidepolar.simulate("slocum-graver", sweep={"b": [0.2, 0.3]}, stop_s=10).columns()["time"]) == 2
        track = glidepolar.track(sys.argv[1], "slocum-049").to_pandas()
        assert len(track) > 10
        """,
        flight,
        programs / "glidepolar",
        cwd=tmp_path,
    )


def test_errors_name_file_line_and_hint(programs, flight, tmp_path):
    broken = tmp_path / "broken.csv"
    lines = flight.read_text().splitlines()
    first = next(i for i, line in enumerate(lines) if not line.startswith("#"))
    cells = lines[first + 5].split(",")
    cells[2] = "much"
    lines[first + 5] = ",".join(cells)
    broken.write_text("\n".join(lines) + "\n")
    in_python(
        programs,
        f"""if True:
        import glidepolar, pytest
        with pytest.raises(glidepolar.InputError) as caught:
            glidepolar.identify("broken.csv", "slocum-049")
        assert (caught.value.file, caught.value.line, caught.value.column) == ("broken.csv", {first + 6}, 3)
        assert "much" in caught.value.problem and isinstance(caught.value, ValueError)
        with pytest.raises(glidepolar.InputError) as caught:
            glidepolar.Vehicle("slocum-048")
        assert "slocum-049" in caught.value.hint
        with pytest.raises(glidepolar.InputError, match="pitch"):
            glidepolar.identify({{"time_s": [0.0, 1.0], "depth_m": [0.0, 1.0]}}, "rogue")
        with pytest.raises(glidepolar.NoAnswerError):
            glidepolar.glide("rogue", glide_angle_deg=-2, speed_m_s=0.3)
        with pytest.raises(glidepolar.OutputError):
            glidepolar.glide("rogue", net_mass_kg=0.3).report("broken.csv")
        with pytest.raises(glidepolar.InputError):
            glidepolar.glide("rogue", pitch_deg=-20)
        """,
        cwd=tmp_path,
    )


def test_python_goes_on_and_can_be_interrupted(programs, tmp_path):
    code = """if True:
        import glidepolar, threading, time
        ticks = []
        threading.Thread(target=lambda: [ticks.append(time.sleep(0.01)) for _ in range(10**6)], daemon=True).start()
        print("ready", flush=True)
        try:
            glidepolar.simulate("slocum-graver", stop_s=1e6, interval_s=10, tolerance=1e-12)
        except KeyboardInterrupt:
            print("interrupted", len(ticks), flush=True)
            time.sleep(1)
            before = time.process_time()
            time.sleep(1)
            print(time.process_time() - before, flush=True)
    """
    with subprocess.Popen(
        [programs / "python", "-c", code], cwd=tmp_path, stdout=subprocess.PIPE, text=True, env=NOTHING_ELSE,
        # A job in the background of a shell inherits that it ignores the signal.
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    ) as process:
        assert process.stdout.readline() == "ready\n"
        time.sleep(2)
        process.send_signal(signal.SIGINT)
        begin = time.monotonic()
        said = process.stdout.readline().split()
        waited = time.monotonic() - begin
        worked_on = float(process.stdout.readline())
    assert said[0] == "interrupted" and int(said[1]) > 20, said
    assert waited < 2
    # Sleeping and counting in the other thread takes little; a simulation would take a whole core.
    assert worked_on < 0.5, "the interrupted work has ended"


def test_long_work_says_how_far_it_is_and_ends_where_the_callback_fails(programs, flight, tmp_path):
    in_python(
        programs,
        """if True:
        import sys, glidepolar, pytest
        steps = []
        variants = {"b": [0.1 + 1e-4 * i for i in range(600)]}
        glidepolar.simulate("slocum-graver", sweep=variants, progress=lambda *step: steps.append(step))
        assert steps[-1] == ("variants", 600, 600) and len(steps) > 1, steps
        assert steps[0][1] < 600 and {(what, total) for what, _, total in steps} == {("variants", 600)}
        steps.clear()
        glidepolar.diagnose(sys.argv[1], "slocum-049", progress=lambda *step: steps.append(step))
        assert {"rows (reading)", "flights of the model"} >= {what for what, _, _ in steps} and steps
        assert all(total is None for _, _, total in steps)

        def fails(what, done, total):
            raise RuntimeError("seen enough")

        with pytest.raises(RuntimeError, match="seen enough"):
            glidepolar.identify(sys.argv[1], "slocum-049", progress=fails)
        """,
        flight,
        cwd=tmp_path,
    )


@long
@pytest.mark.skipif(sys.platform != "linux", reason="only Linux lets a process reset its own peak of memory")
def test_a_long_log_is_not_copied(programs, tmp_path):
    """The analysis keeps a bounded number of samples, and means over a minute each: the same flight of a million seconds in
    eight times as many rows costs no further memory. A copy of only one column would add 8 bytes for each further row, and
    that is the bound. Columns of 32-bit floats have to be converted, which is such a copy of each: the measurement must see
    them.
    """
    many = 2 * int(os.environ.get("GLIDEPOLAR_ROWS", "1000000"))
    # A power of two: how many samples are kept of a log depends on its rows, and is the same for both.
    few = many // 8
    bound = 8 * (many - few)
    for_few, for_many = memory(programs, tmp_path, few), memory(programs, tmp_path, many)
    if for_many - for_few >= bound:
        # What else the process holds at its peak differs from run to run on a busy machine. A copy is there in every run.
        for_many = min(for_many, memory(programs, tmp_path, many))
    assert for_many - for_few < bound, (for_few, for_many)
    # Several columns, since what differs from run to run is nearly as much as one.
    converted = ["depth_m", "pitch_rad", "vbd_cc", "density_kg_m3"]
    for_copies = memory(programs, tmp_path, many, converted)
    seen = (for_copies - for_many) / len(converted)
    assert seen >= 4 * many, f"columns of 64-bit floats were made anew, and the measurement saw {seen:.0f} bytes of each"


def memory(programs, folder, rows: int, converted: list[str] = []) -> int:
    """Bytes by which the process grows at most while a log is identified, beyond what it has before."""
    said = in_python(
        programs,
        """if True:
        import os, sys
        # How much two threads hold at one moment differs by chance from run to run, by more than a column.
        os.environ["RAYON_NUM_THREADS"] = "1"
        import numpy, glidepolar

        def of_process(key):
            lines = open("/proc/self/status").read().splitlines()
            return next(1024 * int(line.split()[1]) for line in lines if line.startswith(key + ":"))

        rows, converted = int(sys.argv[1]), sys.argv[2:]
        time = numpy.arange(rows) * (1e6 / rows)
        phase = (time % 2000) / 1000
        down = phase < 1
        frame = {
            "time_s": time,
            "depth_m": numpy.where(down, 180 * phase, 180 * (2 - phase)),
            "pitch_rad": numpy.where(down, -0.45, 0.45),
            "vbd_cc": numpy.where(down, -200.0, 200.0),
            "density_kg_m3": numpy.full(rows, 1025.0),
        }
        del time, phase, down
        size = sum(values.nbytes for values in frame.values())
        for name in converted:
            frame[name] = frame[name].astype(numpy.float32)
        # The peak of memory, which a process else has from the one that started it, begins anew with what it has now.
        open("/proc/self/clear_refs", "w").write("5")
        before = of_process("VmRSS")
        found = glidepolar.identify(frame, "slocum-049")
        print(found["n_samples"], size, before, of_process("VmHWM"))
        """,
        str(rows),
        *converted,
        cwd=folder,
        # Every large block of memory goes back to the system when it is given up, and counts when it is taken again.
        environment={"MALLOC_MMAP_THRESHOLD_": "65536"},
    )
    _, size, before, peak = map(int, said.split())
    made = f", {len(converted)} of them converted" if converted else ""
    print(
        f"{rows} rows, {size / 1e6:.0f} MB of columns{made}: {before / 1e6:.0f} MB before, peak {peak / 1e6:.0f} MB",
        file=sys.stderr,
    )
    return peak - before


def test_an_example_passes_mypy_strictly(programs, tmp_path):
    example = tmp_path / "example.py"
    example.write_text(
        "import glidepolar\n"
        "from glidepolar import Estimate, Vehicle\n\n"
        "vehicle = Vehicle('slocum-049').with_values({'hydro.b': 0.14})\n"
        "found = glidepolar.identify('flight.csv', vehicle, free=['hull_compressibility_per_Pa'], pin={'a': (21.0, 3.0)})\n"
        "b: Estimate = found.parameters['b']\n"
        "print(b.value + b.ci95[0], found.vehicle.save('identified.toml').name)\n"
        "path: str = glidepolar.fmu_path(2)\n"
        "drag: float = vehicle['hydro.b']\n"
        "text: str = glidepolar.tank.reduce('pmm_runs').to_json()\n"
    )
    check = [sys.executable, "-m", "mypy", "--strict", "--python-executable", str(programs / "python"), "--cache-dir", str(tmp_path / "cache")]
    done = subprocess.run([*check, "example.py"], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    example.write_text("import glidepolar\n\nglidepolar.identify('flight.csv', 'slocum-049', pin=3)\n")
    done = subprocess.run([*check, "example.py"], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 1 and "pin" in done.stdout
