# Servo tables for tools/diagnosis-trial: drawn around their configs, with one thing concealed, recorded by `pneuservo run`.
"""Each case in turn on each config, its size drawn alike for every ratio between the two that stand beside it. Every table makes
half the config's move there at one mean pressure and back at another: what grows with the pressure differs from what does not."""
import json
import pathlib
import random

import yaml

from trial_machines import between, cut_normal, get, put, record

COLUMNS = {"t_s", "x_m", "u1_V", "u2_V", "p1_port_Pa", "p2_port_Pa"}
MOVES = ((-0.025, 0.025, 140e3), (0.025, -0.025, 165e3))  # from [m], to [m], mean pressure [Pa]
# Beside what the configs state: a tape measure, and a gauge of the chambers' volume.
OWNERS_TOLERANCES = {"line_1.length_m": 0.01, "line_2.length_m": 0.01, "cylinder.dead_volume_1_m3": 0.01, "cylinder.dead_volume_2_m3": 0.01}


RECIPE = yaml.safe_load((pathlib.Path(__file__).resolve().parent / "trials/servo_table.yaml").read_text(encoding="utf-8"))
EFFECTS, PARAMETERS = RECIPE["first"] | RECIPE["then"], RECIPE["parameters"]
CASES = ["clean", *RECIPE["first"], *PARAMETERS, *RECIPE["then"]]


def drawn(rng, size):
    if isinstance(size, list):
        return between(rng, *size)
    if isinstance(size, dict):
        return size.get("about", 0.0) + rng.choice([-1, 1]) * between(rng, *size["either_way"])
    return size


def owners_table(path, name):
    rig = yaml.safe_load(path.read_text(encoding="utf-8"))
    rig["tolerances"] |= OWNERS_TOLERANCES
    rig["reference"]["start_s"] = 2.1  # its second half lies in the second that is held out
    return rig | {"name": name, "effects": {}, "duration_s": 4.0}


def conceal(rng, what, owner, rig):
    """Puts into `rig` what its owner does not know; returns the truth."""
    truth = {"verdict": "consistent", "effects": {}, "parameters": {}, "element": "none"}
    if what in EFFECTS:
        rig["effects"] = truth["effects"] = {what: {key: drawn(rng, size) for key, size in EFFECTS[what].items()}}
        return truth | {"verdict": "sensor_error" if what.startswith("sensor_") else "missing_physics"}
    if what in PARAMETERS:
        put(rig, what, get(owner, what) * (1 + owner["tolerances"][what] * rng.uniform(*PARAMETERS[what])))
        return truth | {"verdict": "parameter_error", "parameters": {what: get(rig, what)}}
    return truth


def make_case(number, folder, options):
    """Writes rig.yaml, two recordings and truth.yaml; another draw where the loop ends in a fault."""
    config, what = options.rigs[number % len(options.rigs)], CASES[number // len(options.rigs) % len(CASES)]
    for attempt in range(20):
        rng = random.Random(f"{options.seed}/table/{number}/{attempt}")
        owner = owners_table(config, f"table-{number:03d}")
        rig = json.loads(json.dumps(owner))
        for path, tolerance in owner["tolerances"].items():
            put(rig, path, get(owner, path) * (1 + tolerance * 0.5 * cut_normal(rng)))
        truth = conceal(rng, what, owner, rig)
        folder.mkdir(parents=True, exist_ok=True)
        for r, (start_m, end_m, pressure_Pa) in enumerate(MOVES):
            rig["reference"] |= {"start_m": start_m, "end_m": end_m}
            rig["controller"]["mean_pressure_Pa"] = pressure_Pa
            rig["initial"] = {"position_m": start_m}
            failed = record(options.program, rig, folder / f"recording-{r + 1}.csv.gz", 1000 * number + r + 1, owner["duration_s"], COLUMNS, first_s=0.0)
            if failed:
                break
        if failed:
            print(f"{folder.name}: draw {attempt + 1} put aside: {failed}", flush=True)
            continue
        (folder / "rig.yaml").write_text(yaml.safe_dump(owner, sort_keys=False), encoding="utf-8")
        truth["config"] = config.stem
        truth["true_parameters"] = {p: get(rig, p) for p in owner["tolerances"]}
        (folder / "truth.yaml").write_text(yaml.safe_dump(truth, sort_keys=False), encoding="utf-8")
        return True
    return False


def off_in_errors(truth, answer):
    """Of a rightly named thing, how far its first size is off, in standard errors; nothing where it is not named."""
    hidden = truth["effects"] or {f"parameter:{path}": {"value": value} for path, value in truth["parameters"].items()}
    for name, parameters in hidden.items():
        for one in answer["answers"]:
            if one["effect"] == name:
                key, value = next(iter(parameters.items()))
                told = one["parameters"][key]
                return abs(told["value"] - value) / told["standard_error"]
    return None
