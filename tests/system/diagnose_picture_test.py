#!/usr/bin/env python3
# diagnose --picture where the verdict has a name: no file, and a sentence that says so.
import os
import tempfile

from program import expect, run

CONFIG = "config/cylinder-2m-6.10mm.yaml"
with tempfile.TemporaryDirectory() as folder:
    recording, picture = os.path.join(folder, "run.csv.gz"), os.path.join(folder, "unknown.csv")
    made = run("run", CONFIG, "--duration-s", "4", "--set", "concealed.coulomb_friction.force_N=15", "--record", recording)
    expect(made.returncode == 0, f"run: {made.stderr}")
    done = run("diagnose", CONFIG, recording, "--picture", picture, "--quiet")
    expect(done.returncode == 0 and "coulomb_friction" in done.stdout, f"diagnose: {done.stdout}{done.stderr}")
    expect(not os.path.exists(picture), "a picture of what has a name")
    sentence = f"{picture} is not written: found the verdict missing_physics, expected unknown"
    expect(sentence in done.stderr, f"nothing says that there is no picture: {done.stderr}")
