# Dose and response: one machine an effect, at zero and at four sizes, and the line through what was found.
"""Each machine is drawn as tools/proof draws them, without a background, so that nothing but tolerances and noise stands beside
the effect. A dose depends on seed, effect and number alone."""
import json
import math
import random

import cases
import concealed
import rigs
import scores

# One effect an element, and two of motion: the size that is set and found, and the doublings from the smallest size of the vocabulary
# at which the four doses begin: 4 or 16 times that size, since forces and leaks of 4 and 8 times were not all seen (seed 271828).
EFFECTS = {"coulomb_friction": ("force_N", 4), "constant_force": ("force_N", 4), "valve_dead_band": ("width_V", 2), "command_delay": ("delay_s", 2),
           "chamber_leak_1": ("area_m2", 4), "piston_leak": ("area_m2", 4)}
DOSES = 4


def record(folder, sealed, config, moves, recordings, truth):
    """Writes the owner's config and recordings, and the truth apart from them; the truth last, by which a case is known to be whole."""
    folder.mkdir(parents=True, exist_ok=True)
    sealed.parent.mkdir(exist_ok=True)
    (folder / "rig.yaml").write_text(cases.yaml.safe_dump(config, sort_keys=False), encoding="utf-8")
    for i, rows in enumerate(recordings):
        cases.write_recording(folder / f"recording-{i + 1}.csv.gz", config, moves[i], rows)
    sealed.write_text(json.dumps(truth, indent=1, sort_keys=True), encoding="utf-8")


def recorded(options, rig, lines, moves, seed):
    """Recordings of these moves; none where a user would not be content with one."""
    out = []
    for i, reference in enumerate(moves):
        run = rigs.move_lines(reference) | {"first": cases.FIRST_S, "length": cases.LENGTH_S, "seed": seed + i}
        out.append(cases.simulate(options.machine, lines | run))
    return out if all(cases.is_sensible(rows, rig) for rows in out) else []


def sizes(known, sized, effect, rig):
    """Parameters of the effect at zero and at each dose, every one twice the one before."""
    first = EFFECTS[effect][1]
    return [None, *(sized(known[effect], rung, 0.6 * rigs.moving_kg(rig)) for rung in range(first, first + DOSES))]


def doses_of_a_draw(rng, effect, options, vocabulary_of):
    """Config, moves, and (parameters, recordings) of every dose of one machine; nothing where the machine does not suit."""
    rig, moves, gains = cases.draw_rig(rng, options.machine, f"dose-{effect}", cases.LENGTH_S)
    true_rig = cases.true_machine(rng, rig)
    seed = rng.randrange(1, 2**30)
    if effect in rig["effects"]:
        return None
    config = cases.owners_config(rig, gains, moves[0], cases.LENGTH_S)
    doses = []
    for number, parameters in enumerate(sizes(*vocabulary_of(config), effect, rig)):
        lines = rigs.machine_lines(true_rig, gains) | cases.believed(rig, gains)
        if parameters:
            parameters = {key: rigs.rounded(value, 4) for key, value in parameters.items()}
            concealed.put_effect(lines, effect, parameters)
        recordings = recorded(options, rig, lines, moves, seed + 10 * number)
        if not recordings:
            return None
        doses.append((parameters, recordings))
    return config, moves, doses


def make_doses(effect, options, vocabulary_of):
    """Writes OUT/EFFECT-0 to EFFECT-4 unless they are there; their names."""
    names = [f"{effect}-{number}" for number in range(DOSES + 1)]
    if all((options.out / "sealed" / f"{name}.json").is_file() for name in names):
        return names
    rng = random.Random(f"dose {options.seed} {effect}")
    drawn = None
    while drawn is None:
        drawn = doses_of_a_draw(rng, effect, options, vocabulary_of)
    config, moves, doses = drawn
    for name, (parameters, recordings) in zip(names, doses):
        truth = {"kind": "single" if parameters else "clean", "effects": {effect: parameters} if parameters else {}, "elements": [], "background": False,
                 "fair": [], "set": parameters[EFFECTS[effect][0]] if parameters else 0.0}
        record(options.out / name, options.out / "sealed" / f"{name}.json", config, moves, recordings, truth)
    return names


def size_in(parameters, key):
    """The size under its own key, or what another name for the same physics calls it: both sides alike, or what stays of a fall."""
    if key in parameters:
        return scores.value(parameters, key, 0.0)
    if "forward_N" in parameters:
        return 0.5 * (scores.value(parameters, "forward_N", 0.0) + scores.value(parameters, "backward_N", 0.0))
    return scores.value(parameters, "coulomb_force_N", 0.0)


def found(answer, effect):
    """The size that the answer gives the effect, under any name that nobody can tell from it; 0 where it is not named."""
    for one in answer["answers"]:
        if scores.canonical(one["effect"], one.get("parameters")) == scores.canonical(effect):
            return size_in(one.get("parameters") or {}, EFFECTS[effect][0])
    return 0.0


def line(points):
    """The least-squares line through (set, found): slope and intercept with their standard errors, from what the points leave."""
    n = len(points)
    mean_x, mean_y = (sum(point[i] for point in points) / n for i in (0, 1))
    spread = sum((x - mean_x) ** 2 for x, _ in points)
    slope = sum((x - mean_x) * (y - mean_y) for x, y in points) / spread
    intercept = mean_y - slope * mean_x
    variance = sum((y - intercept - slope * x) ** 2 for x, y in points) / (n - 2)
    return {"slope": slope, "slope_error": math.sqrt(variance / spread), "intercept": intercept,
            "intercept_error": math.sqrt(variance * (1 / n + mean_x**2 / spread))}


def is_one(fitted):
    """Whether a line shows that what is found is what is set: a slope of 0.95 to 1.05 that is sure to 0.05."""
    return 0.95 <= fitted["slope"] <= 1.05 and fitted["slope_error"] <= 0.05
