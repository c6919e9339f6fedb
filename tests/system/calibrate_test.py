#!/usr/bin/env python3
# Verbs home, zero and commission on simulated channels with a displaced encoder and sensors of both kinds, and runs with what they find.
import json, os, tempfile

import yaml

from program import CONFIG, expect, expect_refusal, run

folder = tempfile.mkdtemp()
at = lambda name: os.path.join(folder, name)
CHANNELS = "{channels: {" + ", ".join(f"{name}: {{simulated: true}}" for name in
                                       ("x", "p1_port", "p2_port", "p_supply", "u")) + "}}"
devices = ["--set", f"hal={CHANNELS}", "--set", "sensors.position.incremental=true", "--set", "initial.position_m=0.04"]
displaced = [*devices, "--set", "concealed={'sensor_offset:x': {offset: -0.04}}"]  # it counts from where it was switched on

expect_refusal(run("run", CONFIG, *displaced, "--duration-s", "1"), ["incremental", "verb home"], "run without a zero")
for end, sign in (("low", -1), ("high", 1)):
    done = run("home", CONFIG, *displaced, "--end", end, "--write", at("x.yaml"))
    expect(done.returncode == 0 and f"{end} end at" in done.stdout, f"home: {done.stdout}{done.stderr}")
    with open(at("x.yaml")) as file:
        zero = yaml.safe_load(file)["zeros"]["x"]
    expect(abs(zero - 0.04) < 1e-3, f"home {end}: zero {zero}")
done = run("run", CONFIG, *displaced, "--zeros", at("x.yaml"), "--duration-s", "1.5")
expect(done.returncode == 0, f"run with zeros: {done.stderr}")
done = run("home", CONFIG, *displaced, "--set", "limits.speed_mps=0.005", "--set", "reference.amplitude_m=0.0005")
expect(done.returncode == 1 and "faster than limits.speed_mps" in done.stderr, f"home too fast: {done.stderr}")
for end, sign in (("low", -1), ("high", 1)):  # an encoder that begins far from 0
    done = run("home", CONFIG, *devices, "--end", end)
    expect(done.returncode == 0, f"home {end} of an encoder at 40 mm: {done.stderr}")
done = run("home", CONFIG, *displaced, "--command-V", "1e-6")
expect(done.returncode == 1 and "did not move" in done.stderr, f"home without motion: {done.returncode} {done.stderr}")

# Homing believes no end that is none: an obstacle, an encoder that counts the wrong way or too little.
shorter = ["--set", "deviations={cylinder.stroke_m: -0.3}", "--set", "reference.amplitude_m=0.02"]
done = run("home", CONFIG, *devices, "--set", "initial.position_m=0.01", *shorter)
expect(done.returncode == 1 and "way between both stops" in done.stderr, f"home onto an obstacle: {done.stdout}{done.stderr}")
turned = ["--set", "effects={'sensor_gain:x': {gain: -1}}"]
done = run("home", CONFIG, *devices, *turned)
expect(done.returncode == 1 and "away from the low end" in done.stderr, f"home, encoder reversed: {done.stdout}{done.stderr}")

# Commissioning: what is right, what is wrong, as text and JSON, and the file for run.
done = run("commission", CONFIG, *devices, "--write", at("c.yaml"), "--json", at("c.json"))
expect(done.returncode == 0 and "passed" in done.stdout, f"commission: {done.stdout}{done.stderr}")
with open(at("c.json")) as file:
    found = json.load(file)
expect(found["passed"] and all(check["verdict"] == "ok" for check in found["checks"]), f"commission: {found}")
expect(found["farthest_m"] <= 5e-3 and found["fastest_mps"] <= 0.2, f"commission: {found}")
expect(abs(found["encoder_scale"] - 1) < 0.1 and abs(found["neutral_V"]) < found["neutral_error_V"], f"commission: {found}")
done = run("run", CONFIG, *displaced, "--zeros", at("x.yaml"), "--zeros", at("c.yaml"), "--duration-s", "1.5")
expect(done.returncode == 0, f"run with a commissioning: {done.stderr}")
done = run("commission", CONFIG, *devices, *turned, "--write", at("bad.yaml"), "--json", "-")
verdicts = {check["name"]: check["verdict"] for check in json.loads(done.stdout)["checks"]}
expect(done.returncode == 1 and verdicts["encoder"] == "wrong", f"commission, encoder reversed: {done.stdout}{done.stderr}")
expect_refusal(run("run", CONFIG, *displaced, "--zeros", at("x.yaml"), "--zeros", at("bad.yaml")), ["bad.yaml", "passed"],
               "run after a commissioning that failed")

# A commissioning took a moving machine: it is replaced where that is said, and by nothing but another one.
kept = open(at("c.yaml")).read()
again = ["commission", CONFIG, *devices, "--write"]
expect_refusal(run(*again, at("c.yaml")), ["--write", "c.yaml", "an older commissioning", "--force"], "commission over a commissioning")
expect_refusal(run(*again, at("x.yaml"), "--force"), ["x.yaml", "something else"], "commission --force over a file of zeros")
expect_refusal(run("home", CONFIG, *displaced, "--write", at("c.yaml")), ["c.yaml", "something else"], "home over a commissioning")
expect(open(at("c.yaml")).read() == kept, "a refused verb wrote into a commissioning")
expect(run(*again, at("c.yaml"), "--force").returncode == 0, "commission --force over a commissioning")

# Files of another machine.
other = "config/cylinder-5m-6.10mm.yaml"
for file in ("x.yaml", "c.yaml"):
    expect_refusal(run("run", other, *displaced, "--zeros", at(file)), [file, "cylinder-10m-7.65mm", "cylinder-5m-6.10mm"],
                   f"{file} of another rig")
    expect_refusal(run("run", CONFIG, *displaced, "--set", "cylinder.stroke_m=0.31", "--zeros", at(file)), [file, "machine"],
                   f"{file} of a machine with another stroke")
expect_refusal(run("home", CONFIG), ["hal", "channels"], "home without channels")
expect_refusal(run("run", CONFIG, *displaced, "--hal", "sim", "--zeros", at("x.yaml")), ["--zeros", "sim"], "zeros on the simulated plant")
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
