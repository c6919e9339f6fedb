#!/usr/bin/env python3
# The verb effects: text, JSON of all rigs and of one in its numbers; docs and trial recipes know the same names.
import json, pathlib, re, sys

import yaml

from program import CONFIG, expect, expect_refusal, program, run

sys.dont_write_bytecode = True
sys.path.insert(0, "tools")
import vocabulary

told = vocabulary.effects(program)
expect(len(told) > 50 and {"coulomb_friction", "chamber_leak_2", "porous_leak_1", "sensor_lag:p2_chamber", "sensor_gain:F"} <= set(told), f"names: {list(told)}")
done = run("effects")
expect(done.returncode == 0 and all(name in done.stdout and one["words"] in done.stdout for name, one in told.items()), "the text lacks a name or its words")

# What an effect is on a side stands on it; what is looked for has its priors.
leak = told["line_leak_2"]
expect((leak["element"], leak["family"], leak["words"]) == ("line_2", "leak_2", "a leak from line 2 to the room"), f"line_leak_2: {leak}")
expect(told["stribeck_friction"]["contains"] == "coulomb_friction" and told["stribeck_friction"]["shown_by"] == ["many_speeds"], "stribeck_friction")
expect(told["periodic_force"]["role"] == "disturbance" and told["piston_leak_zone"]["role"] == "description", "roles")
key = next(one for one in leak["keys"] if one["key"] == "area_m2")
expect(key["unit"] == "m2" and key["neutral"] == 0 and key["prior"]["spread"] == 0.01 and key["prior"]["scale"] == "valve_area", f"line_leak_2.area_m2: {key}")

# Of a rig: what it can have, in its numbers.
rig = yaml.safe_load(pathlib.Path(CONFIG).read_text())
own = vocabulary.effects(program, rig)
expect("porous_leak_1" not in own and "sensor_gain:F" not in own, "a cylinder has effects of other rigs")
gauge_Pa = rig["supply"]["pressure_Pa"] - 101325
for name, key, value in (("coulomb_friction", "force_N", 2e-4 * rig["cylinder"]["area_1_m2"] * gauge_Pa),
                         ("pressure_dependent_friction", "force_per_pressure_N_per_Pa", 5e-4 * rig["cylinder"]["area_1_m2"]),
                         ("spring_load", "stiffness_N_per_m", 6e-3 * rig["cylinder"]["area_1_m2"] * gauge_Pa / rig["cylinder"]["stroke_m"]),
                         ("chamber_leak_1", "area_m2", 5e-5 * rig["valve"]["area_max_m2"]), ("valve_asymmetry", "exhaust_ratio", 0.99)):
    found = own[name]["smallest"][key]["value"]
    expect(abs(found / value - 1) < 1e-12, f"{name}.{key}: {found}, expected {value}")
sizes = lambda name, rung: vocabulary.sized(own[name], rung, 1.0)
expect(abs(sizes("valve_asymmetry", 3)["exhaust_ratio"] - 0.92) < 1e-12, "a ratio does not move away from one")
expect(abs(sizes("line_restriction_1", 2)["area_m2"] * 2 / sizes("line_restriction_1", 0)["area_m2"] - 1) < 1e-12, "an opening does not close")
expect(sizes("elastic_load", 20)["mass_kg"] == 1.0 and sizes("elastic_load", 20)["damping_ratio"] == 0.05, "a load outgrows the slider")

# The same names in the docs, and in what the trials conceal.
page = pathlib.Path("docs/physics/effects.md").read_text()
for name in {name.partition(":")[0] for name in told if not name.endswith("_2")}:
    expect(re.search(rf"^\| `{name}[`:]", page, re.M), f"docs/physics/effects.md has no row of {name}")
for path in pathlib.Path("tools/trials").glob("*.yaml"):
    names = {name for part in yaml.safe_load(path.read_text()).values() for name in part}
    unknown = [name for name in names if name not in told and f"{name}:x" not in told and "." not in name]
    expect(not unknown, f"{path}: not in the vocabulary: {unknown}")

expect_refusal(run("effects", "no-such.yaml"), ["no-such.yaml"], "a config that is not there")
