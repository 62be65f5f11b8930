"""Runs a command of the package inside this process."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from typing import NamedTuple, Optional

from . import _native


class GlidepolarWarning(UserWarning):
    """Says with what care a result is to be read. `result.warnings` lists the same sentences."""


class Output(NamedTuple):
    """Is what a command gave back."""

    json: Optional[str]
    text: str
    warnings: list[str]


# Is called with what is counted, how many are done, and of how many where that is known.
Progress = Callable[[str, int, Optional[int]], object]


def run(arguments: list[str], progress: Optional[Progress] = None) -> Output:
    """Runs a command; its warnings come back and are not shown."""
    return Output(*_native.run(arguments, progress))


def show(sentences: list[str]) -> None:
    """Shows warnings once each, at the line that called this package."""
    for sentence in sentences:
        warnings.warn(sentence, GlidepolarWarning, stacklevel=4)
