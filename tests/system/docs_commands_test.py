#!/usr/bin/env python3
# Runs the shell commands of README.md and docs/first-hour.md in order, in a copy of what they use; checks links between pages.
# A block ```sh whose first line contains "# not run" is left out (it installs or builds, which other tests do).
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

SOURCE = pathlib.Path(__file__).resolve().parents[2]
BUILD = pathlib.Path(sys.argv[1]).resolve()
PAGES = ("README.md", "docs/first-hour.md")
BLOCK = re.compile(r"^```sh\n(.*?)^```$", re.MULTILINE | re.DOTALL)
LINK = re.compile(r"!?\[[^\]]*\]\(([^)#\s]+)[^)]*\)")


def blocks(page):
    """(line, text) of each block that is to be run."""
    text = (SOURCE / page).read_text(encoding="utf-8")
    found = [(text.count("\n", 0, match.start(1)) + 1, match[1]) for match in BLOCK.finditer(text)]
    return [(line, block) for line, block in found if "# not run" not in block.split("\n", 1)[0]]


def copy_of_the_tree(folder):
    """What a reader has after the build: configs, tools, and build/release with the program."""
    for name in ("config", "tools"):
        shutil.copytree(SOURCE / name, folder / name)
    (folder / "build").mkdir()
    (folder / "build" / "release").symlink_to(BUILD, target_is_directory=True)


def run(page):
    found = blocks(page)
    if not found:
        return [f"{page}: no command to run"]
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        copy_of_the_tree(folder)
        script = "set -euo pipefail\n" + "".join(f'printf "%s\\n" "== {page}:{line}" >&2\n{block}' for line, block in found)
        environment = {key: value for key, value in os.environ.items() if key not in ("CXXFLAGS", "CPATH")}
        environment["PATH"] = f"{BUILD}:{environment['PATH']}"
        done = subprocess.run(["bash", "-c", script], cwd=folder, env=environment, stdin=subprocess.DEVNULL,
                              capture_output=True, text=True, timeout=900, check=False)
    if done.returncode == 0:
        print(f"{page}: {len(found)} blocks run")
        return []
    place = re.findall(r"^== (.*)$", done.stderr, re.MULTILINE)[-1]
    return [f"{place}: status {done.returncode}\n{done.stdout[-1500:]}\n{done.stderr[-1500:]}"]


def broken_links():
    pages = [*SOURCE.glob("*.md"), *(SOURCE / "docs").rglob("*.md")]
    return [f"{page.relative_to(SOURCE)}: links to {target}, which is not there" for page in pages
            for target in LINK.findall(page.read_text(encoding="utf-8"))
            if "://" not in target and not (page.parent / target).exists()]


def missing_paths():
    """Paths in code spans of README.md, with * for any name."""
    text = (SOURCE / "README.md").read_text(encoding="utf-8")
    paths = re.findall(r"`((?:include|src|hal|tests|config|docs|cmake)/[\w./*-]+)`", text)
    return [f"README.md: names {path}, which is not there" for path in paths if not list(SOURCE.glob(path))]


def main():
    if not (BUILD / "pneuservo").exists():
        print(f"SKIPPED: {BUILD}/pneuservo is not built")
        return 77
    failures = broken_links() + missing_paths()
    for page in PAGES:
        failures += run(page)
    for failure in failures:
        print("FAILED", failure)
    return 1 if failures else 0


sys.exit(main())
