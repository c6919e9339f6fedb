# The notebooks run, cell after cell, and hold no stored outputs.
import json

import pytest

from conftest import SOURCE

NOTEBOOKS = sorted((SOURCE / "python/notebooks").glob("*.ipynb"))


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_runs(path, monkeypatch):
    monkeypatch.chdir(SOURCE)
    names = {}
    for cell in json.loads(path.read_text(encoding="utf-8"))["cells"]:
        if cell["cell_type"] != "code":
            continue
        assert cell["outputs"] == [] and cell["execution_count"] is None
        exec(compile("".join(cell["source"]), path.name, "exec"), names)


def test_there_are_three():
    assert len(NOTEBOOKS) == 3
