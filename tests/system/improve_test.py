#!/usr/bin/env python3
# Verb improve: from a recording of a machine with concealed friction and dead band to a config that follows better, and what is refused.
import json, os, signal, subprocess, tempfile

from program import expect, expect_refusal, program, run

CONFIG = "config/cylinder-2m-6.10mm.yaml"
MACHINE = ("--set", "concealed={coulomb_friction: {force_N: 20}}")

with tempfile.TemporaryDirectory() as folder:
    path = lambda name: os.path.join(folder, name)
    done = run("run", CONFIG, *MACHINE, "--set", "limits.deviation_m=0", "--set", "limits.speed_deviation_mps=0",
               "--set", "duration_s=4", "--record", path("machine.csv.gz"))
    expect(done.returncode == 0, f"recording: status {done.returncode}: {done.stderr}")
    improve = ("improve", CONFIG, path("machine.csv.gz"), "--quiet", "--improved", path("better.yaml"))
    done = run(*improve, "--json", path("result.json"), "--report", path("page.html"))
    expect(done.returncode == 0, f"improve: status {done.returncode}: {done.stdout}{done.stderr}")
    expect("try it: pneuservo run" in done.stdout, f"how to try it: {done.stdout}")
    with open(path("result.json")) as file:
        result = json.load(file)
    found = result["changes"]["effects.coulomb_friction.force_N"]["after"]
    expect(abs(found - 20) < 1, f"friction of 20 N was found as {found}")
    predicted = {when: result["predicted"][when]["max_position_error_m"] for when in ("before", "after")}
    expect(predicted["after"] < 0.4 * predicted["before"], f"predicted: {predicted}")
    with open(path("page.html")) as file:
        page = file.read()
    expect("Before and after" in page and "as configured" in page, "the page has no before and after")

    # The machine itself, in simulation: friction stays concealed there, the improved config knows it.
    def error_m(config):
        ran = run("run", config, *MACHINE, "--set", "limits.deviation_m=0", "--set", "limits.speed_deviation_mps=0", "--json", "-")
        expect(ran.returncode == 0, f"{config}: status {ran.returncode}: {ran.stderr}")
        return json.loads(ran.stdout)["runs"][0]["max_position_error_m"]
    before, after = error_m(CONFIG), error_m(path("better.yaml"))
    expect(after < 0.4 * before, f"the machine errs by {before} m before, {after} m after")
    expect(abs(before - predicted["before"]) < 0.3 * before, f"predicted before {predicted['before']} m, run {before} m")

    expect_refusal(run(*improve), ["--improved", "better.yaml", "--force"], "an improved config that is there")
    done = run("improve", "config/cylinder-5m-6.10mm.yaml", path("machine.csv.gz"), "--quiet", "--improved", path("other.yaml"))
    expect_refusal(done, ["machine.csv.gz", "cylinder-2m-6.10mm", "cylinder-5m-6.10mm"], "a recording of another rig")
    expect(not os.path.exists(path("other.yaml")), "a config was written for another rig")

    process = subprocess.Popen([program, *improve[:-1], path("stopped.yaml")], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    try:
        process.wait(timeout=1)
    except subprocess.TimeoutExpired:
        process.send_signal(signal.SIGTERM)
        said, told = process.communicate(timeout=120)
        expect(process.returncode == 128 + signal.SIGTERM, f"a stop: status {process.returncode}: {told}")
        expect(said == "" and "nothing is written" in told and not os.path.exists(path("stopped.yaml")), f"a stop: {said} {told}")

# Where the config asks for a pass and there is none, the improved one asks for the formula; on devices the printed command is one.
with tempfile.TemporaryDirectory() as folder:
    path = lambda name: os.path.join(folder, name)
    narrow = ("config/can/cylinder-10m-7.65mm.yaml", "--set", "line_1.diameter_m=4.15e-3", "--set", "line_2.diameter_m=4.15e-3")
    done = run("run", *narrow, "--hal", "sim", "--set", "duration_s=2", "--set", "reference.amplitude_m=0.03", "--record", path("run.csv.gz"))
    expect(done.returncode == 0, f"recording: status {done.returncode}: {done.stderr}")
    done = run("improve", narrow[0], path("run.csv.gz"), *narrow[1:], "--set", "controller.flow_feedforward=pass", "--quiet", "--improved", path("better.yaml"),
               "--json", path("result.json"))
    expect(done.returncode == 1 and "No command pass" in done.stdout and "is formula now" in done.stdout, f"narrow: status {done.returncode}: {done.stdout}{done.stderr}")
    with open(path("better.yaml")) as file:
        expect("flow_feedforward: formula" in file.read(), "the improved config asks for a pass that cannot be had")
    command = done.stdout.split("then pneuservo ")[1].splitlines()[0].split()
    expect("not expected" not in run(*command, "--set", "hal.can.interface=unix:/nonexistent/bus").stderr, f"no command of the program: {command}")

# Where no pass can be had the run ends, or goes on with the formula, as configured.
NARROW = ("run", "config/cylinder-10m-4.15mm.yaml", "--set", "duration_s=2", "--set", "controller.flow_feedforward=pass")
expect_refusal(run(*NARROW, "--set", "controller.without_pass=refuse"), ["the lines cannot carry the reference"], "without a fallback")
done = run(*NARROW, "--set", "controller.without_pass=formula", "--json", "-")
expect(done.returncode == 0 and "it goes on with the formula" in done.stderr, f"with the formula: {done.returncode}: {done.stderr}")
expect(json.loads(done.stdout)["runs"][0]["feedforward"] == "formula", "not with the formula")
done = run("check", "config/cylinder-10m-4.15mm.yaml", "--set", "controller.flow_feedforward=pass", "--set", "controller.without_pass=formula")
expect("a run goes on with the formula" in done.stdout, f"check: {done.stdout}{done.stderr}")
expect_refusal(run("improve", "config/servo-table-1m-8mm.yaml", "nothing.csv.gz"), ["improve"], "a servo table")
