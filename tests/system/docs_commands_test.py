#!/usr/bin/env python3
# Runs the shell commands of README.md and some pages of docs in order, in a copy of what they use; checks links, paths and options.
"""usage: tests/system/docs_commands_test.py BUILD [--write]

A block ```sh right behind the line <!-- not run by the test --> is left out (it installs or builds, which other tests do).
A block ```text right behind one must be the last lines that it prints. README's picture must be the one that its commands
draw. --write makes both so, and renews docs/config-keys.md: after a change of the model, look at what it changed and commit it.
Exit status: 0 all well; 1 a command failed, an output differs or a link is broken; 77 the program is not built.
"""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

SOURCE = pathlib.Path(__file__).resolve().parents[2]
BUILD = pathlib.Path(sys.argv[1]).resolve()
WRITE = "--write" in sys.argv[2:]
PAGES = ("README.md", "docs/first-hour.md", "docs/your-axis.md", "docs/pressure.md", "docs/estimator.md")
PICTURE = SOURCE / "docs/images/cylinder-10m-6.10mm.svg"  # README.md draws it as run.svg
KEYS = SOURCE / "docs/config-keys.md"
MARK = "<!-- not run by the test -->\n"
BLOCK = re.compile(rf"^(?P<mark>{MARK})?```sh\n(?P<code>.*?)^```\n(?:\n```text\n(?P<output>.*?)^```$)?", re.MULTILINE | re.DOTALL)
LINK = re.compile(r"!?\[[^\]]*\]\(([^)#\s]*)(?:#([^)\s]+))?[^)]*\)")
HEADING = re.compile(r"^#+ +(.+?) *$", re.MULTILINE)


def blocks(text):
    """Matches of the blocks that are to be run."""
    return [match for match in BLOCK.finditer(text) if not match["mark"]]


def unread_marks():
    """A reader takes "# not run" in a block for a warning: the mark stands above the block, where no page shows it."""
    return [f"{page.relative_to(SOURCE)}: found '# not run' in a block, expected {MARK.strip()} on the line above it"
            for page in [SOURCE / "README.md", *(SOURCE / "docs").rglob("*.md")]
            if re.search(r"^```sh\n# not run", page.read_text(encoding="utf-8"), re.MULTILINE)]


def copy_of_the_tree(folder):
    """What a reader has after the build: configs, tools, and build/release with the program."""
    for name in ("config", "tools"):
        shutil.copytree(SOURCE / name, folder / name)
    (folder / "build").mkdir()
    (folder / "build" / "release").symlink_to(BUILD, target_is_directory=True)


def run_in_order(page, found, folder):
    """Outputs of the blocks, one after the other in one shell; and a sentence where one failed."""
    marks = [f"== {page}, block {i + 1}" for i in range(len(found))]
    script = "set -euo pipefail\n" + "".join(
        f'printf "%s\\n" "{mark}" | tee /dev/stderr\n{block["code"]}' for mark, block in zip(marks, found))
    environment = {key: value for key, value in os.environ.items() if key not in ("CXXFLAGS", "CPATH")}
    environment["PATH"] = f"{BUILD}:{environment['PATH']}"
    done = subprocess.run(["bash", "-c", script], cwd=folder, env=environment, stdin=subprocess.DEVNULL,
                          capture_output=True, text=True, timeout=900, check=False)
    outputs = re.split(r"^== .*, block \d+\n", done.stdout, flags=re.MULTILINE)[1:]
    if done.returncode == 0:
        return outputs, None
    place = re.findall(r"^== (.*)$", done.stderr, re.MULTILINE)[-1]
    return outputs, f"{place}: status {done.returncode}\n{done.stdout[-1500:]}\n{done.stderr[-1500:]}"


def last_lines(output, like):
    return "".join(output.splitlines(keepends=True)[-like.count("\n"):])


def run_page(page):
    path = SOURCE / page
    text = path.read_text(encoding="utf-8")
    found = blocks(text)
    if not found:
        return [f"{page}: no command to run"]
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        copy_of_the_tree(folder)
        outputs, failure = run_in_order(page, found, folder)
        if failure:
            return [failure]
        failures, renewed = [], text
        if page == "README.md" and (folder / "run.svg").read_bytes() != PICTURE.read_bytes():
            failures.append(f"{PICTURE.relative_to(SOURCE)} is not what the commands of {page} draw now; "
                            "tests/system/docs_commands_test.py BUILD --write renews it")
            if WRITE:
                shutil.copyfile(folder / "run.svg", PICTURE)
    for block, output in reversed(list(zip(found, outputs))):
        printed = last_lines(output, block["output"]) if block["output"] else None
        if printed == block["output"]:
            continue
        renewed = renewed[:block.start("output")] + printed + renewed[block.end("output"):]
        line = text.count("\n", 0, block.start("output")) + 1
        failures.append(f"{page}:{line}: the text is not what the command prints now:\n{printed}"
                        "tests/system/docs_commands_test.py BUILD --write renews it")
    if WRITE:
        path.write_text(renewed, encoding="utf-8")
        failures = []
    print(f"{page}: {len(found)} blocks run")
    return failures


def anchors(page):
    """As GitHub makes them of headings: small letters, blanks to hyphens, links and punctuation dropped."""
    text = re.sub(r"^```.*?^```", "", page.read_text(encoding="utf-8"), flags=re.MULTILINE | re.DOTALL)
    out = set(re.findall(r'<a (?:id|name)="([^"]+)"', text))
    for heading in HEADING.findall(text):
        words = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading).lower()
        out.add(re.sub(r"[^\w\- ]", "", words).replace(" ", "-"))
    return out


def broken_links():
    broken = []
    for page in [*SOURCE.glob("*.md"), *(SOURCE / "docs").rglob("*.md")]:
        for target, anchor in LINK.findall(page.read_text(encoding="utf-8")):
            aim = page.parent / target if target else page
            if "://" in target:
                continue
            if not aim.exists():
                broken.append(f"{page.relative_to(SOURCE)}: links to {target}, which is not there")
            elif anchor and aim.suffix == ".md" and anchor not in anchors(aim):
                broken.append(f"{page.relative_to(SOURCE)}: links to {target}#{anchor}, a heading that is not there")
    return broken


def missing_paths():
    """Paths in code spans of README.md and docs/equations.md, with * for any name."""
    missing = []
    for page in ("README.md", "docs/equations.md"):
        text = (SOURCE / page).read_text(encoding="utf-8")
        paths = re.findall(r"`((?:include|src|hal|tests|config|docs|cmake)/[\w./*-]+)`", text)
        missing += [f"{page}: names {path}, which is not there" for path in paths if not list(SOURCE.glob(path))]
    return missing


def help_of(*command):
    done = subprocess.run([*command, "--help"], cwd=SOURCE, capture_output=True, text=True, timeout=60, check=False)
    return done.stdout if done.returncode == 0 else None


def unknown_options():
    """Verbs, tools and their options in all pages, against what --help of each says."""
    helps = {f"tools/{tool.name}": help_of(tool) for tool in sorted((SOURCE / "tools").iterdir()) if tool.is_file() and os.access(tool, os.X_OK)}
    wrong = [f"{tool} --help does not print its usage" for tool, text in helps.items() if not text]
    verbs = re.findall(r"^  ([a-z-]+) ", help_of(BUILD / "pneuservo").split("A new axis:")[1].split("Start here:")[0], re.MULTILINE)
    helps |= {f"pneuservo {verb}": help_of(BUILD / "pneuservo", verb) for verb in verbs}
    for page in [*SOURCE.glob("*.md"), *(SOURCE / "docs").rglob("*.md")]:
        for number, line in enumerate(page.read_text(encoding="utf-8").splitlines(), 1):
            for name, rest in re.findall(r"(?:(?<=`)|(?<=^)|(?<= ))(?:build/release/)?(pneuservo [a-z-]+|tools/[\w-]+)\b([^`|;&\n]*)", line):
                if name not in helps:
                    known = name.startswith("tools/") and any((SOURCE / "tools").glob(name[6:] + "*"))
                    wrong += [] if known or not rest.startswith(" --") else [f"{page.relative_to(SOURCE)}:{number}: {name} is not there"]
                    continue
                wrong += [f"{page.relative_to(SOURCE)}:{number}: {name} has no option {option}" for option in re.findall(r"(?<![\w-])--[a-z][\w-]*", rest)
                          if not re.search(re.escape(option) + r"(?![\w-])", helps[name] or option)]
    return wrong


def main():
    if not (BUILD / "pneuservo").exists():
        print(f"SKIPPED: {BUILD}/pneuservo is not built")
        return 77
    keys = subprocess.run([BUILD / "pneuservo", "keys", "--markdown"], capture_output=True, check=True).stdout
    if WRITE:
        KEYS.write_bytes(keys)
    failures = [] if keys == KEYS.read_bytes() else ["docs/config-keys.md is not the output of pneuservo keys --markdown"]
    failures += [failure for page in PAGES for failure in run_page(page)] + unread_marks() + broken_links() + missing_paths() + unknown_options()
    for failure in failures:
        print("FAILED", failure)
    return 1 if failures else 0


sys.exit(main())
