#!/usr/bin/env python3
# Servo tables of the simulator's own making, diagnosed: nothing missing, a leak; text, JSON and page.
# With PNEUSERVO_LONG=1 every effect of tools/trials/servo_table.yaml on two configs, clean ones among them.
# tags: long
import argparse, importlib, json, os, pathlib, re, subprocess, sys, tempfile

from program import expect, program, run

sys.dont_write_bytecode = True
sys.path.insert(0, "tools")
table_machines = importlib.import_module("table_machines")
folder = pathlib.Path(tempfile.mkdtemp())
RIGS = ["config/servo-table-1m-8mm.yaml", "config/servo-table-0.5m-4mm.yaml"]
seed = os.environ.get("PNEUSERVO_TEST_SEED", "1")


# What docs/servo-table.md states as missed, by case and config of seed 1; other seeds draw other sizes.
MISSED = {("slider.mass_kg", 1)}


def trial(first, count):
    done = subprocess.run(["tools/diagnosis-trial", folder, "--kind", "table", "--first", str(first), "--count", str(count), "--seed", seed,
                           "--program", program, "--markdown", "--rigs", *RIGS], capture_output=True, text=True, check=False, timeout=1200)
    expect(done.returncode == 0, f"seed {seed}: status {done.returncode}: {done.stdout}{done.stderr}")
    judged = {int(number): word == "ok" for number, word in re.findall(r"^table-(\d+) (ok|--)", done.stdout, re.M)}
    expect(sorted(judged) == list(range(first, first + count)), f"seed {seed}: not all cases were judged: {done.stdout}")
    rows = re.findall(r"^\| .* \| servo-table-\S+ \| .* \| (yes|no) \| .* \|$", done.stdout, re.M)
    expect([row == "yes" for row in rows] == [judged[number] for number in sorted(judged)], f"seed {seed}: rows for the docs: {done.stdout}")
    missed = {(table_machines.CASES[number // len(RIGS)], number % len(RIGS)) for number, right in judged.items() if not right}
    known = {one for one in MISSED if first <= len(RIGS) * table_machines.CASES.index(one[0]) + one[1] < first + count}
    expect(missed == known if seed == "1" else len(missed) <= len(MISSED), f"seed {seed}: missed {missed}, known {known}: {done.stdout}")


# The page of a table with a leak: two valves in its picture, the courses of both ports.
case = 2 * table_machines.CASES.index("chamber_leak_1") + 1
machine, answer = folder / f"table-{case:03d}", folder / f"table-{case:03d}.json"
drawing = argparse.Namespace(rigs=[pathlib.Path(rig) for rig in RIGS], seed=int(seed), program=program)
expect(table_machines.make_case(case, machine, drawing), f"seed {seed}: no draw of the leak runs without a fault")
recordings = sorted(str(path) for path in machine.glob("recording-*.csv.gz"))
done = run("diagnose", str(machine / "rig.yaml"), *recordings, "--quiet", "--report", str(folder / "page.html"), "--json", str(answer),
           "--improved", str(folder / "improved.yaml"))
expect(done.returncode == 0, f"page: status {done.returncode}: {done.stderr}")
page = (folder / "page.html").read_text(encoding="utf-8")
sentence = json.loads(answer.read_text(encoding="utf-8"))["sentence"]
expect("valve 1" in page and "valve 2" in page, "page: the picture lacks the valves of the pair")
expect(sentence in done.stdout and sentence in page, f"page: {sentence} is not in text and page")
done = run("check", str(folder / "improved.yaml"))
expect(done.returncode in (0, 1) and "unsafe" not in done.stdout, f"improved: status {done.returncode}: {done.stdout}{done.stderr}")

# The trial takes that answer, and makes the others.
if os.environ.get("PNEUSERVO_LONG") == "1":
    trial(0, 2 * len(table_machines.CASES))
else:
    trial(0, 1)
    trial(case, 1)
