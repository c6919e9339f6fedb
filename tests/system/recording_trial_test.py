#!/usr/bin/env python3
# Runs tools/recording-trial small: one machine in two other loggers' ways, with every mistake of units and wiring, and right.
import os, subprocess, sys, tempfile

from program import expect, program

SEED = int(os.environ.get("PNEUSERVO_TEST_SEED", 9))
print(f"seed {SEED} (PNEUSERVO_TEST_SEED)")
folder = tempfile.mkdtemp()


def trial(kind, *arguments):
    done = subprocess.run(["tools/recording-trial", os.path.join(folder, kind), "--kind", kind, "--count", "1", "--program", program,
                           *arguments], capture_output=True, text=True, timeout=1100)
    expect(done.returncode in (0, 1), f"{kind}: status {done.returncode}: {done.stderr}")
    return done.stdout


said = trial("mistakes", "--seed", str(SEED))
right, _, all_of_them = said.splitlines()[-1].removeprefix("mistakes: ").removesuffix(" right").split()
expect(int(all_of_them) >= 14 and int(right) == int(all_of_them), f"mistakes, seed {SEED}: {said}")
said = trial("right", "--seed", str(SEED))
right, _, all_of_them = said.splitlines()[-1].removeprefix("right: ").removesuffix(" right").split()
expect(int(all_of_them) >= 11 and right == all_of_them, f"right, seed {SEED}: {said}")
# A machine whose name is sure, so that another draw of what is lost cannot leave it open.
said = trial("variants", "--first", "104", "--effects", "valve_dead_band", "--rigs", "config/cylinder-2m-6.10mm.yaml",
             "--only", "second-row", "gap")
expect("variants: 2 of 2 right" in said, f"variants: {said}")
done = subprocess.run(["tools/recording-trial", folder, "--only", "nothing", "--program", program], capture_output=True, text=True)
expect(done.returncode == 2 and "expected one of whole" in done.stderr, f"an unknown variant: {done.stderr}")
sys.exit(0)
