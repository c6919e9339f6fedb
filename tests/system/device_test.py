#!/usr/bin/env python3
# The verb device and a controller as two processes with real frames between them, over a local socket; what the fault of a
# node does, and the way back. On a kernel with CAN the same over vcan0.
import atexit, gzip, json, os, re, signal, subprocess, sys, tempfile, time
from concurrent.futures import ThreadPoolExecutor

import yaml

from program import expect, expect_refusal, program, rows_so_far, run, wait_until

CONFIG = "config/can/cylinder-10m-7.65mm.yaml"
folder = tempfile.mkdtemp()
signal.signal(signal.SIGHUP, signal.SIG_DFL)  # under nohup it would stay ignored, on purpose
# Slow enough for a loaded machine; what is shown here is no matter of speed.
SLOW = ["period_s=0.02", "hal.can.heartbeat_s=0.1", "hal.can.watchdog_s=0.5", "hal.can.nodes.io.heartbeat_s=0.2",
        "hal.can.nodes.encoder.heartbeat_s=0.2", "estimator.cells_per_m=0.5", "controller.velocity_filter_s=0.05",
        "controller.position_gain_N_per_m=1500", "controller.force_gain_V_per_N=0.0008", "reference.amplitude_m=0.02",
        "reference.frequency_Hz=0.2", "sensors.port_pressure.noise_Pa=300"]
sets = [word for one in SLOW for word in ("--set", one)]


def interfaces():
    yield "unix:" + os.path.join(folder, "bus")
    have = subprocess.run(["ip", "link", "show", "vcan0"], capture_output=True).returncode == 0
    made = have or subprocess.run(["ip", "link", "add", "vcan0", "type", "vcan"], capture_output=True).returncode == 0
    if made and subprocess.run(["ip", "link", "set", "vcan0", "txqueuelen", "16", "up"], capture_output=True).returncode == 0:
        yield "vcan0"
    else:
        print("vcan0 cannot be made on this kernel: the runs over it are left out here (local socket alone)")


class Device:
    def __init__(self, interface, *more):
        self.process = subprocess.Popen([program, "device", CONFIG, "--can", interface, *sets, *more], stdin=subprocess.PIPE,
                                        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        atexit.register(self.process.kill)  # a test that fails leaves nothing behind
        expect("are on the bus" in self.process.stderr.readline(), "device: does not begin")

    def end(self):
        self.process.terminate()
        out, err = self.process.communicate(timeout=30)
        expect(self.process.returncode == 0, f"device: status {self.process.returncode}: {err}")
        return out


def moves(record):
    """Whether the recording, as far as it is on the disk, ends with a valve that is open."""
    rows = rows_so_far(record)
    return len(rows) > 50 and abs(float(rows[-1][rows[0].index("u_V")])) > 1e-3


def closed(record):
    """Whether the valve was open, and is closed in the last half second on the disk: one row may be a zero on the way."""
    rows = rows_so_far(record)
    volts = [float(row[rows[0].index("u_V")]) for row in rows[1:]]
    return any(volts) and not any(volts[-25:])


def moving_controller(interface, number):
    """A controller whose valve is open. On a loaded machine one may end by a fault of its own before: then another one."""
    for attempt in range(5):
        record = os.path.join(folder, f"{interface.replace('/', '-')}-{number}-{attempt}.csv.gz")
        process = subprocess.Popen([program, "run", CONFIG, *sets, "--set", f"hal.can.interface={interface}", "--time", "real",
                                    "--duration-s", "60", "--record", record], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        wait_until(lambda: moves(record) or process.poll() is not None, "a controller that moves")
        if process.poll() is None:
            return process
    expect(False, f"no controller moves on this machine: {process.communicate()[1]}")


def control(interface, duration_s, *more):
    return run("run", CONFIG, *sets, "--set", f"hal.can.interface={interface}", "--time", "real", "--duration-s", str(duration_s), *more)


def control_to_the_end(interface, duration_s, *more):
    """On a loaded machine a run may end by a fault of its own: then another one."""
    for _ in range(5):
        done = control(interface, duration_s, *more)
        if done.returncode == 0:
            break
    return done


for interface in interfaces():
    record = os.path.join(folder, interface.replace("/", "-") + ".csv.gz")
    device = Device(interface)
    done = control_to_the_end(interface, 3, "--record", record, "--force", "--json", "-")
    expect(done.returncode == 0, f"{interface}: status {done.returncode}: {done.stderr}")
    expect(json.loads(done.stdout)["runs"][0]["faults"] == [], f"{interface}: {done.stdout}")
    expect("can: " in done.stderr and " malformed" in done.stderr and ", 0 malformed, 0 error frames, 0 outputs not sent" in done.stderr,
           f"{interface}: {done.stderr}")
    with gzip.open(record, "rt") as file:
        head = [line for line in file if line.startswith("#")]
    expect(any(line.startswith("# backend: configured") for line in head), "the recording does not name its backend")
    expect(any("x: real, p1_port: real, p2_port: real, p1_chamber: absent" in line for line in head), "channels are not stamped")
    expect(run("replay", CONFIG, record, *sets, "--set", f"hal.can.interface={interface}").returncode == 0, "replay differs")
    # A second controller on the same device, and a fault that is typed while it runs.
    controller = moving_controller(interface, 1)
    device.process.stdin.write("emergency:io:0x3100\n")
    device.process.stdin.flush()
    _, said = controller.communicate(timeout=60)
    expect(controller.returncode == 1, f"emergency: status {controller.returncode}: {said}")
    expect("fault: node_emergency" in said and "node io (2): emergency 0x3100 (voltage)" in said, f"emergency: {said}")
    # The way back is the same command.
    done = control_to_the_end(interface, 1)
    expect(done.returncode == 0, f"after an emergency: {done.stderr}")
    # A controller that is killed: the watchdog of the device closes the valve.
    device.end()
    plant = record.replace(".csv.gz", "-plant.csv.gz")
    device = Device(interface, "--record", plant)
    controller = moving_controller(interface, 2)
    controller.kill()
    controller.communicate()
    wait_until(lambda: closed(plant), "a valve that its device closes")
    expect(device.end().rstrip().endswith("valve 0.0000 V"), "the valve kept the command of a dead controller")
    # The device goes: the controller says what it sees and ends.
    device = Device(interface, "--fault", "off:encoder@1")
    done = control(interface, 20)
    expect(done.returncode == 1 and ("position_missing" in done.stderr or "node_lost" in done.stderr), f"off: {done.stderr}")
    device.end()
    # Faults from a file: a port sensor at the end of its counts, after 2 s.
    device = Device(interface, "--scenario", "config/scenarios/out-of-range.yaml")
    done = control(interface, 20)
    expect(done.returncode == 1 and "fault: port_pressure_1_missing" in done.stderr, f"scenario: {done.stderr}")
    device.end()

# How a controller ends, with a watchdog that comes too late to matter: every signal that can be caught leaves the safe output
# and a recording; after a crash there is a last record beside it. kill -9 shows that the valve was open.
def ends_by(number):
    bus_path = "unix:" + os.path.join(folder, f"ends {number.name}")
    late_watchdog = ["--set", "hal.can.watchdog_s=30", "--set", "reference.amplitude_m=0.04"]
    for attempt in range(5):  # on a loaded machine a run may end by a fault of its own before the signal: it shows nothing
        record = os.path.join(folder, f"{number.name}-{attempt}.csv.gz")  # not one that an attempt before has left
        device = Device(bus_path, *late_watchdog)
        controller = subprocess.Popen([program, "run", CONFIG, *sets, *late_watchdog, "--set", f"hal.can.interface={bus_path}", "--time", "real",
                                       "--duration-s", "60", "--record", record], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        wait_until(lambda: moves(record) or controller.poll() is not None, "a controller that moves")
        controller.send_signal(number)
        _, said = controller.communicate(timeout=60)
        valve_V = float(re.search(r"valve (\S+) V", device.end()).group(1))
        if "fault: " not in said and (number != signal.SIGKILL or abs(valve_V) > 1e-3):  # or killed where the command passes zero
            break
    if number == signal.SIGKILL:
        expect(abs(valve_V) > 1e-3, "kill -9: the valve was closed, the test shows nothing")
        return
    expect(valve_V == 0.0, f"{number.name}: the valve has {valve_V} V: {said}")
    done = run("replay", CONFIG, record, *sets, *late_watchdog, "--set", f"hal.can.interface={bus_path}")
    expect(done.returncode == 0, f"{number.name}: replay: {done.stdout}{done.stderr}")
    if number in (signal.SIGSEGV, signal.SIGABRT):
        expect(controller.returncode == -number, f"{number.name}: status {controller.returncode}: {said}")
        with open(record.replace(".csv.gz", ".crash.txt")) as file:
            expect("safe output was sent to every device" in file.read(), f"{number.name}: the last record")
    else:
        expect(controller.returncode == 0 and f"stopped by {number.name}" in said and "cut off" not in done.stderr,
               f"{number.name}: status {controller.returncode}: {said}{done.stderr}")
        expect("the safe output of 0 V was sent at t = " in said and "read back at t = " in said, f"{number.name}: {said}")


with ThreadPoolExecutor(2) as pool:  # each on a bus of its own; they wait for most of the time
    list(pool.map(ends_by, (signal.SIGHUP, signal.SIGQUIT, signal.SIGTSTP, signal.SIGUSR1, signal.SIGALRM, signal.SIGSEGV,
                            signal.SIGABRT, signal.SIGKILL)))

# Commands that no longer arrive, and two answers a cycle: both ways to the safe state, and words for what is known.
for scenario, fault, words in (("deaf-output", "output_unconfirmed", "NOT confirmed"),
                               ("pre-operational", "", "NOT confirmed"),
                               ("double-answer", "double_answer", "and read back at t = ")):
    for _ in range(5):  # a valve that goes deaf while it is about closed shows the safe output, rightly
        device = Device(interface, "--scenario", f"config/scenarios/device/{scenario}.yaml")
        done = control(interface, 20)
        expect(done.returncode == 1 and f"fault: {fault}" in done.stderr, f"{scenario}: {done.stderr}")
        time.sleep(1.0)  # the device's own watchdog of 0.5 s
        expect(device.end().rstrip().endswith("valve 0.0000 V"), f"{scenario}: the valve kept its command")
        if words in done.stderr:
            break
    expect("the safe output of 0 V was sent at t = " in done.stderr and words in done.stderr, f"{scenario}: {done.stderr}")

# Verbs home and zero over the bus: an incremental encoder that counts from 40 mm, a pressure sensor 1.2 kPa off.
bus_path = "unix:" + os.path.join(folder, "named steps")
steps = ["--set", "sensors.position.incremental=true", "--set", "hal.channels.x.can.lowest_m=-0.3"]
over_bus = ["--set", f"hal.can.interface={bus_path}", "--time", "real"]
zeros = os.path.join(folder, "zeros.yaml")
for end in ("low", "high"):
    device = Device(bus_path, *steps, "--set", "initial.position_m=0.04", "--set", "effects={'sensor_offset:x': {offset: -0.04}}")
    expect_refusal(run("run", CONFIG, *sets, *steps, *over_bus, "--duration-s", "1"), ["incremental", "verb home"], "no zero yet")
    done = run("home", CONFIG, *sets, *steps, *over_bus, "--end", end, "--write", zeros)
    expect(done.returncode == 0 and f"{end} end at" in done.stdout, f"home over the bus: {done.stdout}{done.stderr}")
    with open(zeros) as file:
        expect(abs(yaml.safe_load(file)["zeros"]["x"] - 0.04) < 1e-3, f"home over the bus, {end}: zero")
    done = run("run", CONFIG, *sets, *steps, *over_bus, "--zeros", zeros, "--duration-s", "1")
    expect(done.returncode == 0, f"run with zeros over the bus: {done.stderr}")
    device.end()
vented = ["--set", "initial={pressure_1_Pa: 101325, pressure_2_Pa: 101325}"]
device = Device(bus_path, *vented, "--set", "effects={'sensor_offset:p2_port': {offset: 1200}, 'sensor_offset:p_supply': {offset: -598675}}")
done = run("zero", CONFIG, *sets, *over_bus, "--write", zeros)
expect(done.returncode == 0, f"zero over the bus: {done.stderr}")
with open(zeros) as file:
    found = yaml.safe_load(file)["zeros"]
expect(abs(found["p2_port"] + 1200) < 100 and abs(found["p1_port"]) < 100, f"zero over the bus: {found}")
device.end()

# Outputs that nothing would close without this program: no start.
BOARD = "config/comedi/cylinder-10m-7.65mm.yaml"
other = "hal.channels.u.can.object=0x21000110"
expect_refusal(run("run", CONFIG, "--time", "real", "--set", other), ["hal.channels.u.can.substitute", "0x21000110"], "no substitute")
expect_refusal(run("run", BOARD, "--time", "real", "--set", "hal.comedi={}"), ["hal.comedi.watchdog", "enable_line"], "no watchdog")
edited = os.path.join(folder, "edited.yaml")
for config, old, new, status, words in (
        (CONFIG, "object: 0x64110110", "object: 0x21000110", 2, "hal.channels.u.can.substitute: found nothing for object 0x21000110"),
        (CONFIG, "x:        {can: {node: encoder, pdo: 1, object: 0x60200120", "x:        {simulated: true} # {", 2, "beside a real valve"),
        (BOARD, "watchdog: external", "watchdog: none", 1, "NOTHING closes the valve"),
        (BOARD, ", watchdog: external", "", 2, "hal.comedi.watchdog: found nothing")):
    with open(config) as source, open(edited, "w") as target:
        text = source.read()
        expect(old in text, f"{config} has no '{old}'")
        target.write(text.replace(old, new))
    done = run("check", edited)
    expect(done.returncode == status and words in done.stdout + done.stderr, f"check with {new}: {done.returncode}: {done.stdout}{done.stderr}")

over_nothing = run("run", CONFIG, "--set", "hal.can.interface=unix:/nonexistent", "--time", "real")
expect(over_nothing.returncode == 1 and "nobody listens there" in over_nothing.stderr, f"nobody: {over_nothing.stderr}")
expect_refusal(run("run", CONFIG), ["--time", "expected --time real"], "simulated time on real devices")
expect_refusal(run("device", "config/cylinder-2m-6.10mm.yaml", "--can", "vcan0"), ["hal.can: found nothing"], "a rig without hal")
expect_refusal(run("device", CONFIG, "--can", "unix:" + folder + "/b", "--fault", "freeze:nonsense@1"),
               ["nonsense", "x, p1_port"], "a fault of nothing")
expect(run("run", CONFIG, "--hal", "sim", "--duration-s", "1").returncode == 0, "--hal sim")
check = run("check", CONFIG, "--json", "-")
bus = [one for one in json.loads(check.stdout)["config"] if one["topic"] == "bus load"]
expect(len(bus) == 1 and bus[0]["level"] == "good" and bus[0]["found"].startswith("41.0 % of 1 ms"), f"check: {bus}")
fast = os.path.join(folder, "fast.yaml")
with open(CONFIG) as source, open(fast, "w") as target:
    target.write(source.read().replace("period_s: 0.001", "period_s: 0.0002"))
check = run("check", fast)
expect(check.returncode == 1 and "DA/AD boards" in check.stdout, f"check at 200 us: {check.stdout}")
