# FMUs of plant and estimator: a valid description, and what the program computes, bit for bit, through FMPy.
import math
import os
import pathlib
import subprocess
import sys
import zipfile
from xml.etree import ElementTree

import fmpy
import pytest
from fmpy.validation import validate_fmu

import pneuservo
import pneuservo.export
from pneuservo import fmu

CONFIG = "config/cylinder-10m-7.65mm.yaml"
TABLE = "config/servo-table-2m-4mm.yaml"
OTHERS = {"line_1.length_m": 4.0, "effects.coulomb_friction.force_N": 12.0}  # set through the FMU, not in its config


@pytest.fixture(scope="module")
def config():
    return pneuservo.Config(CONFIG)


@pytest.fixture(scope="module")
def folder(tmp_path_factory, config):
    path = tmp_path_factory.mktemp("fmu")
    for model in ("plant", "estimator"):
        for fmi in (2, 3):
            fmu.write(config, path / f"{model}{fmi}.fmu", model, fmi)
    return path


class Slave:
    """An FMU at work, by the names of its variables."""

    def __init__(self, path, start=()):
        description = fmpy.read_model_description(path, validate=True)
        self.references = {v.name: v.valueReference for v in description.modelVariables}
        self.names = {c: [v.name for v in description.modelVariables if v.causality == c] for c in ("input", "output")}
        self.messages = []
        kind = fmpy.fmi2.FMU2Slave if description.fmiVersion.startswith("2") else fmpy.fmi3.FMU3Slave
        self.fmu = kind(guid=getattr(description, "guid", None) or description.instantiationToken,
                        unzipDirectory=fmpy.extract(path), modelIdentifier=description.coSimulation.modelIdentifier,
                        instanceName="axis")
        self.fmu.instantiate()
        two = description.fmiVersion.startswith("2")
        self._get = self.fmu.getReal if two else self.fmu.getFloat64
        self.outputs = [self.references[name] for name in self.names["output"]]
        self.instantiated = self.get()
        if two:
            self.fmu.setupExperiment(startTime=0.0)
            self.fmu.enterInitializationMode()
        else:
            self.fmu.enterInitializationMode(startTime=0.0)
        self.set(dict(start))
        self.initial = self.get()
        self.fmu.exitInitializationMode()

    def set(self, values):
        put = self.fmu.setReal if hasattr(self.fmu, "setReal") else self.fmu.setFloat64
        if values:
            put([self.references[name] for name in values], list(values.values()))

    def step(self, values, t_s, step_s):
        self.set(values)
        self.fmu.doStep(t_s, step_s)
        return self.get()

    def get(self):
        return dict(zip(self.names["output"], self._get(self.outputs)))

    def end(self):
        self.fmu.terminate()
        self.fmu.freeInstance()


def test_descriptions_are_valid(folder):
    for path in sorted(folder.glob("*.fmu")):
        assert validate_fmu(str(path)) == [], path.name


@pytest.mark.parametrize("fmi", (2, 3))
def test_closed_loop_is_that_of_the_program(folder, config, fmi):
    """Plant and estimator as FMUs around the program's law against the same objects of the package, bit for bit."""
    plant, estimator = Slave(folder / f"plant{fmi}.fmu"), Slave(folder / f"estimator{fmi}.fmu")
    own_plant, own_estimator = pneuservo.Plant(config), pneuservo.Estimator(config)
    laws = pneuservo.Law(config), pneuservo.Law(config)
    own, own_u_V, u_V = own_plant.now, 0.0, 0.0
    seen = plant.get()
    moved = 0.0
    for k in range(1500):
        own_e = own_estimator.step(own.p1_port_Pa, own.p2_port_Pa, own.x_m, laws[0].v_mps, own_u_V)
        own_u_V = laws[0].step(own.x_m, own_e.p1_estimated_Pa, own_e.p2_estimated_Pa, own.p1_port_Pa, own.p2_port_Pa)
        own = own_plant.step(own_u_V)
        e = estimator.step({"p1_port_Pa": seen["p1_port_Pa"], "p2_port_Pa": seen["p2_port_Pa"], "x_m": seen["x_m"],
                            "v_mps": laws[1].v_mps, "u_V": u_V}, k * 1e-3, 1e-3)
        u_V = laws[1].step(seen["x_m"], e["p1_estimated_Pa"], e["p2_estimated_Pa"], seen["p1_port_Pa"], seen["p2_port_Pa"])
        seen = plant.step({"u_V": u_V}, k * 1e-3, 1e-3)
        assert u_V == own_u_V, k
        for shown, expected in ((seen, own), (e, own_e)):  # every output, each under its own name
            for name in set(shown) - {"inner_step_s", "health"}:
                assert shown[name] == getattr(expected, name), (k, name)
        assert (seen["health"], e["health"]) == (0.0, own_e.health), k
        assert 0.0 < e["inner_step_s"] <= 1e-3
        moved = max(moved, abs(seen["x_m"]))
    assert moved > 0.01
    assert e["mass_flow_1_kgps"] != 0.0
    assert 0.0 < seen["inner_step_s"] <= 1e-3
    plant.end(), estimator.end()


@pytest.mark.parametrize("fmi", (2, 3))
def test_parameters_are_the_configs_numbers(folder, config, fmi):
    slave = Slave(folder / f"plant{fmi}.fmu", OTHERS)
    changed = pneuservo.Plant(config.replace(OTHERS))
    for k in range(40):  # communication steps of several periods
        u_V = 2.0 * math.sin(0.3 * k)
        for _ in range(10):
            own = changed.step(u_V)
        seen = slave.step({"u_V": u_V}, k * 1e-2, 1e-2)
        assert (seen["x_m"], seen["p2_port_Pa"]) == (own.x_m, own.p2_port_Pa)
    slave.end()


@pytest.mark.parametrize("fmi", (2, 3))
def test_a_state_comes_back(folder, fmi):
    slave = Slave(folder / f"plant{fmi}.fmu")
    get, put, free = ((slave.fmu.getFMUstate, slave.fmu.setFMUstate, slave.fmu.freeFMUstate) if fmi == 2 else
                      (slave.fmu.getFMUState, slave.fmu.setFMUState, slave.fmu.freeFMUState))
    slave.step({"u_V": 2.0}, 0.0, 0.1)
    state = get()
    first = slave.step({"u_V": -1.0}, 0.1, 0.1)
    put(state)
    assert slave.step({"u_V": -1.0}, 0.1, 0.1) == first
    free(state)
    slave.end()


@pytest.mark.parametrize("fmi", (2, 3))
def test_a_clock_that_adds_up_its_steps(folder, config, fmi):
    """What such a clock rounds by in two days, a quarter of a period, in 200 steps here: no step is refused or lost."""
    slave, own = Slave(folder / f"plant{fmi}.fmu"), pneuservo.Plant(config)
    time_s = 0.0
    for k in range(200):
        assert slave.step({"u_V": 1.0}, time_s, 1e-3)["x_m"] == own.step(1.0).x_m, k
        time_s += 1e-3 + 2e-6
    assert abs(time_s - 0.2) > 0.25e-3
    with pytest.raises(Exception):  # a period left out, and one done twice
        slave.fmu.doStep(time_s + 1e-3, 1e-3)
    with pytest.raises(Exception):
        slave.fmu.doStep(time_s - 1e-3, 1e-3)
    slave.end()


@pytest.mark.parametrize("fmi", (2, 3))
def test_outputs_before_the_first_step_are_those_of_the_start(folder, config, fmi):
    """With the parameters and inputs of that moment: once instantiated, in the initialisation, after it."""
    start = {"initial.position_m": 0.05, "initial.pressure_1_Pa": 3e5}
    slave = Slave(folder / f"plant{fmi}.fmu", start)
    for seen, own in ((slave.instantiated, pneuservo.Plant(config).now), (slave.initial, pneuservo.Plant(config.replace(start)).now)):
        assert all(seen[name] == getattr(own, name) for name in ("x_m", "v_mps", "p1_port_Pa", "p1_chamber_Pa", "p_supply_Pa"))
        assert (seen["inner_step_s"], seen["health"]) == (0.0, 0.0)
    assert slave.initial["x_m"] == 0.05 and slave.initial != slave.instantiated
    assert slave.get() == slave.initial
    slave.end()
    # Of the estimator: what its first step says, at rest at the pressures of its inputs, with the bound of its start.
    inputs = {"p1_port_Pa": 4e5, "p2_port_Pa": 5e5, "x_m": 0.02, "v_mps": 0.0, "u_V": 0.0}
    slave = Slave(folder / f"estimator{fmi}.fmu", inputs)
    own = pneuservo.Estimator(config).step(*inputs.values())
    for seen in (slave.initial, slave.get(), slave.step({}, 0.0, 1e-3)):
        assert (seen["p1_estimated_Pa"], seen["p2_estimated_Pa"]) == (4e5, 5e5) == (own.p1_estimated_Pa, own.p2_estimated_Pa)
        assert (seen["p1_bound_Pa"], seen["health"]) == (own.p1_bound_Pa, own.health) and seen["p1_bound_Pa"] > 100.0
        assert (seen["mass_flow_1_kgps"], seen["mass_flow_2_kgps"]) == (0.0, 0.0)
    assert slave.instantiated["p1_estimated_Pa"] > 0.0
    slave.end()


def test_two_valves():
    config = pneuservo.Config(TABLE)
    names = [v["name"] for v in pneuservo._core._fmu_variables(config, "plant") if v["causality"] == "input"]
    assert names == ["u1_V", "u2_V"]


def test_what_is_refused(folder, config, tmp_path):
    slave = Slave(folder / "plant2.fmu")
    for call in (lambda: slave.fmu.doStep(0.0, 0.37e-3), lambda: slave.set({"line_1.length_m": 3.0}),
                 lambda: slave.set({"x_m": 0.0}), lambda: slave.fmu.getReal([77])):
        with pytest.raises(Exception):
            call()
    assert slave.step({"u_V": 0.0}, 0.0, 1e-3)["health"] == 0.0  # goes on after each
    slave.end()
    with pytest.raises(Exception):
        Slave(folder / "plant2.fmu", {"line_1.length_m": -1.0})
    with pytest.raises(pneuservo.InputError, match="expected plant or estimator"):
        fmu.write(config, tmp_path / "a.fmu", "valve")
    with pytest.raises(pneuservo.InputError, match="expected 2 or 3"):
        fmu.write(config, tmp_path / "a.fmu", fmi=1)
    with pytest.raises(pneuservo.InputError, match="only cylinders and servo tables have an FMU"):
        fmu.write(pneuservo.Config("config/machines/tank-discharge.yaml"), tmp_path / "a.fmu")
    assert not (tmp_path / "a.fmu").exists()
    fmu.write(config, tmp_path / "a.fmu")
    with pytest.raises(pneuservo.InputError, match="found a file there.*--force"):
        fmu.write(config, tmp_path / "a.fmu", "estimator")
    fmu.write(config, tmp_path / "a.fmu", "estimator", replace=True)
    assert "estimator" in fmpy.read_model_description(tmp_path / "a.fmu").modelName
    # Description and resources of two exports do not go together.
    other = tmp_path / "mixed.fmu"
    with zipfile.ZipFile(folder / "plant2.fmu") as source, zipfile.ZipFile(other, "w") as target:
        for name in source.namelist():
            content = source.read(name)
            if name == "modelDescription.xml":
                root = ElementTree.fromstring(content)
                root.set("guid", "{another}")
                content = ElementTree.tostring(root)
            target.writestr(name, content)
    with pytest.raises(Exception):
        Slave(other)


def test_an_old_fmu_outlives_a_library_that_cannot_be_read(config, tmp_path, monkeypatch):
    old, broken = tmp_path / "old.fmu", tmp_path / "library.so.xz"
    fmu.write(config, old)
    before = old.read_bytes()
    monkeypatch.setattr(fmu, "_LIBRARY", broken)
    for content in (None, b"", fmu.lzma.compress(b"x" * 1000)[:-20], b"no xz at all"):
        if content is not None:
            broken.write_bytes(content)
        with pytest.raises(pneuservo.InputError, match="library.so.xz: found no whole library"):
            fmu.write(config, old, replace=True)
        assert old.read_bytes() == before
        with pytest.raises(pneuservo.InputError):
            fmu.write(config, tmp_path / "new.fmu")
        assert not (tmp_path / "new.fmu").exists()


def verb(*arguments, python=True):
    folder = pathlib.Path(sys.executable).parent
    path = os.pathsep.join([str(folder), os.environ["PATH"]]) if python else "/nonexistent"
    return subprocess.run([os.environ["PNEUSERVO_PROGRAM"], *map(str, arguments)], capture_output=True, text=True,
                          env={**os.environ, "PATH": path})


def test_the_verb_export(tmp_path):
    record = tmp_path / "run.csv.gz"
    assert verb("run", CONFIG, "--duration-s", "0.2", "--record", record).returncode == 0
    done = verb("export", record, "--parquet", "--mat", "--out", tmp_path)
    assert done.returncode == 0, done.stderr
    assert list(pneuservo.read_recordings(record)[0]["x_m"]) == list(pneuservo.export.read(tmp_path / "run.mat")["x_m"])
    done = verb("export", CONFIG, "--fmu", tmp_path / "e.fmu", "--model", "estimator", "--fmi", "3", "--set",
                "line_1.length=3 m")
    assert done.returncode == 0, done.stderr
    parameters = {v.name: v.start for v in fmpy.read_model_description(tmp_path / "e.fmu").modelVariables}
    assert float(parameters["line_1.length_m"]) == 3.0
    for arguments, words in (([record], "expected --parquet"), ([CONFIG, record, "--fmu", "x"], "expected one CONFIG"),
                             ([CONFIG, "--fmu", tmp_path / "x", "--set", "line_1.length_m=-3"], "line_1.length_m")):
        done = verb("export", *arguments)
        assert done.returncode == 2 and words in done.stderr, done.stderr
    for option in (["--parquet"], ["--mat"], ["--mcap"], ["--csv"], ["--out", tmp_path], ["--force"]):
        done = verb("export", CONFIG, "--fmu", tmp_path / "never.fmu", *option)
        assert done.returncode == 2 and f"{option[0]}: found with --fmu" in done.stderr, done.stderr
    for option in (["--model", "plant"], ["--fmi", "2"], ["--set", "period_s=0.001"]):
        done = verb("export", record, "--mat", "--out", tmp_path, "--force", *option)
        assert done.returncode == 2 and f"{option[0]}: found without --fmu" in done.stderr, done.stderr
    assert not (tmp_path / "never.fmu").exists()
    done = verb("export", record, "--mat", python=False)
    assert done.returncode != 0 and "python3 cannot be run" in done.stderr


def test_the_verb_replaces_its_own_fmu_alone(tmp_path):
    target, own = tmp_path / "axis.fmu", tmp_path / "own.yaml"
    for model in ("plant", "estimator"):
        done = verb("export", CONFIG, "--fmu", target, "--model", model)
        assert done.returncode == 0, done.stderr
        assert model in fmpy.read_model_description(target).modelName
    own.write_text(pathlib.Path(CONFIG).read_text())
    foreign = tmp_path / "foreign.fmu"
    with zipfile.ZipFile(foreign, "w") as archive:
        archive.writestr("modelDescription.xml", "<fmiModelDescription/>")
        archive.writestr("resources/fmu.json", "{}")
    for config, path, words in ((own, own, "which CONFIG reads"), (CONFIG, own, "which holds something else"),
                                (CONFIG, foreign, "which holds something else")):
        before = path.read_bytes()
        done = verb("export", config, "--fmu", path)
        assert done.returncode == 2 and words in done.stderr, done.stderr
        assert path.read_bytes() == before
