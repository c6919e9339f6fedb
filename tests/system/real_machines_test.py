#!/usr/bin/env python3
# Diagnoses recordings of real machines; each is left out with a word where its file is absent.
import json
import os

from program import expect, run

RECORDINGS = os.path.join(os.environ.get("PNEUSERVO_SHARED", "../shared"), "recordings")


def emps():
    """Coulomb friction and a viscous one that differs by direction; held out, 1.63 N are known to be reachable."""
    recording = os.path.join(RECORDINGS, "emps", "emps_base.csv.gz")
    if not os.path.exists(recording):
        print(f"left out: {recording} is not there")
        return
    done = run("diagnose", "config/machines/emps.yaml", recording, "--quiet", "--json", "-")
    expect(done.returncode == 0, f"emps: status {done.returncode}: {done.stderr}")
    found = json.loads(done.stdout)
    expect(found["verdict"] == "missing_physics", f"emps: the verdict is {found['verdict']}")
    named = {answer["effect"]: answer for answer in found["answers"]}
    friction = ["coulomb_friction", "direction_dependent_viscous_friction"]
    expect(sorted(named) == friction, f"emps: named are {sorted(named)}, expected {friction}")
    note = found["answers"][0].get("note", "")
    expect("periodic along the way" in note, f"emps: the screw's ripple is not told: {note}")
    viscous = named["direction_dependent_viscous_friction"]["parameters"]
    ratio = viscous["backward_Ns_per_m"]["value"] / viscous["forward_Ns_per_m"]["value"]
    expect(1.3 < ratio < 1.6, f"emps: backward over forward viscous friction is {ratio:.2f}, published data give 1.44")
    held_out = found["fit"]["channels"]["F_N"]["held_out_after"]
    expect(held_out <= 1.7, f"emps: {held_out} N are left on held-out stretches")


emps()
