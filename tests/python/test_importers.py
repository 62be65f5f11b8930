"""Other programs fly the FMUs along a mission, in the plane and in space, and must arrive where the command line does."""

import json
import shutil
import subprocess
import sys
import textwrap
from pathlib import Path

import numpy as np
import pytest
from conftest import path_from
from flights import FLIGHTS, STEP, STOP, assert_same, read
from fmpy import simulate_fmu

ARCHIVES = {
    ("plane", 3): "GLIDEPOLAR_FMU3",
    ("plane", 2): "GLIDEPOLAR_FMU2",
    ("space", 3): "GLIDEPOLAR_SPACE_FMU3",
    ("space", 2): "GLIDEPOLAR_SPACE_FMU2",
}
EACH = pytest.mark.parametrize(("model", "version"), ARCHIVES, ids=[f"{model}-fmi{version}" for model, version in ARCHIVES])
EACH_MODEL = pytest.mark.parametrize("model", FLIGHTS)


def archive(model: str, version: int) -> Path:
    return path_from(ARCHIVES[model, version])


def assert_arrives(output: Path, flown, model: str, first: int = 0) -> None:
    """The rows of a file are those of the command line, from that of this number on."""
    reference = {name: values[first:] for name, values in flown[model].items()}
    assert_same(read(output), reference, FLIGHTS[model].outputs)


def run_alone(script: str, *arguments) -> str:
    """Runs a script in a process of its own: these programs bring C++ libraries that may end the process, and that may
    not like one another's company."""
    command = [sys.executable, "-c", textwrap.dedent(script), *map(str, arguments)]
    result = subprocess.run(command, capture_output=True, text=True, timeout=280, cwd=Path(__file__).parent)
    assert result.returncode == 0, f"exit {result.returncode}\n{result.stdout}\n{result.stderr}"
    return result.stdout


@pytest.mark.parametrize("interface", ["CoSimulation", "ModelExchange"])
@EACH
def test_fmpy_command(model, version, interface, flown, tmp_path):
    output = tmp_path / "flown.csv"
    options = ["--interface-type", interface, "--stop-time", STOP, "--output-interval", STEP, "--relative-tolerance", 1e-10]
    options += ["--input-file", FLIGHTS[model].inputs, "--output-file", output]
    command = [sys.executable, "-m", "fmpy", "simulate", archive(model, version), "--validate", *options]
    result = subprocess.run([*map(str, command)], capture_output=True, text=True, timeout=280)
    assert result.returncode == 0, result.stdout + result.stderr
    assert_arrives(output, flown, model)


ECOS = """
    import csv, sys
    from ecospy import EcosSimulation, EcosSimulationStructure
    from flights import FLIGHTS, STEP, STOP, TURN

    fmu, output, flight = sys.argv[1], sys.argv[2], FLIGHTS[sys.argv[3]]
    with EcosSimulationStructure() as structure:
        structure.add_model("glider", fmu)
        structure.add_parameter_set("descent", {f"glider::{name}": value for name, value in flight.commands(0).items()})
        with EcosSimulation(structure=structure, step_size=STEP) as simulation, open(output, "w") as file:
            simulation.init(parameter_set="descent")
            writer = csv.writer(file)
            writer.writerow(["time", *flight.outputs])
            while True:
                time = simulation.get_time()
                writer.writerow([time, *(repr(simulation.get_real(f"glider::{name}")) for name in flight.outputs)])
                if time >= STOP - 1e-6:
                    break
                if abs(time - TURN) < 1e-6:
                    for name, value in flight.commands(2).items():
                        simulation.set_real(f"glider::{name}", value)
                simulation.step()
            simulation.terminate()
"""


@EACH
def test_ecos(model, version, flown, tmp_path):
    output = tmp_path / "flown.csv"
    probe = subprocess.run([sys.executable, "-c", "import ecospy"], capture_output=True, text=True)
    if probe.returncode != 0 and "libtbb" in probe.stderr:
        pytest.skip("ecospy needs a system library: apt-get install libtbb12")
    run_alone(ECOS, archive(model, version), output, model)
    assert_arrives(output, flown, model)


LIBCOSIM = """
    import csv, sys
    from libcosimpy.CosimExecution import CosimExecution
    from libcosimpy.CosimManipulator import CosimManipulator
    from libcosimpy.CosimObserver import CosimObserver
    from libcosimpy.CosimSlave import CosimLocalSlave
    from fmpy import read_model_description
    from flights import FLIGHTS, STEP, STOP, TURN

    fmu, output, flight = sys.argv[1], sys.argv[2], FLIGHTS[sys.argv[3]]
    references = {v.name: v.valueReference for v in read_model_description(fmu).modelVariables}
    execution = CosimExecution.from_step_size(int(STEP * 1e9))
    glider = execution.add_local_slave(CosimLocalSlave(fmu_path=fmu, instance_name="glider"))
    for name, value in flight.commands(0).items():
        execution.real_initial_value(glider, references[name], value)
    observer, manipulator = CosimObserver.create_last_value(), CosimManipulator.create_override()
    execution.add_observer(observer)
    execution.add_manipulator(manipulator)
    outputs = [references[name] for name in flight.outputs]
    with open(output, "w") as file:
        writer = csv.writer(file)
        writer.writerow(["time", *flight.outputs])
        for count in range(1, round(STOP / STEP) + 1):
            if count - 1 == round(TURN / STEP):
                up = flight.commands(2)
                manipulator.slave_real_values(glider, [references[name] for name in up], list(up.values()))
            assert execution.step()
            writer.writerow([count * STEP, *map(repr, observer.last_real_values(glider, outputs))])
"""


@EACH_MODEL
def test_libcosim(model, flown, tmp_path):
    pytest.importorskip("libcosimpy", reason="libcosimpy has no package for this platform")
    output = tmp_path / "flown.csv"
    run_alone(LIBCOSIM, archive(model, 2), output, model)
    # It shows values after a step only, not those at the start.
    assert_arrives(output, flown, model, first=1)


CASADI = """
    import csv, sys, zipfile
    import casadi
    import numpy as np
    from flights import FLIGHTS, STEP, STOP, TURN

    fmu, output, folder, flight = sys.argv[1], sys.argv[2], sys.argv[3], FLIGHTS[sys.argv[4]]
    zipfile.ZipFile(fmu).extractall(folder)
    model = casadi.DaeBuilder("glider", folder)
    states, inputs = model.x(), model.u()
    right_hand_side = model.create("f", ["x", "u"], ["ode"])
    # Its outputs are numbers; flags are beyond it.
    model.set_y(flight.outputs)
    observe = model.create("g", ["x", "u"], ["y"])
    x, u = casadi.MX.sym("x", len(states)), casadi.MX.sym("u", len(inputs))
    problem = {"x": x, "u": u, "ode": right_hand_side(x, u)}
    options = {"abstol": 1e-12, "reltol": 1e-10, "max_num_steps": 100000}

    state = np.array(model.start(states), dtype=float)
    rows, time = [], 0.0
    for row, until in ((0, TURN), (2, STOP)):
        held = dict(zip(inputs, np.array(model.start(inputs), dtype=float)))
        held.update(flight.commands(row))
        held = np.array([held[name] for name in inputs])
        grid = np.arange(time, until + STEP / 2, STEP)
        # CVODES, with the Jacobian from the FMU's own directional derivatives. The servos' corners come soon after the
        # set-points change; there the integration starts anew.
        integrate = casadi.integrator("flight", "cvodes", problem, 0.0, grid - time, options)
        course = np.array(integrate(x0=state, u=np.tile(held[:, None], len(grid)))["xf"])
        for instant, column in zip(grid, course.T):
            rows.append([instant, *(repr(float(value)) for value in np.array(observe(column, held)).ravel())])
        state, time = course[:, -1], until
    with open(output, "w") as file:
        writer = csv.writer(file)
        writer.writerow(["time", *flight.outputs])
        writer.writerows(rows)
"""


@EACH
def test_casadi(model, version, flown, tmp_path):
    output = tmp_path / "flown.csv"
    run_alone(CASADI, archive(model, version), output, tmp_path / "unpacked", model)
    assert_arrives(output, flown, model)


@EACH_MODEL
def test_container(model, flown, tmp_path):
    """Both FMUs of a model inside one FMU, on the same set-points."""
    flight = FLIGHTS[model]
    names = [shutil.copy(archive(model, version), tmp_path / f"glider{version}.fmu").name for version in (3, 2)]
    description = {
        "name": "both.fmu",
        "fmu": names,
        "step_size": STEP,
        "auto_link": False,
        "auto_output": False,
        "input": [[port, name, port] for name in names for port in flight.commands(0)],
        "output": [[name, output, f"{name[:7]}_{output}"] for name in names for output in flight.outputs],
    }
    (tmp_path / "both.json").write_text(json.dumps(description))
    fmucontainer = Path(sys.executable).with_name("fmucontainer")
    command = [fmucontainer, "-container", "both.json", "-fmi", "3", "-fmu-directory", "."]
    built = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=120)
    assert (tmp_path / "both.fmu").exists(), built.stdout + built.stderr

    signals = np.genfromtxt(flight.inputs, delimiter=",", names=True)
    container = str(tmp_path / "both.fmu")
    result = simulate_fmu(container, stop_time=STOP, step_size=STEP, output_interval=STEP, input=signals)
    for name in names:
        columns = {output: result[f"{name[:7]}_{output}"] for output in flight.outputs}
        assert_same({"time": result["time"], **columns}, flown[model], flight.outputs)


PATHSIM = """
    import csv, sys, warnings
    warnings.simplefilter("ignore", DeprecationWarning)
    from fmpy import read_model_description
    from pathsim import Connection, Simulation
    from pathsim.blocks import Constant, Scope, StepSource
    from pathsim.blocks.fmu import CoSimulationFMU, ModelExchangeFMU
    from pathsim.solvers import RKDP87
    from flights import FLIGHTS, STEP, STOP, TURN

    fmu, output, interface, flight = sys.argv[1], sys.argv[2], sys.argv[3], FLIGHTS[sys.argv[4]]
    description = read_model_description(fmu)
    inputs = [v for v in description.modelVariables if v.causality == "input"]
    outputs = [v.name for v in description.modelVariables if v.causality == "output"]
    down, up = flight.commands(0), flight.commands(2)

    def signal(variable):
        start, end = (values.get(variable.name, float(variable.start)) for values in (down, up))
        # A jump is an event of PathSim's: inside the function of a Source the step control meets it with steps below the
        # spacing of the time's numbers, and never gets by.
        return Constant(start) if start == end else StepSource(amplitude=[start, end], tau=[0.0, TURN - 1e-9])

    sources = [signal(variable) for variable in inputs]
    if interface == "CoSimulation":
        # Nothing is integrated but in the FMU: between its steps there is nothing to see.
        glider, options = CoSimulationFMU(fmu, dt=STEP), {"dt": STEP / 8}
    else:
        glider = ModelExchangeFMU(fmu)
        options = {"dt": 0.01, "tolerance_lte_rel": 1e-10, "tolerance_lte_abs": 1e-12, "dt_max": 4.0}
    scope = Scope(labels=flight.outputs, sampling_period=STEP)
    wires = [Connection(source, glider[i]) for i, source in enumerate(sources)]
    wires += [Connection(glider[outputs.index(name)], scope[i]) for i, name in enumerate(flight.outputs)]
    simulation = Simulation([*sources, glider, scope], wires, Solver=RKDP87, log=False, **options)
    simulation.run(STOP + STEP / 2)
    time, values = scope.read()
    if interface == "CoSimulation":
        # PathSim does a step at its beginning: it shows at each time what the FMU has a step later.
        time = time + STEP
    with open(output, "w") as file:
        writer = csv.writer(file)
        writer.writerow(["time", *flight.outputs])
        writer.writerows(zip(time, *values))
"""


@pytest.mark.parametrize("interface", ["CoSimulation", "ModelExchange"])
@EACH
def test_pathsim(model, version, interface, flown, tmp_path):
    output = tmp_path / "flown.csv"
    run_alone(PATHSIM, archive(model, version), output, interface, model)
    assert_arrives(output, flown, model, first=1 if interface == "CoSimulation" else 0)
