"""Vehicles: built-in ones, files, and changed ones."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from html import escape
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Optional, Union

from . import _native
from ._command import run
from ._fmu import fmu_path

PathLike = Union[str, "os.PathLike[str]"]


class Vehicle:
    """Is a glider: coefficients, masses, buoyancy engine, energy.

    Takes the name of a built-in vehicle (`Vehicle.builtin()`) or a vehicle file (TOML).

    >>> Vehicle("slocum-049")["hydro.b"]
    0.25
    """

    def __init__(self, name_or_file: PathLike) -> None:
        given = os.fspath(name_or_file)
        self._text, self._name, self._source, self._is_builtin = _native.load_vehicle(given)
        # Handed on as it was given, so that reports name it and built-in vehicles stay that.
        self._given: Optional[str] = given

    @classmethod
    def parse(cls, text: str) -> Vehicle:
        """Reads the text of a vehicle file."""
        return cls._of(_native.changed_vehicle(text, []), text)

    @classmethod
    def _of(cls, parts: tuple[str, str, str, bool], text: Optional[str] = None) -> Vehicle:
        made = cls.__new__(cls)
        made._text, made._name, made._source, made._is_builtin = parts
        made._text = made._text if text is None else text
        made._given = None
        return made

    @staticmethod
    def builtin() -> list[str]:
        """Returns the names of the built-in vehicles."""
        return _native.builtin_vehicles()

    @staticmethod
    def keys() -> dict[str, str]:
        """Returns the keys of a vehicle file, each with its unit and meaning."""
        return {path: f"[{unit}] {meaning}" for path, unit, meaning in _native.vehicle_keys()}

    @property
    def name(self) -> str:
        """The vehicle's name, as reports have it."""
        return self._name

    @property
    def source(self) -> str:
        """Where its numbers are from."""
        return self._source

    def __getitem__(self, key: str) -> float:
        """Returns the value of a key, in the unit that `keys()` states."""
        value = _native.vehicle_value(self._text, key)
        if value is None:
            raise KeyError(key)
        return value

    def get(self, key: str, default: Optional[float] = None) -> Optional[float]:
        """Returns the value of a key where the file states it."""
        value = _native.vehicle_value(self._text, key)
        return default if value is None else value

    def with_values(self, values: Mapping[str, float]) -> Vehicle:
        """Returns a vehicle with other values, each within the bounds of a file: `{"hydro.b": 0.14}`."""
        changed = _native.changed_vehicle(self._text, [(key, float(value)) for key, value in values.items()])
        made = Vehicle._of(changed)
        made._is_builtin = self._is_builtin
        return made

    def to_toml(self) -> str:
        """Returns the text of the vehicle file."""
        return self._text

    def save(self, path: PathLike, force: bool = False) -> Path:
        """Writes the vehicle file; replaces one only with `force`."""
        target = Path(path)
        with target.open("w" if force else "x", encoding="utf-8") as file:
            file.write(self._text)
        return target

    def fmu(self, path: PathLike, fmi_version: int = 3, force: bool = False) -> Path:
        """Packs the vehicle as an FMU for FMI 3 or 2; no compiler is needed."""
        with self._named() as name:
            command = ["export-fmu", name, "--output", os.fspath(path), "--fmi", str(fmi_version), "--quiet"]
            run(["glidepolar", *command, "--template", fmu_path(fmi_version), *(["--force"] if force else [])])
        return Path(path)

    @contextmanager
    def _named(self) -> Iterator[str]:
        """Gives a name under which commands find the vehicle."""
        if self._given is not None:
            yield self._given
            return
        with TemporaryDirectory(prefix="glidepolar-") as folder:
            file = Path(folder) / "vehicle.toml"
            file.write_text(self._text, encoding="utf-8")
            yield str(file)

    def __repr__(self) -> str:
        return f"Vehicle({self._name!r})"

    def _repr_html_(self) -> str:
        keys = [(path, unit, self.get(path)) for path, unit, _ in _native.vehicle_keys()]
        rows = "".join(
            f"<tr><td>{path}</td><td>{value:.6g}</td><td>{escape(unit)}</td></tr>"
            for path, unit, value in keys
            if value is not None
        )
        head = "<tr><th>key</th><th>value</th><th>unit</th></tr>"
        return f"<b>{escape(self._name)}</b><details><summary>values</summary><table>{head}{rows}</table></details>"


def as_vehicle(vehicle: Union[Vehicle, PathLike]) -> Vehicle:
    """Returns the vehicle itself, or that of a name or file."""
    return vehicle if isinstance(vehicle, Vehicle) else Vehicle(vehicle)
