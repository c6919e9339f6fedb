#!/usr/bin/env python3
# The verb identify on a simulated line behind a held piston, and what it refuses.
import gzip, json, math, os, tempfile

from program import CONFIG, expect, expect_refusal, run

folder = tempfile.mkdtemp()
command = os.path.join(folder, "command.csv")
record = os.path.join(folder, "sweep.csv.gz")
page = os.path.join(folder, "line.html")
# A line of 2 m; friction holds the slider. Losses as exact theory has them.
LINE = ["--set", "line_1.length_m=2", "--set", "line_2.length_m=2", "--set", "effects.coulomb_friction.force_N=1e4", "--set", "period_s=1e-4",
        "--set", "cylinder.wall_heat_W_per_m2K=1e5", "--set", "simulation.cells_per_m=20",
        "--set", "effects.frequency_dependent_losses.share=1"]
PERIOD_S, ROWS, HIGHEST_HZ = 1e-4, 40000, 80.0
with open(command, "w") as file:
    file.write("t_s,u_V\n")
    for i in range(ROWS):
        t, sweep_s = i * PERIOD_S - 0.4, 3.0
        inside = 0.0 < t < sweep_s
        phase = 2 * math.pi * (2.0 * t + 0.5 * (HIGHEST_HZ - 2.0) * t * t / sweep_s)
        file.write(f"{i * PERIOD_S:.6g},{0.03 * math.sin(phase) if inside else 0.0:.9g}\n")
made = run("simulate", CONFIG, *LINE, "--command", command, "--record", record)
expect(made.returncode == 0, f"simulate: {made.stderr}")

# The simulated losses are fitted to exact theory up to 20 Hz: unit tests judge the identification itself. The age of the
# simulated port, one sub-step, is that of the recording's own config.
for side in ("1", "2"):
    done = run("identify", CONFIG, record, *LINE, "--side", side, "--json", "-", "--report", page, *(["--set", "line_1.length_m=2.1"] if side == "1" else []))
    expect(done.returncode == 0, f"identify: {done.stderr}")
    found = json.loads(done.stdout)
    exact = json.loads(run("identify", CONFIG, record, *LINE, "--side", side, "--json", "-").stdout)["exact_theory"]
    frequency, damping = found["natural_frequency_Hz"], found["damping_ratio"]
    expect(abs(frequency["value"] / exact["natural_frequency_Hz"] - 1) < 0.02, f"side {side}: {frequency}, {exact}")
    expect(abs(damping["value"] / exact["damping_ratio"] - 1) < 0.5, f"side {side}: {damping}, {exact}")
    expect(abs(found["length_m"]["value"] - 2.0) < 0.01, f"side {side}: {found['length_m']}")
    expect(found["port_age_s"] == PERIOD_S, f"side {side}: {found['port_age_s']}")
    expect(found["in"] == f"p{side}_port_Pa" and found["out"] == f"p{side}_chamber_Pa", f"side {side}: {found['in']}")
with open(page) as file:
    expect("natural frequency" in file.read(), "no page")
text = run("identify", CONFIG, record, *LINE).stdout
expect("exact theory, config" in text and "losses over those of the air" in text and "100 us older than its chamber" in text, text)
# A recording that is not simulated has ports as old as its chambers.
plain = os.path.join(folder, "plain.csv")
with gzip.open(record, "rt") as file, open(plain, "w") as out:
    out.write(file.read().replace("p1_port: simulated", "p1_port: real"))
found = json.loads(run("identify", CONFIG, plain, *LINE, "--json", "-").stdout)
expect(found["port_age_s"] == 0.0, f"a real port: {found['port_age_s']}")

# A piston that moves, a rig without a line, a recording without the chamber.
moving = os.path.join(folder, "moving.csv.gz")
run("run", CONFIG, "--duration-s", "1", "--record", moving)
expect_refusal(run("identify", CONFIG, moving), ["x_m", "moves by", "expected one that is held"], "a piston that moves")
expect_refusal(run("identify", "config/machines/emps.yaml", record), ["rig: found driven_axis", "pressures at both ends"], "no line")
expect_refusal(run("identify", CONFIG, command, *LINE), ["p1_port_Pa", "p1_chamber_Pa"], "no pressures")
