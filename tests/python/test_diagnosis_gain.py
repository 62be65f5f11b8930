"""What a diagnosis gains, confirmed by the FMU: packed with the vehicle as its owner has it, and with the extended one, it
flies the log's own ballast volume, moving mass and water, leg by leg, through hours that the diagnosis never saw."""

import csv
import json
import shutil
import subprocess

import numpy as np
import pytest
from fmpy import simulate_fmu
from test_fmu_export import export

# The diagnosis sees the first hours, the FMU flies the rest.
SEEN_H, LOG_H = 9, 12
# A glide is compared from here on, as the diagnosis does.
SETTLED_S, STRETCH_S = 90, 60
GRAVITY_M_S2 = 9.81


@pytest.fixture(scope="module")
def sea(virtual_sea, tmp_path_factory):
    folder = tmp_path_factory.mktemp("sea")
    # The vehicle says some 4e-10 1/Pa. The drawn 2.9e-10 is known by less than six standard errors beside an unknown shear.
    effect = "hull_compressibility=1.0e-10"
    command = [virtual_sea, "--seed", "12", "--effect", effect, "--hours", str(LOG_H), "--out", folder]
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    with open(folder / "log.csv") as file:
        rows = list(csv.reader(file))
    numbers = np.array([[float(cell or "nan") for cell in row] for row in rows[1:]])
    log = dict(zip(rows[0], numbers.T))
    seen = folder / "seen.csv"
    last = int(np.searchsorted(log["time_s"], SEEN_H * 3600))
    with open(seen, "w", newline="") as file:
        csv.writer(file).writerows(rows[: last + 1])
    return folder, seen, log


@pytest.fixture(scope="module")
def diagnosed(glidepolar, sea):
    folder, seen, _ = sea
    command = [glidepolar, "diagnose", seen, "--vehicle", folder / "vehicle.toml"]
    command += ["--extended", folder / "extended.toml", "--json", folder / "found.json", "--quiet"]
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return json.loads((folder / "found.json").read_text())


def test_the_fmu_gains_what_the_diagnosis_promises(glidepolar, fmu, sea, diagnosed, tmp_path):
    folder, _, log = sea
    assert diagnosed["causes"][0]["cause"] == "hull_compressibility"
    errors = {}
    for name in ("vehicle", "extended"):
        archive = export(glidepolar, fmu, tmp_path, folder / f"{name}.toml")
        packed = shutil.move(archive, tmp_path / f"{name}.fmu")
        errors[name] = np.concatenate([misfit(packed, leg) for leg in legs(log, SEEN_H * 3600)])
    assert len(errors["vehicle"]) > 60
    before, after = (np.sqrt(np.mean(errors[name] ** 2)) for name in ("vehicle", "extended"))
    print(f"vertical velocity: {1e3 * before:.1f} -> {1e3 * after:.1f} mm/s rms in {len(errors['vehicle'])} stretches")
    # Waves leave some 5 mm/s to any model; the promise is that of the diagnosis, within its own interval and a tenth.
    promised = diagnosed["gain"]["ci95"][0] - 10
    assert 100 * (1 - after / before) > promised, (before, after, diagnosed["gain"])


def legs(log, from_s):
    """The rows of each descent and ascent after a time, in one piece without gaps."""
    time, pressure = log["time_s"], log["pressure_dbar"]
    rising = np.sign(np.interp(time, time[1:], np.diff(pressure)))
    down = np.convolve(rising, np.ones(15), mode="same") > 0
    cuts = np.flatnonzero((np.diff(down.astype(int)) != 0) | (np.diff(time) > 60)) + 1
    for rows in np.split(np.arange(len(time)), cuts):
        inside = rows[(time[rows] > from_s) & (pressure[rows] > 8)]
        if len(inside) > 40 and time[inside[-1]] - time[inside[0]] > SETTLED_S + 3 * STRETCH_S:
            yield {name: column[inside] for name, column in log.items()}


def misfit(archive, leg):
    """Measured less simulated vertical velocity [m/s], a mean for each stretch of a leg."""
    whole = {name: filled(column) for name, column in leg.items()}
    time = whole["time_s"] - whole["time_s"][0]
    commands = {
        "ballast_command_m3": whole["vbd_cc"] * 1e-6,
        "moving_mass_command_m": whole["battpos_m"],
        "water_density_kg_m3": whole["density_kg_m3"],
        "water_temperature_C": whole["temperature_C"],
        "roll_rad": whole["roll_rad"],
        "rudder_rad": whole["fin_rad"],
    }
    depth = whole["pressure_dbar"] * 1e4 / (whole["density_kg_m3"] * GRAVITY_M_S2)
    pitch = whole["pitch_rad"][0]
    start = {
        "depth_m": depth[0],
        "pitch_rad": pitch,
        "v1_m_s": 0.25,
        "v3_m_s": -0.01 * np.sign(pitch),
        "moving_mass_position_m": commands["moving_mass_command_m"][0],
    }
    inputs = np.zeros(len(time), dtype=[("time", float)] + [(name, float) for name in commands])
    inputs["time"] = time
    for name, values in commands.items():
        inputs[name] = values
    flown = simulate_fmu(
        archive,
        start_values=start,
        input=inputs,
        stop_time=time[-1],
        output_interval=5,
        output=["depth_m", "ballast_m3"],
    )
    edges = np.arange(SETTLED_S, time[-1], STRETCH_S)
    simulated = np.diff(np.interp(edges, flown["time"], flown["depth_m"])) / STRETCH_S
    measured = np.diff(np.interp(edges, time, depth)) / STRETCH_S
    still = np.diff(np.interp(edges, time, whole["vbd_cc"]))
    return (measured - simulated)[np.abs(still) < 5]


def filled(column):
    known = np.isfinite(column)
    return np.interp(np.arange(len(column)), np.flatnonzero(known), column[known])
