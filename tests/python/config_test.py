# Configs as objects: values, changes, effects by name, and errors that say where.
import os
import pathlib
import pickle
import re
import subprocess
import sys

import numpy
import pytest

import pneuservo
from conftest import CYLINDER, SOURCE


def test_values_are_those_of_the_file(config):
    assert config["line_1.length_m"] == 10.0
    assert config["line_1"]["diameter_m"] == 0.00765
    assert config["controller.pressure_source"] == "estimated"
    assert config.kind == "cylinder" and config.valves == 1
    assert config.parameters()["line_1.length_m"]["unit"] == "m"


def test_a_change_makes_a_new_config(config):
    changed = config.replace({"line_1.length_m": 7.5, "controller.pressure_source": "valve"})
    assert (changed["line_1.length_m"], changed["controller.pressure_source"]) == (7.5, "valve")
    assert config["line_1.length_m"] == 10.0
    assert pneuservo.Config(CYLINDER, ["line_1.length_m=7.5"])["line_1.length_m"] == 7.5


def test_effects_are_switched_on_by_name(config):
    leaking = config.with_effects({"chamber_leak_1": {"area_m2": 2e-8}})
    assert leaking["effects.chamber_leak_1.area_m2"] == 2e-8
    assert config["effects.chamber_leak_1.area_m2"] == 0.0
    assert "chamber_leak_1" in config.effect_names()
    with pytest.raises(pneuservo.InputError, match="chamber_leek.*chamber_leak"):
        config.with_effects({"chamber_leek": {"area_m2": 2e-8}})


def test_a_config_reads_back_to_the_same(config):
    text = config.to_yaml()
    assert pneuservo.Config.from_text(text, "again").to_yaml() == text
    assert pickle.loads(pickle.dumps(config)).to_yaml() == text


def test_errors_carry_file_line_and_key(tmp_path):
    text = CYLINDER.read_text()
    lines = text.splitlines()
    at = next(i for i, line in enumerate(lines) if line.startswith("period_s:"))
    lines[at] = "period_s: -1"
    file = tmp_path / "wrong.yaml"
    file.write_text("\n".join(lines) + "\nunheard_of: 1\n")
    with pytest.raises(pneuservo.InputError) as caught:
        pneuservo.Config(file)
    assert isinstance(caught.value, ValueError)
    assert len(caught.value.sentences) == 2
    places = caught.value.places
    assert (places[0].file, places[0].line, places[0].key) == (str(file), at + 1, "period_s")
    assert places[1].key == "unheard_of"
    assert "found -1, expected" in caught.value.sentences[0]


def test_an_unknown_path_is_a_key_error(config):
    with pytest.raises(KeyError, match="line_1.lenght_m"):
        config["line_1.lenght_m"]


@pytest.mark.parametrize("changes, words", [
    ([5], "changes: found int, expected PATH=VALUE as text"),
    (5, "changes: found int, expected a dict or a list"),
    ("seed=1", "changes: found str, expected a dict or a list"),
    ({1: 2}, "changes: found int, expected a config path as text"),
])
def test_changes_of_the_wrong_kind_are_named(changes, words):
    with pytest.raises(TypeError, match=words):
        pneuservo.Config(CYLINDER, changes)


def test_numbers_of_numpy_are_numbers(config):
    leaking = config.with_effects({"chamber_leak_1": {"area_m2": numpy.float32(2e-8)}})
    assert leaking["effects.chamber_leak_1.area_m2"] == pytest.approx(2e-8)
    assert config.replace({"line_1.length_m": numpy.float32(5)})["line_1.length_m"] == 5.0
    with pytest.raises(TypeError, match="found set, expected numbers, words, lists or dicts"):
        config.with_effects({"chamber_leak_1": {"area_m2": {1, 2}}})


def test_the_stub_says_what_calls_take_and_give():
    stub = (pathlib.Path(pneuservo.__file__).parent / "_core.pyi").read_text()
    for line in ("def __getitem__(self, path: str) -> Any", "def __getitem__(self, column: str) -> NDArray[numpy.float64]",
                 "def values(self) -> NDArray[numpy.float64]", "def covariance(self) -> NDArray[numpy.float64]",
                 "def run(self, u_V: NDArray[numpy.float64] | float, u2_V", "p_supply_Pa: float = float('nan')) -> Any",
                 "def header(self) -> dict[str, Any]"):
        assert line in stub, line


def test_the_code_of_the_page_passes_mypy(tmp_path):
    pytest.importorskip("mypy")
    page = (SOURCE / "docs/python.md").read_text()
    (tmp_path / "page.py").write_text("\n".join(re.findall(r"```py\n(.*?)```", page, re.S)))
    folder = pathlib.Path(pneuservo.__file__).parent.parent
    done = subprocess.run([sys.executable, "-m", "mypy", "--strict", "page.py"], cwd=tmp_path, capture_output=True, text=True,
                          env={**os.environ, "MYPYPATH": str(folder)})
    assert not [line for line in done.stdout.splitlines() if line.startswith("page.py")], done.stdout + done.stderr
