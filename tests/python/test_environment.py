"""The environment is the one that is pinned, and every importer in it starts on this machine."""

import importlib
import importlib.metadata
import platform
import re
import subprocess
import sys
from pathlib import Path

import pytest
from packaging.requirements import Requirement

REQUIREMENTS = Path(__file__).with_name("requirements.txt")


def requirements() -> list[Requirement]:
    lines = [re.sub(r"\s#.*", "", line).strip() for line in REQUIREMENTS.read_text(encoding="utf-8").splitlines()]
    return [Requirement(line) for line in lines if line and not line.startswith("#")]


def test_every_package_has_its_pinned_version_and_no_other_came_along():
    here = [requirement for requirement in requirements() if requirement.marker is None or requirement.marker.evaluate()]
    pinned = {requirement.name.lower().replace("_", "-"): requirement for requirement in here}
    installed = {
        package.metadata["Name"].lower().replace("_", "-"): package.version
        for package in importlib.metadata.distributions(path=[path for path in sys.path if "site-packages" in path])
    }
    # setuptools comes with the environment itself, on Python 3.11.
    assert set(installed) - {"setuptools"} == set(pinned)
    for name, requirement in pinned.items():
        assert requirement.specifier.contains(installed[name], prereleases=True), (name, installed[name])


# Each in a process of its own: an importer brings its own C++ libraries, which may not like one another's company.
@pytest.mark.parametrize(
    "module, install",
    [
        ("fmpy.simulation", None),
        ("casadi", None),
        ("ecospy", "apt-get install libtbb12"),
        ("fmu_manipulation_toolbox.container", None),
        ("libcosimpy.CosimExecution", None),
        ("pathsim.blocks.fmu", None),
    ],
)
def test_importer_starts(module: str, install: str | None):
    package = module.split(".")[0]
    if package == "libcosimpy" and (sys.platform == "darwin" or platform.machine() not in {"x86_64", "AMD64"}):
        pytest.skip("libcosimpy has no package for this platform")
    result = subprocess.run([sys.executable, "-c", f"import {module}"], capture_output=True, text=True)
    if result.returncode != 0 and install and "libtbb" in result.stderr:
        pytest.skip(f"{package} needs a system library: {install}")
    assert result.returncode == 0, result.stderr
