# The loop locked to another master's SYNC on a real CAN stack, and its replay.
import unittest

from guest_tools import *

FOREIGN = settings({"hal.can.sync": "foreign"})


class Locked(unittest.TestCase):
    """tests/kernel: the SYNC of another master."""

    def test_foreign_sync(self):
        make_vcan("vcan0")
        plant = device("vcan0", "--priority", "60", *FOREIGN)
        record = "/tmp/locked.csv.gz"
        run, said = finished(controller("vcan0", plan["duration_s"], "--record", record, "--force", *FOREIGN))
        plant.end(terminate=True)
        replay = replayed(CONFIG, record, *FOREIGN, *settings({"hal.can.interface": "vcan0"}), *STATED)
        figures["foreign_sync"] = {"ticks": run["ticks"], "overruns": run["overruns"], "lateness_us": run["lateness_us"],
                                   "backend_us": run["backend_us"], "replay_identical": replay["identical"]}
        self.assertEqual(run["faults"], [], said)
        self.assertRegex(said, r"samples, 0 missed, 0 late, 0 out of limits, 0 malformed")
        self.assertEqual(run["overruns"], 0, said)
        self.assertGreaterEqual(run["ticks"], plan["duration_s"] * 1000)
        self.assertTrue(replay["identical"], replay)
