"""Comet's spiral of 9 August 2019 flown leg by leg by the glider in six degrees of freedom, in FMPy.

    python tests/python/comet.py UnderwaterGlider3D.fmu

fits list, rudder and shear to the odd dives and predicts the even ones, then the other way round: some minutes.

Each leg begins in a settled turn at the depth and heading that were recorded 25 s after the leg began. From then on the heading
is the FMU's. What differs between the legs is that heading alone: the shear of the water is one profile for all of them.
"""

import csv
import os
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from instance import Instance

MEASURED = Path(os.environ.get("GLIDEPOLAR_DATA", Path(__file__).parents[3] / "shared/data"))
COLUMNS = ["time_s", "pressure_dbar", "heading_rad", "pitch_rad"]
SETTLED_S = 25.0
# dbar: above the thermocline with it, below it.
LAYERS = [(3.0, 19.0), (19.0, 30.0)]
# The rudder as it was measured, rad.
RUDDER_RAD = 0.2022
# Ballast and place of the moving mass with which slocum-graver, turning, has the recorded pitch and vertical velocity:
# -25.6 deg and 0.135 m/s on descents, 26.8 deg and -0.168 m/s on ascents.
TRIM = {True: (-4.25e-5, 0.0238), False: (5.95e-5, -0.0231)}
# Time in which the turn settles, s, and the step with which the shear follows the depth.
SETTLES_S, STEP_S = 260.0, 2.0
# Depths between which the shear is linear, m.
KNOTS_M = np.array([4.0, 8.0, 12.0, 16.0, 20.0, 24.0, 28.0])


@dataclass
class Leg:
    """The settled part of a recorded leg."""

    dive: int
    descends: bool
    time_s: np.ndarray
    depth_m: np.ndarray
    heading_rad: np.ndarray
    pitch_rad: np.ndarray


def recorded() -> list[Leg]:
    with (MEASURED / "comet_2019_spiral.csv").open() as file:
        rows = csv.DictReader(line for line in file if not line.startswith("#"))
        table = np.array([[float(row[name] or "nan") for name in COLUMNS] for row in rows])
    table = table[np.isfinite(table).all(axis=1)]
    ends = (np.diff(np.sign(table[:, 3])) != 0) | (np.diff(table[:, 0]) > 60)
    parts = [part for part in np.split(table, np.flatnonzero(ends) + 1) if len(part) > 8 and np.ptp(part[:, 1]) > 8]
    legs = []
    for number, part in enumerate(parts):
        time, depth, heading, pitch = part.T
        here = (time > time[0] + SETTLED_S) & (depth >= LAYERS[0][0]) & (depth < LAYERS[-1][1])
        settled = (time[here] - time[here][0], depth[here], np.unwrap(heading)[here], pitch[here])
        legs.append(Leg(number // 2, bool(pitch.mean() < 0), *settled))
    return legs


def rates(leg, time_s, depth_m, heading_rad) -> list[float]:
    """Turn rate in each layer, rad/s, by a straight line through the headings."""
    found = []
    for low, high in LAYERS:
        here = (depth_m >= low) & (depth_m < high)
        found.append(np.polyfit(time_s[here], heading_rad[here], 1)[0] if here.sum() > 2 else np.nan)
    return found


class Flown:
    """The FMU on Comet's legs; its vehicle is that of the archive, with these parameters."""

    def __init__(self, archive, parameters=None):
        self.settled = {}
        for descends, (ballast, place) in TRIM.items():
            start = {"depth_m": 300.0, "ballast_command_m3": ballast, "moving_mass_command_m": place}
            start |= {"rudder_command_rad": RUDDER_RAD} | (parameters or {})
            instance = Instance(archive, tempfile.mkdtemp(), start=start)
            instance.step(0.0, SETTLES_S)
            self.settled[descends] = (instance, instance.save(), instance.get("depth_m"), instance.get("heading_rad"))

    def leg(self, leg: Leg, shear_1_s: np.ndarray) -> list[float]:
        """Turn rates of one leg in water whose velocity changes with depth by so much at the knots (rows: north, east)."""
        instance, state, depth, heading = self.settled[leg.descends]
        instance.restore(state)
        # The turn goes on from another heading: the water is turned instead.
        away = leg.heading_rad[0] - heading
        turned = np.array([[np.cos(away), np.sin(away)], [-np.sin(away), np.cos(away)]]) @ shear_1_s
        rows = []
        for time in np.arange(0.0, leg.time_s[-1], STEP_S):
            now = instance.get("depth_m") - depth + leg.depth_m[0]
            rows.append((time, now, instance.get("heading_rad") + away))
            instance.set("current_north_shear_1_s", np.interp(now, KNOTS_M, turned[0]))
            instance.set("current_east_shear_1_s", np.interp(now, KNOTS_M, turned[1]))
            instance.step(SETTLES_S + time, STEP_S)
        time, depth, heading = np.array(rows).T
        return rates(leg, time, depth, np.unwrap(heading))

    def legs(self, legs, shear_1_s) -> np.ndarray:
        return np.array([self.leg(leg, shear_1_s) for leg in legs])

    def free(self):
        for instance, *_ in self.settled.values():
            instance.free()


def measured(legs) -> np.ndarray:
    return np.array([rates(leg, leg.time_s, leg.depth_m, leg.heading_rad) for leg in legs])


def rms(errors) -> float:
    return float(np.sqrt(np.nanmean(np.square(errors))))


def means(legs, of) -> dict[bool, np.ndarray]:
    """Mean turn rates by leg and layer of these legs."""
    return {down: np.nanmean([rate for leg, rate in zip(legs, of) if leg.descends == down], axis=0) for down in (True, False)}


# The fit to the odd dives: list, rad, yawing moment per rudder, shear at the knots (rows: north, east), 1/s.
LIST_RAD, CN_DELTA = -0.157, 0.088
SHEAR_1_S = np.array(
    [
        [0.0682, 0.0153, -0.015, -0.0201, 0.0368, 0.0012, 0.0584],
        [0.0203, -0.0528, -0.0852, -0.0776, 0.0567, 0.0109, 0.0763],
    ]
)
# Where the fit begins: the vehicle file's rudder, the list of -4 deg with which it turns alike on both legs without shear.
START = np.concatenate([[-0.077, 0.183], np.zeros(2 * len(KNOTS_M))])
# Error of a recorded turn rate, rad/s, and the prior standard deviation of the shear, 1/s.
RATE_SE, SHEAR_SD = 0.002, 0.05
# slocum-graver: mass of the vehicle, and the first moment below the centre of buoyancy that rights it.
MASS_KG, BELOW_KG_M = 50.0, 0.45


def vehicle(graver: str) -> str:
    """The vehicle file of slocum-graver with Comet's list and rudder."""
    starboard_m = BELOW_KG_M * np.tan(LIST_RAD) / MASS_KG
    own = graver.replace("moving_mass_height_m = 0.05\n", f"moving_mass_height_m = 0.05\ncg_starboard_m = {starboard_m:.8f}\n")
    own = own.replace("CN_delta_per_rad = 0.205", f"CN_delta_per_rad = {CN_DELTA}")
    assert own.count("cg_starboard_m") == 1 and f"CN_delta_per_rad = {CN_DELTA}\n" in own
    return own


def parameters_of(values) -> dict[str, float]:
    """List, rad, and yawing moment per rudder, as parameters of the FMU."""
    return {"starboard_moment_kg_m": BELOW_KG_M * np.tan(values[0]), "rudder_CN_per_rad": values[1]}


def fit(archive, legs, start, steps=6):
    """List, rudder and the shear at the knots from these legs, by Gauss and Newton with halved steps."""
    wanted = measured(legs)

    def residuals(values):
        flown = Flown(archive, parameters_of(values))
        errors = (flown.legs(legs, values[2:].reshape(2, -1)) - wanted).ravel() / RATE_SE
        flown.free()
        return np.concatenate([np.nan_to_num(errors), values[2:] / SHEAR_SD])

    values, now = np.array(start, float), residuals(np.array(start, float))
    for _ in range(steps):
        sizes = np.array([5e-3, 2e-3] + [2e-3] * (len(values) - 2))
        slopes = np.array([(residuals(values + size * row) - now) / size for size, row in zip(sizes, np.eye(len(values)))]).T
        change = -np.linalg.lstsq(slopes, now, rcond=None)[0]
        for share in (1.0, 0.5, 0.25, 0.1):
            tried = values + share * change
            found = residuals(tried)
            if found @ found < now @ now:
                break
        else:
            break
        done = now @ now - found @ found < 1e-3 * (now @ now)
        values, now = tried, found
        print(f"sum of squares {now @ now:.1f}, share {share}", flush=True)
        if done:
            break
    return values, now, slopes


def report(archive):
    legs = recorded()
    for odd in (1, 0):
        fitted = [leg for leg in legs if leg.dive % 2 == odd]
        others = [leg for leg in legs if leg.dive % 2 != odd]
        values, _, slopes = fit(archive, fitted, START)
        errors = np.sqrt(np.diag(np.linalg.inv(slopes.T @ slopes)))
        print(f"fitted to {'odd' if odd else 'even'} dives: list {values[0]:.3f}({errors[0]:.3f}) rad,", end=" ")
        print(f"CN_delta {values[1]:.3f}({errors[1]:.3f})")
        print("shear north, east, 1/s:", values[2:].reshape(2, -1).round(4).tolist())
        flown = Flown(archive, parameters_of(values))
        known = means(fitted, measured(fitted))
        for what, those in (("fitted", fitted), ("held out", others)):
            found, wanted = flown.legs(those, values[2:].reshape(2, -1)), measured(those)
            baseline = np.array([known[leg.descends] for leg in those])
            print(f"{what}: rms of the FMU {rms(found - wanted):.5f}, of means {rms(baseline - wanted):.5f} rad/s")
            print("  flown", means(those, found), "\n  recorded", means(those, wanted))
        flown.free()


if __name__ == "__main__":
    report(sys.argv[1])
