"""NumPy and SciPy on the same steady model and the same bins: least_squares.py BINS.json.

a, b, c and a ballast offset by scipy.optimize.least_squares, residuals vectorised over all bins, slopes by finite
differences: what one writes in an afternoon. Bins, their inertia, baseline and weights come from the library's own fit, so
that both minimise the same sum; the answer holds what was found, for comparison.
"""

import json
import sys
import time

import numpy as np
from scipy.optimize import least_squares
from turns import serve

GIVEN = json.load(open(sys.argv[1]))
FLOWN, PITCH, DENSITY, NET, SINK, SPEED, ROOT = (
    np.array(GIVEN[k], dtype=float) for k in ["flown_pitch", "pitch", "density", "net", "sink", "speed", "root_weight"]
)
HAS_SPEED = np.isfinite(SPEED) & np.isfinite(GIVEN["speed_sd"] or np.nan)
AREA, GRAVITY, Q0, EXPONENT = (GIVEN[k] for k in ["area", "gravity", "q0", "exponent"])
FREE = GIVEN["free"]


def predict(values):
    """Sink and speed of the steady glide at every bin: Newton for the angle of attack, all bins at once."""
    p = {**GIVEN["baseline"], **dict(zip(FREE, values))}
    a, b0, c = p["a_per_rad"], p["b"], p["c_per_rad2"]
    weight = (NET + p["ballast_offset_kg"]) * GRAVITY
    b = np.full_like(PITCH, b0)
    alpha = np.clip(-b / (a * np.tan(PITCH)), -0.15, 0.15)
    q = np.full_like(PITCH, Q0)
    for _ in range(50):
        if EXPONENT != 0.0:
            b = b0 * (q / Q0) ** EXPONENT
        xi = PITCH - alpha
        cos, sin = np.cos(xi), np.sin(xi)
        lift, drag = a * alpha, b + c * alpha * alpha
        balance = drag * cos + lift * sin
        slope = 2 * c * alpha * cos + drag * sin + a * sin - lift * cos
        step = balance / slope
        alpha = alpha - np.clip(step, -0.2, 0.2)
        q_new = np.maximum(np.abs(weight) / (AREA * np.abs(lift * cos - drag * sin)), 1e-9)
        moved = np.max(np.abs(q_new / q - 1)) if EXPONENT != 0.0 else 0.0
        q = q_new
        if np.max(np.abs(step)) < 1e-9 and moved < 1e-9:
            break
    speed = np.sqrt(2 * q / DENSITY)
    return speed * np.sin(alpha - FLOWN), speed


def residuals(values):
    sink, speed = predict(values)
    parts = [ROOT * (SINK - sink) / GIVEN["sink_sd"]]
    if HAS_SPEED.any():
        parts.append((ROOT * (SPEED - speed))[HAS_SPEED] / GIVEN["speed_sd"])
    return np.concatenate(parts)


def handle(_question: dict) -> dict:
    start = np.array([GIVEN["baseline"][name] for name in FREE])
    begin = time.perf_counter()
    found = least_squares(residuals, start, x_scale=np.maximum(np.abs(start), 0.05), method="trf")
    seconds = time.perf_counter() - begin
    return {"seconds": seconds, "values": dict(zip(FREE, found.x)), "evaluations": int(found.nfev), "cost": 2 * found.cost}


if __name__ == "__main__":
    serve(handle)
