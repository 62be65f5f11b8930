"""The glider in the vertical plane as a user of SciPy would write it: Leonard and Graver's equations with servos.

Written from docs and papers, not from the library: no mechanism, no surface, no seabed, nothing that this flight does
not meet. Units are SI; the order of the states is that of the FMU. `p` holds the parameters by the FMU's names.
"""

import math

import numpy as np
from scipy.integrate import solve_ivp

STATES = [
    "x_m",
    "depth_m",
    "pitch_rad",
    "pitch_rate_rad_s",
    "v1_m_s",
    "v3_m_s",
    "moving_mass_position_m",
    "moving_mass_position_3_m",
    "PP1_kg_m_s",
    "PP3_kg_m_s",
    "ballast_mass_kg",
    "energy_J",
]
# Sizes that the tolerance is meant on, as in the FMU's description.
NOMINALS = np.array([100.0, 10.0, 0.1, 0.01, 0.1, 0.01, 0.01, 0.01, 1.0, 0.1, 0.1, 1000.0])


class Glider:
    """The right-hand side with its numbers made ready."""

    def __init__(self, p: dict[str, float]):
        self.p = p
        self.rho = p["reference_density_kg_m3"]
        self.ballast_command = 0.0
        self.moving_mass_command = 0.0

    def rates(self, t, y):
        p, rho = self.p, self.rho
        _, _, pitch, rate, v1, v3, r1, r3, pp1, pp3, mb, _ = y
        s, c = math.sin(pitch), math.cos(pitch)
        m = p["moving_mass_kg"]
        m1 = p["hull_mass_kg"] + mb + p["added_mass_1_kg"]
        m3 = p["hull_mass_kg"] + mb + p["added_mass_3_kg"]
        inertia = p["pitch_inertia_kg_m2"]
        g = p["gravity_m_s2"]

        # Lift, drag and moment from the coefficients.
        v2 = v1 * v1 + v3 * v3
        v = math.sqrt(v2)
        alpha = math.atan2(v3, v1)
        q_area = 0.5 * rho * v2 * p["frontal_area_m2"]
        lift = q_area * p["a_per_rad"] * alpha
        drag = q_area * (p["b"] + p["c_per_rad2"] * alpha * alpha)
        moment = (
            q_area * p["length_m"] * p["d_per_rad"] * alpha
            + p["pitch_damping_N_m_s"] * rate
            + p["pitch_damping_quadratic_N_m_s2"] * rate * abs(rate)
            - (p["added_mass_3_kg"] - p["added_mass_1_kg"]) * alpha * v2
        )
        lift_v, drag_v = (lift / v, drag / v) if v > 0.0 else (0.0, 0.0)
        weight = (p["hull_mass_kg"] + m + mb - p["displaced_mass_kg"]) * g

        r1_dot = pp1 / m - v1 - r3 * rate
        r3_dot = pp3 / m - v3 + r1 * rate
        ps1, ps3 = m1 * v1, m3 * v3
        force = [
            -(ps3 + pp3) * rate - weight * s + lift_v * v3 - drag_v * v1,
            (ps1 + pp1) * rate + weight * c - lift_v * v1 - drag_v * v3,
            ps3 * v1
            - ps1 * v3
            - (r1 * pp1 + r3 * pp3) * rate
            - g * m * (r1 * c + r3 * s)
            + moment,
        ]

        # Servos: a set-point is approached within the rate limit; the mass stays on its axis.
        limit = p["moving_mass_rate_m_s"]
        target = min(max(self.moving_mass_command, p["moving_mass_min_m"]), p["moving_mass_max_m"])
        wanted = min(max(target - r1, -limit), limit)
        w1 = 4.0 * (wanted - r1_dot)
        w3 = -4.0 * r3_dot - 4.0 * (r3 - p["moving_mass_height_m"])
        push1 = m * (w1 + r3_dot * rate)
        push3 = m * (w3 - r1_dot * rate)
        a11, a33 = m1 + m, m3 + m
        a15, a35 = m * r3, -m * r1
        a55 = inertia + m * (r1 * r1 + r3 * r3)
        f1, f3 = force[0] - push1, force[1] - push3
        f5 = force[2] - r3 * push1 + r1 * push3
        rate_dot = (f5 - a15 / a11 * f1 - a35 / a33 * f3) / (a55 - a15 * a15 / a11 - a35 * a35 / a33)
        v1_dot = (f1 - a15 * rate_dot) / a11
        v3_dot = (f3 - a35 * rate_dot) / a33
        u1 = push1 + m * (v1_dot + r3 * rate_dot)
        u3 = push3 + m * (v3_dot - r1 * rate_dot)

        limit = p["ballast_rate_m3_s"]
        volume = (p["ballast_nominal_kg"] - mb) / rho
        target = min(max(self.ballast_command, p["ballast_min_m3"]), p["ballast_max_m3"])
        ballast_rate = min(max(target - volume, -limit), limit)
        depth_rate = v3 * c - v1 * s
        pressure = rho * g * max(y[1], 0.0)
        power = p["hotel_W"] + (p["pump_J_per_m3"] + p["pump_J_per_Pa_m3"] * pressure) * max(ballast_rate, 0.0)
        return [
            v1 * c + v3 * s,
            depth_rate,
            rate,
            rate_dot,
            v1_dot,
            v3_dot,
            r1_dot,
            r3_dot,
            u1,
            u3,
            -rho * ballast_rate,
            power,
        ]

    def advance(self, t: float, y: np.ndarray, size: float, method: str, tolerance: float) -> np.ndarray:
        solution = solve_ivp(
            self.rates, (t, t + size), y, method=method, rtol=tolerance, atol=tolerance * NOMINALS, t_eval=(t + size,)
        )
        if not solution.success:
            raise RuntimeError(solution.message)
        return solution.y[:, -1]
