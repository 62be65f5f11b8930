"""An ensemble of missions with FMPy and Dask: fmpy_ensemble.py FMU. Each mission is one simulate_fmu with its own start
values, as FMPy's own example of parameter variation does it; two worker processes unless asked otherwise."""

import sys
import time

import dask
import fmpy
from turns import serve


def one(folder, description, mission):
    fmpy.simulate_fmu(
        folder,
        model_description=description,
        validate=False,
        stop_time=mission["stop_s"],
        output_interval=mission["stop_s"],
        relative_tolerance=mission["tolerance"],
        fmi_type="CoSimulation",
        start_values={"ballast_offset_kg": mission["offset_kg"]},
        output=["x_m", "depth_m"],
    )
    return 1


FOLDER = fmpy.extract(sys.argv[1])
DESCRIPTION = fmpy.read_model_description(FOLDER)
POOLS = {}


def chunk(missions):
    return sum(one(FOLDER, DESCRIPTION, mission) for mission in missions)


def handle(question: dict) -> dict:
    from concurrent.futures import ProcessPoolExecutor

    workers = question["workers"]
    missions = [
        {"stop_s": question["stop_s"], "tolerance": question["tolerance"], "offset_kg": 1e-3 * (i % 7)}
        for i in range(question["missions"])
    ]
    pieces = [missions[i :: 4 * workers] for i in range(4 * workers)]
    if workers not in POOLS:
        POOLS[workers] = ProcessPoolExecutor(workers)
        list(POOLS[workers].map(chunk, [missions[:1]] * workers))
    begin = time.perf_counter()
    done = dask.compute(
        *[dask.delayed(chunk)(piece) for piece in pieces if piece], scheduler="processes", pool=POOLS[workers]
    )
    seconds = time.perf_counter() - begin
    assert sum(done) == len(missions)
    return {"seconds": seconds / len(missions)}


if __name__ == "__main__":
    serve(handle)
