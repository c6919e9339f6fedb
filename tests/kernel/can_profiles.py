# Pressure transmitters of CiA 404 and a valve of CiA 408 in place of the analog module, on a real CAN stack.
import unittest

from guest_tools import *

EDS = "/tmp/config/can"


def pressure(number, pdo):
    return (f"{{can: {{node: pressures, pdo: {pdo}, object: 0x9130{number:02}20, scale_Pa_per_count: 10, lowest_Pa: 50000, "
            "highest_Pa: 810000}}")


PROFILES = settings({
    "hal.can.nodes": f"{{pressures: {{node_id: 2, profile: 404, eds: {EDS}/pressure-transmitter-404.eds}}, "
                     "encoder: {node_id: 3, profile: 406, mapping: read}, "
                     f"valve: {{node_id: 4, profile: 408, eds: {EDS}/proportional-valve-408.eds}}}}",
    "hal.channels.p1_port": pressure(1, 1), "hal.channels.p2_port": pressure(2, 1), "hal.channels.p_supply": pressure(3, 2),
    "hal.channels.u": "{can: {node: valve, pdo: 1, object: 0x63000110, scale_V_per_count: 6.103515625e-4, lowest_V: -5, highest_V: 5, "
                      "readback: {pdo: 1, object: 0x63010110, tolerance_V: 0.002}}}"})


class Profiles(unittest.TestCase):
    """tests/kernel: devices of other profiles."""

    def test_transmitters_and_valve(self):
        make_vcan("vcan0")
        plant = device("vcan0", "--priority", "60", *PROFILES)
        run, said = finished(controller("vcan0", plan["short_s"], "--record", "/tmp/profiles.csv.gz", "--force", *PROFILES))
        plant.end(terminate=True)
        figures["profiles"] = {"ticks": run["ticks"], "overruns": run["overruns"], "backend_us": run["backend_us"]}
        self.assertEqual(run["faults"], [], said)
        self.assertRegex(said, r"samples, 0 missed, 0 late, 0 out of limits, 0 malformed")
        _, rows = rows_of("/tmp/profiles.csv.gz")
        ways_m = [row["x_m"] for row in rows[1:]]  # the first row is before the first answer
        self.assertGreater(max(ways_m) - min(ways_m), 0.01)  # the valve was brought to ACTIVE and moves the slider
