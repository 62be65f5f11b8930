"""What a list explains of Comet's spiral, by numpy alone: half the difference of the legs, with an interval over the legs."""

import csv

import numpy as np
import pytest
from conftest import MEASURED

SETTLED_S = 25.0
COLUMNS = ["time_s", "pressure_dbar", "heading_rad", "pitch_rad"]


def legs():
    """Time, pressure, heading and pitch of each leg; its pitch has one sign."""
    with (MEASURED / "comet_2019_spiral.csv").open() as file:
        rows = csv.DictReader(line for line in file if not line.startswith("#"))
        table = np.array([[float(row[name] or "nan") for name in COLUMNS] for row in rows])
    table = table[np.isfinite(table).all(axis=1)]
    ends = (np.diff(np.sign(table[:, 3])) != 0) | (np.diff(table[:, 0]) > 60)
    parts = np.split(table, np.flatnonzero(ends) + 1)
    return [part for part in parts if len(part) > 8 and np.ptp(part[:, 1]) > 8]


def turn(leg, low_dbar, high_dbar):
    """Turn rate [rad/s] and curvature by depth rate and pitch [rad/m] in a layer."""
    here = (leg[:, 0] > leg[0, 0] + SETTLED_S) & (leg[:, 1] >= low_dbar) & (leg[:, 1] < high_dbar)
    time, pressure, heading, pitch = leg[here].T
    rate = np.polyfit(time - time[0], np.unwrap(heading), 1)[0]
    speed = abs((pressure[-1] - pressure[0]) / (time[-1] - time[0]) / np.sin(pitch.mean()))
    return rate, rate / speed


def with_error(turns):
    """Mean and its standard error by leaving out one leg at a time."""
    n = len(turns)
    left_out = np.array([np.delete(turns, i, 0).mean(0) for i in range(n)])
    return turns.mean(0), np.sqrt((n - 1) / n * ((left_out - left_out.mean(0)) ** 2).sum(0))


@pytest.mark.parametrize(
    ("layer", "rates", "half"),
    [((19, 30), [0.0177, 0.0179], 0.0039), ((3, 19), [0.0113, -0.0027], 0.0214)],
)
def test_a_list_explains_half_the_difference_of_the_legs(layer, rates, half):
    sides = {down: [turn(leg, *layer) for leg in legs() if (leg[:, 3].mean() < 0) == down] for down in [True, False]}
    (down, down_se), (up, up_se) = (with_error(np.array(sides[side])) for side in [True, False])
    assert [len(side) for side in sides.values()] == [21, 21]
    np.testing.assert_allclose([down[0], up[0]], rates, atol=1e-4)
    explained, se = (down[1] - up[1]) / 2, np.hypot(down_se[1], up_se[1]) / 2
    assert explained == pytest.approx(half, abs=1e-4)
    assert 0.001 < se < 0.0025


def test_no_one_list_explains_both_layers():
    found = []
    for layer in [(19, 30), (3, 19)]:
        sides = [np.array([turn(leg, *layer) for leg in legs() if (leg[:, 3].mean() < 0) == down]) for down in [True, False]]
        (down, down_se), (up, up_se) = map(with_error, sides)
        found.append(((down[1] - up[1]) / 2, np.hypot(down_se[1], up_se[1]) / 2))
    (below, below_se), (above, above_se) = found
    assert (above - below) / np.hypot(below_se, above_se) > 6
