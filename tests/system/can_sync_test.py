#!/usr/bin/env python3
# The loop locked to another master's SYNC, over a local socket: the verb device is that master. A run, its replay, and a
# master that falls silent.
# tags: timing
import atexit, json, os, signal, subprocess, tempfile

from program import expect, program, rows_so_far, run, wait_until

CONFIG = "config/can/cylinder-10m-7.65mm.yaml"
folder = tempfile.mkdtemp()
bus = "unix:" + os.path.join(folder, "bus")
# Slow enough for a loaded machine; what is shown here is no matter of speed.
SETS = ["period_s=0.02", "hal.can.sync=foreign", "hal.can.sync_timeout_s=2", "hal.can.heartbeat_s=0.1", "hal.can.watchdog_s=0.5",
        "hal.can.nodes.io.heartbeat_s=2", "hal.can.nodes.encoder.heartbeat_s=2", "estimator.cells_per_m=0.5",
        "controller.velocity_filter_s=0.05", "controller.position_gain_N_per_m=1500", "controller.force_gain_V_per_N=0.0008",
        "reference.amplitude_m=0.02", "reference.frequency_Hz=0.2", "sensors.port_pressure.noise_Pa=300"]
sets = [word for one in SETS for word in ("--set", one)]
controlled = [*sets, "--set", f"hal.can.interface={bus}"]


def device():
    process = subprocess.Popen([program, "device", CONFIG, "--can", bus, *sets], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                               stderr=subprocess.PIPE, text=True)
    atexit.register(process.kill)
    expect("are on the bus" in process.stderr.readline(), "device: does not begin")
    return process


# A run ends well, without a SYNC of its own, and its replay has every bit. On a loaded machine one may end by a fault before.
master = device()
for attempt in range(5):
    record = os.path.join(folder, f"locked-{attempt}.csv.gz")
    done = run("run", CONFIG, *controlled, "--time", "real", "--duration-s", "3", "--record", record, "--json", "-")
    if done.returncode == 0:
        break
expect(done.returncode == 0 and json.loads(done.stdout)["runs"][0]["faults"] == [], f"status {done.returncode}: {done.stderr}")
replayed = run("replay", CONFIG, record, *controlled, "--json", "-")
expect(replayed.returncode == 0 and json.loads(replayed.stdout)["identical"], f"replay: {replayed.stdout}{replayed.stderr}")
expect(len(rows_so_far(record)) > 50, "too few rows")

# The master stops in motion: a fault that says so.
for attempt in range(5):
    record = os.path.join(folder, f"silent-{attempt}.csv.gz")  # not one that an attempt before has left
    controller = subprocess.Popen([program, "run", CONFIG, *controlled, "--time", "real", "--duration-s", "60", "--record", record],
                                  stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    wait_until(lambda: len(rows_so_far(record)) > 50 or controller.poll() is not None, "a run that goes on")
    if controller.poll() is None:
        break
master.send_signal(signal.SIGSTOP)
_, said = controller.communicate(timeout=60)
master.send_signal(signal.SIGCONT)
expect(controller.returncode == 1 and "fault: node_lost" in said, f"status {controller.returncode}: {said}")
expect("no SYNC of the master that the loop waits for" in said, f"a SYNC that is missing: {said}")
master.terminate()
master.communicate(timeout=30)

# Nobody sends SYNC: no start.
lonely = subprocess.Popen([program, "device", CONFIG, "--can", bus, *sets, "--set", "hal.can.sync=own"], stdin=subprocess.PIPE,
                          stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
atexit.register(lonely.kill)
expect("are on the bus" in lonely.stderr.readline(), "device: does not begin")
done = run("run", CONFIG, *controlled, "--time", "real", "--duration-s", "1")
expect(done.returncode == 1 and "hal.can.sync is foreign: found 0 SYNC" in done.stderr, f"no SYNC: {done.stderr}")
lonely.terminate()
lonely.communicate(timeout=30)
