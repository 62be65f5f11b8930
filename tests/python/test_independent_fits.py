"""The diagnosis of each real log beside a least-squares fit that was written apart (`independent_fits`).

The page of findings holds the table that `python test_independent_fits.py PROGRAM FOLDER` prints. Net weights are compared whole, mass
and offset together: the two programs do not weigh the mean water alike, about which a glider without a stated trim is neutral.
"""

import json
import subprocess
import sys
import tomllib
from pathlib import Path

import numpy as np
import pytest
from conftest import MEASURED
from independent_fits import (
    SEAGLIDER,
    SLOCUM_049,
    Vehicle,
    Windows,
    fit,
    neutral,
    of_seagliders,
    of_table,
    sea_water_kg_m3,
    table,
    windows,
)
from test_ad2cp import pings

FINDINGS = Path(__file__).parents[2] / "docs/evidence/findings.md"


def maria_glides(folder):
    glides = table(folder / "maria997_2022_slocum_g3_glides.csv")
    dive = 100 * glides["segment"] + glides["glide"] // 2
    nothing = np.full(len(dive), np.nan)
    at = Windows(
        dive,
        glides["pitch_rad"],
        glides["vbd_cc"] * 1e-6,
        glides["density_kg_m3"],
        glides["pressure_dbar"] * 1e4,
        glides["temperature_C"],
        -glides["w_m_s"],
        nothing,
    )
    return neutral(SLOCUM_049, at), at


def maria_samples(folder):
    samples = of_table(table(folder / "maria997_2022_slocum_g3_samples.csv"), dive="segment")
    read = np.isfinite(samples["pitch_rad"])
    at = windows({name: values[read] for name, values in samples.items()}, length_s=240)
    return neutral(SLOCUM_049, at), at


def sg542(folder):
    at = windows(of_table(table(folder / "sg542_samples.csv")))
    return neutral(SEAGLIDER, at), at


def sg236(folder):
    at = windows(of_seagliders(sorted((folder / "seaglider_sg236").glob("p236*.nc"))))
    return neutral(SEAGLIDER, at), at


def sg171(folder):
    # Its pitch changes every minute.
    paths = sorted((folder / "seaglider_sg171").glob("p171*.nc"))
    at = windows(of_seagliders(paths, pings), length_s=60, pitch_range_deg=6)
    return neutral(SEAGLIDER, at), at


def comet(folder):
    columns = table(folder / "comet_2016_baltic_1hz.csv")
    columns["dive"] = np.cumsum(np.diff((columns["pressure_dbar"] < 2).astype(int), prepend=1) == -1).astype(float)
    at = windows(of_table(columns, speed="U_dvl_m_s"), length_s=60, after_motor_s=30)
    # The Doppler log lost the water on the last dive.
    at = at.only(at.dive < at.dive.max())
    return neutral(Vehicle(50.0, 0.04868549172346641, 0.03563, 21.0, 0.1175, 1.366), at), at


# Of each log: its fit and what is free there, the command, the cause and its parameter.
OFFSET = ("ballast_offset", "ballast_offset_kg", {"offset_kg": 0.0})
LOGS = {
    "maria, glides": (maria_glides, *OFFSET, ["maria997_2022_slocum_g3_glides.csv", "--vehicle", "slocum-049"]),
    "maria, samples": (maria_samples, *OFFSET, ["maria997_2022_slocum_g3_samples.csv", "--vehicle", "slocum-049"]),
    "SG542": (sg542, *OFFSET, ["sg542_samples.csv", "--vehicle", "seaglider"]),
    "Comet": (
        comet,
        "pitch_scale",
        "pitch_scale",
        {"offset_kg": 0.0, "pitch_scale": 1.0},
        ["comet_2016_baltic_1hz.csv", "--vehicle", "slocum-graver", "--speed-column", "U_dvl_m_s", "--pin-lift=21"],
    ),
    "SG171": (sg171, *OFFSET, ["seaglider_sg171", "--vehicle", "seaglider", "--speed-column", "ad2cp"]),
    "SG236": (sg236, *OFFSET, ["seaglider_sg236", "--vehicle", "seaglider"]),
}


def diagnosed(glidepolar, folder, arguments, name, scratch):
    """What the program finds: value and standard error of a parameter, named or as a trim, and the mass it goes with, if written."""
    first = folder / arguments[0]
    paths = sorted(first.glob("p*.nc")) if first.is_dir() else [first]
    extended, answer = scratch / "extended.toml", scratch / "diagnosis.json"
    options = [*arguments[1:], "--json", answer, "--extended", extended, "--quiet", "--force"]
    done = subprocess.run(
        [str(part) for part in [glidepolar, "diagnose", *paths, *options]], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    found = json.loads(answer.read_text(encoding="utf-8"))
    named = [cause["parameters"][name] for cause in found["causes"] if name in cause["parameters"]]
    size = named[0] if named else found["trim"]
    mass = tomllib.loads(extended.read_text(encoding="utf-8"))["mass"]["mass_kg"] if extended.exists() else None
    return size["value"], size["se"], mass


def compare(glidepolar, folder, log, scratch):
    """Both sizes with their standard errors, and the root mean square of the vertical velocity that the second one leaves."""
    of_log, _, parameter, free, arguments = LOGS[log]
    vehicle, at = of_log(folder)
    sizes, rms = fit(vehicle, at, free, w_error=0.005 if log == "Comet" else 0.008, speed_error=0.015 if log == "Comet" else 0.03)
    value, se = sizes["offset_kg" if parameter == "ballast_offset_kg" else parameter]
    theirs, their_se, mass = diagnosed(glidepolar, folder, arguments, parameter, scratch)
    if parameter == "ballast_offset_kg" and mass is not None:
        value += vehicle.mass_kg - mass
    return (theirs, their_se), (value, se), rms


def row(log, theirs, apart, rms):
    """A row of the page's table."""
    is_mass = LOGS[log][1] == "ballast_offset"
    scale, digits, unit = (1000, 1, " g") if is_mass else (1, 3, "")
    sizes = [f"{scale * value:.{digits}f} +- {scale * se:.{digits}f}{unit}" for value, se in (theirs, apart)]
    what = "net weight" if is_mass else "scale of the pitch"
    return f"| {log} | {what} | {' | '.join(sizes)} | {1000 * rms:.1f} mm/s |"


def test_the_density_is_that_of_the_published_check_values():
    assert abs(sea_water_kg_m3(np.array(0.0), 5.0, 0.0) - 999.96675) < 1e-5
    assert abs(sea_water_kg_m3(np.array(35.0), 25.0, 10000.0) - 1062.53817) < 1e-5


@pytest.mark.parametrize("log", LOGS)
def test_a_fit_written_apart_agrees(glidepolar, log, tmp_path):
    theirs, apart, rms = compare(glidepolar, MEASURED, log, tmp_path)
    assert abs(theirs[0] - apart[0]) < 2 * np.hypot(theirs[1], apart[1]), (theirs, apart)
    assert row(log, theirs, apart, rms) in FINDINGS.read_text(encoding="utf-8"), row(log, theirs, apart, rms)


if __name__ == "__main__":
    import tempfile

    for log in LOGS:
        with tempfile.TemporaryDirectory() as scratch:
            print(row(log, *compare(sys.argv[1], Path(sys.argv[2]), log, Path(scratch))))
