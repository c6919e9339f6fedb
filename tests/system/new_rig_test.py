#!/usr/bin/env python3
# From a data sheet to a rig: new-rig by options and by questions, its file in check, design and run, its refusals.
import json, os, pty, subprocess, sys, tempfile

from program import expect, program, run

folder = tempfile.TemporaryDirectory()
SHEET = {"bore": "32 mm", "rod": "12 mm", "stroke": "200 mm", "mass": "3 kg", "line-length": "3.5 m", "line-diameter": "4 mm",
         "supply": "6 bar gauge", "flow": "700 l/min"}


def at(name):
    return os.path.join(folder.name, name)


def options(**changed):
    return [part for key, value in {**SHEET, **changed}.items() if value for part in (f"--{key}", value)]


def by_options():
    made = run("new-rig", at("axis.yaml"), "--name", "axis", *options())
    expect(made.returncode == 0, f"new-rig ends with {made.returncode}: {made.stdout}{made.stderr}")
    text = open(at("axis.yaml")).read()
    for part in ("bore: 32 mm", "pressure: 6 bar gauge", "nominal_flow: 700 l/min", "# typical: ", "flow_feedforward: formula"):
        expect(part in text, f"the file has no '{part}'")
    checked = run("check", at("axis.yaml"))
    expect("found" not in checked.stderr, f"check refuses what new-rig wrote: {checked.stderr}")
    margins = json.loads(run("design", at("axis.yaml"), "--json", "-").stdout)["margins_distributed_lines"]
    expect(margins["gain_up"] >= 1.95 and margins["phase_deg"] >= 29.0, f"margins {margins}")
    first = json.loads(run("run", at("axis.yaml"), "--json", "-").stdout)["runs"][0]
    share = first["max_position_error_m"] / (2.0 * first["motion"]["amplitude_m"])
    expect(first["motion"]["word"] == "follows" and share <= 0.02, f"the axis is off by {share} of its way")


def short_ways():
    """A way that is too short for the speed: the number that nobody stated gives way."""
    for name, stated in (("heavy", options(bore="20 mm", rod="8 mm", stroke="500 mm", mass="14 kg")),
                         ("slow", [*options(), "--acceleration", "0.3 m/s2"]), ("fast", [*options(), "--speed", "0.5 m/s"])):
        made = run("new-rig", at(name + ".yaml"), *stated)
        expect(made.returncode in (0, 1) and "moves of up to" in made.stdout, f"{name}: {made.stdout}{made.stderr}")
    expect("speed: 0.5 m/s" in open(at("fast.yaml")).read(), "a stated speed was changed")
    expect_words(run("new-rig", at("none.yaml"), *options(), "--speed", "1 m/s", "--acceleration", "1 m/s2"), "is not reached with")


def expect_words(done, *words):
    expect(done.returncode == 2 and done.stdout == "", f"status {done.returncode}: {done.stdout}{done.stderr}")
    expect(all(word in done.stderr for word in words), f"{words} are not all in: {done.stderr}")


def refusals():
    with open(at("axis.yaml"), "a") as file:
        file.write("# mine\n")
    expect_words(run("new-rig", at("axis.yaml"), *options()), "axis.yaml")  # a person may have worked on it
    expect_words(run("new-rig", at("other.yaml"), "--bore", "32 mm", stdin=subprocess.DEVNULL), "--stroke '200 mm'", "--flow")
    expect_words(run("new-rig", at("other.yaml"), *options(bore="32", supply="6 bar")), "cylinder.bore: found '32'",
                 "supply.pressure: found '6 bar'")
    expect(not os.path.exists(at("other.yaml")), "a refused rig was written")


def by_questions():
    """On a terminal it asks for what no option says; an empty line takes the typical value."""
    terminal, inside = pty.openpty()
    process = subprocess.Popen([program, "new-rig", at("asked.yaml"), *options(bore="", rod="")], stdin=inside,
                               stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    os.close(inside)
    os.write(terminal, b"32 mm\n12 mm\n" + b"\n" * 20)
    said, _ = process.communicate(timeout=300)
    expect(process.returncode == 0, f"new-rig by questions ends with {process.returncode}: {said}")
    expect("Bore of the cylinder" in said and "[0 to 10 V]" in said, f"it asked {said}")
    expect("bore: 32 mm" in open(at("asked.yaml")).read(), "an answer is not in the file")


by_options()
short_ways()
refusals()
by_questions()
sys.exit(0)
