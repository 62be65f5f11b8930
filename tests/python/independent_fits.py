"""Least-squares fits of a steady glide to real logs, written apart from the program: its own reading, windows and glide.

Nothing here knows inertia, shear or a model of the noise, nor a prior but that of `c`: windows of some minutes, a force balance, and the
scatter between dives as the only error. What it finds must agree with what the diagnosis finds, within both errors.
"""

import csv
from dataclasses import dataclass, replace

import netCDF4
import numpy as np
from scipy.optimize import least_squares

GRAVITY_M_S2 = 9.81
DBAR_PA = 1e4
BOUNDS = {"offset_kg": (-0.3, 0.3), "pitch_scale": (0.6, 1.6), "a_per_rad": (1.0, 60.0)}


@dataclass(frozen=True)
class Vehicle:
    """What the steady glide needs of a vehicle; a, b and c on the frontal area, b at a dynamic pressure where it has an exponent."""

    mass_kg: float
    volume_m3: float
    area_m2: float
    a_per_rad: float
    b: float
    c_per_rad2: float
    compressibility_per_Pa: float = 0.0
    expansion_per_K: float = 0.0
    reference_C: float = 15.0
    drag_exponent: float = 0.0
    # Of ascents over the mean of both legs: lift slope, b, c.
    ascent: tuple[float, float, float] = (1.0, 1.0, 1.0)


SEAGLIDER = Vehicle(
    52.5, 52.5 / 1027.5, np.pi / 4 * 0.3**2, 9.317917543873333, 0.1972226955478818, 0.8576947265937526,
    compressibility_per_Pa=4.18e-10, expansion_per_K=7.05e-5, drag_exponent=-0.25,
)  # fmt: skip
# Lift slope by a build-up of hull and wing; of the drag the ratio of the legs alone is the vehicle's.
SLOCUM_049 = Vehicle(51.25, 0.05, np.pi / 4 * 0.213**2, 21.1, 0.22, 6.35, ascent=(4.0 / 4.35, 0.19 / 0.22, 6.5 / 6.35))


@dataclass
class Windows:
    """Windows of steady glide, one row each; vertical velocity positive down, ballast positive where it lifts."""

    dive: np.ndarray
    pitch_rad: np.ndarray
    ballast_m3: np.ndarray
    density_kg_m3: np.ndarray
    pressure_Pa: np.ndarray
    temperature_C: np.ndarray
    w_m_s: np.ndarray
    speed_m_s: np.ndarray

    def only(self, rows):
        return Windows(*(values[rows] for values in vars(self).values()))


def windows(samples, length_s=150.0, after_motor_s=60.0, pitch_range_deg=4.0, deeper_than_dbar=5.0) -> Windows:
    """Means over pieces of one length between moves of the ballast; the vertical velocity is a straight line through the depth."""
    time, ballast = samples["time_s"], samples["ballast_m3"]
    moving = np.r_[False, np.abs(np.diff(ballast)) > 1e-6] | (np.diff(samples["dive"], prepend=samples["dive"][0]) != 0)
    moved = np.maximum.accumulate(np.where(moving, time, -np.inf))
    good = (time - moved > after_motor_s) & (samples["pressure_dbar"] > deeper_than_dbar)
    for name in ["pitch_rad", "density_kg_m3", "temperature_C"]:
        good &= np.isfinite(samples[name])
    leg = np.cumsum(moving)
    rows = []
    for number in np.unique(leg[good]):
        of_leg = np.flatnonzero(good & (leg == number))
        piece = ((time[of_leg] - time[of_leg[0]]) // length_s).astype(int)
        for k in np.unique(piece):
            i = of_leg[piece == k]
            if len(i) < 4 or np.ptp(time[i]) < 0.6 * length_s or np.ptp(samples["pitch_rad"][i]) > np.radians(pitch_range_deg):
                continue
            density = samples["density_kg_m3"][i].mean()
            depth = samples["pressure_dbar"][i] * DBAR_PA / (density * GRAVITY_M_S2)
            w = np.polyfit(time[i] - time[i].mean(), depth, 1)[0]
            measured = samples["speed_m_s"][i]
            speed = np.nanmean(measured) if np.isfinite(measured).any() else np.nan
            mean = {name: values[i].mean() for name, values in samples.items()}
            if abs(w) > 0.03 and abs(mean["pitch_rad"]) > np.radians(8) and (w > 0) == (mean["pitch_rad"] < 0):
                rows.append(
                    (mean["dive"], mean["pitch_rad"], mean["ballast_m3"], density, DBAR_PA * mean["pressure_dbar"],
                     mean["temperature_C"], w, speed)
                )  # fmt: skip
    return Windows(*np.array(rows).T)


def neutral(vehicle: Vehicle, at: Windows) -> Vehicle:
    """The vehicle with the mass that makes it neutral at ballast volume zero in the mean water."""
    mean = [values.mean() for values in (at.density_kg_m3, at.pressure_Pa, at.temperature_C)]
    return replace(vehicle, mass_kg=mean[0] * hull_volume_m3(vehicle, *mean[1:]))


def hull_volume_m3(vehicle, pressure_Pa, temperature_C):
    return vehicle.volume_m3 * (
        1
        - vehicle.compressibility_per_Pa * pressure_Pa
        + vehicle.expansion_per_K * (temperature_C - vehicle.reference_C)
    )


def glide(vehicle: Vehicle, at: Windows, offset_kg=0.0, pitch_scale=1.0):
    """Vertical velocity and speed of the steady glide: lift and drag carry the net weight at the pitch that was read."""
    hull = hull_volume_m3(vehicle, at.pressure_Pa, at.temperature_C)
    net_kg = vehicle.mass_kg + offset_kg - at.density_kg_m3 * (hull + at.ballast_m3)
    rises = net_kg < 0
    a, b, c = (
        coefficient * np.where(rises, ratio, 2 - ratio)
        for coefficient, ratio in zip((vehicle.a_per_rad, vehicle.b, vehicle.c_per_rad2), vehicle.ascent, strict=True)
    )
    pitch = np.where(rises, 1, -1) * at.pitch_rad * pitch_scale
    speed = np.full(len(pitch), 0.3)
    reference_Pa = 0.5 * 1027.5 * 0.3**2
    for _ in range(60):
        pressure_Pa = 0.5 * at.density_kg_m3 * speed**2
        drag = b * (pressure_Pa / reference_Pa) ** vehicle.drag_exponent
        alpha = drag / (a * np.tan(np.maximum(pitch, 0.05)))
        for _ in range(4):
            # a alpha sin(path) = (b + c alpha^2) cos(path), path = pitch + alpha.
            sine, cosine = np.sin(pitch + alpha), np.cos(pitch + alpha)
            lift, total = a * alpha, drag + c * alpha**2
            slope = a * sine + lift * cosine - 2 * c * alpha * cosine + total * sine
            alpha = alpha - (lift * sine - total * cosine) / slope
        force = np.hypot(a * alpha, drag + c * alpha**2)
        before, speed = speed, np.sqrt(2 * np.abs(net_kg) * GRAVITY_M_S2 / (at.density_kg_m3 * vehicle.area_m2 * force))
        if np.nanmax(np.abs(speed - before)) < 1e-10:
            break
    return np.where(rises, -1, 1) * speed * np.sin(pitch + alpha), speed


def fit(vehicle: Vehicle, at: Windows, free: dict[str, float], w_error=0.008, speed_error=0.03):
    """Sizes of what is free, beside the drag b and c, with errors by leaving one dive out; and the rms of the vertical velocity.

    `free` has the first guess of each: offset_kg, pitch_scale, a_per_rad.
    """
    names = list(free)

    def residual(x, at):
        sizes = dict(zip(names, x[2:], strict=True))
        polar = {"b": np.exp(x[0]), "c_per_rad2": np.exp(x[1]), "a_per_rad": sizes.pop("a_per_rad", vehicle.a_per_rad)}
        w, speed = glide(replace(vehicle, **polar), at, **sizes)
        of_speed = (speed - at.speed_m_s)[np.isfinite(at.speed_m_s)]
        # What a log says of c alone is little: published polars scatter by a factor of two.
        prior = (x[1] - np.log(vehicle.c_per_rad2)) / np.log(2)
        return np.nan_to_num(np.r_[(w - at.w_m_s) / w_error, of_speed / speed_error, prior], nan=30.0)

    def solve(at, start):
        low, high = np.array([(-4.6, 2.3), (-3.0, 5.0), *(BOUNDS[name] for name in names)]).T
        return least_squares(residual, start, args=(at,), bounds=(low, high), loss="soft_l1", f_scale=2.0).x

    best = solve(at, np.r_[np.log(vehicle.b), np.log(vehicle.c_per_rad2), list(free.values())])
    dives = np.unique(at.dive)
    groups = np.array_split(dives, min(len(dives), 12))
    without = np.array([solve(at.only(~np.isin(at.dive, group)), best) for group in groups])
    error = np.sqrt((len(groups) - 1) / len(groups) * ((without - without.mean(axis=0)) ** 2).sum(axis=0))
    rms = np.sqrt(np.mean((residual(best, at)[: len(at.w_m_s)] * w_error) ** 2))
    sizes = {name: (value, se) for name, value, se in zip(names, best[2:], error[2:], strict=True)}
    return sizes, rms


def table(path) -> dict[str, np.ndarray]:
    """The columns of a table."""
    with open(path, encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    return {name: np.array([float(row[name] or "nan") for row in rows]) for name in rows[0]}


def of_table(columns, dive="dive", speed=None):
    """Samples from a table in the flight log's columns."""
    nothing = np.full(len(columns["time_s"]), np.nan)
    ballast = columns["vbd_cc"] * 1e-6
    known = np.isfinite(ballast)
    ballast = np.interp(np.arange(len(ballast)), np.flatnonzero(known), ballast[known])
    return {
        "dive": columns.get(dive, np.zeros(len(nothing))),
        "time_s": columns["time_s"],
        "pitch_rad": columns["pitch_rad"],
        "ballast_m3": ballast,
        "density_kg_m3": columns["density_kg_m3"],
        "pressure_dbar": columns["pressure_dbar"],
        "temperature_C": columns["temperature_C"],
        "speed_m_s": columns[speed] if speed else nothing,
    }


def of_seagliders(paths, pings=None):
    """Samples from a basestation's files, the ballast volume from the last file's centre; `pings` gives times and speeds of a file."""
    dives = []
    last = netCDF4.Dataset(paths[-1])
    for number, path in enumerate(paths):
        with netCDF4.Dataset(path) as file:
            values = {
                name: np.ma.filled(file[name][:].astype(float), np.nan)
                for name in ["time", "pressure", "eng_vbdCC", "eng_pitchAng", "ctd_time", "temperature", "salinity"]
            }
            time = values["time"]

            def of_ctd(name, values=values, time=time):
                good = np.isfinite(values[name])
                return np.interp(time, values["ctd_time"][good], values[name][good], np.nan, np.nan)

            # What these files call density in situ is that at the surface.
            temperature, salinity = of_ctd("temperature"), of_ctd("salinity")
            density = sea_water_kg_m3(salinity, temperature, values["pressure"])
            counts = float(file["log_C_VBD"][:]) - float(last["log_C_VBD"][:])
            speed = np.full(len(time), np.nan)
            if pings:
                at, measured = pings(file)
                speed[[np.abs(time - t).argmin() for t in at]] = measured
            dives.append(
                {
                    "dive": np.full(len(time), float(number)),
                    "time_s": time,
                    "pitch_rad": np.radians(values["eng_pitchAng"]),
                    "ballast_m3": 1e-6 * (values["eng_vbdCC"] + counts * float(file["log_VBD_CNV"][:])),
                    "density_kg_m3": density,
                    "pressure_dbar": values["pressure"],
                    "temperature_C": temperature,
                    "speed_m_s": speed,
                }
            )
    return {name: np.concatenate([dive[name] for dive in dives]) for name in dives[0]}


def sea_water_kg_m3(salinity, temperature_C, pressure_dbar):
    """Density in situ by the equation of state of 1980 (Fofonoff and Millard, UNESCO 1983), not by the program's TEOS-10."""
    s, t, p = salinity, temperature_C, pressure_dbar / 10
    root = np.sqrt(s)

    def series(x, *coefficients):
        return sum(coefficient * x**power for power, coefficient in enumerate(coefficients))

    surface = (
        series(t, 999.842594, 6.793952e-2, -9.095290e-3, 1.001685e-4, -1.120083e-6, 6.536332e-9)
        + s * series(t, 8.24493e-1, -4.0899e-3, 7.6438e-5, -8.2467e-7, 5.3875e-9)
        + s * root * series(t, -5.72466e-3, 1.0227e-4, -1.6546e-6)
        + 4.8314e-4 * s**2
    )
    modulus_bar = (
        series(t, 19652.21, 148.4206, -2.327105, 1.360477e-2, -5.155288e-5)
        + s * series(t, 54.6746, -0.603459, 1.09987e-2, -6.1670e-5)
        + s * root * series(t, 7.944e-2, 1.6483e-2, -5.3009e-4)
        + p
        * (
            series(t, 3.239908, 1.43713e-3, 1.16092e-4, -5.77905e-7)
            + s * series(t, 2.2838e-3, -1.0981e-5, -1.6078e-6)
            + 1.91075e-4 * s * root
        )
        + p**2 * (series(t, 8.50935e-5, -6.12293e-6, 5.2787e-8) + s * series(t, -9.9348e-7, 2.0816e-8, 9.1697e-10))
    )
    return surface / (1 - p / modulus_bar)
