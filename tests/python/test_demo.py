"""`glidepolar demo`, from the wheel alone: the fault that was hidden is named, and the extended vehicle's FMU flies the held-out dive."""

import html
import json
import os
import re
import subprocess
import time
import zipfile
from pathlib import Path

import jsonschema
import numpy as np
import pytest
from conftest import together

pytestmark = together("demo")

ROOT = Path(__file__).parents[2]
ENVIRONMENT = {name: value for name, value in os.environ.items() if not name.startswith("GLIDEPOLAR_")}


def demo(programs: Path, cwd: Path, *options) -> dict:
    command = [programs / "glidepolar", "demo", *options, "--json", "result.json"]
    done = subprocess.run([str(word) for word in command], cwd=cwd, env=ENVIRONMENT, capture_output=True, text=True, timeout=280)
    assert done.returncode == 0, done.stderr
    return json.loads((cwd / "result.json").read_text())


@pytest.fixture(scope="module")
def made(programs, tmp_path_factory) -> tuple[Path, dict, float]:
    """The demonstration with FMPy, its result, and the seconds of work that it took."""
    folder = tmp_path_factory.mktemp("demo")
    begin = os.times()
    result = demo(programs, folder)
    end = os.times()
    return folder / "glidepolar-demo", result, end.children_user + end.children_system - begin.children_user - begin.children_system


@pytest.fixture(scope="module")
def without(programs, tmp_path_factory) -> tuple[Path, dict]:
    """The demonstration without FMPy: the equations fly in the place of the FMU."""
    folder = tmp_path_factory.mktemp("demo-without")
    return folder / "there", demo(programs, folder, "there", "--python", "no-such-python")


def test_what_was_hidden_is_named_and_the_held_out_dive_is_predicted(made):
    folder, result, seconds = made
    jsonschema.validate(result, json.loads((ROOT / "docs/reference/schemas/demo.json").read_text()))
    (cause,) = result["causes"]
    (hidden,) = result["hidden"]
    low, high = cause["parameters"][hidden["parameter"]]["ci95"]
    assert cause["cause"] == "trapped_air" and low <= hidden["value"] <= high
    (cause,) = result["tank"]
    low, high = next(iter(cause["parameters"].values()))["ci95"]
    truth = result["tank_hidden"]
    assert cause["cause"] == truth["parameter"] and low <= truth["value"] <= high
    before, after = result["before"], result["after"]
    assert after["vertical_velocity_rms_m_s"] < 0.8 * before["vertical_velocity_rms_m_s"]
    assert after["depth_rms_m"] < 0.5 * before["depth_rms_m"]
    assert seconds < 20, f"{seconds:.1f} s of work"


def test_the_fmu_flies_what_the_equations_fly(made, without):
    folder, with_fmpy, _ = made
    there, without = without
    assert with_fmpy["flown_by_fmpy"] and zipfile.ZipFile(folder / "Extended.fmu").testzip() is None
    flown = np.genfromtxt(folder / "flight/held-out-flown.csv", delimiter=",", names=True)
    assert flown["depth_m"].max() > 50
    assert not without["flown_by_fmpy"] and not (there / "flight/held-out-flown.csv").exists()
    # FMPy holds the inputs of a co-simulation from one output to the next, the equations take them between two rows: at
    # a quarter of a second the two dives are 1.5 cm apart.
    for key, value in with_fmpy["after"].items():
        assert without["after"][key] == pytest.approx(value, rel=0.02), key


def test_the_page_leads_to_all_others_and_its_commands_repeat_it(programs, made):
    folder, _, _ = made
    page = (folder / "report.html").read_text(encoding="utf-8")
    links = [html.unescape(link) for link in re.findall(r'href="([^"#][^":]*)"', page)]
    assert {"tank/report.html", "diagnosis/report.html", "extended.toml"} <= set(links)
    assert all((folder / link).is_file() for link in links)
    commands = re.search(r"The commands.*?<code>(.*?)</code>", page, re.DOTALL)[1].splitlines()
    assert len(commands) == 5 and str(folder) not in page.split('id="repeat"')[0]
    (repeated,) = [line for line in commands if line.startswith("tank-reduce") and "--diagnose" in line]
    subprocess.run([programs / "tank-reduce", *repeated.split()[1:]], cwd=folder, check=True, capture_output=True)


def test_a_second_demonstration_replaces_the_first_and_nothing_else(programs, made, tmp_path):
    folder, _, _ = made
    begin = time.time()
    demo(programs, folder.parent)
    assert (folder / "report.html").stat().st_mtime >= begin - 1
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine/thesis.txt").write_text("years of work")
    done = subprocess.run([programs / "glidepolar", "demo", "mine"], cwd=tmp_path, env=ENVIRONMENT, capture_output=True, text=True)
    assert done.returncode == 2 and "no earlier demonstration" in done.stderr
    assert [file.name for file in (tmp_path / "mine").iterdir()] == ["thesis.txt"]
