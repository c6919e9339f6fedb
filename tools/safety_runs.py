# Runs of the program for tools/safety-table: on the simulated plant, and as two processes with real frames between them.
"""Truth is the plant's own state, recorded by the plant's side: `device --record` of two processes, x_true_m of one."""
import bisect
import gzip
import json
import math
import os
import pathlib
import re
import signal
import subprocess
import threading
import time
import zlib

SOURCE = pathlib.Path(__file__).resolve().parent.parent
CAN = SOURCE / "config/can/cylinder-10m-7.65mm.yaml"
HAL_BEGINS = "# Sensors, valve and what they count."
LINES = [f"{length}m-{diameter}mm" for length in (2, 5, 10) for diameter in ("7.65", "6.10", "4.15")]
SAFE_V = 0.0
PERIOD_S = 0.001
WATCHDOG_S = 0.06


def lines_of(path):
    """Of a recording, also of one that is cut off; whether it was closed."""
    packed = zlib.decompressobj(31)
    try:
        text = packed.decompress(pathlib.Path(path).read_bytes())
    except (OSError, zlib.error):
        return [], False
    return text.decode(errors="replace").splitlines(), packed.eof


class Rows:
    """Columns of a recording as lists; nan where a row has no value."""

    def __init__(self, path):
        lines, self.closed = lines_of(path)
        rows = [line.split(",") for line in lines if line and not line.startswith("#")]
        self.names = rows[0] if rows else []
        rows = [row for row in rows[1:] if len(row) == len(self.names)]
        self.columns = {name: [float(row[i]) if row[i] else math.nan for row in rows] for i, name in enumerate(self.names)}
        self.ticks = [round(t / PERIOD_S) for t in self.columns.get("t_s", [])]

    def __len__(self):
        return len(self.ticks)

    def __getitem__(self, name):
        return self.columns.get(name, [math.nan] * len(self))

    def has(self, name):
        return any(not math.isnan(value) for value in self[name])

    def at(self, name, tick):
        """The value of the newest row at or before a tick."""
        if not self.ticks:
            return math.nan
        return self[name][max(bisect.bisect_right(self.ticks, tick) - 1, 0)]

    def after(self, name, tick):
        return self[name][bisect.bisect_left(self.ticks, tick):]


class Outcome:
    """One run. `truth`: rows of the plant's side, `control`: of the controller's, truth tick = control tick + shift."""

    def __init__(self, command, status, out, err, control, truth, nominal, geometry):
        self.command, self.status, self.out, self.err = command, status, out, err
        self.control, self.truth, self.nominal, self.geometry = control, truth, nominal, geometry
        self.faults = re.findall(r"^fault: (\w+):", err, re.M)
        self.shift = self.find_shift() if truth is not control else 0
        ticks = [tick for tick, fault in zip(control.ticks, control["fault"]) if fault > 0]
        self.fault_tick = ticks[0] if ticks else None
        self.same_clock = True  # a second SYNC makes the plant's time run ahead
        self.event_tick = None  # of the truth: when the test did something

    def find_shift(self):
        """The device counts from the first SYNC, the loop from its first tick: both know the commands."""
        u, v = self.control["u_V"], self.truth["u_V"]
        if not u or not v:
            return 0
        moved = next((i for i, value in enumerate(u) if abs(value) > 5e-3), None)
        if moved is None:
            return 0
        probe = range(max(moved - 40, 0), min(moved + 200, len(u)), 5)
        def miss(shift):
            # By size: a wrong sign in the config turns what the device sees.
            return sum(abs(abs(u[i]) - abs(self.truth.at("u_V", self.control.ticks[i] + shift))) for i in probe)
        return min(range(0, 2500), key=miss)

    def off_m(self, tick):
        """Truth less the nominal loop's motion at a tick of the controller."""
        return self.truth.at("x_true_m", tick + self.shift) - self.nominal.at("x_true_m", tick)

    def end_tick(self):
        return self.fault_tick if self.fault_tick is not None else (self.control.ticks[-1] if self.control.ticks else 0)

    def first_off_tick(self, way_m=1e-3):
        return next((tick for tick in self.control.ticks if abs(self.off_m(tick)) > way_m), None)

    def worst_off_m(self):
        return max((abs(self.off_m(tick)) for tick in self.control.ticks[:-1]), default=math.nan)

    def speeds_mps(self):
        x, t = self.truth["x_true_m"], self.truth.ticks
        return [(x[i + 1] - x[i]) / ((t[i + 1] - t[i]) * PERIOD_S) for i in range(len(x) - 1)]

    def peak_speed_mps(self, until_tick=None):
        speeds = self.speeds_mps()
        if until_tick is not None:
            speeds = speeds[:bisect.bisect_right(self.truth.ticks, until_tick + self.shift)]
        return max(map(abs, speeds), default=math.nan)

    def forces_N(self):
        a_1, a_2, p = self.geometry
        return [a_1 * p_1 - a_2 * p_2 - (a_1 - a_2) * p
                for p_1, p_2 in zip(self.truth["p1_chamber_true_Pa"], self.truth["p2_chamber_true_Pa"])]

    def force_at_N(self, tick):
        i = bisect.bisect_right(self.truth.ticks, tick + self.shift) - 1
        forces = self.forces_N()
        return abs(forces[i]) if 0 <= i < len(forces) else math.nan

    def peak_force_N(self):
        return max(map(abs, self.forces_N()), default=math.nan)

    def further_m(self):
        """Travel after the fault."""
        if self.fault_tick is None:
            return math.nan
        x = self.truth.after("x_true_m", self.fault_tick + self.shift)
        return max((abs(value - x[0]) for value in x), default=math.nan)

    def safe_after_s(self, tick):
        """From a tick of the truth until the valve has its safe output for good; None: never."""
        commands, ticks = self.truth["u_V"], self.truth.ticks
        since = None
        for at, command in zip(ticks, commands):
            if at < tick:
                continue
            if abs(command - SAFE_V) > 1e-3:
                since = None
            elif since is None:
                since = at
        return None if since is None else (since - tick) * PERIOD_S

    def lies(self):
        """What was printed and is not so."""
        found = []
        said = re.search(r"has its safe output of \S+ V since t = (\S+) s", self.err)
        if said and self.truth is not self.control and self.same_clock:
            tick = round(float(said[1]) / PERIOD_S) + self.shift
            late = self.safe_after_s(tick)
            if late is None or late > 0.003:
                found.append("says the valve has its safe output, " +
                             ("which it never gets" if late is None else f"which comes {1e3 * late:.0f} ms later"))
        reference = max(map(abs, self.control["x_ref_m"]), default=0.0)
        if "follows its reference" in self.out and self.worst_off_m() > 0.5 * max(reference, 1e-3):
            found.append("says the axis follows its reference")
        return found


class Runner:
    def __init__(self, build, folder):
        self.program, self.tamper = str(build / "pneuservo"), str(build / "tests/bus_tamper")
        self.folder, self.count, self.nominals, self.checks = pathlib.Path(folder), 0, {}, {}
        self.lines, self.only_simulated = LINES, False
        self.lock = threading.Lock()

    def name(self):
        with self.lock:
            self.count += 1
            return self.folder / f"{self.count:04d}"

    @staticmethod
    def config(line):
        return SOURCE / f"config/cylinder-{line}.yaml"

    def can_config(self, line):
        """The cylinder of a line behind the devices of config/can."""
        if line == "10m-7.65mm":
            return CAN
        path = self.folder / f"can-{line}.yaml"
        if not path.exists():
            own = re.sub(r"^limits:.*\n", "", self.config(line).read_text(), flags=re.M)  # those of the bus hold them, too
            path.write_text(own + "\n" + HAL_BEGINS + CAN.read_text().split(HAL_BEGINS)[1])
        return path

    @staticmethod
    def geometry(config):
        text = pathlib.Path(config).read_text()
        number = lambda key: float(re.search(rf"{key}:\s*([-+.\deE]+)", text)[1])
        return number("area_1_m2"), number("area_2_m2"), number("atmosphere_Pa")

    def call(self, *words, timeout=600):
        return subprocess.run([self.program, *map(str, words)], capture_output=True, text=True, timeout=timeout)

    def checked(self, config):
        """What check finds of a config, once."""
        if str(config) not in self.checks:
            self.checks[str(config)] = json.loads(self.call("check", config, "--json", "-").stdout)["config"]
        return self.checks[str(config)]

    def nominal(self, config, duration_s, age):
        """What the axis does where nothing is wrong."""
        key = (str(config), duration_s, age)
        if key not in self.nominals:
            path = self.name().with_suffix(".csv.gz")
            path.unlink(missing_ok=True)
            done = self.call("run", config, "--hal", "sim", "--set", f"simulation.input_age_periods={age}", "--duration-s",
                             duration_s, "--record", path)
            if done.returncode not in (0, 1):
                raise SystemExit(f"{config}: the nominal run: {done.stderr}")
            self.nominals[key] = Rows(path)
        return self.nominals[key]

    def simulated(self, config, *words, duration_s=5):
        path = self.name().with_suffix(".csv.gz")
        path.unlink(missing_ok=True)
        command = ["run", str(config), "--hal", "sim", "--duration-s", str(duration_s), *map(str, words)]
        done = self.call(*command, "--record", path)
        rows = Rows(path)
        return Outcome("pneuservo " + " ".join(command), done.returncode, done.stdout, done.stderr, rows, rows,
                       self.nominal(config, duration_s, 0), self.geometry(config))

    def two(self, config, control=(), device=(), tamper=(), act=None, act_s=2.3, duration_s=5, verb="run", tries=4):
        """Controller and device as two processes; a loaded machine's lost answers are no result and are tried again.
        None where only the simulated plant is asked for."""
        if self.only_simulated:
            return None
        for _ in range(tries):
            outcome = self.two_once(config, control, device, tamper, act, act_s, duration_s, verb)
            starved = {"position_missing", "port_pressure_1_missing", "port_pressure_2_missing"} <= set(outcome.faults)
            starved = starved or "homing: position_missing" in outcome.err
            starved = starved or ("late_tick" in outcome.faults and act is None)
            # Nobody silences a node where nothing stands between: the machine was too busy for its heartbeat.
            starved = starved or (not tamper and not act and bool({"node_lost", "node_emergency"} & set(outcome.faults)))
            # A fault before the test did anything, of a run that would have gone well, is the loaded machine's too.
            early = outcome.fault_tick is not None and (
                (tamper and outcome.fault_tick + outcome.shift < tamper[1] - 3) or (act and not outcome.lived))
            if not starved and not early:
                break
        return outcome

    def two_once(self, config, control, device, tamper, act, act_s, duration_s, verb):
        base = self.name()
        bus, front = f"{base}.device", f"{base}.bus"
        for path in (bus, front, f"{base}.truth.csv.gz", f"{base}.control.csv.gz"):
            pathlib.Path(path).unlink(missing_ok=True)
        words = ["device", str(config), "--can", f"unix:{bus}", "--priority", "60", *map(str, device)]
        plant = subprocess.Popen([self.program, *words, "--record", f"{base}.truth.csv.gz"], stdin=subprocess.PIPE,
                                 stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        started = plant.stderr.readline()
        between = None
        if tamper:
            between = subprocess.Popen([self.tamper, front, bus, *map(str, tamper)], stderr=subprocess.PIPE, text=True)
            while not os.path.exists(front) and between.poll() is None:
                time.sleep(0.01)
        run = [verb, str(config), "--set", f"hal.can.interface=unix:{front if tamper else bus}", "--time", "real",
               *map(str, control)]
        if verb == "run":
            run += ["--duration-s", str(duration_s)]
            record = ["--record", f"{base}.control.csv.gz"]
        else:
            record = []
        process = subprocess.Popen([self.program, *run, *record], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                                   stderr=subprocess.PIPE, text=True)
        stamp = self.act_on(process, plant, act, act_s) if act else None
        try:
            out, err = process.communicate(timeout=duration_s + 20)
        except subprocess.TimeoutExpired:
            process.kill()
            out, err = process.communicate()
            err += "\nthe controller did not end by itself"
        time.sleep(0.35)
        plant.send_signal(signal.SIGINT)
        said = started + plant.communicate(timeout=30)[1]
        if between:
            between.kill()
            said += between.communicate()[1]
        control_rows, truth = Rows(f"{base}.control.csv.gz"), Rows(f"{base}.truth.csv.gz")
        command = " ".join(["pneuservo", *words, "&", *(["bus_tamper BUS DEVICE", *map(str, tamper), "&"] if tamper else []),
                            "pneuservo", *run])
        outcome = Outcome(command, process.returncode, out, err, control_rows, truth,
                          self.nominal(config, 5, 1), self.geometry(config))
        outcome.said, outcome.lived = said, stamp is not None and stamp != "dead"
        found = re.search(r"t = ([\d.]+) s: spike:x:0", said)
        if found:
            outcome.event_tick = round(float(found[1]) / PERIOD_S)
        return outcome

    @staticmethod
    def act_on(process, plant, act, act_s):
        """After so much time, in the same instant: the test's act, and an order without effect that gives it a time."""
        time.sleep(act_s)
        if process.poll() is not None:
            return "dead"
        plant.stdin.write("spike:x:0\n")
        plant.stdin.flush()
        act(process)
        return "acted"


class Stopper:
    """Pauses a process again and again, as a machine that is throttled does."""

    def __init__(self, run_s, pause_s):
        self.run_s, self.pause_s = run_s, pause_s

    def __call__(self, process):
        def work():
            try:
                os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(90))
            except OSError:
                pass
            while process.poll() is None:
                time.sleep(self.run_s)
                process.send_signal(signal.SIGSTOP)
                time.sleep(self.pause_s)
                process.send_signal(signal.SIGCONT)

        threading.Thread(target=work, daemon=True).start()
