#!/usr/bin/env python3
# A pressure that is served: good and bad commands, units at the command line, two commanders, one that dies, a fault, the
# record and its replay; what new-rig writes of such a rig.
import gzip

from program import expect, expect_refusal, run
from served import Client, Served, at, refused

CONFIG = "config/served/pressure-3m-4mm.yaml"


def is_at(pressure_Pa):
    return lambda s: s["p_Pa"] is not None and not s["moving"] and abs(s["p_Pa"] - pressure_Pa) < 2e3


expect_refusal(run("serve", "config/pressure-3m-4mm.yaml", "--socket", at("no.sock")), ["reference.kind", "lowest_Pa"], "a fixed reference")
rig = Served(CONFIG, "rig", "--set", "serve.part_s=60")

# Before enable nothing moves; then commands in Pa and in units, gauge and absolute.
done = rig.command("move", "4e5")
expect(done.returncode == 1 and "not enabled" in done.stderr, f"a move before enable: {done}")
status = rig.status()
expect(status["state"] == "inactive" and status["u_V"] == 0 and "x_m" not in status, f"not shut: {status}")
expect(rig.command("enable").returncode == 0, "enable was refused")
done = rig.command("move", "4 bar absolute", "--rate", "0.5 bar/s", "--wait")
expect(done.returncode == 0 and "to 400.000 kPa" in done.stdout, f"a move: {done}")
rig.until(is_at(4e5), "the pressure of the move")
expect(rig.command("move", "3.5 bar gauge", "--wait").returncode == 0, "a gauge pressure was refused")
rig.until(lambda s: s["target_Pa"] == 451325, "the gauge target")
expect(rig.command("move-by", "-0.5 bar").returncode == 0, "a relative move was refused")
rig.until(lambda s: abs(s["target_Pa"] - 401325) < 1e-6 and is_at(401325)(s), "the relative target")
for words, said in ((("move", "3 bar"), ["move: found '3 bar'", "with its zero"]), (("move", "30 mm"), ["a pressure with its zero"]),
                    (("move", "3e5", "--speed", "0.1"), ["--speed: found", "--rate"]), (("move", "3e5", "--rate", "x"), ["--rate: found 'x'"]),
                    (("stop", "5"), ["expected none after it"]), (("jog", "8e4", "--rate", "5"), ["expected move or move-by"])):
    expect_refusal(rig.command(*words), said, " ".join(words))
expect("kPa" in rig.command("status").stdout, "status in words")

# Bad input: one sentence each, and the pressure stays where it is.
client = Client(rig.socket)
refused(client.ask(b"move\n"), "no JSON object")
refused(client.ask({"command": "move_to"}), "pressure_Pa", "nothing")
refused(client.ask({"command": "move_to", "position_m": 0.1}), "position_m", "unknown key", "pressure_Pa")
refused(client.ask({"command": "move_to", "pressure_Pa": 9e5}), "pressure_Pa", "200000 to 600000")
refused(client.ask({"command": "move_to", "pressure_Pa": "4e5"}), "pressure_Pa")
refused(client.ask(b'{"version":1,"command":"move_to","pressure_Pa":NaN}\n'), "no JSON object")
refused(client.ask({"command": "move_to", "pressure_Pa": 4e5, "rate_Pa_per_s": 1e6}), "rate_Pa_per_s", "80000")
refused(client.ask({"command": "move_by", "change_Pa": 3e5}), "outside")
refused(client.ask({"command": "jog", "rate_Pa_per_s": 0}), "rate_Pa_per_s")
refused(client.ask({"command": "follow", "pressure_Pa": 4e5}), "interval_s")
refused(client.ask({"command": "resume"}), "nothing to resume")
refused(client.ask({"command": "enable"}), "enabled already")
status = rig.status()
expect(abs(status["target_Pa"] - 401325) < 1e-6 and not status["moving"], f"something moved: {status}")

# Two commanders, a flood, a stream.
other = Client(rig.socket)
expect(client.ask({"command": "move_to", "pressure_Pa": 3e5})["ok"], "the commander's move")
refused(other.ask({"command": "move_to", "pressure_Pa": 5e5}), "commanded by process")
expect(other.ask({"command": "stop"})["ok"] and other.ask({"command": "mark"})["ok"], "stop and mark of a second client")
taken = []
for i in range(2000):
    client.send({"command": "move_to", "pressure_Pa": 3e5 + 1e5 * (i % 2), "id": i})
    if i % 100 == 99:
        for answer in [client.answer() for _ in range(100)]:  # what is refused is told so, and the last that is taken counts
            expect(answer["ok"] or "without an answer" in answer["error"], f"an answer of the flood: {answer}")
            taken += [answer["id"]] if answer["ok"] else []
expect(len(taken) > 200 and taken == sorted(taken), f"of the flood {len(taken)} were taken")
rig.until(is_at(3e5 + 1e5 * (taken[-1] % 2)), "the last word of the flood")
for i in range(50):
    expect(client.ask({"command": "follow", "pressure_Pa": 4e5 + 1e3 * i, "interval_s": 0.05})["ok"], "a set point of a stream")
rig.until(is_at(4.49e5), "the end of the stream")

# A commander that dies: the pressure comes to rest on its way.
expect(client.ask({"command": "move_to", "pressure_Pa": 2e5})["ok"], "the way down")
rig.until(is_at(2e5), "the lower end")
expect(client.ask({"command": "jog", "rate_Pa_per_s": 200})["ok"], "a slow jog")
client.close()
status = rig.until(lambda s: s["commander"] is None and not s["moving"], "the stop after the commander's death")
expect(status["state"] == "active" and status["target_Pa"] < 6e5, f"it went on: {status}")
expect(rig.command("disable").returncode == 0 and rig.status()["u_V"] == 0, "disable")
refused(other.ask({"command": "move_to", "pressure_Pa": 5e5}), "not enabled")
ended, log = rig.end()
expect(ended == 0 and "is gone: stop" in log and "fault" not in log, f"the end: {ended}: {log}")
parts = rig.parts()
expect(any("/kept/" in part for part in parts), f"no file of the mark was kept: {parts}")
done = run("replay", CONFIG, *parts, "--set", "serve.part_s=60")
expect(done.returncode == 0 and "bit for bit" in done.stdout, f"replay: {done.stdout[-600:]} {done.stderr[-600:]}")
with gzip.open(parts[0], "rt") as file:
    names = next(line for line in file if not line.startswith("#")).strip().split(",")
expect("command_Pa" in names and "command_m" not in names, f"columns {names}")

# A fault: the valve is shut, commands are refused, the way back is reset and enable.
rig = Served(CONFIG, "faulty", "--fault", "emergency_stop@300+1")
expect(rig.command("enable").returncode == 0, "enable before the fault")
rig.until(lambda s: s["faults"], "the fault")
for words in (("move", "4e5"), ("enable",)):
    done = rig.command(*words)
    expect(done.returncode == 1 and "fault is latched" in done.stderr, f"{words} in a fault: {done}")
expect(rig.status()["u_V"] == 0 and rig.command("reset").returncode == 0 and rig.command("enable").returncode == 0, "reset and enable")
expect(rig.command("move", "4e5", "--wait").returncode == 0, "a move after the fault")
rig.end()
expect(any("/kept/" in part for part in rig.parts()), "the file of the fault was not kept")

# From data sheets: a proportional valve and two on/off valves.
SHEET = ["--rig", "pressure", "--volume", "0.5 l", "--line-length", "3 m", "--line-diameter", "4 mm", "--supply", "6 bar gauge"]
for name, valve, words in (("proportional", ["--flow", "100 l/min"], "signal: 0 to 10 V"),
                           ("on-off", ["--flow", "0.2 l/(s bar)", "--switching-on", "3 ms", "--switching-off", "2 ms"], "switching_time_on: 3 ms")):
    path = at(name + ".yaml")
    done = run("new-rig", path, "--name", name, *SHEET, *valve)
    expect(done.returncode == 0 and "% of the range" in done.stdout, f"new-rig {name}: {done.stdout}{done.stderr}")
    expect(words in open(path).read(), f"new-rig {name} wrote no '{words}'")
    done = run("check", path)
    expect("found" not in done.stderr and "steps" in done.stdout or "error" in done.stdout, f"check {name}: {done.stdout}{done.stderr}")
    rig = Served(path, name)
    expect(rig.command("enable").returncode == 0 and rig.command("move", "3 bar gauge", "--wait").returncode == 0, f"a move of {name}")
    rig.until(is_at(401325), f"3 bar of {name}")
    rig.end()
for arguments, words in ((SHEET + ["--flow", "100 l/min", "--bore", "32 mm"], ["--bore: found with --rig pressure"]),
                         (SHEET + ["--flow", "100 l/min", "--speed", "0.1 m/s"], ["--rate"]),
                         (SHEET + ["--flow", "100 l/min", "--switching-on", "3 ms"], ["--switching-off"]),
                         (SHEET, ["--flow '700 l/min'"])):
    expect_refusal(run("new-rig", at("no.yaml"), *arguments), words, " ".join(arguments[-2:]))
