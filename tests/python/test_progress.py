"""How far a reading is, on a terminal and nowhere else."""

import os
import subprocess
import sys

import log_files
import pytest
from conftest import together
from log_files import Dive

pytestmark = together("progress")


@pytest.fixture(scope="module")
def long_log(tmp_path_factory):
    """A table that takes some seconds to read and little to fit: between forty dives the glider lies at the surface for a day."""
    path = tmp_path_factory.mktemp("long") / "log.csv"
    dive = Dive(rows=400)
    names = ["time_s", "pressure_dbar", "pitch_deg", "vbd_cc", "temperature_C", "salinity_psu", "heading_deg"]
    lines = [",".join(f"{dive[name][row]:.4f}" for name in names[1:]) for row in range(dive.rows)]
    lines += [lines[-1]] * 19_600
    with open(path, "w", encoding="utf-8") as file:
        file.write(",".join(names) + "\n")
        for i in range(40):
            start = log_files.START_S + (5 * len(lines) + 100) * i
            file.write("".join(f"{start + 5 * row:.1f},{line}\n" for row, line in enumerate(lines)))
    return path


@pytest.mark.skipif(sys.platform == "win32", reason="pseudo-terminals are of Unix")
def test_on_a_terminal_the_rows_are_counted_and_the_line_is_taken_away(glidepolar, long_log):
    import pty

    main, side = pty.openpty()
    arguments = [glidepolar, "identify", str(long_log), "--vehicle", "seaglider", "--quiet"]
    running = subprocess.Popen(arguments, stdout=subprocess.DEVNULL, stderr=side, env={**os.environ, "TERM": "xterm"})
    os.close(side)
    shown = b""
    while True:
        try:
            part = os.read(main, 4096)
        except OSError:
            break
        if not part:
            break
        shown += part
    os.close(main)
    running.wait()
    text = shown.decode(errors="replace")
    assert "reading" in text and "rows" in text, text[-500:]
    # The last of it is taken away before the answer.
    assert "\x1b[2K" in text[text.rindex("rows") :], text[-500:]


def test_elsewhere_nothing_is_drawn(glidepolar, long_log):
    done = subprocess.run(
        [glidepolar, "identify", str(long_log), "--vehicle", "seaglider", "--quiet"],
        capture_output=True,
        text=True,
        check=False,
    )
    assert "reading" not in done.stdout + done.stderr
