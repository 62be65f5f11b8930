"""What the tests in Python share: where the built things are, as `cargo xtask test` says it, and the list of skips."""

import os
import subprocess
import sys
import sysconfig
from pathlib import Path

import flights
import pytest

# dbdreader makes this folder on import and fails where another process of the tests makes it at the same time.
(Path.home() / ".local/share/dbdreader").mkdir(parents=True, exist_ok=True)

# Where measured logs lie, if there are any.
MEASURED = Path(os.environ.get("GLIDEPOLAR_DATA", Path(__file__).parents[3] / "shared/data"))


def together(group: str) -> pytest.MarkDecorator:
    """Tests that share what is dear to make: in one process of those that run the tests, so that it is made once."""
    return pytest.mark.xdist_group(group)


# Minutes each: they begin before all others, so that none of them is left over for one process at the end.
long = pytest.mark.long


def pytest_configure(config):
    config.addinivalue_line("markers", "long: takes minutes, and begins before all others")


@pytest.hookimpl(trylast=True)
def pytest_collection_modifyitems(config, items):
    """Long tests come first. Where pytest-xdist does not see the groups, what is dear is made in every process, and two of them
    build in one folder: nothing fails, everything takes longer. That is said here.
    """
    items.sort(key=lambda item: item.get_closest_marker("long") is None)
    if getattr(config.option, "loadgroup", False):
        alone = [item.nodeid for item in items if item.get_closest_marker("xdist_group") and "@" not in item.nodeid]
        assert alone == [], f"pytest-xdist has lost the groups of {len(alone)} tests, as {alone[0]}"


def path_from(variable: str) -> Path:
    value = os.environ.get(variable)
    if value is None:
        pytest.skip(f"{variable} is not set; run the tests as `cargo xtask test`")
    return Path(value)


@pytest.fixture(scope="session")
def fmu3() -> Path:
    """The FMI 3.0 archive."""
    return path_from("GLIDEPOLAR_FMU3")


@pytest.fixture(scope="session")
def fmu2() -> Path:
    """The FMI 2.0 archive."""
    return path_from("GLIDEPOLAR_FMU2")


@pytest.fixture(params=["GLIDEPOLAR_FMU3", "GLIDEPOLAR_FMU2"], ids=["fmi3", "fmi2"])
def fmu(request) -> Path:
    """Each of the two archives in turn."""
    return path_from(request.param)


@pytest.fixture(scope="session")
def glidepolar() -> Path:
    """The command line."""
    return path_from("GLIDEPOLAR_COMMAND")


@pytest.fixture(scope="session")
def log_values() -> Path:
    """The program that writes a log as it was read."""
    return path_from("GLIDEPOLAR_LOG_VALUES")


@pytest.fixture(scope="session")
def wheel() -> Path:
    """The package for pip."""
    return path_from("GLIDEPOLAR_WHEEL")


def empty_environment(folder: Path) -> tuple[Path, list[str]]:
    """Makes a Python environment in which nothing is: the folder of its programs, and the command that is its pip."""
    subprocess.run([sys.executable, "-m", "venv", "--without-pip", folder], check=True)
    programs = folder / ("Scripts" if os.name == "nt" else "bin")
    return programs, [sys.executable, "-m", "pip", "--disable-pip-version-check", "--python", str(programs / "python")]


@pytest.fixture(scope="session")
def programs(wheel, tmp_path_factory) -> Path:
    """The programs of an environment with the wheel, beside which the tests' own packages can be imported."""
    programs, pip = empty_environment(tmp_path_factory.mktemp("package") / "environment")
    subprocess.run([*pip, "install", "--quiet", "--no-index", wheel], check=True)
    site = subprocess.check_output(
        [programs / "python", "-c", "import sysconfig; print(sysconfig.get_paths()['purelib'])"], text=True
    )
    (Path(site.strip()) / "tests.pth").write_text(sysconfig.get_paths()["purelib"] + "\n")
    return programs


@pytest.fixture(scope="session")
def virtual_sea() -> Path:
    """The generator of flight logs with a hidden effect."""
    return path_from("GLIDEPOLAR_VIRTUAL_SEA")


def pytest_runtest_logreport(report):
    """A skip goes into the list that `cargo xtask test` shows at its end."""
    file = os.environ.get("GLIDEPOLAR_SKIPPED")
    is_worker = "PYTEST_XDIST_WORKER" in os.environ
    if report.skipped and file and not is_worker and not hasattr(report, "wasxfail"):
        *_, reason = report.longrepr
        with open(file, "a", encoding="utf-8") as skipped:
            skipped.write(f"{report.nodeid}: {reason.removeprefix('Skipped: ')}\n")


@pytest.fixture(scope="session")
def flown(glidepolar, tmp_path_factory) -> dict[str, dict]:
    """The missions of `flights` as the command line flies them, every 8 s."""
    folder = tmp_path_factory.mktemp("reference")
    runs = {}
    for name, flight in flights.FLIGHTS.items():
        options = ["--inputs", str(flight.inputs), "--stop", str(flights.STOP), "--interval", str(flights.STEP)]
        runs[name] = flights.simulate(glidepolar, folder / f"{name}.csv", *options, *flight.options)
    return runs


def counters() -> tuple[str, str]:
    """Tables of motor moves and dives of a glider that pumps 0.03 J per dbar and cc, and 10 J per cc."""
    strokes, dives = [], []
    charge = 0.0
    for dive in range(1, 13):
        depth, duration = 300 + 70 * (5 * dive % 12), 6000 + 700 * dive
        energy = 0.0
        for number, share in enumerate((0.02, 0.5, 1.0), start=1):
            volume = 40.0 * number
            joule = (0.03 * depth * share * 1.01043 + 10) * volume * (1 + 0.02 * (-1) ** (dive + number))
            strokes.append(f"{dive},{depth * share:.1f},3000,{3000 - volume / 0.25:.0f},{joule / 15:.2f},1,15")
            energy += joule
        charge += (energy + 4000 + 0.2 * duration) / 15 / 3600
        dives.append(f"{dive},{duration},0.25,{charge:.5f},15,0,10")
    moves = "\n".join(["dive,depth_m,vbd_ad_start,vbd_ad_end,vbd_secs,vbd_A,vbd_V", *strokes]) + "\n"
    columns = "dive,duration_s,VBD_CNV_cc_per_count,ah24_cum_Ah,ah24_min_V,ah10_cum_Ah,ah10_min_V"
    return moves, "\n".join([columns, *dives]) + "\n"
