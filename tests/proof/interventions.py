# What an operator does at a bench for each dose of tools/proof-bench.
# name told by the diagnosis, its parameter, what the operator does, doses in the parameter's unit
INTERVENTIONS = [
    ("chamber_leak_1", "area_m2", "open the needle valve at the tee of chamber 1 to an effective area of {:.2g} m2 (from its measured curve)", [2e-8, 4e-8, 8e-8, 1.6e-7]),
    ("piston_leak", "area_m2", "open the needle valve between both chambers to an effective area of {:.2g} m2", [2e-8, 4e-8, 8e-8, 1.6e-7]),
    ("line_restriction_1", "area_m2", "put the drilled plug of {:.2g} m2 effective area between line 1 and the cylinder", [8e-6, 5.6e-6, 4e-6, 2.8e-6]),
    ("parameter:slider.payload_kg", "value", "fix {:g} kg on the slider", [0.25, 0.5, 1.0, 2.0]),
    ("constant_force", "force_N", "hang {:g} N on the cord over the pulley, against positive x", [2.0, 4.0, 8.0, 16.0]),
    ("command_delay", "delay_s", "set the command's delay in the software to {:g} s", [0.002, 0.004, 0.008, 0.016]),
    ("sensor_offset:p1_port", "offset", "add {:g} Pa to the reading of port 1 in the software", [2000.0, 4000.0, 8000.0, 16000.0]),
]
