#!/usr/bin/env python3
# The rules by which tools/proof scores: exact intervals, what is right, false, near or a rival, calibration and coverage.
import math, sys

from program import expect

sys.path.insert(0, "tests/proof")
import scores

for right, of in ((0, 20), (7, 21), (20, 20)):  # Clopper and Pearson: each end leaves 2.5 % beyond it
    low, high = scores.interval(right, of)
    above = sum(math.comb(of, k) * low**k * (1 - low) ** (of - k) for k in range(right, of + 1))
    below = sum(math.comb(of, k) * high**k * (1 - high) ** (of - k) for k in range(right + 1))
    expect(low == 0.0 if right == 0 else abs(above - 0.025) < 1e-9, f"lower end of {right} of {of}: {low}")
    expect(high == 1.0 if right == of else abs(below - 0.025) < 1e-9, f"upper end of {right} of {of}: {high}")


def truth(kind, effects=None, elements=("chamber_1",), background=False, fair=(), **more):
    return {"kind": kind, "effects": effects or {}, "elements": list(elements), "background": background, "fair": list(fair), **more}


def answer(*said, verdict="missing_physics", element="chamber_1", rivals=(), warnings=()):
    answers = [{"effect": name, "element": element, "probability": p, "parameters": {"area_m2": {"value": 1.2e-8, "standard_error": 1e-9}},
                "ambiguous_with": list(rivals)} for name, p in said]
    return {"verdict": verdict, "answers": answers, "elements": [{"element": element, "share": 1.0}], "data": {"warnings": list(warnings)}}


LEAK = {"chamber_leak_1": {"area_m2": 1e-8}}
QUIET = answer(verdict="consistent")
UNKNOWN = answer(("unknown", 0.7), verdict="unknown")
relief = truth("outside", near=["chamber_leak_1"])
known_relief = truth("outside", near=["chamber_leak_1"], law=["chamber_relief_1"])
for what, t, a, word in (
        ("named", truth("single", LEAK), answer(("chamber_leak_1", 0.9)), "right"),
        ("leak at the line's end", truth("single", LEAK), answer(("line_leak_1", 0.9)), "wrong name"),
        ("a rival", truth("single", LEAK), answer(("piston_leak", 0.6), rivals=["chamber_leak_1"]), "true one a rival"),
        ("not seen", truth("single", LEAK), QUIET, "not seen"),
        ("nothing hidden", truth("clean"), QUIET, "right"),
        ("a false alarm", truth("clean"), answer(("piston_leak", 0.6)), "false name"),
        ("unknown on an ideal machine", truth("clean"), UNKNOWN, "unknown"),
        ("unknown on a background", truth("clean", background=True), UNKNOWN, "right"),
        ("a name of the background", truth("clean", background=True, fair=["piston_leak"]), answer(("piston_leak", 0.6)), "right"),
        ("behind a name of the background", truth("single", LEAK, background=True, fair=["valve_dead_band"]), answer(("valve_dead_band", 0.9), ("chamber_leak_1", 0.8)), "right"),
        ("half of a pair", truth("pair", LEAK | {"valve_lag": {"time_constant_s": 0.01}}), answer(("chamber_leak_1", 0.9)), "one of two"),
        ("outside", relief, UNKNOWN, "right"),
        ("outside, elsewhere", relief, answer(("unknown", 0.7), verdict="unknown", element="motion"), "unknown, other element"),
        ("outside, near", relief, answer(("chamber_leak_1", 0.9)), "near law"),
        ("outside, wrong", relief, answer(("valve_lag", 0.9)), "wrong name"),
        ("outside, with a law by now", known_relief, answer(("chamber_relief_1", 0.9)), "right"),
        ("outside, its law not named", known_relief, UNKNOWN, "unknown"),
        ("outside, near its law", known_relief, answer(("chamber_leak_1", 0.9)), "near law"),
        ("outside, that law wrong", relief, answer(("chamber_relief_1", 0.9)), "wrong name"),
        ("mounting", truth("mounting", mounting="ports exchanged"), answer(verdict="consistent", warnings=["p1 and p2 are exchanged"]), "right"),
        ("mounting, not told", truth("mounting", mounting="ports exchanged"), QUIET, "not told")):
    got = scores.outcome(t, a)["word"]
    expect(got == word, f"{what}: {got}, expected {word}")

mass = truth("parameter", parameters={"slider.mass_kg": 2.2})
expect(scores.outcome(mass, answer(("parameter:slider.payload_kg", 0.9)))["right"], "mass and payload are one")
cases = [{"name": "a", "truth": truth("clean"), "answer": answer(("piston_leak", 0.9))},
         {"name": "b", "truth": truth("clean"), "answer": QUIET},
         {"name": "c", "truth": truth("single", LEAK, times_smallest=4.0), "answer": answer(("chamber_leak_1", 0.9))}]
_, figures = scores.table(cases)
expect(figures["rates"]["clean: without a false name"]["right"] == 1, "clean cases with a false name")
[both] = figures["calibration"]["bins"]
expect((both["right"], both["of"]) == (1, 2) and abs(figures["calibration"]["expected_calibration_error"] - 0.4) < 1e-12, f"calibration: {both}")
# The size told is two standard errors off: beyond both intervals.
expect(figures["coverage"]["90%"]["right"] == 0 and figures["coverage"]["90%"]["of"] == 1, "coverage")
