#!/usr/bin/env python3
# What replay says of a run that it computes again: bit for bit, or how far off and which faults by name.
import os
import tempfile

from program import CONFIG, expect, run

with tempfile.TemporaryDirectory() as folder:
    path = os.path.join(folder, "run.csv.gz")
    # Without feedforward the gains alone make the motion.
    off = ("--set", "controller.flow_feedforward=off")
    made = run("run", CONFIG, *off, "--duration-s", "2", "--record", path)
    expect(made.returncode == 0, f"run: {made.stderr}")
    done = run("replay", CONFIG, path, *off)
    expect(done.returncode == 0 and "bit for bit as recorded" in done.stdout, f"replay: {done.stdout}{done.stderr}")
    # A quarter of the gain leaves the recorded motion, which is a fault of the replay alone.
    done = run("replay", CONFIG, path, *off, "--set", "controller.position_gain_N_per_m=2000")
    expect(done.returncode == 1, f"replay with other gains: status {done.returncode}: {done.stdout}{done.stderr}")
    lines = [line for line in done.stdout.splitlines() if line.split()[:1] == ["fault"]]
    expect(len(lines) == 1 and "recorded none, replayed " in lines[0] and "largest difference" not in lines[0], f"no names of faults: {done.stdout}")
    expect("none" not in lines[0].split("replayed")[1], f"no fault is named: {lines}")

    # Recorded with one fault, replayed with another.
    path = os.path.join(folder, "fault.csv.gz")
    made = run("run", CONFIG, "--duration-s", "2", "--set", "concealed.constant_force.force_N=150", "--record", path)
    expect(made.returncode == 1 and "start_motion" in made.stderr, f"run with an unknown load: {made.stdout}{made.stderr}")
    done = run("replay", CONFIG, path, "--set", "limits.deviation_m=0", "--set", "limits.speed_deviation_mps=0")
    expect("recorded start_motion, replayed speed" in done.stdout, f"the recorded fault is not named: {done.stdout}")
