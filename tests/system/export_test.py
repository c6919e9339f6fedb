#!/usr/bin/env python3
# What export says where python3 has no package of this program: one sentence with the remedy.
import os
import tempfile

from program import CONFIG, expect, run

with tempfile.TemporaryDirectory() as folder:
    # A python3 that looks for packages nowhere but in its own library.
    python3 = os.path.join(folder, "python3")
    with open(python3, "w") as file:
        file.write('#!/bin/sh\nexec /usr/bin/python3 -S -I "$@"\n')
    os.chmod(python3, 0o755)
    environment = {**os.environ, "PATH": f"{folder}:{os.environ['PATH']}"}
    done = run("export", CONFIG, "--fmu", os.path.join(folder, "axis.fmu"), env=environment)
    said = done.stderr.strip()
    expect(done.returncode == 1 and len(said.splitlines()) == 1, f"export without the package: status {done.returncode}: {said}")
    for word in ("found no Python package", "expected it in the environment that is active", "pip install '.[files]'", "docs/python.md"):
        expect(word in said, f"{word} is not in: {said}")
