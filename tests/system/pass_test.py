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
    done = run("run", NARROW, *SHORT, "--set", "controller.flow_feedforward=pass", "--set", "controller.without_pass=refuse")
    expect_refusal(done, ["controller.flow_feedforward: found pass, but the lines cannot carry the reference", "expected a slower"],
                   "a run of what the lines cannot carry")

    done = run("run", CONFIG, "--set", "duration_s=3", "--set", "controller.flow_feedforward=pass", "--json", "-")
    expect(done.returncode == 0, f"run: status {done.returncode}: {done.stderr}")
    followed = json.loads(done.stdout)["runs"][0]
    expect(followed["feedforward"] == "pass", f"feedforward: {followed['feedforward']}")
    expect(followed["max_position_error_m"] < 1e-4, f"largest error {followed['max_position_error_m']} m")

    # Moves that teach each other, kept from run to run, and replayed from what a run began with.
    learns = ("--set", "controller.flow_feedforward=pass", "--set", "controller.learning=command", *SHORT, "--set",
              "reference={kind: waypoints, times_s: [0.2, 1.0, 1.1, 1.9], positions_m: [0, 0.08, 0.08, 0], smoothness: 7}")
    machine = ("--set", "deviations={valve.area_per_volt_m2_per_V: 0.05}")
    errors = []
    for number in (1, 2):
        done = run("run", CONFIG, *learns, *machine, "--moves", "3", "--learned", path("mine.learned"),
                   "--record", path(f"{number}.csv.gz"), "--json", "-")
        expect(done.returncode == 0 and "learning" in done.stderr, f"learning: status {done.returncode}: {done.stderr}")
        errors += [one["rms_position_error_m"] for one in json.loads(done.stdout)["runs"]]
    expect(errors[2] < 0.6 * errors[0] and errors[3] < 0.6 * errors[0], f"moves did not teach: {errors}")
    replay = ("replay", CONFIG, path("2.csv.gz"), *learns, *machine)
    expect(run(*replay, "--learned", path("mine.learned.before")).returncode == 0, "a run that began with a learned move is not replayed")
    expect(run(*replay).returncode == 1, "a replay without what was learned says that nothing differs")
    expect_refusal(run("run", CONFIG, *learns, "--set", "reference.positions_m=[0, 0.07, 0.07, 0]", "--learned", path("mine.learned")),
                   ["mine.learned", "another reference"], "what another move taught")
    expect_refusal(run("run", CONFIG, "--learned", path("new.learned")), ["--learned", "controller.learning"], "learning without a law that learns")
    expect_refusal(run("check", CONFIG, "--set", "controller.learning=command", "--set", "controller.flow_feedforward=off"), ["controller.learning", "pass"], "learning without a pass")

expect_refusal(run("pass", "config/servo-table-1m-8mm.yaml"), ["pass"], "a servo table")
