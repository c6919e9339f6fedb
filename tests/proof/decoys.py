# Decoys: an effect, and beside it a number of the config that is wrong within three tolerances and favours a rival.
"""The machine has the effect; the owner's number is 2 to 3 tolerances off to the side on which it leaves a mismatch like the
effect's own. Right is the effect first: what is within its tolerances is no name. Effects that move no port by three sensor floors are
drawn again, as tools/proof does with what is outside: nobody could tell them from a number. A case depends on seed and number alone."""
import random

import cases
import concealed
import dose
import rigs

# Effect, the number that is off, the side on which the true one lies, and the name that the number then speaks for.
DECOYS = [("command_delay", "valve.natural_frequency_Hz", -1, "valve_lag"),  # a slower spool is late as well
          ("line_restriction_1", "line_1.diameter_m", -1, "parameter:line_1.diameter_m"),  # a narrower line resists as well
          ("quadratic_drag", "slider.viscous_friction_Ns_per_m", 1, "parameter:slider.viscous_friction_Ns_per_m"),  # both brake with speed
          ("coulomb_friction", "slider.viscous_friction_Ns_per_m", 1, "stribeck_friction"),  # both brake, the one at all speeds
          ("valve_asymmetry", "valve.critical_pressure_ratio", -1, "parameter:valve.critical_pressure_ratio"),  # less exhaust flow
          ("supply_droop", "supply.pressure_Pa", -1, "parameter:supply.pressure_Pa"),  # less supply
          ("valve_dead_band", "valve.area_per_volt_m2_per_V", -1, "parameter:valve.area_per_volt_m2_per_V"),  # less area a volt
          ("chamber_leak_1", "cylinder.dead_volume_1_m3", 1, "line_leak_1")]  # a chamber that fills more slowly
LEAST_FLOORS = 3.0


def conceals(rng, rig, true_rig, gains, effect, vocabulary):
    """Lines of the machine without and with the effect at 4 to 16 times its smallest size, and its parameters."""
    known, sized = vocabulary
    parameters = {key: rigs.rounded(value, 4) for key, value in sized(known[effect], rng.uniform(2, 4), 0.6 * rigs.moving_kg(rig)).items()}
    plain = rigs.machine_lines(true_rig, gains) | cases.believed(rig, gains)
    lines = dict(plain)
    concealed.put_effect(lines, effect, parameters)
    return plain, lines, parameters


def make_case(number, options, vocabulary_of):
    """Writes OUT/decoy-NNN unless it is there; its name."""
    name = f"decoy-{number:03d}"
    sealed = options.out / "sealed" / f"{name}.json"
    if sealed.is_file():
        return name
    effect, path, side, rival = DECOYS[number % len(DECOYS)]
    rng = random.Random(f"decoy {options.seed} {number}")
    while True:
        rig, moves, gains = cases.draw_rig(rng, options.machine, name, cases.LENGTH_S)
        true_rig, off = cases.true_machine(rng, rig), side * rng.uniform(2, 3)
        if effect in rig["effects"] or path not in rig["tolerances"]:
            continue
        cases.put(true_rig, path, rigs.rounded(cases.get(rig, path) * (1 + rig["tolerances"][path] * off), 7))
        config = cases.owners_config(rig, gains, moves[0], cases.LENGTH_S)
        plain, lines, parameters = conceals(rng, rig, true_rig, gains, effect, vocabulary_of(config))
        seed = rng.randrange(1, 2**30)
        recordings, without = (dose.recorded(options, rig, one, moves, seed) for one in (lines, plain))
        shows = max((cases.visible(*pair, rig) for pair in zip(recordings, without)), default=0.0)
        if shows > LEAST_FLOORS:
            break
    truth = {"kind": "single", "effects": {effect: parameters}, "elements": [], "background": False, "fair": [], "rival": rival, "visible": rigs.rounded(shows),
             "decoy": {"path": path, "tolerances_off": rigs.rounded(off)}}
    dose.record(options.out / name, sealed, config, moves, recordings, truth)
    return name
