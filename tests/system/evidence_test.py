#!/usr/bin/env python3
# The evidence page: its table from rows' files, what a row counts as met, the line of a dose, what ablation judges; nothing is diagnosed.
import importlib.machinery, importlib.util, json, os, pathlib, subprocess, sys, tempfile, types

from program import expect, program

sys.dont_write_bytecode = True
sys.path[:0] = ["tools", "tests/proof"]
import dose, evidence_page, evidence_rows, real

folder = pathlib.Path(tempfile.mkdtemp())


def script(name):
    loader = importlib.machinery.SourceFileLoader(name.replace("-", "_"), f"tools/{name}")
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader(loader.name, loader))
    loader.exec_module(module)
    return module


def near(found, asked, what):
    expect(abs(found - asked) < 1e-9, f"{what}: {found}, expected {asked}")


# A line through points by hand: what is left is 0.2, -0.1, -0.4, 0.3, of variance 0.15.
fitted = dose.line([(0.0, 0.0), (1.0, 1.0), (2.0, 2.0), (3.0, 4.0)])
for key, asked in (("slope", 1.3), ("intercept", -0.2), ("slope_error", 0.03**0.5), ("intercept_error", (0.15 * 0.7) ** 0.5)):
    near(fitted[key], asked, key)
fitted = dose.line([(x, 0.97 * x + 0.5) for x in (0, 4, 8, 16, 32)])
near(fitted["slope"], 0.97, "slope of points on a line")
near(fitted["intercept"], 0.5, "intercept of points on a line")
expect(dose.is_one(fitted), "a slope of 0.97 is not one")
for points, what in (([(x, 0.94 * x) for x in range(5)], "a slope of 0.94"), ([(0, 0), (4, 4), (8, 0), (16, 0), (32, 32)], "a line with two doses not named")):
    expect(not dose.is_one(dose.line(points)), f"{what} counts as one: {dose.line(points)}")


def answer(*said, verdict="missing_physics"):
    return {"verdict": verdict, "answers": [{"effect": name, "element": element, "probability": p, "parameters": parameters or {}}
                                            for name, element, p, parameters in said]}


size = lambda value: {"value": value, "standard_error": 0.01}
dry = {"extra_force_N": size(0.1), "velocity_mps": size(0.03), "coulomb_force_N": size(2.0)}
near(dose.found(answer(("coulomb_friction", "motion", 0.9, {"force_N": size(2.5)})), "coulomb_friction"), 2.5, "found")
near(dose.found(answer(("stribeck_friction", "motion", 0.9, dry)), "coulomb_friction"), 2.0, "found by a name for the same")
near(dose.found(answer(("stribeck_friction", "motion", 0.9, dry | {"extra_force_N": size(1.0)})), "coulomb_friction"), 0.0, "another friction")
near(dose.found(answer(verdict="consistent"), "coulomb_friction"), 0.0, "nothing named")

# Rows: exact interval, and met by the rule that is asked.
rows = {row.name: row for row in evidence_page.ROWS}
expect(len(rows) == len(evidence_page.ROWS), "two rows have one name")
expect({row.measurement for row in evidence_page.ROWS} == set(evidence_rows.MEASUREMENTS), "rows and measurements differ")
for name, figures, met in (("ablation-labelled", {"right": 17, "of": 20}, True), ("ablation-labelled", {"right": 16, "of": 20}, False),
                           ("ablation-labelled-wrong", {"right": 2, "of": 20}, False), ("ablation-labelled-wrong", {"right": 1, "of": 20}, True),
                           ("calibration-sure", {"right": 20, "of": 20}, False), ("calibration-sure", {"right": 40, "of": 40}, True),
                           ("calibration-error", {"value": 0.051, "found": "0.051"}, False), ("calibration-sizes", {"right": 99, "of": 100}, False),
                           ("numbers", {"value": 15, "found": "15"}, True), ("numbers", {"value": 16, "found": "16"}, False),
                           ("dose-zero", {"right": 5, "of": 6}, False), ("decoys-wrong", {"right": 0, "of": 8}, True),
                           ("decoys", {"right": 0, "of": 8}, None), ("dose-zero", {"right": 0, "of": 0}, None)):
    got = evidence_page.measured(rows[name], **figures)["met"]
    expect(got is met, f"{name} of {figures}: met is {got}, expected {met}")

# The page: what stands around the marks stays, a row without a file is not measured, writing twice changes nothing.
kept, page = folder / "evidence", folder / "page.md"
page.write_text(f"# Before\n\n{evidence_page.BEGIN}\nold table\n{evidence_page.END}\n\nAfter\n")
wrong = [f"case-{number}: consistent" for number in range(8)]
evidence_page.write_row(kept, evidence_page.measured(rows["ablation-labelled"], right=12, of=20, wrong=wrong),
                        {"command": "tools/evidence OUT --rows ablation-labelled", "commit": "0123abcd", "date": "2026-12-01"})
expect(evidence_page.write_page(page, kept) == "", "the page is not written")
text = page.read_text()
expect(text.startswith(f"# Before\n\n{evidence_page.BEGIN}\n| what |") and text.endswith(f"\n{evidence_page.END}\n\nAfter\n"), f"around the marks: {text}")
expect("old table" not in text, "the table of before stands")
# Clopper and Pearson: 12 of 20 is 36 to 81 %.
line = f"| {rows['ablation-labelled'].what} | 12 of 20 | 36 to 81 % | 85 % | no | 2026-12-01, `0123abcd` |\n"
expect(line in text, f"the row is not {line}: {text}")
expect(f"| {rows['decoys'].what} | not measured |" in text and text.count("not measured") == len(rows) - 1, "rows that are not measured")
expect("- `tools/evidence OUT --rows ablation-labelled`\n" in text and "case-5: consistent; 2 more in `docs/evidence/ablation-labelled.json`\n" in text, f"command and cases: {text}")
evidence_page.write_page(page, kept)
expect(page.read_text() == text, "writing twice changes the page")
page.write_text("no marks\n")
expect("expected one line" in evidence_page.write_page(page, kept) and page.read_text() == "no marks\n", "a page without marks")
expect(pathlib.Path("docs/diagnosis-results.md").read_text().count(evidence_page.BEGIN) == 1, "docs/diagnosis-results.md has no place for the table")

# Real machines: a name of 0.5 or more that no source bears out.
found = answer(("coulomb_friction", "motion", 0.9, None), ("valve_lag", "valve", 0.6, None), ("spring_load", "motion", 0.4, None))
expect(real.wrong_names("emps.yaml emps_base.csv.gz", found) == ["valve_lag"], "names of emps")
expect(real.wrong_names("cylinder-strokes.yaml cylinder_damp_up_2.csv.gz", found) == ["coulomb_friction", "valve_lag"], "names of a damper")

# Ablation: the word for what is said instead, and an order of own machines that does not depend on how many are wanted.
ablation = script("ablation-trial")
for said, word in ((answer(("unknown", "line_1", 0.7, None), verdict="unknown"), "right"), (answer(("unknown", "motion", 0.7, None), verdict="unknown"), "elsewhere"),
                   (answer(("piston_leak", "piston", 0.5, None)), "wrong"), (answer(("piston_leak", "piston", 0.49, None)), "doubted"), (answer(verdict="consistent"), "nothing")):
    got = ablation.judged(said, {"chamber_1", "line_1"})
    expect(got == word, f"{said}: {got}, expected {word}")
numbers = ablation.own_numbers(3, 20)
expect(len(set(numbers)) == len(numbers) and all(number // 20 % 5 >= 2 for number in numbers), "own machines: each once, from 4 times the smallest size on")
expect(numbers != ablation.own_numbers(4, 20), "own machines do not depend on the seed")

# The tool: sentences for what it cannot use, and no answers of two programs in one row.
without = {key: value for key, value in os.environ.items() if key != "PNEUSERVO_SHARED"}
for words, status, told in ((["OUT", "--rows", "nothing"], 2, "expected some of numbers"), (["--count", "dose=3", "--page"], 2, "expected NAME=N"), ([], 2, "expected one of them"),
                            ([folder / "out", "--rows", "labelled", "--program", program], 1, "labelled: left, $PNEUSERVO_SHARED/concealed/labelled is not there")):
    done = subprocess.run(["tools/evidence", *map(str, words)], capture_output=True, text=True, env=without)
    expect(done.returncode == status and told in done.stderr and len(done.stderr.splitlines()) == 1, f"{words}: status {done.returncode}: {done.stderr}")
evidence, other = script("evidence"), folder / "program"
other.write_text("one")
options = types.SimpleNamespace(out=folder, program=other, commit="0123abcd", seed=7)
expect(evidence.is_another_run("dose", options) == "" and evidence.is_another_run("dose", options) == "", "the same program is refused")
other.write_text("another")
expect("expected the same" in evidence.is_another_run("dose", options), "another program is taken for the same")
numbers = evidence_rows.numbers(types.SimpleNamespace(root=pathlib.Path(".")))["numbers"]["value"]
text = pathlib.Path("src/diagnosis/verdict/decision_rules.hpp").read_text()
expect(numbers == text.count("///<") - sum(line.strip().startswith("///<") for line in text.splitlines()), f"numbers counted: {numbers}")
