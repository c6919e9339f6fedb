#!/usr/bin/env python3
# Every secret that tools/proof may draw reaches the machine: the machine knows its lines and moves otherwise than without them.
import pathlib, random, sys

from program import expect

sys.path.insert(0, "tests/proof")
import cases, concealed, rigs

machine = pathlib.Path(sys.argv[1]) / "tests/proof/machine/proof_machine"
rng = random.Random(3)
rig = rigs.owners_rig(rng, "rig")
while not 1.0 < rig["line_1"]["length_m"] < 3.0 or rig["period_s"] != 0.001 or rig["effects"]:
    rig = rigs.owners_rig(rng, "rig")
plain = rigs.machine_lines(rig, rigs.loop_gains(rig))
reach = 0.4 * rig["cylinder"]["stroke_m"]
moves = {"move.point": [f"0 {-reach}", f"0.1 {-reach}", f"0.6 {reach}", f"0.7 {reach}", f"1.2 {-reach}"], "first": 0.5, "length": 1.3}


def course(lines):
    return cases.simulate(machine, lines | moves)


def changed(lines, what):
    rows = course(lines)
    largest = max(abs(a[c] - b[c]) for a, b in zip(rows, without) for c in ("p1_port_Pa", "p2_port_Pa"))
    expect(largest > 3 * rig["sensors"]["port_pressure"]["quantum_Pa"], f"{what} changes nothing: {largest} Pa at most")


without = course(plain)
SIZES = {"force_N": 30.0, "extra_force_N": 30.0, "velocity_mps": 0.05, "coulomb_force_N": 0.0, "forward_N": 30.0, "backward_N": 10.0,
         "force_per_pressure_N_per_Pa": 1e-4, "center_m": 0.0, "width_m": 0.05, "coefficient_Ns2_per_m2": 200.0, "stiffness_N_per_m": 500.0, "rest_m": 0.0,
         "mass_kg": 0.5 * rigs.moving_kg(rig), "natural_frequency_Hz": 8.0, "damping_ratio": 0.05, "width_V": 0.5, "offset_V": 0.3, "time_constant_s": 0.01,
         "exhaust_ratio": 0.7, "delay_s": 0.01, "volume_m3": 5e-4, "position": 0.5}
for effect, keys in concealed.EFFECT_LINES.items():
    lines = dict(plain)
    opening = 0.3 if effect.startswith(("line_restriction", "supply")) else 0.05
    concealed.put_effect(lines, effect, {key: SIZES.get(key, opening * rig["valve"]["area_max_m2"]) for key in keys})
    changed(lines, effect)

seen = {}
for _ in range(2000):
    lines = dict(plain)
    truth = concealed.outside(rng, rig, lines, 1.3, {"chamber_relief_1", "valve_stiction"})
    seen.setdefault(truth["outside"], []).append(lines)
    known_law = {"relief valve": ["chamber_relief_1"], "sticking spool": ["valve_stiction"]}.get(truth["outside"], [])
    expect(truth["law"] in ([], known_law) and (truth["law"] != []) == (truth["verdict"] == "missing_physics"), f"law of {truth}")
expect(len(seen) >= 12, f"kinds outside the vocabulary: {sorted(seen)}")
for kind, drawn in sorted(seen.items()):
    if kind == "payload taken up":
        drawn[0]["motion.gained_at"] = 0.8  # these moves are shorter than a recording
    changed(drawn[0], kind)

small = dict(plain)
fair = concealed.background(rng, rig, small)
changed(small, "the background")
expect("frequency_dependent_losses" in fair, f"names of the background: {fair}")

# A machine's own loop: it comes where it is wanted, without hitting the ends.
expect(abs(without[-1]["x_m"] - without[-1]["x_ref_m"]) < 0.25 * reach, f"at the end the slider is {without[-1]['x_m']} m, wanted {without[-1]['x_ref_m']} m")
