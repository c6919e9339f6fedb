#!/usr/bin/env python3
# What supervision must find, on the simulated plant: a few rows of tools/safety-table on two lines, and one draw of each.
import json, subprocess, sys

from program import expect, expect_refusal, run

done = subprocess.run(["tools/safety-table", sys.argv[1], "--rows", "payload,jam,obstacle,wiring", "--lines", "2m-6.10mm,10m-7.65mm",
                       "--simulated", "--count", "1", "--seed", "7", "--json", "-"], capture_output=True, text=True, timeout=300)
expect(done.returncode in (0, 1) and done.stdout.startswith("["), f"tools/safety-table: {done.returncode}: {done.stderr}")
rows = json.loads(done.stdout)
expect(len(rows) >= 12, f"{len(rows)} rows, seed 7")
missed = [f"{row['row']}: {row['scenario']}: {'; '.join(row['missed'])}\n  {row['command']}" for row in rows if not row["passed"]]
expect(not missed, "seed 7, not as asked:\n" + "\n".join(missed))

bad = subprocess.run(["tools/safety-table", sys.argv[1], "--rows", "nonsense"], capture_output=True, text=True)
expect(bad.returncode == 2 and "nonsense" in bad.stderr, f"an unknown row: {bad.returncode}: {bad.stderr}")

expect_refusal(run("stopping", "config/machines/tube.yaml"), ["stopping", "cylinder or servo_table"], "a rig without an axis")
done = run("stopping", "config/cylinder-2m-7.65mm.yaml", "--set", "duration_s=2", "--json", "-")
stated = json.loads(done.stdout)
expect(done.returncode == 0 and stated["own_reference"]["distance_m"] > 0.0, f"stopping: {done.stderr}")
checked = subprocess.run(["tools/stopping-table", "--check", sys.argv[1], "config/cylinder-2m-7.65mm.yaml", "config/cylinder-10m-7.65mm.yaml"], capture_output=True, text=True, timeout=300)
expect(checked.returncode == 0, f"tools/stopping-table: {checked.stderr}")
