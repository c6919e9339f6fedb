# What the scenarios share: commands, the program as a process, interfaces, figures for the host.
import gzip, json, os, random, signal, subprocess, threading, time

PROGRAM = "/tmp/pneuservo"
CONFIG = "/tmp/config/can/cylinder-10m-7.65mm.yaml"
plan = {}      # from the host: length, what the simulated backend gave there
figures = {}   # to the host


def sh(command, check=True):
    """A shell command; its output."""
    done = subprocess.run(command, shell=True, capture_output=True, text=True)
    if check and done.returncode != 0:
        raise AssertionError(f"{command}: status {done.returncode}: {done.stdout}{done.stderr}")
    return done.stdout


def settings(values):
    return [word for key, value in values.items() for word in ("--set", f"{key}={value}")]


# No machine is drawn where all limits of the motion are stated: under emulation that would take many seconds.
STATED = settings({"limits.deviation_m": 0.02, "limits.speed_deviation_mps": 0.4, "limits.stall_force_N": 150, "limits.speed_mps": 1})


def slow_axis(period_s):
    """An axis whose pressures know nothing of its valve: its slider is moved by a scenario at the terminals of a device."""
    return settings({"period_s": period_s, "estimator.cells_per_m": 0.5, "controller.velocity_filter_s": 0.05,
                     "controller.position_gain_N_per_m": 1500, "controller.force_gain_V_per_N": 0.0008,
                     "controller.pressure_source": "valve", "reference.amplitude_m": 0.02, "reference.frequency_Hz": 0.2,
                     "hal.bench": "true", "limits.flow_mismatch_share": 0, "limits.deviation_m": 0, "limits.speed_deviation_mps": 0,
                     "limits.stall_force_N": 0, "limits.speed_mps": 1})


class Program:
    """The program as a process whose standard error goes to a file, so that it never blocks."""

    count = 0

    def __init__(self, *arguments):
        Program.count += 1
        self.err_path = f"/tmp/program-{Program.count}.err"
        self.arguments = arguments
        with open(self.err_path, "w") as err:
            self.process = subprocess.Popen([PROGRAM, *arguments], stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=err, text=True)

    def said(self):
        with open(self.err_path) as file:
            return file.read()

    def wait_for(self, words, timeout_s=20.0):
        end = time.monotonic() + timeout_s
        while words not in self.said():
            if self.process.poll() is not None or time.monotonic() > end:
                raise AssertionError(f"{self.arguments[:2]}: no word of '{words}': {self.said()}")
            time.sleep(0.01)
        return self

    def type(self, line):
        self.process.stdin.write(line + "\n")
        self.process.stdin.flush()

    def kill(self):
        self.process.kill()
        self.process.communicate()

    def end(self, timeout_s=240.0, terminate=False):
        """Waits for its end; standard output."""
        if terminate and self.process.poll() is None:
            self.process.send_signal(signal.SIGTERM)
        out, _ = self.process.communicate(timeout=timeout_s)
        self.status = self.process.returncode
        return out


class SliderThread(threading.Thread):
    """A slider at the terminals of a device: step(dt_s) four times a period, until it is stopped."""

    def __init__(self, period_s):
        super().__init__(daemon=True)
        self.period_s, self.ends, self.noise, self.x_m = period_s, False, random.Random(1), 0.0

    def run(self):
        last = time.monotonic()
        while not self.ends:
            time.sleep(self.period_s / 4)
            now = time.monotonic()
            self.step(now - last)
            last = now

    def wait_until_driven(self, run, timeout_s=60.0):
        """Waits until a controller's commands have moved it by 0.1 mm, however long its start took."""
        start_m, end = self.x_m, time.monotonic() + timeout_s
        while abs(self.x_m - start_m) < 1e-4:
            if run.process.poll() is not None or time.monotonic() > end:
                raise AssertionError(f"{run.arguments[:2]}: the slider was not driven: {run.said()}")
            time.sleep(0.01)

    def stop(self):
        self.ends = True
        self.join()


def device(interface, *more, config=CONFIG):
    return Program("device", config, "--can", interface, *more).wait_for("are on the bus")


def controller(interface, duration_s, *more, config=CONFIG):
    return Program("run", config, "--set", f"hal.can.interface={interface}", "--time", "real", "--duration-s", str(duration_s),
                   "--json", "-", *STATED, *more)


def finished(run, status=0):
    """Waits for a controller; what it reported of its one run, and what it said."""
    out = run.end()
    said = run.said()
    if run.status != status:
        raise AssertionError(f"{run.arguments}: status {run.status}, expected {status}: {said}")
    return json.loads(out)["runs"][0], said


def replayed(config, record, *more):
    """What a replay of a recording found."""
    replay = Program("replay", config, record, *more, "--json", "-")
    out = replay.end()
    if replay.status not in (0, 1):
        raise AssertionError(f"replay: status {replay.status}: {replay.said()}")
    return json.loads(out)


def rows_of(path):
    """Head lines and rows of a recording as dictionaries of floats (None where a field is empty)."""
    with gzip.open(path, "rt") as file:
        lines = file.read().splitlines()
    head = [line for line in lines if line.startswith("#")]
    body = [line for line in lines if not line.startswith("#")]
    names = body[0].split(",")
    return head, [{name: float(word) if word else None for name, word in zip(names, line.split(","))} for line in body[1:]]


def make_vcan(name, queue=16):
    sh(f"ip link del {name}", check=False)
    sh(f"ip link add {name} type vcan && ip link set {name} txqueuelen {queue} up")
    return name


def make_pair():
    """The two emulated controllers of one bus."""
    for name in ("can0", "can1"):
        sh(f"ip link set {name} down; ip link set {name} type can bitrate 1000000 restart-ms 0; "
           f"ip link set {name} txqueuelen 16 up")
    return "can0", "can1"
