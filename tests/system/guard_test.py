#!/usr/bin/env python3
# pneuservo guard beside a run on the simulated device: kill -9 and SIGSTOP of the loop, a guard that is missing, stopped or
# ends. The device's own watchdog is set far later than the guard, so that what closes the valve is the guard.
# tags: timing
import atexit, os, re, signal, subprocess, sys, tempfile, time

from program import expect, program, run

CONFIG = "config/can/cylinder-10m-7.65mm.yaml"
folder = tempfile.mkdtemp()
NAME = f"test-{os.getpid()}"
# Slow enough for a loaded machine; what is shown here is no matter of speed.
SETS = ["period_s=0.02", "hal.can.heartbeat_s=0.1", "hal.can.watchdog_s=20", "hal.can.nodes.io.heartbeat_s=0.5",
        "hal.can.nodes.encoder.heartbeat_s=0.5", "estimator.cells_per_m=0.5", "controller.velocity_filter_s=0.05",
        "controller.position_gain_N_per_m=1500", "controller.force_gain_V_per_N=0.0008", "reference.amplitude_m=0.02",
        "reference.frequency_Hz=0.2", "limits.lateness_s=5", f"hal.guard={{name: {NAME}, timeout_s: 0.5}}"]
sets = [word for one in SETS for word in ("--set", one)]
bus = "unix:" + os.path.join(folder, "bus")


class Process:
    def __init__(self, *arguments):
        self.log = open(os.path.join(folder, f"{arguments[0]}-{time.monotonic_ns()}"), "w+")
        self.process = subprocess.Popen([program, *arguments], stdin=subprocess.DEVNULL, stdout=self.log, stderr=self.log)
        atexit.register(lambda: self.process.poll() is None and self.process.kill())

    def said(self):
        self.log.flush()
        return open(self.log.name).read()

    def wait_for(self, words, within_s=30.0, beside=None):
        end = time.monotonic() + within_s
        while words not in self.said():
            expect(time.monotonic() < end and self.process.poll() is None,
                   f"never said '{words}': {self.said()}{beside.said() if beside else ''}")
            time.sleep(0.02)

    def end(self, number=signal.SIGTERM):
        self.process.send_signal(number)
        self.process.wait(timeout=30)
        return self.said()


def device():
    started = Process("device", CONFIG, "--can", bus, *sets)
    started.wait_for("are on the bus")
    return started


def guard():
    started = Process("guard", CONFIG, *sets, "--set", f"hal.can.interface={bus}")
    started.wait_for("Ctrl-C ends")
    return started


def loop():
    return Process("run", CONFIG, *sets, "--set", f"hal.can.interface={bus}", "--time", "real", "--duration-s", "60")


def moving_beside(watch):
    """A loop that has moved for 2 s. On a loaded machine a device may be too late for it: then another one."""
    for _ in range(3):
        moving = loop()
        watch.wait_for(f"watches process {moving.process.pid}", beside=moving)
        time.sleep(2.0)
        if f"process {moving.process.pid} ended" not in watch.said():
            return moving
        moving.process.wait(timeout=60)
    expect(False, f"no motion lasts on this machine: {moving.said()}")


def valve_V(device):
    return float(re.search(r"valve (-?[\d.]+) V", device.end()).group(1))


# Without a guard no motion.
dev = device()
missing = run("run", CONFIG, *sets, "--set", f"hal.can.interface={bus}", "--time", "real", "--duration-s", "1")
expect(missing.returncode == 1 and "no guard" in missing.stderr and "pneuservo guard" in missing.stderr, f"no guard: {missing.stderr}")

for number in (signal.SIGKILL, signal.SIGSTOP):
    watch = guard()
    second = run("guard", CONFIG, *sets, "--set", f"hal.can.interface={bus}")
    expect(second.returncode == 1 and f"held by process {watch.process.pid}" in second.stderr, f"a second guard: {second.stderr}")
    moving = moving_beside(watch)
    other = run("run", CONFIG, *sets, "--set", f"hal.can.interface={bus}", "--time", "real", "--duration-s", "1")
    expect(other.returncode == 1 and f"held by process {moving.process.pid}" in other.stderr, f"a second run: {other.stderr}")
    moving.process.send_signal(number)
    watch.wait_for("no sign of life", beside=moving)
    expect("safe output sent" in watch.said(), f"{number.name}: {watch.said()}")
    if number == signal.SIGSTOP:
        moving.process.send_signal(signal.SIGCONT)
        moving.process.wait(timeout=60)
        expect(moving.process.returncode == 1 and "fault: " in moving.said() and "guard_lost" in moving.said(), f"continued: {moving.said()}")
    else:
        moving.process.wait(timeout=30)
        watch.wait_for("is gone")
    watch.end()
    expect(valve_V(dev) == 0.0, f"{number.name}: the valve kept its command")
    dev = device()

# A guard that vanishes or is stopped ends the motion.
for number in (signal.SIGKILL, signal.SIGSTOP):
    watch = guard()
    moving = moving_beside(watch)
    watch.process.send_signal(number)
    moving.process.wait(timeout=60)
    expect(moving.process.returncode == 1 and "fault: guard_lost" in moving.said(), f"guard {number.name}: {moving.said()}")
    watch.process.kill()
    watch.process.wait()

# An ordered end is none of its business beyond the safe output.
watch = guard()
moving = moving_beside(watch)
moving.end(signal.SIGINT)
expect(moving.process.returncode == 0, f"an ordered end: {moving.said()}")
watch.wait_for("ended its motion")
expect("no sign of life" not in watch.said(), f"an ordered end: {watch.said()}")
watch.end()
dev.end()
