"""Flies FMUs through FMPy: fmpy_flight.py WORK FMU... ; FMU number k is flown on {"fmu": k, ...}.

An entry `slave:METHOD` is no file: it is the PythonFMU3 slave, built here with that method of solve_ivp from WORK's
parameters.json.
"""

import json
import shutil
import subprocess
import sys
import time
from pathlib import Path

import fmpy
from fmpy.fmi3 import FMU3Slave
from fmpy.fmi2 import FMU2Slave
from glider_equations import NOMINALS, STATES
from turns import serve

HERE = Path(__file__).parent


def build_slave(work: Path, method: str) -> Path:
    folder = work / f"slave-{method}"
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    given = json.loads((work / "parameters.json").read_text())
    given["method"] = method
    (folder / "parameters.json").write_text(json.dumps(given))
    for name in ["glider_slave.py", "glider_equations.py"]:
        shutil.copy(HERE / name, folder / name)
    build = [sys.executable, "-m", "pythonfmu3", "build", "-f", "glider_slave.py", "-d", ".", "glider_equations.py"]
    done = subprocess.run(build + ["parameters.json"], cwd=folder, capture_output=True, text=True)
    made = list(folder.glob("*.fmu"))
    if done.returncode != 0 or not made:
        raise RuntimeError(f"pythonfmu3 build: {done.stderr.strip().splitlines()[-1:]}")
    return made[0]


class Flown:
    """An archive, unpacked once."""

    def __init__(self, path: Path):
        self.folder = fmpy.extract(str(path))
        self.description = fmpy.read_model_description(self.folder, validate=False)
        self.references = {v.name: v.valueReference for v in self.description.modelVariables}

    def fly(self, legs: int, leg_s: float, step_s: float, tolerance: float) -> dict:
        is_3 = self.description.fmiVersion.startswith("3")
        slave = (FMU3Slave if is_3 else FMU2Slave)(
            guid=self.description.guid,
            unzipDirectory=self.folder,
            modelIdentifier=self.description.coSimulation.modelIdentifier,
            instanceName="flown",
        )
        slave.instantiate()
        if is_3:
            slave.enterInitializationMode(tolerance=tolerance, startTime=0.0)
        else:
            slave.setupExperiment(tolerance=tolerance, startTime=0.0)
            slave.enterInitializationMode()
        slave.exitInitializationMode()
        get, set_ = (slave.getFloat64, slave.setFloat64) if is_3 else (slave.getReal, slave.setReal)
        commands = [self.references[name] for name in ["ballast_command_m3", "moving_mass_command_m"]]
        base = get(commands)
        steps = round(leg_s / step_s)
        begin = time.perf_counter()
        for leg in range(legs):
            sign = 1.0 if leg % 2 == 0 else -1.0
            set_(commands, [sign * value for value in base])
            for step in range(steps):
                slave.doStep(leg * leg_s + step * step_s, step_s)
        seconds = time.perf_counter() - begin
        states = get([self.references[name] for name in STATES])
        slave.terminate()
        slave.freeInstance()
        return {"seconds": seconds / legs, "states": list(states), "nominals": list(NOMINALS)}


def main(work: Path, entries: list[str]) -> None:
    flown: dict[int, Flown] = {}

    def handle(question: dict) -> dict:
        number = question["fmu"]
        if number not in flown:
            _, _, method = entries[number].partition("slave:")
            flown[number] = Flown(build_slave(work, method) if method else Path(entries[number]))
        return flown[number].fly(question["legs"], question["leg_s"], question["step_s"], question["tolerance"])

    serve(handle)


if __name__ == "__main__":
    main(Path(sys.argv[1]), sys.argv[2:])
