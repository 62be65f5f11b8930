"""The FMUs of the glider in six degrees of freedom in FMPy: validation, both interfaces, the plane inside them, a survey."""

import importlib.util
from pathlib import Path

import numpy as np
import pytest
from conftest import path_from
from fmpy import read_model_description, simulate_fmu
from fmpy.validation import validate_fmu

EXAMPLES = Path(__file__).parents[2] / "examples"


@pytest.fixture(params=["GLIDEPOLAR_SPACE_FMU3", "GLIDEPOLAR_SPACE_FMU2"], ids=["fmi3", "fmi2"])
def space(request) -> Path:
    """Each of the two archives in turn."""
    return path_from(request.param)


def turn(fmu, interface, **arguments):
    arguments.setdefault("stop_time", 400)
    arguments.setdefault("output_interval", 2)
    names = ["north_m", "east_m", "depth_m", "roll_rad", "pitch_rad", "heading_rad", "turn_rate_rad_s", "energy_J"]
    return simulate_fmu(
        fmu, fmi_type=interface, relative_tolerance=1e-9, start_values={"rudder_command_rad": 0.2}, output=names, **arguments
    )


def test_validation_finds_nothing(space):
    assert validate_fmu(str(space)) == []
    description = read_model_description(space)
    for interface in (description.coSimulation, description.modelExchange):
        assert interface.modelIdentifier == "UnderwaterGlider3D"
    for variable in description.modelVariables:
        if variable.start and variable.min is not None and variable.type != "String":
            assert float(variable.min) <= float(variable.start) <= float(variable.max), variable.name


def test_both_interfaces_fly_the_same_turn(space):
    own, other = turn(space, "CoSimulation"), turn(space, "ModelExchange")
    # Model Exchange has rows at events, too: the corners of the rudder's servo.
    other = other[np.searchsorted(other["time"], own["time"])]
    assert np.array_equal(other["time"], own["time"])
    for name in own.dtype.names[1:]:
        size = max(1.0, np.abs(own[name]).max())
        assert np.abs(own[name] - other[name]).max() < 1e-5 * size, name
    # A rudder to starboard turns the bow to starboard, and the turn becomes steady.
    assert own["heading_rad"][-1] > 2
    assert np.ptp(own["turn_rate_rad_s"][-50:]) < 1e-6


def test_the_turn_is_the_steady_turn_of_the_command_line(space, glidepolar):
    import json
    import subprocess

    end = turn(space, "CoSimulation", stop_time=900)[-1]
    net = simulate_fmu(space, stop_time=1, output=["net_mass_kg", "moving_mass_position_m"])[-1]
    command = [glidepolar, "turn", "slocum-graver", "--rudder-deg", str(np.rad2deg(0.2)), "--json", "-"]
    command += ["--net-mass-kg", repr(float(net["net_mass_kg"])), "--moving-mass-m", repr(float(net["moving_mass_position_m"]))]
    turns = json.loads(subprocess.run(command, capture_output=True, text=True, check=True).stdout)["turns"]
    assert turns[0]["stable"]
    assert abs(turns[0]["turn_rate_rad_s"] - end["turn_rate_rad_s"]) < 1e-6
    assert abs(turns[0]["roll_rad"] - end["roll_rad"]) < 1e-6


@pytest.mark.parametrize("outside", [False, True], ids=["heading inside", "heading outside"])
def test_a_lawn_mower_pattern_is_flown(outside):
    fmu = path_from("GLIDEPOLAR_SPACE_FMU3")
    spec = importlib.util.spec_from_file_location("lawn_mower", EXAMPLES / "lawn_mower.py")
    example = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(example)
    rows, reached = example.survey(fmu, outside)
    assert reached == len(example.WAYPOINTS_M)
    assert rows[:, 3].max() < example.DEEP_M + 25 and rows[:, 3].min() > 0
