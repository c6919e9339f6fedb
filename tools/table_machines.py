# Servo tables for tools/diagnosis-trial: drawn around their configs, with one thing concealed, recorded by `pneuservo run`.
"""Each case in turn on each config, its size drawn alike for every ratio between the two that stand beside it. Every table makes
half the config's move there at one mean pressure and back at another: what grows with the pressure differs from what does not."""
import json
import random

import yaml

from trial_machines import between, cut_normal, get, put, record

COLUMNS = {"t_s", "x_m", "u1_V", "u2_V", "p1_port_Pa", "p2_port_Pa"}
MOVES = ((-0.025, 0.025, 140e3), (0.025, -0.025, 165e3))  # from [m], to [m], mean pressure [Pa]
# Beside what the configs state: a tape measure, and a gauge of the chambers' volume.
OWNERS_TOLERANCES = {"line_1.length_m": 0.01, "line_2.length_m": 0.01, "cylinder.dead_volume_1_m3": 0.01, "cylinder.dead_volume_2_m3": 0.01}


def amount(key, least, most, **held):
    return lambda rng: {key: between(rng, least, most), **held}


def either_way(key, least, most, neutral=0.0):
    return lambda rng: {key: neutral + rng.choice([-1, 1]) * between(rng, least, most)}


# From about twice what clean tables say would have shown.
EFFECTS = {
    "valve_dead_band": amount("width_V", 0.004, 0.03),
    "chamber_leak_1": amount("area_m2", 4e-9, 4e-8),
    "coulomb_friction": amount("force_N", 0.4, 3),
    "sensor_offset:p1_port": either_way("offset", 1500, 6000),
    "line_restriction_2": amount("area_m2", 3e-6, 6e-6),
    "spring_load": lambda rng: {"stiffness_N_per_m": between(rng, 10, 60), "rest_m": 0.0},
    "sensor_lag:p2_port": amount("time_constant_s", 0.008, 0.03),
    "supply_droop": amount("area_m2", 2e-6, 6e-6, volume_m3=3e-4),
    "valve_offset": either_way("offset_V", 0.003, 0.01),
    "constant_force": either_way("force_N", 0.5, 5),
    "sensor_gain:p2_port": either_way("gain", 0.01, 0.03, 1.0),
    "piston_leak": amount("area_m2", 4e-8, 3e-7),
    "command_delay": amount("delay_s", 0.0015, 0.004),
    "quadratic_drag": amount("coefficient_Ns2_per_m2", 100, 500),
    "valve_asymmetry": either_way("exhaust_ratio", 0.1, 0.3, 1.0),
    "valve_neutral_leak": amount("area_m2", 4e-9, 4e-8),
    "valve_hysteresis": amount("width_V", 0.004, 0.03),
    "chamber_leak_2": amount("area_m2", 4e-9, 4e-8),
    "line_restriction_1": amount("area_m2", 3e-6, 6e-6),
}
# In tolerances: a payload that nobody counted, another hose, a supply that drops.
PARAMETERS = {"slider.mass_kg": (4, 9), "line_1.diameter_m": (8, 12), "supply.pressure_Pa": (-9, -5), "line_2.length_m": (60, 90)}
FIRST = list(EFFECTS)[:6]
CASES = ["clean", *FIRST, *PARAMETERS, *(name for name in EFFECTS if name not in FIRST)]


def owners_table(path, name):
    rig = yaml.safe_load(path.read_text(encoding="utf-8"))
    rig["tolerances"] |= OWNERS_TOLERANCES
    rig["reference"]["start_s"] = 2.1  # its second half lies in the second that is held out
    return rig | {"name": name, "effects": {}, "duration_s": 4.0}


def conceal(rng, what, owner, rig):
    """Puts into `rig` what its owner does not know; returns the truth."""
    truth = {"verdict": "consistent", "effects": {}, "parameters": {}, "element": "none"}
    if what in EFFECTS:
        rig["effects"] = truth["effects"] = {what: EFFECTS[what](rng)}
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
