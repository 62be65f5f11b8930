"""The FMUs in FMPy, as a user runs them: validation, simulation through all four interfaces, start values, inputs from
a file, events, saved states and derivatives."""

import csv
import shutil
import subprocess
import sys
import zipfile

import numpy as np
import pytest
from fmpy import extract, read_model_description, simulate_fmu
from fmpy.util import create_plotly_figure
from fmpy.validation import validate_fmu
from instance import Instance

INTERFACES = ["CoSimulation", "ModelExchange"]


def references(fmu):
    return {variable.name: variable.valueReference for variable in read_model_description(fmu).modelVariables}


def simulate(fmu, interface="CoSimulation", **arguments):
    arguments.setdefault("stop_time", 600)
    arguments.setdefault("output_interval", 1)
    return simulate_fmu(fmu, fmi_type=interface, relative_tolerance=1e-9, **arguments)


def sawtooth(start):
    """Commands for a dive and a climb from the start values of a run."""
    down = (start["ballast_command_m3"], start["moving_mass_command_m"])
    up = (-down[0], -down[1])
    names = ["time", "ballast_command_m3", "moving_mass_command_m"]
    rows = [(0, *down), (500, *down), (500, *up), (1000, *up)]
    return np.array(rows, dtype=[(name, np.float64) for name in names])


def start_values(fmu):
    return {v.name: float(v.start) for v in read_model_description(fmu).modelVariables if v.start and v.type != "String"}


def test_validation_finds_nothing(fmu):
    assert validate_fmu(str(fmu)) == []
    done = subprocess.run([sys.executable, "-m", "fmpy", "validate", str(fmu)], capture_output=True, text=True)
    assert done.returncode == 0, done.stdout


def test_what_validation_does_not_see(fmu):
    """Starts within bounds, references and names unique, the binary under the name that the description gives."""
    description = read_model_description(fmu)
    seen = set()
    for variable in description.modelVariables:
        assert variable.valueReference not in seen
        seen.add(variable.valueReference)
        if variable.start and variable.min is not None and variable.type != "String":
            assert float(variable.min) <= float(variable.start) <= float(variable.max), variable.name
    for interface in (description.coSimulation, description.modelExchange):
        assert interface.modelIdentifier == "UnderwaterGlider"
    with zipfile.ZipFile(fmu) as archive:
        names = archive.namelist()
    stems = {name.rsplit("/", 1)[1].rsplit(".", 1)[0] for name in names if name.startswith("binaries/") and name[-1] != "/"}
    assert stems == {"UnderwaterGlider"}
    assert "documentation/index.html" in names


def test_the_bare_command_shows_a_steady_glide_down(fmu, tmp_path):
    out = tmp_path / "out.csv"
    command = [sys.executable, "-m", "fmpy", "simulate", str(fmu), "--output-file", str(out)]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    # Nothing is said but by the logger, which was not asked for events.
    assert done.stdout + done.stderr == ""
    with out.open() as file:
        rows = list(csv.DictReader(file))
    depth = [float(row["depth_m"]) for row in rows]
    expected = 10 + 0.3 * np.sin(np.deg2rad(25)) * 600
    assert float(rows[-1]["time"]) == 600 and abs(depth[-1] - expected) < 1e-6 * expected
    assert all(abs(float(row["glide_angle_rad"]) + np.deg2rad(25)) < 1e-9 for row in rows)


def test_the_plot_shows_every_output_with_its_unit(fmu):
    """As `--show-plot` draws those that it is given: FMPy gives up beyond 17 panels."""
    result = simulate_fmu(fmu)
    outputs = [v.name for v in read_model_description(fmu).modelVariables if v.causality == "output"]
    titles = set()
    for some in (outputs[:15], outputs[15:]):
        figure = create_plotly_figure(result, names=some)
        titles |= {figure.layout[axis].title.text for axis in figure.layout if axis.startswith("yaxis")}
    assert len(titles) == len(outputs)
    assert {title.split(" [")[0] for title in titles} == set(outputs)
    assert all(title.endswith("]") for title in titles), titles
    assert {"pitch_rad [deg]", "depth_m [m]", "energy_J [kJ]"} <= titles


def test_all_four_interfaces_fly_the_same_sawtooth(fmu2, fmu3):
    signals = sawtooth(start_values(fmu3))
    results = {}
    for fmu in (fmu2, fmu3):
        for interface in INTERFACES:
            results[fmu.name, interface] = simulate(fmu, interface, stop_time=1000, input=signals)
    reference = results[fmu3.name, "CoSimulation"]
    assert reference["depth_m"].max() > 70 and reference["depth_m"][-1] < 30
    for key, result in results.items():
        assert len(result) >= len(reference)
        for name in ("depth_m", "x_m", "pitch_rad", "v1_m_s", "ballast_mass_kg"):
            scale = np.abs(reference[name]).max()
            times, first = np.unique(result["time"], return_index=True)
            found = np.interp(reference["time"], times, result[name][first])
            # Event times apart, where the importer puts its own rows.
            apart = np.abs(reference["time"] - 500) > 2
            assert np.abs(found - reference[name])[apart].max() < 1e-6 * scale, (key, name)


def test_start_values_set_by_the_user_are_used_and_momentum_follows(fmu):
    outputs = ["v1_m_s", "PP1_kg_m_s", "PP3_kg_m_s", "moving_mass_position_3_m"]
    starts = {"v1_m_s": 0.2, "v3_m_s": -0.01, "moving_mass_height_m": 0.04, "pitch_rate_rad_s": 0.01}
    for interface in INTERFACES:
        result = simulate(fmu, interface, stop_time=1, start_values=starts, output=outputs)
        first = {name: result[name][0] for name in outputs}
        assert first["v1_m_s"] == 0.2
        assert first["moving_mass_position_3_m"] == 0.04
        assert first["PP1_kg_m_s"] == pytest.approx(9 * (0.2 + 0.04 * 0.01), rel=1e-14)
        assert first["PP3_kg_m_s"] == pytest.approx(9 * (-0.01 - 0.01983026804078783 * 0.01), rel=1e-12)


def test_inputs_come_from_a_file(fmu, tmp_path):
    signals = tmp_path / "in.csv"
    signals.write_text('"time","current_x_m_s"\n0,0\n100,0.5\n200,0.5\n')
    out = tmp_path / "out.csv"
    command = [sys.executable, "-m", "fmpy", "simulate", str(fmu), "--stop-time", "200", "--interface-type"]
    more = ["--input-file", str(signals), "--output-file", str(out), "--relative-tolerance", "1e-8"]
    every_second = {"CoSimulation": ["--output-interval", "1"], "ModelExchange": []}
    drifts = {}
    for interface in INTERFACES:
        done = subprocess.run([*command, interface, *more, *every_second[interface]], capture_output=True, text=True)
        assert done.returncode == 0, done.stdout + done.stderr
        with out.open() as file:
            last = list(csv.DictReader(file))[-1]
        still = simulate(fmu, interface, stop_time=200)["x_m"][-1]
        drifts[interface] = float(last["x_m"]) - still
    # The current carries the glider by its integral, 0.5 * 100 / 2 + 0.5 * 100 = 75 m. FMPy's co-simulation sets inputs at
    # communication points, here every second with the output interval, and they stand still between them: along
    # the ramp of 0.005 m/s2 that lasts 100 s they lag by half a step. Its model exchange sets them between the solver's
    # steps, which are shorter.
    lag = 0.005 * 0.5 * 100
    assert drifts["CoSimulation"] == pytest.approx(75 - lag, abs=1e-6)
    assert 75 - lag < drifts["ModelExchange"] <= 75 + 1e-6


@pytest.mark.parametrize("interface", INTERFACES)
def test_the_seabed_is_an_event(fmu, interface):
    shallow = {"seabed_depth_m": 60.0}
    shown = ["depth_m", "on_seabed"]
    result = simulate(fmu, interface, stop_time=1500, start_values=shallow, output_interval=5, output=shown)
    sink = 0.3 * np.sin(np.deg2rad(25))
    met = 50 / sink
    before, after = result[result["time"] < met - 1], result[result["time"] > met + 60]
    assert not before["on_seabed"].any()
    assert np.allclose(before["depth_m"], 10 + sink * before["time"], rtol=0, atol=1e-6)
    assert after["on_seabed"].all() and (np.abs(after["depth_m"] - 60) < 0.01).all()


def test_wrong_starts_are_refused_with_a_reason(fmu, tmp_path):
    for name, value in (("hull_mass_kg", "-1"), ("b", "nan"), ("water_density_kg_m3", "-1")):
        command = [sys.executable, "-m", "fmpy", "simulate", str(fmu), "--stop-time", "1"]
        done = subprocess.run([*command, "--start-values", name, value], capture_output=True, text=True)
        assert done.returncode != 0
        assert f"{name} = " in done.stdout and "expected" in done.stdout + "expected" * ("bounds" in done.stdout)


def test_a_saved_run_goes_on_bit_for_bit_in_another_instance_too(fmu, tmp_path):
    first = Instance(fmu, tmp_path / "first")
    first.set("ballast_command_m3", 5e-5)
    for i in range(10):
        first.step(float(i), 1.0)
    state = first.save()
    data = first.serialized(state)

    def go_on(instance):
        for i in range(10, 60):
            instance.step(float(i), 1.0)
        return [instance.get(name) for name in ("x_m", "depth_m", "pitch_rad", "v1_m_s", "PP3_kg_m_s")]

    expected = go_on(first)
    first.restore(state)
    assert go_on(first) == expected
    second = Instance(fmu, tmp_path / "second")
    second.restore(second.deserialized(data))
    assert go_on(second) == expected
    first.free()
    second.free()


def test_directional_derivatives_are_those_of_differences(fmu, tmp_path):
    instance = Instance(fmu, tmp_path / "fmu")
    instance.step(0.0, 1.0)
    unknowns = ["der(v1_m_s)", "der(v3_m_s)", "der(pitch_rate_rad_s)", "net_mass_kg", "lift_N"]
    for known, h in (("water_density_kg_m3", 1e-2), ("current_z_m_s", 1e-4), ("b", 1e-5), ("a_per_rad", 1e-4)):
        exact = instance.derivative(unknowns, [known], [1.0])
        here = instance.get(known)
        instance.set(known, here + h)
        above = [instance.get(name) for name in unknowns]
        instance.set(known, here - h)
        below = [instance.get(name) for name in unknowns]
        instance.set(known, here)
        numeric = (np.array(above) - np.array(below)) / (2 * h)
        assert np.allclose(exact, numeric, rtol=1e-6, atol=1e-9), known
    instance.free()


def test_many_instances_live_side_by_side(fmu, tmp_path):
    first, second = Instance(fmu, tmp_path / "a"), Instance(fmu, tmp_path / "b")
    first.set("ballast_command_m3", 1e-4)
    for i in range(20):
        first.step(float(i), 1.0)
        second.step(float(i), 1.0)
    assert second.get("depth_m") == pytest.approx(10 + 0.3 * np.sin(np.deg2rad(25)) * 20, rel=1e-12)
    assert first.get("depth_m") < second.get("depth_m") - 0.1
    first.free()
    second.free()


def test_a_folder_with_blanks_and_percent_signs_in_its_name_does_no_harm(fmu, tmp_path):
    folder = tmp_path / "my fmu 100% #1 ü"
    extract(str(fmu), unzipdir=folder)
    vehicle = folder / "resources" / "vehicle.toml"
    vehicle.write_text(vehicle.read_text().replace("moving_mass_height_m = 0.05", "moving_mass_height_m = 0.06"))
    description = read_model_description(folder)
    result = simulate_fmu(folder, stop_time=1, output=["moving_mass_height_m"])
    assert result["moving_mass_height_m"][0] == 0.06
    assert description.modelName == "UnderwaterGlider"
    shutil.rmtree(folder)
