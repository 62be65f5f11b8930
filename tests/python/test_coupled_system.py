"""A system of three parts, connected and stepped together as a user of FMUs has it: the glider's FMU, an autopilot and
an ocean with a rising seabed and a sheared current. It flies several dives, and is held against `glidepolar simulate
--mission`, which flies the same orders with a pilot of its own inside the equations."""

import csv
import math
import subprocess

import numpy as np
import pytest
from conftest import together
from instance import Instance

STEP = 0.5
DURATION = 9000.0
MAX_DEPTH, ALTIMETER, CLIMB_TO = 60.0, 15.0, 10.0
PITCH, BALLAST = math.radians(23.0), 46e-6
SURFACE_PITCH = math.radians(-20.0)
FIRST_SURFACING, EVERY, STAY = 3000.0, 4400.0, 300.0
LOOK, GAIN, DEADBAND = 60.0, 0.5, math.radians(0.1)
SEABED = ([0.0, 2000.0], [90.0, 45.0])
CURRENT = ([0.0, 20.0, 60.0], [0.08, 0.05, -0.03])

MISSION = f"""
name = "Three parts"
[voyage]
duration_h = {DURATION / 3600}
[dive]
max_depth_m = {MAX_DEPTH}
altimeter_m = {ALTIMETER}
climb_to_m = {CLIMB_TO}
[glide]
pitch_down_deg = {-math.degrees(PITCH)}
pitch_up_deg = {math.degrees(PITCH)}
ballast_down_cc = {-BALLAST * 1e6}
ballast_up_cc = {BALLAST * 1e6}
[surfacing]
first_after_h = {FIRST_SURFACING / 3600}
every_h = {EVERY / 3600}
stay_min = {STAY / 60}
pitch_deg = {math.degrees(SURFACE_PITCH)}
[control]
period_s = {LOOK}
gain = {GAIN}
deadband_deg = {math.degrees(DEADBAND)}
[seabed]
distance_km = {[x / 1000 for x in SEABED[0]]}
depth_m = {SEABED[1]}
[current]
depth_m = {CURRENT[0]}
along_m_s = {CURRENT[1]}
"""


class Ocean:
    """What the glider meets: inputs x_m, depth_m; outputs seabed_depth_m, current_x_m_s and its shear, without which the FMU
    takes a current that changes from step to step for one that is uniform and steady."""

    def outputs(self, x, depth):
        layer = min(max(int(np.searchsorted(CURRENT[0], depth)) - 1, 0), len(CURRENT[0]) - 2)
        within = CURRENT[0][0] <= depth <= CURRENT[0][-1]
        slopes = np.diff(CURRENT[1]) / np.diff(CURRENT[0])
        return {
            "current_x_shear_1_s": float(slopes[layer]) if within else 0.0,
            "seabed_depth_m": float(np.interp(x, *SEABED)),
            "current_x_m_s": float(np.interp(depth, *CURRENT)),
        }


class Autopilot:
    """Turns by depth gauge, altimeter and clock; trims the moving mass by the pitch that it reads.

    It knows the height of the moving mass and nothing of the glider's hydrodynamics: what the trim of a leg needs beyond
    the hydrostatic balance it learns on the way, and keeps from leg to leg of the same kind.
    """

    def __init__(self, height):
        self.height = height
        self.surface_trim = -height * math.tan(SURFACE_PITCH)
        self.trim = {"descent": height * math.tan(PITCH), "ascent": -height * math.tan(PITCH)}
        self.kind, self.due, self.until, self.look = "descent", FIRST_SURFACING, None, LOOK
        self.surfaces = False
        self.turns = []

    def commands(self, time, depth, altitude, pitch):
        kind, why = self.kind, None
        if kind == "descent":
            due = time >= self.due
            if altitude <= ALTIMETER or depth >= MAX_DEPTH or due:
                why = "altimeter" if altitude <= ALTIMETER else "max_depth" if depth >= MAX_DEPTH else "surfacing_due"
                self.kind = "ascent"
            self.surfaces = due
        elif kind == "ascent":
            if not self.surfaces and time >= self.due:
                self.surfaces, why = True, "surfacing_due"
            elif depth <= (0.0 if self.surfaces else CLIMB_TO):
                self.kind, why = ("surface", "surfaced") if self.surfaces else ("descent", "climb_to")
                self.until = time + STAY
        elif time >= self.until:
            self.kind, why, self.due = "descent", "stay_over", time + EVERY
        if why:
            self.turns.append((time, kind, why, depth, pitch))
            self.look = time + LOOK
        elif self.kind != "surface" and time >= self.look:
            self.look = time + LOOK
            error = pitch - (-PITCH if self.kind == "descent" else PITCH)
            if abs(error) > DEADBAND:
                self.trim[self.kind] += GAIN * self.height / math.cos(PITCH) ** 2 * error
        return {
            "ballast_command_m3": -BALLAST if self.kind == "descent" else BALLAST,
            "moving_mass_command_m": self.trim.get(self.kind, self.surface_trim),
        }


def fly(fmu, folder):
    """The three parts stepped together: first the ocean, then the autopilot, then the glider."""
    height = 0.05
    autopilot, ocean = Autopilot(height), Ocean()
    nominal, density = 1.0, 1027.0
    start = {
        "x_m": 0.0,
        "depth_m": 0.0,
        "pitch_rad": SURFACE_PITCH,
        "v1_m_s": 0.0,
        "v3_m_s": 0.0,
        "moving_mass_position_m": autopilot.surface_trim,
        "ballast_mass_kg": nominal - density * BALLAST,
        "seabed_depth_m": SEABED[1][0],
    }
    glider = Instance(fmu, folder, start=start)
    assert glider.get("moving_mass_height_m") == height
    watched = ["x_m", "depth_m", "pitch_rad", "seabed_depth_m", "vertical_velocity_m_s", "energy_J", "speed_m_s"]
    rows = []
    for i in range(int(DURATION / STEP)):
        time = i * STEP
        now = {name: glider.get(name) for name in watched}
        rows.append([time, *now.values()])
        # The current of the middle of the step, by the way that the glider is on: exact to second order.
        ahead = now["depth_m"] + 0.5 * STEP * now["vertical_velocity_m_s"]
        around = ocean.outputs(now["x_m"], ahead)
        altitude = around["seabed_depth_m"] - now["depth_m"]
        orders = autopilot.commands(time, now["depth_m"], altitude, now["pitch_rad"])
        for name, value in (around | orders).items():
            glider.set(name, value)
        glider.step(time, STEP)
    glider.free()
    table = dict(zip(["time", *watched], np.array(rows).T))
    return table, autopilot.turns


def command_line(glidepolar, folder):
    mission = folder / "mission.toml"
    mission.write_text(MISSION)
    command = [glidepolar, "simulate", "slocum-graver", "--mission", mission, "--out", folder / "out", "--quiet"]
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    with open(folder / "out" / "legs.csv") as file:
        return list(csv.DictReader(file))


pytestmark = together("coupled-system")


@pytest.fixture(scope="module")
def flights(glidepolar, fmu2, fmu3, tmp_path_factory):
    folder = tmp_path_factory.mktemp("coupled")
    return [fly(fmu, folder / fmu.stem) for fmu in (fmu2, fmu3)], command_line(glidepolar, folder)


def test_both_versions_fly_alike(flights):
    (first, first_turns), (second, second_turns) = flights[0]
    assert first_turns == second_turns
    for name in first:
        assert np.array_equal(first[name], second[name]), name


def test_the_dives_are_those_of_the_command_line(flights):
    (_, turns), _ = flights[0]
    legs = flights[1]
    assert len(turns) >= 12 and {why for _, _, why, _, _ in turns} >= {"altimeter", "max_depth", "climb_to", "surfaced"}
    ended = [leg for leg in legs if leg["ended_by"] != "mission_end"]
    assert [(kind, why) for _, kind, why, _, _ in turns] == [(leg["leg"], leg["ended_by"]) for leg in ended]
    sink = 0.13
    for (_, kind, why, depth, _), leg in zip(turns, ended):
        if why in ("max_depth", "climb_to"):
            assert abs(depth - float(leg["end_depth_m"])) <= sink * STEP, (kind, why, depth, leg)
    # Different trims on the way to the same pitch: the first two legs are flown untrimmed, then the pitch is the same within
    # the dead band, and so is how fast the legs go down and up.
    begun, upper = 0.0, 0.0
    for (time, kind, why, depth, _), leg in zip(turns, ended):
        if kind != "surface":
            fast = abs(depth - upper) / (time - begun)
            wanted = abs(float(leg["end_depth_m"]) - float(leg["start_depth_m"])) / (
                float(leg["end_s"]) - float(leg["start_s"])
            )
            assert abs(fast / wanted - 1) < 0.02, (time, kind, why, fast, wanted)
        begun, upper = time, depth
    (table, _), _ = flights[0]
    assert abs(table["x_m"][-1] / float(legs[-1]["end_x_m"]) - 1) < 0.005


def test_what_must_hold_holds(flights):
    (table, turns), _ = flights[0]
    overshoot = 0.13 * (2 * BALLAST / 24.34e-6 + 60.0) / 2
    margin = table["seabed_depth_m"] - table["depth_m"]
    assert margin.min() > ALTIMETER - overshoot, margin.min()
    assert table["depth_m"].max() < MAX_DEPTH + overshoot and table["depth_m"].min() > -0.3
    assert (np.diff(table["energy_J"]) >= 0).all()
    assert table["speed_m_s"].max() < 0.5
    # Trimmed by what it reads: from the second leg of a kind on, the pitch at its end is the one ordered.
    for kind, wanted in (("descent", -PITCH), ("ascent", PITCH)):
        ends = [pitch for _, ended, why, _, pitch in turns if ended == kind and why != "surfaced"]
        assert len(ends) >= 3 and all(abs(pitch - wanted) < DEADBAND for pitch in ends[1:]), (kind, ends)
    # The surface is left and met by the clock: on time, but for the leg that is under way.
    surfaced = [time for time, _, why, _, _ in turns if why == "surfaced"]
    assert surfaced and FIRST_SURFACING < surfaced[0] < FIRST_SURFACING + 900
