#!/usr/bin/env python3
# Runs tools/figures; all nine lines where PNEUSERVO_LONG is set. tags below are read by tests/CMakeLists.txt.
# tags: long
import os
import subprocess
import sys

build = sys.argv[1]
arguments = ["tools/figures", "--build", build]
if not os.environ.get("PNEUSERVO_LONG"):
    arguments.append("--short")
for name, path in (("pneuservo", "pneuservo"), ("test_figures", "tests/test_figures")):
    if not os.access(os.path.join(build, path), os.X_OK):
        print(f"SKIPPED: {name} is not built")
        sys.exit(77)
sys.exit(subprocess.run(arguments).returncode)
