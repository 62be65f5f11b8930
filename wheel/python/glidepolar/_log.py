"""Flight logs: files of any maker, and data frames."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any, Optional, Union

from . import _native
from .errors import InputError

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt
    import pandas
    import xarray

PathLike = Union[str, "os.PathLike[str]"]


class Reading:
    """Is how the columns of a log are read; the same for every function that takes a log."""

    def __init__(
        self,
        columns: Optional[Mapping[str, str]] = None,
        units: Optional[Mapping[str, str]] = None,
        cache: Union[PathLike, Iterable[PathLike]] = (),
        speed_column: Optional[str] = None,
    ) -> None:
        self.columns = [f"{channel}={column}" for channel, column in (columns or {}).items()]
        self.units = [f"{channel}={unit}" for channel, unit in (units or {}).items()]
        self.cache = paths(cache)
        self.speed_column = speed_column

    def arguments(self, has_speed: bool = True) -> list[str]:
        """Returns the options of a command that say the same."""
        said = [f"--column={choice}" for choice in self.columns] + [f"--unit={unit}" for unit in self.units]
        said += [f"--cache={folder}" for folder in self.cache]
        if has_speed and self.speed_column is not None:
            said.append(f"--speed-column={self.speed_column}")
        elif self.speed_column is not None:
            said.append(f"--column=speed_through_water_m_s={self.speed_column}")
        return said


class Log:
    """Is the flight log of one glider.

    `read(files)` makes it of files, `Log.from_dataframe(frame)` of a table in memory. Names of columns carry the units, as
    `pitch_deg` or `pitch_rad`; names that gliders' makers use are known, too.
    """

    def __init__(self, files: list[str], reading: Reading, table: Optional[_native.Table] = None) -> None:
        self._files = files
        self._reading = reading
        # Keeps the columns in memory announced.
        self._table = table
        self._read: Optional[tuple[dict[str, npt.NDArray[np.float64]], list[str], list[str]]] = None

    @classmethod
    def from_dataframe(
        cls,
        frame: Any,
        *,
        columns: Optional[Mapping[str, str]] = None,
        units: Optional[Mapping[str, str]] = None,
        speed_column: Optional[str] = None,
    ) -> Log:
        """Takes a DataFrame, an xarray Dataset or a mapping of arrays as a log.

        Columns of 64-bit floats are read where they lie, without a copy. Other numbers and times are converted, column by
        column. Columns of text are left out. `columns` names the column of a channel, `units` states its unit, as in `read`.
        """
        numbers = list(_numbers(frame))
        if not numbers:
            raise InputError("the table has no column of numbers")
        table = _native.Table(numbers)
        return cls([str(table.path)], Reading(columns, units, (), speed_column), table)

    @property
    def files(self) -> list[str]:
        """The files, as they were named; a placeholder for a table in memory."""
        return list(self._files)

    def channels(self) -> dict[str, npt.NDArray[np.float64]]:
        """Returns the recorded channels by their names with units, in order of time; a missing value is NaN."""
        return dict(self._content()[0])

    @property
    def notes(self) -> list[str]:
        """What was found in the files and done about it."""
        return list(self._content()[1])

    @property
    def warnings(self) -> list[str]:
        """What was left out of the files."""
        return list(self._content()[2])

    def to_pandas(self) -> pandas.DataFrame:
        """Returns the channels as a DataFrame, a row for each sample."""
        import pandas as pd

        return pd.DataFrame(self.channels(), copy=False)

    def to_xarray(self) -> xarray.Dataset:
        """Returns the channels as a Dataset along `time_s`."""
        import xarray as xr

        channels = self.channels()
        time = channels.pop("time_s")
        return xr.Dataset({name: ("time_s", values) for name, values in channels.items()}, coords={"time_s": time})

    def __len__(self) -> int:
        return max((len(values) for values in self._content()[0].values()), default=0)

    def __repr__(self) -> str:
        shown = self._files[0] if len(self._files) == 1 else f"{len(self._files)} files from {self._files[0]}"
        return f"Log({shown})"

    def _repr_html_(self) -> str:
        import numpy as np

        rows = "".join(
            f"<tr><td>{name}</td><td>{np.isfinite(v).sum()}</td><td>{np.nanmin(v):.6g}</td><td>{np.nanmax(v):.6g}</td></tr>"
            for name, v in self._content()[0].items()
        )
        head = "<tr><th>channel</th><th>values</th><th>least</th><th>largest</th></tr>"
        return f"<b>Flight log, {len(self)} rows</b><table>{head}{rows}</table>"

    def _content(self) -> tuple[dict[str, npt.NDArray[np.float64]], list[str], list[str]]:
        if self._read is None:
            import numpy  # noqa: F401  the extension module makes its arrays

            r = self._reading
            self._read = _native.read(self._files, r.columns, r.units, r.cache, r.speed_column)
        return self._read


def read(
    files: Union[PathLike, Iterable[PathLike]],
    *,
    columns: Optional[Mapping[str, str]] = None,
    units: Optional[Mapping[str, str]] = None,
    cache: Union[PathLike, Iterable[PathLike]] = (),
    speed_column: Optional[str] = None,
) -> Log:
    """Reads the flight log of one glider from files of any maker.

    The files may be CSV, Seaglider NetCDF, a Slocum's binary files, SeaExplorer files, Slocum or OG1 NetCDF, in any order.

    Args:
        files: a file or several.
        columns: the column of a channel: `{"pitch_rad": "pitch_corr_rad"}`.
        units: the unit of a channel, whatever the file says: `{"pitch_rad": "deg"}`.
        cache: folders with a Slocum's lists of sensors (.cac, .ccc), where they are not beside the files.
        speed_column: the column that holds the measured speed through the water [m/s].
    """
    named = paths(files)
    if not named:
        raise InputError("no files: expected one at least")
    log = Log(named, Reading(columns, units, cache, speed_column))
    log.channels()
    return log


def as_log(log: Any, reading: Reading) -> Log:
    """Returns a log as it is, or that of files, a DataFrame, a Dataset or a mapping of arrays."""
    if isinstance(log, Log):
        if reading.columns or reading.units or reading.cache or reading.speed_column is not None:
            return Log(log._files, reading, log._table)
        return log
    if isinstance(log, (str, os.PathLike)):
        return Log(paths(log), reading)
    if isinstance(log, Mapping) or hasattr(log, "columns") or hasattr(log, "data_vars"):
        made = Log.from_dataframe(log)
        return Log(made._files, reading, made._table)
    return Log(paths(log), reading)


def paths(files: Union[PathLike, Iterable[PathLike]]) -> list[str]:
    """Returns the names of one file or of several."""
    if isinstance(files, (str, os.PathLike)):
        return [os.fspath(files)]
    return [os.fspath(file) for file in files]


def _numbers(frame: Any) -> Iterable[tuple[str, npt.NDArray[np.float64]]]:
    """Yields the columns that hold numbers or times."""
    import numpy as np

    names = list(frame.variables) if hasattr(frame, "data_vars") else list(frame)
    for name in names:
        values = np.asarray(frame[name])
        if values.ndim != 1:
            continue
        if values.dtype == np.float64:
            yield str(name), values
        elif np.issubdtype(values.dtype, np.datetime64):
            yield str(name), _seconds(values)
        elif np.issubdtype(values.dtype, np.number) or values.dtype == np.bool_:
            yield str(name), values.astype(np.float64)
        else:
            converted = _of_text(values)
            if converted is not None:
                yield str(name), converted


def _of_text(values: npt.NDArray[Any]) -> Optional[npt.NDArray[np.float64]]:
    """Returns the numbers or times that a column of texts or objects holds; nothing where it holds something else."""
    import numpy as np

    try:
        return values.astype(np.float64)
    except (TypeError, ValueError):
        pass
    try:
        times = values.astype(str).astype("datetime64[ns]")
    except ValueError:
        return None
    return _seconds(times)


def _seconds(times: npt.NDArray[Any]) -> npt.NDArray[np.float64]:
    """Returns times as Unix seconds: whole seconds and their fraction apart, for the nearest number to that of a file."""
    import numpy as np

    nanoseconds = times.astype("datetime64[ns]").astype(np.int64)
    seconds = nanoseconds // 10**9 + (nanoseconds % 10**9) / 1e9
    return np.where(np.isnat(times), np.nan, seconds)
