#!/usr/bin/env python3
# Files that no logger should write, to every verb that reads recordings: a result or one sentence, within bounds of memory.
# The cylinder, whose diagnosis takes seconds, is diagnosed from eight drawn files, with PNEUSERVO_LONG=1 from all.
# tags: long
import gzip, math, os, random, resource, struct, subprocess, sys, tempfile

from program import expect, program

SEED = int(os.environ.get("PNEUSERVO_TEST_SEED", random.randrange(1 << 30)))
print(f"seed {SEED} (PNEUSERVO_TEST_SEED)")
draw = random.Random(SEED)
folder = tempfile.mkdtemp()
MOST_MEMORY = 1 << 30  # bytes of addresses, of which the program with its libraries takes a tenth
AXIS = """format: pneuservo-rig/1
name: axis
rig: driven_axis
period_s: 0.001
slider: {mass_kg: 20.0, viscous_friction_Ns_per_m: 150.0, stroke_m: 0.6, force_max_N: 400.0}
sensors: {position: {quantum_m: 1.0e-7, noise_m: 1.0e-7}, force: {quantum_N: 0.0, noise_N: 0.1}}
controller: {kind: pd_force, position_gain_N_per_m: 100000.0, velocity_gain_Ns_per_m: 2000.0, velocity_filter_s: 0.001}
reference: {kind: sine, amplitude_m: 0.12, frequency_Hz: 0.8}
tolerances: {slider.mass_kg: 0.001, slider.viscous_friction_Ns_per_m: 0.01}
"""
CYLINDER = "config/cylinder-2m-6.10mm.yaml"
COLUMNS = ("t_s", "x_m", "F_N", "u_V", "p1_port_Pa", "p2_port_Pa")


def path_of(name):
    return os.path.join(folder, name)


def put(name, content):
    with open(path_of(name), "wb") as file:
        file.write(content if isinstance(content, bytes) else content.encode())
    return path_of(name)


def motion(count=800, interval_s=0.002):
    out = []
    for i in range(count):
        t = i * interval_s
        out.append([t, 0.1 * math.sin(5 * t), 20 * math.cos(5 * t) + draw.gauss(0, 0.1), 0.5 * math.cos(5 * t),
                    4e5 + 5e4 * math.sin(5 * t) + draw.gauss(0, 300), 4e5 - 5e4 * math.sin(5 * t) + draw.gauss(0, 300)])
    return out


def table(rows, names=COLUMNS):
    return ",".join(names) + "\n" + "".join(",".join(v if isinstance(v, str) else repr(v) for v in row) + "\n" for row in rows)


def with_column(change, column=None):
    """The motion with every column but the time changed, or one alone: change(row, value)."""
    rows = motion()
    for i, row in enumerate(rows):
        for c in range(len(row)) if column is not None else range(1, len(row)):
            if column is None or c == column:
                row[c] = change(i, row[c])
    return table(rows)


def spoiled(text):
    """Some bytes of it drawn anew."""
    data = bytearray(text.encode())
    for _ in range(draw.randrange(1, 200)):
        data[draw.randrange(len(data))] = draw.randrange(256)
    return bytes(data)


def shuffled():
    rows = motion()
    draw.shuffle(rows)
    return table(rows)


whole = table(motion())
OWN = "# format: pneuservo-recording/1\n# rig: axis\n# period_s: 0.002\n"
HUGE = 10.0 ** draw.uniform(150, 308)
odd = {
    "empty": "", "blank": "\n\n \n", "zeros": bytes(5000), "names-alone": table([]), "one-row": table(motion(1)),
    "two-rows": table(motion(2)), "twenty-rows": table(motion(20)), "one-column": table([row[:1] for row in motion()], COLUMNS[:1]),
    "values-alone": table([row[1:2] for row in motion()], COLUMNS[1:2]), "no-name": whole.split("\n", 1)[1],
    "all-nan": with_column(lambda i, v: "nan"), "all-inf": with_column(lambda i, v: "inf"), "all-empty": with_column(lambda i, v: ""),
    "text": with_column(lambda i, v: "error"), "constant": with_column(lambda i, v: 1.0), "all-zero": with_column(lambda i, v: 0.0),
    "huge": with_column(lambda i, v: HUGE * draw.uniform(-1, 1)), "tiny": with_column(lambda i, v: 1e-300 * draw.uniform(-1, 1)),
    "half-huge": with_column(lambda i, v: HUGE if i % 2 else v), "drawn": with_column(lambda i, v: draw.uniform(-1, 1)),
    "times-nan": with_column(lambda i, v: "nan", 0), "times-constant": with_column(lambda i, v: 1.0, 0),
    "times-reversed": with_column(lambda i, v: 10 - v, 0), "times-huge": with_column(lambda i, v: 1e300 * (1 + i), 0),
    "times-tiny": with_column(lambda i, v: 1e-300 * i, 0), "times-negative": with_column(lambda i, v: v - 1e6, 0),
    "times-drawn": with_column(lambda i, v: draw.uniform(0, 1e12), 0), "times-rising": with_column(lambda i, v: math.exp(0.05 * i), 0),
    "times-fine-then-coarse": with_column(lambda i, v: 1e-9 * i if i < 700 else 10.0 * i, 0),
    "times-2^31-apart": with_column(lambda i, v: 2.0**31 * i, 0), "times-jump-2^31": with_column(lambda i, v: v + (2**31 if i > 600 else 0), 0),
    "times-one-far": with_column(lambda i, v: 1e15 if i == 600 else v, 0), "times-pairs": with_column(lambda i, v: i // 2 + 1e-9 * (i % 2), 0),
    "times-shuffled": shuffled(), "every-row-a-run": with_column(lambda i, v: 0.002 * (i % 5), 0),
    "x-nan": with_column(lambda i, v: "nan", 1), "x-huge": with_column(lambda i, v: 1e200 if i % 7 == 0 else v, 1),
    "u-nan": with_column(lambda i, v: "nan", 3), "p-nan": with_column(lambda i, v: "nan", 4), "p-zero": with_column(lambda i, v: 0.0, 4),
    "x-sparse": with_column(lambda i, v: v if i % 100 == 0 else "", 1), "p-one": with_column(lambda i, v: v if i == 600 else "", 4),
    "claims-2^31-rows": "# format: pneuservo-recording/1\n# rig: axis\n# period_s: 1e-12\n# rows: 2147483648\n# moves: 2147483647\n" + whole,
    "claims-a-period": OWN.replace("0.002", "1e300") + whole, "claims-a-negative-period": OWN.replace("0.002", "-1") + whole,
    "claims-yaml": "# format: pneuservo-recording/1\n# rig: {a: [b, *c]}\n# period_s: [1]\n" + whole, "own": OWN + whole,
    "binary": bytes(draw.randrange(256) for _ in range(100000)), "mat": b"MATLAB 5.0 MAT-file, Platform: GLNXA64".ljust(124) + b"\0\1IM" + os.urandom(2000),
    "hdf5": b"\x89HDF\r\n\x1a\n" + bytes(2000), "zip": b"PK\3\4" + bytes(range(256)) * 8, "parquet": b"PAR1" + bytes(500) + b"PAR1",
    "long-line": "t_s,x_m\n" + "1," * 200000 + "1\n", "one-long-field": "t_s,x_m\n0," + "9" * 300000 + "\n1,2\n",
    "many-names": ",".join(f"c{i}" for i in range(3000)) + "\n" + (",".join("1" for _ in range(3000)) + "\n") * 3,
    "name-twice": "t_s,x_m,x_m\n0,1,2\n", "quotes-open": 't_s,"x_m\n0,1\n1,2\n', "utf-16-odd": b"\xff\xfe" + whole.encode("utf-16-le")[:-1],
    "cut": whole[:-7], "semicolons-mixed": whole.replace(",", ";", 500), "header-again": whole + whole,
    "gzip-cut": gzip.compress(whole.encode())[:-900], "gzip-spoiled": gzip.compress(whole.encode())[:300] + os.urandom(3000),
    "gzip-of-gzip": gzip.compress(gzip.compress(whole.encode())),
}
for i in range(4):
    odd[f"spoiled-{i}"] = spoiled(whole)


def bounded():
    resource.setrlimit(resource.RLIMIT_AS, (MOST_MEMORY, MOST_MEMORY))


def try_file(name, path, *arguments):
    done = subprocess.run([program, *arguments], capture_output=True, text=True, errors="replace", timeout=300, preexec_fn=bounded)
    what = f"{name}: {' '.join(os.path.basename(a) for a in arguments)}"
    expect(done.returncode in (0, 1, 2), f"{what}: status {done.returncode}: {done.stderr[-400:]}")
    said = done.stderr.strip().splitlines()
    if done.returncode == 2:
        expect(done.stdout == "" and said[-1].startswith("pneuservo: ") and (os.path.basename(path) in said[-1] or " axis: " in said[-1]), f"{what}: no sentence: {done.stderr[-400:]}")
    expect(done.returncode != 1 or arguments[0] == "replay", f"{what}: status 1: {done.stderr[-400:]}")
    for word in ("bad_alloc", "std::", "vector", "parameter:", "stod"):
        expect(word not in done.stderr, f"{what}: says {word}: {done.stderr[-400:]}")
    return done


read = set()


def is_read_as_before(path, rig):
    """Whether the cylinder has had these channels, times and doubts from another file."""
    done = subprocess.run([program, "import", path, rig, "--json", "-"], capture_output=True, text=True, errors="replace")
    understood = done.stdout.replace(path, "")
    seen = understood in read
    read.add(understood)
    return seen and done.returncode == 0


# What each verb makes of files whose use is known: 0 with a result, 2 with a sentence.
WANTED = {"whole": 0, "own": 0, "cut": 0, "empty": 2, "blank": 2, "zeros": 2, "names-alone": 2, "one-row": 2, "all-nan": 2, "all-empty": 2,
          "text": 2, "hdf5": 2, "parquet": 2, "zip": 2, "binary": 2, "constant": 2}
odd["whole"] = whole
of_cylinder = list(odd) if os.environ.get("PNEUSERVO_LONG") == "1" else draw.sample(list(odd), 8)
axis = put("axis.yaml", AXIS)
for name, content in odd.items():
    path = put(f"{name}.csv", content)
    try_file(name, path, "import", path)
    for rig in (axis, CYLINDER):
        try_file(name, path, "import", path, rig, "--report", path_of("page.html"))
        if rig == CYLINDER and (name not in of_cylinder or is_read_as_before(path, rig)):
            continue
        done = try_file(name, path, "diagnose", rig, path, "--quiet")
        if rig == axis and name in WANTED:
            expect(done.returncode == WANTED[name], f"{name}: status {done.returncode}, expected {WANTED[name]}: {done.stdout}{done.stderr}")
            expect(done.returncode == 2 or "The model" in done.stdout or "Model and" in done.stdout or "missing" in done.stdout,
                   f"{name}: no verdict: {done.stdout}")
    try_file(name, path, "replay", CYLINDER, path)
    try_file(name, path, "simulate", CYLINDER, "--command", path)
for name in (folder, "/dev/null"):
    try_file(name, name, "import", name)
    try_file(name, name, "diagnose", axis, name, "--quiet")
