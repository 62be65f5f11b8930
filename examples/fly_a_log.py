"""The glider's FMU in FMPy, flown by a measured log: what the pump and the battery did at sea goes in, where the model
glider then goes comes out and is set beside where the real one went.

    python examples/fly_a_log.py flight.csv --hours 1 --output flown.csv

The log is a CSV file as glidepolar reads it: time_s, pressure_dbar or depth_m, pitch_rad, vbd_cc, density_kg_m3 and, where
it is there, temperature_C. The ballast volume and the water go into the FMU as they were measured. The moving mass is set
so that the model's pitch becomes the measured one: first where it balances that pitch at rest, at -r tan(pitch) with the
pendulum's height r; then, flight after flight, by what the flight before was off. With --battpos it is set to the log's
battpos_m instead, for a log of this very vehicle.

The default FMU is neutral without ballast in water of its reference density; that is set to the log's mean density.
Where the two then differ, the polar, the trim or the log is wrong: `glidepolar identify` and `glidepolar diagnose` say
which.
"""

import argparse
import csv
import subprocess
import sys
from pathlib import Path

import fmpy
import numpy as np

DBAR_PA, GRAVITY_M_S2 = 1e4, 9.81
# Vertical velocities are compared as means over this time, below this depth.
MEAN_S, BELOW_M = 60.0, 5.0
# Share of a pitch error that the next flight's moving mass takes away, and the time over which errors are averaged.
LEARNING, SMOOTH_S = 0.7, 20.0


def main() -> int:
    arguments = parse()
    fmu = arguments.fmu or subprocess.check_output(["glidepolar", "fmu"], text=True).strip()
    log = read(arguments.log, arguments.start, arguments.hours)
    description = fmpy.read_model_description(fmu)
    start = {variable.name: variable.start for variable in description.modelVariables}

    density = float(np.mean(log["density_kg_m3"]))
    inputs = np.zeros(len(log["time_s"]), dtype=[("time", float), *((name, float) for name in input_names(description))])
    for name in inputs.dtype.names[1:]:
        inputs[name] = float(start[name])
    inputs["time"] = log["time_s"]
    inputs["ballast_command_m3"] = log["vbd_cc"] * 1e-6
    inputs["water_density_kg_m3"] = log["density_kg_m3"]
    inputs["water_temperature_C"] = log["temperature_C"]
    height = float(start["moving_mass_height_m"])
    reach = float(start["moving_mass_min_m"]), float(start["moving_mass_max_m"])
    mass = log["battpos_m"] if arguments.battpos else -height * np.tan(log["pitch_rad"])
    for flight in range(1 if arguments.battpos else arguments.flights):
        if flight > 0:
            off = np.interp(log["time_s"], result["time"], result["pitch_rad"]) - log["pitch_rad"]
            mass = mass + LEARNING * height / np.cos(log["pitch_rad"]) ** 2 * smooth(log["time_s"], off)
        mass = np.clip(mass, *reach)
        inputs["moving_mass_command_m"] = mass
        result = fmpy.simulate_fmu(
            fmu,
            start_values={
                "depth_m": log["depth_m"][0],
                "pitch_rad": log["pitch_rad"][0],
                "moving_mass_position_m": mass[0],
                **({} if arguments.keep_trim else {"reference_density_kg_m3": density}),
            },
            input=inputs,
            stop_time=log["time_s"][-1],
            output_interval=1.0,
            output=["depth_m", "x_m", "pitch_rad", "speed_m_s", "vertical_velocity_m_s"],
        )

    time = result["time"]
    measured = np.interp(time, log["time_s"], log["depth_m"])
    step = int(MEAN_S)
    both = [(depth[step:] - depth[:-step]) / (time[step:] - time[:-step]) for depth in (result["depth_m"], measured)]
    deep = np.minimum(measured[step:], measured[:-step]) > BELOW_M
    deep &= np.minimum(result["depth_m"][step:], result["depth_m"][:-step]) > BELOW_M
    pitch = np.interp(time, log["time_s"], log["pitch_rad"])
    print(f"{time[-1] / 3600:.2f} h, {len(log['time_s'])} rows of the log")
    print(f"way through the water        {result['x_m'][-1] / 1e3:8.2f} km")
    if deep.any():
        print(f"vertical velocity measured   {rms(both[1][deep]) * 100:8.2f} cm/s rms")
        print(f"  model less measured        {rms((both[0] - both[1])[deep]) * 100:8.2f} cm/s rms")
        print(f"pitch, model less measured   {np.degrees(rms((result['pitch_rad'] - pitch)[:-step][deep])):8.2f} deg rms")
    print(f"depth, model less measured   {rms(result['depth_m'] - measured):8.2f} m rms")
    if arguments.output:
        with arguments.output.open("w", newline="") as file:
            writer = csv.writer(file)
            writer.writerow([*result.dtype.names, "measured_depth_m", "measured_pitch_rad"])
            writer.writerows([*row, depth, angle] for row, depth, angle in zip(result.tolist(), measured, pitch))
    return 0


def parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("log", type=Path, help="the flight log (CSV)")
    parser.add_argument("--fmu", help="the archive (default: the one that `glidepolar fmu` names)")
    parser.add_argument("--start", type=float, default=0.0, help="begin so many hours into the log")
    parser.add_argument("--hours", type=float, default=np.inf, help="fly so many hours of it")
    parser.add_argument("--flights", type=int, default=5, help="flights in which the pitch is learnt (default 5)")
    parser.add_argument("--battpos", action="store_true", help="move the mass as battpos_m says")
    parser.add_argument("--keep-trim", action="store_true", help="keep the FMU's own reference density")
    parser.add_argument("--output", type=Path, help="write both flights to this CSV file")
    return parser.parse_args()


def read(path: Path, start_h: float, hours: float) -> dict[str, np.ndarray]:
    """The columns that are needed; rows that lack one of them are left out, and so are rows of an earlier time."""
    with path.open(newline="") as file:
        rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
    if not rows:
        sys.exit(f"error: {path} has no rows")

    def column(name: str) -> np.ndarray:
        return np.array([float(row[name]) if row.get(name) else np.nan for row in rows])

    log = {name: column(name) for name in ("time_s", "pitch_rad", "vbd_cc", "density_kg_m3", "temperature_C")}
    log["battpos_m"] = column("battpos_m")
    log["depth_m"] = column("depth_m")
    if not np.isfinite(log["depth_m"]).any():
        log["depth_m"] = column("pressure_dbar") * DBAR_PA / (log["density_kg_m3"] * GRAVITY_M_S2)
    if not np.isfinite(log["temperature_C"]).any():
        log["temperature_C"] = np.full(len(rows), 15.0)
    if not np.isfinite(log["battpos_m"]).any():
        log["battpos_m"] = np.zeros(len(rows))

    keep = np.all([np.isfinite(values) for values in log.values()], axis=0)
    keep &= log["time_s"] == np.maximum.accumulate(np.where(np.isfinite(log["time_s"]), log["time_s"], -np.inf))
    keep[1:] &= np.diff(log["time_s"]) > 0
    log = {name: values[keep] for name, values in log.items()}
    if not len(log["time_s"]):
        sys.exit(f"error: no row of {path} has time_s, depth, pitch_rad, vbd_cc and density_kg_m3")
    log["time_s"] = log["time_s"] - log["time_s"][0]
    part = (log["time_s"] >= start_h * 3600) & (log["time_s"] <= (start_h + hours) * 3600)
    log = {name: values[part] for name, values in log.items()}
    if len(log["time_s"]) < 2:
        sys.exit("error: fewer than two rows lie in that part of the log")
    log["time_s"] = log["time_s"] - log["time_s"][0]
    return log


def input_names(description) -> list[str]:
    return [variable.name for variable in description.modelVariables if variable.causality == "input"]


def smooth(time: np.ndarray, values: np.ndarray) -> np.ndarray:
    """A running mean over SMOOTH_S."""
    sums = np.concatenate([[0.0], np.cumsum(values)])
    first = np.searchsorted(time, time - SMOOTH_S / 2)
    last = np.searchsorted(time, time + SMOOTH_S / 2, side="right")
    return (sums[last] - sums[first]) / (last - first)


def rms(values: np.ndarray) -> float:
    return float(np.sqrt(np.mean(np.square(values))))


if __name__ == "__main__":
    sys.exit(main())
