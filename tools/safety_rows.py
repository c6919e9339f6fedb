# The scenarios of tools/safety-table: what goes wrong, what is asked, and the verdict on what came of it.
"""Each scenario is a function of (runner, rng, draw): draw 0 has the stated numbers, others draw theirs from rng. It
yields cases; a case is a scenario in words, what is asked, an Outcome or None, and what was missed (nothing: passed)."""
import math
import os
import pathlib
import re
import signal
from dataclasses import dataclass, field

from safety_runs import PERIOD_S, SOURCE, WATCHDOG_S, Outcome, Rows, Stopper

OFF_M, LATE_S = 0.010, 0.6       # off the prediction, after 1 mm
CONTACT_S, CONTACT_N = 0.020, 60  # obstacle
START_M, START_MPS = 0.005, 0.2   # reversed at the start
HEALTH_S = 0.5
AFTER_SIGNAL_TICKS = 2 + 2  # asked, and what the bus and the time stamp of the signal take
BUS_S = 0.003               # a tick, its SYNC and the device's own tick
CHOKES = "10m-4.15mm"       # a line that is too narrow for its own sine
STATED = 1.1                # of what check states of a line: the tool against the simulation


@dataclass
class Case:
    scenario: str
    asked: str
    outcome: Outcome = None
    missed: list = field(default_factory=list)
    note: str = ""
    command: str = ""

    def need(self, condition, what):
        if not condition:
            self.missed.append(what)


def judged(case):
    """What holds for every run that should end in a fault."""
    out = case.outcome
    case.command = case.command or out.command
    if not out.control.ticks and "home" not in out.command and case.note != "refused":
        said = [line for line in out.err.strip().splitlines() if "NOT REAL" not in line]
        case.missed = ["did not run: " + (said[-1][:120] if said else f"exit status {out.status}")]
    for lie in out.lies():
        case.missed.append(lie)
    return case


def refused(out):
    """Unusable input, said in one sentence, and no motion."""
    moved = max((abs(v) for v in out.truth["u_V"]), default=0.0) > 1e-3 if out.truth is not None else False
    said = [line for line in out.err.strip().splitlines() if line and "NOT REAL" not in line]
    return out.status == 2 and not moved and len(said) >= 1


def late_s(out):
    """From 1 mm off the prediction to the fault."""
    first = out.first_off_tick()
    return math.inf if out.fault_tick is None else 0.0 if first is None else (out.fault_tick - first) * PERIOD_S


def off_mm(out):
    """At the fault."""
    return math.inf if out.fault_tick is None else 1e3 * abs(out.off_m(out.fault_tick))


def deviates(scenario, out, line, may_refuse=False):
    if out is None:  # two processes are left out
        return None
    case = Case(scenario, f"fault {1e3 * OFF_M:.0f} mm off the prediction and {LATE_S} s after 1 mm at most", out)
    if may_refuse and refused(out):
        case.note = "refused"
        return judged(case)
    if out.fault_tick is None:
        case.missed.append("no fault")
        return judged(case)
    case.need(out.status == 1, f"exit status {out.status}")
    case.need(off_mm(out) <= 1e3 * OFF_M, f"{off_mm(out):.1f} mm off")
    case.need(late_s(out) <= LATE_S, f"{late_s(out):.2f} s after 1 mm")
    return judged(case)


def stated_payload(runner, line, kg):
    """What check states of the next lighter payload of its list: seconds after 1 mm and mm off, inf where it cannot be
    told; None where it states nothing."""
    found = next((one for one in runner.checked(runner.config(line)) if one["topic"] == "unknown payload"), {})
    stated = {one["payload_kg"]: (math.inf, math.inf) if one["after_s"] is None else (one["after_s"], 1e3 * one["off_m"])
              for one in found.get("figures", [])}
    lighter = [one for one in stated if one <= kg + 1e-9]
    return stated[max(lighter)] if lighter else None


def payload(runner, rng, draw):
    """A payload that the controller does not know."""
    if draw == 0:
        for kg in (20, 200):
            out = runner.two(runner.can_config("10m-7.65mm"), device=["--set", f"slider.payload_kg={kg}"])
            yield deviates(f"payload {kg} kg, two processes", out, "10m-7.65mm")
        cases = [(line, 20.0, 0.0) for line in runner.lines]
    else:
        cases = [(rng.choice(runner.lines), rng.choice([1, 10]) * rng.uniform(15, 30), rng.uniform(0, 2.5)) for _ in range(2)]
    for line, kg, at_s in cases:
        out = runner.simulated(runner.config(line), "--fault", f"payload:{kg:.1f}@{at_s:.3f}")
        case = deviates(f"payload {kg:.1f} kg from {at_s:.1f} s, {line}", out, line)
        stated = stated_payload(runner, line, kg) if case.missed else None
        # What a line cannot do is as asked where check states it, and no later than stated.
        if stated and late_s(out) <= max(STATED * stated[0], LATE_S) and off_mm(out) <= max(STATED * stated[1], 1e3 * OFF_M):
            case.missed = out.lies()
            case.note = "cannot be told, says check" if math.isinf(stated[0]) else f"check says {stated[0]:.2f} s, {stated[1]:.1f} mm"
        yield case


def gains(runner, rng, draw):
    """Gains that are too large by far."""
    line, factor, key = "10m-7.65mm", 10.0, "position_gain_N_per_m"
    cases = [(line, factor, key), (line, factor, "force_gain_V_per_N")]
    if draw:
        cases = [(rng.choice(runner.lines), rng.uniform(8, 20), rng.choice(["position_gain_N_per_m", "force_gain_V_per_N"]))]
    for line, factor, key in cases:
        text = pathlib.Path(runner.config(line)).read_text()
        value = float(re.search(rf"{key}:\s*(\S+)", text)[1]) * factor
        words = ["--set", f"controller.{key}={value:.6g}"]
        yield deviates(f"{key} x {factor:.1f}, {line}, two processes", runner.two(runner.can_config(line), words), line, True)
        yield deviates(f"{key} x {factor:.1f}, {line}", runner.simulated(runner.config(line), *words), line, True)


def jam(runner, rng, draw):
    """Jammed, with an encoder whose last digits are never quiet."""
    line, jam_, noise = "10m-7.65mm", 20000.0, 1e-5
    if draw:
        line, jam_, noise = rng.choice(runner.lines), rng.uniform(5000, 50000), rng.uniform(5e-6, 3e-5)
    device = ["--set", f"slider.viscous_friction_Ns_per_m={jam_:.0f}", "--set", f"sensors.position.noise_m={noise:.2g}"]
    words = f"jammed by {jam_:.0f} N s/m, jitter {1e6 * noise:.0f} um, {line}"
    yield deviates(words + ", two processes", runner.two(runner.can_config(line), device=device), line)
    at_s = 1.5 if draw == 0 else rng.uniform(0.2, 2.5)
    out = runner.simulated(runner.config(line), "--fault", f"jam:{jam_:.0f}@{at_s:.3f}", "--set",
                           f"sensors.position.noise_m={noise:.2g}")
    yield deviates(words + f" from {at_s:.1f} s", out, line)


def touches(scenario, out, stop_m, line):
    if out is None:  # two processes are left out
        return None
    case = Case(scenario, f"fault {1e3 * CONTACT_S:.0f} ms after contact at most, {CONTACT_N} N at most then", out)
    touched = next((tick for tick, x in zip(out.truth.ticks, out.truth["x_true_m"]) if abs(x) > stop_m - 1e-6), None)
    if touched is None:
        case.need(out.fault_tick is not None, "the obstacle was not reached")
        case.note = "fault before contact"
        return judged(case)
    if out.fault_tick is None:
        case.missed.append("no fault")
        return judged(case)
    late_s = (out.fault_tick + out.shift - touched) * PERIOD_S
    case.need(late_s <= CONTACT_S, f"{1e3 * late_s:.0f} ms after contact")
    case.need(out.force_at_N(out.fault_tick) <= CONTACT_N, f"{out.force_at_N(out.fault_tick):.0f} N at the fault")
    case.note = f"{1e3 * late_s:.0f} ms, {out.force_at_N(out.fault_tick):.0f} N at the fault"
    return judged(case)


def obstacle(runner, rng, draw):
    """Something hard in the way."""
    cases = [("10m-7.65mm", 0.02)] if draw == 0 else [(rng.choice(runner.lines), rng.uniform(0.01, 0.06))]
    for line, stop_m in cases:
        out = runner.two(runner.can_config(line), device=["--fault", f"obstacle:{stop_m:.4f}@0"])
        yield touches(f"obstacle at {1e3 * stop_m:.0f} mm, {line}, two processes", out, stop_m, line)
    for line, stop_m in [(line, 0.02) for line in runner.lines] if draw == 0 else cases:
        out = runner.simulated(runner.config(line), "--fault", f"obstacle:{stop_m:.4f}@0")
        yield touches(f"obstacle at {1e3 * stop_m:.0f} mm, {line}", out, stop_m, line)


def wiring(runner, rng, draw):
    """Valve, encoder, hoses or port sensors reversed or exchanged at the start."""
    kinds = ["reversed_valve", "reversed_encoder", "exchanged_hoses", "exchanged_ports"]
    config = runner.can_config("10m-7.65mm")
    places = [("10m-7.65mm", kind, 0.0, 470e3) for kind in kinds]
    if draw:
        places = [(rng.choice(runner.lines), rng.choice(kinds), rng.uniform(-0.05, 0.05), rng.uniform(300e3, 550e3)) for _ in range(2)]
    for line, kind, at_m, start_Pa in places:
        start = ["--set", f"initial={{position_m: {at_m:.4f}, pressure_1_Pa: {start_Pa:.0f}}}"]
        words = f"{kind.replace('_', ' ')}, {line}, at {1e3 * at_m:.0f} mm"
        both = [(words + ", two processes", runner.two(runner.can_config(line), device=["--fault", f"{kind}@0", *start])),
                (words, runner.simulated(runner.config(line), "--fault", f"{kind}@0", *start))]
        for scenario, out in both:
            yield starts(scenario, out)
    if draw == 0:
        for key, value in (("u.can.scale_V_per_count", -3.0517578125e-4), ("x.can.scale_m_per_count", -5e-6)):
            out = runner.two(config, ["--set", f"hal.channels.{key}={value}"])
            yield starts(f"{key} negative in the config, two processes", out)


def starts(scenario, out):
    if out is None:  # two processes are left out
        return None
    case = Case(scenario, f"fault within {1e3 * START_M:.0f} mm and {START_MPS} m/s", out)
    if out.fault_tick is None:
        case.missed.append("no fault")
        return judged(case)
    x = out.truth["x_true_m"][:max(1, sum(tick <= out.fault_tick + out.shift for tick in out.truth.ticks))]
    way = max((abs(value - x[0]) for value in x), default=0.0)
    speed = out.peak_speed_mps(out.fault_tick)
    case.need(way <= START_M, f"{1e3 * way:.1f} mm")
    case.need(speed <= START_MPS, f"{speed:.2f} m/s")
    case.note = f"{1e3 * way:.1f} mm, {speed:.2f} m/s until the fault"
    return judged(case)


def deaf(runner, rng, draw):
    """The device no longer takes the outputs."""
    first = 2000 if draw == 0 else rng.randrange(900, 3000)
    line = "10m-7.65mm" if draw == 0 else rng.choice(runner.lines)
    for mode, words in (("pre_operational", [2]), ("moved_outputs", []), ("lost_outputs", [])):
        out = runner.two(runner.can_config(line), tamper=[mode, first, *words])
        case = Case(f"{mode.replace('_', ' ')} at {first / 1e3:.1f} s, {line}",
                    f"substitute {1e3 * WATCHDOG_S:.0f} ms after the fault at most, text true", out)
        if out.fault_tick is None:
            case.missed.append("no fault")
        else:
            late = out.safe_after_s(out.fault_tick + out.shift)
            seen_s = (out.fault_tick + out.shift - first) * PERIOD_S
            case.note = f"fault {1e3 * seen_s:.0f} ms after it, safe {'never' if late is None else f'{1e3 * late:.0f} ms'} later"
            case.need(late is not None and late <= WATCHDOG_S + BUS_S, "never safe" if late is None else f"safe after {1e3 * late:.0f} ms")
        yield judged(case)


def killed(runner, rng, draw):
    """kill -9, with outputs of other kinds than CiA 401."""
    kill = lambda process: process.send_signal(signal.SIGKILL)
    act_s = 2.3 if draw == 0 else rng.uniform(1.5, 3.0)
    for object_ in ("0x64110110", "0x21000110", "0x64120120"):
        words = ["--set", f"hal.channels.u.can.object={object_}"]
        out = runner.two(runner.can_config("10m-7.65mm"), words, words, act=kill, act_s=act_s)
        case = Case(f"kill -9, output {object_}", f"refused at the start, or safe within {1e3 * WATCHDOG_S:.0f} ms", out)
        if refused(out):
            case.note = "refused"
        elif out.event_tick is None:
            case.missed.append(f"did not run: {out.err.strip()[-80:]}")
        else:
            late = out.safe_after_s(out.event_tick)
            case.note = "never safe" if late is None else f"safe after {1e3 * late:.0f} ms"
            case.need(late is not None and late <= WATCHDOG_S + BUS_S, case.note)
        yield judged(case)
    if draw == 0:
        board = SOURCE / "config/comedi/cylinder-10m-7.65mm.yaml"
        said = runner.call("check", board).stdout
        case = Case("kill -9, DA/AD board", "refused at the start, or the missing watchdog said by check")
        case.command = f"pneuservo check {board}"
        case.need(re.search(r"board without program +keeps its outputs", said), "check does not say that a board keeps its output")
        yield case


def health(runner, rng, draw):
    """Supervision that is blinded bit by bit."""
    config = runner.can_config("10m-7.65mm")
    pause_s = 0.005 if draw == 0 else rng.uniform(0.004, 0.007)
    first = 2000 if draw == 0 else rng.randrange(1200, 3000)
    offset = 4000 if draw == 0 else rng.randrange(2000, 8000)
    runs = [(f"{100 * pause_s / (0.015 + pause_s):.0f} % of the slots missed", dict(act=Stopper(0.015, pause_s), act_s=2.3)),
            ("two of three positions lost", dict(tamper=["lost_answers", first, "0x183"])),
            ("two of three answers of the pressures lost", dict(tamper=["lost_answers", first, "0x282"])),
            (f"two of three positions {5e-3 * offset:.0f} mm off", dict(tamper=["jumps", first, "0x183", offset])),
            (f"second answer each cycle, {5e-3 * offset / 4:.0f} mm off", dict(tamper=["second_answer", first, "0x183", offset // 4])),
            ("second SYNC each cycle", dict(tamper=["second_sync", first]))]
    for scenario, how in runs:
        out = runner.two(config, **how)
        case = Case(scenario, f"fault within {HEALTH_S} s", out)
        out.same_clock = scenario != "second SYNC each cycle"
        began = out.event_tick if "act" in how else first
        if out.fault_tick is None:
            case.missed.append("no fault")
        elif began is not None:
            late = (out.fault_tick + out.shift - began) * PERIOD_S
            case.note = f"{late:.2f} s after it began"
            case.need(0 <= late <= HEALTH_S, f"{late:.2f} s")
        yield judged(case)


def signals(runner, rng, draw):
    """Signals in motion."""
    names = ["HUP", "QUIT", "TSTP", "USR1", "ALRM", "PIPE", "SEGV"] if draw == 0 else [rng.choice(["USR2", "ABRT", "BUS", "TERM", "INT", "HUP"])]
    for name in names:
        number = getattr(signal, "SIG" + name)
        crash = name in ("SEGV", "ABRT", "BUS")
        out = runner.two(runner.can_config("10m-7.65mm"), act=lambda process: process.send_signal(number), act_s=2.0 + rng.uniform(0, 1))
        case = Case(f"SIG{name} in motion", "safe output in 2 ticks" + ("" if crash else ", recording closed"), out)
        if out.event_tick is None:
            case.missed.append("ended before the signal: " + out.err.strip()[-80:])
            yield judged(case)
            continue
        late = out.safe_after_s(out.event_tick)
        ticks = None if late is None else round(late / PERIOD_S)
        case.note = "never safe" if ticks is None else f"safe {ticks} ticks later at the device"
        case.need(ticks is not None and ticks <= AFTER_SIGNAL_TICKS, case.note)
        ends = out.control.ticks and out.control.ticks[-1] + out.shift
        case.need(not ends or ends <= out.event_tick + 1000, "goes on")
        if not crash:
            case.need(out.control.closed, "recording not closed")
            case.need("did not end by itself" not in out.err, "does not end")
        yield judged(case)


def home(runner, rng, draw):
    """The named step home where it must not take a place for the end stop."""
    at_m = 0.06 if draw == 0 else rng.uniform(0.02, 0.1)
    at_s = 0.3 if draw == 0 else rng.uniform(0.2, 0.6)
    zeros = runner.name().with_suffix(".yaml")
    wrongs = [("frozen encoder", f"freeze:x@{at_s:.3f}"), (f"obstacle at {1e3 * at_m:.0f} mm", f"obstacle:{at_m:.4f}@0"),
              ("reversed valve", "reversed_valve@0"), ("reversed encoder", "reversed_encoder@0")]
    for scenario, fault in wrongs:
        out = runner.two(runner.can_config("10m-7.65mm"), ["--end", "low", "--write", zeros], ["--fault", fault], verb="home",
                         duration_s=20)
        case = Case(f"home: {scenario}", "refused with the reason", out)
        case.need(out.status != 0, "accepted: " + out.out.strip()[:60])
        case.need(not zeros.exists(), "zero written")
        case.need(out.status == 0 or out.err.strip(), "no reason")
        said = [line for line in out.err.splitlines() if line and "NOT REAL" not in line]
        case.note = said[-1][:110] if out.status and said else ""
        zeros.unlink(missing_ok=True)
        yield judged(case)


PAYLOAD_MAX_KG, FRICTION_MAX_N = 1.25, 10.0
# References of the documents, in the reach of every line: each ends within the run.
REFERENCES = {
    "the config's": [],
    "sine 50 mm 0.7 Hz": ["--set", "reference={kind: sine, amplitude_m: 0.05, frequency_Hz: 0.7}"],
    "120 mm in 0.8 s": ["--set", "reference={kind: waypoints, times_s: [0, 0.3, 1.1, 1.5, 2.3], positions_m: "
                        "[-0.06, -0.06, 0.06, 0.06, -0.06], smoothness: 7}"],
    "creep 10 mm/s": ["--set", "reference={kind: waypoints, times_s: [0, 0.5, 4.5], positions_m: [-0.02, -0.02, 0.02]}"],
    "multisine": ["--set", "reference={kind: multisine, components: [[0.02, 0.5, 0], [0.01, 1.1, 1], [0.005, 1.7, 2]], "
                  "center_m: 0.0, ramp_s: 1.0}"],
}


def tolerances(config):
    """Paths and relative deviations of a config's owner."""
    block = re.search(r"^tolerances:\n((?:  .+\n)+)", pathlib.Path(config).read_text(), re.M)
    return [(path, float(value)) for path, value in re.findall(r"^  ([\w.]+):\s*([\d.e-]+)", block[1], re.M)] if block else []


def drawn_machine(config, rng):
    """A machine as the owner may have it: within two deviations of each tolerance, with payload and friction."""
    cut = lambda sigma: max(-2.0, min(2.0, rng.gauss(0, 1))) * sigma
    parts = ", ".join(f"{path}: {cut(sigma):.5f}" for path, sigma in tolerances(config))
    return ["--set", f"deviations={{{parts}}}", "--set", f"limits.payload_max_kg={PAYLOAD_MAX_KG}",
            "--set", f"limits.dry_friction_max_N={max(FRICTION_MAX_N, 12.6)}", "--set", f"seed={rng.randrange(1, 10**6)}",
            "--fault", f"payload:{rng.uniform(0, PAYLOAD_MAX_KG):.3f}@0", "--fault", f"dry_friction:{rng.uniform(0, FRICTION_MAX_N):.2f}@0"]


def without_fault(scenario, runs, workers):
    """Runs that must go well; the command of the first that does not."""
    case = Case(scenario, "no fault")
    def go(words):
        done = words[0].call(*words[1])
        return done.returncode, re.findall(r"^fault: (\w+)", done.stderr, re.M), done.stderr, words[1]
    results = list(workers.map(go, runs))
    bad = [result for result in results if result[0] != 0]
    case.note = f"{len(results)} runs, {len(bad)} with a fault"
    if bad:
        names = sorted({name for result in bad for name in result[1]} or {bad[0][2].strip()[:90]})
        case.missed.append(f"{len(bad)} of {len(results)}: " + ", ".join(names))
        case.command = "pneuservo " + " ".join(f"'{word}'" if " " in str(word) or "{" in str(word) else str(word) for word in bad[0][3])
    return case


def machines(runner, rng, draw):
    """Machines as their owners may have them."""
    if draw:
        return
    for line in runner.lines:
        config, runs = runner.config(line), []
        for _ in range(runner.machines):
            # The narrow 10 m line chokes on its own sine.
            names = [name for name in REFERENCES if line != CHOKES or name != "120 mm in 0.8 s"]
            runs.append((runner, ["run", config, *drawn_machine(config, rng), *REFERENCES[rng.choice(names)], "--duration-s", "5"]))
        yield without_fault(f"{len(runs)} drawn machines, {line}", runs, runner.workers)


def shipped(runner, rng, draw):
    """Each shipped config for an hour of its own time, over payloads and references."""
    if draw or not runner.long:
        return
    for config in sorted(SOURCE.glob("config/*.yaml")):
        cylinder = config.name.startswith("cylinder")
        runs = []
        for part in range(12):
            words = ["run", config, "--duration-s", "300", "--set", f"seed={rng.randrange(1, 10**6)}"]
            if cylinder:
                words += ["--set", f"limits.payload_max_kg={PAYLOAD_MAX_KG}", "--fault", f"payload:{PAYLOAD_MAX_KG * part / 11:.3f}@0"]
            else:
                words[3] = "20"
            runs.append((runner, words))
        yield without_fault(f"1 h in 12 runs, {config.stem}", runs, runner.workers)


def stopping(runner, rng, draw):
    """An emergency stop at the reference's top speed, against the table of `pneuservo stopping`."""
    line = "10m-7.65mm" if draw == 0 else rng.choice(runner.lines)
    config = runner.config(line)
    case = Case(f"stopping distance, {line}", "stated, within 10 % of a run with an emergency stop")
    told = runner.call("stopping", config, "--json", "-")
    case.command = f"pneuservo stopping {config} --json -"
    if told.returncode != 0:
        case.missed.append("not stated")
        yield case
        return
    import json
    stated = json.loads(told.stdout)["own_reference"]
    at_s = stated["at_s"]
    out = runner.simulated(config, "--fault", f"emergency_stop@{at_s}")
    case.outcome = out
    if out.fault_tick is None:
        case.missed.append("no fault")
    else:
        found_m = out.further_m()
        case.note = f"stated {1e3 * stated['distance_m']:.1f} mm from {stated['speed_mps']:.2f} m/s, run {1e3 * found_m:.1f} mm"
        case.need(abs(stated["distance_m"] - found_m) <= 0.1 * found_m, case.note)
    yield case


def work(runner, rng, draw):
    """What supervision costs a tick, from the project's own benchmark where it is built."""
    if draw:
        return
    case = Case("work per tick of all supervision", "250 ns at most")
    bench = runner.build / "tests/benchmarks/pneuservo_bench"
    found = next((path for path in [bench, *runner.build.rglob("pneuservo_bench")] if path.is_file()), None)
    if found is None:
        case.note = "pneuservo_bench is not built"
        case.missed.append("not measured")
        yield case
        return
    import json
    import subprocess
    case.command = f"{found.name} --benchmark_filter=supervisor --benchmark_repetitions=5"
    done = subprocess.run([str(found), "--benchmark_filter=supervisor", "--benchmark_format=json", "--benchmark_repetitions=5"],
                          capture_output=True, text=True, timeout=300)
    times = [one["real_time"] for one in json.loads(done.stdout)["benchmarks"] if one.get("run_type") == "iteration"]
    case.note = f"{min(times):.0f} ns" if times else "no benchmark"
    case.need(times and min(times) <= 250, case.note)
    yield case


def refusals(runner, rng, draw):
    """Input that must not lead to motion."""
    if draw:
        return
    config, can = runner.config("10m-7.65mm"), runner.can_config("10m-7.65mm")
    foreign = runner.name().with_suffix(".yaml")
    foreign.write_text("# Zeros of servo-table-1m-8mm, for run --zeros.\nrig: servo-table-1m-8mm\nzeros:\n  x: 0.01\n")
    fast = "reference={kind: waypoints, times_s: [0, 0.5, 0.502, 2], positions_m: [-0.14, -0.14, 0.14, 0.14]}"
    off = ["deviation_m=0", "stall_force_N=0", "speed_mps=100", "end_stop_contact=allowed", "flow_mismatch_share=0",
           "chamber_mismatch_Pa=0", "bad_share=1", "missed_share=1", "checks_rest_s=0", "lateness_s=3600", "pressure_Pa=1e8"]
    sets = [word for one in off for word in ("--set", f"limits.{one}")]
    wanted = [("reference at 262 m/s", ["run", config, "--set", fast]),
              ("speed limit below the reference", ["run", config, "--set", "limits.speed_mps=0.1"]),
              ("deviation limit below the encoder's quantum", ["run", config, "--set", "limits.deviation_m=1e-7"]),
              ("every limit switched off", ["run", can, "--set", "hal.can.interface=unix:/nonexistent", "--time", "real", *sets]),
              ("zeros of another rig", ["run", can, "--set", "hal.can.interface=unix:/nonexistent", "--time", "real", "--zeros", foreign]),
              ("real valve, simulated position", ["run", can, "--set", "hal.can.interface=unix:/nonexistent", "--time", "real",
                                                  "--set", "hal.channels.x={simulated: true}"])]
    for scenario, words in wanted:
        done = runner.call(*words)
        case = Case(f"refused: {scenario}", "exit status 2, one sentence, no motion", command="pneuservo " + " ".join(map(str, words)))
        said = [line for line in done.stderr.strip().splitlines() if line and "NOT REAL" not in line]
        case.note = said[0][:140] if said else ""
        case.need(done.returncode == 2, f"exit status {done.returncode}")
        case.need(len(said) == 1, f"{len(said)} sentences")
        yield case


TWO_PROCESSES = {"deaf", "killed", "health", "signals", "home"}
ROWS = {row.__name__: row for row in (payload, gains, jam, obstacle, wiring, deaf, killed, health, signals, home, machines,
                                      shipped, stopping, work, refusals)}
