"""Logs in the dialects that public programs write: one known dive, written by netCDF4 or as text, comes back value for value."""

import csv
import io
import subprocess

import log_files
import netCDF4
import numpy as np
import pytest
from log_files import OG1, RAD, Dive, channel, date, time

DIVE = Dive()
EPOCHS = {"1950": -631_152_000, "1858": -3_506_716_800, "1900": -2_208_988_800, "0000": -719_528 * 86_400}


def read(log_values, *arguments):
    """The columns of a log, and what was said of it."""
    done = subprocess.run([log_values, *map(str, arguments)], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    rows = list(csv.DictReader(io.StringIO(done.stdout)))
    number = {name: np.array([float(row[name] or "nan") for row in rows]) for name in rows[0]}
    return number, done.stderr


def assert_is_the_dive(log, dive=DIVE, without=(), error=1e-9):
    """Compares each channel; an instrument with a clock of its own may begin and end two rows from the others."""
    for name in dive.values:
        if name in without:
            continue
        is_angle = name in ("pitch_deg", "roll_deg", "heading_deg")
        found, truth = log[name.replace("_deg", "_rad")] / RAD if is_angle else log[name], dive[name]
        assert len(found) == dive.rows, name
        known = np.isfinite(found)
        assert known.sum() >= dive.rows - 4, name
        difference = (found - truth)[known]
        if name == "heading_deg":
            difference = (difference + 180) % 360 - 180
        # A clock in days counts microseconds.
        most = 2e-5 if name == "time_s" else error * max(1, np.abs(truth).max())
        assert np.abs(difference).max() <= most, (name, np.abs(difference).max())


def assert_time_series_is_read(log_values, path, changes=None, error=1e-9, without=(), **how):
    log_files.time_series(path, DIVE, changes, **how)
    log, said = read(log_values, path)
    assert_is_the_dive(log, error=error, without=without)
    return said


@pytest.mark.parametrize("unlimited", [False, True])
@pytest.mark.parametrize(
    "form", ["NETCDF4", "NETCDF4_CLASSIC", "NETCDF3_CLASSIC", "NETCDF3_64BIT_OFFSET", "NETCDF3_64BIT_DATA"]
)
def test_every_form_of_netcdf_is_read(log_values, tmp_path, form, unlimited):
    assert_time_series_is_read(log_values, tmp_path / "og1.nc", form=form, unlimited=unlimited)
    log_files.seaglider(tmp_path / "p1710001.nc", DIVE, form=form)
    assert_is_the_dive(read(log_values, tmp_path / "p1710001.nc")[0], without=["conductivity_S_m"])


@pytest.mark.parametrize(
    ("unit", "second", "epoch_s"),
    [
        ("seconds since 1970-1-1", 1, 0),
        ("Seconds since 1970-01-01T00:00:00.000000", 1, 0),
        ("seconds since 2022-06-13 02:00:00 +02:00", 1, 1_655_078_400),
        ("seconds since 1990-01-01 00:00:00 UTC", 1, 631_152_000),
        ("minutes since 2022-06-13", 60, 1_655_078_400),
        ("hours since 1900-01-01 00:00:0.0", 3600, EPOCHS["1900"]),
        ("days since 1950-01-01T00:00:00Z", 86_400, EPOCHS["1950"]),
        ("days since 1858-11-17", 86_400, EPOCHS["1858"]),
        ("days since 0000-01-01 00:00:00", 86_400, EPOCHS["0000"]),
        ("microseconds since 1970-01-01", 1e-6, 0),
        ("timestamp", 1, 0),
        ("UTC", 1, 0),
        ("epoch seconds", 1, 0),
        ("", 1, 0),
    ],
)
def test_times_count_from_the_day_that_the_file_states(log_values, tmp_path, unit, second, epoch_s):
    assert_time_series_is_read(log_values, tmp_path / "og1.nc", {"TIME": time(unit, second, epoch_s)})
    if " since " in unit:
        log_files.seaglider(tmp_path / "p1710001.nc", DIVE, unit=unit, second=second, epoch_s=epoch_s)
        assert_is_the_dive(read(log_values, tmp_path / "p1710001.nc")[0], without=["conductivity_S_m"])


@pytest.mark.parametrize(
    ("kind", "unit", "second"),
    [("i8", "nanoseconds", 1e-9), ("i8", "milliseconds", 1e-3), ("i4", "seconds", 1), ("u4", "seconds", 1)],
)
def test_times_may_be_whole_numbers(log_values, tmp_path, kind, unit, second):
    changes = {"TIME": time(f"{unit} since 1970-01-01", second, kind=kind)}
    assert_time_series_is_read(log_values, tmp_path / "og1.nc", changes)


def test_packed_and_short_numbers_are_unpacked_and_fill_values_are_missing(log_values, tmp_path):
    packed = {
        "PRES": channel("pressure_dbar", "dbar", kind="i2", pack=(0.01, 300.0), fill=-32768),
        "TEMP": channel("temperature_C", "degree_Celsius", kind="i2", pack=(0.001, 10.0), fill=-32767),
        "PSAL": channel("salinity_psu", "1", kind="f4", fill=-999.0),
    }
    assert_time_series_is_read(log_values, tmp_path / "og1.nc", packed, error=2e-4)
    holes = Dive()
    for name, value in [("temperature_C", np.nan), ("salinity_psu", np.nan)]:
        holes.values[name] = np.where(np.arange(holes.rows) % 10 == 3, value, holes[name])
    kinds = {**packed, "TEMP": channel("temperature_C", "degC", more={"missing_value": -99999.0}, fill=-99999.0)}
    log_files.time_series(tmp_path / "holes.nc", holes, kinds)
    log, _ = read(log_values, tmp_path / "holes.nc")
    for name in ["temperature_C", "salinity_psu"]:
        assert (np.isnan(log[name]) == np.isnan(holes[name])).all(), name


UNITS = {
    "TEMP": (
        "temperature_C",
        [
            ("K", 1, 273.15),
            ("kelvin", 1, 273.15),
            *(
                (u, 1, 0)
                for u in ["degrees_C", "deg C", "degree Celsius", "ITS-90", "\u00b0C", "degrees_Celsius", "Deg C"]
            ),
        ],
    ),
    "PRES": (
        "pressure_dbar",
        [
            ("bar", 0.1, 0),
            ("Pa", 1e4, 0),
            ("kPa", 10, 0),
            ("mbar", 100, 0),
            ("pascal", 1e4, 0),
            ("decibars", 1, 0),
            ("dBar", 1, 0),
            ("", 1, 0),
        ],
    ),
    "CNDC": (
        "conductivity_S_m",
        [(u, 1, 0) for u in ["S m-1", "S.m-1", "S/m", "mhos/m", "Siemens/m", "S m^-1"]]
        + [(u, 10, 0) for u in ["mS/cm", "mS.cm-1", "mS cm**-1", "mmho cm-1", ""]]
        + [("uS/cm", 1e4, 0)],
    ),
    "PITCH": (
        "pitch_deg",
        [
            ("rad", RAD, 0),
            ("radians", RAD, 0),
            *((u, 1, 0) for u in ["degrees", "Degrees", "arc_degree", "angular degrees", "degree_T"]),
        ],
    ),
    "VBD_CC": (
        "vbd_cc",
        [(u, 1, 0) for u in ["cc", "cm^3", "cm**3", "cm\u00b3", "cubic_centimeter", "cubic centimeters", "mL", "1", ""]]
        + [("m3", 1e-6, 0), ("L", 1e-3, 0)],
    ),
    "PSAL": (
        "salinity_psu",
        [(u, 1, 0) for u in ["1", "PSU", "1e-3", "0.001", "PSS-78", "practical salinity units", "ppt", "g kg-1"]],
    ),
}


@pytest.mark.parametrize("name", UNITS)
def test_units_are_known_as_programs_write_them(log_values, tmp_path, name, subtests):
    of, units = UNITS[name]
    for unit, factor, offset in units:
        with subtests.test(unit):
            changes = {name: channel(of, unit, factor, offset)}
            assert_time_series_is_read(log_values, tmp_path / "og1.nc", changes, error=1e-8)


NAMES = {
    "TIME": ["time", "Time", "m_present_time", "sci_m_present_time", "ctd_time", "ctd_epoch_time", "timestamp", "JULD"],
    "PRES": [
        "pressure",
        "Pressure",
        "press",
        "pres",
        "PRES_ADJUSTED",
        "sci_water_pressure",
        "m_pressure",
        "ctd_pressure",
        "LEGATO_PRESSURE",
        "sea_water_pressure",
    ],
    "PITCH": ["pitch", "GLIDER_PITCH", "m_pitch", "eng_pitchAng", "platform_pitch_angle", "PLATFORM_PITCH"],
    "ROLL": ["roll", "GLIDER_ROLL", "m_roll", "platform_roll_angle"],
    "HEADING": ["heading", "GLIDER_HEADING", "m_heading", "eng_head", "platform_yaw_angle", "platform_orientation"],
    "VBD_CC": [
        "vbd_cc",
        "vbdCC",
        "eng_vbdCC",
        "ballast_pumped",
        "m_ballast_pumped",
        "m_de_oil_vol",
        "BallastPos",
        "BALLAST",
        "ballast_volume",
        "GLIDER_VBD",
    ],
    "TEMP": ["temperature", "temp", "TEMPERATURE", "sci_water_temp", "sea_water_temperature", "GPCTD_TEMPERATURE"],
    "PSAL": ["salinity", "SALINITY", "practical_salinity", "sea_water_practical_salinity", "PSAL_ADJUSTED"],
    "CNDC": ["conductivity", "sci_water_cond", "cond", "sea_water_electrical_conductivity", "LEGATO_CONDUCTIVITY"],
    "LATITUDE": ["latitude", "lat", "LAT", "m_lat"],
    "LONGITUDE": ["longitude", "lon", "LON", "m_lon"],
}


@pytest.mark.parametrize("name", NAMES)
def test_names_are_known_as_programs_write_them(log_values, tmp_path, name, subtests):
    for other in NAMES[name]:
        with subtests.test(other):
            assert_time_series_is_read(log_values, tmp_path / "og1.nc", {name: None, other: OG1[name]})
    standard = {"PRES": "sea_water_pressure", "PITCH": "platform_pitch_fore_up", "TEMP": "sea_water_temperature"}
    if name in standard:
        other = {**OG1[name], "more": {"standard_name": standard[name]}}
        assert_time_series_is_read(log_values, tmp_path / "og1.nc", {name: None, "x7": other})


def test_values_flagged_bad_are_missing(log_values, tmp_path):
    flags = np.where(np.arange(DIVE.rows) % 4 == 0, 4, 1)
    log_files.time_series(tmp_path / "og1.nc", DIVE, flags={"TEMP_QC": flags, "PSAL_QC": np.ones(DIVE.rows)})
    log, said = read(log_values, tmp_path / "og1.nc")
    assert (np.isnan(log["temperature_C"]) == (flags == 4)).all() and np.isfinite(log["salinity_psu"]).all()
    assert "30 of 120 values of `TEMP`" in said


@pytest.mark.parametrize("dimensions", [("N_MEASUREMENTS",), ("N_MEASUREMENTS", "string1")])
def test_flags_may_be_characters(log_values, tmp_path, dimensions):
    bad = np.arange(DIVE.rows) % 4 == 0
    log_files.time_series(tmp_path / "og1.nc", DIVE)
    with netCDF4.Dataset(tmp_path / "og1.nc", "a") as file:
        file.createDimension("string1", 1)
        flags = np.where(bad, b"4", b"1").astype("S1")
        file.createVariable("TEMP_QC", "S1", dimensions)[:] = flags.reshape(-1, *[1] * (len(dimensions) - 1))
    log, said = read(log_values, tmp_path / "og1.nc")
    assert (np.isnan(log["temperature_C"]) == bad).all() and "30 of 120 values of `TEMP`" in said


@pytest.mark.parametrize("fill", [-999.0, -9999.0, 1e20, 9.969209968386869e36])
@pytest.mark.parametrize("kind", ["og1", "seaglider", "csv"])
def test_numbers_that_no_channel_has_are_missing_though_no_file_says_so(log_values, tmp_path, kind, fill):
    holes, names = Dive(), ["vbd_cc", "roll_deg", "temperature_C"]
    missing = np.arange(holes.rows) % 10 == 3
    for name in names:
        holes.values[name] = np.where(missing, fill, holes[name])
    path = tmp_path / "log"
    if kind == "og1":
        log_files.time_series(path, holes)
    elif kind == "seaglider":
        log_files.seaglider(path, holes, one_clock=True)
    else:
        log_files.cells(path, {name: (lambda row, name=name: holes[name][row]) for name in holes.values}, holes.rows)
    log, _ = read(log_values, path)
    for name in names:
        found = log[name.replace("_deg", "_rad")] / (RAD if "deg" in name else 1)
        # On one clock nothing is brought to other times, and what is missing stays so.
        assert np.allclose(found[~missing], DIVE[name][~missing]), name
        assert (np.isnan(found) == missing).all() or np.abs(found - DIVE[name]).max() < 5, name


def test_of_two_pressures_the_one_with_values_is_taken_and_depths_above_the_surface_are_turned_round(
    log_values, tmp_path
):
    empty = {"of": lambda dive: np.full(dive.rows, np.nan), "unit": "dbar"}
    two = {"PRES": None, "pressure": empty, "m_pressure": channel("pressure_dbar", "bar", 0.1)}
    assert_time_series_is_read(log_values, tmp_path / "og1.nc", two)
    log_files.time_series(
        tmp_path / "up.nc", DIVE, {"DEPTH_Z": channel("pressure_dbar", "m", -1, more={"positive": "up"})}
    )
    assert np.allclose(read(log_values, tmp_path / "up.nc")[0]["depth_m"], DIVE["pressure_dbar"])


def test_positions_in_degrees_and_minutes_and_a_receivers_own(log_values, tmp_path):
    of = {
        "LATITUDE": {"of": lambda dive: np.array([log_files.minutes(x) for x in dive["lat_deg"]])},
        "LONGITUDE": {"of": lambda dive: np.array([log_files.minutes(x) for x in dive["lon_deg"]])},
    }
    receiver = {"m_gps_lat": of["LATITUDE"], "m_gps_lon": of["LONGITUDE"]}
    said = assert_time_series_is_read(
        log_values,
        tmp_path / "og1.nc",
        {**of, **receiver, "TIME": time("days since 1950-01-01", 86_400, EPOCHS["1950"])},
    )
    # When the position of the first row was received is not known: the first fix is a later one at the surface.
    time_s, lat_deg, lon_deg = [float(x) for x in said.split("fix: ")[1].split()[:3]]
    way_deg = 1e-5 * (time_s - DIVE.start_s)
    assert time_s > DIVE.start_s
    assert np.allclose([lat_deg, lon_deg], [48.0 + way_deg, -124.0 - way_deg], atol=2e-5)


SEAGLIDERS = {
    "one clock": {"one_clock": True},
    "other names of clocks": {"names": {"time": "epoch_time", "ctd_time": "ctd_epoch_time"}},
    "times without a unit": {"unit": ""},
    "raw values only": {"names": {"temperature": "temperature_raw", "salinity": "salinity_raw"}},
    "a pumped CTD": {
        "names": {
            "ctd_time": "gpctd_time",
            "ctd_pressure": "gpctd_pressure",
            "temperature": "gpctd_temperature",
            "salinity": "gpctd_salinity",
        }
    },
    "a Legato": {
        "names": {
            "ctd_time": "legato_time",
            "ctd_pressure": "legato_pressure",
            "temperature": "legato_temp",
            "salinity": "legato_salinity",
        }
    },
    "no positions": {"drop": ["log_gps_time", "log_gps_lat", "log_gps_lon"]},
}


@pytest.mark.parametrize("kind", SEAGLIDERS)
def test_files_of_every_basestation_are_read(log_values, tmp_path, kind):
    log_files.seaglider(tmp_path / "p1710001.nc", DIVE, **SEAGLIDERS[kind])
    assert_is_the_dive(read(log_values, tmp_path / "p1710001.nc")[0], without=["conductivity_S_m"])


def test_a_dive_that_was_never_processed_counts_from_its_start(log_values, tmp_path):
    def add(file):
        log_files.variable(file, "eng_elaps_t", ("sg_data_point",), DIVE["time_s"] - DIVE.start_s)
        file.start_time = DIVE.start_s

    log_files.seaglider(tmp_path / "p1710001.nc", DIVE, one_clock=True, drop=["time"], add=add)
    assert_is_the_dive(read(log_values, tmp_path / "p1710001.nc")[0], without=["conductivity_S_m"])


def test_the_conductivity_serves_where_there_is_no_salinity(log_values, tmp_path):
    log_files.seaglider(tmp_path / "p1710001.nc", DIVE, drop=["salinity"])
    assert_is_the_dive(read(log_values, tmp_path / "p1710001.nc")[0], without=["salinity_psu"])


def column(name, factor=1.0):
    return lambda row: DIVE[name][row] * factor


ERDDAP = {
    "time": lambda row: date(DIVE["time_s"][row]),
    "latitude": column("lat_deg"),
    "longitude": column("lon_deg"),
    "pressure": column("pressure_dbar"),
    "pitch": column("pitch_deg"),
    "roll": column("roll_deg"),
    "heading": column("heading_deg"),
    "m_ballast_pumped": column("vbd_cc"),
    "temperature": column("temperature_C"),
    "salinity": column("salinity_psu"),
    "conductivity": column("conductivity_S_m", 10),
}
ERDDAP_UNITS = [
    "UTC",
    "degrees_north",
    "degrees_east",
    "dbar",
    "degree",
    "degree",
    "degree",
    "cm3",
    "degree_C",
    "1",
    "mS cm-1",
]
OWN = {name: column(name) for name in DIVE.values}


@pytest.mark.parametrize("separator", [",", "\t", ";"])
def test_units_below_the_names_or_in_brackets_are_read(log_values, tmp_path, separator):
    path = tmp_path / "log.csv"
    log_files.cells(path, ERDDAP, DIVE.rows, units=ERDDAP_UNITS, separator=separator)
    assert_is_the_dive(read(log_values, path)[0])
    for form in ["{} ({})", "{}[{}]"]:
        named = {form.format(name, unit): of for (name, of), unit in zip(ERDDAP.items(), ERDDAP_UNITS, strict=True)}
        log_files.cells(path, named, DIVE.rows, separator=separator)
        assert_is_the_dive(read(log_values, path)[0])


@pytest.mark.parametrize(
    "how",
    [
        {"separator": ";", "mark": ","},
        {"separator": "\t", "mark": ","},
        {"separator": ";", "above": "sep=;\n"},
        {"separator": "|"},
        {"above": "\ufeff"},
        {"end": "\r\n"},
        {"above": "# a remark\n#another\n"},
    ],
)
def test_tables_are_read_as_spreadsheets_write_them(log_values, tmp_path, how):
    log_files.cells(tmp_path / "log.csv", OWN, DIVE.rows, **how)
    assert_is_the_dive(read(log_values, tmp_path / "log.csv")[0])


def test_a_degree_sign_in_the_letters_of_an_old_program_is_known(log_values, tmp_path):
    named = {"time_s": "time_s", "pressure_dbar": "pressure (dbar)", "pitch_deg": "pitch (\u00b0)", "vbd_cc": "vbd (cm\u00b3)"}
    path = tmp_path / "log.csv"
    log_files.cells(path, {new: column(name) for name, new in named.items()}, DIVE.rows)
    path.write_bytes(path.read_text(encoding="utf-8").encode("latin-1"))
    log, _ = read(log_values, path)
    assert np.allclose(log["pitch_rad"] / RAD, DIVE["pitch_deg"]) and np.allclose(log["vbd_cc"], DIVE["vbd_cc"])


@pytest.mark.parametrize(
    ("unit", "second", "epoch_s"),
    [
        ("excel", 86_400, -25_569 * 86_400),
        ("matlab", 86_400, -719_529 * 86_400),
        ("julian", 86_400, -2_440_587.5 * 86_400),
        ("ms", 1e-3, 0),
        ("ns", 1e-9, 0),
    ],
)
def test_times_that_are_no_seconds_are_refused_until_their_unit_is_stated(log_values, tmp_path, unit, second, epoch_s):
    path = tmp_path / "log.csv"
    log_files.cells(path, {**OWN, "time_s": lambda row: (DIVE["time_s"][row] - epoch_s) / second}, DIVE.rows)
    done = subprocess.run([log_values, path], capture_output=True, text=True, check=False)
    assert done.returncode == 2 and "log.csv" in done.stderr and f"--unit time_s={unit}" in done.stderr, done.stderr
    log, _ = read(log_values, "--unit", f"time_s={unit}", path)
    # A Julian day has no more than 40 microseconds.
    assert np.abs(log["time_s"] - DIVE["time_s"]).max() < 5e-5


def test_the_tables_of_both_computers_of_a_slocum_are_one_log(log_values, tmp_path):
    flight = {
        "m_battpos": lambda row: "" if row % 7 else 0.5,
        "m_ballast_pumped": column("vbd_cc"),
        "m_gps_lat": lambda row: "",
        "m_heading": column("heading_deg", RAD),
        "m_pitch": column("pitch_deg", RAD),
        "m_present_time": column("time_s"),
        "m_roll": column("roll_deg", RAD),
        "m_lat": lambda row: log_files.minutes(DIVE["lat_deg"][row]),
        "m_lon": lambda row: log_files.minutes(DIVE["lon_deg"][row]),
    }
    science = {
        "i": lambda row: str(row),
        "sci_m_present_time": lambda row: DIVE["time_s"][row],
        "sci_water_pressure": column("pressure_dbar", 0.1),
        "sci_water_temp": column("temperature_C"),
        "sci_water_cond": column("conductivity_S_m"),
    }
    names = [tmp_path / "unit_5-2025-056-0-27.sbd.csv", tmp_path / "unit_5-2025-056-0-27.tbd.csv"]
    for name, columns in zip(names, [flight, science], strict=True):
        log_files.cells(name, columns, DIVE.rows)
    log, said = read(log_values, *names)
    assert_is_the_dive(log, without=["salinity_psu"])
    assert np.allclose(log["battpos_m"][np.isfinite(log["battpos_m"])], 0.5 * 0.0254) and "left out" not in said


@pytest.mark.parametrize("word", ["", "NaN", "nan", "NA", "N/A", "null", "NULL", "None", "--"])
def test_words_for_a_missing_value_are_known(log_values, tmp_path, word):
    log_files.cells(tmp_path / "log.csv", {**OWN, "coulomb_Ah": lambda row: word}, DIVE.rows)
    log, _ = read(log_values, tmp_path / "log.csv")
    assert_is_the_dive(log)
    assert np.isnan(log["coulomb_Ah"]).all()


@pytest.mark.parametrize(
    "form",
    [
        "%Y-%m-%dT%H:%M:%SZ",
        "%Y-%m-%d %H:%M:%S",
        "%Y-%m-%d %H:%M:%S UTC",
        "%Y-%m-%dT%H:%M:%S.000+0000",
        "%Y%m%dT%H%M%SZ",
        "%d/%m/%Y %H:%M:%S",
        "%d.%m.%Y %H:%M:%S",
        "%d-%b-%Y %H:%M:%S",
    ],
)
def test_dates_are_read_as_programs_write_them(log_values, tmp_path, form):
    log_files.cells(tmp_path / "log.csv", {**OWN, "time_s": lambda row: date(DIVE["time_s"][row], form)}, DIVE.rows)
    assert_is_the_dive(read(log_values, tmp_path / "log.csv")[0])


@pytest.mark.parametrize(("extension", "end"), [("dbd", ""), ("sbd", ""), ("dbd", "1655143800.0 1.5 0.3")])
def test_slocum_files_as_text_are_read(log_values, tmp_path, extension, end):
    log_files.dinkum_ascii(tmp_path / "amadeus.dba", DIVE, extension, end)
    log, said = read(log_values, tmp_path / "amadeus.dba")
    assert_is_the_dive(log, without=["salinity_psu"])
    assert ("such rows are left out" in said) == bool(end)


@pytest.mark.parametrize(
    ("names", "how"),
    [
        (("sea035.12.gli.sub.5", "sea035.12.pld1.raw.5"), {}),
        (("sea035.12.gli.sub.05.gz", "sea035.12.pld1.sub.5.gz"), {}),
        (("sea035.12.gli.sub.all.csv", "sea035.12.pld1.raw.all.csv"), {}),
        (("gli.csv", "pld.csv"), {"missing": ""}),
        (("sea035.12.gli.sub.5", "sea035.12.pld1.raw.5"), {"ctd": "LEGATO", "siemens": 10.0, "more": "DeadReckoning;"}),
        (("sea035.12.gli.sub.5", "sea035.12.pld1.raw.5"), {"ctd": "RBR", "siemens": 10.0, "last": ""}),
        (("sea035.12.gli.sub.5", "sea035.12.pld1.raw.5"), {"ctd": "CTD", "clock": "%Y-%m-%d %H:%M:%S"}),
    ],
)
def test_tables_of_a_seaexplorer_are_read(log_values, tmp_path, names, how):
    files = [tmp_path / name for name in names]
    log_files.seaexplorer(*files, DIVE, **how)
    log, said = read(log_values, *files)
    assert_is_the_dive(log, without=["salinity_psu"])
    assert np.allclose(log["roll_mass_rad"], 10 * RAD) and np.allclose(log["battpos_m"], 0.03)
    assert "warning" not in said


@pytest.mark.parametrize("separator", [";", ",", "\t"])
def test_tables_of_a_seaexplorer_that_a_spreadsheet_saved_again_are_read(log_values, tmp_path, separator):
    files = [tmp_path / "sea035.12.gli.sub.5", tmp_path / "sea035.12.pld1.raw.5"]
    log_files.seaexplorer(*files, DIVE)
    for path in files:
        rows = [line.split(";") for line in path.read_text(encoding="utf-8").splitlines()]
        lines = [separator.join(f'"{cell}"' for cell in row) for row in rows]
        path.write_bytes(("\r\n".join(lines) + "\r\n").encode())
    log, said = read(log_values, *files)
    assert_is_the_dive(log, without=["salinity_psu"])
    assert "warning" not in said
