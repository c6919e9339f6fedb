#!/usr/bin/env python3
# Verbs home and zero on simulated channels with a displaced encoder and sensors of both kinds, and runs with what they find.
import os, tempfile

import yaml

from program import CONFIG, expect, expect_refusal, run

folder = tempfile.mkdtemp()
at = lambda name: os.path.join(folder, name)
CHANNELS = "{channels: {" + ", ".join(f"{name}: {{simulated: true}}" for name in
                                       ("x", "p1_port", "p2_port", "p_supply", "u")) + "}}"
devices = ["--set", f"hal={CHANNELS}", "--set", "sensors.position.incremental=true", "--set", "initial.position_m=0.04"]
displaced = [*devices, "--set", "effects={'sensor_offset:x': {offset: -0.04}}"]  # it counts from where it was switched on

expect_refusal(run("run", CONFIG, *displaced, "--duration-s", "1"), ["incremental", "verb home"], "run without a zero")
for end, sign in (("low", -1), ("high", 1)):
    done = run("home", CONFIG, *displaced, "--end", end, "--write", at("x.yaml"))
    expect(done.returncode == 0 and f"{end} end at" in done.stdout, f"home: {done.stdout}{done.stderr}")
    with open(at("x.yaml")) as file:
        zero = yaml.safe_load(file)["zeros"]["x"]
    expect(abs(zero - 0.04) < 1e-3, f"home {end}: zero {zero}")
done = run("run", CONFIG, *displaced, "--zeros", at("x.yaml"), "--duration-s", "1.5")
expect(done.returncode == 0, f"run with zeros: {done.stderr}")
done = run("home", CONFIG, *displaced, "--set", "limits.speed_mps=0.005")
expect(done.returncode == 1 and "faster than limits.speed_mps" in done.stderr, f"home too fast: {done.stderr}")
for end, sign in (("low", -1), ("high", 1)):  # an encoder that begins far from 0
    done = run("home", CONFIG, *devices, "--end", end)
    expect(done.returncode == 0, f"home {end} of an encoder at 40 mm: {done.stderr}")
done = run("home", CONFIG, *displaced, "--command-V", "1e-6")
expect(done.returncode == 1 and "did not move" in done.stderr, f"home without motion: {done.returncode} {done.stderr}")
expect_refusal(run("home", CONFIG), ["hal", "channels"], "home without channels")
expect_refusal(run("run", CONFIG, "--zeros", at("x.yaml")), ["--zeros", "sim"], "zeros on the simulated plant")
for verb in ("run", "home", "zero"):
    expect_refusal(run(verb, "config/comedi/cylinder-10m-7.65mm.yaml"), ["--time", "real"], f"{verb} of a board in simulated time")

vented = ["--set", "initial={pressure_1_Pa: 101325, pressure_2_Pa: 101325}", "--set", f"hal={CHANNELS}"]
gauge = "'sensor_offset:p1_port': {offset: -101000}, 'sensor_offset:p2_port': {offset: 1200}, 'sensor_offset:p_supply': {offset: -598675}"
done = run("zero", CONFIG, *vented, "--set", "effects={" + gauge + "}", "--write", at("p.yaml"))
expect(done.returncode == 0, f"zero: {done.stderr}")
words = {line.split()[0]: line.split()[1] for line in done.stdout.splitlines()}
expect(words == {"p1_port": "gauge", "p2_port": "absolute", "p_supply": "absolute"}, f"zero: {words}")
with open(at("p.yaml")) as file:
    zeros = yaml.safe_load(file)["zeros"]
expect(abs(zeros["p1_port"] - 101000) < 100 and abs(zeros["p2_port"] + 1200) < 100, f"zero: {zeros}")
done = run("zero", CONFIG, "--set", f"hal={CHANNELS}")
expect(done.returncode == 1 and "p1_port shows 47" in done.stderr and "vent the lines" in done.stderr, f"zero under air: {done.stderr}")
