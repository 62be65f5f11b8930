"""Real files of all three makers, value for value as dbdreader, netCDF4 and pyglider (by xarray) have them.

Files: those that `cargo xtask fetch-data` fetches into data/, and the Seaglider dives of the folder of measured data.
"""

from pathlib import Path

import dbdreader
import netCDF4
import numpy as np
import pandas
import pytest
import xarray
from conftest import MEASURED
from test_log_dialects import read

DATA = Path(__file__).parents[2] / "data"


def files(folder: Path, pattern: str) -> list[Path]:
    found = sorted(folder.glob(pattern))
    if not found:
        pytest.skip(f"no {folder}/{pattern}: run `cargo xtask fetch-data`")
    return found


def assert_same(found, expected, error=1e-12):
    """The same values, missing in the same places."""
    expected = np.ma.filled(np.ma.asarray(expected, dtype=float), np.nan)
    assert found.shape == expected.shape
    assert (np.isfinite(found) == np.isfinite(expected)).all()
    known = np.isfinite(expected)
    assert np.abs(found - expected)[known].max(initial=0.0) <= error * np.abs(expected[known]).max(initial=1.0)


@pytest.mark.parametrize("glider", ["sg171", "sg236", "sg542"])
def test_dives_of_a_seaglider_are_those_of_netcdf4(log_values, glider):
    folder = DATA / "sg542" if glider == "sg542" else MEASURED / f"seaglider_{glider}"
    paths = files(folder, "p*.nc")
    for path in paths[:5]:
        log, _ = read(log_values, path)
        with netCDF4.Dataset(path) as file:
            is_own = file["pressure"].dimensions == file["time"].dimensions
            assert is_own, "the glider's own pressure is that of the rows"
            assert_same(log["time_s"], file["time"][:])
            same_clock = file["ctd_pressure"].dimensions == file["pressure"].dimensions
            assert_same(log["pressure_dbar"], file["ctd_pressure" if same_clock else "pressure"][:])
            for name, channel in [("eng_pitchAng", "pitch_rad"), ("eng_rollAng", "roll_rad")]:
                assert_same(log[channel], np.radians(file[name][:].astype(float)))
            assert_same(log["vbd_cc"], file["eng_vbdCC"][:])
            heading = np.radians(np.ma.filled(file["eng_head"][:].astype(float), np.nan)) % (2 * np.pi)
            assert_same(log["heading_rad"], heading)
            # The CTD by straight lines from its own clock; only where two of its readings are near.
            clock, values = file["ctd_time"][:].astype(float), np.ma.filled(file["temperature"][:], np.nan)
            known = np.isfinite(values)
            lines = np.interp(log["time_s"], clock[known], values[known])
            there = np.isfinite(log["temperature_C"])
            # Where quality control left less than half of what was read, the raw record is taken.
            if known.sum() > np.isfinite(np.ma.filled(file["temperature_raw"][:], np.nan)).sum() / 2:
                # The CTD of SG236 was off on the descent of dive 4.
                assert there.sum() > 0.4 * len(lines)
                assert np.abs(log["temperature_C"] - lines)[there].max() < 1e-9


# Flight and science files of segments, as dbdreader's source package and pyglider's have them.
SEGMENTS = [
    ("dbdreader", ["amadeus-2014-204-05-000.dbd", "amadeus-2014-204-05-000.ebd"], "cac"),
    ("dbdreader", ["sebastian-2014-204-05-000.dbd", "sebastian-2014-204-05-000.ebd"], "cac"),
    ("dbdreader", ["electa-2023-143-00-050.sbd", "electa-2023-143-00-050.tbd"], "cac"),
    ("pyglider/maria997", ["maria-997-2022-164-7-0.sbd", "maria-997-2022-164-7-0.tbd"], "cac"),
]


@pytest.mark.parametrize(("folder", "names", "cache"), SEGMENTS, ids=[names[0] for _, names, _ in SEGMENTS])
def test_segments_of_a_slocum_are_those_of_dbdreader(log_values, folder, names, cache):
    paths = [file for name in names for file in files(DATA / folder, name)]
    log, _ = read(log_values, "--cache", DATA / folder / cache, *paths)
    wanted = ["sci_water_pressure", "m_pitch", "m_roll", "m_ballast_pumped", "m_de_oil_vol", "m_fin", "m_battpos"]
    wanted += ["sci_water_temp", "sci_water_cond"]
    sensors = {name: (np.array([]), np.array([])) for name in wanted}
    for path in paths:
        # The first cycle has the last value of every sensor, however old.
        file = dbdreader.DBD(str(path), cacheDir=str(DATA / folder / cache), skip_initial_line=True)
        # The flight computer stores some of the science computer's sensors as well, at its own times.
        for name in set(wanted) & set(file.parameterNames):
            times, values = file.get(name, decimalLatLon=False, discardBadLatLon=False)
            known = np.isfinite(times) & np.isfinite(values) & (times > 1e8)
            sensors[name] = tuple(
                np.concatenate([old, new[known]]) for old, new in zip(sensors[name], (times, values), strict=True)
            )
    times, pressure = sensors["sci_water_pressure"]
    order = np.argsort(times, kind="stable")
    times, pressure = times[order], pressure[order] * 10
    # Every reading of the CTD is a row, in its place; others stand between where the CTD was off.
    place = np.searchsorted(log["time_s"], times)
    assert (log["time_s"][place] == times).all()
    first = np.searchsorted(times, times)
    assert np.abs(log["pressure_dbar"][place] - pressure[first]).max() < 1e-9
    compared = 0
    for name, channel, factor in [
        ("m_pitch", "pitch_rad", 1),
        ("m_roll", "roll_rad", 1),
        ("m_ballast_pumped", "vbd_cc", 1),
        ("m_fin", "fin_rad", 1),
        ("m_battpos", "battpos_m", 0.0254),
        ("sci_water_temp", "temperature_C", 1),
        ("sci_water_cond", "conductivity_S_m", 1),
    ]:
        clock, values = sensors[name]
        if len(clock) < 2 or (channel == "vbd_cc" and len(sensors["m_de_oil_vol"][1]) > 0):
            continue
        order = np.argsort(clock, kind="stable")
        clock, values = clock[order], values[order]
        clock, first = np.unique(clock, return_index=True)
        lines = np.interp(log["time_s"], clock, values[first]) * factor
        there = np.isfinite(log[channel])
        assert there.any(), channel
        assert np.abs(log[channel] - lines)[there].max() < 1e-9, channel
        compared += 1
    assert compared >= 3


def test_the_files_of_a_seaexplorer_are_those_of_pygliders_table(log_values):
    paths = files(DATA / "pyglider/sea035", "sea035.*")
    log, _ = read(log_values, *paths)
    [table] = files(DATA / "pyglider/eva035", "*.nc")
    with xarray.open_dataset(table, decode_times=False) as other:
        time = other["time"].values.astype(float)
        row = {round(t, 3): i for i, t in enumerate(log["time_s"])}
        pairs = [(row[round(t, 3)], i) for i, t in enumerate(time) if round(t, 3) in row]
        assert len(pairs) > 0.99 * len(time), (len(pairs), len(time))
        own, others = map(np.array, zip(*pairs, strict=True))
        for channel, name, factor, error in [
            ("pressure_dbar", "pressure", 1, 1e-9),
            ("temperature_C", "temperature", 1, 1e-9),
            ("conductivity_S_m", "conductivity", 1, 1e-9),
        ]:
            found, expected = log[channel][own], other[name].values[others] * factor
            both = np.isfinite(found) & np.isfinite(expected)
            assert both.sum() > 0.9 * len(own), channel
            assert np.abs(found - expected)[both].max() < error, channel
        # pyglider brings attitude to the same times by straight lines, too.
        found, expected = np.degrees(log["pitch_rad"][own]), other["pitch"].values[others]
        both = np.isfinite(found) & np.isfinite(expected)
        assert np.median(np.abs(found - expected)[both]) < 1e-6


@pytest.mark.parametrize(
    ("folder", "dives", "ctd", "siemens"), [("sea046", "1[01]", "GPCTD", 1.0), ("sea063", "*", "LEGATO", 0.1)]
)
def test_the_files_of_a_seaexplorer_are_those_of_pandas(log_values, folder, dives, ctd, siemens):
    """Two CTDs, one in S/m and one in mS/cm; attitude from the flight computer by straight lines to the CTD's times."""

    def table(kind, clock):
        paths = files(DATA / "pyglider" / folder, f"*.{kind}.*.{dives}.gz")
        whole = pandas.concat([pandas.read_csv(path, sep=";") for path in paths])
        form = "%d/%m/%Y %H:%M:%S" if kind == "gli" else "%d/%m/%Y %H:%M:%S.%f"
        time = pandas.to_datetime(whole[clock], format=form) - pandas.Timestamp("1970-01-01")
        return whole.assign(time_s=time.dt.total_seconds()).sort_values("time_s", kind="stable")

    log, _ = read(log_values, *files(DATA / "pyglider" / folder, f"*.{dives}.gz"))
    payload = table("pld1", "PLD_REALTIMECLOCK").dropna(subset=[f"{ctd}_PRESSURE", f"{ctd}_TEMPERATURE"])
    payload = payload.drop_duplicates("time_s", keep=False)
    row = {round(t, 3): i for i, t in enumerate(log["time_s"])}
    pairs = [(row[round(t, 3)], i) for i, t in enumerate(payload["time_s"]) if round(t, 3) in row]
    assert len(pairs) > 0.99 * len(payload), (len(pairs), len(payload))
    own, others = map(np.array, zip(*pairs, strict=True))
    for channel, name, factor in [
        ("pressure_dbar", "PRESSURE", 1),
        ("temperature_C", "TEMPERATURE", 1),
        ("conductivity_S_m", "CONDUCTIVITY", siemens),
    ]:
        found, expected = log[channel][own], payload[f"{ctd}_{name}"].to_numpy(float)[others] * factor
        both = np.isfinite(found) & np.isfinite(expected)
        assert both.sum() > 0.9 * len(own), channel
        assert np.abs(found - expected)[both].max() < 1e-9, channel
    flight = table("gli", "Timestamp").drop_duplicates("time_s")
    lines = np.interp(log["time_s"][own], flight["time_s"], np.radians(flight["Pitch"]))
    found = log["pitch_rad"][own]
    there = np.isfinite(found)
    assert there.sum() > 0.5 * len(own) and np.median(np.abs(found - lines)[there]) < 1e-9


@pytest.mark.parametrize("folder", ["rosie713", "rosie713-og10"])
def test_time_series_of_pyglider_and_og1_are_those_of_xarray(log_values, folder):
    path = next(p for p in files(DATA / "pyglider" / folder, "*.nc") if "adjusted" not in p.name)
    is_og1 = folder.endswith("og10")
    # Neither holds a ballast volume: a column without a unit stands for it.
    ballast = "BBP700" if is_og1 else "backscatter_700"
    log, said = read(log_values, "--column", f"vbd_cc={ballast}", path)
    with xarray.open_dataset(path, decode_times=False) as other:
        name = (lambda og1, own: og1) if is_og1 else (lambda og1, own: own)
        for channel, variable in [
            ("time_s", name("TIME", "time")),
            ("pressure_dbar", name("PRES", "pressure")),
            ("temperature_C", name("TEMP", "temperature")),
            ("salinity_psu", name("PSAL", "salinity")),
            ("conductivity_S_m", name("CNDC", "conductivity")),
            ("density_kg_m3", name("DENSITY", "density")),
            ("lat_deg", name("LATITUDE", "latitude")),
            ("depth_m", name("DEPTH", "depth")),
            ("vbd_cc", ballast),
        ]:
            assert_same(log[channel], other[variable].values)
        # Radians that are labelled degrees: pyglider's own table of this glider.
        assert "taken as radians" in said
        assert_same(log["pitch_rad"], other[name("PITCH", "pitch")].values)
