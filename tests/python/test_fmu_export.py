"""`glidepolar export-fmu`: the description's start values are what the instance really starts from, whoever the vehicle is."""

import subprocess

import numpy as np
import pytest
from conftest import path_from
from fmpy import read_model_description, simulate_fmu
from fmpy.validation import validate_fmu

WATER = "depth_m,density_kg_m3,temperature_C\n0,1027,17\n30,1027.2,12\n100,1027.6,8\n"


def export(glidepolar, template, folder, vehicle, *more):
    path = folder / "exported.fmu"
    standard = "2" if template.name.endswith("_fmi2.fmu") else "3"
    command = [glidepolar, "export-fmu", vehicle, "-o", path, "--fmi", standard, "--template", template, *more]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return path


@pytest.mark.parametrize("vehicle", ["rogue", "slocum-graver"])
def test_an_exported_vehicle_starts_where_its_description_says(glidepolar, fmu, tmp_path, vehicle):
    path = export(glidepolar, fmu, tmp_path, vehicle)
    assert validate_fmu(str(path)) == []
    stated = {
        v.name: float(v.start) for v in read_model_description(path).modelVariables if v.start and v.type != "String"
    }
    for interface in ("CoSimulation", "ModelExchange"):
        result = simulate_fmu(path, fmi_type=interface, stop_time=1, output=list(stated), output_interval=1)
        for name, start in stated.items():
            # Bit for bit: what the importer reads is what the instance starts from.
            assert float(result[name][0]) == start, (interface, name)


@pytest.mark.parametrize("template", ["GLIDEPOLAR_SPACE_FMU3", "GLIDEPOLAR_SPACE_FMU2"], ids=["fmi3", "fmi2"])
def test_a_vehicle_exported_in_space_is_valid_and_starts_where_its_description_says(glidepolar, template, tmp_path):
    path = export(glidepolar, path_from(template), tmp_path, "slocum-graver", "--3d")
    assert validate_fmu(str(path)) == []
    stated = {
        v.name: float(v.start) for v in read_model_description(path).modelVariables if v.start and v.type != "String"
    }
    result = simulate_fmu(path, stop_time=1, output=list(stated), output_interval=1)
    assert {name: float(result[name][0]) for name in stated} == stated


def test_the_water_travels_along(glidepolar, fmu, tmp_path):
    table = tmp_path / "water.csv"
    table.write_text(WATER)
    path = export(glidepolar, fmu, tmp_path, "slocum-graver", "--water-column", table)
    result = simulate_fmu(path, stop_time=300, output_interval=10, output=["depth_m", "surrounding_density_kg_m3"])
    density = result["surrounding_density_kg_m3"]
    assert (np.diff(density) > 0).all() and 1027 < density[0] < 1027.2 < density[-1] < 1027.6


def test_a_vehicle_that_cannot_move_and_a_template_that_is_none_are_refused(glidepolar, fmu, tmp_path):
    out = tmp_path / "out.fmu"
    for vehicle, template, expected in (
        ("no-such-vehicle", fmu, "no-such-vehicle"),
        ("rogue", tmp_path / "missing.fmu", "missing.fmu"),
    ):
        command = [glidepolar, "export-fmu", vehicle, "-o", out, "--template", template]
        done = subprocess.run(command, capture_output=True, text=True)
        assert done.returncode == 2 and expected in done.stderr, done.stderr
        assert not out.exists()
