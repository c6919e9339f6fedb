#!/usr/bin/env python3
# An axis that is served: commands of good and bad clients, a commander that dies, a fault, recordings and their replay.
import gzip, os, socket, threading

from program import expect, expect_refusal, run
from served import Client, Served, at, refused

CONFIG = "config/served/cylinder-10m-7.65mm.yaml"
PASS_BEGINS = 32  # of the column flags

# What serve does not take.
expect_refusal(run("serve", "config/cylinder-10m-7.65mm.yaml", "--socket", at("no.sock")), ["reference.kind", "live"], "a fixed reference")
expect_refusal(run("check", CONFIG, "--set", "reference.highest_m=0.2"), ["reference"], "a range beyond the stroke")
expect_refusal(run("check", CONFIG, "--set", "reference.lowest_m=0.12"), ["highest_m", "lowest_m"], "an empty range")
expect_refusal(run("check", CONFIG, "--set", "reference.speed_mps=9"), ["speed"], "a speed beyond the valve")
expect_refusal(run("command", "status", "--socket", at("nobody.sock")), ["nobody.sock", "serve"], "no axis there")

# `run` plays the trial motion by the formula, and its replay knows.
done = run("run", CONFIG, "--duration-s", "2", "--record", at("trial.csv.gz"))
expect(done.returncode == 0 and "not for the trial motion" in done.stderr, f"run of a served config: {done}")
done = run("replay", CONFIG, at("trial.csv.gz"))
expect(done.returncode == 0 and "bit for bit" in done.stdout and "another config" not in done.stderr, f"its replay: {done}")

axis = Served(CONFIG, "axis", "--set", "serve.part_s=20")
expect_refusal(run("serve", CONFIG, "--socket", axis.socket), ["another program"], "a second axis at the same socket")

# Before enable nothing moves.
done = axis.command("move", "0.05")
expect(done.returncode == 1 and "not enabled" in done.stderr, f"a move before enable: {done}")
status = axis.status()
expect(status["state"] == "inactive" and abs(status["x_m"]) < 1e-5, f"not at rest: {status}")
expect(axis.command("enable").returncode == 0, "enable was refused")
done = axis.command("move", "0.05", "--speed", "0.2", "--wait")
expect(done.returncode == 0 and "50.000 mm" in done.stdout, f"a move: {done}")
axis.until(lambda s: abs(s["x_m"] - 0.05) < 1e-3, "the target of the move")
expect(axis.command("move-by", "-0.02", "--wait").returncode == 0, "a relative move was refused")
axis.until(lambda s: abs(s["target_m"] - 0.03) < 1e-12 and abs(s["x_m"] - 0.03) < 1e-3, "the target of the relative move")

# Bad input: one sentence each, and the axis stays where it is.
client = Client(axis.socket)
refused(client.ask(b"move\n"), "no JSON object")
refused(client.ask(b'[1]\n'), "no JSON object")
refused(client.ask(b'{"version":1,"command":"enable","command":"disable"}\n'), "command: found twice")
refused(client.ask(b'\xff\xfe{}\n'), "no JSON object")
refused(client.ask(b'{"command":"move_to","position_m":0.1}\n'), "version")
refused(client.ask({"version": 2, "command": "status"}), "version", "2")
refused(client.ask({"command": "fly"}), "fly", "enable")
refused(client.ask({"command": "move_to"}), "position_m", "nothing")
refused(client.ask({"command": "move_to", "position_m": 0.5}), "position_m", "0.5", "-0.12 to 0.12")
refused(client.ask({"command": "move_to", "position_m": "0.1"}), "position_m")
refused(client.ask(b'{"version":1,"command":"move_to","position_m":1e999}\n'), "no JSON object")
refused(client.ask({"command": "move_to", "position_m": 0.1, "speed_mps": 3}), "speed_mps", "0.4")
refused(client.ask({"command": "move_to", "position_m": 0.1, "sped": 3}), "sped", "unknown key")
refused(client.ask({"command": "move_by", "way_m": 0.2}), "outside")
refused(client.ask({"command": "jog", "speed_mps": 0}), "speed_mps")
refused(client.ask({"command": "resume"}), "nothing to resume")
refused(client.ask({"command": "enable"}), "enabled already")
refused(client.ask({"command": "reset"}), "no fault")
answer = client.ask({"command": "status", "id": "me"})
expect(answer["id"] == "me" and abs(answer["status"]["target_m"] - 0.03) < 1e-12 and not answer["status"]["moving"], f"something moved: {answer}")

# Two commanders: the second may look, stop and mark, and commands when the first has released.
other = Client(axis.socket)
expect(client.ask({"command": "move_to", "position_m": 0.0})["ok"], "the commander's move")
refused(other.ask({"command": "move_to", "position_m": 0.1}), "commanded by process")
expect(other.ask({"command": "stop"})["ok"] and other.ask({"command": "mark"})["ok"], "stop and mark of a second client")
slow = {"command": "move_to", "position_m": 0.1, "speed_mps": 0.001}
expect(client.ask({"command": "release"})["ok"] and other.ask(slow)["ok"], "command after the release")
expect(other.ask({"command": "hold"})["ok"] and other.ask({"command": "resume"})["ok"], "hold and resume")
expect(other.ask({"command": "move_to", "position_m": 0.1})["ok"], "a faster move to the same place")
axis.until(lambda s: abs(s["x_m"] - 0.1) < 1e-3, "the target after hold and resume")

# A flood is answered line by line, and the last word counts.
flood = 3000
for i in range(flood):
    other.send({"command": "move_to", "position_m": 0.1 * (i % 2), "id": i})
    if i % 100 == 99:
        answers = [other.answer() for _ in range(100)]
        expect(all("error" in a or a["ok"] for a in answers), "an answer of the flood")
other.send(b"x" * 10000)
refused(other.answer(), "4096")
axis.until(lambda s: s["commander"] is None and not s["moving"], "the end of the flood")
expect(axis.status()["state"] == "active", "the flood ended the motion")

# A refused command has no effect: what another commander began goes on.
expect(axis.command("move", "-0.1", "--speed", "0.0005").returncode == 0, "a slow move")
expect(axis.command("enable").returncode == 1 and axis.command("move", "5").returncode == 1, "refused commands")
dumb = Client(axis.socket)
refused(dumb.ask({"command": "enable"}), "enabled already")
dumb.close()
status = axis.until(lambda s: s["commander"] is None, "the end of the refused client")
expect(status["moving"] and abs(status["target_m"] + 0.1) < 1e-9, f"a refused command ended the move: {status}")

# A commander that dies while it jogs: the axis stops.
jogger = Client(axis.socket)
expect(jogger.ask({"command": "move_to", "position_m": -0.1})["ok"], "the way to the lower end")
axis.until(lambda s: not s["moving"], "the lower end")
watcher = Client(axis.socket)
expect(watcher.ask({"command": "watch", "interval_s": 0.01})["ok"] and "status" in watcher.answer(), "watch")
expect(jogger.ask({"command": "jog", "speed_mps": 0.001})["ok"], "jog")
jogger.close()
status = axis.until(lambda s: s["commander"] is None and not s["moving"], "the stop after the commander's death")
expect(status["state"] == "active" and status["target_m"] < 0.12, f"it went on: {status}")
expect(axis.command("disable").returncode == 0 and axis.status()["state"] == "safe_stop", "disable")
done = axis.command("move", "0.05")
expect(done.returncode == 1 and "not enabled" in done.stderr, f"a move after disable: {done}")
expect(axis.command("enable").returncode == 0 and axis.command("move", "0").returncode == 0, "enable once more")
status, log = axis.end()
expect(status == 0 and "is gone: stop" in log and "fault" not in log, f"the end: {status}: {log}")
expect(not os.path.exists(axis.socket), "the socket was left")

# The record has it all: the mark's file is kept, the replay is bit for bit.
parts = axis.parts()
expect(any("/kept/" in part for part in parts), f"no file of the mark was kept: {parts}")
done = run("replay", CONFIG, *parts, "--set", "serve.part_s=20")
expect(done.returncode == 0 and "bit for bit" in done.stdout, f"replay: {done.stdout[-600:]} {done.stderr[-600:]}")
kinds, passes = [], 0
for part in parts:
    with gzip.open(part, "rt") as file:
        rows = (line.rstrip("\n").split(",") for line in file if not line.startswith("#"))
        names = next(rows)
        kind, flags = names.index("command_kind"), names.index("flags")
        for row in rows:
            kinds += [row[kind]] if row[kind] != "0" else []
            passes += int(row[flags]) & PASS_BEGINS != 0
expect(passes >= 2 and "goes by the formula: it takes" in log, f"{passes} moves from rest followed a pass, the slowest has none: {log}")
expect(kinds[:3] == ["1", "4", "5"] and kinds.count("10") == 1 and kinds.count("8") == 1 and kinds.count("9") == 1 and kinds[-3:] == ["2", "1", "4"],
       f"commands in the record: {kinds[:5]} ... {kinds[-5:]}")

# A fault: commands are refused, the way back is reset and enable; the file around it is kept. The service manager is told
# that the axis is ready and lives; commands come over TCP on the loopback, too.
manager = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
manager.bind(at("manager"))
manager.settimeout(20)
free = socket.socket()
free.bind(("127.0.0.1", 0))
port = free.getsockname()[1]
free.close()
axis = Served(CONFIG, "faulty", "--fault", "emergency_stop@300+1", "--set", f"serve.tcp_port={port}", NOTIFY_SOCKET=at("manager"), WATCHDOG_USEC="200000")
expect(manager.recv(4096).decode().startswith("READY=1\n"), "the manager was not told that the axis is ready")
said = []


def listen():
    while b"STOPPING=1" not in said:
        said.append(manager.recv(4096))


listener = threading.Thread(target=listen, daemon=True)
listener.start()
done = run("command", "status", "--tcp", str(port))
expect(done.returncode == 0 and "inactive" in done.stdout, f"status over TCP: {done}")
expect(axis.command("enable").returncode == 0, "enable before the fault")
axis.until(lambda s: s["faults"], "the fault")
done = axis.command("move", "0.05")
expect(done.returncode == 1 and "fault is latched" in done.stderr, f"a move in a fault: {done}")
done = axis.command("enable")
expect(done.returncode == 1 and "fault is latched" in done.stderr, f"enable in a fault: {done}")
expect(axis.command("reset").returncode == 0 and axis.status()["state"] == "inactive", "reset")
expect(axis.command("enable").returncode == 0 and axis.command("move", "0.01", "--wait").returncode == 0, "a move after the fault")
status, log = axis.end()
expect(status == 0 and "fault:" in log, f"the end after a fault: {status}: {log}")
listener.join(10)
expect(b"WATCHDOG=1" in said and said[-1] == b"STOPPING=1", f"the manager was told {said[-5:]}")
expect(any("/kept/" in part for part in axis.parts()), "the file of the fault was not kept")
