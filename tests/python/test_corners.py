"""Model Exchange under CVODE, LSODA, BDF, Radau and Euler's method: a selection of the corners that `corners.py` flies."""

import corners
import numpy as np
import pytest
from conftest import path_from, together
from fmpy import extract, read_model_description, simulate_fmu

ARCHIVES = {
    "plane-fmi3": "GLIDEPOLAR_FMU3",
    "plane-fmi2": "GLIDEPOLAR_FMU2",
    "space-fmi3": "GLIDEPOLAR_SPACE_FMU3",
    "space-fmi2": "GLIDEPOLAR_SPACE_FMU2",
}
# Method, tolerance and output interval, s. FMPy gives CVODE 500 internal steps to an output, whatever the tolerance.
SELECTION = [
    ("CVODE", 1e-4, 1.0),
    ("CVODE", 1e-4, 600.0),
    ("CVODE", 1e-7, 60.0),
    ("CVODE", 1e-8, 60.0),
    ("CVODE", 1e-10, 1.0),
    ("LSODA", 1e-4, 600.0),
    ("LSODA", 1e-10, 1.0),
    ("BDF", 1e-4, 600.0),
    ("BDF", 1e-8, 1.0),
    ("Radau", 1e-4, 1.0),
    ("Radau", 1e-6, 600.0),
]


@pytest.fixture(params=[pytest.param(name, marks=together(f"corners-{name}")) for name in ARCHIVES], scope="module")
def folder(request, tmp_path_factory):
    """The unpacked archive."""
    return extract(str(path_from(ARCHIVES[request.param])), unzipdir=str(tmp_path_factory.mktemp("archive")))


@pytest.fixture(scope="module")
def own(folder) -> dict[str, np.ndarray]:
    """Where the library's own integrator ends."""
    description = read_model_description(folder)
    names = [state.name for state in corners.states_of(description)]
    ends = {}
    for name, mission in corners.missions(description).items():
        rows = simulate_fmu(
            folder,
            stop_time=mission.stop,
            output_interval=1.0,
            relative_tolerance=1e-10,
            start_values=mission.start | mission.at(0.0) | mission.choices,
            input=mission.signals(),
            output=names,
        )
        ends[name] = np.array([rows[-1][state] for state in names])
    return ends


@pytest.mark.parametrize(("method", "tolerance", "interval"), SELECTION)
def test_surface_seabed_and_limits_are_flown(folder, own, method, tolerance, interval):
    description = read_model_description(folder)
    depth = corners.depth_of(description)
    for name, mission in corners.missions(description).items():
        end = corners.fly(folder, mission, method, tolerance, interval).states
        assert np.isfinite(end).all()
        # A dive of 60 m: what a step may lose, times some hundred steps.
        apart = abs(end[depth] - own[name][depth])
        assert apart < 60 * max(300 * tolerance, 1e-5), f"{name}: {end[depth]} m against {own[name][depth]} m"


def test_euler_is_stable_in_a_dive_with_steps_of_50_ms(folder):
    for name, apart in corners.euler_in_a_dive(folder).items():
        assert apart < 1e-2, name


def test_cvode_at_1e_10_needs_more_than_500_steps_for_a_leg_change_in_mid_water(folder):
    """Why outputs ten minutes apart fail in FMPy at this tolerance: no contact takes part."""
    most = corners.internal_steps(folder, corners.LEG_CHANGE, 1e-10, 1000.0)
    description = read_model_description(folder)
    rows = corners.simulate_by_cvode(folder, corners.LEG_CHANGE, 1e-4, 10.0, ["depth_m"])
    assert rows["depth_m"].min() > 1, description.modelName
    assert 500 < max(most.values()) < 800, most
    # Outputs a second apart are far from the limit.
    assert max(corners.internal_steps(folder, corners.LEG_CHANGE, 1e-10, 1.0).values()) < 250
