#!/usr/bin/env python3
# The verb design on the rigs of config: figures, rules, a config written and designed again, a page that draws itself.
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

from program import CONFIG, expect, expect_refusal, run

TABLE = "config/servo-table-0.5m-4mm.yaml"


def figures(*arguments):
    done = run("design", *arguments, "--json", "-")
    expect(done.returncode == 0, f"{arguments}: status {done.returncode}: {done.stderr}")
    return json.loads(done.stdout)


def near(found, wanted, share=2e-3):
    return abs(found - wanted) <= share * abs(wanted)


def written_config(config, folder, *arguments):
    """A config that design wrote gives the gains it was written with, and no other change when written again."""
    first, second = (os.path.join(folder, name) for name in ("first.yaml", "second.yaml"))
    done = run("design", config, *arguments, "--write", first)
    expect(done.returncode == 0, f"--write: status {done.returncode}: {done.stderr}")
    before, after = figures(config, *arguments), figures(first, "--write", second, "--force")
    expect(all(near(after["gains_config"][key], value, 1e-12) for key, value in before["gains"].items()),
           f"{config}: the written gains are not the designed ones")
    with open(first) as a, open(second) as b:
        text = a.read()
        expect(text == b.read(), f"{config}: a config judged as it is was written another way")
    expect("  # V/m" in text or "  # N/m" in text, "the written config has no comments")


def drawn(page):
    browser = next((path for name in ("chromium", "chromium-browser") if (path := shutil.which(name))), None)
    if browser is None:
        return
    with tempfile.TemporaryDirectory() as profile:
        done = subprocess.run([browser, "--headless", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage",
                               f"--user-data-dir={profile}", "--enable-logging=stderr", "--virtual-time-budget=10000",
                               "--window-size=1400,4000", "--dump-dom", pathlib.Path(page).as_uri()],
                              capture_output=True, text=True, timeout=240)
    ready = re.findall(r'data-ready="(\w+)"', done.stdout)
    expect(len(ready) >= 6 and set(ready) == {"true"}, f"plots that were drawn: {ready}")
    expect("CONSOLE" not in done.stderr, f"the page complains: {done.stderr}")


with tempfile.TemporaryDirectory() as folder:
    page = os.path.join(folder, "design.html")
    cylinder = figures(CONFIG, "--report", page)
    expect(cylinder["stable"] and len(cylinder["models"]) == 3, "the cylinder's design is not complete")
    expect(near(cylinder["margins"]["gain_up"], cylinder["margins_distributed_lines"]["gain_up"], 0.05),
           "the cylinder's linear model has other margins than its distributed lines")
    drawn(page)
    written_config(CONFIG, folder, "--method", "alpha_beta", "--position-gain", "120", "--force")

    if os.path.exists(TABLE):
        table = figures(TABLE)
        for path, wanted in {"gain_m_per_s3V": 45.58, "discharge_ratio": 0.21693}.items():
            expect(near(table[path], wanted), f"{path}: {table[path]}, expected {wanted}")
        expect(near(table["margins"]["gain_up"], 3.897), f"gain margin {table['margins']['gain_up']}")
        expect(table["mean_pressure_needed_Pa"] <= 120e3, "the printed move needs more than 120 kPa")
        written_config(TABLE, folder, "--method", "itae_min")
        done = run("design", TABLE, "--coefficients")
        expect("least" in done.stdout and "-17.5 ± 41.4j" in done.stdout, "the table on the screen lacks a part")

    expect_refusal(run("design", CONFIG, "--method", "alpha_beta", "--position-gain", "1e-6"),
                   [CONFIG, "alpha_beta", "position gain", "up"], "a gain too small for the rule")
    unwritten = os.path.join(folder, "unstable.yaml")
    unstable = ["design", CONFIG, "--set", "controller.force_gain_V_per_N=0.1", "--write", unwritten]
    done = run(*unstable)
    expect(done.returncode == 1 and len(done.stderr.strip().splitlines()) == 1, f"unstable gains: {done.stderr}")
    expect("unstable" in done.stderr and "of this" in done.stderr and "--force" in done.stderr, f"margin: {done.stderr}")
    expect(not os.path.exists(unwritten), "gains of an unstable loop were written")
    expect(run(*unstable, "--force").returncode == 0 and os.path.exists(unwritten), "--force did not write")
    expect_refusal(run("design", os.path.join(folder, "none.yaml")), ["none.yaml", "no such file"], "a missing config")
    expect_refusal(run("design", CONFIG, "--report", os.path.join(folder, "no", "page.html")), ["--report"],
                   "a page in no folder")
    done = run("design", "--help")
    expect(all(word in done.stdout for word in ("alpha_beta", "itae_7", "itae_min", "--write")), "--help lacks a rule")
