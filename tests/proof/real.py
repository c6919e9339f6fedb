# What the sources of the real recordings bear out: names that a diagnosis may give with 0.5 or more.
"""A name is borne out where the makers of the data changed that part, where their own fits have that term, or where other recordings of
the same machine show it (docs/real-machines.md, tests/system/real_machines_test.py)."""
FRICTION = {"coulomb_friction", "stribeck_friction"}
# Word of the command, names: the first row that fits counts.
BORNE_OUT = [("emps.yaml", FRICTION | {"direction_dependent_viscous_friction"}),
             ("kdn25_", FRICTION | {"pressure_dependent_friction"}),
             ("xring257_", {"pressure_dependent_friction"}),
             ("oring257_", FRICTION | {"pressure_dependent_friction", "direction_dependent_friction"}),
             ("oring25_", FRICTION | {"pressure_dependent_friction"}),
             ("tank-discharge.yaml", {"wall_heat_exchange"}),
             ("tube.yaml", {"drop_out_delay"}),
             ("cylinder_valve1_", {"parameter:throttle_2.outflow_area_m2"}),
             ("cylinder_valve2_", {"parameter:throttle_1.outflow_area_m2"}),
             ("cylinder-strokes.yaml", set()),
             ("arm-joint.yaml", FRICTION | {"gravity_load"}),
             ("rack-and-pinion.yaml", FRICTION | {"viscous_friction"}),
             ("serial-joint.yaml", FRICTION | {"viscous_friction"}),
             ("pump-tank.yaml", {"wall_heat_exchange", "pump_curve", "laminar_leak_1", "porous_leak_1"}),
             ("printed-block.yaml", FRICTION)]


def wrong_names(command, answer):
    """Names of 0.5 or more that nothing bears out; of a machine that the list does not hold, all."""
    borne_out = next((names for word, names in BORNE_OUT if word in command), set())
    return [one["effect"] for one in answer["answers"] if one["effect"] not in borne_out | {"unknown"} and one["probability"] >= 0.5]
