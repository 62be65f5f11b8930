"""The scripts in examples/, as a user runs them: few variants in every run, a thousand by command:

    GLIDEPOLAR_VARIANTS=1000 target/python/bin/python -m pytest tests/python/test_examples.py -s -k sweep
"""

import csv
import json
import os
import re
import subprocess
import sys
import time
from contextlib import ExitStack
from pathlib import Path

import numpy as np
import pandas
import pytest
from conftest import MEASURED

ROOT = Path(__file__).parents[2]
EXAMPLES = ROOT / "examples"


def run(script: str, *arguments, cwd: Path):
    command = [str(word) for word in (sys.executable, EXAMPLES / script, *arguments)]
    return subprocess.run(command, cwd=cwd, capture_output=True, text=True, timeout=280)


def number_of(text: str, pattern: str) -> float:
    found = re.search(pattern, text)
    assert found, text
    return float(found[1])


def test_a_sweep_on_dask_equals_that_of_the_command(glidepolar, fmu3, tmp_path):
    variants = int(os.environ.get("GLIDEPOLAR_VARIANTS", "24"))
    done = run(
        "dask_sweep.py", "--variants", variants, "--fmu", fmu3, "--compare", glidepolar, "--output", "sweep.csv", cwd=tmp_path
    )
    print(done.stdout)
    assert done.returncode == 0, done.stderr
    assert number_of(done.stdout, r"(\d+) variants of 1000 s") == variants
    assert number_of(done.stdout, r", (\d+) a second\nglidepolar") > 0
    assert number_of(done.stdout, r"largest difference (\S+) of") <= 1e-9
    with (tmp_path / "sweep.csv").open() as file:
        rows = list(csv.DictReader(file))
    # The variants are flown, and differ.
    assert len(rows) == variants == len({row["depth_m"] for row in rows})
    assert all(20 < float(row["depth_m"]) < 500 for row in rows)


def test_a_sweep_over_tcp_is_written_as_parquet_and_resumed(glidepolar, fmu3, tmp_path):
    """A scheduler and workers as programs of their own, which know each other by a TCP address only."""
    variants = max(int(os.environ.get("GLIDEPOLAR_VARIANTS", "0")), 256)
    place = tmp_path / "scheduler.json"
    modules = [["scheduler", "--host", "127.0.0.1", "--port", "0", "--no-dashboard"]]
    modules += [["worker", "--nthreads", "1", "--no-dashboard", "--local-directory", tmp_path]] * 3
    with ExitStack() as stack:
        for name, *options in modules:
            command = [sys.executable, "-m", f"distributed.cli.dask_{name}", "--scheduler-file", place, *options]
            process = stack.enter_context(subprocess.Popen([str(word) for word in command], stderr=subprocess.DEVNULL))
            stack.callback(process.kill)
        until = time.monotonic() + 60
        while not place.is_file():
            assert time.monotonic() < until, "no scheduler within a minute"
            time.sleep(0.1)
        address = json.loads(place.read_text())["address"]
        assert address.startswith("tcp://127.0.0.1:")
        sweep = ["dask_sweep.py", "--variants", variants, "--fmu", fmu3, "--stop", "100", "--scheduler", address]
        done = run(*sweep, "--parquet", "ends", "--compare", glidepolar, cwd=tmp_path)
        assert done.returncode == 0, done.stderr
        assert number_of(done.stdout, r"largest difference (\S+) of") <= 1e-9
        assert number_of(done.stdout, r"flown in (\d+) processes") >= 2
        parts = sorted((tmp_path / "ends").iterdir())
        assert len(parts) == variants // 64
        whole = pandas.read_parquet(tmp_path / "ends")
        # What an interrupted sweep would have left: one piece is missing, and is flown again.
        parts[1].unlink()
        done = run(*sweep, "--parquet", "ends", "--resume", cwd=tmp_path)
        assert done.returncode == 0, done.stderr
        assert number_of(done.stdout, r"workers: (\d+) variants") == variants - number_of(done.stdout, r"(\d+) variants were finished")
        assert 64 <= number_of(done.stdout, r"workers: (\d+) variants") < 128
        pandas.testing.assert_frame_equal(pandas.read_parquet(tmp_path / "ends"), whole, check_exact=True)
        done = run(*sweep, "--parquet", "ends", "--resume", "--seed", "2", cwd=tmp_path)
        assert done.returncode == 1 and "other variants" in done.stderr, done.stderr


def test_a_sweep_that_differs_fails(glidepolar, fmu2, tmp_path):
    """Another program in the place of glidepolar: one that sweeps other numbers."""
    impostor = tmp_path / "impostor"
    impostor.write_text(f'#!/bin/sh\nexec "{glidepolar}" "$@" --set hydro.CL0=0.0001\n')
    impostor.chmod(0o755)
    if os.name == "nt":
        pytest.skip("shell scripts do not run here")
    done = run("dask_sweep.py", "--variants", "2", "--fmu", fmu2, "--compare", impostor, "--stop", "100", cwd=tmp_path)
    assert done.returncode == 1 and "differ by more than" in done.stderr, done.stdout + done.stderr


@pytest.fixture(scope="module")
def flight(glidepolar, tmp_path_factory) -> Path:
    """A log and the FMU of the vehicle that made it."""
    folder = tmp_path_factory.mktemp("flight")
    mission = ROOT / "missions/rising-seabed.toml"
    subprocess.run(
        [glidepolar, "simulate", "slocum-049", "--mission", mission, "--stop", "4000", "--interval", "5", "--quiet",
         "--log", folder / "log.csv"], check=True,
    )  # fmt: skip
    return folder


def test_a_log_of_the_fmus_own_vehicle_is_flown_again(glidepolar, fmu3, flight):
    fmu = flight / "own.fmu"
    subprocess.run([glidepolar, "export-fmu", "slocum-049", "-o", fmu, "--template", fmu3, "-q", "--force"], check=True)
    for moved, depth_m, w_cm_s in ((["--battpos"], 5.0, 1.0), ([], 5.0, 1.0)):
        done = run("fly_a_log.py", "log.csv", "--fmu", fmu, "--keep-trim", *moved, "--output", "flown.csv", cwd=flight)
        assert done.returncode == 0, done.stderr
        measured = number_of(done.stdout, r"vertical velocity measured +(\S+) cm/s")
        assert measured > 15, "the glider hardly moves: nothing is shown"
        assert number_of(done.stdout, r"velocity measured.*\n +model less measured +(\S+) cm/s") < w_cm_s
        assert number_of(done.stdout, r"depth, model less measured +(\S+) m") < depth_m
        flown = np.genfromtxt(flight / "flown.csv", delimiter=",", names=True)
        assert flown["time"][-1] == pytest.approx(4000, abs=5)


def test_a_log_from_sea_goes_through(fmu3, tmp_path):
    log = MEASURED / "comet_2016_baltic_1hz.csv"
    if not log.is_file():
        pytest.skip(f"no measured data: {log} is missing")
    done = run("fly_a_log.py", log, "--fmu", fmu3, "--hours", "0.5", "--flights", "2", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert number_of(done.stdout, r"vertical velocity measured +(\S+) cm/s") > 5


def test_a_log_without_what_is_needed_is_refused_in_words(fmu3, tmp_path):
    (tmp_path / "log.csv").write_text("time_s,depth_m\n0,1\n")
    done = run("fly_a_log.py", "log.csv", "--fmu", fmu3, cwd=tmp_path)
    assert done.returncode == 1 and "error: no row" in done.stderr and "Traceback" not in done.stderr


def test_water_carried_along_is_that_of_an_exponential(tmp_path):
    """A step of density, met at once: what is felt beyond it dies away with the exchange time; after a gap nothing is left."""
    times = [*range(0, 1001, 10), 50_000]
    rows = [f"{t},{1000 if t < 100 else 1004},12.0,{0.1 * t:.1f}" for t in times]
    (tmp_path / "log.csv").write_text("time_s,density_kg_m3,temperature_C,pressure_dbar\n" + "\n".join(rows) + "\n")
    asked = ("log.csv", "--share", "0.25", "--exchange-s", "200", "--output", "carried.csv")
    done = run("carried_water.py", *asked, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    carried = np.genfromtxt(tmp_path / "carried.csv", delimiter=",", names=True)
    # Density belongs to another water now, so nothing may be left from which it could be computed anew.
    assert carried.dtype.names == ("time_s", "density_kg_m3", "pressure_dbar")
    t = carried["time_s"]
    # At the step itself the water inside has followed over one row's time.
    late = np.where((t >= 100) & (t < 50_000), np.exp(-(t - 90) / 200), 0)
    assert carried["density_kg_m3"] == pytest.approx(np.where(t < 100, 1000, 1004) + 0.25 * 4 * late, abs=1e-4)
    (tmp_path / "log.csv").write_text("time_s,depth_m\n0,1\n")
    done = run("carried_water.py", *asked, cwd=tmp_path)
    assert done.returncode == 1 and "no density_kg_m3" in done.stderr and "Traceback" not in done.stderr


def test_comet_needs_no_water_carried_along(glidepolar, tmp_path):
    """Over 40 m on a pair of headings the shear of an unknown current does what a ballast scale of 0.8 did before it was in the model."""
    log = MEASURED / "comet_2016_baltic_1hz.csv"
    if not log.is_file():
        pytest.skip(f"no measured data: {log} is missing")
    command = [glidepolar, "diagnose", "--vehicle", "slocum-graver", "--speed-column", "U_dvl_m_s", "--pin-lift=21", "--json", "-"]
    done = subprocess.run([*command, log], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    causes = {cause["cause"]: cause for cause in json.loads(done.stdout)["causes"]}
    assert not {"ballast_scale", "carried_water", "reynolds_drag", "climb_dive_asymmetry"} & causes.keys(), causes.keys()
    # A scale of the pitch, by its own name or that of its group: the owners' own correction.
    scales = [cause for name, cause in causes.items() if "pitch_scale" in [name, *cause["indistinguishable_from"]]]
    assert len(scales) == 1, causes.keys()
