#!/usr/bin/env python3
# tools/setup asks for what the pages use after it: apt-get and dpkg-query are played, nothing is installed.
import os
import subprocess
import tempfile

from program import expect

with tempfile.TemporaryDirectory() as folder:
    for name, text in (("dpkg-query", "exit 1"), ("apt-get", f'echo "$@" >> {folder}/asked')):
        path = os.path.join(folder, name)
        with open(path, "w") as file:
            file.write(f"#!/bin/sh\n{text}\n")
        os.chmod(path, 0o755)
    done = subprocess.run(["tools/setup", "--build-only"], capture_output=True, text=True, check=False,
                          env={**os.environ, "PATH": f"{folder}:{os.environ['PATH']}"})
    asked = done.stdout
    if os.path.exists(os.path.join(folder, "asked")):
        with open(os.path.join(folder, "asked")) as file:
            asked += file.read()
    # python3 for tools/plot-run and export, make for a CMake project of one's own without a generator stated.
    for package in ("cmake", "g++", "make", "ninja-build", "python3"):
        expect(package in asked.split(), f"--build-only does not bring {package}: {asked}{done.stderr}")
