"""A thousand variants of the glider's FMU, flown in FMPy on all cores by Dask's distributed scheduler.

    python examples/dask_sweep.py --variants 1000 --compare glidepolar

Each variant sets some of the FMU's parameters by a draw from a seed. A worker unpacks and instantiates the FMU once and
flies one variant after the other with it. With `--compare PROGRAM` the same table goes through `glidepolar simulate
--sweep`, and the script fails where any output of any variant differs by more than 1e-9.

Needs fmpy, dask and distributed; runs on the cores of this machine. For a cluster, give Client() the address of its
scheduler instead of a LocalCluster, and put the FMU where every worker can read it.
"""

import argparse
import csv
import json
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from dask.distributed import Client, LocalCluster

# What is drawn, and from which range: (low, high), evenly.
VARIED = {
    "a_per_rad": (6.0, 8.5),
    "b": (0.10, 0.16),
    "c_per_rad2": (1.0, 2.0),
    "hull_compressibility_per_Pa": (0.0, 5e-10),
    "ballast_offset_kg": (-0.02, 0.02),
    "drag_growth_per_day": (0.0, 0.01),
}
# What is compared at the end of each flight.
OUTPUTS = [
    "depth_m", "x_m", "pitch_rad", "glide_angle_rad", "angle_of_attack_rad", "speed_m_s", "vertical_velocity_m_s",
    "v1_m_s", "v3_m_s", "net_mass_kg", "ballast_mass_kg", "moving_mass_position_m", "lift_N", "drag_N",
    "pitching_moment_N_m",
]  # fmt: skip
TOLERANCE = 1e-12
AGREE_WITHIN = 1e-9


def main() -> int:
    arguments = parse()
    variants = draw(arguments.variants, arguments.seed)
    fmu = arguments.fmu or subprocess.check_output([arguments.compare or "glidepolar", "fmu"], text=True).strip()

    with LocalCluster(n_workers=arguments.workers, threads_per_worker=1, dashboard_address=None) as cluster:
        with Client(cluster) as client:
            # Interpreters, imports and the unpacking of the FMU are not what is measured.
            client.run(instance, fmu)
            begin = time.perf_counter()
            # A few pieces for each worker: little to schedule, and none waits long for the last one.
            pieces = np.array_split(variants, min(len(variants), 8 * len(cluster.workers)))
            futures = client.map(fly, pieces, fmu=fmu, stop_s=arguments.stop)
            ends = np.concatenate(client.gather(futures))
            seconds = time.perf_counter() - begin
            workers = len(cluster.workers)
    print(f"Dask, {workers} workers: {len(ends)} variants of {arguments.stop:g} s in {seconds:.2f} s, {len(ends) / seconds:.0f} a second")

    if arguments.output:
        write(arguments.output, variants, ends)
    if not arguments.compare:
        return 0
    reference, rate = by_command(arguments.compare, variants, arguments.stop)
    worst = deviations(ends, reference)
    name = max(worst, key=worst.get)
    print(f"glidepolar: the same variants, {rate:.0f} a second")
    print(f"largest difference {worst[name]:.1e} of the largest {name}")
    if not worst[name] <= AGREE_WITHIN:
        print(f"error: they differ by more than {AGREE_WITHIN:g}", file=sys.stderr)
        return 1
    return 0


def parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--variants", type=int, default=1000, help="how many (default 1000)")
    parser.add_argument("--seed", type=int, default=1, help="the same seed draws the same variants (default 1)")
    parser.add_argument("--stop", type=float, default=1000.0, help="how long each flies [s] (default 1000)")
    parser.add_argument("--workers", type=int, help="processes (default: one for each core)")
    parser.add_argument("--fmu", help="the archive (default: the one that `glidepolar fmu` names)")
    parser.add_argument("--compare", metavar="PROGRAM", help="fly the sweep by this glidepolar, too")
    parser.add_argument("--output", type=Path, help="write variants and results to this CSV file")
    return parser.parse_args()


def draw(number: int, seed: int) -> np.ndarray:
    """One row for each variant, columns as in VARIED."""
    low, high = np.array(list(VARIED.values())).T
    return np.random.default_rng(seed).uniform(low, high, size=(number, len(VARIED)))


_INSTANCES: dict = {}


def instance(fmu: str):
    """This worker's FMU: description, folder and instance, made once."""
    import fmpy

    if fmu not in _INSTANCES:
        description = fmpy.read_model_description(fmu)
        folder = fmpy.extract(fmu)
        _INSTANCES[fmu] = (description, folder, fmpy.instantiate_fmu(folder, description, "CoSimulation"))
    # Not for sending home: Client.run() wants an answer that can travel.
    return None


def fly(variants: np.ndarray, fmu: str, stop_s: float) -> np.ndarray:
    """The outputs at the end of each variant's flight."""
    import fmpy

    instance(fmu)
    description, folder, made = _INSTANCES[fmu]
    ends = []
    for values in variants:
        made.reset()
        result = fmpy.simulate_fmu(
            folder,
            model_description=description,
            fmu_instance=made,
            fmi_type="CoSimulation",
            start_values=dict(zip(VARIED, values)),
            stop_time=stop_s,
            output_interval=stop_s,
            relative_tolerance=TOLERANCE,
            output=OUTPUTS,
        )
        ends.append([result[name][-1] for name in OUTPUTS])
    return np.array(ends)


def by_command(program: str, variants: np.ndarray, stop_s: float) -> tuple[np.ndarray, float]:
    """The same by `glidepolar simulate --sweep`, and how many a second."""
    with tempfile.TemporaryDirectory() as folder:
        table, results = Path(folder) / "variants.csv", Path(folder) / "results.csv"
        with table.open("w", newline="") as file:
            writer = csv.writer(file)
            writer.writerow(VARIED)
            # repr() is exact: both sides fly the same numbers.
            writer.writerows([repr(float(value)) for value in row] for row in variants)
        command = [program, "simulate", "slocum-graver", "--sweep", table, "--csv", results, "--json", "-"]
        command += ["--stop", stop_s, "--interval", stop_s, "--tolerance", TOLERANCE]
        said = json.loads(subprocess.check_output([str(word) for word in command], text=True))
        with results.open(newline="") as file:
            ends = [[float(row[name]) for name in OUTPUTS] for row in csv.DictReader(file)]
    return np.array(ends), said["variants_per_s"]


def deviations(found: np.ndarray, reference: np.ndarray) -> dict[str, float]:
    """The largest difference of each output, relative to its largest magnitude."""
    if found.shape != reference.shape:
        raise ValueError(f"{found.shape} results against {reference.shape}")
    scale = np.max(np.abs(reference), axis=0)
    return dict(zip(OUTPUTS, np.max(np.abs(found - reference), axis=0) / np.where(scale > 0, scale, 1.0)))


def write(path: Path, variants: np.ndarray, ends: np.ndarray) -> None:
    with path.open("w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow([*VARIED, *OUTPUTS])
        writer.writerows(np.hstack([variants, ends]).tolist())


if __name__ == "__main__":
    sys.exit(main())
