"""A thousand variants of the glider's FMU, flown in FMPy on all cores by Dask's distributed scheduler.

    python examples/dask_sweep.py --variants 1000 --compare glidepolar
    python examples/dask_sweep.py --variants 100000 --parquet ends --scheduler tcp://10.0.0.1:8786

Each variant sets some of the FMU's parameters by a draw from a seed. A worker unpacks and instantiates the FMU once and
flies one variant after the other with it. With `--compare PROGRAM` the same table goes through `glidepolar simulate
--sweep`, and the script fails where any output of any variant differs by more than 1e-9.

With `--parquet FOLDER` each worker writes the pieces that it has flown as files of that folder, with variants and results;
`pandas.read_parquet(FOLDER)` reads them as one table. After Ctrl-C what is finished stays there, and `--resume` flies the rest.

Needs fmpy, dask, distributed, and pyarrow for Parquet; runs on the cores of this machine. For a cluster, name its scheduler
with `--scheduler`, and put FMU and folder where every worker has them under the same path.
"""

import argparse
import csv
import json
import os
import subprocess
import sys
import tempfile
import time
from contextlib import ExitStack
from pathlib import Path
from typing import Optional

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
# Variants in a piece: little to schedule, and little is lost with one.
PIECE = 64
AGREE_WITHIN = 1e-9


def main() -> int:
    arguments = parse()
    variants = draw(arguments.variants, arguments.seed)
    fmu = arguments.fmu or subprocess.check_output([arguments.compare or "glidepolar", "fmu"], text=True).strip()

    pieces = np.array_split(variants, max(1, len(variants) // PIECE))
    parts = [part(arguments.parquet, number) for number in range(len(pieces))]
    if arguments.parquet:
        arguments.parquet.mkdir(parents=True, exist_ok=True)
    found = finished(parts, pieces) if arguments.resume else {}
    with ExitStack() as stack:
        address = arguments.scheduler
        if address is None:
            cluster = LocalCluster(n_workers=arguments.workers, threads_per_worker=1, dashboard_address=None)
            address = stack.enter_context(cluster)
        client = stack.enter_context(Client(address))
        # Interpreters, imports and the unpacking of the FMU are not what is measured.
        workers = len(client.run(instance, fmu))
        begin = time.perf_counter()
        todo = [number for number in range(len(pieces)) if number not in found]
        flown = client.map(fly_piece, [pieces[n] for n in todo], [parts[n] for n in todo], fmu=fmu, stop_s=arguments.stop)
        results = client.gather(flown)
        seconds = time.perf_counter() - begin
    found |= {number: ends for number, (ends, _) in zip(todo, results)}
    ends = np.concatenate([found[number] for number in range(len(pieces))])
    now = sum(len(pieces[number]) for number in todo)
    if now < len(ends):
        print(f"{len(ends) - now} variants were finished before")
    print(f"flown in {len({process for _, process in results})} processes")
    print(f"Dask, {workers} workers: {now} variants of {arguments.stop:g} s in {seconds:.2f} s, {now / seconds:.0f} a second")

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
    parser.add_argument("--parquet", type=Path, metavar="FOLDER", help="write variants and results to this folder, piece by piece")
    parser.add_argument("--resume", action="store_true", help="fly only what is not finished in the folder of --parquet")
    parser.add_argument("--scheduler", metavar="ADDRESS", help="scheduler of a running cluster (default: one on this machine)")
    arguments = parser.parse_args()
    if arguments.resume and not arguments.parquet:
        parser.error("--resume needs --parquet FOLDER")
    return arguments


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


def fly_piece(variants: np.ndarray, file: Optional[Path], fmu: str, stop_s: float) -> tuple[np.ndarray, tuple[str, int]]:
    """The same, written to a file, whole or not at all; and which process did it."""
    from socket import gethostname

    ends = fly(variants, fmu, stop_s)
    if file is not None:
        import pyarrow as pa
        import pyarrow.parquet as pq

        columns = dict(zip([*VARIED, *OUTPUTS], np.hstack([variants, ends]).T))
        partial = file.with_suffix(f".{os.getpid()}.partial")
        pq.write_table(pa.table({name: np.ascontiguousarray(column) for name, column in columns.items()}), partial)
        partial.replace(file)
    return ends, (gethostname(), os.getpid())


def part(folder: Optional[Path], number: int) -> Optional[Path]:
    """The file of a piece."""
    return None if folder is None else folder.resolve() / f"part-{number:06}.parquet"


def finished(parts: list, pieces: list) -> dict[int, np.ndarray]:
    """The results of the pieces that an earlier run wrote."""
    import pyarrow.parquet as pq

    found = {}
    for number, (file, variants) in enumerate(zip(parts, pieces)):
        if file.is_file():
            table = pq.read_table(file)
            kept = np.array([table[name].to_numpy() for name in VARIED]).T
            if kept.shape != variants.shape or not np.array_equal(kept, variants):
                sys.exit(f"error: {file} has other variants: repeat that sweep's command, or choose another folder")
            found[number] = np.array([table[name].to_numpy() for name in OUTPUTS]).T
    return found


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
