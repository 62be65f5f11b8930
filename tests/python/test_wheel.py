"""The wheel in a clean environment: both commands, both FMUs, manual pages, and the way that a new user goes. What the
package does in Python is in test_python_package.py.

`cargo xtask test` makes the wheel from the programs that it has built. The one for others, `cargo xtask wheel`, is tried
by the same tests:

    GLIDEPOLAR_WHEEL=target/wheels/glidepolar-*.whl target/python/bin/python -m pytest tests/python/test_wheel.py
"""

import csv
import hashlib
import os
import subprocess
import sys
import zipfile
from base64 import urlsafe_b64encode
from pathlib import Path

import pytest
from conftest import MEASURED, empty_environment

SEAGLIDER = "sg542_samples.csv"
ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="session")
def clean(wheel, tmp_path_factory) -> Path:
    """The programs of an environment in which nothing is but the wheel."""
    programs, pip = empty_environment(tmp_path_factory.mktemp("clean") / "environment")
    # Without an index: the wheel needs nothing else.
    subprocess.run([*pip, "install", "--quiet", "--no-index", wheel], check=True)
    return programs


def ok(*arguments, cwd: Path, **environment) -> str:
    env = {name: value for name, value in os.environ.items() if not name.startswith("GLIDEPOLAR_")}
    command = [str(word) for word in arguments]
    done = subprocess.run(command, cwd=cwd, capture_output=True, text=True, env={**env, **environment}, timeout=200)
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_the_wheel_is_what_its_name_and_its_record_say(wheel):
    name, version, python, abi, platform = wheel.stem.split("-")
    assert (name, python, abi) == ("glidepolar", "cp39", "abi3")
    with zipfile.ZipFile(wheel) as archive:
        assert archive.testzip() is None
        tags = archive.read(f"{name}-{version}.dist-info/WHEEL").decode().splitlines()
        assert f"Tag: cp39-abi3-{platform}" in tags and "Root-Is-Purelib: false" in tags
        record = {row[0]: row[1:] for row in csv.reader(archive.read(f"{name}-{version}.dist-info/RECORD").decode().splitlines())}
        assert set(record) == {entry for entry in archive.namelist() if not entry.endswith("/")}
        for entry, (digest, size) in record.items():
            if not entry.endswith("RECORD"):
                content = archive.read(entry)
                wanted = urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()
                assert (digest, int(size)) == (f"sha256={wanted}", len(content)), entry
        licences = [entry for entry in archive.namelist() if "/licenses/" in entry]
        assert {entry.rsplit("/", 1)[1] for entry in licences} == {"LICENSE-MIT", "LICENSE-APACHE", "LICENSES.txt"}
        text = archive.read(next(entry for entry in licences if entry.endswith("LICENSES.txt"))).decode()
        assert "clap 4" in text and "nalgebra 0" in text and "pyo3 0" in text


def test_a_tank_engineers_first_commands(clean, tmp_path):
    ok(clean / "tank-reduce", "--help", cwd=tmp_path)
    ok(clean / "tank-reduce", "demo", "pmm_runs/", cwd=tmp_path)
    said = ok(clean / "tank-reduce", "pmm_runs/", cwd=tmp_path)
    assert "LDR12.5" in said
    assert (tmp_path / "tank_out/report.html").stat().st_size > 100_000


def test_a_pilots_first_commands(clean, tmp_path):
    ok(clean / "glidepolar", "--help", cwd=tmp_path)
    # The Seaglider's own files where they were fetched, else its table, else a log of the simulated glider, which shows as well
    # that the command is whole.
    logs = sorted((ROOT / "data/sg542").glob("p5420*.nc")) or [log for log in [MEASURED / SEAGLIDER] if log.is_file()]
    if not logs:
        mission = ROOT / "missions/rising-seabed.toml"
        ok(clean / "glidepolar", "simulate", "slocum-049", "--mission", mission, "--log", "log.csv", cwd=tmp_path)
        logs = [tmp_path / "log.csv"]
    said = ok(clean / "glidepolar", "identify", *logs, "--vehicle", "seaglider", cwd=tmp_path)
    assert "a_per_rad" in said or "\na " in said


def test_a_modellers_first_commands(clean, tmp_path):
    fmu = ok(clean / "glidepolar", "fmu", cwd=tmp_path).strip()
    ask = "import glidepolar; print(glidepolar.fmu_path()); print(glidepolar.fmu_path(2)); print(glidepolar.__version__)"
    in_python = ok(clean / "python", "-c", ask, cwd=tmp_path).split()
    assert in_python[:2] == [fmu, ok(clean / "glidepolar", "fmu", "--fmi", "2", cwd=tmp_path).strip()]
    assert in_python[2] in ok(clean / "glidepolar", "--version", cwd=tmp_path)
    assert Path(fmu).is_relative_to(clean.parent.resolve())
    # FMPy is the tests' own: the FMU comes from the wheel.
    for archive in in_python[:2]:
        command = [sys.executable, "-m", "fmpy", "simulate", archive, "--stop-time", "1000", "--output-interval", "10"]
        ok(*command, "--output-file", "result.csv", cwd=tmp_path)
        rows = (tmp_path / "result.csv").read_text().splitlines()
        assert len(rows) == 102
    ok(clean / "glidepolar", "export-fmu", "rogue", "-o", "Rogue.fmu", cwd=tmp_path)
    ok(sys.executable, "-m", "fmpy", "validate", "Rogue.fmu", cwd=tmp_path)


def test_pages_and_completions_lie_where_they_are_looked_for(clean):
    share = clean.parent / "share"
    for page in ("glidepolar.1", "glidepolar-identify.1", "tank-reduce.1"):
        assert (share / "man/man1" / page).is_file()
    for place in ("bash-completion/completions/NAME", "zsh/site-functions/_NAME", "fish/vendor_completions.d/NAME.fish"):
        for program in ("glidepolar", "tank-reduce"):
            assert (share / place.replace("NAME", program)).stat().st_size > 1000
