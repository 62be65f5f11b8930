"""The same glider as a PythonFMU3 slave: what a user without this project would write to have it as an FMU.

Built by `pythonfmu3 build` together with glider_equations.py and parameters.json (the numbers that the library's own FMU
starts from: start of the states, parameters, SciPy's method, tolerance).
"""

import json
from pathlib import Path

import numpy as np
from glider_equations import STATES, Glider
from pythonfmu3 import Fmi3Causality, Fmi3Slave, Fmi3Variability, Float64


class GliderSlave(Fmi3Slave):
    author = "glidepolar"
    description = "An underwater glider by solve_ivp"

    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        file = Path(__file__).parent / "parameters.json"
        given = json.loads(file.read_text())
        self.method, self.tolerance = given["method"], given["tolerance"]
        self.glider = Glider(given["parameters"])
        self.y = np.array([given["start"][name] for name in STATES])
        self.time = 0.0
        self.ballast_command_m3 = given["start"]["ballast_command_m3"]
        self.moving_mass_command_m = given["start"]["moving_mass_command_m"]
        self.register_variable(
            Float64("time", causality=Fmi3Causality.independent, variability=Fmi3Variability.continuous)
        )
        for name in ["ballast_command_m3", "moving_mass_command_m"]:
            self.register_variable(Float64(name, causality=Fmi3Causality.input))
        for index, name in enumerate(STATES):
            self.register_variable(
                Float64(name, causality=Fmi3Causality.output, getter=lambda i=index: float(self.y[i]))
            )

    def do_step(self, current_time, step_size):
        self.glider.ballast_command = self.ballast_command_m3
        self.glider.moving_mass_command = self.moving_mass_command_m
        self.y = self.glider.advance(current_time, self.y, step_size, self.method, self.tolerance)
        self.time = current_time + step_size
        return True
