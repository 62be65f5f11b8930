"""Every command that README.md and docs/ show is run, page by page, in a folder of its own, as a reader would type it.

A command is a line of an indented or fenced block that begins with a program's name; text two or more spaces behind it is
the page's remark, a backslash at its end goes on in the next line. Blocks of Python (```python) are run, too. The folder
has what the pages speak of without making it: my-glider.toml, flight.csv, fixes.csv, motor_moves.csv, dives.csv, and the
checkout's missions/, tank/data/ and examples/.

What no test runs says so in the page, above the block, and is listed as skipped with the reason:

    <!-- by hand: a reason -->      too long for every run, or needs a network: the reader's to run
    <!-- with: data/sg542 -->       run where that folder is in the checkout
    <!-- measured: a.csv b.csv -->  run where those tables are among the measured data, put into the reader's folder
"""

import os
import re
import shlex
import shutil
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import pytest
from conftest import MEASURED, counters, path_from

ROOT = Path(__file__).parents[2]
PAGES = [ROOT / "README.md", ROOT / "wheel/README.md", *sorted((ROOT / "docs").glob("*.md"))]
PROGRAMS = {"glidepolar", "tank-reduce", "cargo", "fmpy", "python", "pip", "man", "printf", "valgrind"}
MARKER = re.compile(r"<!-- (by hand|with|measured): (.+?) -->")
# Longer than this, and a command belongs into a campaign.
PATIENCE_S = 120


@dataclass
class Block:
    """Commands or Python of a page that stand together."""

    line: int
    text: str
    is_python: bool
    marker: tuple[str, str] | None

    @property
    def commands(self) -> list[str]:
        return [command for command in map(command_of, joined(self.text)) if command]


def joined(text: str) -> list[str]:
    """Lines, those that end in a backslash with the next."""
    return re.sub(r"\\\n\s*", "", text).splitlines()


def command_of(line: str) -> str | None:
    """The command in a line without the remark behind it; None where the line is none."""
    line = re.split(r"\s+#\s|\s{2,}(?=[^-\s|&>])", line.strip().removeprefix("$ "))[0]
    words = line.split()
    while words and re.fullmatch(r"[A-Z_0-9]+=\S*", words[0]):
        words = words[1:]
    return line if words and words[0] in PROGRAMS else None


def blocks_of(page: Path) -> list[Block]:
    blocks, marker, lines = [], None, page.read_text(encoding="utf-8").splitlines()
    number = 0
    while number < len(lines):
        line, begin = lines[number], number
        if line.startswith("```"):
            end = next(i for i in range(number + 1, len(lines)) if lines[i].startswith("```"))
            blocks.append(Block(begin + 1, "\n".join(lines[number + 1 : end]), line.startswith("```python"), marker))
            number, marker = end + 1, None
        elif line.startswith("    ") and (number == 0 or not lines[number - 1].strip() or MARKER.search(lines[number - 1])):
            while number < len(lines) and (lines[number].startswith("    ") or not lines[number].strip()):
                number += 1
            text = "\n".join(text.removeprefix("    ") for text in lines[begin:number])
            blocks.append(Block(begin + 1, text, False, marker))
            marker = None
        else:
            found = MARKER.search(line)
            marker = (found[1], found[2]) if found else (marker if not line.strip() else None)
            number += 1
    return [block for block in blocks if block.is_python or block.commands]


def test_commands_are_found_and_remarks_are_not_taken_for_them():
    text = "  tank-reduce demo x --seed 7   something hidden\n"
    assert command_of(text) == "tank-reduce demo x --seed 7"
    assert command_of("cargo xtask fmu   # the FMUs") == "cargo xtask fmu"
    assert command_of("BLIND_SEEDS=20 cargo test -p x -- --ignored") == "BLIND_SEEDS=20 cargo test -p x -- --ignored"
    assert command_of("w = -V sin xi") is None
    assert joined("glidepolar assemble a \\\n    --wing b\nc") == ["glidepolar assemble a --wing b", "c"]
    assert command_of("glidepolar vehicles x > y.toml") == "glidepolar vehicles x > y.toml"


def test_pages_are_found_with_their_commands():
    """Were the reading of pages broken, nothing would be run and nothing would fail."""
    counted = {page.name: sum(len(block.commands) for block in blocks_of(page)) for page in PAGES}
    assert counted["README.md"] >= 5 and counted["hull-tests.md"] >= 3 and counted["voyages.md"] >= 4, counted


def test_every_link_and_picture_leads_somewhere():
    broken = []
    for page in PAGES:
        for target in re.findall(r"\]\(([^)#\s]+)(?:#[^)]*)?\)", page.read_text(encoding="utf-8")):
            if not re.match(r"[a-z]+:", target) and not (page.parent / target).exists():
                broken.append(f"{page.name}: {target}")
    assert broken == []


def test_the_contents_name_every_page():
    contents = (ROOT / "docs/README.md").read_text(encoding="utf-8")
    missing = [page.name for page in (ROOT / "docs").glob("*.md") if page.name != "README.md" and f"({page.name}" not in contents]
    assert missing == []


@pytest.mark.parametrize(
    "arguments, figures",
    [
        (["glide", "slocum-049"], {"polar": "glide-polar"}),
        (
            ["simulate", "slocum-049", "--mission", ROOT / "missions/rising-seabed.toml"],
            {"depth": "rising-seabed", "record": "rising-seabed-record"},
        ),
    ],
    ids=["glide", "mission"],
)
def test_the_figures_are_those_that_the_commands_draw(glidepolar, tmp_path, arguments, figures):
    subprocess.run([str(word) for word in (glidepolar, *arguments, "--quiet", "--out", tmp_path)], check=True)
    for drawn, kept in figures.items():
        here = (tmp_path / f"figures/{drawn}.svg").read_text(encoding="utf-8")
        there = (ROOT / f"docs/figures/{kept}.svg").read_text(encoding="utf-8")
        assert here == there, f"docs/figures/{kept}.svg is stale: draw it anew by `cargo xtask figures`"


@pytest.fixture(scope="session")
def programs(glidepolar, tmp_path_factory) -> Path:
    """A folder with the programs by the names that the pages use."""
    folder = tmp_path_factory.mktemp("programs")
    here = {"glidepolar": glidepolar, "tank-reduce": path_from("GLIDEPOLAR_TANK_REDUCE"), "python": Path(sys.executable)}
    here["fmpy"] = Path(sys.executable).with_name("fmpy")
    for name, program in here.items():
        # Not a link: an interpreter finds its environment by the path that it was started with.
        (folder / name).write_text(f'#!/bin/sh\nexec "{program}" "$@"\n')
        (folder / name).chmod(0o755)
    return folder


@pytest.fixture(scope="session")
def given(programs, tmp_path_factory) -> Path:
    """The files that pages speak of without making them."""
    folder = tmp_path_factory.mktemp("given")
    mission = ROOT / "missions/rising-seabed.toml"
    command = f"""
        glidepolar vehicles slocum-049 > my-glider.toml
        glidepolar simulate slocum-049 --mission {shlex.quote(str(mission))} --interval 4 --log log.csv --quiet
        """
    shell(command, folder, programs)
    # A simulated log has no heading: one is added, and two fixes.
    header, *rows = [line for line in (folder / "log.csv").read_text().splitlines() if not line.startswith("#")]
    (folder / "flight.csv").write_text("\n".join([header + ",heading_rad", *(row + ",1.0" for row in rows)]) + "\n")
    (folder / "log.csv").unlink()
    (folder / "fixes.csv").write_text("time_s,lat_deg,lon_deg\n0,47.5,-52.5\n4200,47.506,-52.488\n18000,47.52,-52.43\n")
    moves, dives = counters()
    (folder / "motor_moves.csv").write_text(moves)
    (folder / "dives.csv").write_text(dives)
    return folder


def shell(command: str, folder: Path, programs: Path) -> str:
    env = {**os.environ, "PATH": f"{programs}{os.pathsep}{os.environ['PATH']}"}
    # Those are for the tests; a reader has none of them. The FMU is looked for in target/fmu, as in a checkout.
    for name in list(env):
        if name.startswith("GLIDEPOLAR_"):
            del env[name]
    done = subprocess.run(
        ["bash", "-euo", "pipefail", "-c", command], cwd=folder, capture_output=True, text=True, env=env, timeout=PATIENCE_S
    )
    assert done.returncode == 0, f"{command}\nexit code {done.returncode}\n{done.stdout[-2000:]}\n{done.stderr[-4000:]}"
    return done.stdout


@pytest.mark.skipif(shutil.which("bash") is None, reason="the commands are those of a shell: no bash")
@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_every_command_of_a_page_runs(page, programs, given, fmu3, fmu2, tmp_path, subtests):
    folder = tmp_path / "reader"
    shutil.copytree(given, folder)
    for below in ("missions", "tank", "vehicles", "examples", "tests"):
        (folder / below).symlink_to(ROOT / below)
    (folder / "target/fmu").mkdir(parents=True)
    for fmu in (fmu3, fmu2):
        (folder / "target/fmu" / fmu.name).symlink_to(fmu)
    if (ROOT / "data").is_dir():
        (folder / "data").symlink_to(ROOT / "data")
    for block in blocks_of(page):
        with subtests.test(msg=f"{page.name}:{block.line}"):
            what, reason = block.marker or ("", "")
            if what == "by hand":
                pytest.skip(f"by hand: {reason}: {'; '.join(block.commands)}")
            if what == "with" and not (ROOT / reason).exists():
                pytest.skip(f"{reason} is not there, `cargo xtask fetch-data` gets it: {'; '.join(block.commands)}")
            if what == "measured":
                measured = [MEASURED / name for name in reason.split()]
                if missing := [str(file) for file in measured if not file.exists()]:
                    pytest.skip(f"no measured data: {', '.join(missing)}: {'; '.join(block.commands)}")
                for file in measured:
                    (folder / file.name).unlink(missing_ok=True)
                    (folder / file.name).symlink_to(file)
            if block.is_python:
                (folder / "block.py").write_text(block.text)
                shell("python block.py", folder, programs)
            for command in block.commands:
                assert shlex.split(command, comments=True)[0] != "cargo", f"mark it `by hand`: {command}"
                shell(command, folder, programs)
