"""Results of the functions, with the JSON of the commands."""

from __future__ import annotations

import csv
import json
import math
import os
from collections.abc import Callable, Iterator
from html import escape
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any, NamedTuple, Optional, Union

from ._command import Output
from ._vehicle import PathLike, Vehicle
from .errors import NoAnswerError

if TYPE_CHECKING:
    import pandas

# Runs the command again with further options.
Again = Callable[[list[str]], Output]


class Estimate(NamedTuple):
    """Is an estimated quantity."""

    value: float
    se: float
    """Standard error."""
    ci95: tuple[float, float]
    """95 % interval."""
    unit: str

    @classmethod
    def of(cls, quantity: dict[str, Any]) -> Estimate:
        low, high = quantity["ci95"]
        return cls(quantity["value"], quantity["se"], (low, high), quantity["unit"])

    def __str__(self) -> str:
        return f"{self.value:.6g} +- {self.se:.2g} {self.unit}"


class Result:
    """Is the result of a command."""

    def __init__(self, output: Output, again: Again) -> None:
        self._output = output
        self._again = again
        self._values: Optional[dict[str, Any]] = None

    def to_dict(self) -> dict[str, Any]:
        """Returns the command's JSON as a dictionary; docs/reference/json.md describes it."""
        if self._values is None:
            self._values = json.loads(self.to_json())
        return dict(self._values or {})

    def to_json(self) -> str:
        """Returns the very text that the command prints with `--json -`."""
        return self._output.json or "{}"

    def __getitem__(self, key: str) -> Any:
        return self.to_dict()[key]

    @property
    def warnings(self) -> list[str]:
        """What the result is to be read with."""
        return list(self._output.warnings)

    def report(self, path: PathLike, force: bool = False) -> Path:
        """Writes report.html with its figures into a folder, and returns the page's path. Does the work once more."""
        self._again(["--out", os.fspath(path), "--quiet", *(["--force"] if force else [])])
        return Path(path) / "report.html"

    def tables(self) -> str:
        """Returns the tables that the command prints. Does the work once more."""
        return self._again([]).text

    def __repr__(self) -> str:
        return f"{type(self).__name__}({self.to_dict().get('vehicle', '')})"

    def _repr_html_(self) -> str:
        return f"<b>{type(self).__name__}</b>{table(self._rows())}{_list(self.warnings)}"

    def _rows(self) -> list[list[str]]:
        """Returns what a notebook shows: a line of names, then rows."""
        plain = [[key, _text(v)] for key, v in self.to_dict().items() if isinstance(v, (int, float, str))]
        return [["", "value"], *plain]


class WithVehicle(Result):
    """Is a result from which a vehicle follows."""

    _option = "--write"

    @property
    def vehicle(self) -> Vehicle:
        """The vehicle that follows from the log. Does the work once more when it is first asked for."""
        if not hasattr(self, "_vehicle"):
            with TemporaryDirectory(prefix="glidepolar-") as folder:
                file = Path(folder) / "vehicle.toml"
                self._again([self._option, str(file), "--quiet"])
                self._vehicle = Vehicle.parse(file.read_text(encoding="utf-8"))
        return self._vehicle

    def fmu(self, path: PathLike, fmi_version: int = 3, force: bool = False) -> Path:
        """Packs that vehicle as an FMU."""
        return self.vehicle.fmu(path, fmi_version, force)


class Identification(WithVehicle):
    """Is what a flight log identifies."""

    @property
    def parameters(self) -> dict[str, Estimate]:
        """The parameters with their errors; those of both methods by name."""
        found = self.to_dict().get("parameters") or {}
        return {name: Estimate.of(quantity) for name, quantity in found.items() if quantity is not None}

    def _rows(self) -> list[list[str]]:
        pinned = self.to_dict().get("pinned") or {}
        shown = [
            [name, f"{q.value:.5g}", f"{q.se:.2g}", q.unit, "fixed" if name in pinned else "fitted"]
            for name, q in self.parameters.items()
        ]
        return [["parameter", "value", "standard error", "unit", ""], *shown]


class Diagnosis(WithVehicle):
    """Is what the steady glide gets wrong in a log, and why."""

    _option = "--extended"

    @property
    def verdict(self) -> str:
        """`none`, `named`, `unexplained` and the like."""
        return str(self.to_dict()["verdict"])

    @property
    def causes(self) -> list[str]:
        """The mechanisms that held-out data confirm."""
        return [str(cause["cause"]) for cause in self.to_dict()["causes"]]

    @property
    def parameters(self) -> dict[str, Estimate]:
        """The sizes of the causes."""
        causes = self.to_dict()["causes"]
        return {name: Estimate.of(q) for cause in causes for name, q in cause["parameters"].items()}

    def __repr__(self) -> str:
        return f"Diagnosis({self.verdict}: {', '.join(self.causes) or 'no cause'})"

    def _rows(self) -> list[list[str]]:
        shown = [[name, f"{q.value:.5g}", f"{q.se:.2g}", q.unit] for name, q in self.parameters.items()]
        return [[f"verdict: {self.verdict}", "value", "standard error", "unit"], *shown]


class Table(Result):
    """Is a result with a table."""

    def __init__(self, output: Output, again: Again, columns: dict[str, list[float]]) -> None:
        super().__init__(output, again)
        self._columns = columns

    def columns(self) -> dict[str, list[float]]:
        """Returns the columns of the table by their names; a missing value is NaN."""
        return {name: list(values) for name, values in self._columns.items()}

    def to_pandas(self) -> pandas.DataFrame:
        """Returns the table as a DataFrame."""
        import pandas as pd

        return pd.DataFrame(self._columns)


class Glide(Table):
    """Is one steady glide, or the polar at one net mass."""


class Turn(Result):
    """Is a steady turn, or a sweep of them."""


class Plan(Result):
    """Is what a battery is enough for."""


class Comparison(Result):
    """Is vehicles or logs side by side."""


class Track(Table):
    """Is a track by dead reckoning, and the currents between fixes."""


class Simulation(Table):
    """Is a time history, the legs of a mission, or the last moments of the variants of a sweep."""

    def __init__(
        self, output: Output, again: Again, columns: dict[str, list[float]], log: Optional[dict[str, list[float]]]
    ) -> None:
        super().__init__(output, again, columns)
        self._log = log

    @property
    def log(self) -> dict[str, list[float]]:
        """The mission as the glider's own flight log, by columns; `identify` and `diagnose` take it as it is."""
        if self._log is None:
            raise NoAnswerError("only a mission leaves a flight log", hint="give simulate a mission")
        return self._log


class Reduction(Result):
    """Is a reduced hull test."""

    @property
    def parameters(self) -> dict[str, dict[str, Estimate]]:
        """The coefficients of each hull's fit by the hull's name: a, b, c, d on the frontal area."""
        fits = {str(hull["id"]): hull.get("fit") or {} for hull in self.to_dict()["hulls"]}
        return {
            hull: {name: Estimate.of(q) for name, q in fit.items() if isinstance(q, dict) and "ci95" in q}
            for hull, fit in fits.items()
        }

    def _rows(self) -> list[list[str]]:
        shown = [
            [hull, name, f"{q.value:.5g}", f"{q.se:.2g}", q.unit]
            for hull, fit in self.parameters.items()
            for name, q in fit.items()
        ]
        return [["hull", "coefficient", "value", "standard error", "unit"], *shown]


def read_columns(file: Path) -> dict[str, list[float]]:
    """Reads the columns of numbers of a table that a command wrote."""
    with file.open(encoding="utf-8", newline="") as lines:
        rows = csv.reader(line for line in lines if not line.startswith("#"))
        names = next(rows)
        return dict(zip(names, map(list, zip(*([_number(cell) for cell in row] for row in rows)))))


def _number(cell: str) -> float:
    try:
        return float(cell)
    except ValueError:
        return math.nan


def table(rows: list[list[str]]) -> str:
    """Returns rows as HTML, the first as a line of names."""
    head, *body = rows

    def line(cells: list[str], tag: str) -> str:
        return "<tr>" + "".join(f"<{tag}>{escape(cell)}</{tag}>" for cell in cells) + "</tr>"

    return "<table>" + line(head, "th") + "".join(line(row, "td") for row in body) + "</table>"


def _list(sentences: list[str]) -> str:
    items: Iterator[str] = (f"<li>{escape(sentence)}</li>" for sentence in sentences)
    listed = "".join(items)
    return f"<details><summary>{len(sentences)} warnings</summary><ul>{listed}</ul></details>" if listed else ""


def _text(value: Union[float, str]) -> str:
    return f"{value:.6g}" if isinstance(value, float) else str(value)
