#!/usr/bin/env python3
# The axis as a CiA 402 drive under an independent master, the drive class of python-canopen: 100 moves, 10 000 set points
# in cyclic mode, faults, quick stop, another commander, masters that die in motion.
# tags: long
import atexit, glob, gzip, json, math, os, random, re, signal, subprocess, sys, tempfile, time

from canopen_env import with_canopen

with_canopen()
import canopen  # noqa: E402
from canopen.profiles.p402 import BaseNode402  # noqa: E402

sys.path.append("tools")
from local_can import LocalCan  # noqa: E402
from program import expect, expect_refusal, program, run  # noqa: E402

CONFIG = "config/served/cylinder-10m-7.65mm.yaml"
NODE = 5
PATIENCE_S = 30.0  # waits for what must come; a machine with other work answers late
LONG = os.environ.get("PNEUSERVO_LONG") is not None
folder = tempfile.TemporaryDirectory()


def at(name):
    return os.path.join(folder.name, name)


def drive_keys(bus):
    return ["--set", f"serve.drive.interface=unix:{bus}", "--set", f"serve.drive.node_id={NODE}"]


class Served:
    """The axis with its drive on a local bus."""

    def __init__(self, name, *options, time_kind="simulated"):
        self.bus, self.socket, self.records, self.log = at(name + ".bus"), at(name + ".sock"), at(name), at(name + ".log")
        self.process = subprocess.Popen([program, "serve", CONFIG, "--time", time_kind, "--socket", self.socket, "--record", self.records,
                                         *drive_keys(self.bus), *options], stderr=open(self.log, "w"))
        atexit.register(self.process.kill)

    def command(self, *words):
        return run("command", *words, "--socket", self.socket)

    def end(self):
        self.process.send_signal(signal.SIGTERM)
        self.process.wait(timeout=60)
        return open(self.log).read()

    def rows(self, *columns):
        for part in sorted(glob.glob(self.records + "/*.csv.gz") + glob.glob(self.records + "/kept/*.csv.gz"), key=os.path.basename):
            names = None
            for line in gzip.open(part, "rt"):
                if line.startswith("#"):
                    continue
                fields = line.rstrip("\n").split(",")
                if names is None:
                    names = {name: i for i, name in enumerate(fields)}
                    continue
                yield [fields[names[column]] for column in columns]


    def set_points_um(self):
        """The set points that were taken, in the order of the record."""
        return [round(float(place_m) * 1e6) for kind, place_m in self.rows("command_kind", "command_m") if kind == "11"]


class Master:
    """A PLC: one network, one drive."""

    def __init__(self, served, eds):
        self.network = canopen.Network()
        self.network.bus = LocalCan(served.bus)
        self.network.connect()
        self.drive = BaseNode402(NODE, eds)
        self.drive.sdo.RESPONSE_TIMEOUT = PATIENCE_S
        for limit in ("SWITCH_OP_MODE", "SWITCH_STATE_FINAL", "SWITCH_STATE_SINGLE", "CHECK_TPDO", "RESET_FAULT", "HOMING_DEFAULT"):
            setattr(self.drive, "TIMEOUT_" + limit, PATIENCE_S)
        self.network.add_node(self.drive)
        self.drive.nmt.state = "PRE-OPERATIONAL"
        self.drive.sdo[0x1017].raw = 50
        self.drive.setup_402_state_machine()
        self.drive.nmt.state = "OPERATIONAL"
        self.until(lambda: self.drive.state != "NOT READY TO SWITCH ON", "the axis", 120.0)

    def until(self, holds, what, patience_s=30.0):
        end = time.monotonic() + patience_s
        while not holds():
            expect(time.monotonic() < end, f"{what} did not come: statusword {self.drive.sdo[0x6041].raw:#06x}, state {self.drive.state}")
            time.sleep(0.002)

    def bit(self, bit):
        return bool(self.drive.sdo[0x6041].raw & 1 << bit)

    def enable(self, mode):
        self.drive.op_mode = mode
        self.drive.state = "SWITCHED ON"
        self.drive.state = "OPERATION ENABLED"

    def move(self, target_um, extra=0):
        """One set point by the handshake of the profile position mode; returns when it is reached."""
        self.drive.sdo[0x607A].raw = target_um
        self.drive.controlword = 0x000F | extra
        self.drive.controlword = 0x001F | extra
        self.until(lambda: self.bit(12), "the acknowledgement")
        self.drive.controlword = 0x000F | extra
        self.until(lambda: not self.bit(12) and self.bit(10), "the target")

    def actual_um(self):
        return self.drive.sdo[0x6064].raw

    def watch(self, milliseconds):
        """The drive watches this master's heartbeat, which begins."""
        self.drive.sdo[0x1016][1].raw = 127 << 16 | milliseconds
        self.heartbeat = self.network.send_periodic(0x77F, [5], milliseconds / 5e3)
        time.sleep(milliseconds / 1e3)

    def stream(self, count, cycle_s=0.0):
        """Drives so many set points in cyclic synchronous position mode, one a cycle and SYNC; the plan in um."""
        drive, rpdo, tpdo = self.drive, self.drive.rpdo[2], self.drive.tpdo[2]
        drive.sdo[0x6098].raw = 0
        drive.nmt.state = "PRE-OPERATIONAL"
        rpdo.clear()
        rpdo.add_variable(0x607A)
        rpdo.trans_type = 1
        rpdo.enabled = True
        rpdo.save()
        tpdo.trans_type = 1
        tpdo.save()
        drive.sdo[0x60C2][1].raw = 10
        drive.nmt.state = "OPERATIONAL"
        self.enable("CYCLIC SYNCHRONOUS POSITION")
        expect(drive.state == "OPERATION ENABLED" and drive.op_mode == "CYCLIC SYNCHRONOUS POSITION", "cyclic mode")
        begin_um = drive.sdo[0x6062].raw
        plan = [round(begin_um * (1 - i / count) + 60_000 * math.sin(0.02 * i)) for i in range(1, count + 1)]
        due = time.monotonic()
        for place in plan:
            rpdo[0].raw = place
            rpdo.transmit()
            tpdo.is_received = False
            self.network.sync.transmit()
            end = time.monotonic() + 5.0
            while not tpdo.is_received:  # a PLC's cycle: SYNC out, actual values in
                expect(time.monotonic() < end, "no actual values after SYNC")
                time.sleep(0.0005)
            due += cycle_s
            time.sleep(max(0.0, due - time.monotonic()))
        self.until(lambda: drive.sdo[0x6062].raw == plan[-1], "the last set point")
        expect(drive.state == "OPERATION ENABLED", f"after the stream: {drive.state}")
        return plan

    def die(self):
        self.network.disconnect()


def documented(eds):
    """Every object of the drive stands in the document with its access, and no other."""
    table = dict(re.findall(r"^\| `0x([0-9A-F]{4})` \| ([^|]+?) \|", open("docs/drive.md").read().split("## Error codes")[0], re.MULTILINE))
    own = {f"{index:04X}": entry.name for index, entry in eds.items() if index >= 0x2000}
    expect(table == own, f"docs/drive.md and the dictionary differ: {sorted(set(table.items()) ^ set(own.items()))}")


expect_refusal(run("serve", CONFIG, "--eds", at("no.eds")), ["serve.drive", "node_id"], "an EDS without a drive")
expect(run("serve", CONFIG, *drive_keys("x"), "--eds", at("drive.eds")).returncode == 0, "the EDS was not written")
eds = canopen.import_od(at("drive.eds"), NODE)
documented(eds)

served = Served("axis", "--set", "serve.part_s=600")
master = Master(served, at("drive.eds"))
drive = master.drive
expect(drive.state == "SWITCH ON DISABLED", f"after power-on: {drive.state}")
expect(drive.sdo[0x6502].raw == 0xA1 and drive.sdo[0x60A8].raw == 0xFA010000, "modes or units")
expect((drive.sdo[0x607D][1].raw, drive.sdo[0x607D][2].raw) == (-120000, 120000), "the software limits")

# Profile position.
master.enable("PROFILED POSITION")
expect(drive.state == "OPERATION ENABLED", f"after enable: {drive.state}")
draw = random.Random(1)
moves = 100 if LONG else 15
for i in range(moves):
    drive.sdo[0x6081].raw = draw.randrange(50_000, 400_001)
    target = draw.randrange(-120_000, 120_001)
    master.move(target)
    expect(drive.sdo[0x6062].raw == target, f"move {i}: demand {drive.sdo[0x6062].raw}, target {target}")
    master.until(lambda: abs(master.actual_um() - target) < 2000, f"the axis of move {i}")
print(f"{moves} moves reached")

# Relative; beyond the limits: held to them, and said.
master.move(0)
master.move(-20_000, 0x40)
expect(drive.sdo[0x6062].raw == -20_000 and not master.bit(11), "a relative move")
master.move(500_000)
expect(drive.sdo[0x6062].raw == 120_000 and master.bit(11), "a target beyond the limit")
master.move(0)
expect(not master.bit(11), "the limit's bit after a move within")

# Halt and on again; a set point that replaces the one under way.
drive.sdo[0x6081].raw = 1_000
drive.sdo[0x607A].raw = 100_000
drive.controlword = 0x001F
drive.controlword = 0x010F
master.until(lambda: master.bit(10), "the halt")
expect(abs(drive.sdo[0x6062].raw) < 50_000 and abs(drive.sdo[0x606B].raw) < 10, "the axis did not halt")
drive.controlword = 0x000F
drive.sdo[0x6081].raw = 400_000
master.move(-50_000, 0x20)
expect(drive.sdo[0x6062].raw == -50_000, "a set point at once")

# What SDO refuses.
for index, value in ((0x6060, 3), (0x6098, 17), (0x6083, 1), (0x6007, 7)):
    try:
        drive.sdo[index].raw = value
        expect(False, f"{index:#06x} = {value} was taken")
    except canopen.SdoAbortedError:
        pass

# Homing: the place is known; the zero of the bus can be put where the axis stands.
expect(drive.homing(timeout=PATIENCE_S) and drive.sdo[0x6062].raw == -50_000, "homing of an absolute axis")
drive.controlword = 0x000F
drive.sdo[0x6098].raw = 37
drive.sdo[0x607C].raw = 1_000
expect(drive.homing(timeout=PATIENCE_S) and drive.sdo[0x6062].raw == 1_000, "the zero where the axis stands")
expect(drive.sdo[0x607D][1].raw == -120_000 + 51_000, "the limits after homing")
drive.controlword = 0x000F
drive.sdo[0x607C].raw = -50_000
expect(drive.homing(timeout=PATIENCE_S) and drive.sdo[0x6062].raw == -50_000, "the zero back")

# Quick stop in motion: at rest, then safe output; and with code 6 it holds its place.
drive.op_mode = "PROFILED POSITION"
drive.controlword = 0x000F
for code, end in ((2, "SWITCH ON DISABLED"), (6, "QUICK STOP ACTIVE")):
    master.enable("PROFILED POSITION")
    drive.sdo[0x605A].raw = code
    drive.sdo[0x6081].raw = 1_000
    drive.sdo[0x607A].raw = 100_000
    drive.controlword = 0x001F
    master.until(lambda: drive.sdo[0x606B].raw > 500, "the motion")
    drive.controlword = 0x0002
    master.until(lambda: drive.state == end, f"{end} after a quick stop")
    time.sleep(0.1)
    expect(drive.state == end, f"{end} did not stay")
drive.state = "SWITCH ON DISABLED"

# The others: while the drive has the axis nobody else commands; after it they may, and the drive is told.
master.enable("PROFILED POSITION")
done = served.command("move", "0.01")
expect(done.returncode == 1 and "node 5" in done.stderr, f"a second commander: {done}")
expect(served.command("disable").returncode == 0, "disable of another client")
master.until(lambda: drive.state == "SWITCH ON DISABLED", "the state after another's disable")

# Cyclic synchronous position: target and controlword by PDO on SYNC, a set point every 10 ms of the master's plan.
plan = master.stream(1_000)
master.until(lambda: abs(master.actual_um() - plan[-1]) < 2000, "the axis at the last set point")
expect(master.bit(12) and not master.bit(13), "bits of the cyclic mode")

# A master whose heartbeat ends in the midst of a stream: a quick stop, at rest the safe output.
drive.sdo[0x6007].raw = 3
drive.sdo[0x605A].raw = 2
master.watch(200)
drive.rpdo[2][0].raw = plan[-1] + 5_000
drive.rpdo[2].transmit()
master.network.sync.transmit()
master.heartbeat.stop()
master.until(lambda: drive.sdo[0x6041].raw & 0x6F in (0x40, 0x60), "the safe output after the heartbeat's end")
master.die()
log = served.end()
expect("fault" not in log, f"a fault: {log}")
taken = served.set_points_um()
rest = iter(plan + [plan[-1] + 5_000])
expect(all(place in rest for place in taken), "set points were taken out of order, or others than were sent")
# In simulated time the axis is not clocked with the master: a newer set point may replace one that waits.
expect(len(taken) > 2, f"{len(taken)} set points were taken of {len(plan)}")
print(f"{len(taken)} of {len(plan) + 1} set points taken in simulated time, in order")

# In real time the axis takes every one of them.
if LONG:
    axis = Served("stream", "--set", "serve.part_s=600", time_kind="real")
    plc = Master(axis, at("drive.eds"))
    plan = plc.stream(10_000, cycle_s=0.01)
    plc.drive.state = "SWITCH ON DISABLED"
    plc.die()
    log = axis.end()
    taken = axis.set_points_um()
    expect("fault" not in log and taken == plan, f"of {len(plan)} set points {len(taken)} were taken in real time: {log}")
    print(f"{len(taken)} of {len(plan)} set points taken in real time")

# A master that dies in motion, its socket and all: as serve.commander_lost says.
for lost, end_state in (("stop", "active"), ("finish", "active"), ("safe", "safe_stop")):
    axis = Served("lost-" + lost, "--set", f"serve.commander_lost={lost}")
    plc = Master(axis, at("drive.eds"))
    plc.enable("PROFILED POSITION")
    plc.drive.sdo[0x6081].raw = 400
    plc.drive.sdo[0x607A].raw = 100_000
    plc.drive.controlword = 0x001F
    plc.until(lambda: plc.bit(12), "the acknowledgement")
    plc.die()
    end = time.monotonic() + 20
    while True:
        status = json.loads(axis.command("status", "--json").stdout)
        if status["commander"] is None and (lost == "finish" or not status["moving"]):
            break
        expect(time.monotonic() < end, f"{lost}: the commander is still there: {status}")
    expect(status["state"] == end_state, f"{lost}: {status}")
    expect(status["moving"] == (lost == "finish"), f"{lost}: {status}")
    log = axis.end()
    expect("node 5" in log and lost in log, f"{lost}: the log says nothing: {log}")

# A fault of the axis: state, code, register; reset by the edge of bit 7; then it moves again.
def enabled_before(fault_s):
    """An axis that is enabled when its encoder falls silent at this simulated time, and the emergencies; None: it fell silent before."""
    axis = Served(f"fault-{fault_s}", "--fault", f"drop:x@{fault_s}+0.5")
    plc = Master(axis, at("drive.eds"))
    errors = []
    plc.drive.emcy.add_callback(lambda error: errors.append(error.code))
    try:
        plc.enable("PROFILED POSITION")
        if not errors:
            return axis, plc, errors
    except (RuntimeError, ValueError):
        pass
    plc.die()
    axis.end()
    return None


axis, plc, errors = next(filter(None, map(enabled_before, (300, 3000, 30000))))
plc.until(lambda: plc.drive.state == "FAULT", "the fault", 120.0)
expect(plc.drive.sdo[0x603F].raw == 0x7305 and plc.drive.sdo[0x2000][1].raw & 1, f"code {plc.drive.sdo[0x603F].raw:#06x}")
time.sleep(0.3)
plc.drive.reset_from_fault()
expect(plc.drive.state == "OPERATION ENABLED" and plc.drive.sdo[0x603F].raw == 0, f"after the reset: {plc.drive.state}")
plc.move(10_000)
expect(errors == [0x7305, 0], f"emergencies {errors}")
plc.die()
axis.end()

# The master that docs/your-axis.md begins with.
axis = Served("example")
done = subprocess.run([sys.executable, "tools/canopen-master", "unix:" + axis.bus, "--eds", at("drive.eds"), "--speed", "200", "20", "-10"],
                      capture_output=True, text=True, timeout=300)
expect(done.returncode == 0 and done.stdout.count("at ") == 2 and "asked for -10 mm" in done.stdout, f"tools/canopen-master: {done.stdout}{done.stderr}")
axis.end()
