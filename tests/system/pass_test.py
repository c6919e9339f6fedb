#!/usr/bin/env python3
# Verb pass: figures, table and page of a feasible pass, a sentence where the lines cannot carry the reference, and runs that follow it.
import csv, json, os, tempfile

from program import CONFIG, expect, expect_refusal, run

NARROW = "config/cylinder-10m-4.15mm.yaml"
SHORT = ("--set", "duration_s=2")

with tempfile.TemporaryDirectory() as folder:
    path = lambda name: os.path.join(folder, name)
    done = run("pass", CONFIG, *SHORT, "--json", path("pass.json"), "--out", path("pass.csv"), "--report", path("pass.html"))
    expect(done.returncode == 0, f"pass: status {done.returncode}: {done.stderr}")
    expect("feasible: run it with --set controller.flow_feedforward=pass" in done.stdout, f"not said to be feasible: {done.stdout}")
    with open(path("pass.json")) as file:
        figures = json.load(file)
    expect(figures["feasible"] and figures["refusal"] == "", f"not feasible: {figures}")
    expect(0.5 < figures["largest_command_V"] < 5.0, f"largest command: {figures}")
    expect(0.0 < figures["predicted_error_m"] < 1e-4, f"predicted error: {figures}")
    with open(path("pass.csv")) as file:
        expect(file.readline().startswith("# Command pass of cylinder-10m-7.65mm"), "the table does not say what it is")
        rows = list(csv.DictReader(file))
    expect(len(rows) == 2001, f"{len(rows)} rows, not one a tick")
    largest = max(abs(float(row["u_V"])) for row in rows)
    expect(abs(largest - figures["largest_command_V"]) < 1e-6, "table and figures differ")
    # Again over the results of before, not over a file of somebody else.
    done = run("pass", CONFIG, *SHORT, "--out", path("pass.csv"), "--json", "-")
    expect(done.returncode == 0 and json.loads(done.stdout)["feasible"], "a second pass may not replace the table of the first")
    with open(path("mine.csv"), "w") as file:
        file.write("t_s,u_V\n0,0\n")
    expect_refusal(run("pass", CONFIG, "--out", path("mine.csv")), ["--out", "mine.csv"], "a file of somebody else")

    done = run("pass", NARROW, *SHORT)
    expect(done.returncode == 1, f"10 m of 4.15 mm: status {done.returncode}")
    expect("not feasible: the lines cannot carry the reference" in done.stdout and "of its speed or" in done.stdout,
           f"10 m of 4.15 mm: {done.stdout}")
    done = run("run", NARROW, *SHORT, "--set", "controller.flow_feedforward=pass")
    expect_refusal(done, ["controller.flow_feedforward: found pass, but the lines cannot carry the reference", "expected a slower"],
                   "a run of what the lines cannot carry")

    done = run("run", CONFIG, "--set", "duration_s=3", "--set", "controller.flow_feedforward=pass", "--json", "-")
    expect(done.returncode == 0, f"run: status {done.returncode}: {done.stderr}")
    followed = json.loads(done.stdout)["runs"][0]
    expect(followed["feedforward"] == "pass", f"feedforward: {followed['feedforward']}")
    expect(followed["max_position_error_m"] < 1e-4, f"largest error {followed['max_position_error_m']} m")

expect_refusal(run("pass", "config/servo-table-1m-8mm.yaml"), ["pass"], "a servo table")
