# What is concealed: effects of the vocabulary, parameters, sensors, mounting, and what the vocabulary has no law for.
"""Each function changes the lines that the machine reads and returns the truth about it."""
import math

from rigs import log_uniform, moving_kg, pull_N, rounded

EFFECT_LINES = {  # effect of the vocabulary: its parameters as lines of the machine; "+" adds to what is there
    "coulomb_friction": {"force_N": ["+motion.forward", "+motion.backward"]},
    "stribeck_friction": {"extra_force_N": ["motion.extra"], "velocity_mps": ["motion.extra_speed"], "coulomb_force_N": ["+motion.forward", "+motion.backward"]},
    "direction_dependent_friction": {"forward_N": ["+motion.forward"], "backward_N": ["+motion.backward"]},
    "pressure_dependent_friction": {"force_per_pressure_N_per_Pa": ["motion.seal"]},
    "friction_zone": {"force_N": ["motion.zone"], "center_m": ["motion.zone_at"], "width_m": ["motion.zone_width"]},
    "quadratic_drag": {"coefficient_Ns2_per_m2": ["motion.drag"]},
    "constant_force": {"force_N": ["+motion.load"]},
    "spring_load": {"stiffness_N_per_m": ["motion.spring"], "rest_m": ["motion.spring_at"]},
    "elastic_load": {"mass_kg": ["motion.tail"], "natural_frequency_Hz": ["motion.tail_frequency"], "damping_ratio": ["motion.tail_damping"]},
    "valve_dead_band": {"width_V": ["valve.dead_band"]},
    "valve_offset": {"offset_V": ["valve.offset"]},
    "valve_hysteresis": {"width_V": ["valve.play"]},
    "valve_lag": {"time_constant_s": ["valve.lag"]},
    "valve_neutral_leak": {"area_m2": ["valve.neutral_leak"]},
    "valve_asymmetry": {"exhaust_ratio": ["valve.exhaust_ratio"]},
    "command_delay": {"delay_s": ["valve.delay"]},
    "supply_droop": {"area_m2": ["supply.hose"], "volume_m3": ["supply.volume"]},
    "line_restriction_1": {"area_m2": ["side_1.end"]}, "line_restriction_2": {"area_m2": ["side_2.end"]},
    "line_leak_1": {"area_m2": ["tube_1.leak"], "position": ["tube_1.leak_place"]},
    "line_leak_2": {"area_m2": ["tube_2.leak"], "position": ["tube_2.leak_place"]},
    "chamber_leak_1": {"area_m2": ["side_1.leak"]}, "chamber_leak_2": {"area_m2": ["side_2.leak"]},
    "piston_leak": {"area_m2": ["piston.leak"]},
}
SENSOR_LINES = {"x": "x", "p1_port": "port_1", "p2_port": "port_2"}


def put_effect(lines, effect, parameters):
    for key, value in parameters.items():
        for line in EFFECT_LINES[effect][key]:
            lines[line.lstrip("+")] = value + (lines.get(line[1:], 0.0) if line.startswith("+") else 0.0)


def background(rng, rig, lines):
    """A little of everything, each item as on a machine in good order; returns the names that a diagnosis may rightly give."""
    amount, largest, span, pull = rng.uniform(0.3, 1.0), rig["valve"]["area_max_m2"], rig["valve"]["command_max_V"], pull_N(rig)
    lines["supply.temperature"] += amount * rng.uniform(-3, 3)
    lines["room"] += amount * rng.uniform(-1.5, 1.5)
    way = rng.uniform(2e-5, 6e-5)
    if "coulomb_friction" in rig["effects"]:  # the dry friction that its owner knows builds up over a way
        lines |= {"motion.bristle": lines["motion.forward"], "motion.bristle_way": way, "motion.forward": 0.0, "motion.backward": 0.0}
    else:
        lines |= {"motion.bristle": amount * rng.uniform(1e-4, 5e-4) * pull, "motion.bristle_way": way}
    lines |= {"valve.dead_band": amount * rng.uniform(5e-4, 3e-3) * span, "valve.exhaust_ratio": 1 + amount * rng.uniform(-0.02, 0.02),
              "valve.delay": amount * rng.uniform(1e-4, 3e-4), "valve.wave": amount * rng.uniform(0.005, 0.02), "valve.wave_length": rng.uniform(0.1, 0.6) * span,
              "valve.neutral_leak": amount * rng.uniform(5e-5, 4e-4) * largest, "supply.swing": amount * rng.uniform(5e-4, 3e-3) * rig["supply"]["pressure_Pa"],
              "supply.swing_frequency": log_uniform(rng, 0.4, 3), "jitter": 2e-5 * amount, "piston.leak": amount * rng.uniform(1e-5, 5e-5) * largest}
    for s in (1, 2):
        bore = math.pi / 4 * rig[f"line_{s}"]["diameter_m"] ** 2
        lines |= {f"tube_{s}.layers": 1.0, f"side_{s}.inlet_loss": 0.5 * amount, f"side_{s}.leak": amount * rng.uniform(1e-5, 5e-5) * largest,
                  f"side_{s}.port": rng.uniform(0.05, 0.15) * bore}  # 0.6 to 2 cm3 at 4 mm
        for channel in ("port", "chamber"):
            lines |= {f"sensor.{channel}_{s}.lag": 3e-4 * amount, f"sensor.{channel}_{s}.offset": amount * rng.uniform(-200, 200)}
    fair = ["frequency_dependent_losses", "valve_dead_band", "valve_asymmetry", "valve_curve", "command_delay", "supply_swing", "valve_neutral_leak",
            "elastic_friction", "coulomb_friction", "piston_leak"]
    fair += [f"{name}_{s}" for s in (1, 2) for name in ("line_branch", "chamber_leak", "line_leak")]
    return fair + [f"sensor_{what}:p{s}_{where}" for what in ("lag", "offset") for s in (1, 2) for where in ("port", "chamber")]


def single(rng, rig, lines, known, sized, least=-1.0):
    """One effect, from half to 16 times the smallest size that the vocabulary states for this rig."""
    names = [name for name in EFFECT_LINES if name in known and known[name]["smallest"] and name not in rig["effects"]]
    effect, rung = rng.choice(names), rng.uniform(least, 4.0)
    if effect in ("valve_offset", "constant_force", "spring_load") and rng.random() < 0.5:
        flip = -1.0
    else:
        flip = 1.0
    first = next(iter(known[effect]["smallest"]))
    parameters = {key: rounded(value * (flip if key == first else 1.0), 4) for key, value in sized(known[effect], rung, 0.6 * moving_kg(rig)).items()}
    put_effect(lines, effect, parameters)
    return {"verdict": "missing_physics", "effects": {effect: parameters}, "elements": [known[effect]["element"]], "times_smallest": rounded(2**rung)}


def pair(rng, rig, lines, known, sized):
    first = single(rng, rig, lines, known, sized, 2.0)
    for _ in range(100):
        second_lines = dict(lines)
        second = single(rng, rig, second_lines, known, sized, 2.0)
        if second["elements"] != first["elements"]:
            lines |= second_lines
            return {"verdict": "missing_physics", "effects": first["effects"] | second["effects"], "elements": first["elements"] + second["elements"],
                    "times_smallest": min(first["times_smallest"], second["times_smallest"])}
    return first


def parameter(rng, rig, true_rig, get, put):
    path = rng.choice(sorted(rig["tolerances"]))
    off = math.copysign(rng.uniform(4, 8), rng.random() - 0.5)
    put(true_rig, path, rounded(get(rig, path) * max(1 + rig["tolerances"][path] * off, 0.1), 6))
    section = path.split(".")[0]
    elements = {"slider": ["motion"], "effects": ["motion"], "cylinder": [f"chamber_{s}" for s in (1, 2) if "dead" not in path or f"_{s}_m3" in path]}
    return {"verdict": "parameter_error", "parameters": {path: get(true_rig, path)}, "elements": elements.get(section, [section]), "tolerances_off": rounded(off)}


def sensor(rng, lines):
    channel = rng.choice(["p1_port", "p2_port", "p1_port", "p2_port", "x"])
    what = rng.choice(["gain", "lag"] if channel == "x" else ["offset", "gain", "lag"])
    key, value = {"offset": ("offset", rng.choice([-1, 1]) * rng.uniform(3000, 9000)), "gain": ("gain", 1 + rng.choice([-1, 1]) * rng.uniform(0.01, 0.03)),
                  "lag": ("time_constant_s", rng.uniform(0.008, 0.03))}[what]
    lines[f"sensor.{SENSOR_LINES[channel]}.{what}"] = value
    return {"verdict": "sensor_error", "effects": {f"sensor_{what}:{channel}": {key: value}}, "elements": [f"sensor:{channel}"]}


MOUNTING = ("ports exchanged", "command reversed", "position reversed")  # as the logger has them


def mounting(rng):
    return {"verdict": "consistent", "mounting": rng.choice(MOUNTING), "elements": ["none"]}


# Kinds for which the vocabulary has got a law since the list was drawn up: the law is then what has to be named.
LAWS = {"swelling hose": "line_compliance_{}", "sticking spool": "valve_stiction", "relief valve": "chamber_relief_{}", "end cushion": "end_cushion_{}",
        "check valve": "flow_control_{}", "payload taken up": "payload_change"}


def outside(rng, rig, lines, length_s, known):
    """Physics that the program's list of effects did not hold; `near` are laws that say nearly the same, `law` is its own, if `known` has one now."""
    side, largest, span, pull = rng.choice([1, 2]), rig["valve"]["area_max_m2"], rig["valve"]["command_max_V"], pull_N(rig)
    supply, half, mass = rig["supply"]["pressure_Pa"], rig["cylinder"]["stroke_m"] / 2, moving_kg(rig)
    line, chamber = f"line_{side}", f"chamber_{side}"
    area = lambda least, most: largest * rng.uniform(least, most)
    weight = 9.81 if "constant_force" in rig["effects"] else 0.0
    gained = mass * rng.uniform(0.1, 0.3)
    narrow = [f"line_restriction_{side}"]
    kinds = {
        "swelling hose": ({f"tube_{side}.swelling": log_uniform(rng, 1e-7, 5e-7)}, [line], [f"line_branch_{side}"]),
        "play of the encoder": ({"sensor.x.play": log_uniform(rng, 3e-5, 3e-4)}, ["sensor:x", "motion"], ["load_backlash"]),
        "warming seal": ({"motion.warm": pull * log_uniform(rng, 0.01, 0.05), "motion.warm_time": rng.uniform(3, 8)}, ["motion"], ["coulomb_friction"]),
        "sticking spool": ({"valve.sticks": span * log_uniform(rng, 2e-3, 1.5e-2)}, ["valve", "timing"], ["valve_hysteresis"]),
        "drifting valve": ({"valve.drift": rng.choice([-1, 1]) * rng.uniform(0.005, 0.03)}, ["valve"], ["parameter:valve.area_per_volt_m2_per_V"]),
        "relief valve": ({f"side_{side}.relief_pressure": supply * rng.uniform(0.55, 0.75), f"side_{side}.relief_slope": area(0.005, 0.03) / 5e4}, [chamber, line], [f"chamber_leak_{side}", f"line_leak_{side}"]),
        "end cushion": ({f"side_{side}.cushion": area(0.1, 0.35), f"side_{side}.cushion_length": half * rng.uniform(0.3, 0.6)}, [line, chamber], narrow),
        "check valve": ({f"side_{side}.check_valve": area(0.25, 0.8)}, [line, chamber], narrow),
        "clogged silencer": ({"valve.silencer": area(0.3, 1.0)}, ["valve"], ["valve_asymmetry"]),
        "regulator hysteresis": ({"supply.hose": area(2, 4), "supply.volume": rng.uniform(3e-4, 1e-3), "supply.regulator_gap": supply * rng.uniform(0.01, 0.04)}, ["supply"], ["supply_droop"]),
        "kinked tube": ({f"side_{side}.kink": area(0.2, 0.6), f"side_{side}.kink_from": half * rng.uniform(-0.2, 0.3)}, [line, chamber], narrow),
        "payload taken up": ({"motion.gained": gained, "motion.gained_weight": gained * weight, "motion.gained_at": 4.0 + length_s * rng.uniform(0.3, 0.6)}, ["motion"], ["parameter:slider.mass_kg", "parameter:slider.payload_kg"]),
        "blows": ({"motion.blow": pull * rng.uniform(0.02, 0.08), "motion.blow_every": rng.uniform(1.2, 2.0), "motion.blow_lasts": rng.uniform(0.03, 0.1)}, ["motion"], []),
        "other consumers": ({"supply.dip": supply * rng.uniform(0.02, 0.06), "supply.dip_every": rng.uniform(1.0, 2.0), "supply.dip_lasts": rng.uniform(0.2, 0.4)}, ["supply"], ["supply_droop"]),
        "rubber bumper": ({"motion.bumper": pull / half * log_uniform(rng, 0.1, 0.6), "motion.bumper_at": half * rng.uniform(0.1, 0.4)}, ["motion"], ["spring_load"]),
        "bent sensor": ({f"sensor.port_{side}.bend": rng.choice([-1, 1]) * rng.uniform(0.03, 0.1)}, [f"sensor:p{side}_port"], [f"sensor_gain:p{side}_port", f"sensor_offset:p{side}_port"]),
    }
    kind = rng.choice(list(kinds))
    changes, elements, near = kinds[kind]
    lines |= changes
    law = [name for name in (LAWS.get(kind, "").format(side),) if name in known]
    return {"verdict": "missing_physics" if law else "unknown", "outside": kind, "outside_lines": changes, "elements": elements, "near": near, "law": law}
