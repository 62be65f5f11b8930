"""gliderflight's own calibration on its own data: gliderflight_calibration.py gliderflight_data.npy.

{"model": "steady"} or {"model": "dynamic", "budget_s": N}: drag coefficient and mass on the depth rate, settings and mask
as the package's own example has them. With a budget the calibration is stopped where it runs out, and says so.
"""

import sys
import time

import gliderflight
import numpy as np
from turns import serve

TIME, PRESSURE, PITCH, DRIVE, DENSITY, _ = np.load(sys.argv[1])


class OutOfTime(Exception):
    pass


class Clock:
    """What the calibration may take, and what it took; the models themselves travel between processes."""

    end = float("inf")
    evaluations = 0


class Clocked:
    def cost_function(self, *arguments):
        if time.perf_counter() > Clock.end:
            raise OutOfTime
        Clock.evaluations += 1
        return super().cost_function(*arguments)


class Steady(Clocked, gliderflight.SteadyStateCalibrate):
    pass


class Dynamic(Clocked, gliderflight.DynamicCalibrate):
    pass


def handle(question: dict) -> dict:
    is_steady = question["model"] == "steady"
    model = Steady(rho0=1004) if is_steady else Dynamic(rho0=1004, k1=0.2, k2=0.98, dt=1.0)
    begin = time.perf_counter()
    Clock.end, Clock.evaluations = begin + question.get("budget_s", float("inf")), 0
    model.define(ah=3.8, Cd1=10.5)
    model.set_input_data(time=TIME, pressure=PRESSURE, pitch=PITCH, buoyancy_change=DRIVE, density=DENSITY)
    model.OR(PRESSURE * 10 < 10)
    model.OR(PRESSURE * 10 > 35)
    model.define(Cd0=0.15, mg=70, Vg=70 / 1004)
    try:
        found, finished = model.calibrate("Cd0", "mg"), True
    except OutOfTime:
        found, finished = {}, False
    seconds = time.perf_counter() - begin
    return {"seconds": seconds, "finished": finished, "evaluations": Clock.evaluations, "samples": len(TIME), **found}


if __name__ == "__main__":
    serve(handle)
