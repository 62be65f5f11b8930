"""What the tests in Python share: where the built things are, as `cargo xtask test` says it, and the list of skips."""

import os
from pathlib import Path

import flights
import pytest


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
def virtual_sea() -> Path:
    """The generator of flight logs with a hidden effect."""
    return path_from("GLIDEPOLAR_VIRTUAL_SEA")


def pytest_runtest_logreport(report):
    """A skip goes into the list that `cargo xtask test` shows at its end."""
    file = os.environ.get("GLIDEPOLAR_SKIPPED")
    if report.skipped and file and not hasattr(report, "wasxfail"):
        *_, reason = report.longrepr
        with open(file, "a", encoding="utf-8") as skipped:
            skipped.write(f"{report.nodeid}: {reason.removeprefix('Skipped: ')}\n")


@pytest.fixture(scope="session")
def sawtooth(glidepolar, tmp_path_factory) -> dict:
    """The sawtooth as the command line flies it, every 8 s."""
    output = tmp_path_factory.mktemp("reference") / "sawtooth.csv"
    return flights.simulate(
        glidepolar, output, "--inputs", flights.SAWTOOTH, "--stop", str(flights.STOP), "--interval", "8"
    )
