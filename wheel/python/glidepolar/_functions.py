"""The functions of the package: each does the work of the command of its name, with the same results."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping, Sequence
from contextlib import ExitStack
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Literal, Optional, Union

from ._command import Output, Progress, run
from ._log import Log, Reading, as_log, paths
from ._results import (
    Again,
    Comparison,
    Diagnosis,
    Glide,
    Identification,
    Plan,
    Simulation,
    Track,
    Turn,
    read_columns,
)
from ._vehicle import PathLike, Vehicle, as_vehicle
from .errors import InputError

AnyVehicle = Union[Vehicle, PathLike]
# Files, a Log, a DataFrame, a Dataset or a mapping of arrays.
AnyLog = Any
Trim = Literal["vehicle", "neutral"]
# A value, or a value and its standard error.
External = Union[float, tuple[float, float]]
# A file, or a table in memory.
AnyTable = Union[PathLike, Any]


def identify(
    log: AnyLog,
    vehicle: AnyVehicle,
    *,
    speed_column: Optional[str] = None,
    columns: Optional[Mapping[str, str]] = None,
    units: Optional[Mapping[str, str]] = None,
    cache: Union[PathLike, Iterable[PathLike]] = (),
    density: Optional[float] = None,
    half_window_s: Optional[float] = None,
    method: Literal["joint", "iterative"] = "joint",
    trim: Optional[Trim] = None,
    free: Iterable[str] = (),
    pin: Optional[Mapping[str, External]] = None,
    unsteady: bool = False,
    progress: Optional[Progress] = None,
) -> Identification:
    """Identifies the glide polar, the ballast offset and more from a flight log, and what the log cannot identify.

    Args:
        log: files of any maker, a Log, a DataFrame, a Dataset or a mapping of arrays.
        vehicle: a Vehicle, a vehicle file or the name of a built-in vehicle.
        speed_column: column of the measured speed through the water [m/s].
        columns, units, cache: as in `read`.
        density: in-situ density where the log gives none [kg/m3].
        half_window_s: half window of the filter for vertical velocity [s].
        method: all samples at once with errors, or the scheme of the tank paper.
        trim: the net weight of the baseline; by default neutral for a built-in vehicle, of the vehicle for a file.
        free: parameters to fit, too.
        pin: fixed parameters, a value or (value, standard error): `{"a": (21.0, 3.0)}`.
        unsteady: fly the dives through time, with added mass.
        progress: is called with what is counted, how many are done, and of how many where that is known.
    """
    options = _options(locals(), "density", "half_window_s", "method")
    taken = as_log(log, Reading(columns, units, cache, speed_column))
    options += [f"--free={name}" for name in free]
    options += [f"--pin={name}={_external(value)}" for name, value in (pin or {}).items()]
    options += ["--unsteady"] if unsteady else []
    return Identification(*_on_log("identify", taken, as_vehicle(vehicle), trim, options, progress))


def diagnose(
    log: AnyLog,
    vehicle: AnyVehicle,
    *,
    speed_column: Optional[str] = None,
    columns: Optional[Mapping[str, str]] = None,
    units: Optional[Mapping[str, str]] = None,
    cache: Union[PathLike, Iterable[PathLike]] = (),
    density: Optional[float] = None,
    half_window_s: Optional[float] = None,
    trim: Optional[Trim] = None,
    pin_lift: Union[bool, External] = False,
    relevant: Optional[Mapping[str, float]] = None,
    progress: Optional[Progress] = None,
) -> Diagnosis:
    """Finds what the steady glide gets wrong in a log, why, the extended vehicle and the gain on held-out data.

    Args:
        log, vehicle, speed_column, columns, units, cache, density, half_window_s, trim, progress: as in `identify`.
        pin_lift: fix the lift slope: at the vehicle's value (True), or at a value [1/rad] with its standard error.
        relevant: size above which a misfit is worth acting on: `{"vertical_velocity": 0.002}` [m/s].
    """
    options = _options(locals(), "density", "half_window_s")
    taken = as_log(log, Reading(columns, units, cache, speed_column))
    options += [f"--relevant={name}={value!r}" for name, value in (relevant or {}).items()]
    if pin_lift is True:
        options.append("--pin-lift")
    elif pin_lift is not False:
        options.append(f"--pin-lift={_external(pin_lift)}")
    return Diagnosis(*_on_log("diagnose", taken, as_vehicle(vehicle), trim, options, progress))


def track(
    log: AnyLog,
    vehicle: AnyVehicle,
    *,
    fixes: Optional[AnyTable] = None,
    declination_deg: Optional[float] = None,
    heading_error_deg: Optional[float] = None,
    speed_error_percent: Optional[float] = None,
    fixes_at: Literal["start", "middle"] = "start",
    fix_error_m: Optional[float] = None,
    density: Optional[float] = None,
    columns: Optional[Mapping[str, str]] = None,
    units: Optional[Mapping[str, str]] = None,
    cache: Union[PathLike, Iterable[PathLike]] = (),
) -> Track:
    """Reckons the track by the polar and the heading, and the depth-averaged currents between fixes.

    `to_pandas()` is the track. `fixes` is a table with time_s, lat_deg, lon_deg; by default those in the files.
    """
    options = _options_but(locals(), "log", "vehicle", "fixes", "columns", "units", "cache")
    taken, made = as_log(log, Reading(columns, units, cache)), as_vehicle(vehicle)

    def again(further: list[str]) -> Output:
        with ExitStack() as stack:
            command = ["glidepolar", "track", *taken.files, "--vehicle", stack.enter_context(made._named()), *options]
            command += taken._reading.arguments(has_speed=False)
            command += [] if fixes is None else ["--fixes", _file(fixes, stack)]
            return run([*command, *further])

    with TemporaryDirectory(prefix="glidepolar-") as folder:
        file = Path(folder) / "track.csv"
        output = again(["--json", "-", "--csv", str(file)])
        return Track(output, again, read_columns(file))


def glide(
    vehicle: AnyVehicle,
    *,
    net_mass_kg: Optional[float] = None,
    pitch_deg: Optional[float] = None,
    glide_angle_deg: Optional[float] = None,
    speed_m_s: Optional[float] = None,
    density: Optional[float] = None,
    depth_m: Optional[float] = None,
) -> Glide:
    """Computes one steady glide, or the polar at one net mass.

    Args:
        vehicle: a Vehicle, a vehicle file or the name of a built-in vehicle.
        net_mass_kg: net mass, positive when heavy [kg]; alone: the polar at this net mass.
        pitch_deg: pitch, nose up positive [deg]; with `net_mass_kg`.
        glide_angle_deg: glide path angle, negative when descending [deg]; with `speed_m_s`.
        speed_m_s: speed through the water [m/s].
        density: in-situ density [kg/m3]; by default the vehicle's reference.
        depth_m: depth, for compressible hulls [m].
    """
    output, again = _of_vehicle("glide", vehicle, _options_but(locals(), "vehicle"))
    made = Glide(output, again, {})
    values = made.to_dict()
    rows = (values.get("polar") or {}).get("glides") or [values["glide"]]
    numbers = [name for name, value in rows[0].items() if isinstance(value, (int, float))]
    return Glide(output, again, {name: [row[name] for row in rows] for name in numbers})


def turn(
    vehicle: AnyVehicle,
    *,
    rudder_deg: Optional[float] = None,
    roll_mass_deg: Optional[float] = None,
    net_mass_kg: Optional[float] = None,
    moving_mass_m: Optional[float] = None,
    pitch_deg: Optional[float] = None,
    sweep: Optional[str] = None,
    density: Optional[float] = None,
    depth_m: Optional[float] = None,
) -> Turn:
    """Computes steady turns: roll, pitch, speed, sideslip, turn rate, radius and stability.

    `sweep` varies one of the first five: `"roll-mass-deg=-60..60:11"`. Angles in degrees, net mass in kg.
    """
    return Turn(*_of_vehicle("turn", vehicle, _options_but(locals(), "vehicle")))


def plan(
    vehicle: AnyVehicle,
    *,
    depth_m: Optional[float] = None,
    battery_Wh: Optional[float] = None,
    battery_Ah: Optional[float] = None,
    battery_V: Optional[float] = None,
    days: Optional[float] = None,
    pitch_deg: Optional[float] = None,
    ballast_down_cc: Optional[float] = None,
    ballast_up_cc: Optional[float] = None,
    surface_ballast_cc: Optional[float] = None,
    dives_per_surfacing: Optional[float] = None,
    stay_min: Optional[float] = None,
    pitch_moves: Optional[float] = None,
    density: Optional[float] = None,
    model_error_percent: Optional[float] = None,
    sensor_W: Optional[float] = None,
    sensor_drag_m2: Optional[float] = None,
    moves: Optional[AnyTable] = None,
    dives: Optional[AnyTable] = None,
) -> Plan:
    """Plans energy per dive, dives, days and distance on one battery, and what one more sensor costs.

    Units stand in the names: m, Wh, Ah, V, d, deg, cm3, min, W. `moves` and `dives` are tables of battery counters.
    """
    options = _options_but(locals(), "vehicle", "moves", "dives")
    return Plan(*_of_vehicle("plan", vehicle, options, moves=moves, dives=dives))


def compare(
    *things: Any,
    vehicle: Optional[AnyVehicle] = None,
    net_mass_kg: Optional[float] = None,
    depth_m: Optional[float] = None,
    density: Optional[float] = None,
    speed_column: Optional[str] = None,
) -> Comparison:
    """Compares vehicles or logs: polars, speeds at the same ballast and pitch, energy of a dive.

    Each is a Vehicle, a name, a file, a Log or a DataFrame; logs are identified with `vehicle`.
    """
    options = _options_but(locals(), "things", "vehicle")
    made = [thing if isinstance(thing, (Vehicle, str, os.PathLike)) else as_log(thing, Reading()) for thing in things]

    def again(further: list[str]) -> Output:
        with ExitStack() as stack:
            names = []
            for thing in made:
                if isinstance(thing, Vehicle):
                    names.append(stack.enter_context(thing._named()))
                else:
                    names += thing.files if isinstance(thing, Log) else [os.fspath(thing)]
            of = [] if vehicle is None else ["--vehicle", stack.enter_context(as_vehicle(vehicle)._named())]
            return run(["glidepolar", "compare", *names, *of, *options, *further])

    return Comparison(again(["--json", "-"]), again)


def simulate(
    vehicle: AnyVehicle,
    *,
    mission: Optional[PathLike] = None,
    inputs: Optional[AnyTable] = None,
    sweep: Optional[AnyTable] = None,
    stop_s: Optional[float] = None,
    interval_s: Optional[float] = None,
    tolerance: Optional[float] = None,
    actuation: Optional[Literal["servo", "raw", "raw-along-axis1"]] = None,
    progress: Optional[Progress] = None,
) -> Simulation:
    """Flies the glider through time as its FMU does; `to_pandas()` is the time history.

    Args:
        vehicle: a Vehicle, a vehicle file or the name of a built-in vehicle.
        mission: a mission file (TOML): depths, pitch, ballast, surfacings, seabed, water. `result.log` is its flight log.
        inputs: inputs against `time` [s]: a file or a table, columns named as the FMU's inputs.
        sweep: a table of parameters, a row for each variant; the result has each one's last moment.
        stop_s: end of the time history [s].
        interval_s: time between two rows [s].
        tolerance: relative tolerance of the integration.
        actuation: who moves ballast and moving mass; servos by default.
        progress: as in `identify`; counts the variants of a sweep.
    """
    stop, interval = stop_s, interval_s
    options = _options(locals(), "stop", "interval", "tolerance", "actuation")
    options += [] if mission is None else ["--mission", os.fspath(mission)]
    with TemporaryDirectory(prefix="glidepolar-") as folder:
        file, log = Path(folder) / "history.csv", Path(folder) / "log.csv"
        first = ["--csv", str(file), *([] if mission is None else ["--log", str(log)])]
        output, again = _of_vehicle("simulate", vehicle, options, first, progress, inputs=inputs, sweep=sweep)
        return Simulation(output, again, read_columns(file), None if mission is None else read_columns(log))


def _on_log(
    command: str, log: Log, vehicle: Vehicle, trim: Optional[Trim], options: list[str], progress: Optional[Progress]
) -> tuple[Output, Again]:
    """Runs a command on a log; `progress` is for the first time only."""
    if trim is None and vehicle._given is None and vehicle._is_builtin:
        trim = "neutral"  # as the built-in vehicle that it was made of
    options = options + ([] if trim is None else ["--trim", trim]) + log._reading.arguments()

    def again(further: list[str], progress: Optional[Progress] = None) -> Output:
        # The log is kept by this function, and so are its columns in memory.
        with vehicle._named() as name:
            return run(["glidepolar", command, *log.files, "--vehicle", name, *options, *further], progress)

    return again(["--json", "-"], progress), again


def _of_vehicle(
    command: str,
    vehicle: AnyVehicle,
    options: list[str],
    first: Sequence[str] = (),
    progress: Optional[Progress] = None,
    **tables: Optional[AnyTable],
) -> tuple[Output, Again]:
    """Runs a command on a vehicle, with tables as files; `first` and `progress` are for the first time only."""
    made = as_vehicle(vehicle)

    def again(further: list[str], progress: Optional[Progress] = None) -> Output:
        with ExitStack() as stack:
            files = [
                word
                for name, table in tables.items()
                if table is not None
                for word in (f"--{name}", _file(table, stack))
            ]
            name = stack.enter_context(made._named())
            return run(["glidepolar", command, name, *options, *files, *further], progress)

    return again(["--json", "-", *first], progress), again


def _options(given: Mapping[str, Any], *names: str) -> list[str]:
    """Returns the arguments of these names as a command's options, as far as they were given; numbers to the last digit."""
    stated = ((name.replace("_", "-"), given[name]) for name in names if given[name] is not None)
    return [f"--{name}={value if isinstance(value, str) else repr(float(value))}" for name, value in stated]


def _options_but(given: Mapping[str, Any], *names: str) -> list[str]:
    """Returns all arguments but these as options."""
    return _options(given, *(name for name in given if name not in names))


def _external(value: External) -> str:
    if isinstance(value, tuple):
        return f"{float(value[0])!r}+-{float(value[1])!r}"
    return repr(float(value))


def _file(table: AnyTable, stack: ExitStack) -> str:
    """Returns the name of a file with the table; one in memory is written to a file, to the last digit."""
    if isinstance(table, (str, os.PathLike)):
        return paths(table)[0]
    file = Path(stack.enter_context(TemporaryDirectory(prefix="glidepolar-"))) / "table.csv"
    write_table(table, file)
    return str(file)


def write_table(table: Any, file: Path) -> None:
    """Writes a DataFrame or a mapping of columns as CSV."""
    names = list(table.variables) if hasattr(table, "data_vars") else list(table)
    columns = [[_cell(value) for value in table[name]] for name in names]
    if len({len(column) for column in columns}) > 1:
        raise InputError("the columns of a table differ in length")
    lines = [",".join(map(str, names)), *(",".join(row) for row in zip(*columns))]
    file.write_text("\n".join(lines) + "\n", encoding="utf-8")


def _cell(value: Any) -> str:
    """Returns a value as a cell; nothing for a missing one."""
    if value is None or value != value:
        return ""
    if hasattr(value, "item"):
        value = value.item()
    text = repr(value) if isinstance(value, float) else str(value)
    return '"' + text.replace('"', '""') + '"' if any(mark in text for mark in ',"\n') else text
