"""What the functions of this package raise."""

from __future__ import annotations

from typing import Optional

__all__ = ["GlidepolarError", "InputError", "NoAnswerError", "OutputError"]


class GlidepolarError(Exception):
    """Is the base of all errors of this package.

    Attributes:
        problem: what was found and what was expected.
        file: the file to blame, as it was named.
        line: the line in it, from 1; the row of a DataFrame.
        column: the column, from 1: a character in text files, a cell in tables.
        hint: what to do.
    """

    def __init__(
        self,
        problem: str,
        file: Optional[str] = None,
        line: Optional[int] = None,
        column: Optional[int] = None,
        hint: Optional[str] = None,
    ) -> None:
        self.problem = problem
        self.file = file
        self.line = line
        self.column = column
        self.hint = hint
        place = ":".join(str(part) for part in (file, line, column) if part is not None)
        super().__init__((f"{place}: " if place else "") + problem + (f"; {hint}" if hint else ""))


class InputError(GlidepolarError, ValueError):
    """Says that a file, a table or an argument cannot be used."""


class NoAnswerError(GlidepolarError):
    """Says that the question has no answer, as a glide at this path."""


class OutputError(GlidepolarError, OSError):
    """Says that a result cannot be written, or would replace a file of yours."""
