#!/usr/bin/env python3
# Signals in simulated and real time: status, recording closed or readable to the last flush, results; what a crash leaves;
# a reader that goes away, a disk that hangs.
import json, os, signal, subprocess, sys, tempfile, time

from program import CONFIG, catches, expect, program, rows_so_far, run, size_so_far, wait_until

folder = tempfile.mkdtemp()
signal.signal(signal.SIGHUP, signal.SIG_DFL)  # under nohup it would stay ignored, on purpose


def start(name, *arguments):
    path = os.path.join(folder, name + ".csv.gz")
    process = subprocess.Popen([program, "run", CONFIG, "--record", path, *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    wait_until(lambda: size_so_far(path) > 60_000, f"{name}: the recording")
    return process, path


def replayed(path, *arguments):
    done = run("replay", CONFIG, path, "--json", "-", *arguments)
    return done, json.loads(done.stdout) if done.stdout else {}


STOPS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT, signal.SIGTSTP, signal.SIGUSR1, signal.SIGUSR2, signal.SIGALRM,
         signal.SIGRTMIN)
for time_, numbers in (("simulated", STOPS[:2]), ("real", STOPS)):
    for number in map(signal.Signals, numbers):
        what = f"{number.name} in {time_} time"
        process, path = start(f"{time_}-{number.name}", "--time", time_, "--set", "duration_s=300")
        expect(process.poll() is None, f"{what}: the run ended by itself: {process.returncode}")
        process.send_signal(number)
        output, said = process.communicate(timeout=120)
        expect(process.returncode == 0, f"{what}: status {process.returncode}: {said}")
        expect("the simulated valve has its safe output of 0 V since t = " in said and "recording is closed" in said and "max position error" in output, f"{what}: no results: {output}{said}")
        done, result = replayed(path, "--set", "duration_s=300")
        expect(done.returncode == 0 and result["identical"] and result["compared_rows"] == result["rows"], f"{what}: replay: {done.stderr}{done.stdout}")
        expect("cut off" not in done.stderr and "damaged" not in done.stderr, f"{what}: the recording is not closed: {done.stderr}")

process, path = start("killed", "--time", "real", "--set", "duration_s=300")
wait_until(lambda: len(rows_so_far(path)) > 1500, "rows on the disk")
process.kill()
elapsed = time.time()
process.communicate(timeout=60)
done, result = replayed(path, "--set", "duration_s=300")
expect(done.returncode == 0 and result["identical"], f"kill -9: replay: {done.stderr}{done.stdout}")
expect("cut off" in done.stderr, f"kill -9: the cut is not said: {done.stderr}")
behind = elapsed - os.path.getmtime(path)
expect(result["rows"] > 1000 and result["compared_rows"] == result["rows"], f"kill -9: {result}")
print(f"kill -9: {result['rows']} rows, last flush {behind:.2f} s before")

# A crash: the handler of the signal leaves a record, and the program ends by that signal.
for number in (signal.SIGSEGV, signal.SIGABRT, signal.SIGBUS, signal.SIGFPE, signal.SIGILL):
    process, path = start(f"crash-{number.name}", "--time", "real", "--set", "duration_s=300")
    process.send_signal(number)
    _, said = process.communicate(timeout=60)
    expect(process.returncode == -number, f"{number.name}: status {process.returncode}: {said}")
    record = path.replace(".csv.gz", ".crash.txt")
    with open(record) as file:
        left = file.read()
    expect(number.name in left and " in tick " in left and "safe output was sent" in left and left in said, f"{number.name}: {left}{said}")
    done, result = replayed(path, "--set", "duration_s=300")
    expect(done.returncode == 0 and result["identical"], f"{number.name}: replay: {done.stderr}")

# Signals that come before anything moves, and many at once: a clean end each time.
for delay in (0.0, 0.005, 0.02, 0.05):
    process = subprocess.Popen([program, "run", CONFIG, "--time", "real", "--set", "duration_s=300"], stdout=subprocess.PIPE,
                               stderr=subprocess.PIPE, text=True)
    while "pneuservo" not in open(f"/proc/{process.pid}/cmdline").read() or not os.readlink(f"/proc/{process.pid}/exe").endswith("pneuservo"):
        time.sleep(0.001)
    wait_until(lambda: catches(process, signal.SIGTERM), "the handler of signals")
    time.sleep(delay)
    for _ in range(200):
        process.send_signal(signal.SIGTERM)
        process.send_signal(signal.SIGHUP)
    _, said = process.communicate(timeout=60)
    expect(process.returncode == 0 and "stopped by SIG" in said, f"burst after {delay} s: status {process.returncode}: {said}")

# Nobody reads what it says: the run goes on to its end.
path = os.path.join(folder, "pipe.csv.gz")
process = subprocess.Popen([program, "run", CONFIG, "--time", "real", "--duration-s", "1", "--fault", "emergency_stop@0.5", "--record", path],
                           stdout=subprocess.PIPE, stderr=subprocess.PIPE)
process.stdout.close()
process.stderr.close()
expect(process.wait(timeout=60) == 1, f"closed standard error: status {process.returncode}")
expect(run("replay", CONFIG, path).returncode == 0, "closed standard error: the recording is not whole")

# A disk that hangs (a pipe that nobody empties): the fault is told before the end, and the end comes in time or by a signal.
for asked in (False, True):
    path = os.path.join(folder, f"hung-{asked}.csv.gz")
    os.mkfifo(path)
    reader = os.open(path, os.O_RDONLY | os.O_NONBLOCK)
    process = subprocess.Popen([program, "run", CONFIG, "--time", "real", "--duration-s", "6", "--fault", "emergency_stop@4", "--record", path],
                               stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    said = ""
    while "fault: emergency_stop" not in said:
        line = process.stderr.readline()
        expect(line != "", f"hung disk: the fault is not told: {said}")
        said += line
    expect(process.poll() is None, "hung disk: it was told after the end")
    if asked:
        time.sleep(2.5)
        process.send_signal(signal.SIGTERM)
    output, rest = process.communicate(timeout=60)
    said += rest
    expect(process.returncode == 1, f"hung disk: status {process.returncode}: {said}")
    expect("could not be ended" in said and "rows are in the file for certain" in said, f"hung disk: {said}")
    expect("max position error" in output, f"hung disk: no results: {output}")
    os.close(reader)
