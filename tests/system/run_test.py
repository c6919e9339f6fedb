#!/usr/bin/env python3
# The verb run and its replay: keys of the JSON in both times, recordings by source, moves, faults with status 1.
import gzip, json, os, sys, tempfile

from program import CONFIG, edited_config, expect, expect_refusal, run

folder = tempfile.mkdtemp()
at = lambda name: os.path.join(folder, name)

# Three sources, recorded, and each replayed bit for bit; duration and source come from the recording.
done = run("run", CONFIG, "--pressure-source", "all", "--duration-s", "1.2", "--record", at("a.csv.gz"), "--json", at("a.json"),
           "--set", "initial.position_m=0.05")
expect(done.returncode == 0, f"run: status {done.returncode}: {done.stderr}")
with open(at("a.json")) as file:
    result = json.load(file)
expect([one["pressure_source"] for one in result["runs"]] == ["valve", "chamber", "estimated"], "run: the three sources are not there")
expect(all(one["faults"] == [] and one["overruns"] == 0 and "lateness_us" not in one for one in result["runs"]), "run: odd keys")
expect(all(2000 < one["ticks"] < 2500 for one in result["runs"]), "run: the approach is not in the ticks")
for source in ("valve", "chamber", "estimated"):
    name = at(f"a-{source}.csv.gz")
    replayed = run("replay", CONFIG, name, "--set", "initial.position_m=0.05", "--json", "-")
    expect(replayed.returncode == 0 and json.loads(replayed.stdout)["identical"], f"replay of {source}: {replayed.stderr}{replayed.stdout}")
    expect(replayed.stderr == "", f"replay of {source} complains: {replayed.stderr}")
changed = run("replay", CONFIG, at("a-estimated.csv.gz"), "--set", "initial.position_m=0.05", "--set", "line_1.diameter_m=0.007650000000000001")
expect(changed.returncode == 1 and "first: row" in changed.stdout and "another config" in changed.stderr, f"a changed bit is not seen: {changed.stdout}{changed.stderr}")

# Feedforwards beside sources: the pass errs least with each of them. Where the lines cannot carry the reference the formula has its run.
done = run("run", CONFIG, "--pressure-source", "all", "--flow-feedforward", "all", "--duration-s", "3", "--record", at("f.csv.gz"), "--json", "-")
expect(done.returncode == 0, f"feedforwards: status {done.returncode}: {done.stderr}")
error_m = {(one["pressure_source"], one["feedforward"]): one["max_position_error_m"] for one in json.loads(done.stdout)["runs"]}
for source in ("valve", "chamber", "estimated"):
    expect(error_m[source, "pass"] < 0.1 * error_m[source, "formula"] < 0.1 * error_m[source, "none"], f"feedforwards: {error_m}")
expect(os.path.exists(at("f-chamber-formula.csv.gz")) and run("replay", CONFIG, at("f-valve-pass.csv.gz")).returncode == 0, "recordings of the feedforwards")
done = run("run", "config/cylinder-10m-4.15mm.yaml", "--flow-feedforward", "all", "--duration-s", "2", "--json", "-")
expect([one["feedforward"] for one in json.loads(done.stdout)["runs"]] == ["none", "formula"], f"feedforwards of narrow lines: {done.stdout}")
expect("cannot carry the reference" in done.stderr, f"feedforwards of narrow lines: {done.stderr}")
expect_refusal(run("run", "config/servo-table-1m-8mm.yaml", "--flow-feedforward", "pass"), ["flow_feedforward"], "a feedforward for ppd2")
expect_refusal(run("run", "config/servo-table-1m-8mm.yaml", "--flow-feedforward", "all"), ["--flow-feedforward", "ppd2"], "feedforwards for ppd2")

# Moves.
move = "reference={kind: minimum_jerk, start_m: 0.0, end_m: 0.05, start_s: 0.1, duration_s: 0.4}"
done = run("run", CONFIG, "--set", move, "--duration-s", "1.5", "--moves", "3", "--record", at("m.csv.gz"), "--json", "-")
moves = json.loads(done.stdout)["runs"]
expect(done.returncode == 0 and [one["move"] for one in moves] == [1, 2, 3], f"--moves 3: {done.stderr}")
expect(max(one["max_position_error_m"] for one in moves) < 1.3 * min(one["max_position_error_m"] for one in moves), "--moves: not alike")
expect(run("replay", CONFIG, "--set", move, at("m.csv.gz")).returncode == 0, "replay of three moves differs")

# Real time: latency keys, a whole histogram, and the numbers of simulated time up to the first overrun.
done = run("run", CONFIG, "--time", "real", "--duration-s", "1", "--record", at("r.csv.gz"), "--json", "-")
expect(done.returncode == 0, f"real time: status {done.returncode}: {done.stderr}")
result = json.loads(done.stdout)
one = result["runs"][0]
for key in ("lateness_us", "work_us", "loop_us", "estimator_us", "controller_us", "backend_us", "page_faults", "context_switches_involuntary"):
    expect(key in one, f"real time: {key} is missing")
expect(one["ticks"] + one["overruns"] == 1000, f"real time: {one['ticks']} ticks and {one['overruns']} overruns are not 1000 slots")
counted = sum(count for _, count in one["lateness_histogram_us"])
expect(counted == one["ticks"] - 200, f"real time: the histogram holds {counted} of {one['ticks']} ticks less 200 of warm-up")
expect(0.9 < result["realtime_factor"] < 1.1, f"real time: {result['realtime_factor']} times real time")
expect(run("replay", CONFIG, at("r.csv.gz")).returncode == 0, "replay of a real-time run differs")
done = run("latency", CONFIG, "--duration-s", "1", "--json", "-")
both = json.loads(done.stdout)["runs"]
expect([len(both), both[0]["name"], both[1]["name"]] == [2, "timer", "cylinder-10m-7.65mm"], f"latency CONFIG: {done.stdout[:300]}")

# A fault: status 1, one reason with its remedy, the rows before and after it, the legend in the header.
done = run("run", CONFIG, "--fault", "drop:x@0.5", "--set", "safe_output.command_V=0.125", "--record", at("f.csv.gz"), "--json", at("f.json"))
expect(done.returncode == 1, f"fault: status {done.returncode}")
expect(done.stderr.count("fault: ") == 1 and "fault: position_missing: the position was missing" in done.stderr, f"fault: {done.stderr}")
expect("its safe output of 0.125 V since t = " in done.stderr and "run the same command again with another name" in done.stderr, "fault: the way back is not said")
with open(at("f.json")) as file:
    expect(json.load(file)["runs"][0]["faults"][0].startswith("position_missing: "), "fault: not in the JSON")
with gzip.open(at("f.csv.gz"), "rt") as file:
    lines = file.read().splitlines()
rows = [line.split(",") for line in lines if not line.startswith("#")]
fault, command = rows[0].index("fault"), rows[0].index("u_V")
expect(any("fault_bits:" in line for line in lines) and any('1: "position_missing: ' in line for line in lines), "fault: no legend in the header")
bad = [row for row in rows[1:] if row[fault] != "0"]
expect(len(bad) == 301 and all(row[command] == "0.125" and int(row[fault]) & 1 for row in bad), f"fault: {len(bad)} rows after it")
expect(len(rows) > 400 and rows[-301:] == bad, "fault: rows before it are lost")
expect(run("replay", CONFIG, at("f.csv.gz"), "--set", "safe_output.command_V=0.125").returncode == 0, "replay of a faulted run differs")
expect(run("run", CONFIG, "--duration-s", "0.5").returncode == 0, "the same axis does not run after a fault")

# A machine that skips a slot now and then keeps its cross-checks.
late = [word for k in range(1, 12) for word in ("--fault", f"late_tick:0.001@{0.4 * k:g}")]
done = run("run", CONFIG, "--duration-s", "4", "--fault", "leak:1:1e-6@2", *late)
expect(done.returncode == 1 and "flow_mismatch_1" in done.stderr, f"leak beside late ticks: {done.returncode} {done.stderr}")
