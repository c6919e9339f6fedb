#!/usr/bin/env python3
# A pressure rig from the command line: check, run, recording, replay, simulate, page, faults, and what is refused.
import gzip, json, os, tempfile

from program import expect, expect_refusal, run

RIG, PULSED = "config/pressure-3m-4mm.yaml", "config/pressure-on-off-3m-4mm.yaml"
folder = tempfile.mkdtemp()


def figures(*arguments, rig=RIG, status=0):
    done = run("run", rig, *arguments, "--json", "-")
    expect(done.returncode == status, f"run {' '.join(arguments)}: status {done.returncode}: {done.stderr}")
    return json.loads(done.stdout)["runs"]


recording, page = os.path.join(folder, "steps.csv.gz"), os.path.join(folder, "page.html")
one = figures("--record", recording, "--report", page)[0]
volume = one["volume"]
expect(one["pressure_source"] == "estimated" and one["faults"] == [], f"run: {one}")
expect(len(volume["steps"]) == 5 and volume["pressure"] == "true", f"steps: {volume}")
expect(volume["max_overshoot_share"] <= 0.03 and volume["max_settled_error_Pa"] <= 5e3, f"steps: {volume}")
expect(volume["max_estimation_error_Pa"] <= 1e3, f"estimate: {volume}")

with gzip.open(recording, "rt") as file:
    names = next(line for line in file if not line.startswith("#")).strip().split(",")
for name in ("t_s", "p_ref_Pa", "p1_port_Pa", "p1_estimated_Pa", "p1_bound_Pa", "mass_flow_1_kgps", "u_V", "p_supply_Pa", "p1_chamber_true_Pa",
             "p_target_Pa", "state", "fault"):
    expect(name in names, f"no column {name}: {names}")
for name in ("x_m", "x_ref_m", "v_mps", "p2_port_Pa", "p1_chamber_Pa", "u1_V"):
    expect(name not in names, f"a column {name}: {names}")

replayed = json.loads(run("replay", RIG, recording, "--json", "-").stdout)
expect(replayed["identical"] and replayed["compared_rows"] == replayed["rows"] == 11000, f"replay: {replayed}")
simulated = json.loads(run("simulate", RIG, "--command", recording, "--json", "-").stdout)
expect(simulated["difference"]["p1_port_Pa"]["rms"] < 500, f"simulate: {simulated}")  # the sensor's noise of 300 Pa is in it
with open(page) as file:
    html = file.read()
expect("Pressure in the volume" in html and "p_target_Pa" in html and "Position error" not in html, "the page")

checked = run("check", RIG, "--json", os.path.join(folder, "check.json"))
with open(os.path.join(folder, "check.json")) as file:
    found = {finding["topic"]: finding for finding in json.load(file)["config"]}
expect(found["loop margins"]["level"] == found["loop in simulation"]["level"] == "good", f"check: {found}")
fast = run("check", RIG, "--set", "controller.gain_per_s=200")
expect("unstable" in fast.stdout and fast.returncode == 1, f"check of a gain that is too high: {fast.stdout}")
port = run("check", RIG, "--set", "controller.pressure_source=valve", "--set", "controller.gain_per_s=2000")
expect("unstable" in port.stdout and port.returncode == 1, f"check of a gain that is too high at the port: {port.stdout}")

# Two on/off valves.
pulses = os.path.join(folder, "pulses.csv.gz")
volume = figures("--record", pulses, rig=PULSED)[0]["volume"]
expect(volume["max_overshoot_share"] <= 0.03 and volume["max_settled_error_Pa"] <= 5e3, f"steps by pulses: {volume}")
expect(volume["max_estimation_error_Pa"] <= 1e3, f"estimate by pulses: {volume}")
replayed = json.loads(run("replay", PULSED, pulses, "--json", "-").stdout)
expect(replayed["identical"] and replayed["compared_rows"] == 11000, f"replay of pulses: {replayed}")
checked = run("check", PULSED)
expect("the shortest pulse opens for 3.00 ms" in checked.stdout and "unstable" not in checked.stdout, f"check of pulses: {checked.stdout}")
done = run("run", PULSED, "--fault", "leak:1:1e-6@2+5")
expect(done.returncode == 1 and "flow_mismatch_1: " in done.stderr, f"a leak beside pulses: {done.stderr}")

moves = figures("--moves", "2")
expect([move["move"] for move in moves] == [1, 2] and all(move["faults"] == [] for move in moves), f"two moves: {moves}")

for fault, name in (("drop:p1_port@2+1", "port_pressure_1_missing"), ("freeze:p1_port@2+3", "port_pressure_1_frozen"),
                    ("supply_loss:3e5@2+5", "supply_low"), ("leak:1:1e-6@2+5", "flow_mismatch_1"), ("emergency_stop@2+1", "emergency_stop")):
    done = run("run", RIG, "--fault", fault)
    expect(done.returncode == 1 and name + ": " in done.stderr, f"{fault}: status {done.returncode}: {done.stderr}")

dumped = run("run", RIG, "--dump-config")
copy = os.path.join(folder, "copy.yaml")
with open(copy, "w") as file:
    file.write(dumped.stdout)
expect(run("run", copy, "--dump-config").stdout == dumped.stdout, "the dumped config does not read back")

for arguments, words in (
    (["run", RIG, "--set", "reference.pressures_Pa=[3e5, 4e5, 5e5, 6e5, 7e5, 4e5]"], ["a pressure of 700000", "less than supply.pressure_Pa"]),
    (["run", RIG, "--set", "reference.times_s=[0, 1]"], ["reference.pressures_Pa: found 6 pressures", "as many as times_s"]),
    (["run", RIG, "--set", "controller.pressure_source=chamber"], ["sensors.chamber_pressure"]),
    (["run", RIG, "--set", "line_1.model=second_order_lag"], ["line_1.model", "expected distributed"]),
    (["run", RIG, "--set", "limits.pressure_Pa=5e5"], ["limits.pressure_Pa", "more than the reference asks for"]),
    (["improve", RIG, recording], ["rig: found pressure", "improve works on no other rig"]),
    *(([verb, RIG], ["rig: found pressure", verb + " works on no other rig"])
      for verb in ("design", "stopping", "pass", "index", "commission", "home")),
    (["identify", RIG, recording], ["rig: found pressure", "identify needs pressures at both ends"]),
    (["device", RIG, "--can", "vcan0"], ["hal.can: found nothing"]),
    (["guard", RIG], ["hal.guard: found nothing"]),
    (["diagnose", RIG, recording], ["rig: found pressure", "no residuals of it"]),
):
    expect_refusal(run(*arguments), words, " ".join(arguments[:2]))

# Another law has other keys, which are told as well.
for rig, law, words in ((RIG, "pd_force", "found pd_force, expected pressure_pi, the law of a pressure"),
                        ("config/cylinder-2m-4.15mm.yaml", "pressure_pi", "found pressure_pi, expected pd_force, the law of a cylinder")):
    done = run("run", rig, "--set", "controller.kind=" + law)
    expect(done.returncode == 2 and words in done.stderr, f"{law} on {rig}: {done.stderr}")
