#!/usr/bin/env python3
# Every scenario of config/scenarios gives the fault that it says, in its time, with the safe output and no row lost.
import subprocess, sys

from program import expect, expect_refusal, run

done = subprocess.run(["tools/fault-table", sys.argv[1], "--markdown"], capture_output=True, text=True, timeout=900)
expect(done.returncode == 0, f"tools/fault-table: status {done.returncode}:\n{done.stdout}{done.stderr}")
with open("docs/faults.md") as page:
    rows = set(page.read().splitlines())
stale = [row for row in done.stdout.splitlines() if row.startswith("| ") and row not in rows]
expect(not stale, "docs/faults.md does not have these rows of tools/fault-table --markdown: " + "; ".join(stale))

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
