#!/usr/bin/env python3
# The verb check on configs: a loop that is unstable, limits that are switched off, devices without an emergency stop; and
# that run warns of such a loop, and says what the axis did.
import json
import os
import random
import tempfile

from program import CONFIG, expect, expect_refusal, run

CAN = "config/can/cylinder-10m-7.65mm.yaml"
MIXED = "config/mixed/cylinder-10m-7.65mm.yaml"
seed = int(os.environ.get("PNEUSERVO_TEST_SEED", random.randrange(2**32)))
print(f"seed {seed}")
draw = random.Random(seed)


def sets(*values):
    return [part for value in values for part in ("--set", value)]


def graded(config, *values):
    done = run("check", config, *sets(*values), "--json", "-")
    result = json.loads(done.stdout)
    levels = {finding["topic"]: finding["level"] for finding in result["config"]}
    expect(done.returncode == (0 if result["ready"] else 1), f"{values}: status {done.returncode}, ready {result['ready']}")
    expect(all(finding["remedy"] for finding in result["config"] if finding["level"] != "good"), f"{values}: no remedy")
    return levels, result


levels, result = graded(CONFIG)
expect(not {"bad", "unsafe"} & set(levels.values()), f"{CONFIG} is not sound: {levels}")
# The payloads that the sentence names, as numbers: told ones with time and distance, the others with null.
payloads = next(finding for finding in result["config"] if finding["topic"] == "unknown payload")
told = [one for one in payloads["figures"] if one["after_s"] is not None]
expect(told and all(f"{one['payload_kg']:g} kg after {one['after_s']:.2f} s, {1e3 * one['off_m']:.1f} mm off" in payloads["found"] for one in told),
       f"check: numbers and sentence differ: {payloads}")
untold = [one for one in payloads["figures"] if one["after_s"] is None]
expect(all(one["off_m"] is None and f"{one['payload_kg']:g}" in payloads["found"].split(" kg cannot")[0] for one in untold), f"check: {payloads}")

times = draw.uniform(5, 70)
gain = f"controller.force_gain_V_per_N={0.00572 * times}"
levels, result = graded(CONFIG, gain)
expect(levels["loop margins"] == levels["loop at rest"] == "unsafe" and not result["ready"], f"{gain}: {levels}")
done = run("run", CONFIG, *sets(gain))
expect("the loop is unstable" in done.stderr, f"{gain}: no warning: {done.stderr}")
expect("oscillates" in done.stdout or "ended in a fault" in done.stdout, f"{gain}: {done.stdout[:400]}")
expect_refusal(run("run", CAN, *sets(gain, f"hal.can.interface=unix:{tempfile.gettempdir()}/no-bus"), "--time", "real"),
               ["unstable", "--allow-unstable"], "an unstable loop on devices")
expect_refusal(run("run", MIXED, *sets("hal.bench=false"), "--time", "real"), ["hal.bench"], "a real valve on simulated pressures")

off = ["speed_mps=100", "deviation_m=0", "stall_force_N=0", "end_stop_contact=allowed", "position_margin_m=1", "lateness_s=3600",
       "supply_share=0", "flow_mismatch_share=0", "chamber_mismatch_Pa=0", "pressure_Pa=1e8", "checks_rest_s=0", "bad_share=1",
       "missed_share=1"]
levels, _ = graded(CONFIG, *(f"limits.{value}" for value in off))
for value in off:
    topic = "limits." + value.split("=")[0]
    expect(levels.get(topic) == "unsafe", f"{topic} is switched off and is called {levels.get(topic)}")
done = run("check", CONFIG, *sets(*(f"limits.{value}" for value in off)))
expect(done.returncode == 1 and done.stdout.strip().endswith("unsafe: see the lines marked unsafe"), done.stdout[-200:])

levels, _ = graded(CAN)
expect(all(levels[topic] == "unsafe" for topic in ("emergency stop", "enable output")), f"{CAN}: {levels}")

motion = {}
for amplitude, frequency in ((0.05, 0.3), (0.04, 5.0)):
    done = run("run", CONFIG, *sets(f"reference.amplitude_m={amplitude}", f"reference.frequency_Hz={frequency}", "duration_s=8"),
               "--json", "-")
    motion[frequency] = json.loads(done.stdout)["runs"][0]["motion"]
expect(motion[0.3]["word"] == "follows", f"0.3 Hz: {motion[0.3]}")
expect(motion[5.0]["word"] in ("does_not_follow", "end_stop", "fault"), f"5 Hz: {motion[5.0]}")
