"""Flights that every importer repeats, and their comparison with the command line's own run."""

import csv
import subprocess
from dataclasses import dataclass
from pathlib import Path

import numpy as np

MISSIONS = Path(__file__).parent.parent / "missions"
# When the missions turn and end, s.
TURN, STOP = 1104.0, 2208.0
# Between two rows, and in Co-Simulation the communication step, s.
STEP = 8.0


@dataclass(frozen=True)
class Flight:
    """A mission of one model: a dive and a climb."""

    # Its inputs against time.
    inputs: Path
    # What the command line needs to be told beside them.
    options: list[str]
    # Every output that moves on it.
    outputs: list[str]

    def commands(self, row: int) -> dict[str, float]:
        """The set-points in a row of the mission: 0 on the way down, 2 on the way up."""
        with self.inputs.open() as file:
            values = list(csv.DictReader(file))[row]
        return {name: float(value) for name, value in values.items() if name != "time"}


ALIKE = [
    "depth_m",
    "pitch_rad",
    "glide_angle_rad",
    "angle_of_attack_rad",
    "speed_m_s",
    "vertical_velocity_m_s",
    "v1_m_s",
    "v3_m_s",
    "net_mass_kg",
    "ballast_mass_kg",
    "moving_mass_position_m",
    "energy_J",
]
FLIGHTS = {
    # A sawtooth in the plane.
    "plane": Flight(
        MISSIONS / "sawtooth.csv",
        [],
        [*ALIKE, "x_m", "pitch_rate_rad_s", "lift_N", "drag_N", "pitching_moment_N_m"],
    ),
    # Spirals: down with the rudder to starboard, up with it to port.
    "space": Flight(
        MISSIONS / "turning.csv",
        ["--3d"],
        [
            *ALIKE,
            "north_m",
            "east_m",
            "heading_rad",
            "roll_rad",
            "v2_m_s",
            "p_rad_s",
            "q_rad_s",
            "r_rad_s",
            "sideslip_rad",
            "turn_rate_rad_s",
            "rudder_rad",
        ],
    ),
}


def read(path: Path) -> dict[str, np.ndarray]:
    with open(path) as file:
        rows = list(csv.DictReader(file))
    return {name: np.array([number(row[name]) for row in rows]) for name in rows[0]}


def number(cell: str) -> float:
    truth = {"true": 1.0, "false": 0.0}.get(cell.lower())
    return float(cell) if truth is None else truth


def simulate(glidepolar: Path, output: Path, *options: str, vehicle: str = "slocum-graver") -> dict[str, np.ndarray]:
    """A run of the command line, at tight tolerance."""
    command = [glidepolar, "simulate", vehicle, "--quiet", "--tolerance", "1e-12", "--csv", output, *options]
    subprocess.run([str(word) for word in command], check=True, capture_output=True, text=True)
    return read(output)


def deviation(found: dict[str, np.ndarray], reference: dict[str, np.ndarray], name: str) -> float:
    """The largest difference, relative to the largest magnitude in the reference.

    Rows are matched by time. Where a time stands twice, before and after an event, the better of the two counts; a time
    that is missing is a failure.
    """
    scale = np.max(np.abs(reference[name]))
    assert scale > 0, f"{name} is 0 throughout the reference: nothing to compare"
    worst = 0.0
    for time, wanted in zip(reference["time"], reference[name]):
        here = np.abs(found["time"] - time) <= 1e-9 * (1 + abs(time))
        assert here.any(), f"no row at {time} s"
        difference = np.min(np.abs(found[name][here] - wanted))
        assert np.isfinite(difference), f"{name} at {time} s is no number"
        worst = max(worst, difference)
    return worst / scale


def assert_same(found, reference, names, tolerance: float = 1e-6) -> None:
    deviations = {name: deviation(found, reference, name) for name in names}
    worst = {name: f"{value:.1e}" for name, value in deviations.items() if not value <= tolerance}
    assert not worst, f"differs by more than {tolerance:g}: {worst}"
