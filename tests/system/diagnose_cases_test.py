#!/usr/bin/env python3
# Runs tools/diagnose-cases on two cases that it records itself: all columns, fewer columns, one recording, bad arguments.
import csv, gzip, json, os, pathlib, re, subprocess, tempfile

from program import CONFIG, expect, program, run

folder = pathlib.Path(tempfile.mkdtemp())
CHAMBERS = ["p1_chamber_Pa", "p2_chamber_Pa"]


def diagnose_cases(out, *arguments):
    return subprocess.run(["tools/diagnose-cases", folder / "cases", folder / out, "--program", program, *arguments],
                          capture_output=True, text=True, timeout=300)


def columns_of(path):
    with gzip.open(path, "rt") as file:
        return next(csv.reader(line for line in file if not line.startswith("#")))


def rows_of(path):
    with gzip.open(path, "rt") as file:
        return list(csv.DictReader(line for line in file if not line.startswith("#")))


for case in ("001", "002"):
    rig = folder / "cases" / f"case-{case}" / "rig.yaml"
    rig.parent.mkdir(parents=True)
    rig.write_bytes(pathlib.Path(CONFIG).read_bytes())
    for number in ("1", "2"):
        done = run("run", str(rig), "--duration-s", "2", "--set", f"seed={case}{number}",
                   "--record", str(rig.parent / f"recording-{number}.csv.gz"))
        expect(done.returncode == 0, f"recording: {done.stderr}")

for arguments, words in ((["--recording", "0"], ["--recording 0", "from 1"]),
                         (["--without", "p3_chamber_Pa"], ["--without p3_chamber_Pa", "expected one of", *CHAMBERS]),
                         (["--only", "007"], ["case-*/rig.yaml"])):
    done = diagnose_cases("refused", *arguments)
    said = done.stderr.strip()
    expect(done.returncode == 2 and len(said.splitlines()) == 1 and all(word in said for word in words),
           f"{arguments}: status {done.returncode}: {said}")
    expect(not (folder / "refused").exists() and done.stdout == "", f"{arguments}: something was written")

done = diagnose_cases("less", "--recording", "2", *[word for column in CHAMBERS for word in ("--without", column)])
expect(done.returncode == 0 and "2 cases, 0 without answer" in done.stdout, f"less data: {done.stdout}{done.stderr}")
for case in ("001", "002"):
    whole = folder / "cases" / f"case-{case}" / "recording-2.csv.gz"
    less = folder / "less" / f"case-{case}-recording-2.csv.gz"
    expect([c for c in columns_of(whole) if c not in CHAMBERS] == columns_of(less), f"columns left: {columns_of(less)}")
    kept = [{name: value for name, value in row.items() if name not in CHAMBERS} for row in rows_of(whole)]
    expect(kept == rows_of(less), "a copy without columns differs in the others")
    expect(not (folder / "less" / f"case-{case}-recording-1.csv.gz").exists(), "recording 1 was taken, too")
    channels = json.loads((folder / "less" / f"case-{case}.json").read_text())["fit"]["channels"]
    expect("p1_port_Pa" in channels and not set(CHAMBERS) & set(channels), f"channels of the answer: {sorted(channels)}")

(folder / "cases" / "case-003").mkdir()
(folder / "cases" / "case-003" / "rig.yaml").write_bytes(pathlib.Path(CONFIG).read_bytes())
done = diagnose_cases("refused")
expect(done.returncode == 2 and re.search(r"case-003: no recording", done.stderr), f"no recording: {done.stderr}")
