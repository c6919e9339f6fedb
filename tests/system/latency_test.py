#!/usr/bin/env python3
# The verbs check and latency: exit status, keys of their JSON, stop by signal, and messages for unusable input.
import json, os, signal, subprocess, tempfile, time

from program import catches, expect, program, run, wait_until

checked = run("check", "--json", "-")
findings = json.loads(checked.stdout)
levels = {finding["level"] for finding in findings["machine"]}
expect(checked.returncode == (1 if "bad" in levels else 0), f"check: status {checked.returncode} with levels {levels}")
expect(findings["ready"] == ("bad" not in levels), "check: ready contradicts the levels")
expect(all(finding["remedy"] or finding["level"] == "good" for finding in findings["machine"]), "check: a finding without remedy")
expect("kernel" in run("check").stdout, "check: the table does not name the kernel")
expect(run("check", "--cpu", "100000").returncode == 1, "check: an impossible processor is not bad")

with tempfile.TemporaryDirectory() as folder:
    file = os.path.join(folder, "latency.json")
    done = run("latency", "--period-us", "500", "--duration-s", "0.5", "--json", file)
    expect(done.returncode == 0, f"latency: status {done.returncode}: {done.stderr}")
    expect("lateness p99.99 [us]" in done.stdout, "latency: the table has no p99.99")
    with open(file) as stream:
        one = json.load(stream)["runs"][0]
expect(sum(count for _, count in one["lateness_histogram_us"]) == one["ticks"], "latency: the histogram is not the ticks")
expect(one["ticks"] + one["overruns"] >= 1000 >= one["ticks"], "latency: slots are neither served nor skipped")
late = one["lateness_us"]
expect(late["p50"] <= late["p99"] <= late["p99_9"] <= late["p99_99"] <= late["max"], "latency: percentiles are not in order")

expect(run("latency", "--period-us", "1").returncode == 2, "latency: a period of 1 us is accepted")
expect(run("latency", "--duration-s", "0.1", "--json", "/nonexistent/file").returncode == 2, "latency: an unwritable file is no error")

process = subprocess.Popen([program, "latency", "--duration-s", "600"], stdout=subprocess.PIPE, text=True)
wait_until(lambda: catches(process, signal.SIGINT), "a measurement that can be stopped")
time.sleep(1)
process.send_signal(signal.SIGINT)
output, _ = process.communicate(timeout=60)
expect(process.returncode == 0 and "lateness p50" in output, "latency: Ctrl-C loses the results")
