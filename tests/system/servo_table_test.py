#!/usr/bin/env python3
# The servo table from the command line: figures, recording and replay, a plant that differs, gains of a running loop.
import json, os, subprocess, sys, tempfile, time

from program import expect, expect_refusal, program, run, size_so_far, wait_until

TABLE = "config/servo-table-0.5m-4mm.yaml"
folder = tempfile.mkdtemp()


def runs_of(*arguments):
    done = run("run", *arguments, "--json", "-")
    expect(done.returncode == 0, f"run {' '.join(arguments)}: status {done.returncode}: {done.stderr}")
    return json.loads(done.stdout)["runs"]


def replay(path, *arguments):
    done = run("replay", TABLE, path, "--json", "-", *arguments)
    expect(done.stdout != "", f"replay of {path}: {done.stderr}")
    return json.loads(done.stdout)


recording = os.path.join(folder, "move.csv.gz")
one = runs_of(TABLE, "--record", recording)[0]
expect(one["feedforward"] == "flatness" and one["max_position_error_m"] < 1e-6, f"the printed move: {one}")
result = replay(recording)
expect(result["identical"] and result["compared_rows"] == result["rows"] == 15000, f"replay: {result}")
done = run("simulate", TABLE, "--command", recording, "--json", "-")
difference = json.loads(done.stdout)["difference"]["x_m"]["max"]
expect(difference < 1e-9, f"simulate on the recorded commands: {difference} m")

linear = runs_of(TABLE, "--set", "controller.feedforward=5")[0]
expect(1.0e-4 < linear["max_position_error_m"] < 1.4e-4 and linear["pressure_source"] == "none", f"linear: {linear}")

# The plant has 3 % less area than the controller knows; the moves teach it.
moves = runs_of(TABLE, "--set", "controller.learning=flow", "--set", "deviations={valve.area_per_volt_m2_per_V: -0.0291425}", "--moves", "3")
errors = [move["max_position_error_m"] for move in moves]
expect(5e-6 < errors[0] < 7e-6 and errors[2] < 1.2e-6, f"learning: {errors}")

expect_refusal(run("run", TABLE, "--set", "controller.mean_pressure_Pa=110000"), ["mean_pressure_Pa 110000", "expected at least"], "too little pressure")
expect_refusal(run("run", TABLE, "--pressure-source", "all"), ["--pressure-source", "ppd2"], "pressure sources for ppd2")
expect_refusal(run("run", TABLE, "--set", "controller.observer=measured"), ["controller.observer", "error"], "flatness on the measured position")

# A long rest, gains from a file: taken, refused, replayed.
gains, recording = os.path.join(folder, "gains.yaml"), os.path.join(folder, "gains.csv.gz")
long = ["--set", "controller.feedforward=5", "--set", "simulation.cells_per_m=16", "--set", "duration_s=150"]
heard = os.path.join(folder, "stderr.txt")
process = subprocess.Popen([program, "run", TABLE, *long, "--gains", gains, "--record", recording], stdout=subprocess.PIPE, stderr=open(heard, "w"), text=True)
said = ""
wait_until(lambda: size_so_far(recording) > 60_000, "the recording")


def write_gains(text, answer):
    global said
    with open(gains + ".new", "w") as file:
        file.write(text)
    os.rename(gains + ".new", gains)
    deadline = time.monotonic() + 60
    while answer not in said and time.monotonic() < deadline and process.poll() is None:
        time.sleep(0.05)
        with open(heard) as file:
            said = file.read()
    expect(answer in said, f"gains {text!r}: {answer!r} was not said: {said!r}, status {process.poll()}")


write_gains("position_gain_V_per_m: 1400\nvelocity_gain_Vs_per_m: 60\n", "gains 1400 V/m, 60 V s/m, 1.3 V s2/m")
write_gains("position_gain: 1400\n", "gains.yaml:1: position_gain: found no gain that may change")
write_gains("position_gain_V_per_m: -1\n", "controller.position_gain_V_per_m")
write_gains("position_gain_V_per_m: 60000\n", "does not come to rest within 4 s")
process.terminate()
process.communicate(timeout=120)
expect(process.returncode == 0, f"the run with gains: status {process.returncode}: {said}")
result = replay(recording, *long)
expect(result["identical"] and result["rows"] > 1000, f"replay of a run with gains: {result}")
print("servo table: printed move", one["max_position_error_m"], "m; learning", errors)
