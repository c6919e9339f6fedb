# Controller and simulated plant as two processes on a real CAN stack; every frame of the bus against the recording.
import collections, re, struct, subprocess, unittest

from guest_tools import *

SYNC, COMMAND, PRESSURES, POSITION = 0x080, 0x302, 0x282, 0x183
COUNT_M, COUNT_PA, COUNT_V = 5.0e-6, 25.0, 3.0517578125e-4


def frames_of(log):
    """Time, id and data of each frame that candump -l wrote."""
    with open(log) as file:
        for line in file:
            stamp, _, frame = line.split()
            number, _, data = frame.partition("#")
            yield float(stamp[1:-1]), int(number, 16), bytes.fromhex(data)


def cycles_of(log):
    """For each SYNC: counts of the command before it and of the answers after it."""
    Cycle = collections.namedtuple("Cycle", "t command pressures position")
    command, cycles, current = None, [], None
    for t, number, data in frames_of(log):
        if number == COMMAND:
            command = struct.unpack("<h", data[:2])[0]
        elif number == SYNC:
            current = {"t": t, "command": command, "pressures": [], "position": []}
            cycles.append(current)
        elif current is not None and number == PRESSURES:
            current["pressures"].append(struct.unpack("<3H", data[:6]))
        elif current is not None and number == POSITION:
            current["position"].append(struct.unpack("<i", data[:4])[0])
    return cycles


def wrong_values(rows, cycles):
    """Rows whose inputs are not those of the last cycle on the bus, or whose command is not that of their own."""
    wrong = []
    for k in range(1, len(rows)):
        row, own, last = rows[k], cycles[k], cycles[k - 1]
        answered = len(last["pressures"]) == 1 and len(last["position"]) == 1
        same = answered and abs(row["x_m"] - last["position"][0] * COUNT_M) < 1e-9 and all(
            abs(row[name] - count * COUNT_PA) < 1e-3
            for name, count in zip(("p1_port_Pa", "p2_port_Pa", "p_supply_Pa"), last["pressures"][0]))
        if not same or abs(row["u_V"] - own["command"] * COUNT_V) > 0.5001 * COUNT_V:
            wrong.append((k, row, own, last))
    return wrong


def position_error(rows):
    """Largest and mean square error over the second half, against where the slider was: the next row's measurement."""
    half = rows[len(rows) // 2:]
    errors = [now["x_ref_m"] - after["x_m"] for now, after in zip(half, half[1:])]
    return max(map(abs, errors)), (sum(e * e for e in errors) / len(errors)) ** 0.5


class Pair(unittest.TestCase):
    """tests/kernel: controller and device as two processes."""

    def run_pair(self, interface_of_device, interface, duration_s, name):
        log = f"/tmp/{name}.log"
        # The conversation of the start comes faster than the log is written: room for all of it, and a word if a frame is lost.
        witness = subprocess.Popen(["candump", "-L", "-d", "-r", str(1 << 22), interface], stdout=open(log, "w"), stderr=subprocess.PIPE,
                                   text=True)
        plant = device(interface_of_device, "--priority", "60")
        run, said = finished(controller(interface, duration_s, "--record", f"/tmp/{name}.csv.gz", "--force"))
        reported = plant.end(terminate=True)
        witness.terminate()
        self.assertNotIn("DROPCOUNT", witness.communicate()[1])
        counted = re.search(r"(\d+) samples, (\d+) missed, (\d+) late, (\d+) out of limits, (\d+) malformed, (\d+) error frames, "
                            r"(\d+) outputs not sent, (\d+) frames dropped, slowest answer (\d+) us", said)
        self.assertIsNotNone(counted, said)
        figures[name] = {"ticks": run["ticks"], "overruns": run["overruns"], "lateness_us": run["lateness_us"],
                         "backend_us": run["backend_us"], "loop_us": run["loop_us"], "samples": int(counted[1]),
                         "missed": int(counted[2]), "late": int(counted[3]), "dropped": int(counted[8]),
                         "slowest_answer_us": int(counted[9])}
        self.assertEqual(run["faults"], [], said)
        self.assertEqual([int(counted[i]) for i in range(2, 9)], [0] * 7, said)
        self.assertIn(", 0 frames not sent, 0 dropped", reported)
        _, rows = rows_of(f"/tmp/{name}.csv.gz")
        cycles = cycles_of(log)
        # Three SYNC to check the answers stand before the loop's own.
        wrong = wrong_values(rows, cycles[3:])
        figures[name]["wrong_values"] = len(wrong)
        self.assertEqual(wrong[:1], [])
        return rows

    def test_vcan(self):
        """As good as the simulation inside the process at the same age of its inputs: within 1 %."""
        duration_s = plan["duration_s"]
        rows = self.run_pair(make_vcan("vcan0"), "vcan0", duration_s, "pair_vcan")
        ours, simulated = position_error(rows), position_error(rows_of("/share/simulated.csv.gz")[1])
        for name, value, beside in zip(("max", "rms"), ours, simulated):
            figures["pair_vcan"][f"{name}_position_error_m"] = value
            figures["pair_vcan"][f"{name}_position_error_beside_sim"] = value / beside - 1.0
            self.assertLess(abs(value / beside - 1.0), 0.01, name)

    def test_two_controllers_on_one_bus(self):
        first, second = make_pair()
        self.run_pair(second, first, plan["short_s"], "pair_kvaser")
