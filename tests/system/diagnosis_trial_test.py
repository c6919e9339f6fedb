#!/usr/bin/env python3
# Runs tools/diagnosis-trial on a clean machine and one with what that was told to show; draws a machine of each kind without a law.
import importlib.machinery, importlib.util, json, pathlib, subprocess, sys, tempfile, types

import yaml

from program import expect, program

sys.dont_write_bytecode = True
sys.path.insert(0, "tools")
folder = pathlib.Path(tempfile.mkdtemp())


def trial(*arguments):
    return subprocess.run(["tools/diagnosis-trial", folder, "--count", "1", "--program", program, *arguments],
                          capture_output=True, text=True, timeout=300)


done = trial("--kind", "clean")
expect(done.returncode == 0 and "seed 1" in done.stdout, f"clean: status {done.returncode}: {done.stdout}{done.stderr}")
expect("clean: 1 of 1 right, 0 not called consistent, 0 smaller" in done.stdout, f"clean: {done.stdout}")
answer = json.loads((folder / "clean-000.json").read_text())
expect(answer["verdict"] == "consistent" and answer["detectable"], f"clean: the answer is {answer['verdict']}")
again = trial("--kind", "clean", "--markdown")
expect("\n| `clean`, 1, 1 | 1 |  |\n" in again.stdout, f"clean: no row for the docs: {again.stdout}")
expect("  0.0 s" in again.stdout, f"clean: diagnosed anew: {again.stdout}")
done = trial("--kind", "detectable")
expect("detectable: 1 of 1 right" in done.stdout, f"detectable: {done.stdout}{done.stderr}")
done = trial("--kind", "detectable", "--first", "7")
expect(done.returncode == 2 and "no clean-007.json" in done.stderr, f"detectable without clean: {done.stderr}")

import trial_machines

options = types.SimpleNamespace(program=program, seed=11, out=folder, effects=None, rigs=sorted(pathlib.Path("config").glob("cylinder-*.yaml")))
elements = []
for number in range(len(trial_machines.OUTSIDE)):
    case = folder / f"outside-{number:03d}"
    expect(trial_machines.make_case("outside", number, case, options), f"{case.name}: no machine")
    truth = yaml.safe_load((case / "truth.yaml").read_text())
    elements.append(truth["element"])
    expect(truth["verdict"] == "unknown" and bool(truth["effects"]) != ("power" in truth), f"{case.name}: {truth}")
    expect(yaml.safe_load((case / "rig.yaml").read_text())["effects"] == {}, f"{case.name}: the owner knows of it")
expect(elements == ["valve", "piston", "motion", "supply", "motion"], f"elements: {elements}")
# The first draw of this machine does not stand out of its background: another takes its place.
expect(trial_machines.make_case("background", 1, folder / "background-001", options), "background-001: no machine")

loader = importlib.machinery.SourceFileLoader("trial", "tools/diagnosis-trial")
script = importlib.util.module_from_spec(importlib.util.spec_from_loader("trial", loader))
loader.exec_module(script)
told = {"verdict": "consistent", "detectable": [{"effect": "sensor_gain:x", "parameter": "gain", "value": 1.02},
                                                {"effect": "parameter:slider.mass_kg", "parameter": "value", "value": 2.3},
                                                {"effect": "line_restriction_1", "parameter": "area_m2", "value": 2e-5}]}
rig = {"slider": {"mass_kg": 2.0}}
for effects, parameters, too_small in (({"sensor_gain:x": {"gain": 0.985}}, {}, True), ({"sensor_gain:x": {"gain": 0.975}}, {}, False),
                                       ({}, {"slider.mass_kg": 2.2}, True), ({}, {"slider.mass_kg": 1.6}, False),
                                       ({"line_restriction_1": {"area_m2": 3e-5}}, {}, True), ({"line_restriction_1": {"area_m2": 1e-5}}, {}, False)):
    truth = {"effects": effects, "parameters": parameters}
    expect(script.below_what_shows(truth, told, rig) == too_small, f"{truth}: is {'not ' if too_small else ''}called too small")
