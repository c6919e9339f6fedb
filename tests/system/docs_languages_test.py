#!/usr/bin/env python3
# The lines of docs for numpy, pandas, MATLAB and Octave: they read what the program records, and it reads what they write.
import csv, gzip, json, os, re, subprocess, sys, tempfile

from program import CONFIG, expect, run

folder = tempfile.mkdtemp()
PYTHON = "/usr/bin/python3"  # the one that Debian's numpy and pandas belong to
NAMES = ("t_s", "x_m", "u_V", "p1_port_Pa", "p2_port_Pa")


def blocks(page, language):
    with open(page) as file:
        return re.findall(f"```{language}\n(.*?)```", file.read(), re.DOTALL)


def in_language(language, text, what):
    command = [PYTHON, "-c", text] if language == "python" else ["octave-cli", "--no-init-file", "--eval", text]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=300)
    expect(done.returncode == 0, f"{what}: {language}: status {done.returncode}: {done.stderr[-600:]}")
    expect("Warning" not in done.stderr, f"{what}: {language} warns: {done.stderr[-600:]}")
    return done.stdout.split()


made = run("run", CONFIG, "--duration-s", "1", "--record", os.path.join(folder, "run.csv.gz"))
expect(made.returncode == 0, f"run: {made.stderr}")
with gzip.open(os.path.join(folder, "run.csv.gz"), "rt") as file:
    rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
true = {name: [float(row[name]) for row in rows] for name in (*NAMES, "x_ref_m")}

# Reading: each way gives the sum of the positions, to a rounding of each.
page = "docs/recording.md"
text_of, with_pandas, with_numpy = blocks(page, "python")
for what, lines in (("pandas", with_pandas), ("numpy", with_numpy)):
    said = in_language("python", text_of + lines + "print(len(run['x_m']), float(sum(run['x_m'])))\n", what)
    expect(int(said[-2]) == len(rows) and abs(float(said[-1]) - sum(true["x_m"])) < 1e-12 * len(rows), f"{what}: {said[-2:]}")
(matlab,) = blocks(page, "matlab")
said = in_language("matlab", matlab + "printf('%d %.17g', numel(recording.x_m), sum(recording.x_m))\n", "MATLAB")
expect(int(said[-2]) == len(rows) and abs(float(said[-1]) - sum(true["x_m"])) < 1e-12 * len(rows), f"MATLAB: {said[-2:]}")
largest = max(abs(a - b) for a, b in zip(true["x_m"], true["x_ref_m"]))
expect(abs(float(said[0]) - largest) < 1e-3 * largest, f"MATLAB: {said[0]} instead of {largest}")

# Writing: what they write is read as it was.
page, log = "docs/your-recording.md", os.path.join(folder, "log.csv")
values = {"t_s": true["t_s"], "x_m": true["x_m"], "u_V": true["u_V"], "p1_Pa": true["p1_port_Pa"], "p2_Pa": true["p2_port_Pa"]}
given = {"python": "import numpy\n" + "".join(f"{name} = numpy.array({column})\n" for name, column in values.items()),
         "matlab": "".join(f"{name} = {column}';\n" for name, column in values.items())}
written = [("python", lines) for lines in blocks(page, "python")] + [("matlab", lines) for lines in blocks(page, "matlab")]
expect(len(written) == 3, f"{page}: {len(written)} ways to write instead of 3")
for language, lines in written:
    script = os.path.join(folder, "script")
    with open(script, "w") as file:
        file.write(given[language] + lines)
    in_language(language, f"exec(open('{script}').read())" if language == "python" else f"source('{script}')", f"{page}: {lines[:40]}")
    seen = json.loads(run("import", log, CONFIG, "--json", "-").stdout)
    expect([column["taken_for"] for column in seen["columns"]] == list(NAMES), f"{lines}: {seen['columns']}")
    expect(seen["runs"][0]["rows"] == len(rows) and seen["doubts"] == [] and seen["understood"] == [], f"{lines}: {seen}")
    with open(log) as file:
        read = list(csv.DictReader(file))
    for name in NAMES:
        worst = max(abs(float(row[name]) - value) for row, value in zip(read, true[name]))
        expect(worst < 1e-8 * max(1, max(map(abs, true[name]))), f"{lines}: {name} is off by {worst}")
    os.remove(log)
