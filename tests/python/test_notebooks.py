"""The notebooks in examples/notebooks run as they are, in an environment with the wheel, each below a minute."""

import os
import subprocess
import time
from pathlib import Path

import pytest

NOTEBOOKS = sorted((Path(__file__).parents[2] / "examples/notebooks").glob("*.ipynb"))

RUN = """if True:
    import sys, nbformat
    from nbclient import NotebookClient
    notebook = nbformat.read(sys.argv[1], as_version=4)
    NotebookClient(notebook, timeout=200, resources={"metadata": {"path": "."}}).execute()
    print(sum(cell.cell_type == "code" and bool(cell.outputs) for cell in notebook.cells))
"""


@pytest.mark.parametrize("notebook", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_runs(programs, tmp_path, notebook):
    env = {name: value for name, value in os.environ.items() if not name.startswith("GLIDEPOLAR_")}
    # The kernel is this environment's, whatever else is installed for the user.
    env |= {"JUPYTER_PATH": "", "JUPYTER_DATA_DIR": str(tmp_path / "jupyter"), "IPYTHONDIR": str(tmp_path / "ipython")}
    begin = time.process_time(), os.times().children_user
    done = subprocess.run([programs / "python", "-c", RUN, notebook], cwd=tmp_path, capture_output=True, text=True, env=env)
    assert done.returncode == 0, done.stderr[-3000:]
    assert int(done.stdout) >= 3, "cells show results"
    assert os.times().children_user - begin[1] < 30, "seconds of work in a build for tests"


def test_there_is_one_for_each_kind_of_user():
    assert [notebook.stem for notebook in NOTEBOOKS] == ["modeller", "pilot", "tank-engineer"]
    # Kept without results, so that a change of one shows what was changed.
    assert all('"outputs": []' in notebook.read_text() and '"output_type"' not in notebook.read_text() for notebook in NOTEBOOKS)
