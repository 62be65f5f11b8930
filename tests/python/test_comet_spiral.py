"""What a list explains of Comet's spiral, by numpy alone: half the difference of the legs, with an interval over the legs; and what
one vehicle in sheared water predicts of held-out dives."""

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
    print(f"{layer} dbar: {down[0]:.4f} down, {up[0]:.4f} up, rad/s; a list explains {explained:.4f} +- {1.96 * se:.4f} rad/m (95 %)")
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


# So many intervals between samples make a window of 20 to 60 s; the shear is linear between depths so far apart, m.
WINDOW, LONGEST_S, KNOTS_M = 5, 60, np.arange(4, 29, 4)
# Drag over slope of the lift of a Slocum, for the angle of attack.
DRAG_PER_LIFT = 0.03


def windows():
    """Of each window: dive, sign (+1 down), depth, turn rate, speed, vertical velocity, heading, duration."""
    found = []
    for number, leg in enumerate(legs()):
        time, pressure, heading, pitch = leg.T
        heading = np.unwrap(heading)
        settled = np.flatnonzero((time > time[0] + SETTLED_S) & (pressure >= 3) & (pressure < 30))
        for first in range(0, len(settled) - WINDOW, WINDOW):
            at = settled[first : first + WINDOW + 1]
            duration = np.ptp(time[at])
            if duration > LONGEST_S:
                continue
            rate, sink = (np.polyfit(time[at] - time[at].mean(), of[at], 1)[0] for of in (heading, pressure))
            steep, attack = abs(pitch[at].mean()), 0.03
            for _ in range(40):
                attack = (attack + DRAG_PER_LIFT / np.tan(steep + attack)) / 2
            speed = abs(sink) / np.sin(steep + attack)
            sign = -np.sign(pitch.mean())
            found.append((number // 2, sign, pressure[at].mean(), rate, speed, sink, heading[at].mean(), duration))
    return np.array(found).T


def held_out(data, columns):
    """Root mean square of the errors of the turn rates by leg and layer, each dive predicted from the others, rad/s."""
    dive, sign, depth, rate, *_, duration = data
    design, weights = np.array(columns).T, np.sqrt(duration)
    predicted = np.zeros(len(rate))
    for one in np.unique(dive):
        known = dive != one
        fitted = np.linalg.lstsq(design[known] * weights[known, None], rate[known] * weights[known], rcond=None)[0]
        predicted[~known] = design[~known] @ fitted
    cells = [(dive == d) & (sign == s) & ((depth >= 19) == below) for d in np.unique(dive) for s in (1, -1) for below in (True, False)]
    errors = [np.average((rate - predicted)[cell], weights=duration[cell]) for cell in cells if cell.any()]
    return np.sqrt(np.mean(np.square(errors)))


def by_depth(depth, factor, heading):
    """A force of a fixed direction, piecewise linear in depth, on a glider with this heading."""
    hats = [np.maximum(0, 1 - abs(depth - knot) / 4) for knot in KNOTS_M]
    return [factor * direction(heading) * hat for direction in (np.sin, np.cos) for hat in hats]


def test_one_vehicle_in_sheared_water_predicts_held_out_dives_better_than_means_of_leg_and_layer():
    data = windows()
    dive, sign, depth, rate, speed, sink, heading, duration = data
    assert len(rate) == 304
    below = depth >= 19
    means = held_out(data, [(sign == s) & (below == b) for s in (1, -1) for b in (True, False)])
    vehicle = [speed, speed * sign]
    found = {
        "rudder and list": held_out(data, vehicle),
        "compass": held_out(data, vehicle + [speed * f(n * heading) for n in (1, 2) for f in (np.sin, np.cos)]),
        "shear": held_out(data, vehicle + by_depth(depth, sink, heading)),
        # The same with a sign that does not change with the leg, as a magnetic field by depth would have.
        "by depth, both legs alike": held_out(data, vehicle + by_depth(depth, speed, heading)),
    }
    print(f"held out: means of leg and layer {means:.5f} rad/s;", ", ".join(f"{name} {error:.5f}" for name, error in found.items()))
    assert means == pytest.approx(0.00293, abs=5e-5)
    assert found["shear"] == pytest.approx(0.00234, abs=5e-5) and found["shear"] < means
    assert min(error for name, error in found.items() if name != "shear") > 1.3 * means


def test_the_list_beside_shear_has_an_interval():
    data = windows()
    dive, sign, depth, rate, speed, sink, heading, duration = data
    design = np.array([speed, speed * sign, *by_depth(depth, sink, heading)]).T
    weights, chance = np.sqrt(duration), np.random.default_rng(1)
    fit = lambda rows: np.linalg.lstsq(design[rows] * weights[rows, None], rate[rows] * weights[rows], rcond=None)[0]
    dives = np.unique(dive)
    drawn = [np.concatenate([np.flatnonzero(dive == d) for d in chance.choice(dives, len(dives))]) for _ in range(1000)]
    sizes = np.array([fit(rows)[:2] for rows in drawn])
    rudder, listed = fit(np.arange(len(rate)))[:2]
    low, high = np.percentile(sizes[:, 1], [2.5, 97.5])
    assert rudder == pytest.approx(0.0483, abs=5e-4) and listed == pytest.approx(0.0066, abs=2e-4)
    assert low == pytest.approx(0.0037, abs=7e-4) and high == pytest.approx(0.0090, abs=7e-4)
