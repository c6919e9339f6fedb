#!/usr/bin/env python3
# The verb thesis: its rows stand, a changed config moves one and gives status 1, the page has its pictures.
# tags: long
import json
import pathlib
import shutil
import tempfile

from program import expect, expect_refusal, run

folder = pathlib.Path(tempfile.mkdtemp())

# Tables of parameters and gains as shipped.
done = run("thesis", "--only", "Table 2.1", "--json", "-")
expect(done.returncode == 0, f"Table 2.1: status {done.returncode}: {done.stderr}")
rows = json.loads(done.stdout)["groups"][0]["rows"]
expect([row["verdict"] for row in rows] == ["agrees"] * len(rows), f"Table 2.1: {rows}")

# A config with another mass: its row has moved, and no other of the table.
configs = folder / "config"
shutil.copytree("config", configs)
table = configs / "servo-table-0.5m-4mm.yaml"
text = table.read_text()
expect("mass_kg: 26.0" in text, "the table's mass stands elsewhere now")
table.write_text(text.replace("mass_kg: 26.0", "mass_kg: 27.0"))
done = run("thesis", "--only", "Table 2.1", "--configs", configs)
expect(done.returncode == 1, f"another mass: status {done.returncode}")
moved = [line for line in done.stdout.splitlines() if line.startswith("Table 2.1") and "MOVED" in line]
expect(len(moved) == 1 and "mass m" in moved[0], f"another mass: {done.stdout}")

# What cannot be asked.
expect_refusal(run("thesis", "--only", "Table 9.9"), ["--only", "Table 9.9"], "a place that the thesis lacks")
expect_refusal(run("thesis", "--configs", folder / "none"), ["none", "--configs"], "a folder that is not there")

expect_refusal(run("thesis", "--search", "table", "--figures", "9.9"), ["--figures", "9.9"], "a figure that is none")

# A search for one figure counts that figure alone.
done = run("thesis", "--search", "lines", "--figures", "2.11", "--evaluations", "8")
expect("Fig 2.11" in done.stdout and "Table 2.5" not in done.stdout, f"a search for one figure: {done.stdout}{done.stderr}")

# The page has the pictures of the lines and the rows' reasons.
page = folder / "thesis.html"
done = run("thesis", "--only", "Fig 2.11", "--report", page)
expect(done.returncode == 0, f"the page: status {done.returncode}: {done.stdout}{done.stderr}")
text = page.read_text()
for words in ("Fig 2.12: D 5 mm", "Fig 2.13: L 1 m", "exact theory", "0.005 would ring"):
    expect(words in text, f"the page: '{words}' is not in it")

# Every row, in half a minute of two processors: a law or a config that moves one is to say so.
done = run("thesis", "--report", page)
expect(done.returncode == 0, f"all rows: status {done.returncode}:\n{done.stdout}")
shutil.rmtree(folder)
