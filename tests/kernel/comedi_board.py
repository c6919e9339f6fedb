# All channels of a rig on a DA/AD board: the kernel's comedi_test carries each output to the input of its number.
import unittest

from comedi_library import Board
from guest_tools import *

COMEDI = "/tmp/config/comedi/cylinder-10m-7.65mm.yaml"
PERIOD_S = 0.01
SLOW = slow_axis(PERIOD_S)


class Slider(SliderThread):
    """At the board's terminals: a slider whose speed follows the valve's voltage, pressures that rest but for noise."""

    def __init__(self):
        super().__init__(PERIOD_S)
        self.board, self.fixed_V = Board(), {}
        self.board.write(0, 0.0)
        self.step(0.0)

    def step(self, dt_s):
        self.x_m += dt_s * 0.5 * self.board.read(0)
        for channel, volts in ((1, 4.7 + self.noise.gauss(0, 0.003)), (2, 5.402 + self.noise.gauss(0, 0.003)), (3, self.x_m / 0.0175)):
            self.board.write(channel, self.fixed_V.get(channel, volts))

    def stop(self):
        super().stop()
        self.valve_V = self.board.read(0)
        self.board.close()


class Analog(unittest.TestCase):
    """tests/kernel: a DA/AD board."""

    def setUp(self):
        self.slider = Slider()
        self.slider.start()

    def tearDown(self):
        if not self.slider.ends:
            self.slider.stop()

    def control(self, duration_s, *more):
        return Program("run", COMEDI, "--time", "real", "--duration-s", str(duration_s), "--json", "-", *SLOW, *more)

    def test_closed_loop(self):
        run, said = finished(self.control(5, "--record", "/tmp/board.csv.gz", "--force"))
        self.assertEqual(run["faults"], [], said)
        self.assertIn("x: input 3, -10 to 10 V, the board's own calibration", said)
        self.assertIn("0 samples at the converter's end, 0 out of limits, 0 calls refused", said)
        readback = float(said.split("was read back within ")[1].split()[0])
        self.assertLess(readback, 0.0002)  # half a count of 16 bits over 20 V
        head, rows = rows_of("/tmp/board.csv.gz")
        self.assertTrue(any("x: real, p1_port: real, p2_port: real" in line for line in head))
        positions = [row["x_m"] for row in rows if row["x_m"] is not None]
        self.assertGreater(max(positions) - min(positions), 0.002)
        self.assertLess(abs(sum(row["p1_port_Pa"] for row in rows) / len(rows) - 470e3), 100.0)
        self.slider.stop()
        self.assertLess(abs(self.slider.valve_V), 0.001)  # the safe output stays
        figures["board"] = {"ticks": run["ticks"], "overruns": run["overruns"], "backend_us": run["backend_us"],
                            "readback_V": readback}

    def test_stuck_output(self):
        """The readback input is another one than the output's: as if the output did not follow."""
        _, said = finished(self.control(5, "--set", "hal.channels.u.comedi.readback.channel=4", "--set",
                                        "hal.channels.u.comedi.readback.tolerance_V=0.002"), status=1)
        self.assertIn("fault: output_unconfirmed", said)
        self.assertIn("more than its tolerance", said)

    def test_cable_at_the_end_of_the_range(self):
        run = self.control(10, "--record", "/tmp/saturated.csv.gz", "--force")
        self.slider.wait_until_driven(run)
        self.slider.fixed_V[1] = 10.0
        _, said = finished(run, status=1)
        self.assertIn("fault: port_pressure_1_missing", said)
        _, rows = rows_of("/tmp/saturated.csv.gz")
        empty = next(k for k, row in enumerate(rows) if row["p1_port_Pa"] is None)
        fault = next(k for k, row in enumerate(rows) if int(row["fault"]))
        self.assertEqual(fault, empty)  # limits.missing_ticks is 0: none is bridged
        self.slider.fixed_V.clear()
        run, said = finished(self.control(0.5))
        self.assertEqual(run["faults"], [], said)

    def test_refusals(self):
        for word, *sets in (("expected one of 0: -10 to 10 V, 1: -5 to 5 V", "hal.channels.x.comedi.range=5"),
                            ("found input 77, expected one of 0 to 7", "hal.channels.x.comedi.channel=77"),
                            ("cannot be opened", "hal.comedi.device=/dev/comedi9"),
                            ("calibration file /tmp/none cannot be read", "hal.comedi.calibration=/tmp/none")):
            run = self.control(1, "--set", *sets)
            run.end()
            self.assertEqual(run.status, 1)
            self.assertIn(word, run.said())
