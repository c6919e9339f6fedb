# A case: draws rig, machine and secret, tunes the user's loop, records, writes the owner's files and seals the truth.
"""A case depends on seed and number alone. OUT/case-NNN holds what the owner has, OUT/sealed/case-NNN.json the truth, and
OUT/commitments.txt the truth's SHA-256, written before anything is diagnosed."""
import copy
import functools
import gzip
import hashlib
import json
import math
import operator
import random
import secrets
import subprocess

import yaml

import concealed
import rigs

FIRST_S, LENGTH_S, RECORDINGS = 4.0, 6.0, 2
# Shares of the kinds in a block of 21: 100 clean, 120 single, 40 pairs, 40 parameters, 20 sensors, 20 mounting, 80 outside of 420.
BLOCK = ["clean"] * 5 + ["single"] * 6 + ["pair"] * 2 + ["parameter"] * 2 + ["sensor", "mounting"] + ["outside"] * 4
COLUMNS = ["t_s", "x_ref_m", "x_m", "u_V", "p1_port_Pa", "p2_port_Pa"]


def get(tree, path):
    return functools.reduce(operator.getitem, path.split("."), tree)


def put(tree, path, value):
    way, _, last = path.rpartition(".")
    (get(tree, way) if way else tree)[last] = value


def kind_of(seed, number):
    block = list(BLOCK)
    random.Random(f"block {seed} {number // len(BLOCK)}").shuffle(block)
    return block[number % len(BLOCK)]


def simulate(machine, lines):
    """Rows of the machine's recording, as dictionaries of numbers."""
    text = "".join(f"{key} {one}\n" for key, value in lines.items() for one in (value if isinstance(value, list) else [value]))
    done = subprocess.run([str(machine)], input=text, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise RuntimeError(f"{machine}: {done.stderr.strip()}")
    names, *rows = done.stdout.splitlines()
    names = names.split(",")
    return [dict(zip(names, map(float, row.split(",")))) for row in rows]


def rms(values):
    values = list(values)
    return math.sqrt(sum(v * v for v in values) / len(values)) if values else 0.0


def is_sensible(rows, rig):
    """Whether a user would be content: quiet at rest, on its way, seldom at the valve's end, and numbers at all."""
    if not all(math.isfinite(v) for row in rows[-3:] for v in row.values()):
        return False
    span, rest = rig["valve"]["command_max_V"], rows[:int(0.3 / rig["period_s"])]
    middle = sum(r["u_V"] for r in rest) / len(rest)
    mean = sum(r["x_ref_m"] for r in rows) / len(rows)
    swing = rms(r["x_ref_m"] - mean for r in rows)
    off = [r["x_ref_m"] - r["x_m"] for r in rows]
    bias = sum(off) / len(off)
    quiet = rms(r["u_V"] - middle for r in rest) < 0.05 * span and max(r["x_m"] for r in rest) - min(r["x_m"] for r in rest) < 1e-3
    ends = sum(abs(r["u_V"]) > 0.98 * span for r in rows) < 0.1 * len(rows)
    inside = max(abs(r["x_m"]) for r in rows) < 0.49 * rig["cylinder"]["stroke_m"]
    return quiet and ends and inside and rms(v - bias for v in off) < 0.7 * swing


def tuned(machine, rig, reference):
    """Gains with which the owner's machine, as believed, moves sensibly: first the rule's, then softer ones."""
    gains = rigs.loop_gains(rig)
    for force, position in ((1, 1), (1, 0.5), (0.4, 1), (0.4, 0.5), (0.15, 0.6)):
        softer = gains | {"force_gain_V_per_N": gains["force_gain_V_per_N"] * force}
        for key in ("position_gain_N_per_m", "velocity_gain_Ns_per_m"):
            softer[key] = gains[key] * position
        lines = rigs.machine_lines(rig, softer) | rigs.move_lines(reference) | {"first": 2.5, "length": 3.0}
        if is_sensible(simulate(machine, lines), rig):
            return {key: rigs.rounded(value) for key, value in softer.items()}
    return None


def draw_rig(rng, machine, name, length_s):
    """An owner's rig whose loop works, with its moves."""
    while True:
        rig = rigs.owners_rig(rng, name)
        moves = [rigs.move(rng, rig, length_s) for _ in range(RECORDINGS)]
        gains = tuned(machine, rig, moves[0])
        if gains:
            return rig, moves, gains


def true_machine(rng, rig):
    """Every number under `tolerances` drawn anew: normal, cut at two standard deviations."""
    true_rig = copy.deepcopy(rig)
    for path, tolerance in rig["tolerances"].items():
        z = rng.gauss(0, 1)
        while abs(z) > 2:
            z = rng.gauss(0, 1)
        put(true_rig, path, rigs.rounded(get(rig, path) * (1 + tolerance * z), 7))
    return true_rig


def believed(rig, gains):
    """Lines of the loop, which goes by what its owner believes, not by what is true."""
    lines = rigs.machine_lines(rig, gains)
    return {"loop.area_1": lines["side_1.piston"], "loop.area_2": lines["side_2.piston"], "loop.bias": lines["loop.bias"]}


def conceal(rng, kind, rig, true_rig, gains, vocabulary, options):
    """Lines of the machine without and with its secret, and the truth."""
    plain_rig = copy.deepcopy(true_rig)
    truth = {"verdict": "consistent", "elements": ["none"]}
    if kind == "parameter":
        truth = concealed.parameter(rng, rig, true_rig, get, put)
    plain = rigs.machine_lines(plain_rig, gains)
    with_background = {"draw": rng.random() < 0.75, "yes": True, "no": False}[options.background]
    small, fair = {}, []
    if with_background:
        small = dict(plain)
        fair = concealed.background(rng, rig, small)
        small = {key: value for key, value in small.items() if value != plain.get(key)}
    lines = rigs.machine_lines(true_rig, gains)
    friction = lines["motion.forward"]
    lines |= small
    plain |= small
    if with_background and "coulomb_friction" in rig["effects"]:  # a wrong friction is wrong before it slides, too
        lines["motion.bristle"] = friction
    known, sized = vocabulary
    if kind in ("single", "pair"):
        truth = getattr(concealed, kind)(rng, rig, lines, known, sized)
    elif kind == "sensor":
        truth = concealed.sensor(rng, lines)
    elif kind == "mounting":
        truth = concealed.mounting(rng)
    elif kind == "outside":
        truth = concealed.outside(rng, rig, lines, options.length_s, known)
    return plain | believed(rig, gains), lines | believed(rig, gains), truth | {"kind": kind, "background": with_background, "fair": fair, "background_lines": small}


def as_logged(rows, mounting):
    for row in rows:
        if mounting == "ports exchanged":
            row["p1_port_Pa"], row["p2_port_Pa"] = row["p2_port_Pa"], row["p1_port_Pa"]
        elif mounting == "command reversed":
            row["u_V"] = -row["u_V"]
        elif mounting == "position reversed":
            row["x_m"] = -row["x_m"]
    return rows


def visible(with_it, without_it, rig):
    """How far the secret moves command and ports in the same move: rms over what the same machine's noise moves them."""
    floor_Pa = math.hypot(rig["sensors"]["port_pressure"]["noise_Pa"], rig["sensors"]["port_pressure"]["quantum_Pa"] / math.sqrt(12))
    return max(rms(a[c] - b[c] for a, b in zip(with_it, without_it)) / floor_Pa for c in ("p1_port_Pa", "p2_port_Pa"))


def write_recording(path, rig, reference, rows):
    """`reference` is left out where the logger's sides are not the loop's."""
    columns = [c for c in COLUMNS if reference or c != "x_ref_m"]
    columns += ["p1_chamber_Pa", "p2_chamber_Pa"] if "chamber_pressure" in rig["sensors"] else []
    columns += ["p_supply_Pa"] if "supply_pressure" in rig["sensors"] else []
    flow = yaml.safe_dump(reference, default_flow_style=True, width=10**6, sort_keys=False).strip() if reference else ""
    with gzip.open(path, "wt", encoding="utf-8") as file:
        file.write(f"# format: pneuservo-recording/1\n# rig: {rig['name']}\n# period_s: {rig['period_s']}\n" + (f"# reference: {flow}\n" if flow else ""))
        file.write(",".join(columns) + "\n")
        file.writelines(",".join(f"{row[c]:.9g}" for c in columns) + "\n" for row in rows)


def owners_config(rig, gains, reference, length_s):
    source = "chamber" if "chamber_pressure" in rig["sensors"] else "valve"
    return rig | {"controller": {"kind": "pd_force", "pressure_source": source, **gains}, "reference": reference, "duration_s": length_s}


def make_case(number, options, vocabulary_of):
    """Writes the case unless it is there; the name of its folder."""
    name = f"case-{number:03d}"
    folder, sealed = options.out / name, options.out / "sealed" / f"{name}.json"
    if sealed.is_file():
        return name
    folder.mkdir(parents=True, exist_ok=True)
    sealed.parent.mkdir(exist_ok=True)
    kind = options.kind or kind_of(options.seed, number)
    rng = random.Random(f"case {options.seed} {number} {kind}")
    while True:
        rig, moves, gains = draw_rig(rng, options.machine, name, options.length_s)
        true_rig = true_machine(rng, rig)
        config = owners_config(rig, gains, moves[0], options.length_s)
        plain, lines, truth = conceal(rng, kind, rig, true_rig, gains, vocabulary_of(config), options)
        seed = rng.randrange(1, 2**31)
        recordings, shows = [], []
        for i, reference in enumerate(moves):
            run = rigs.move_lines(reference) | {"first": FIRST_S, "length": options.length_s, "seed": seed + i}
            recordings.append(simulate(options.machine, lines | run))
            shows.append(visible(recordings[-1], simulate(options.machine, plain | run), rig))
        # What the vocabulary has no law for has to show at all: nobody could find a relief valve that never opens.
        if all(is_sensible(rows, rig) for rows in recordings) and (kind != "outside" or max(shows) > 3.0):
            break
    truth |= {"true_rig": true_rig, "lines": {k: v for k, v in lines.items() if v != plain.get(k)}, "visible": rigs.rounded(max(shows)), "salt": secrets.token_hex(16)}
    (folder / "rig.yaml").write_text(yaml.safe_dump(config, sort_keys=False), encoding="utf-8")
    for i, rows in enumerate(recordings):
        write_recording(folder / f"recording-{i + 1}.csv.gz", rig, None if "mounting" in truth else moves[i], as_logged(rows, truth.get("mounting")))
    text = json.dumps(truth, indent=1, sort_keys=True)
    with open(options.out / "commitments.txt", "a", encoding="utf-8") as file:
        file.write(f"{hashlib.sha256(text.encode()).hexdigest()}  {name}\n")
    sealed.write_text(text, encoding="utf-8")
    return name
