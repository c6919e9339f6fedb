#!/usr/bin/env python3
# Every scenario of config/scenarios gives the fault that it says, in its time, with the safe output and no row lost.
import glob, re, subprocess, sys

import yaml

from program import expect, expect_refusal, run

done = subprocess.run(["tools/fault-table", sys.argv[1], "--markdown"], capture_output=True, text=True, timeout=900)
expect(done.returncode == 0, f"tools/fault-table: status {done.returncode}:\n{done.stdout}{done.stderr}")
with open("docs/faults.md") as page:
    rows = set(page.read().splitlines())
stale = [row for row in done.stdout.splitlines() if row.startswith("| ") and row not in rows]
expect(not stale, "docs/faults.md does not have these rows of tools/fault-table --markdown: " + "; ".join(stale))

# Every fault has its scenario, one of a pair of sides stands for both. What no kind injects has a test of its own.
NOT_INJECTED = {"estimate_invalid", "command_not_finite", "limit_switch", "valve_power", "link_down",
                "position_unknown"}
family = lambda name: re.sub(r"_[12](?=_|$)", "", name)
with open("include/pneuservo/loop/fault.hpp") as header:
    names = re.findall(r"^    \{fault_\w+, \"(\w+)\"", header.read(), re.M)
found = {name for row in done.stdout.splitlines()[2:] for name in row.split("|")[4].strip().split(", ")}
for path in glob.glob("config/scenarios/device/*.yaml"):
    with open(path) as file:
        found.add(yaml.safe_load(file)["expect"]["fault"])
without = {name for name in names if family(name) not in set(map(family, found))}
expect(len(names) > 40 and without == NOT_INJECTED, f"faults without a scenario: {without ^ NOT_INJECTED}")
# As an expected value in code: neither in a comment nor in a text.
tests = "".join(re.sub(r'//.*|"(\\.|[^"\\])*"', "", open(path).read()) for path in glob.glob("tests/**/*_test.cpp", recursive=True))
untested = [name for name in NOT_INJECTED if not re.search(rf"(==|&|,)\s*(std::uint64_t\{{)?fault_{name}\b", tests)]
expect(not untested, f"faults without scenario and test: {untested}")

drawn = subprocess.run(["tools/state-figure", "--check"], capture_output=True, text=True, timeout=120)
expect(drawn.returncode == 0, f"tools/state-figure: {drawn.stderr}")

CONFIG = "config/cylinder-10m-7.65mm.yaml"
expect_refusal(run("run", CONFIG, "--fault", "bias:p3:1"), ["bias", "'p3'", "p1_port"], "a channel that is not there")
expect_refusal(run("run", CONFIG, "--fault", "bias:p1_port"), ["bias", "no value"], "a bias without a size")
expect_refusal(run("run", CONFIG, "--fault", "off:io"), ["off", "verb device"], "a fault of a bus in sim")
expect_refusal(run("run", CONFIG, "--scenario", "no-such-file.yaml"), ["no-such-file.yaml", "no such file"], "no file")

# The same command without the fault leads back: nothing of it is kept.
expect(run("run", CONFIG, "--duration-s", "1.5", "--fault", "emergency_stop@1").returncode == 1, "the emergency stop did not end the run")
done = run("run", CONFIG, "--duration-s", "1.5", "--fault", "emergency_stop@1")
expect("fault: emergency_stop" in done.stderr and "t = 1 s" in done.stderr, f"emergency stop: {done.stderr}")
expect(run("run", CONFIG, "--duration-s", "1.5").returncode == 0, "the way back")
