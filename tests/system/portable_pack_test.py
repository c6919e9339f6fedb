#!/usr/bin/env python3
# The estimator gives the same bits with the instructions of x86 and with the portable operations.

import secrets
import subprocess
import sys
from pathlib import Path

programs = [Path(sys.argv[1]) / "tests" / f"estimator_hash_{way}" for way in ("native", "portable")]
for seed in [1] + [secrets.randbelow(1 << 32) for _ in range(3)]:
    hashes = [subprocess.run([program, str(seed)], check=True, capture_output=True, text=True).stdout.strip()
              for program in programs]
    if len(hashes[0]) != 16 or hashes[0] != hashes[1]:
        sys.exit(f"seed {seed}: found the hashes {hashes} of the two ways, expected the same one")
    print(f"seed {seed}: {hashes[0]}")
