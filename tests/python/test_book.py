"""Every command that README.md and docs/ show is run, page by page, in a folder of its own, as a reader would type it.

A command is a line of an indented or fenced block that begins with a program's name; text two or more spaces behind it is
the page's remark, a backslash at its end goes on in the next line. Blocks of Python (```python) are run, too. The folder
has what the pages speak of without making it: my-glider.toml, flight.csv, fixes.csv, motor_moves.csv, dives.csv, and the
checkout's missions/, tank/data/ and examples/.

Commands of cargo are run in the checkout itself. Lines of HTML above a block say how it is run where that is not as it
stands; what is not there is listed as skipped:

    <!-- in short: A => B; C => -->  run with B in the place of A and without C: a campaign of an hour, of a minute
    <!-- clean start -->             on top of a page: nothing is there but the checkout, and what a page prints as the
                                     output of a command (```output behind it) are lines that the command prints
    <!-- with: data/sg542 -->        run where that folder is in the checkout
    <!-- measured: a.csv b.csv -->   run where those tables are among the measured data, put into the reader's folder
"""

import os
import re
import shlex
import shutil
import subprocess
import sys
from dataclasses import dataclass, field, replace
from pathlib import Path

import pytest
from conftest import MEASURED, counters, empty_environment, long, path_from, together

ROOT = Path(__file__).parents[2]
PAGES = [ROOT / "README.md", ROOT / "wheel/README.md", *sorted((ROOT / "docs").rglob("*.md"))]
PROGRAMS = {"glidepolar", "tank-reduce", "cargo", "fmpy", "python", "pip", "man", "printf", "valgrind"}
CLEAN_START = "<!-- clean start -->"
# Pages that diagnose long logs.
LONG = {"findings.md", "fmu-users.md", "pilots.md"}
MARKER = re.compile(r"<!-- (in short|with|measured): (.+?) -->")
# Longer than this, and a command belongs into a campaign; those of cargo may have to build first.
PATIENCE_S, PATIENCE_OF_CARGO_S = 120, 1200


@dataclass
class Block:
    """Commands or Python of a page that stand together."""

    line: int
    text: str
    is_python: bool
    markers: dict[str, str]
    output: list[str] = field(default_factory=list)

    @property
    def commands(self) -> list[str]:
        return [command for command in map(command_of, joined(self.text)) if command]

    def shortened(self) -> "Block":
        """The block as its marker has it run."""
        text = self.text
        for change in self.markers["in short"].split(";"):
            long, short = (part.strip() for part in f"{change} ".split(" => "))
            assert long in text, f"the marker speaks of what the commands have not: {long}"
            text = text.replace(long, short)
        return replace(self, text=text)


def joined(text: str) -> list[str]:
    """Lines, those that end in a backslash with the next."""
    return re.sub(r"\\\n\s*", "", text).splitlines()


def command_of(line: str) -> str | None:
    """The command in a line without the remark behind it; None where the line is none."""
    line = re.split(r"\s+#\s|\s{2,}(?=[^-\s|&>])", line.strip().removeprefix("$ "))[0]
    return line if program_of(line) in PROGRAMS else None


def program_of(line: str) -> str:
    """The word behind a command's environment."""
    return re.sub(r"^([A-Z_0-9]+=(\"[^\"]*\"|\S*)\s+)*", "", line).partition(" ")[0]


def blocks_of(page: Path) -> list[Block]:
    blocks, markers, lines = [], {}, page.read_text(encoding="utf-8").splitlines()
    number = 0
    while number < len(lines):
        line, begin = lines[number], number
        if line.startswith("```output"):
            end = next(i for i in range(number + 1, len(lines)) if lines[i].startswith("```"))
            blocks[-1].output = lines[number + 1 : end]
            number, marker = end + 1, None
        elif line.startswith("```"):
            end = next(i for i in range(number + 1, len(lines)) if lines[i].startswith("```"))
            blocks.append(Block(begin + 1, "\n".join(lines[number + 1 : end]), line.startswith("```python"), markers))
            number, markers = end + 1, {}
        elif line.startswith("    ") and (number == 0 or not lines[number - 1].strip() or MARKER.search(lines[number - 1])):
            while number < len(lines) and (lines[number].startswith("    ") or not lines[number].strip()):
                number += 1
            text = "\n".join(text.removeprefix("    ") for text in lines[begin:number])
            blocks.append(Block(begin + 1, text, False, markers))
            markers = {}
        else:
            found = MARKER.search(line)
            markers = {**markers, found[1]: found[2]} if found else (markers if not line.strip() else {})
            number += 1
    return [block for block in blocks if block.is_python or block.commands]


def test_commands_are_found_and_remarks_are_not_taken_for_them():
    text = "  tank-reduce demo x --seed 7   something hidden\n"
    assert command_of(text) == "tank-reduce demo x --seed 7"
    assert command_of("cargo xtask fmu   # the FMUs") == "cargo xtask fmu"
    assert command_of("BLIND_SEEDS=20 cargo test -p x -- --ignored") == "BLIND_SEEDS=20 cargo test -p x -- --ignored"
    assert program_of('A=1 RUNNER="valgrind --quiet" cargo test') == "cargo"
    assert command_of("w = -V sin xi") is None
    assert joined("glidepolar assemble a \\\n    --wing b\nc") == ["glidepolar assemble a --wing b", "c"]
    assert command_of("glidepolar vehicles x > y.toml") == "glidepolar vehicles x > y.toml"


def test_pages_are_found_with_their_commands():
    """Were the reading of pages broken, nothing would be run and nothing would fail."""
    counted = {str(page.relative_to(ROOT)): sum(len(block.commands) for block in blocks_of(page)) for page in PAGES}
    assert counted["README.md"] >= 5 and counted["docs/how-to/missions-and-plans.md"] >= 4, counted
    assert counted["docs/how-to/tank-engineers.md"] >= 3 and counted["docs/how-to/pilots.md"] >= 4, counted


def test_every_link_and_picture_leads_somewhere():
    broken = []
    for page in PAGES:
        for target in re.findall(r"\]\(([^)#\s]+)(?:#[^)]*)?\)", page.read_text(encoding="utf-8")):
            if not re.match(r"[a-z]+:", target) and not (page.parent / target).exists():
                broken.append(f"{page.name}: {target}")
    assert broken == []


def test_the_contents_name_every_page():
    contents = (ROOT / "docs/README.md").read_text(encoding="utf-8")
    pages = [page.relative_to(ROOT / "docs").as_posix() for page in (ROOT / "docs").rglob("*.md")]
    missing = [page for page in pages if page != "README.md" and f"({page}" not in contents]
    assert missing == []


@pytest.fixture(scope="session")
def programs(glidepolar, tmp_path_factory) -> Path:
    """A folder with the programs by the names that the pages use."""
    folder = tmp_path_factory.mktemp("programs")
    here = {"glidepolar": glidepolar, "tank-reduce": path_from("GLIDEPOLAR_TANK_REDUCE"), "python": Path(sys.executable)}
    here["fmpy"] = Path(sys.executable).with_name("fmpy")
    _, pip = empty_environment(folder / "environment")
    (folder / "pip").write_text(f'#!/bin/sh\nexec {shlex.join(pip)} "$@"\n')
    (folder / "pip").chmod(0o755)
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
    # Two fixes beside the log.
    header, *rows = [line for line in (folder / "log.csv").read_text().splitlines() if not line.startswith("#")]
    (folder / "flight.csv").write_text("\n".join([header, *rows]) + "\n")
    (folder / "log.csv").unlink()
    (folder / "fixes.csv").write_text("time_s,lat_deg,lon_deg\n0,47.5,-52.5\n4200,47.506,-52.488\n18000,47.52,-52.43\n")
    moves, dives = counters()
    (folder / "motor_moves.csv").write_text(moves)
    (folder / "dives.csv").write_text(dives)
    return folder


def shell(command: str, folder: Path, programs: Path, patience_s: float = PATIENCE_S) -> str:
    env = {**os.environ, "PATH": f"{programs}{os.pathsep}{os.environ['PATH']}"}
    # Those are for the tests; a reader has none of them. The FMU is looked for in target/fmu, as in a checkout.
    for name in list(env):
        if name.startswith("GLIDEPOLAR_"):
            del env[name]
    done = subprocess.run(
        ["bash", "-euo", "pipefail", "-c", command], cwd=folder, capture_output=True, text=True, env=env, timeout=patience_s
    )
    assert done.returncode == 0, f"{command}\nexit code {done.returncode}\n{done.stdout[-2000:]}\n{done.stderr[-4000:]}"
    return done.stdout


def cargo(command: str, folder: Path, programs: Path) -> None:
    """Runs it in the checkout, on files of the reader's folder by their whole names; leaves the checkout as it was."""
    if command == "cargo xtask test":
        # What has run these tests is this very command.
        assert "GLIDEPOLAR_SKIPPED" in os.environ
        return
    for word, needed, package in (("valgrind", "valgrind", "valgrind"), ("xtask fuzz", "c++", "g++")):
        if word in command and shutil.which(needed) is None:
            pytest.skip(f"no {needed}, `apt-get install {package}` gets it: {command}")
    words = [str(folder / word) if "." in word and (folder / word).is_file() else word for word in command.split(" ")]
    before = kept_files()
    shell(" ".join(words), ROOT, programs, PATIENCE_OF_CARGO_S)
    assert kept_files() == before, f"{command} has written files anew that the checkout keeps: commit them"


def kept_files() -> dict[Path, bytes]:
    """What commands write into the checkout itself: a run of the tests leaves it as it was."""
    return {file: file.read_bytes() for folder in ("docs", "modelDescription") for file in (ROOT / folder).rglob("*.*")}


def in_groups(pages: list[Path]) -> list:
    """The pages as parameters: those that run cargo one after the other, since it builds in one folder, and first."""

    def runs_cargo(page: Path) -> bool:
        return any(program_of(command) == "cargo" for block in blocks_of(page) for command in block.commands)

    def parameter(page: Path):
        marks = [together("cargo"), long] if runs_cargo(page) else [long] if page.name in LONG else []
        return pytest.param(page, id=str(page.relative_to(ROOT)), marks=marks)

    return [parameter(page) for page in sorted(pages, key=runs_cargo, reverse=True)]


@pytest.mark.timeout(2 * PATIENCE_OF_CARGO_S)
@pytest.mark.skipif(shutil.which("bash") is None, reason="the commands are those of a shell: no bash")
@pytest.mark.parametrize("page", in_groups(PAGES))
def test_every_command_of_a_page_runs(page, programs, given, fmu3, fmu2, wheel, tmp_path, subtests):
    folder = tmp_path / "reader"
    if CLEAN_START in page.read_text(encoding="utf-8"):
        folder.mkdir()
    else:
        shutil.copytree(given, folder)
    for below in ("missions", "tank", "vehicles", "examples", "tests"):
        (folder / below).symlink_to(ROOT / below)
    (folder / "target/fmu").mkdir(parents=True)
    for fmu in (fmu3, fmu2):
        (folder / "target/fmu" / fmu.name).symlink_to(fmu)
    (folder / wheel.name).symlink_to(wheel)
    if (ROOT / "data").is_dir():
        (folder / "data").symlink_to(ROOT / "data")
        for log in (ROOT / "data/sg542").glob("*.nc"):
            (folder / log.name).symlink_to(log)
    for block in blocks_of(page):
        with subtests.test(msg=f"{page.name}:{block.line}"):
            if "in short" in block.markers:
                block = block.shortened()
            # What another test fetches meanwhile was not linked.
            if (reason := block.markers.get("with")) and not (folder / reason).exists():
                pytest.skip(f"{reason} is not there, `cargo xtask fetch-data` gets it: {'; '.join(block.commands)}")
            if reason := block.markers.get("measured"):
                measured = [MEASURED / name for name in reason.split()]
                if missing := [str(file) for file in measured if not file.exists()]:
                    pytest.skip(f"no measured data: {', '.join(missing)}: {'; '.join(block.commands)}")
                for file in measured:
                    (folder / file.name).unlink(missing_ok=True)
                    (folder / file.name).symlink_to(file)
            if block.is_python:
                (folder / "block.py").write_text(block.text)
                shell("python block.py", folder, programs)
            printed = ""
            for command in block.commands:
                if program_of(command) == "cargo":
                    cargo(command, folder, programs)
                else:
                    printed += shell(command, folder, programs)
            words = [" ".join(line.split()) for line in printed.splitlines()]
            missing = [line for line in block.output if line != "..." and " ".join(line.split()) not in words]
            assert missing == [], f"{block.commands} prints otherwise:\n{printed}"
