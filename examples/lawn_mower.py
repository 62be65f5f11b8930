"""Fly a lawn-mower pattern in FMPy with the glider in six degrees of freedom.

The script is the glider's pilot: it turns the dives round, and gives a heading from waypoint to waypoint. The rudder follows
the heading inside the FMU (steering 1) or, with `--outside`, by a controller here. A current sets the glider aside.

    python examples/lawn_mower.py UnderwaterGlider3D.fmu
"""

import argparse
import math
import shutil

import numpy as np
from fmpy import extract, read_model_description
from fmpy.fmi3 import FMU3Slave

STEP_S = 10.0
DEEP_M, SHALLOW_M = 60.0, 15.0
REACHED_M = 150.0
WAYPOINTS_M = [(1000, 0), (1000, 400), (0, 400), (0, 800), (1000, 800)]
CURRENT_M_S = (0.02, 0.05)


class Glider:
    """An instance of the FMU whose variables are read and set by name."""

    def __init__(self, archive, parameters):
        description = read_model_description(archive)
        self.folder = extract(archive)
        self.references = {variable.name: variable.valueReference for variable in description.modelVariables}
        self.fmu = FMU3Slave(
            guid=description.guid,
            unzipDirectory=self.folder,
            modelIdentifier=description.coSimulation.modelIdentifier,
            instanceName="survey",
        )
        self.fmu.instantiate()
        for name, value in parameters.items():
            set_value = self.fmu.setInt64 if name == "steering" else self.fmu.setFloat64
            set_value([self.references[name]], [value])
        self.fmu.enterInitializationMode(startTime=0.0)
        self.fmu.exitInitializationMode()

    def get(self, *names):
        return self.fmu.getFloat64([self.references[name] for name in names])

    def set(self, **values):
        self.fmu.setFloat64([self.references[name] for name in values], list(values.values()))

    def close(self):
        self.fmu.terminate()
        self.fmu.freeInstance()
        shutil.rmtree(self.folder, ignore_errors=True)


def shortest(angle):
    """The same angle within half a turn."""
    return (angle + math.pi) % (2 * math.pi) - math.pi


def survey(archive, outside=False, most_s=60_000):
    """Flies the pattern. Returns time, north, east and depth row by row, and how many waypoints were reached."""
    glider = Glider(archive, {"steering": 0 if outside else 1})
    try:
        down = glider.get("ballast_command_m3", "moving_mass_command_m")
        up = [-value for value in down]
        glider.set(current_north_m_s=CURRENT_M_S[0], current_east_m_s=CURRENT_M_S[1])
        rows, reached, diving, time = [], 0, True, 0.0
        while reached < len(WAYPOINTS_M) and time < most_s:
            north, east, depth, heading = glider.get("north_m", "east_m", "depth_m", "heading_rad")
            rows.append((time, north, east, depth))
            to_north, to_east = (waypoint - here for waypoint, here in zip(WAYPOINTS_M[reached], (north, east)))
            if math.hypot(to_north, to_east) < REACHED_M:
                reached += 1
                continue
            course = math.atan2(to_east, to_north)
            if outside:
                glider.set(rudder_command_rad=float(np.clip(0.3 * shortest(course - heading), -0.4, 0.4)))
            else:
                glider.set(heading_command_rad=course)
            if diving and depth > DEEP_M or not diving and depth < SHALLOW_M:
                diving = not diving
                ballast, mass = down if diving else up
                glider.set(ballast_command_m3=ballast, moving_mass_command_m=mass)
            glider.fmu.doStep(currentCommunicationPoint=time, communicationStepSize=STEP_S)
            time += STEP_S
        return np.array(rows), reached
    finally:
        glider.close()


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("fmu", help="UnderwaterGlider3D.fmu (`glidepolar fmu --3d`)")
    arguments.add_argument("--outside", action="store_true", help="hold the heading by a controller in this script")
    given = arguments.parse_args()
    rows, reached = survey(given.fmu, given.outside)
    print(f"{reached} of {len(WAYPOINTS_M)} waypoints in {rows[-1, 0] / 3600:.2f} h, largest depth {rows[:, 3].max():.1f} m")


if __name__ == "__main__":
    main()
