#!/usr/bin/env python3
# Opens the pages of `run` and `diagnose` in headless Chromium: every plot is drawn, no message on the console, nothing from outside.
import html.parser
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

build = pathlib.Path(sys.argv[1])
browser = next((path for name in ("chromium", "chromium-browser", "google-chrome") if (path := shutil.which(name))), None)
if browser is None:
    print("SKIPPED: no chromium to open the page with")
    sys.exit(77)
generators = {name: build / "tests" / f"make_sample_{name}" for name in ("report", "diagnosis")}
for generator in generators.values():
    if not generator.exists():
        print(f"SKIPPED: {generator} is not built")
        sys.exit(77)


class Page(html.parser.HTMLParser):
    """Collects the plots, their canvases and legends, and every attribute that could load something."""

    def __init__(self):
        super().__init__()
        self.plots, self.loads, self.title, self.tag = [], [], "", ""

    def handle_starttag(self, tag, attributes):
        attributes = dict(attributes)
        self.tag = tag
        self.loads += [f"{tag} {key}={value}" for key, value in attributes.items() if key in ("src", "href", "data", "srcset")]
        if tag == "figure" and "plot" in attributes.get("class", ""):
            self.plots.append({"attributes": attributes, "canvases": 0, "entries": 0})
        elif tag == "canvas" and self.plots:
            self.plots[-1]["canvases"] += 1
        elif tag == "button" and self.plots and "aria-pressed" in attributes and "data-panel" not in attributes:
            self.plots[-1]["entries"] += 1

    def handle_endtag(self, tag):
        self.tag = ""

    def handle_data(self, data):
        if self.tag == "title":
            self.title += data


def open_page(path, profile):
    command = [browser, "--headless", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--no-first-run",
               f"--user-data-dir={profile}", "--enable-logging=stderr", "--virtual-time-budget=10000",
               "--window-size=1400,2600", "--dump-dom", path.as_uri()]
    return subprocess.run(command, capture_output=True, text=True, timeout=240)


def check(condition, message):
    if not condition:
        print("FAILED:", message)
        sys.exit(1)


def check_page(kind, plots_expected, folder, title="sample <10 m"):
    path = folder / f"{kind}.html"
    command = [generators["diagnosis"], path] if kind == "diagnosis" else [generators["report"], path, kind]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    text = path.read_text(encoding="utf-8")
    check(path.stat().st_size < 3_000_000, f"{kind}: the page has {path.stat().st_size} bytes")
    written = Page()
    written.feed(text)
    check(not written.loads, f"{kind}: the page loads {written.loads}")
    check(not re.search(r"url\(|@import|sourceMappingURL", text), f"{kind}: the page refers to another file")

    shown = open_page(path, folder / "profile")
    console = [line for line in shown.stderr.splitlines() if "CONSOLE" in line]
    check(shown.returncode == 0, f"{kind}: the browser ended with {shown.returncode}: {shown.stderr[-500:]}")
    check(not console, f"{kind}: messages on the console: {console}")
    page = Page()
    page.feed(shown.stdout)
    check(page.title.startswith(title), f"{kind}: the title is {page.title!r}")
    check(len(page.plots) == plots_expected, f"{kind}: {len(page.plots)} plots, expected {plots_expected}")
    for plot in page.plots:
        attributes = plot["attributes"]
        check(attributes.get("data-ready") == "true", f"{kind}: {attributes['id']} is not drawn")
        check(int(attributes.get("data-points", 0)) > 30, f"{kind}: {attributes['id']} has hardly any data")
        check(plot["canvases"] >= 2, f"{kind}: {attributes['id']} has no canvas")
        check(plot["entries"] >= 1, f"{kind}: {attributes['id']} has no legend")
    print(f"{kind}: {len(page.plots)} plots drawn, {path.stat().st_size} bytes")


with tempfile.TemporaryDirectory() as name:
    check_page("simulated", 3 + 3 * 4, pathlib.Path(name))
    check_page("real", 3 + 4 + 1, pathlib.Path(name))
    check_page("diagnosis", 2 + 3, pathlib.Path(name), "sample <axis>")  # course and difference, residual against three
