"""Turn rates of real Seagliders beside a second computation from the same files, with numpy alone."""

import json
import subprocess

import netCDF4
import numpy as np
import pytest
from conftest import MEASURED
from test_log_values import DATA, files

SETTLED_S, SHORTEST_S, LONGEST_S, LONGEST_GAP_S = 25.0, 20.0, 300.0, 60.0


def filled(file, name):
    return np.ma.filled(file[name][:].astype(float), np.nan)


def stretches(paths):
    """Dive, whether it descends, turn rate and mean roll, each between two moves of the motors."""
    found = []
    for dive, path in enumerate(paths):
        with netCDF4.Dataset(path) as file:
            time, heading, roll = (filled(file, name) for name in ["time", "eng_head", "eng_rollAng"])
            pitch = filled(file, "eng_pitchAng")
            starts, ends = np.sort(filled(file, "gc_st_secs")), np.sort(filled(file, "gc_end_secs"))
        for end in ends:
            later = starts[starts > end]
            until = later.min() if len(later) else time[-1]
            rows = np.flatnonzero((time >= end + SETTLED_S) & (time <= until) & np.isfinite(heading) & np.isfinite(roll))
            begin = 0
            for i in range(1, len(rows) + 1):
                closes = i == len(rows)
                closes = closes or time[rows[i]] - time[rows[begin]] > LONGEST_S
                closes = closes or time[rows[i]] - time[rows[i - 1]] > LONGEST_GAP_S
                if not closes:
                    continue
                run, begin = rows[begin:i], i
                if len(run) >= 3 and time[run[-1]] - time[run[0]] >= SHORTEST_S:
                    turned = np.unwrap(np.radians(heading[run]))
                    rate = np.polyfit(time[run] - time[run[0]], turned, 1)[0]
                    found.append((dive, pitch[run].mean() < 0, rate, np.radians(roll[run]).mean()))
    return np.array(found)


def held_out(found, descends):
    """Slope over all, and the error on every other dive by the line through the others [deg/s]."""
    dive, _, rate, roll = found[found[:, 1] == descends].T
    design = np.column_stack([np.ones_like(roll), roll])
    errors = np.empty_like(rate)
    for odd in [0, 1]:
        line = np.linalg.lstsq(design[dive % 2 == odd], rate[dive % 2 == odd], rcond=None)[0]
        errors[dive % 2 != odd] = (rate - design @ line)[dive % 2 != odd]
    return np.linalg.lstsq(design, rate, rcond=None)[0][1], np.degrees(np.sqrt((errors**2).mean()))


@pytest.mark.parametrize("glider", ["sg236", "sg542"])
def test_turn_rates_are_predicted_as_well_as_by_a_second_computation(glidepolar, glider):
    paths = files(DATA / "sg542" if glider == "sg542" else MEASURED / "seaglider_sg236", "p*.nc")
    # The CTD of SG236 was off on one descent: with a density its turns take part.
    arguments = ["identify", *paths, "--vehicle", "seaglider", "--density", "1027", "--json", "-"]
    done = subprocess.run([glidepolar, *map(str, arguments)], capture_output=True, text=True, check=True)
    turning = json.loads(done.stdout)["turning"]
    found = stretches(paths)
    for leg, descends in [("descent", 1), ("ascent", 0)]:
        slope, error = held_out(found, descends)
        own = turning["turn_rate_per_roll_1_s"][leg]
        assert own["ci95"][0] <= slope <= own["ci95"][1], (own, slope)
        # Here the pitch has to be that of the leg as well, which leaves out a stretch or two more.
        rms = np.degrees(turning["holdout_rms_rad_s"][leg])
        assert 0.85 * error < rms <= 1.01 * error, (leg, rms, error)
