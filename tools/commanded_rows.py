# Rows of tools/improve-table: moves that are commanded at run time, by the formula and by a pass of each.
"""A served axis in simulated time goes forth and back over 200 mm at most at 0.4 m/s and 3 m/s2, with the sensors' noise."""
import csv
import glob
import gzip
import pathlib
import signal
import subprocess
import tempfile
import time

REFERENCE = "reference={kind: live, lowest_m: -0.12, highest_m: 0.12, speed_mps: 0.4, acceleration_mps2: 3.0}"
# The first proves the start, the second leads to the end of the way.
MOVES_M = ["0.02", "0.1", "-0.1", "0.1", "-0.1"]
LED_TO = 2
MOVE_TO = "4"  # of the column command_kind
ROWS = [("commanded moves", "none"), ("commanded moves, 20 N friction found exactly", "friction 20 N"), ("commanded moves, the triple found exactly", "triple")]


def served_mm(build, config, sets):
    """Largest error of the true position over the moves [mm], rests after them included, and what ended it before."""
    with tempfile.TemporaryDirectory() as folder:
        socket = pathlib.Path(folder) / "axis.sock"
        program = f"{build}/pneuservo"
        served = subprocess.Popen([program, "serve", config, "--time", "simulated", "--socket", socket, "--record", folder, *sets],
                                  stderr=subprocess.PIPE, text=True)
        while not socket.exists() and served.poll() is None:
            time.sleep(0.02)
        said = ""
        for words in [["enable"], *(["move", move, "--wait"] for move in MOVES_M)]:
            done = subprocess.run([program, "command", *words, "--socket", socket], capture_output=True, text=True)
            said = said or (done.stderr.strip() if done.returncode else "")
        served.send_signal(signal.SIGTERM)
        log = served.communicate()[1].strip()
        if said or served.returncode:
            return None, said or log
        most_m, begun = 0.0, 0
        for part in sorted(glob.glob(f"{folder}/*.csv.gz")):
            with gzip.open(part, "rt") as file:
                for row in csv.DictReader(line for line in file if line[0] != "#"):
                    begun += row["command_kind"] == MOVE_TO
                    if begun > LED_TO:
                        most_m = max(most_m, abs(float(row["x_ref_m"]) - float(row["x_true_m"])))
        return 1e3 * most_m, ""


def print_rows(build, sets_of, config_of, groups, effects, workers):
    """A row for each machine and each feedforward; the worst line of a group."""
    for name, effect in ROWS:
        for feedforward in ("formula", "pass"):
            cases = [(group, line) for group, lines in groups.items() for line in lines]
            found = list(workers.map(lambda case: served_mm(build, config_of(case[1]), sets_of(
                case[1], effect, effects[effect], REFERENCE, f"controller.flow_feedforward={feedforward}", "controller.without_pass=formula")), cases))
            cells = []
            for group in groups:
                of_group = [one for (where, _), one in zip(cases, found) if where == group]
                refused = [refusal for _, refusal in of_group if refusal]
                cells.append(refused[0] if refused else f"{max(value for value, _ in of_group):.3f}" if of_group else "-")
            print(f"| {name}, {feedforward} | " + " | ".join(cells) + " |", flush=True)
