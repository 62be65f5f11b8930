"""Every command's JSON is as the schema files in docs/reference/schemas say."""

import json
import re
import subprocess
from pathlib import Path

import jsonschema
import pytest
from conftest import MEASURED, counters, path_from
from test_log_values import files as files_of

ROOT = Path(__file__).parents[2]
SCHEMAS = {path.stem: json.loads(path.read_text(encoding="utf-8")) for path in sorted((ROOT / "docs/reference/schemas").glob("*.json"))}

WING = ["--wing", "span_m=1.01,chord_m=0.12,sweep_deg=43,aft_m=0.95", "--fin", "span_m=0.25,chord_m=0.12,sweep_deg=30,aft_m=1.75"]

# A schema's name, and commands that print such a result; words in capitals are files.
COMMANDS = [
    ("glide", "glidepolar glide rogue --glide-angle-deg -30 --speed-m-s 0.3"),
    ("glide", "glidepolar glide seaexplorer"),
    ("turn", "glidepolar turn slocum-049 --rudder-deg 11 --net-mass-kg -0.2"),
    ("turn", "glidepolar turn seaglider --sweep roll-mass-deg=-40..40:3"),
    ("compare", "glidepolar compare slocum-049 seaglider FLIGHT --vehicle slocum-049"),
    ("simulate", "glidepolar simulate slocum-graver --stop 50"),
    ("mission", "glidepolar simulate slocum-049 --mission MISSION"),
    ("simulate-space", "glidepolar simulate slocum-049 --3d --stop 50"),
    ("mission-space", "glidepolar simulate slocum-049 --3d --mission LAWN_MOWER --stop 3000"),
    ("sweep", "glidepolar simulate slocum-graver --sweep VARIANTS --stop 50"),
    ("identify", "glidepolar identify FLIGHT --vehicle slocum-049"),
    ("identify", "glidepolar identify SEA_LOG --vehicle SEA_VEHICLE"),
    ("identify", "glidepolar identify FLIGHT --vehicle slocum-049 --method iterative"),
    ("diagnosis", "glidepolar diagnose SEA_LOG --vehicle SEA_VEHICLE"),
    ("track", "glidepolar track FLIGHT --vehicle slocum-049"),
    ("plan", "glidepolar plan seaglider --battery-Wh 2700 --depth-m 500 --sensor-W 0.5"),
    ("plan", "glidepolar plan seaglider --moves MOVES --dives DIVES"),
    ("tank-reduce", "tank-reduce POINTS --hull HULL --out OUT"),
    ("tank-reduce", "tank-reduce CAMPAIGN --diagnose --out OUT"),
    ("demo", "glidepolar demo DEMO --python no-such-python"),
    ("assemble", "glidepolar assemble FITS --hull LDR8.5 WING -o ASSEMBLED"),
]


@pytest.fixture(scope="module")
def files(tmp_path_factory) -> dict[str, Path]:
    folder = tmp_path_factory.mktemp("schemas")
    found = {name: folder / f"{name.lower()}.csv" for name in ("FLIGHT", "VARIANTS", "MOVES", "DIVES")}
    found |= {"MISSION": ROOT / "missions/rising-seabed.toml", "LAWN_MOWER": ROOT / "missions/lawn-mower.toml", "OUT": folder / "out", "ASSEMBLED": folder / "assembled.toml", "DEMO": folder / "demo"}
    found |= {"POINTS": ROOT / "tank/data/suboff_roddy1990.csv", "HULL": ROOT / "tank/data/suboff.toml"}
    program, tank, sea = (path_from(f"GLIDEPOLAR_{name}") for name in ("COMMAND", "TANK_REDUCE", "VIRTUAL_SEA"))
    subprocess.run([program, "simulate", "slocum-049", "--mission", found["MISSION"], "--log", found["FLIGHT"], "-q"], check=True)
    subprocess.run([sea, "--seed", "3", "--effect", "drag_growth", "--hours", "6", "--dives", "8", "--out", folder / "sea"], check=True)
    found["SEA_LOG"], found["SEA_VEHICLE"] = folder / "sea/log.csv", folder / "sea/vehicle.toml"
    found["VARIANTS"].write_text("b\n0.2\n0.3\n")
    moves, dives = counters()
    found["MOVES"].write_text(moves)
    found["DIVES"].write_text(dives)
    found["CAMPAIGN"] = folder / "campaign"
    subprocess.run([tank, "demo", found["CAMPAIGN"], "--hull", "LDR8.5", "--effect", "crossflow", "--quiet"], check=True)
    subprocess.run([tank, found["CAMPAIGN"], "--out", folder / "reduced", "--quiet"], check=True)
    found["FITS"] = folder / "reduced/fits.json"
    return found


@pytest.mark.parametrize("name, command", COMMANDS)
def test_a_result_is_as_its_schema_says(files, name, command):
    words = [word for part in command.split() for word in (WING if part == "WING" else [str(files.get(part, part))])]
    program = path_from("GLIDEPOLAR_TANK_REDUCE" if words[0] == "tank-reduce" else "GLIDEPOLAR_COMMAND")
    printed = subprocess.check_output([program, *words[1:], "--json", "-", "--force"], stderr=subprocess.DEVNULL)
    result = json.loads(printed)
    jsonschema.validate(result, SCHEMAS[name])
    # The schema can fail: each field that it needs is missed, and a text is no number.
    for field in SCHEMAS[name]["required"]:
        with pytest.raises(jsonschema.ValidationError):
            jsonschema.validate({key: value for key, value in result.items() if key != field}, SCHEMAS[name])


# Real logs lack what the made ones have, and other fields are empty.
REAL = [
    ("identify", "seaglider_sg236", "p*.nc", "seaglider"),
    ("identify", ".", "comet_2019_spiral.csv", "slocum-049"),
    ("diagnosis", "seaglider_sg236", "p*.nc", "seaglider"),
    ("diagnosis", ".", "maria997_2022_slocum_g3_glides.csv", "slocum-049"),
    ("track", "seaglider_sg236", "p*.nc", "seaglider"),
]


@pytest.mark.parametrize("name, folder, pattern, vehicle", REAL, ids=[f"{name}-{pattern}" for name, _, pattern, _ in REAL])
def test_the_result_of_a_real_log_is_as_its_schema_says(glidepolar, name, folder, pattern, vehicle):
    logs = files_of(MEASURED / folder, pattern)
    command = "diagnose" if name == "diagnosis" else name
    printed = subprocess.check_output([glidepolar, command, *logs, "--vehicle", vehicle, "--json", "-"], stderr=subprocess.DEVNULL)
    jsonschema.validate(json.loads(printed), SCHEMAS[name])


def fields(schema, path=()):
    """Every field that a schema describes, with its path."""
    for name, field in schema.get("properties", {}).items():
        yield (*path, name), field
        yield from fields(field, (*path, name))
    for nested in ("items", "additionalProperties"):
        if isinstance(schema.get(nested), dict):
            yield from fields(schema[nested], path)


@pytest.mark.parametrize("name", SCHEMAS)
def test_no_field_is_always_empty(name):
    """A schema made from one result would forbid what another one has."""
    assert [path for path, field in fields(SCHEMAS[name]) if field.get("type") == "null"] == []


def test_every_schema_is_valid_tried_and_described():
    described = (ROOT / "docs/reference/json.md").read_text(encoding="utf-8")
    assert {name for name, _ in COMMANDS} == set(SCHEMAS)
    for name, schema in SCHEMAS.items():
        jsonschema.Draft202012Validator.check_schema(schema)
        assert f"`{schema['properties']['schema']['const']}`" in described and f"schemas/{name}.json" in described


def test_every_schema_that_a_program_prints_has_a_file():
    sources = [path for folder in ("src", "tank/src") for path in (ROOT / folder).rglob("*.rs")]
    known = {schema["properties"]["schema"]["const"] for schema in SCHEMAS.values()}
    printed = {found for path in sources for found in re.findall(r'"((?:glidepolar\.[a-z-]+|tank-reduce)/\d+)"', path.read_text(encoding="utf-8"))}
    printed -= {"glidepolar.virtual-tank/1", "tank-reduce/9"}
    assert printed <= known
