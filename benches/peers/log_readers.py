"""Glider files read by the programs that pilots have: log_readers.py; one question a line.

{"reader": NAME, "files": [...], "cache": DIR}: reads the files once, every channel that glidepolar takes from them, brought to
the same rows. The answer has `seconds`, `rows` and `sum`, the sum of the pressures in dbar.
"""

import time
from pathlib import Path

import dbdreader
import netCDF4
import numpy as np
import pandas as pd
import xarray
from turns import serve

# What glidepolar takes from a Seaglider's file; those that a file does not have are left out.
OF_GLIDER = ["eng_pitchAng", "eng_vbdCC", "eng_rollAng", "eng_head", "eng_pitchCtl", "eng_rollCtl", "latitude", "longitude"]
OF_CTD = ["temperature", "salinity", "conductivity"]
OF_MOTORS = ["gc_st_secs", "gc_end_secs", "log_gps_time", "log_gps_lat", "log_gps_lon"]

OF_SLOCUM = ["m_pitch", "m_roll", "m_heading", "m_fin", "m_battpos", "m_ballast_pumped", "m_de_oil_vol", "m_gps_lat", "m_gps_lon"]
OF_SCIENCE = ["sci_water_temp", "sci_water_cond"]


def seaglider(columns, length_of):
    """Everything on the clock of the pressure, by straight lines."""
    # On one clock the CTD's own is that of the temperature beside it.
    pressure = columns["ctd_pressure" if length_of("ctd_pressure") == length_of("pressure") else "pressure"]
    clock = next(c for c in ("time", "ctd_time") if length_of(c) == len(pressure))
    rows = columns[clock]
    for name in [*OF_GLIDER, *OF_CTD]:
        if name not in columns:
            continue
        own = next((c for c in ("time", "ctd_time") if c in columns and length_of(c) == length_of(name)), clock)
        values = columns[name]
        known = np.isfinite(values)
        if own != clock and known.any():
            np.interp(rows, columns[own][known], values[known])
    return len(rows), float(np.nansum(pressure))


WANTED = ["time", "ctd_time", "pressure", "ctd_pressure", *OF_GLIDER, *OF_CTD, *OF_MOTORS]


def by_netcdf4(path):
    with netCDF4.Dataset(path) as file:
        there = [name for name in WANTED if name in file.variables]
        columns = {name: np.ma.filled(np.ma.asarray(file[name][:], dtype=float), np.nan) for name in there}
    return seaglider(columns, lambda name: columns[name].size if name in columns else -1)


def by_xarray(path):
    with xarray.open_dataset(path, decode_times=False) as file:
        columns = {name: file[name].values.astype(float) for name in WANTED if name in file.variables}
    return seaglider(columns, lambda name: columns[name].size if name in columns else -1)


def by_pandas(paths):
    """A SeaExplorer's flight and payload files, the attitude at the payload's times."""
    own, payload = None, None
    for path in paths:
        table = pd.read_csv(path, sep=";", na_values=["9999", "9999.00"])
        clock = "Timestamp" if "Timestamp" in table else "PLD_REALTIMECLOCK"
        seconds = pd.to_datetime(table[clock], dayfirst=True).astype("datetime64[ms]").astype("int64") / 1e3
        table["time_s"] = seconds
        if clock == "Timestamp":
            own = table if own is None else pd.concat([own, table])
        else:
            payload = table if payload is None else pd.concat([payload, table])
    pressure = next(name for name in payload if name in ("GPCTD_PRESSURE", "LEGATO_PRESSURE"))
    payload = payload[payload[pressure].notna()]
    for name in ["Heading", "Pitch", "Roll", "BallastPos", "LinPos", "AngPos"]:
        values = own[name].to_numpy(dtype=float)
        known = np.isfinite(values)
        np.interp(payload["time_s"], own["time_s"][known], values[known])
    return len(payload), float(payload[pressure].sum())


def by_dbdreader(paths, cache):
    """The sensors that glidepolar takes, at the times of the science computer's pressure."""
    rows, total = 0, 0.0
    for pair in paths:
        sensors = {}
        for path in pair:
            file = dbdreader.DBD(path, cacheDir=cache, skip_initial_line=False)
            names = [n for n in [*OF_SLOCUM, *OF_SCIENCE, "sci_water_pressure"] if n in file.parameterNames]
            found = file.get(*names, decimalLatLon=False, discardBadLatLon=False)
            sensors.update({n: column for n, column in zip(names, found, strict=True) if len(column[0])})
            file.close()
        times, pressure = sensors.pop("sci_water_pressure")
        for clock, values in sensors.values():
            np.interp(times, clock, values)
        rows, total = rows + len(times), total + 10 * float(np.nansum(pressure))
    return rows, total


def all_by_dbdreader(paths, cache):
    """Every sensor of every file, as recorded."""
    rows = 0
    for path in paths:
        file = dbdreader.DBD(path, cacheDir=cache, skip_initial_line=False)
        names = sorted(file.parameterNames)
        rows += sum(len(times) for times, _ in file.get(*names, decimalLatLon=False, discardBadLatLon=False))
        file.close()
    return rows, 0.0


def handle(question):
    files, cache = question["files"], question.get("cache")
    begin = time.perf_counter()
    match question["reader"]:
        case "netCDF4":
            found = [by_netcdf4(path) for path in files]
        case "xarray":
            found = [by_xarray(path) for path in files]
        case "pandas":
            found = [by_pandas(files)]
        case "dbdreader":
            segments = {}
            for path in files:
                segments.setdefault(Path(path).stem, []).append(path)
            found = [by_dbdreader(segments.values(), cache)]
        case "dbdreader, all":
            found = [all_by_dbdreader(files, cache)]
        case other:
            raise ValueError(other)
    seconds = time.perf_counter() - begin
    return {"seconds": seconds, "rows": sum(rows for rows, _ in found), "sum": sum(total for _, total in found)}


if __name__ == "__main__":
    serve(handle)
