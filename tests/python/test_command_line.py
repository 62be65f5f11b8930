"""The habits of both commands: help with examples, exit codes, hints for misspelt names, colour, silence, JSON alone on
standard output, completions and manual pages; text from files that cannot act on a terminal or a page; files that are
whole whenever the program is killed."""

import json
import os
import random
import re
import shutil
import signal
import subprocess
import time
from pathlib import Path

import pytest
from conftest import path_from

ROOT = Path(__file__).parents[2]
COMMANDS = ["glide", "compare", "simulate", "identify", "diagnose", "track", "turn", "plan", "assemble", "vehicles", "export-fmu", "fmu", "demo", "completions", "man"]  # fmt: skip


@pytest.fixture(scope="session")
def tank_reduce() -> Path:
    return path_from("GLIDEPOLAR_TANK_REDUCE")


def run(program, *arguments, cwd=None, **environment):
    return subprocess.run(
        [str(word) for word in (program, *arguments)],
        capture_output=True,
        text=True,
        cwd=cwd,
        env={**os.environ, **environment},
        timeout=120,
    )


def ok(*arguments, **options) -> str:
    done = run(*arguments, **options)
    assert done.returncode == 0, done.stderr
    return done.stdout


def on_a_terminal(*arguments, **environment) -> str:
    """What a command shows on a terminal."""
    pty = pytest.importorskip("pty")
    ours, theirs = pty.openpty()
    env = {**os.environ, "TERM": "xterm-256color", **environment}
    process = subprocess.Popen([str(word) for word in arguments], stdout=theirs, stderr=theirs, stdin=theirs, env=env)
    os.close(theirs)
    shown = b""
    # The end of a terminal without a writer is an error on Linux and an empty read elsewhere.
    try:
        while piece := os.read(ours, 1 << 16):
            shown += piece
    except OSError:
        pass
    process.wait(timeout=60)
    os.close(ours)
    return shown.decode()


# Help, manual pages, completions


def test_every_command_has_help_with_examples_that_name_it(glidepolar, tank_reduce):
    listed = re.findall(r"^  ([a-z-]+) ", ok(glidepolar, "--help"), re.MULTILINE)
    assert [name for name in listed if name != "help"] == COMMANDS
    for command in COMMANDS:
        text = ok(glidepolar, command, "--help")
        examples = text.split("Examples:\n")[1]
        assert f"{command}" in examples, command
        # One line is what the list of commands shows.
        assert len(text.splitlines()[0]) < 110, command
    for arguments in ([], ["demo"]):
        assert "Examples:\n" in ok(tank_reduce, *arguments, "--help"), arguments


def test_exit_codes_are_documented(glidepolar, tank_reduce):
    for program in (glidepolar, tank_reduce):
        assert re.search(r"Exit code: 0 done, 1 .+, 2 the input cannot be used", " ".join(ok(program, "--help").split()))


def test_manual_pages_are_written_for_every_command(glidepolar, tank_reduce, tmp_path):
    ok(glidepolar, "man", tmp_path)
    ok(tank_reduce, "--man", tmp_path)
    names = {path.name for path in tmp_path.iterdir()}
    # Beside them stands the record of what was written.
    assert names - {".glidepolar"} == {"glidepolar.1", "tank-reduce.1", "tank-reduce-demo.1", *(f"glidepolar-{c}.1" for c in COMMANDS)}
    for path in tmp_path.glob("*.1"):
        text = path.read_text()
        assert text.startswith(".ie") and ".SH NAME" in text and ".SH SYNOPSIS" in text, path
    # A second time replaces its own pages and nothing else.
    ok(glidepolar, "man", tmp_path)
    (tmp_path / "glidepolar.1").write_text("my own page")
    assert run(glidepolar, "man", tmp_path).returncode == 1
    if shutil.which("man"):
        ok(tank_reduce, "--man", tmp_path / "again")
        assert "towing tank" in ok("man", "-l", tmp_path / "again/tank-reduce.1", MANWIDTH="200", LC_ALL="C.UTF-8")


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_completions_are_fit_for_their_shell(glidepolar, tank_reduce, tmp_path, shell):
    for program, arguments in ((glidepolar, ["completions", shell]), (tank_reduce, ["--completions", shell])):
        script = tmp_path / f"{program.stem}.{shell}"
        script.write_text(ok(program, *arguments))
        assert "--json" in script.read_text() or "json" in script.read_text()
        if shutil.which(shell):
            ok(shell, "-n", script)


@pytest.mark.skipif(shutil.which("bash") is None, reason="no bash")
def test_bash_completes_commands_and_options(glidepolar, tmp_path):
    script = tmp_path / "completions"
    script.write_text(ok(glidepolar, "completions", "bash"))
    ask = f"source {script}; COMP_WORDS=(glidepolar {{0}}); COMP_CWORD={{1}}; _glidepolar glidepolar {{2}} {{3}}; echo ${{{{COMPREPLY[@]}}}}"
    assert ok("bash", "-c", ask.format("ident", 1, "ident", "glidepolar")).split() == ["identify"]
    assert "--fixes" in ok("bash", "-c", ask.format("track --fi", 2, "--fi", "track")).split()


# Exit codes and hints


@pytest.mark.parametrize(
    "arguments, code, hint",
    [
        (["vehicles"], 0, ""),
        (["glide", "rogue", "--glide-angle-deg", "-2", "--speed-m-s", "0.3"], 1, "choose a steeper path"),
        (["glide", "slocum-gravr"], 2, "slocum-graver"),
        (["glide", "slocum-graver", "--pich-deg", "3"], 2, "--pitch-deg"),
        (["gilde", "slocum-graver"], 2, "glide"),
        (["glide", "slocum-graver", "--set", "hydro.bb=1"], 2, "hydro.b"),
        (["glide", "slocum-graver", "--set", "hydro.b=one"], 2, "KEY=NUMBER"),
        (["glide", "slocum-graver", "--set", "hydro.b=-1"], 2, "not below zero"),
        (["glide", "slocum-graver", "--density", "1"], 2, "900 to 1300"),
        (["identify", "no-such.csv", "--vehicle", "seaglider"], 2, "no-such.csv"),
        (["completions", "bsh"], 2, "bash"),
        (["export-fmu", "rogue", "-o", "x.fmu", "--fmi", "4"], 2, "possible values: 2, 3"),
    ],
)
def test_exit_code_and_hint(glidepolar, tmp_path, arguments, code, hint):
    done = run(glidepolar, *arguments, cwd=tmp_path)
    assert done.returncode == code, done.stderr
    assert hint in done.stderr
    assert "panicked" not in done.stderr
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    "arguments, hint",
    [
        (["no-such-folder"], "no-such-folder"),
        (["demo", "x", "--effect", "crosflow"], "crossflow"),
        (["demo", "x", "--hull", "LDR8"], "LDR8.5"),
        (["points.csv", "--rang-deg", "5"], "--range-deg"),
    ],
)
def test_tank_reduce_says_what_to_do(tank_reduce, tmp_path, arguments, hint):
    done = run(tank_reduce, *arguments, cwd=tmp_path)
    assert done.returncode == 2 and hint in done.stderr, done.stderr
    assert list(tmp_path.iterdir()) == []


def test_a_misspelt_column_of_a_sweep_is_named_with_the_nearest(glidepolar, tmp_path):
    table = tmp_path / "variants.csv"
    for text, expected in (
        ("b,hull_mas_kg\n0.1,40\n", "variants.csv:1:2: unknown parameter `hull_mas_kg`"),
        ("b\n0.1\nx\n", "variants.csv:3:1: `b` cannot be x"),
        ("b\n-4\n", "from 0 to 100"),
        ("b,b\n1,1\n", "stands twice"),
        ("b\n", "no variants"),
        ("b,CL0\n1\n", "variants.csv:2"),
    ):
        table.write_text(text)
        done = run(glidepolar, "simulate", "slocum-graver", "--sweep", table)
        assert done.returncode == 2 and expected in done.stderr, done.stderr


def test_a_changed_value_does_what_a_changed_file_does(glidepolar, tmp_path):
    text = ok(glidepolar, "vehicles", "slocum-graver")
    number = re.search(r"(?m)^(b\s*=\s*)([0-9.e-]+)", text)
    file = tmp_path / "rougher.toml"
    file.write_text(text.replace(number[0], f"{number[1]}0.2", 1))
    changed = json.loads(ok(glidepolar, "glide", "slocum-graver", "--set", "hydro.b=0.2", "--json", "-"))
    assert changed == json.loads(ok(glidepolar, "glide", file, "--json", "-"))
    assert changed != json.loads(ok(glidepolar, "glide", "slocum-graver", "--json", "-"))


def test_a_sweep_is_the_single_flights(glidepolar, tmp_path):
    """A variant that equals the vehicle ends where a plain run of it does; the others do not."""
    (tmp_path / "variants.csv").write_text("b,hull_mass_kg\n0.11751199237210526,40\n0.2,40\n0.11751199237210526,40.01\n")
    common = ["simulate", "slocum-graver", "--stop", "600", "--interval", "100", "--quiet"]
    ok(glidepolar, *common, "--sweep", "variants.csv", "--csv", "sweep.csv", cwd=tmp_path)
    ok(glidepolar, *common, "--csv", "one.csv", cwd=tmp_path)
    header, *rows = [line.split(",") for line in (tmp_path / "sweep.csv").read_text().splitlines()]
    single = (tmp_path / "one.csv").read_text().splitlines()
    assert header[2:] == single[0].split(",")
    ends = [[float(cell) for cell in row[2:]] for row in rows]
    assert ends[0] == [float(cell) for cell in single[-1].split(",")]
    depth = header.index("depth_m") - 2
    assert len({row[depth] for row in ends}) == 3


def test_an_interrupted_sweep_goes_on_where_it_stopped(glidepolar, tmp_path):
    variants = "b\n" + "".join(f"{0.1 + 1e-5 * i}\n" for i in range(2000))
    (tmp_path / "variants.csv").write_text(variants)
    sweep = ["simulate", "slocum-graver", "--stop", "2000", "--sweep", "variants.csv", "--quiet"]
    ok(glidepolar, *sweep, "--csv", "whole.csv", cwd=tmp_path)
    whole = (tmp_path / "whole.csv").read_text()
    kept = tmp_path / "ends.csv.unfinished"
    with subprocess.Popen(
        [glidepolar, *sweep, "--csv", "ends.csv"], cwd=tmp_path, preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL)
    ) as process:
        while process.poll() is None and not (kept.is_file() and kept.read_text().count("\n") > 1):
            time.sleep(0.002)
        process.send_signal(signal.SIGINT)
    assert process.returncode == -signal.SIGINT and not (tmp_path / "ends.csv").exists()
    # A signal can end a write between two pages: what follows the last end of line is a row that was cut off.
    left = kept.read_text()
    mark, *rows = left[: left.rindex("\n")].split("\n")
    assert 0 < len(rows) < 2000 and rows == whole.splitlines()[1 : 1 + len(rows)], "finished rows stand on the disk"

    done = run(glidepolar, *sweep, "--tolerance", "1e-5", "--csv", "ends.csv", "--resume", cwd=tmp_path)
    assert done.returncode == 2 and "another sweep left" in done.stderr, done.stderr
    # A mark in a finished row shows that it is taken as it is; a row that was cut off is flown again.
    marked = rows[0] + "00"
    kept.write_text("\n".join([mark, marked, *rows[1:]]) + "\n0.1,4")
    ok(glidepolar, *sweep, "--csv", "ends.csv", "--resume", cwd=tmp_path)
    assert (tmp_path / "ends.csv").read_text() == whole.replace(rows[0] + "\n", marked + "\n", 1)
    assert not kept.exists()


def test_long_work_shows_on_a_terminal_how_far_it_is(glidepolar, tmp_path):
    (tmp_path / "variants.csv").write_text("b\n" + "0.2\n" * 3000)
    sweep = [glidepolar, "simulate", "slocum-graver", "--stop", "3000", "--sweep", tmp_path / "variants.csv"]
    shown = on_a_terminal(*sweep)
    counts = [int(count) for count in re.findall(r"(\d+)/3000 variants", shown)]
    # It is drawn a few times a second, so that the last rows may end between two drawings.
    assert counts and counts[0] < 3000 and 2700 < max(counts) <= 3000, shown[-500:]
    done = run(*sweep)
    assert "/3000" not in done.stderr + done.stdout


# Colour, silence, JSON


def test_colour_only_on_a_terminal_that_wants_it(glidepolar):
    wrong = [glidepolar, "glide", "slocum-gravr"]
    without = {name: "" for name in ("NO_COLOR", "CLICOLOR_FORCE")}
    assert "\x1b[" in on_a_terminal(*wrong, **without)
    assert "\x1b[" not in on_a_terminal(*wrong, NO_COLOR="1")
    assert "\x1b[" not in run(*wrong).stderr
    # Of messages that the parser of arguments writes, too.
    assert "\x1b[" in on_a_terminal(glidepolar, "gilde", **without)
    assert "\x1b[" not in on_a_terminal(glidepolar, "gilde", NO_COLOR="1")


def test_quiet_prints_nothing(glidepolar, tank_reduce, tmp_path):
    for arguments in (
        ["glide", "slocum-graver"],
        ["simulate", "slocum-graver", "--stop", "10"],
        ["plan", "seaglider", "--battery-Wh", "2700", "--depth-m", "1000"],
        ["simulate", "slocum-049", "--mission", ROOT / "missions/rising-seabed.toml", "--stop", "4000", "--log", "log.csv"],
        ["track", "log.csv", "--vehicle", "slocum-049", "--column", "heading_rad=pitch_rad"],
    ):
        done = run(glidepolar, *arguments, "--quiet", cwd=tmp_path)
        # What a reader of the figures has to know goes to standard error even then.
        others = [line for line in done.stderr.splitlines() if not line.startswith("warning: ")]
        assert (done.returncode, done.stdout, others) == (0, "", []), arguments
    points = [ROOT / "tank/data/suboff_roddy1990.csv", "--hull", ROOT / "tank/data/suboff.toml"]
    done = run(tank_reduce, "demo", "runs", "--hull", "LDR8.5", "--quiet", cwd=tmp_path)
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
    # What a reader of the figures has to know is said even then.
    done = run(tank_reduce, *points, "--quiet", cwd=tmp_path)
    assert (done.returncode, done.stdout) == (0, "")
    assert done.stderr and all(line.startswith("warning: ") for line in done.stderr.splitlines())


def test_json_is_alone_on_standard_output(glidepolar, tank_reduce, tmp_path):
    said = {}
    for name, arguments in {
        "glide": [glidepolar, "glide", "slocum-graver"],
        "simulate": [glidepolar, "simulate", "slocum-graver", "--stop", "10"],
        "plan": [glidepolar, "plan", "seaglider", "--battery-Wh", "2700", "--depth-m", "1000"],
        "tank": [tank_reduce, ROOT / "tank/data/suboff_roddy1990.csv", "--hull", ROOT / "tank/data/suboff.toml"],
    }.items():
        said[name] = json.loads(ok(*arguments, "--json", "-", cwd=tmp_path))
    assert said["tank"]["schema"] == "tank-reduce/1"
    assert {name: value["schema"] for name, value in said.items() if name != "tank"} == {
        name: f"glidepolar.{name}/1" for name in ("glide", "simulate", "plan")
    }


def test_a_reader_that_has_seen_enough_ends_the_command_quietly(glidepolar):
    process = subprocess.Popen([glidepolar, "vehicles", "--keys"], stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    process.stdout.close()
    assert process.stderr.read() == b""
    process.wait(timeout=60)


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no /dev/full on this system")
def test_an_output_that_takes_no_more_ends_the_command_with_a_message(glidepolar, tmp_path):
    for arguments in (["vehicles", "--keys"], ["glide", "slocum-graver"]):
        with open("/dev/full", "w", encoding="utf-8") as full:
            done = subprocess.run([glidepolar, *arguments], stdout=full, stderr=subprocess.PIPE, text=True, cwd=tmp_path)
        assert done.returncode == 1 and "standard output cannot be written" in done.stderr, done.stderr


# Text from files


# Sets a terminal's title, and a page's script; what of it may be seen is text.
EVIL = "\x1b]0;owned\x07\x9b31m\u202e<script>alert(1)</script>"


def assert_harmless(done):
    assert "panicked" not in done.stderr
    for stream in (done.stdout, done.stderr):
        # The program's own colours, which no text above has.
        stream = re.sub(r"\x1b\[[0-9;]*m", "", stream)
        for character in ("\x1b", "\x07", "\x9b", "\u202e"):
            assert character not in stream, repr(stream)


def test_text_from_files_cannot_act_on_a_terminal_or_a_page(glidepolar, tank_reduce, tmp_path):
    toml = "".join(f"\\u{ord(c):04x}" if not c.isprintable() or ord(c) > 126 else c for c in EVIL)
    vehicle = re.sub(r'(?m)^name = ".*"', lambda _: f'name = "{toml}"', ok(glidepolar, "vehicles", "seaglider"))
    assert toml in vehicle
    (tmp_path / "evil.toml").write_text(vehicle)
    mission = (ROOT / "missions/rising-seabed.toml").read_text(encoding="utf-8")
    (tmp_path / "mission.toml").write_text(re.sub(r'(?m)^name = ".*"', lambda _: f'name = "{toml}"', mission))
    evil_file = tmp_path / f"evil{EVIL.replace('/', '')}.csv"
    evil_file.write_text(f"time_s,{EVIL},pressure_dbar,pitch_rad,vbd_cc\n0,1,x{EVIL},0,0\n1,2,3,{EVIL},0\n")
    force = {"CLICOLOR_FORCE": "1", "NO_COLOR": ""}

    pages = []
    for name, arguments in {
        "glide": ["glide", "evil.toml", "--out", "glide"],
        "plan": ["plan", "evil.toml", "--battery-Wh", "2700", "--depth-m", "1000", "--out", "plan"],
        "mission": ["simulate", "slocum-049", "--mission", "mission.toml", "--stop", "2000", "--out", "mission"],
        "history": ["simulate", "evil.toml", "--set", "hydro.b=0.1", "--stop", "10", "--out", "history"],
    }.items():
        done = run(glidepolar, *arguments, cwd=tmp_path, **force)
        assert_harmless(done)
        if done.returncode == 0:
            pages.append((tmp_path / name / "report.html").read_text(encoding="utf-8"))
            assert "alert(1)" in pages[-1], name
    assert len(pages) >= 3
    for page in pages:
        assert "<script>alert" not in page
        # The page's own: the values of its figures and sliders, and what draws them under the mouse.
        own = re.findall(r"<script(?: type=\"application/json\" id=\"(?:figures|explorers)\")?>", page)
        assert page.count("<script") == len(own) <= 5
        for values in re.findall(r'<script type="application/json" id="\w+">(.*?)</script>', page, re.DOTALL):
            assert "<" not in values
        assert not set("\x1b\x07\x9b\u202e") & set(page)

    for arguments in (
        ["identify", evil_file, "--vehicle", "seaglider"],
        ["diagnose", evil_file, "--vehicle", "seaglider"],
        ["track", evil_file, "--vehicle", "seaglider"],
        ["simulate", "slocum-graver", "--inputs", evil_file],
        ["simulate", "slocum-graver", "--sweep", evil_file],
        ["glide", EVIL],
        ["glide", "slocum-graver", "--set", EVIL],
        ["plan", "seaglider", "--moves", evil_file, "--dives", evil_file],
    ):
        done = run(glidepolar, *arguments, cwd=tmp_path, **force)
        assert done.returncode == 2, arguments
        assert_harmless(done)

    ok(tank_reduce, "demo", "runs", "--hull", "LDR8.5", "--quiet", cwd=tmp_path)
    manifest = tmp_path / "runs/campaign.toml"
    manifest.write_text(manifest.read_text().replace('"LDR8.5"', f'"{toml}"'))
    table = tmp_path / "runs/runs.csv"
    table.write_text(table.read_text().replace("LDR8.5", EVIL))
    done = run(tank_reduce, "runs", cwd=tmp_path, **force)
    assert_harmless(done)
    if done.returncode == 0:
        page = (tmp_path / "tank_out/report.html").read_text(encoding="utf-8")
        assert "<script" not in page and not set("\x1b\x07\x9b\u202e") & set(page)


# Killed


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="no SIGKILL on this system")
def test_a_killed_command_leaves_no_half_written_file(glidepolar, tank_reduce, tmp_path):
    """Killed at some moment of its run, a command leaves each of its files whole or not at all."""
    mission = ["simulate", "slocum-049", "--mission", ROOT / "missions/rising-seabed.toml", "--out", "voyage", "--stop", "5000"]
    mission += ["--csv", "history.csv", "--log", "log.csv", "--json", "voyage.json", "--quiet"]
    points = [ROOT / "tank/data/suboff_roddy1990.csv", "--hull", ROOT / "tank/data/suboff.toml", "--quiet"]
    seed = random.randrange(1 << 32)
    moments = random.Random(seed)
    print(f"seed {seed}")
    for program, arguments in ((glidepolar, mission), (tank_reduce, points)):
        folder = tmp_path / program.stem
        folder.mkdir()
        begin = time.perf_counter()
        ok(program, *arguments, cwd=folder)
        duration = time.perf_counter() - begin
        whole = contents(folder)
        assert len(whole) > 8
        killed = 0
        for _ in range(12):
            shutil.rmtree(folder)
            folder.mkdir()
            process = subprocess.Popen([str(word) for word in (program, *arguments)], cwd=folder)
            time.sleep(moments.uniform(0, duration))
            process.kill()
            killed += process.wait() == -signal.SIGKILL
            left = contents(folder)
            for name, content in left.items():
                assert content == whole[name], f"{name} is half written"
            # The next run is not troubled by what the killed one left.
            if 0 < len(left) < len(whole):
                ok(program, *arguments, cwd=folder)
                assert contents(folder) == whole
        assert killed > 0, "no run was killed: the test has seen nothing"


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="no SIGKILL on this system")
def test_a_file_of_a_killed_command_may_be_replaced(glidepolar, tmp_path):
    """Killed as soon as a file stands in its place, a command has it among those that the next run may replace."""
    mission = ROOT / "missions/rising-seabed.toml"
    words = ["simulate", "slocum-049", "--mission", mission, "--stop", "5000", "--csv", "history.csv", "--quiet"]
    for _ in range(20):
        process = subprocess.Popen([str(word) for word in (glidepolar, *words)], cwd=tmp_path)
        while process.poll() is None and not (tmp_path / "history.csv").exists():
            pass
        process.kill()
        process.wait()
        ok(glidepolar, *words, cwd=tmp_path)
        (tmp_path / "history.csv").unlink()
        (tmp_path / ".glidepolar").unlink()


def test_thirty_rows_of_a_log_are_no_result(glidepolar, tmp_path):
    """Part of one leg has a solution with a condition number of 1e7, which is no polar."""
    mission = ROOT / "missions/rising-seabed.toml"
    ok(glidepolar, "simulate", "slocum-049", "--mission", mission, "--log", "flight.csv", "--quiet", cwd=tmp_path)
    rows = (tmp_path / "flight.csv").read_text().splitlines(keepends=True)
    (tmp_path / "short.csv").write_text("".join(rows[:31]))
    done = run(glidepolar, "identify", "short.csv", "--vehicle", "slocum-049", cwd=tmp_path)
    assert done.returncode == 1, done.stderr
    assert "at least 2 are needed" in done.stderr and "condition number" in done.stderr
    # What is short is the steady glide: no channel is asked for that is there.
    done = run(glidepolar, "diagnose", "short.csv", "--vehicle", "slocum-049", cwd=tmp_path)
    assert done.returncode == 1, done.stderr
    assert "too little steady glide" in done.stderr and "no channel" not in done.stderr, done.stderr


def contents(folder: Path) -> dict[str, bytes]:
    """The files that a user sees: partial files and the list of what was written begin with a dot."""
    files = (path for path in folder.rglob("*") if path.is_file() and not path.name.startswith("."))
    return {str(path.relative_to(folder)): path.read_bytes() for path in files}
