"""Writes one known dive in the dialects of public programs: NetCDF, CSV, and the makers' own tables."""

import datetime
import gzip
import struct
import zlib
from dataclasses import dataclass, field
from pathlib import Path

import netCDF4
import numpy as np

# 2022-06-13T18:00:00Z
START_S = 1_655_143_200.0
UNIX = "seconds since 1970-01-01T00:00:00Z"
RAD = np.pi / 180


@dataclass
class Dive:
    """A dive of a glider: what every dialect has to give back."""

    rows: int = 120
    start_s: float = START_S
    values: dict = field(default_factory=dict)

    def __post_init__(self):
        t = np.arange(self.rows) * 5.0
        down = t < t[-1] / 2
        pressure = np.where(down, 5 + 0.15 * t, 5 + 0.15 * (t[-1] - t))
        self.values = {
            "time_s": self.start_s + t,
            "pressure_dbar": pressure,
            "pitch_deg": np.where(down, -24.0, 26.0) + 0.5 * np.sin(t / 40),
            "roll_deg": 4.0 + np.cos(t / 30),
            "heading_deg": (350.0 + 0.05 * t) % 360.0,
            "vbd_cc": np.where(down, -180.0, 210.0),
            "temperature_C": 12.0 - 0.1 * pressure,
            "salinity_psu": 33.0 + 0.01 * pressure,
            "conductivity_S_m": 3.6 - 0.01 * pressure,
            "lat_deg": 48.0 + 1e-5 * t,
            "lon_deg": -124.0 - 1e-5 * t,
        }

    def __getitem__(self, name):
        return self.values[name]


def channel(name, unit="", factor=1.0, offset=0.0, **stored):
    """A variable that holds a channel in a unit: `factor` of them are one of the channel's own."""
    return {"of": lambda dive: dive[name] * factor + offset, "unit": unit, **stored}


def time(unit=UNIX, second=1.0, epoch_s=0.0, **stored):
    """Times that count from another day, in units of so many seconds."""
    return {"of": lambda dive: (dive["time_s"] - epoch_s) / second, "unit": unit, **stored}


# A time series as the OG1 format names it, with the ballast as programs name it that write it.
OG1 = {
    "TIME": time(),
    "PRES": channel("pressure_dbar", "dbar"),
    "PITCH": channel("pitch_deg", "degree"),
    "ROLL": channel("roll_deg", "degree"),
    "HEADING": channel("heading_deg", "degree"),
    "VBD_CC": channel("vbd_cc", "cm3"),
    "TEMP": channel("temperature_C", "Celsius"),
    "PSAL": channel("salinity_psu", "1e-3"),
    "CNDC": channel("conductivity_S_m", "mS cm-1", 10),
    "LATITUDE": channel("lat_deg", "degrees_north"),
    "LONGITUDE": channel("lon_deg", "degrees_east"),
}


def time_series(path: Path, dive: Dive, changes: dict | None = None, *, form="NETCDF4", unlimited=False, flags=None):
    """Writes a time series; `changes` replaces variables of OG1, those that are None are left out."""
    with netCDF4.Dataset(path, "w", format=form) as file:
        file.createDimension("N_MEASUREMENTS", None if unlimited else dive.rows)
        for name, spec in {**OG1, **(changes or {})}.items():
            if spec is not None:
                variable(
                    file, name, ("N_MEASUREMENTS",), spec["of"](dive), **{k: v for k, v in spec.items() if k != "of"}
                )
        for name, values in (flags or {}).items():
            file.createVariable(name, "i1", ("N_MEASUREMENTS",))[:] = values


def variable(file, name, dimensions, values, unit="", kind="f8", fill=None, pack=None, more=None):
    """Adds a variable: packed by (scale, offset) where asked for, missing values as the fill value."""
    made = file.createVariable(name, kind, dimensions, fill_value=fill)
    if unit:
        made.units = unit
    for key, value in (more or {}).items():
        setattr(made, key, value)
    made.set_auto_maskandscale(False)
    values = np.asarray(values, dtype=float)
    if pack:
        made.scale_factor, made.add_offset = pack
        values = (values - pack[1]) / pack[0]
    if not kind.startswith("f"):
        values = np.where(np.isfinite(values), np.round(values), 0 if fill is None else fill)
    elif fill is not None:
        values = np.where(np.isfinite(values), values, fill)
    made[:] = values.astype(kind)


def seaglider(
    path: Path,
    dive: Dive,
    *,
    form="NETCDF3_CLASSIC",
    number=1,
    glider="SG171",
    names=None,
    drop=(),
    one_clock=False,
    unit="seconds since 1970-1-1 00:00:00",
    epoch_s=0.0,
    second=1.0,
    add=None,
    log=None,
):
    """Writes a dive as the basestation does: the CTD on a clock of its own, begun one row later and ended two rows earlier."""
    names = names or {}
    with netCDF4.Dataset(path, "w", format=form) as file:
        file.createDimension("sg_data_point", dive.rows)
        file.platform_id, file.dive_number = glider, np.int32(number)

        def put(name, dimension, values, unit=""):
            if name not in drop:
                variable(file, names.get(name, name), (dimension,), values, unit)

        put("time", "sg_data_point", (dive["time_s"] - epoch_s) / second, unit)
        for name, of in [
            ("eng_pitchAng", "pitch_deg"),
            ("eng_rollAng", "roll_deg"),
            ("eng_head", "heading_deg"),
            ("eng_vbdCC", "vbd_cc"),
            ("latitude", "lat_deg"),
            ("longitude", "lon_deg"),
            ("pressure", "pressure_dbar"),
        ]:
            put(name, "sg_data_point", dive[of])
        ctd, rows = "sg_data_point", slice(None)
        if not one_clock:
            ctd, rows = "ctd_data_point", slice(1, -2)
            file.createDimension(ctd, dive.rows - 3)
            put("ctd_time", ctd, (dive["time_s"][rows] - epoch_s) / second, unit)
        put("ctd_pressure", ctd, dive["pressure_dbar"][rows], "dbar")
        put("temperature", ctd, dive["temperature_C"][rows], "degrees_Celsius")
        put("salinity", ctd, dive["salinity_psu"][rows], "PSU")
        put("conductivity", ctd, dive["conductivity_S_m"][rows], "S/m")
        file.createDimension("gps_info", 2)
        put("log_gps_time", "gps_info", dive.start_s + np.array([-20.0, 700.0]), "seconds since 1970-1-1 00:00:00")
        put("log_gps_lat", "gps_info", [48.0, 48.01])
        put("log_gps_lon", "gps_info", [-124.0, -124.01])
        for name, value in {"log_C_VBD": 3000.0, "log_VBD_MIN": 500.0, "log_VBD_CNV": -0.2453, **(log or {})}.items():
            file.createVariable(name, "f8", ())[...] = value
        if add:
            add(file)


def cells(path: Path, columns: dict, rows: int, *, separator=",", mark=".", units=None, above="", end="\n"):
    """Writes a table of text; a column is a function of the row, of a number or a text."""
    lines = [separator.join(columns)] + ([separator.join(units)] if units else [])
    for row in range(rows):
        values = [of(row) for of in columns.values()]
        lines.append(separator.join(v if isinstance(v, str) else repr(float(v)).replace(".", mark) for v in values))
    path.write_bytes((above + end.join(lines) + end).encode())


def date(unix_s: float, form="%Y-%m-%dT%H:%M:%SZ") -> str:
    """A time as a text."""
    return datetime.datetime.fromtimestamp(unix_s, datetime.UTC).strftime(form)


def minutes(degrees: float) -> float:
    """Degrees as a receiver writes them, DDMM.mmm."""
    whole = int(degrees)
    return 100 * whole + (degrees - whole) * 60


def dinkum_ascii(path: Path, dive: Dive, extension="dbd", end=""):
    """Writes what dbd2asc writes of a Slocum's file."""
    sensors = {
        "m_present_time": ("timestamp", dive["time_s"]),
        "sci_water_pressure": ("bar", dive["pressure_dbar"] / 10),
        "m_pitch": ("rad", dive["pitch_deg"] * RAD),
        "m_roll": ("rad", dive["roll_deg"] * RAD),
        "m_heading": ("rad", dive["heading_deg"] * RAD),
        "m_ballast_pumped": ("cc", dive["vbd_cc"]),
        "sci_water_temp": ("degc", dive["temperature_C"]),
        "sci_water_cond": ("s/m", dive["conductivity_S_m"]),
        "m_lat": ("lat", [minutes(x) for x in dive["lat_deg"]]),
        "m_lon": ("lon", [minutes(x) for x in dive["lon_deg"]]),
        "m_gps_mag_var": ("rad", [float("nan")] * dive.rows),
    }
    keys = {
        "dbd_label": "DBD_ASC(dinkum_binary_data_ascii)file",
        "encoding_ver": 2,
        "num_ascii_tags": 14,
        "all_sensors": 0,
        "filename": "amadeus-2014-204-05-000",
        "the8x3_filename": "00110000",
        "filename_extension": extension,
        "filename_label": f"amadeus-2014-204-05-000-{extension}(00110000)",
        "mission_name": "MICRO.MI",
        "fileopen_time": "Thu_Jul_24_17:00:00_2014",
        "sensors_per_cycle": len(sensors),
        "num_label_lines": 3,
        "num_segments": 1,
        "segment_filename_0": "amadeus-2014-204-05-000",
    }
    lines = [f"{key}: {value}" for key, value in keys.items()]
    lines += [" ".join(sensors) + " ", " ".join(unit for unit, _ in sensors.values()) + " ", "8 " * len(sensors)]
    lines += [" ".join(repr(float(values[row])) for _, values in sensors.values()) + " " for row in range(dive.rows)]
    path.write_text("\n".join(lines) + "\n" + end, encoding="utf-8")


def seaexplorer(
    vehicle: Path,
    payload: Path,
    dive: Dive,
    *,
    ctd="GPCTD",
    siemens=1.0,
    missing="9999",
    last=";",
    more="",
    clock="%d/%m/%Y %H:%M:%S",
):
    """Writes the table of the vehicle and that of its payload, gzipped where the name says so."""
    names = f"Timestamp;NavState;SecurityLevel;Heading;Declination;Pitch;Roll;Depth;Temperature;Pa;Lat;Lon;{more}DesiredH;BallastCmd;BallastPos;LinCmd;LinPos;AngCmd;AngPos;Voltage;Altitude{last}"
    own, other = (
        [names],
        [
            f"PLD_REALTIMECLOCK;NAV_RESOURCE;NAV_LONGITUDE;NAV_LATITUDE;NAV_DEPTH;{ctd}_CONDUCTIVITY;{ctd}_TEMPERATURE;{ctd}_PRESSURE;FLBBCD_CHL_COUNT{last}"
        ],
    )
    for row in range(dive.rows):
        of = {name: values[row] for name, values in dive.values.items()}
        time, state = date(of["time_s"], clock), 100 if of["pitch_deg"] < 0 else 117
        lat, lon, depth = minutes(of["lat_deg"]), minutes(of["lon_deg"]), of["pressure_dbar"] / 1.0055
        cells = [time, state, 0, of["heading_deg"], 15, of["pitch_deg"], of["roll_deg"], depth, 10, 79000, lat, lon]
        cells += ([0] if more else []) + [90, 0, of["vbd_cc"], 0, 30, 0, 10, 28, -1]
        own.append(";".join(map(str, cells)) + last)
        cells = [time + ".000", state, lon, lat, depth, of["conductivity_S_m"] * siemens, of["temperature_C"]]
        other.append(";".join(map(str, [*cells, of["pressure_dbar"], missing])) + last)
    for path, lines in [(vehicle, own), (payload, other)]:
        text = ("\n".join(lines) + "\n").encode()
        path.write_bytes(gzip.compress(text) if path.suffix == ".gz" else text)


# Sensors of a Slocum's binary file: bytes of a value, unit, and what they are of a dive.
SLOCUM = {
    "m_present_time": (8, "timestamp", lambda dive: dive["time_s"]),
    "sci_water_pressure": (4, "bar", lambda dive: dive["pressure_dbar"] / 10),
    "m_pitch": (4, "rad", lambda dive: dive["pitch_deg"] * RAD),
    "m_roll": (4, "rad", lambda dive: dive["roll_deg"] * RAD),
    "m_heading": (4, "rad", lambda dive: dive["heading_deg"] * RAD),
    "m_ballast_pumped": (4, "cc", lambda dive: dive["vbd_cc"]),
    "sci_water_temp": (4, "degc", lambda dive: dive["temperature_C"]),
    "sci_water_cond": (4, "s/m", lambda dive: dive["conductivity_S_m"]),
}


def slocum_list(more=0) -> bytes:
    """The list of sensors, `more` of them that nobody asks for."""
    sensors = [*((name, size, unit) for name, (size, unit, _) in SLOCUM.items())]
    sensors += [(f"x_other_{i}", 8, "nodim") for i in range(more)]
    return b"".join(f"s: T {i:4} {i:4} {size} {name} {unit}\n".encode() for i, (name, size, unit) in enumerate(sensors))


def slocum_crc(sensors: bytes) -> str:
    """The checksum by which a file names its list: CRC-32 without the inversion at the end."""
    return f"{~zlib.crc32(sensors) & 0xFFFFFFFF:08x}"


def slocum(path: Path, dive: Dive, *, glider="unit_1", more=0, factored=False, lacks=(), segment=0) -> np.dtype:
    """Writes a binary file, every sensor new in every cycle; the type of a cycle comes back."""
    sensors = slocum_list(more)
    count = len(SLOCUM) + more
    lines = {
        "dbd_label": "DBD(dinkum_binary_data)file",
        "encoding_ver": 5,
        "num_ascii_tags": 14,
        "all_sensors": "T",
        "the8x3_filename": "01600000",
        "full_filename": f"{glider}-2020-257-0-{segment}",
        "filename_extension": "dbd",
        "mission_name": "LAKE.MI",
        "fileopen_time": datetime.datetime.fromtimestamp(dive["time_s"][0], datetime.UTC).strftime("%a_%b_%d_%H:%M:%S_%Y"),
        "total_num_sensors": count,
        "sensors_per_cycle": count,
        "state_bytes_per_cycle": -(-count // 4),
        "sensor_list_crc": slocum_crc(sensors).upper(),
        "sensor_list_factored": int(factored),
    }
    text = "".join(f"{key}:    {value}\n" for key, value in lines.items()).encode()
    known = b"sa" + struct.pack("<hfd", 0x1234, 123.456, 123456789.12345)
    state = np.frombuffer(np.packbits(np.tile([1, 0], 4 * -(-count // 4))).tobytes(), np.uint8).copy()
    # Places beyond the last sensor are not set.
    for place in range(count, 4 * len(state)):
        state[place // 4] &= ~(0b11 << (6 - 2 * (place % 4))) & 0xFF
    fields = [("d", "S1"), ("state", "u1", (len(state),))]
    fields += [(name, f"<f{size}") for name, (size, _, _) in SLOCUM.items()]
    fields += [("more", "<f8", (more,))] if more else []
    cycles = np.zeros(dive.rows, np.dtype(fields))
    cycles["d"], cycles["state"] = b"d", state
    for name, (_, _, of) in SLOCUM.items():
        cycles[name] = np.nan if name in lacks else of(dive)
    with open(path, "wb") as file:
        file.write(text + (b"" if factored else sensors) + known)
        cycles.tofile(file)
        file.write(b"X")
    return cycles.dtype
