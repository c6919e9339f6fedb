# Machines for tools/diagnosis-trial: drawn around configs, with something concealed, and recorded by `pneuservo run`.
"""What each kind conceals stands in its function; CONCEALED and OUTSIDE name them. A machine depends on seed, kind, number
and draw alone."""
import csv
import gzip
import itertools
import json
import math
import pathlib
import random
import subprocess

import yaml

import vocabulary

FIRST_S = 5.0  # held at the first reference value by its own loop before the recording begins

BACKGROUND = yaml.safe_load((pathlib.Path(__file__).resolve().parent / "trials/background.yaml").read_text(encoding="utf-8"))
RUNGS = 5


def force(rig):
    return rig["cylinder"]["area_1_m2"] * (rig["supply"]["pressure_Pa"] - 101325)


def moving_kg(rig):
    return rig["slider"]["mass_kg"] + rig["slider"]["payload_kg"]


def known_effects(options, rig):
    """The vocabulary, with sizes in the numbers of this rig."""
    return vocabulary.effects(options.program, rig)


def sized(effect, rig, rung, options):
    return vocabulary.sized(known_effects(options, rig)[effect], rung, 0.6 * moving_kg(rig))


def fair_names(options):
    """Names that machines of kind background may get without being false."""
    of_every_machine = {name for name, one in vocabulary.effects(options.program).items() if one["of_every_machine"] and one["smallest"]}
    return of_every_machine - set(BACKGROUND["not_held"]) | set(BACKGROUND["fair"])


PRESSURES = ("p1_port", "p2_port", "p1_chamber", "p2_chamber")


def main_effects(options, owner):
    """Main effects of kind background: those that its small physics does not hold, a delay, and an overlap."""
    left_out = fair_names(options) | set(BACKGROUND["never_main"])
    return [name for name in vocabulary.with_sizes(known_effects(options, owner)) if name not in left_out] + BACKGROUND["main_too"]


def get(tree, path):
    for key in path.split("."):
        tree = tree[key]
    return tree


def put(tree, path, value):
    *way, last = path.split(".")
    for key in way:
        tree = tree[key]
    tree[last] = value


def cut_normal(rng):
    while True:
        z = rng.gauss(0, 1)
        if abs(z) <= 2:
            return z


def reference(rng, stroke_m, length_s):
    """Minimum-jerk moves with dwells, creeps, or sines."""
    kind = rng.choice(["moves", "moves", "creep", "sine", "multisine"])
    reach = 0.33 * stroke_m
    start = FIRST_S + 0.3
    if kind == "sine":
        f = rng.uniform(0.4, 1.5)
        amplitude = min(reach, 0.45 / (2 * math.pi * f)) * rng.uniform(0.7, 1)
        return {"kind": "sine", "amplitude_m": amplitude, "frequency_Hz": f, "center_m": rng.uniform(-0.01, 0.01), "start_s": start}
    if kind == "multisine":
        parts = []
        for _ in range(5):
            f = rng.uniform(0.4, 1.8)
            parts.append([min(0.25 * reach, 0.12 / (2 * math.pi * f)), f, rng.uniform(0, 2 * math.pi)])
        return {"kind": "multisine", "components": parts, "center_m": 0.0, "start_s": start, "ramp_s": 1.0}
    times, places = [0.0, start], [-rng.uniform(0.1, 0.9) * reach] * 2
    while times[-1] < FIRST_S + length_s:
        to = -math.copysign(rng.uniform(0.2, 1) * reach, places[-1])
        way = abs(to - places[-1])
        lasts = rng.uniform(1.3, 2.5) if kind == "creep" else max(0.35, 1.9 * way / rng.uniform(0.25, 0.5))
        times += [times[-1] + lasts]
        times += [times[-1] + rng.uniform(0.25, 0.8)]
        places += [to, to]
    return {"kind": "waypoints", "times_s": times, "positions_m": places, "smoothness": 5}


def first_position(reference):
    if reference["kind"] == "waypoints":
        return reference["positions_m"][0]
    return reference["center_m"]


def owners_rig(rng, configs, name):
    rig = yaml.safe_load(pathlib.Path(rng.choice(configs)).read_text(encoding="utf-8"))
    rig.update(name=name, effects={})
    # A pass of the machine's own rig would know what is hidden from its owner.
    rig["controller"]["flow_feedforward"] = "off"
    rig["slider"]["payload_kg"] = rng.choice([0.0, 1.25])
    if rng.random() < 0.5:  # another machine than the config's, and its owner knows
        for path, least, most in (("cylinder.area_1_m2", 0.8, 1.3), ("cylinder.dead_volume_1_m3", 0.7, 2),
                                  ("cylinder.dead_volume_2_m3", 0.7, 2), ("slider.mass_kg", 0.7, 1.6),
                                  ("slider.viscous_friction_Ns_per_m", 0.6, 1.6)):
            put(rig, path, get(rig, path) * rng.uniform(least, most))
        rig["cylinder"]["area_2_m2"] = rig["cylinder"]["area_1_m2"] * rng.uniform(0.8, 0.95)
        rig["valve"]["natural_frequency_Hz"] = rng.choice([0, 90, 120])
        rig["supply"]["pressure_Pa"] = rng.choice([600000, 700000, 800000])
    # The machine is simulated on a grid finer than any that the diagnosis compares with: its own error is no alarm.
    rig["simulation"] = {"cells_per_m": round(80 / max(rig["line_1"]["length_m"], rig["line_2"]["length_m"]) ** 0.75)}
    noise = rng.choice([200.0, 300.0, 400.0])
    for sensor in ("port_pressure", "chamber_pressure", "supply_pressure"):
        rig["sensors"][sensor]["noise_Pa"] = noise
    return rig


def true_rig(rng, owner, edge):
    rig = json.loads(json.dumps(owner))
    for path, tolerance in owner["tolerances"].items():
        z = math.copysign(rng.uniform(1.7, 2), rng.random() - 0.5) if edge and rng.random() < 0.25 else cut_normal(rng)
        put(rig, path, get(owner, path) * (1 + tolerance * z))
    return rig


def one_effect(_rng, number, owner, rig, options):
    names = options.effects or vocabulary.with_sizes(known_effects(options, owner))
    effect, rung = names[number % len(names)], (number // len(names)) % RUNGS
    rig["effects"] = {effect: sized(effect, owner, rung, options)}
    return {"verdict": "missing_physics", "rung": rung}


def two_effects(rng, _number, owner, rig, options):
    known = known_effects(options, owner)
    names = sorted(set(vocabulary.with_sizes(known)) - {"elastic_load"})  # is looked for before other names alone
    first = rng.choice(names)
    second = rng.choice([name for name in names if known[name]["element"] != known[first]["element"]])
    rig["effects"] = {name: sized(name, owner, rng.randrange(2, RUNGS), options) for name in (first, second)}
    return {"verdict": "missing_physics"}


def parameter_off(rng, _number, owner, rig, _options):
    path = rng.choice(sorted(owner["tolerances"]))
    off = math.copysign(rng.uniform(4, 8), rng.random() - 0.5)
    put(rig, path, get(owner, path) * (1 + owner["tolerances"][path] * off))
    return {"verdict": "parameter_error", "parameters": {path: get(rig, path)}, "tolerances": off}


def sensor_at_fault(rng, _number, _owner, rig, _options):
    channel = rng.choice(["p1_port", "p2_port", "x"])
    name, key, size = {
        "offset": ("sensor_offset", "offset", rng.choice([-1, 1]) * rng.uniform(3000, 9000)),
        "gain": ("sensor_gain", "gain", 1 + rng.choice([-1, 1]) * rng.uniform(0.01, 0.03)),
        "lag": ("sensor_lag", "time_constant_s", rng.uniform(0.008, 0.03)),
    }[rng.choice(["gain", "lag"] if channel == "x" else ["offset", "gain", "lag"])]
    rig["effects"] = {f"{name}:{channel}": {key: size}}
    return {"verdict": "sensor_error"}


def of_the_size_told(rng, number, owner, rig, options):
    clean = json.loads((options.out / f"clean-{number:03d}.json").read_text(encoding="utf-8"))
    sizes = {name: len(one["smallest"]) for name, one in known_effects(options, owner).items()}
    seen = [d for d in clean["detectable"] if sizes.get(d["effect"]) == 1]
    chosen = rng.choice(seen)
    rig["effects"] = {chosen["effect"]: {chosen["parameter"]: chosen["value"]}}
    return {"verdict": "missing_physics"}


def between(rng, least, most):
    """Drawn alike for every ratio."""
    return math.exp(rng.uniform(math.log(least), math.log(most)))


def bent_edges(rng, _owner):
    return {}, {"element": "valve", "power": 1 + rng.choice([-1, 1]) * rng.uniform(0.05, 0.2)}  # of the command once it is recorded


def worn_bore(rng, owner):
    middle_m, reach_m = rng.uniform(-0.2, 0.2) * owner["cylinder"]["stroke_m"], rng.uniform(0.01, 0.03)
    return {"piston_leak_zone": {"area_m2": rng.uniform(2e-3, 1.6e-2) * owner["valve"]["area_max_m2"],
                                 "center_m": middle_m, "width_m": reach_m}}, {"element": "piston"}


def shaken_slider(rng, owner):
    return {"periodic_force": {"amplitude_N": between(rng, 4e-4, 6e-3) * force(owner), "frequency_Hz": rng.uniform(3, 12)}}, {"element": "motion"}


def swinging_supply(rng, owner):
    return {"supply_swing": {"amplitude_Pa": rng.uniform(0.01, 0.05) * owner["supply"]["pressure_Pa"],
                             "frequency_Hz": between(rng, 0.8, 6)}}, {"element": "supply"}


def loose_load(rng, owner):
    return {"load_backlash": {"mass_kg": rng.uniform(0.2, 0.5) * moving_kg(owner), "play_m": between(rng, 3e-4, 3e-3),
                              "contact_frequency_Hz": rng.uniform(25, 90), "contact_damping_ratio": rng.uniform(0.1, 0.4)}}, {"element": "motion"}


OUTSIDE = (bent_edges, worn_bore, shaken_slider, swinging_supply, loose_load)


def without_a_law(rng, number, owner, rig, _options):
    rig["effects"], truth = OUTSIDE[number % len(OUTSIDE)](rng, owner)
    return {"verdict": "unknown"} | truth


CONCEALED = {"effect": one_effect, "pair": two_effects, "parameter": parameter_off, "sensor": sensor_at_fault,
             "detectable": of_the_size_told, "outside": without_a_law}


def conceal(rng, kind, number, owner, rig, options):
    """Puts into `rig` what its owner does not know; returns the truth."""
    truth = {"verdict": "consistent", "effects": {}, "parameters": {}, "element": "none"}
    if kind in CONCEALED:
        truth |= CONCEALED[kind](rng, number, owner, rig, options)
        truth["effects"] = rig["effects"]
    return truth


def with_small_physics(rng, owner):
    """The owner's rig with friction before which the machine's own is off, and what must be free for it."""
    owner["effects"] = {"coulomb_friction": {"force_N": rng.uniform(2e-3, 6e-3) * force(owner)}}
    owner["valve"]["natural_frequency_Hz"] = rng.uniform(90, 140)
    owner["tolerances"] |= {"effects.coulomb_friction.force_N": 0.15, "valve.natural_frequency_Hz": 0.05}


def small_physics(rng, rig):
    """Effects that no owner writes down, each as small as on a machine in good order (machines of concealed/background)."""
    effects = rig["effects"] | {name: vocabulary.drawn(rng, sizes) for name, sizes in BACKGROUND["effects"].items()}
    for channel in PRESSURES:
        for name, sizes in BACKGROUND["sensors"].items():
            sign = rng.choice([-1, 1]) if name == "sensor_offset" else 1
            effects[f"{name}:{channel}"] = {key: sign * value for key, value in vocabulary.drawn(rng, sizes).items()}
    rig["effects"] = effects
    rig["air"]["temperature_K"] += rng.uniform(-1.5, 1.5)


def course(options, folder, rig):
    """Ports and command of a run of the rig as it is, columns by name; nothing where it ends in a fault."""
    path = folder / "course.csv.gz"
    failed = record(options.program, dict(rig), path, 1, rig["duration_s"] - FIRST_S, {"t_s", "u_V", "p1_port_Pa", "p2_port_Pa"})
    if failed:
        return None
    with gzip.open(path, "rt", encoding="utf-8") as file:
        names, *rows = csv.reader(line for line in file if not line.startswith("#"))
    path.unlink()
    return {name: [float(row[at]) for row in rows] for at, name in enumerate(names) if name != "t_s"}


def main_to_background(ideal, background, whole):
    """Largest of the ratios, over the channels, of what the main effect changes to what the background changes, as rms; of courses."""
    runs = [ideal, background, whole]
    if None in runs:
        return None
    ratios = []
    for channel in ideal:
        small, large = (sum((a - b) ** 2 for a, b in zip(runs[i][channel], runs[i + 1][channel])) for i in (0, 1))
        ratios.append(math.sqrt(large / small))
    return max(ratios)


def conceal_main(rng, number, owner, rig, folder, options):
    """Puts small physics and, in four of five, one main thing into `rig`, at a size that stands out of it; the truth."""
    truth = {"verdict": "consistent", "effects": {}, "parameters": {}, "element": "none"}
    ideal = json.loads(json.dumps(rig))
    small_physics(rng, rig)
    background, way = json.loads(json.dumps(rig)), number % 5
    if way == 0:
        return truth
    path, sign = rng.choice(sorted(owner["tolerances"])), rng.choice([-1, 1])
    effect, least = rng.choice(options.effects or main_effects(options, owner)), rng.uniform(1.2, 2.5)
    quiet = [course(options, folder, one) for one in (ideal, background)]
    for rung in range(2, 11):
        if way == 1:
            put(rig, path, get(owner, path) * (1 + owner["tolerances"][path] * sign * 3 * rung))
        else:
            rig["effects"] = background["effects"] | {effect: sized(effect, owner, rung, options)}
        ratio = main_to_background(*quiet, course(options, folder, rig))
        if ratio is None or ratio >= least:
            break
    if ratio is None or not least <= ratio <= 5:
        return None
    if way == 1:
        return truth | {"verdict": "parameter_error", "parameters": {path: get(rig, path)}, "main_to_background": ratio}
    return truth | {"verdict": "missing_physics", "effects": {effect: rig["effects"][effect]}, "main_to_background": ratio}


def record(program, rig, path, case_seed, length_s, columns, first_s=FIRST_S):
    """Runs the machine; the first seconds, in which it finds its rest, are cut off."""
    rig["seed"] = case_seed
    rig["duration_s"] = first_s + length_s
    config = path.with_suffix("").with_suffix(".yaml")
    config.write_text(yaml.safe_dump(rig, sort_keys=False), encoding="utf-8")
    raw = path.with_name("raw.csv.gz")
    done = subprocess.run([str(program), "run", str(config), "--record", str(raw), "--force"], capture_output=True, text=True, check=False)
    config.unlink()
    if done.returncode != 0:
        raw.unlink(missing_ok=True)
        return done.stderr.strip().splitlines()[-1] if done.stderr.strip() else f"status {done.returncode}"
    with gzip.open(raw, "rt", encoding="utf-8") as source, gzip.open(path, "wt", compresslevel=3, encoding="utf-8") as target:
        names = None
        for line in source:
            if line.startswith("#"):
                if not line.startswith("# reference"):
                    target.write(line)
                continue
            fields = line.rstrip("\n").split(",")
            if names is None:
                names = fields
                kept = [i for i, n in enumerate(names) if n in columns]
                target.write(",".join(names[i] for i in kept) + "\n")
                continue
            if float(fields[0]) < first_s - 1e-9:
                continue
            fields[0] = f"{float(fields[0]) - first_s:.6g}"
            target.write(",".join(fields[i] for i in kept) + "\n")
    raw.unlink()
    return ""


def with_power_law(path, power):
    """Changes the commands of a recording to those that a valve of area k |u / 1 V|^power would have needed for the same."""
    with gzip.open(path, "rt", encoding="utf-8") as file:
        lines = file.read().splitlines()
    first = next(i for i, line in enumerate(lines) if not line.startswith("#"))
    at = lines[first].split(",").index("u_V")
    for i in range(first + 1, len(lines)):
        fields = lines[i].split(",")
        command_V = float(fields[at])
        fields[at] = f"{math.copysign(abs(command_V) ** (1 / power), command_V):.6g}"
        lines[i] = ",".join(fields)
    with gzip.open(path, "wt", compresslevel=3, encoding="utf-8") as file:
        file.write("\n".join(lines) + "\n")


def hunts(path):
    """What is wrong with a loop that swings where it should rest; no owner would run it."""
    with gzip.open(path, "rt", encoding="utf-8") as file:
        rows = csv.DictReader(line for line in file if not line.startswith("#"))
        places = [float(row["x_m"]) for row in itertools.takewhile(lambda row: float(row["t_s"]) < 0.3, rows)]
    reach = max(places) - min(places)
    return f"swings by {1e6 * reach:.0f} um at rest" if reach > 200e-6 else ""


def make_case(kind, number, folder, options):
    """Writes rig.yaml, recordings and truth.yaml; another draw where the loop ends in a fault."""
    base = "clean" if kind == "detectable" else kind
    for attempt in range(20):
        rng = random.Random(f"{options.seed}/{base}/{number}/{attempt}")
        owner = owners_rig(rng, options.rigs, f"{kind}-{number:03d}")
        if kind == "background":
            with_small_physics(rng, owner)
        rig = true_rig(rng, owner, edge=rng.random() < 0.33)
        columns = {"t_s", "x_m", "u_V", "p1_port_Pa", "p2_port_Pa"}
        if rng.random() < 0.5:
            columns |= {"p1_chamber_Pa", "p2_chamber_Pa"}
        if rng.random() < 0.3:
            columns |= {"p_supply_Pa"}
        length_s = rng.choice([7.0, 8.0, 9.0])
        references = [reference(rng, owner["cylinder"]["stroke_m"], length_s) for _ in range(2)]
        pressure_1_Pa = rng.uniform(0.6, 0.72) * owner["supply"]["pressure_Pa"]
        folder.mkdir(parents=True, exist_ok=True)
        failed = ""
        if kind == "background":
            rig |= {"reference": references[0], "initial": {"position_m": first_position(references[0]), "pressure_1_Pa": pressure_1_Pa},
                    "duration_s": FIRST_S + length_s}
            truth = conceal_main(rng, number, owner, rig, folder, options)
            failed = "" if truth else "the main effect does not stand out of the background, or too much"
        else:
            truth = conceal(random.Random(f"{options.seed}/{kind}/{number}/hidden"), kind, number, owner, rig, options)
        for r, one in enumerate(references):
            rig["reference"] = one
            rig["initial"] = {"position_m": first_position(one), "pressure_1_Pa": pressure_1_Pa}
            for name in sorted({"periodic_force", "supply_swing"} & set(rig["effects"])):
                rig["effects"][name]["phase_rad"] = rng.uniform(0, 6.28)
            failed = failed or record(options.program, rig, folder / f"recording-{r + 1}.csv.gz", 1000 * number + r + 1, length_s, columns)
            if "periodic_force" not in rig["effects"]:  # which shakes it at rest
                failed = failed or hunts(folder / f"recording-{r + 1}.csv.gz")
            if not failed and "power" in truth:
                with_power_law(folder / f"recording-{r + 1}.csv.gz", truth["power"])
        if failed:
            print(f"{folder.name}: draw {attempt + 1} put aside: {failed}", flush=True)
            continue
        owner["reference"] = references[0]
        (folder / "rig.yaml").write_text(yaml.safe_dump(owner, sort_keys=False), encoding="utf-8")
        truth["true_parameters"] = {p: get(rig, p) for p in owner["tolerances"]}
        (folder / "truth.yaml").write_text(yaml.safe_dump(truth, sort_keys=False), encoding="utf-8")
        return True
    return False


def recorded_columns(path):
    with gzip.open(path, "rt", encoding="utf-8") as file:
        return set(next(csv.reader(line for line in file if not line.startswith("#"))))


def make_proposed(number, folder, proposal, options):
    """Records the true machine of a case as its owner would the proposal: from the first tick. What went wrong, or ""."""
    truth = yaml.safe_load((folder / "truth.yaml").read_text(encoding="utf-8"))
    rig = yaml.safe_load(proposal.read_text(encoding="utf-8"))
    owner = yaml.safe_load((folder / "rig.yaml").read_text(encoding="utf-8"))
    for path, value in truth["true_parameters"].items():  # a machine whose supply is 1 % high has it when turned down too
        put(rig, path, value * get(rig, path) / get(owner, path))
    rig["effects"] = truth["effects"]
    length_s = rig["duration_s"]
    return record(options.program, rig, folder / "proposed-1.csv.gz", 1000 * number + 9, length_s,
                  recorded_columns(folder / "recording-1.csv.gz"), first_s=0.0)
