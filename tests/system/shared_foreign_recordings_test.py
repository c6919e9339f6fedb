#!/usr/bin/env python3
# Recordings as the public's bug reports describe them, from the shared files: each is read, and named as its whole original.
import glob, os, re, subprocess, sys

from program import expect, program

FOLDER = os.path.join(os.environ.get("PNEUSERVO_SHARED", "../shared"), "foreign", "recordings")
FRICTION, DEAD_BAND = ("coulomb_friction", 20.46, 0.03), ("valve_dead_band", 0.030, 0.02)  # name, size, share it may be off by
REFUSED = {"csv-frozen-position/const.csv": "x_m does not move", "cyl-position-outside-stroke/xoff.csv": "State it"}

paths = sorted(glob.glob(os.path.join(FOLDER, "*", "*.csv")))
if not paths:
    print(f"left out: {FOLDER} is not there")
    sys.exit(77)
for path in paths:
    folder, name = os.path.split(path)
    case = os.path.join(os.path.basename(folder), name)
    rig = glob.glob(os.path.join(folder, "*.yaml"))[0]
    done = subprocess.run([program, "diagnose", rig, path, "--quiet"], capture_output=True, text=True, timeout=300)
    if case in REFUSED:
        expect(done.returncode == 2 and REFUSED[case] in done.stderr and done.stderr.count("\n") == 1, f"{case}: {done.stderr}")
        continue
    first = done.stdout.partition("\n")[0]
    effect, size, share = DEAD_BAND if case.startswith("cyl-") else FRICTION
    named = re.fullmatch(r"The model lacks (\w+) at [^()]*\(\w+ = (\S+) \+- \S+\), probability \S+", first)  # one name alone
    expect(done.returncode == 0 and named and named[1] == effect and abs(float(named[2]) / size - 1) < share,
           f"{case}: status {done.returncode}: {first} {done.stderr}")
sys.exit(0)
