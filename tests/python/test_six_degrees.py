"""The table that the program's six degrees of freedom are held against is what the independent integration gives."""

from pathlib import Path

import numpy as np
import six_degrees

TABLE = Path(__file__).parents[2] / "crates/spatial/tests/reference/seawing_turn.csv"


def test_the_table_is_that_of_the_independent_integration():
    written = np.loadtxt(TABLE, delimiter=",", skiprows=1)
    assert TABLE.read_text().splitlines()[0] == six_degrees.COLUMNS
    found = six_degrees.fly()
    assert np.all(np.abs(found - written) <= 1e-9 * np.maximum(1.0, np.abs(written)))


def test_the_independent_integration_is_on_the_spiral_of_the_reference():
    last = six_degrees.fly()[-1]
    roll, pitch, r = last[4], last[5], last[12]
    assert abs(roll + 0.2388306) < 1e-6 and abs(pitch + 0.6204126) < 1e-6
    assert abs(r - 0.00385385 * np.cos(roll) * np.cos(pitch)) < 1e-7
