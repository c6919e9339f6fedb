#!/usr/bin/env python3
# Ctrl-C, SIGTERM and kill -9 in simulated and real time: status, recording closed or readable to the last flush, results.
import json, os, signal, subprocess, sys, tempfile, time

from program import CONFIG, expect, program, run

folder = tempfile.mkdtemp()


def start(name, *arguments):
    path = os.path.join(folder, name + ".csv.gz")
    process = subprocess.Popen([program, "run", CONFIG, "--record", path, *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    deadline = time.monotonic() + 60
    while not (os.path.exists(path) and os.path.getsize(path) > 60_000) and time.monotonic() < deadline:
        time.sleep(0.02)
    return process, path


def replayed(path, *arguments):
    done = run("replay", CONFIG, path, "--json", "-", *arguments)
    return done, json.loads(done.stdout) if done.stdout else {}


for time_ in ("simulated", "real"):
    for number in (signal.SIGINT, signal.SIGTERM):
        what = f"{number.name} in {time_} time"
        process, path = start(f"{time_}-{number.name}", "--time", time_, "--set", "duration_s=300")
        expect(process.poll() is None, f"{what}: the run ended by itself: {process.returncode}")
        process.send_signal(number)
        output, said = process.communicate(timeout=120)
        expect(process.returncode == 0, f"{what}: status {process.returncode}: {said}")
        expect("safe output is set" in said and "max position error" in output, f"{what}: no results: {output}{said}")
        done, result = replayed(path, "--set", "duration_s=300")
        expect(done.returncode == 0 and result["identical"] and result["compared_rows"] == result["rows"], f"{what}: replay: {done.stderr}{done.stdout}")
        expect("cut off" not in done.stderr and "damaged" not in done.stderr, f"{what}: the recording is not closed: {done.stderr}")

process, path = start("killed", "--time", "real", "--set", "duration_s=300")
time.sleep(1.0)
process.kill()
elapsed = time.time()
process.communicate(timeout=60)
done, result = replayed(path, "--set", "duration_s=300")
expect(done.returncode == 0 and result["identical"], f"kill -9: replay: {done.stderr}{done.stdout}")
expect("cut off" in done.stderr, f"kill -9: the cut is not said: {done.stderr}")
behind = elapsed - os.path.getmtime(path)
expect(result["rows"] > 1000 and result["compared_rows"] == result["rows"], f"kill -9: {result}")
print(f"kill -9: {result['rows']} rows, last flush {behind:.2f} s before")
