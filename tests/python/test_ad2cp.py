"""A Seaglider's own current profiler, one speed a minute: five dives of SG171 in which pitch and roll change as often.

A second computation takes the speeds from the same files; a flight by a known polar along the same dives says which of the
answers is right: interpolated speeds are no measurement, since the glider pitches between two pings.
"""

import csv
import json
import os
import shutil
import subprocess
from pathlib import Path

import netCDF4
import numpy as np
from conftest import MEASURED
from test_log_values import files

FOLDER = MEASURED / "seaglider_sg171"
DBAR_PER_M = 1.007
PAGE = Path(__file__).parents[2] / "docs/evidence/identification.md"


def identify(glidepolar, paths, *arguments):
    arguments = ["identify", *paths, "--vehicle", "seaglider", *arguments, "--json", "-"]
    done = subprocess.run([glidepolar, *map(str, arguments)], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def filled(file, name):
    return np.ma.filled(file[name][:].astype(float), np.nan)


def pings(file):
    """Times of sound pings and speeds through the water: the near cells along the heading, and their vertical part."""
    time, heading = filled(file, "ad2cp_time"), np.radians(filled(file, "ad2cp_heading"))
    near = [filled(file, f"ad2cp_vel{axis}")[:, :4] for axis in "XYZ"]
    x, y, z = (cells.mean(axis=1) for cells in near)
    along = -(x * np.sin(heading) + y * np.cos(heading))
    tilt = np.degrees(
        np.arccos(np.cos(np.radians(filled(file, "ad2cp_pitch"))) * np.cos(np.radians(filled(file, "ad2cp_roll"))))
    )
    rows, pressure = filled(file, "time"), filled(file, "pressure")
    sinking = np.interp(time, 0.5 * (rows[1:] + rows[:-1]), np.diff(pressure) / np.diff(rows)) * 0.995
    spread = np.max([cells.std(axis=1, ddof=1) for cells in near], axis=0)
    sound = (np.interp(time, rows, pressure) > 1) & (tilt <= 65) & (along > 0) & (spread <= 0.1)
    sound &= np.abs(sinking - z) <= 0.1
    return time[sound], np.hypot(along, z)[sound]


def with_speeds(folder, speed_of):
    """Copies of the dives with the speeds of a function at the pings: `sparse` in the nearest row, `lines` between them; as such,
    in 32 bits, and to a millimetre per second.
    """
    folder.mkdir()
    paths = []
    for path in files(FOLDER, "p171*.nc"):
        paths.append(folder / path.name)
        shutil.copyfile(path, paths[-1])
        with netCDF4.Dataset(paths[-1], "a") as file:
            time, speed = pings(file)
            speed = speed_of(time, speed)
            time, speed = time[np.isfinite(speed)], speed[np.isfinite(speed)]
            rows = filled(file, "time")
            sparse = np.full(len(rows), np.nan)
            sparse[[np.abs(rows - t).argmin() for t in time]] = speed
            lines = np.interp(rows, time, speed, left=np.nan, right=np.nan)
            columns = [
                ("sparse", "f8", sparse),
                ("lines", "f8", lines),
                ("lines_of_32_bits", "f4", lines),
                ("lines_to_1_mm_s", "f8", np.round(lines, 3)),
            ]
            for name, kind, values in columns:
                column = file.createVariable(name, kind, file["time"].dimensions)
                column.units, column[:] = "m/s", values
    return paths


def stands_in_the_page(row, found):
    a, speeds = found["parameters"]["a"], found["rows"]["speed"]["values"]
    expected = f"{row} | {a['value']:.2f} +- {a['se']:.2f} | {speeds} |"
    assert expected in PAGE.read_text(encoding="utf-8"), expected


def test_the_diagnosis_uses_the_speeds_that_are_asked_for(glidepolar):
    arguments = ["diagnose", *files(FOLDER, "p171*.nc"), "--vehicle", "seaglider", "--speed-column", "ad2cp", "--json", "-"]
    done = subprocess.run([glidepolar, *map(str, arguments)], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert "no measured speed" not in done.stderr, done.stderr
    found = json.loads(done.stdout)
    gains = found.get("diagnosis", found)["gains"]
    assert "speed_through_water" in [gain["quantity"] for gain in gains], gains


def test_speeds_at_their_own_times_and_interpolated_ones_give_one_lift_slope(glidepolar, tmp_path):
    own = identify(glidepolar, files(FOLDER, "p171*.nc"), "--speed-column", "ad2cp")
    paths = with_speeds(tmp_path / "dives", lambda _, speed: speed)
    a = own["parameters"]["a"]
    assert "a" not in own["pinned"]
    rows = {"sparse": "in the nearest rows", "lines": "interpolated, recognised as such"}
    for name in [*rows, "lines_of_32_bits", "lines_to_1_mm_s"]:
        found = identify(glidepolar, paths, "--speed-column", name)
        other = found["parameters"]["a"]
        assert "a" not in found["pinned"]
        # The same pings by a second computation: where they are not the very same, less than the errors.
        assert abs(a["value"] - other["value"]) < min(a["se"], other["se"]), (name, a, other)
        assert a["ci95"][0] <= other["value"] <= a["ci95"][1], (name, a, other)
        assert any("interpolated" in warning for warning in found["warnings"]) == (name != "sparse")
        if name in rows:
            stands_in_the_page(rows[name], found)
    stands_in_the_page("`--speed-column ad2cp`", own)
    assert abs(own["fit"]["speed_bias_holdout_m_s"]) <= 0.012, own["fit"]
    for name, halves in own["halves"].items():
        one, other = halves["values"]
        # The lift slope and the trim agree within one standard error. b is 1.5 apart, as in one of eight flights of these dives
        # through moving water by one and the same b (below).
        most = 2 if name == "b" else 1
        assert abs(one - other) < most * halves["difference_se"], (name, halves)


def test_in_moving_water_halves_differ_as_their_error_says(glidepolar, tmp_path):
    """The dives flown again by the polar found, through water that moves by 25 mm/s for five minutes at a time.

    The page has the figures of `GLIDEPOLAR_FLIGHTS=150`.
    """
    flights = int(os.environ.get("GLIDEPOLAR_FLIGHTS", "48"))
    log = Flown(glidepolar, files(FOLDER, "p171*.nc"), tmp_path, ["--write", tmp_path / "polar.toml"])
    held, apart = dict.fromkeys(log.polar, 0), {name: [] for name in log.polar}
    for seed in range(flights):
        flight = tmp_path / "flight.csv"
        log.write(flight, np.random.default_rng(seed), water_m_s=0.025, water_s=300, speed_m_s=0.033)
        found = identify(glidepolar, [flight], "--speed-column", "speed_through_water_m_s", "--free", "a")
        for name, truth in log.polar.items():
            low, high = found["parameters"][name]["ci95"]
            held[name] += low <= truth <= high
            one, other = found["halves"][name]["values"]
            apart[name].append((one - other) / found["halves"][name]["difference_se"])
    for name, differences in apart.items():
        size = np.abs(differences)
        figures = np.sqrt(np.mean(size**2)), np.mean(size < 1), np.mean(size > 1.5)
        print(name, f"held {held[name]} of {flights}", "apart {:.2f}, below 1 {:.2f}, above 1.5 {:.2f}".format(*figures))
        # By Student's law of four degrees of freedom 1.4, and of so few draws between half and twice that.
        assert 0.7 < figures[0] < 2.0, (name, figures)
        assert held[name] >= 0.85 * flights, (name, held)


class Flown:
    """Dives as a polar flies them along the recorded pitch and ballast, to be written with other water and other noise."""

    def __init__(self, glidepolar, paths, folder, arguments):
        found = identify(glidepolar, paths, "--speed-column", "ad2cp", *arguments)["parameters"]
        self.polar = {name: found[name]["value"] for name in ("a", "b", "ballast_offset_kg")}
        log = folder / "flown.csv"
        track = [glidepolar, "track", *paths, "--vehicle", folder / "polar.toml", "--write", log, "--quiet"]
        subprocess.run([*map(str, track)], check=True, capture_output=True)
        with open(log, encoding="utf-8") as file:
            self.rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
        self.time, self.pressure, self.dive = (self.column(name) for name in ("time_s", "pressure_dbar", "dive"))
        self.speed = self.column("speed_through_water_m_s")
        self.sinking = self.speed * -np.sin(self.path(found["c"]["value"]))
        recorded = np.gradient(self.pressure, self.time) / DBAR_PER_M
        self.sinking = np.where(np.isfinite(self.sinking), self.sinking, recorded)
        self.pings = np.concatenate([pings(netCDF4.Dataset(path))[0] for path in paths])

    def column(self, name):
        return np.array([float(row[name] or "nan") for row in self.rows])

    def path(self, c):
        """Angle of the path by Newton's method: tan(pitch - alpha) a alpha + b + c alpha^2 = 0."""
        a, b, pitch = self.polar["a"], self.polar["b"], self.column("pitch_rad")
        # Where the glider is level there is no glide, and no speed either.
        with np.errstate(divide="ignore", invalid="ignore"):
            alpha = -b / (a * np.tan(pitch))
            for _ in range(20):
                tan = np.tan(pitch - alpha)
                alpha -= (tan * a * alpha + b + c * alpha**2) / (a * tan - (1 + tan**2) * a * alpha + 2 * c * alpha)
            return pitch - alpha

    def write(self, path, noise, water_m_s, water_s, speed_m_s):
        pressure, speed = self.pressure.copy(), np.full(len(self.rows), np.nan)
        for dive in np.unique(self.dive):
            rows = np.flatnonzero(self.dive == dive)
            steps = np.diff(self.time[rows])
            water = [noise.normal(0, water_m_s)]
            for kept in np.exp(-steps / water_s):
                water.append(water[-1] * kept + noise.normal(0, water_m_s * np.sqrt(1 - kept**2)))
            sinking = self.sinking[rows] + water
            sunk = np.cumsum(0.5 * (sinking[1:] + sinking[:-1]) * steps) * DBAR_PER_M
            pressure[rows[1:]] = np.maximum(pressure[rows[0]] + sunk, 0.05)
        for time in self.pings:
            nearest = np.abs(self.time - time).argmin()
            speed[nearest] = self.speed[nearest] + noise.normal(0, speed_m_s)
        with open(path, "w", encoding="utf-8") as file:
            writer = csv.DictWriter(file, self.rows[0])
            writer.writeheader()
            for row, here, there, measured in zip(self.rows, pressure, self.pressure, speed, strict=True):
                # The same water at another pressure: 0.0044 kg/m3 a dbar, and no salinity that would contradict it.
                density = float(row["density_kg_m3"] or "nan") + 0.0044 * (here - there)
                figures = {"pressure_dbar": here, "speed_through_water_m_s": measured, "density_kg_m3": density}
                figures = {name: f"{value:.4f}" if np.isfinite(value) else "" for name, value in figures.items()}
                writer.writerow(row | figures | {"salinity_psu": ""})


def test_where_the_polar_is_known_the_interval_holds_it(glidepolar, tmp_path):
    """The dives flown again by a polar of a = 7.2: its speeds at the times of the pings, with their scatter of 3 cm/s."""
    paths = files(FOLDER, "p171*.nc")
    pinned = ["--pin", "a=7.2", "--pin", "c=0.86"]
    log = Flown(glidepolar, paths, tmp_path, [*pinned, "--write", tmp_path / "polar.toml"])
    held, off = 0, []
    for seed in range(8):
        draw = np.random.default_rng(seed).normal

        def speed_of(time, _, draw=draw):
            nearest = [np.abs(log.time - t).argmin() for t in time]
            return log.speed[nearest] + draw(0, 0.03, len(time))

        flight = with_speeds(tmp_path / str(seed), speed_of)
        a = identify(glidepolar, flight, "--speed-column", "sparse", "--free", "a")["parameters"]["a"]
        held += a["ci95"][0] <= 7.2 <= a["ci95"][1]
        off.append(a["value"] - 7.2)
        # Between the pings nothing was measured: the lines add nothing, and take nothing away.
        lines = identify(glidepolar, flight, "--speed-column", "lines", "--free", "a")["parameters"]["a"]
        assert abs(lines["value"] - a["value"]) < a["se"], (a, lines)
    assert held >= 7, (held, off)
    # In the mean over the draws less than half of one standard error of a single flight.
    assert abs(np.mean(off)) < 0.7, off
