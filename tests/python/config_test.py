# Configs as objects: values, changes, effects by name, and errors that say where.
import pickle

import pytest

import pneuservo
from conftest import CYLINDER


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
