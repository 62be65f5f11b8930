"""Do two builds of the commands give the same results?

    python xtask/python/same_results.py BEFORE AFTER [--data FOLDER] [--seeds N]

BEFORE and AFTER are folders with `glidepolar`, `tank-reduce` and `virtual-sea`. Both run every command that prints JSON
on measured data (FOLDER, those whose files are there) and on virtual logs and campaigns that `virtual-sea` and
`tank-reduce demo` of BEFORE write. Printed is the largest relative difference of any number of each command's JSON, and
texts that differ in more than their rounded numbers. The exit code is 1 where a number differs by more than 1e-9.
"""

import argparse
import json
import math
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

LIMIT = 1e-9
NUMBER = re.compile(r"[-+]?\d+\.?\d*(?:[eE][-+]?\d+)?")
# Effects of the virtual sea, one for each seed in turn.
EFFECTS = ["none", "drag_step", "leak", "hull_compressibility", "trapped_air", "pitch_scale", "thermal_lag", "hull_creep"]


def leaves(value, path=""):
    """Every number and text of a JSON value with where it stands."""
    if isinstance(value, dict):
        for key, inner in value.items():
            yield from leaves(inner, f"{path}/{key}")
    elif isinstance(value, list):
        for i, inner in enumerate(value):
            yield from leaves(inner, f"{path}/{i}")
    else:
        yield path, value


def difference(before, after):
    """The largest relative difference of two results, where it is, and the texts that differ in more than numbers."""
    worst, place, texts = 0.0, "", []
    ones, others = dict(leaves(before)), dict(leaves(after))
    if ones.keys() != others.keys():
        return math.inf, "keys: " + ", ".join(sorted(ones.keys() ^ others.keys())[:4]), texts
    for path, one in ones.items():
        other = others[path]
        if isinstance(one, float | int) and isinstance(other, float | int) and not isinstance(one, bool):
            size = max(abs(one), abs(other))
            apart = abs(one - other) / size if size > 0 else 0.0
        elif isinstance(one, str) and isinstance(other, str):
            # Numbers in a sentence are rounded: those that the fields hold are compared above.
            if NUMBER.sub("0", one) != NUMBER.sub("0", other):
                texts.append(f"{path}: {one} | {other}")
            apart = 0.0
        else:
            apart = 0.0 if one == other else math.inf
        if apart > worst:
            worst, place = apart, f"{path}: {one} {other}"
    return worst, place, texts


def run(folder, arguments, cwd):
    """Exit code and JSON of a command of this build; its message where it has no result."""
    program, *rest = arguments
    done = subprocess.run(
        [folder / program, *rest, "--json", "-", "--quiet"], cwd=cwd, capture_output=True, text=True, check=False
    )
    try:
        return done.returncode, json.loads(done.stdout)
    except json.JSONDecodeError:
        return done.returncode, done.stderr


def on_measured_data(data):
    """Commands on the files of the folder of measured data."""
    comet = ["comet_2016_baltic_1hz.csv", "--vehicle", "slocum-graver", "--speed-column", "U_dvl_m_s"]
    comet += ["--column", "pitch_rad=pitch_corr_rad"]
    hull = ["--free", "hull_compressibility_per_Pa", "--free", "hull_thermal_expansion_per_K"]
    fleets = {"seaglider_sg171": sorted(data.glob("seaglider_sg171/*.nc")), "seaglider_sg236": sorted(data.glob("seaglider_sg236/*.nc"))}
    cases = {
        "identify comet": ["glidepolar", "identify", *comet],
        "identify comet --unsteady": ["glidepolar", "identify", *comet, "--unsteady"],
        "identify comet --pin a=21+-3": ["glidepolar", "identify", *comet[:3], *comet[5:], "--pin", "a=21.1+-2.9"],
        "identify comet --method iterative": ["glidepolar", "identify", *comet, "--method", "iterative"],
        "identify comet spiral": ["glidepolar", "identify", "comet_2019_spiral.csv", "--vehicle", "slocum-049"],
        "identify maria": ["glidepolar", "identify", "maria997_2022_slocum_g3_glides.csv", "--vehicle", "slocum-graver"],
        "identify maria samples": ["glidepolar", "identify", "maria997_2022_slocum_g3_samples.csv", "--vehicle", "slocum-049"],
        "identify sg542": ["glidepolar", "identify", "sg542_samples.csv", "--vehicle", "seaglider", *hull],
        "diagnose comet": ["glidepolar", "diagnose", *comet],
        "diagnose comet --pin-lift": ["glidepolar", "diagnose", *comet, "--pin-lift=21"],
        "diagnose maria": ["glidepolar", "diagnose", "maria997_2022_slocum_g3_glides.csv", "--vehicle", "slocum-049"],
        "diagnose maria samples": ["glidepolar", "diagnose", "maria997_2022_slocum_g3_samples.csv", "--vehicle", "slocum-049"],
        "diagnose sg542": ["glidepolar", "diagnose", "sg542_samples.csv", "--vehicle", "seaglider"],
        "plan sg542": ["glidepolar", "plan", "seaglider", "--moves", "sg542_motor_moves.csv", "--dives", "sg542_dives.csv"],
        "plan seaglider": ["glidepolar", "plan", "seaglider", "--battery-Wh", "2700", "--depth-m", "1000", "--density", "1026.5"],
        "track comet spiral": ["glidepolar", "track", "comet_2019_spiral.csv", "--vehicle", "slocum-049"],
    }
    for name, files in fleets.items():
        files = [str(file) for file in files]
        cases[f"identify {name}"] = ["glidepolar", "identify", *files, "--vehicle", "from-file"]
        cases[f"identify {name} ad2cp"] = ["glidepolar", "identify", *files, "--vehicle", "seaglider", "--speed-column", "ad2cp"]
        cases[f"diagnose {name}"] = ["glidepolar", "diagnose", *files, "--vehicle", "seaglider"]
        cases[f"track {name}"] = ["glidepolar", "track", *files, "--vehicle", "seaglider"]
    for log in sorted(data.glob("outside/*.csv.gz")):
        vehicle = str(log).replace(".csv.gz", ".vehicle.toml")
        name = log.name.split(".")[0]
        for verb in ("identify", "diagnose"):
            cases[f"{verb} {name}"] = ["glidepolar", verb, name + ".csv", "--vehicle", vehicle]
    for campaign in sorted(data.glob("outside/campaign*.tar.gz")):
        name = campaign.name.split(".")[0]
        cases[f"tank-reduce --diagnose {name}"] = ["tank-reduce", name, "--diagnose", "--out", "OUT"]
    return cases


def virtual(before, folder, seeds):
    """Commands on virtual logs and campaigns, which are written now."""
    cases = {}
    for seed in range(1, seeds + 1):
        log = folder / f"sea{seed}"
        effect = EFFECTS[seed % len(EFFECTS)]
        made = [before / "virtual-sea", "--seed", str(7000 + seed), "--effect", effect, "--out", log]
        subprocess.run(made, capture_output=True, check=True)
        for verb in ("identify", "diagnose", "track"):
            cases[f"{verb} sea{seed} ({effect})"] = ["glidepolar", verb, str(log / "log.csv"), "--vehicle", str(log / "vehicle.toml")]
        cases[f"plan sea{seed}"] = ["glidepolar", "plan", str(log / "vehicle.toml"), "--battery-Wh", "2000", "--depth-m", "200", "--set", "energy.hotel_W=1"]
        tank = folder / f"tank{seed}"
        subprocess.run([before / "tank-reduce", "demo", tank, "--seed", str(8000 + seed)], capture_output=True, check=True)
        cases[f"tank-reduce --diagnose tank{seed}"] = ["tank-reduce", str(tank), "--diagnose", "--out", "OUT"]
        fits = folder / f"fits{seed}"
        subprocess.run([before / "tank-reduce", tank, "--out", fits, "--quiet"], capture_output=True, check=False)
        wing = "span_m=1.01,chord_m=0.12,sweep_deg=43,aft_m=0.88"
        fin = "span_m=0.25,chord_m=0.12,sweep_deg=30,aft_m=1.75"
        sensor = "drag_area_m2=0.002,aft_m=1.0,starboard_m=-0.15,below_m=0.05,power_W=0.2"
        parts = ["--hull", "LDR8.5", "--tow-speed-m-s", "2", "--wing", wing, "--fin", fin, "--sensor", sensor]
        cases[f"assemble tank{seed}"] = ["glidepolar", "assemble", str(fits / "fits.json"), *parts]
    return cases


def prepare(data, folder):
    """The measured data in the folder that the commands run in, archives unpacked."""
    for file in data.iterdir():
        (folder / file.name).symlink_to(file)
    for archive in data.glob("outside/*"):
        if archive.name.endswith(".tar.gz"):
            out = folder / archive.name.split(".")[0]
            out.mkdir()
            subprocess.run(["tar", "-xzf", archive, "-C", out, "--strip-components=1"], check=True)
        elif archive.name.endswith(".csv.gz"):
            unpacked = subprocess.run(["gzip", "-dc", archive], capture_output=True, check=True).stdout
            (folder / archive.name.removesuffix(".gz")).write_bytes(unpacked)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("before", type=Path)
    parser.add_argument("after", type=Path)
    parser.add_argument("--data", type=Path, help="folder with the measured data")
    parser.add_argument("--seeds", type=int, default=20, help="virtual logs and campaigns")
    parser.add_argument("--only", default="", help="cases whose name holds this")
    arguments = parser.parse_args()
    before, after = arguments.before.resolve(), arguments.after.resolve()
    worst = 0.0
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        cases = {}
        if arguments.data:
            data = arguments.data.resolve()
            prepare(data, folder)
            cases |= on_measured_data(data)
        cases |= virtual(before, folder, arguments.seeds)
        for name, command in cases.items():
            if arguments.only not in name:
                continue
            results = []
            for build in (before, after):
                results.append(run(build, command, folder))
                shutil.rmtree(folder / "OUT", ignore_errors=True)
            (code, one), (other_code, other) = results
            apart, place, texts = difference({"code": code, "result": one}, {"code": other_code, "result": other})
            worst = max(worst, apart)
            print(f"{apart:9.1e}  {name}  (exit {code}){'  ' + place[:160] if apart > LIMIT else ''}", flush=True)
            for text in texts:
                print(f"           text: {text[:300]}")
    print(f"{worst:9.1e}  largest of {len(cases)} commands, limit {LIMIT:g}")
    return int(worst > LIMIT)


if __name__ == "__main__":
    sys.exit(main())
