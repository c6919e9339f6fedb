# Rigs as users have them: catalogue cylinders, tubes, valves and sensors; the owner's config, the machine's lines, the loop.
"""A rig is a dictionary in the form of an owner's config. `lines_of` writes what the independent machine reads."""
import math

AIR_PA = 101325.0
BORES = {16: 6, 20: 8, 25: 10, 32: 12, 40: 16, 50: 20, 63: 20}  # mm: rod of ISO 6432 and ISO 15552
TUBES = {16: (2.5, 4.0), 20: (2.5, 4.0), 25: (4.0, 5.5), 32: (4.0, 5.5, 6.5), 40: (5.5, 6.5, 7.65), 50: (6.5, 8.0), 63: (6.5, 8.0, 9.0)}


def log_uniform(rng, least, most):
    return math.exp(rng.uniform(math.log(least), math.log(most)))


def rounded(value, digits=3):
    return float(f"{value:.{digits}g}")


def pull_N(rig):
    return rig["cylinder"]["area_1_m2"] * (rig["supply"]["pressure_Pa"] - AIR_PA)


def moving_kg(rig):
    return rig["slider"]["mass_kg"] + rig["slider"]["payload_kg"]


def lines_and_cylinder(rng, rig):
    bore = rng.choice(list(BORES))
    area = math.pi / 4 * (bore * 1e-3) ** 2
    rod = math.pi / 4 * (BORES[bore] * 1e-3) ** 2
    both_rods = rng.random() < 0.2
    stroke = rng.choice([s for s in (0.1, 0.16, 0.2, 0.25, 0.32, 0.4, 0.5) if s >= 2.5 * bore * 1e-3])
    tube = rng.choice(TUBES[bore])
    length = log_uniform(rng, 0.5, 15.0 if tube > 3 else 4.0)
    other = length if rng.random() < 0.4 else min(max(length * log_uniform(rng, 0.5, 2.0), 0.5), 15.0)
    rig["line_1"] = {"length_m": rounded(length), "diameter_m": tube * 1e-3}
    rig["line_2"] = {"length_m": rounded(other), "diameter_m": tube * 1e-3}
    dead = lambda: rounded(area * rng.uniform(0.01, 0.025) + 2e-6)
    rig["cylinder"] = {"stroke_m": stroke, "area_1_m2": rounded(area - rod if both_rods else area, 5), "area_2_m2": rounded(area - rod, 5),
                       "dead_volume_1_m3": dead(), "dead_volume_2_m3": dead(), "wall_heat_W_per_m2K": 50.0}
    rig["slider"] = {"viscous_friction_Ns_per_m": rounded(60 * bore / 40 * rng.uniform(0.6, 1.5))}


def load(rng, rig):
    heaviest = min(20.0, pull_N(rig) / 20.0)
    mass = log_uniform(rng, 0.2, heaviest)
    payload = rng.choice([0.0, 0.5 * mass])
    rig["slider"] |= {"mass_kg": rounded(mass - payload), "payload_kg": rounded(payload)}
    if rng.random() < 0.25 and 9.81 * mass < 0.25 * pull_N(rig):  # upright, and its owner knows
        rig["effects"]["constant_force"] = {"force_N": rounded(9.81 * moving_kg(rig), 5)}
    if rng.random() < 0.3:
        rig["effects"]["coulomb_friction"] = {"force_N": rounded(pull_N(rig) * rng.uniform(3e-3, 8e-3))}


def valve_and_sensors(rng, rig):
    fastest = rng.uniform(1.0, 2.5)
    largest = fastest * rig["cylinder"]["area_1_m2"] / (0.685 * 290 * 1.3)
    span = rng.choice([5.0, 10.0])
    rig["valve"] = {"command_max_V": span, "area_per_volt_m2_per_V": rounded(largest / span), "area_max_m2": rounded(largest),
                    "critical_pressure_ratio": rounded(rng.uniform(0.2, 0.5), 2), "natural_frequency_Hz": rng.choice([0.0, 60.0, 90.0, 120.0, 150.0]),
                    "damping_ratio": 0.7}
    noise = rounded(log_uniform(rng, 100, 1500), 2)
    pressure = {"quantum_Pa": rng.choice([100.0, 244.0, 500.0]), "noise_Pa": noise}
    rig["sensors"] = {"position": {"quantum_m": rng.choice([1e-6, 5e-6, 1e-5, 5e-5]), "noise_m": 0.0}, "port_pressure": dict(pressure)}
    if rng.random() < 0.25:
        rig["sensors"]["chamber_pressure"] = dict(pressure)
    if rng.random() < 0.4:
        rig["sensors"]["supply_pressure"] = dict(pressure)


def tolerances(rng, rig):
    s = rng.choice([0.6, 1.0])
    out = {"slider.mass_kg": 0.02, "slider.viscous_friction_Ns_per_m": 0.1, "valve.area_per_volt_m2_per_V": 0.03,
           "valve.critical_pressure_ratio": 0.05, "line_1.length_m": 0.005, "line_1.diameter_m": 0.005, "line_2.length_m": 0.005,
           "line_2.diameter_m": 0.005, "cylinder.dead_volume_1_m3": 0.05, "cylinder.dead_volume_2_m3": 0.05,
           "cylinder.wall_heat_W_per_m2K": 0.2, "supply.pressure_Pa": 0.005}
    out = {path: rounded(s * value) for path, value in out.items()}
    if rig["valve"]["natural_frequency_Hz"]:
        out["valve.natural_frequency_Hz"] = 0.05
    if "coulomb_friction" in rig["effects"]:
        out["effects.coulomb_friction.force_N"] = 0.15
    return out


def owners_rig(rng, name):
    rig = {"format": "pneuservo-rig/1", "name": name, "rig": "cylinder", "period_s": rng.choice([5e-4, 1e-3, 1e-3, 1e-3, 2e-3, 4e-3]),
           "air": {"gas_constant_J_per_kgK": 287.0, "heat_capacity_ratio": 1.4, "temperature_K": 293.0, "atmosphere_Pa": AIR_PA,
                   "viscosity_Pas": 1.8e-5, "prandtl": 0.71},
           "supply": {"pressure_Pa": rng.choice([4e5, 5e5, 6e5, 7e5, 7e5, 8e5, 9e5])}, "effects": {}}
    lines_and_cylinder(rng, rig)
    load(rng, rig)
    valve_and_sensors(rng, rig)
    rig["tolerances"] = tolerances(rng, rig)
    return rig


def loop_gains(rig):
    """A force loop as fast as tubes and sampling let it be, a position loop at 0.3 of its limit of stability."""
    a1, a2, mass, friction = rig["cylinder"]["area_1_m2"], rig["cylinder"]["area_2_m2"], moving_kg(rig), rig["slider"]["viscous_friction_Ns_per_m"]
    supply, half = rig["supply"]["pressure_Pa"], rig["cylinder"]["stroke_m"] / 2
    mean = 0.65 * supply
    volume = [rig["cylinder"][f"dead_volume_{s}_m3"] + a * half + math.pi / 4 * rig[f"line_{s}"]["diameter_m"] ** 2 * rig[f"line_{s}"]["length_m"]
              for s, a in ((1, a1), (2, a2))]
    stiffness = 1.2 * mean * (a1 * a1 / volume[0] + a2 * a2 / volume[1])
    speed_per_V = 0.685 * rig["valve"]["area_per_volt_m2_per_V"] * 290 * supply * 0.75 / (a1 * mean)
    late = 2 * rig["period_s"] + max(rig[f"line_{s}"]["length_m"] for s in (1, 2)) / 343 + 0.004
    fast = min(0.5 / late, 80.0)
    share, damping = 0.3, 0.0166
    position = share * (mass * fast + friction) * (stiffness + fast * friction) / (mass * fast)
    # Above the tubes' corner a volt raises a port by the tube's impedance times the edge's flow; and noise is not to be heard.
    flow_per_V = 0.685 * rig["valve"]["area_per_volt_m2_per_V"] * supply / 290
    port_per_V = max(flow_per_V * 343 / (math.pi / 4 * rig[f"line_{s}"]["diameter_m"] ** 2) for s in (1, 2))
    most = min(0.35 / (port_per_V * (a1 + a2)), 0.01 * rig["valve"]["command_max_V"] / (1.4 * a1 * rig["sensors"]["port_pressure"]["noise_Pa"]))
    return {"position_gain_N_per_m": rounded(position), "velocity_gain_Ns_per_m": rounded(damping * position),
            "velocity_filter_s": rounded(max(0.003, 2 * rig["period_s"])), "force_gain_V_per_N": rounded(min(fast / (stiffness * speed_per_V), most))}


def waypoints(rng, reach, fastest, length_s, kind):
    times, places = [0.0, 0.3], [rounded(rng.uniform(-0.9, 0.9) * reach)] * 2
    slow = {"pick": 1.0, "creep": 0.12, "stairs": 0.6}[kind]
    direction = 1
    while times[-1] < length_s:
        if kind == "stairs":
            to = places[-1] + direction * rng.uniform(0.15, 0.4) * reach
            if abs(to) > reach:
                direction = -direction
                continue
        else:
            to = -math.copysign(rng.uniform(0.3, 1.0) * reach, places[-1])
        way = abs(to - places[-1])
        lasts = min(max(0.25, 1.9 * way / (slow * fastest * rng.uniform(0.5, 1.0))), 3.5)
        times += [round(times[-1] + lasts, 3)]
        times += [round(times[-1] + rng.uniform(0.2, 0.7), 3)]
        places += [rounded(to)] * 2
    return {"kind": "waypoints", "times_s": times, "positions_m": places, "smoothness": 5}


def move(rng, rig, length_s):
    """A move as users make them, within what valve and supply can do."""
    reach = 0.42 * rig["cylinder"]["stroke_m"]
    valve = 0.685 * 290 * 1.1 * rig["valve"]["area_max_m2"] / rig["cylinder"]["area_1_m2"]
    longest = max(rig["line_1"]["length_m"], rig["line_2"]["length_m"])
    fastest = min(0.3 * valve, 0.6, 0.6 * (2.0 / max(longest, 2.0)) ** 0.5)
    kind = rng.choice(["pick", "pick", "creep", "stairs", "sine", "multisine"])
    if kind == "sine":
        f = rounded(rng.uniform(0.4, 1.2))
        amplitude = rounded(min(0.8 * reach, fastest / (2 * math.pi * f)))
        return {"kind": "sine", "amplitude_m": amplitude, "frequency_Hz": f, "center_m": rounded(rng.uniform(-0.15, 0.15) * reach), "start_s": 0.3, "ramp_s": 1.0}
    if kind == "multisine":
        parts = [[rounded(min(0.25 * reach, 0.35 * fastest / (2 * math.pi * f))), f, rounded(rng.uniform(0, 6.28))]
                 for f in (rounded(rng.uniform(0.3, 1.8)) for _ in range(4))]
        return {"kind": "multisine", "components": parts, "center_m": 0.0, "start_s": 0.3, "ramp_s": 1.0}
    return waypoints(rng, reach, fastest, length_s, kind)


def move_lines(reference):
    if reference["kind"] == "waypoints":
        return {"move.point": [f"{t!r} {x!r}" for t, x in zip(reference["times_s"], reference["positions_m"])]}
    waves = reference.get("components") or [[reference["amplitude_m"], reference["frequency_Hz"], 0.0]]
    return {"move.wave": [f"{a!r} {f!r} {phase!r}" for a, f, phase in waves], "move.center": reference["center_m"],
            "move.start": reference["start_s"], "move.ramp": reference["ramp_s"]}


def machine_lines(rig, gains):
    """What the machine reads: numbers of this rig (the true one), sensors, and the loop of its user."""
    out = {"period": rig["period_s"], "room": rig["air"]["temperature_K"], "supply.pressure": rig["supply"]["pressure_Pa"],
           "supply.temperature": 293.0, "motion.mass": moving_kg(rig), "motion.viscous": rig["slider"]["viscous_friction_Ns_per_m"],
           "motion.stroke": rig["cylinder"]["stroke_m"], "motion.load": rig["effects"].get("constant_force", {}).get("force_N", 0.0),
           "start_pressure": 0.6 * rig["supply"]["pressure_Pa"]}
    valve = rig["valve"]
    for key, path in (("range", "command_max_V"), ("slope", "area_per_volt_m2_per_V"), ("largest", "area_max_m2"), ("b", "critical_pressure_ratio"),
                      ("frequency", "natural_frequency_Hz"), ("damping", "damping_ratio")):
        out[f"valve.{key}"] = valve[path]
    for s in (1, 2):
        out |= {f"tube_{s}.length": rig[f"line_{s}"]["length_m"], f"tube_{s}.bore": rig[f"line_{s}"]["diameter_m"],
                f"side_{s}.piston": rig["cylinder"][f"area_{s}_m2"], f"side_{s}.dead": rig["cylinder"][f"dead_volume_{s}_m3"],
                f"side_{s}.heat": rig["cylinder"]["wall_heat_W_per_m2K"]}
    for key in ("forward", "backward"):
        out[f"motion.{key}"] = rig["effects"].get("coulomb_friction", {}).get("force_N", 0.0)
    out |= {"sensor.x.quantum": rig["sensors"]["position"]["quantum_m"], "sensor.x.noise": rig["sensors"]["position"]["noise_m"]}
    for channel in ("port_1", "port_2", "chamber_1", "chamber_2", "supply"):
        out |= {f"sensor.{channel}.quantum": rig["sensors"]["port_pressure"]["quantum_Pa"], f"sensor.{channel}.noise": rig["sensors"]["port_pressure"]["noise_Pa"]}
    out |= {"loop.position_gain": gains["position_gain_N_per_m"], "loop.speed_gain": gains["velocity_gain_Ns_per_m"],
            "loop.force_gain": gains["force_gain_V_per_N"], "loop.filter": gains["velocity_filter_s"],
            "loop.bias": rig["effects"].get("constant_force", {}).get("force_N", 0.0), "loop.at_chambers": int("chamber_pressure" in rig["sensors"])}
    return out
