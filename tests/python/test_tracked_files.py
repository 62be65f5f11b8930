"""What the repository carries: sources, pages and figures, each small enough to review; no dump of a program, no built file."""

import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
# Fonts of the reports, icons of the FMU and one damaged log among the fuzz regressions are the only files that are not text.
BINARY_ENDINGS = {".ttf", ".png", ".nc"}
# Twice the largest file there is, the log of the pilots' page.
MOST_BYTES = 500_000


@pytest.mark.skipif(not (ROOT / ".git").exists(), reason="a source archive has no list of tracked files")
def test_every_tracked_file_is_a_small_text_or_a_known_binary():
    listed = subprocess.run(["git", "-c", "safe.directory=*", "ls-files", "-z"], cwd=ROOT, capture_output=True, check=True).stdout
    names = [name.decode() for name in listed.split(b"\0") if name]
    assert "Cargo.toml" in names
    wrong = []
    for name in names:
        content = (ROOT / name).read_bytes()
        if len(content) > MOST_BYTES:
            wrong.append(f"{name}: {len(content)} bytes, more than {MOST_BYTES}")
        if b"\0" in content and Path(name).suffix not in BINARY_ENDINGS:
            wrong.append(f"{name}: not a text")
    assert not wrong, "\n".join(wrong)
