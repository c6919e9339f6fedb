#!/usr/bin/env python3
# Commanders that are killed in motion, of an axis and of a pressure; an hour of it under PNEUSERVO_LONG=1.
# tags: long
import os, subprocess, sys

from program import expect

LONG = os.environ.get("PNEUSERVO_LONG") is not None
length = ["--hours", "1", "--kills", "20"] if LONG else ["--hours", "0.01", "--kills", "2"]
for config in ("config/served/cylinder-10m-7.65mm.yaml", "config/served/pressure-3m-4mm.yaml"):
    done = subprocess.run(["tools/served-trial", "killed", sys.argv[1], "--config", config, *length], capture_output=True, text=True, timeout=3600)
    expect(done.returncode == 0 and "faults: 0" in done.stdout, f"{config}: status {done.returncode}: {done.stdout}{done.stderr}")
