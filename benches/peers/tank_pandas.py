"""A towing-tank campaign reduced by pandas and SciPy: tank_pandas.py CAMPAIGN; one line of JSON at the end.

The steady half of what tank-reduce does, as one writes it for oneself: zeros interpolated in time, interaction, window of
steady speed, strut taken off, dynamic pressure, wind axes, moment to the centre of buoyancy, straight fits per hull. Every
file is read, since every run is in the campaign; no standard errors from correlated samples, no oscillations, no checks.
"""

import json
import resource
import sys
import time
import tomllib
from pathlib import Path

import numpy as np
import pandas as pd
from scipy.optimize import least_squares

CHANNELS = ["AF_N", "SF_N", "YM_N_m"]


def density(celsius):
    """Fresh water at atmospheric pressure, kg/m3 (a parabola through the ITTC table between 10 and 25 degrees)."""
    return 999.1026 - 0.1511 * (celsius - 15.0) - 0.00570 * (celsius - 15.0) ** 2


def main(folder: Path) -> dict:
    begin = time.perf_counter()
    campaign = tomllib.loads((folder / "campaign.toml").read_text())
    runs = pd.read_csv(folder / "runs.csv")
    matrix = np.array(campaign.get("balance", {}).get("interaction", np.eye(3)))
    means = []
    for run in runs.itertuples():
        data = pd.read_csv(folder / run.file)
        speed = data["speed_m_s"].to_numpy()
        if run.kind == "zero":
            use = np.ones(len(data), dtype=bool)
        else:
            # Where the speed is the nominal one, less a tenth at each end for what the start leaves behind.
            steady = np.flatnonzero(np.abs(speed - run.speed_m_s) < 0.02 * run.speed_m_s + 0.01)
            if len(steady) < 50:
                means.append([np.nan] * 5)
                continue
            first, last = steady[0], steady[-1]
            trim = (last - first) // 10
            use = slice(first + 3 * trim, last - trim)
        part = data[use]
        q_speed = np.sqrt((part["speed_m_s"] ** 2).mean())
        means.append([*part[CHANNELS].mean(), q_speed, part["yaw_deg"].mean()])
    runs[[*CHANNELS, "U", "psi_deg"]] = means

    at = runs["start_time_s"] if "start_time_s" in runs else runs.index.to_series()
    zeros = runs["kind"] == "zero"
    for channel in CHANNELS:
        runs[channel] -= np.interp(at, at[zeros], runs.loc[zeros, channel])
    runs[CHANNELS] = runs[CHANNELS].to_numpy() @ matrix.T

    rho = density(runs["water_temperature_c"].fillna(campaign["water"]["temperature_c"]))
    runs["q"] = 0.5 * rho * runs["U"] ** 2
    psi = np.radians(runs["psi_deg"])
    sine = np.sin(psi)
    terms = np.column_stack([np.ones_like(sine), sine, sine**2, sine**3, np.log(runs["U"].clip(lower=0.1) / 2.0)])
    tares = (runs["kind"] == "tare") & runs["U"].notna()
    for channel in CHANNELS:
        loads, *_ = np.linalg.lstsq(terms[tares], (runs[channel] / runs["q"])[tares], rcond=None)
        runs[channel] -= runs["q"] * (terms @ loads)

    hulls = {}
    for hull in campaign["hull"]:
        mine = runs[(runs["kind"] == "static") & (runs["hull"] == hull["id"]) & runs["U"].notna()]
        psi = np.radians(mine["psi_deg"].to_numpy())
        af, sf, ym = (mine[channel].to_numpy() for channel in CHANNELS)
        force = mine["q"].to_numpy() * np.pi / 4 * hull["diameter_m"] ** 2
        lift = (sf * np.cos(psi) - af * np.sin(psi)) / force
        drag = (af * np.cos(psi) + sf * np.sin(psi)) / force
        moment = (ym + (hull["cb_m"] - hull["mc_m"]) * sf) / (force * hull["loa_m"])
        near = np.abs(psi) <= np.radians(10.5)

        def misfit(p, psi=psi[near], lift=lift[near], drag=drag[near], moment=moment[near]):
            a, b, c, d = p
            return np.concatenate([lift - a * psi, drag - b - c * psi**2, moment - d * psi])

        found = least_squares(misfit, [1.0, 0.1, 1.0, 1.0])
        hulls[hull["id"]] = dict(zip("abcd", found.x))
    seconds = time.perf_counter() - begin
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024
    return {"seconds": seconds, "peak_bytes": peak, "hulls": hulls}


if __name__ == "__main__":
    print(json.dumps(main(Path(sys.argv[1]))))
