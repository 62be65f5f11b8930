"""Hull tests in a towing tank: raw balance runs or tables of points to lift, drag and moment coefficients."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Optional, Union

from ._command import Output, Progress, run
from ._functions import AnyTable, _file, write_table
from ._results import Reduction
from ._vehicle import PathLike

__all__ = ["Campaign", "demo", "diagnose", "reduce"]


class Campaign:
    """Is a campaign of raw balance runs in memory.

    Args:
        campaign: text of campaign.toml, or the path of such a file: hulls, water, balance.
        runs: table of the runs, as runs.csv has it.
        data: table of each run's readings by the name of its file.
    """

    def __init__(self, campaign: PathLike, runs: Any, data: Mapping[str, Any]) -> None:
        text = os.fspath(campaign)
        self.campaign = text if "\n" in text else Path(text).read_text(encoding="utf-8")
        self.runs = runs
        self.data = dict(data)

    def save(self, folder: PathLike) -> Path:
        """Writes the campaign as a folder that `tank-reduce` takes."""
        root = Path(folder)
        (root / "data").mkdir(parents=True)
        (root / "campaign.toml").write_text(self.campaign, encoding="utf-8")
        write_table(self.runs, root / "runs.csv")
        for name, readings in self.data.items():
            file = name if name.endswith(".csv") else f"{name}.csv"
            write_table(readings, root / file if file.startswith("data/") else root / "data" / file)
        return root


def reduce(
    source: Union[Campaign, AnyTable],
    hull: Optional[PathLike] = None,
    *,
    range_deg: Optional[float] = None,
    strict: bool = False,
    out: Optional[PathLike] = None,
    force: bool = False,
    progress: Optional[Progress] = None,
) -> Reduction:
    """Reduces a campaign's folder, a Campaign, or a table of points to coefficients with intervals.

    Args:
        source: a folder (campaign.toml, runs.csv, data/), a Campaign, a file of points or a DataFrame of points.
        hull: hull.toml of a table of points.
        range_deg: fit the points up to this angle [deg]; 10 by default.
        strict: take one unusable run for an error instead of leaving it out.
        out: folder for report.html and tables, which are thrown away without it; `report(path)` would do the work once more.
        force: replace in that folder what this package did not write, too.
        progress: is called with what is counted, how many are done, and of how many where that is known.
    """
    return _reduce(source, hull, range_deg, strict, [], _kept(out, force), progress)


def diagnose(
    source: Union[Campaign, AnyTable],
    hull: Optional[PathLike] = None,
    *,
    range_deg: Optional[float] = None,
    strict: bool = False,
    out: Optional[PathLike] = None,
    force: bool = False,
    progress: Optional[Progress] = None,
) -> Reduction:
    """Reduces, and finds what the steady runs depart from, why, and how much a correction gains."""
    return _reduce(source, hull, range_deg, strict, ["--diagnose"], _kept(out, force), progress)


def demo(folder: PathLike, *, seed: int = 1, effects: tuple[str, ...] = (), force: bool = False) -> Path:
    """Writes a synthetic campaign with stated truth; `effects` hides something in it: `("crossflow",)`."""
    options = [f"--effect={effect}" for effect in effects] + (["--force"] if force else [])
    run(["tank-reduce", "demo", os.fspath(folder), f"--seed={seed}", "--quiet", *options])
    return Path(folder)


def _reduce(
    source: Union[Campaign, AnyTable],
    hull: Optional[PathLike],
    range_deg: Optional[float],
    strict: bool,
    options: list[str],
    kept: list[str],
    progress: Optional[Progress],
) -> Reduction:
    options = options + (["--strict"] if strict else [])
    options += [] if range_deg is None else [f"--range-deg={float(range_deg)!r}"]
    options += [] if hull is None else ["--hull", os.fspath(hull)]

    def again(further: list[str], progress: Optional[Progress] = None) -> Output:
        with ExitStack() as stack:
            name = stack.enter_context(_named(source))
            # Results always go into a folder; nobody asked for this one.
            unasked = [] if "--out" in further else ["--out", stack.enter_context(TemporaryDirectory())]
            return run(["tank-reduce", name, *options, *unasked, *further], progress)

    return Reduction(again(["--json", "-", *kept], progress), again)


def _kept(out: Optional[PathLike], force: bool) -> list[str]:
    return [] if out is None else ["--out", os.fspath(out), *(["--force"] if force else [])]


@contextmanager
def _named(source: Union[Campaign, AnyTable]) -> Iterator[str]:
    with ExitStack() as stack:
        if isinstance(source, Campaign):
            folder = stack.enter_context(TemporaryDirectory(prefix="glidepolar-"))
            yield str(source.save(Path(folder) / "campaign"))
        else:
            yield _file(source, stack)
