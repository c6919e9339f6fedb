# Digital lines on the kernel's simulated GPIO chip, in one rig with an encoder and a valve on CAN, a sensor on a DA/AD
# board and simulated pressures.
import glob, unittest

from comedi_library import Board
from guest_tools import *

MIXED = "/tmp/config/mixed/cylinder-10m-7.65mm.yaml"
LINES = ["ESTOP", "LIMIT_LOW", "LIMIT_HIGH", "VALVE_POWER", "ENABLE", "OTHER"]
COMMAND, SYNC = 0x302, 0x080


class Chip:
    """gpio-sim with named lines."""

    def __init__(self):
        folder = "/sys/kernel/config/gpio-sim/pneuservo"
        if not os.path.isdir("/sys/module/gpio_sim_oot"):
            sh("insmod /share/gpio-sim.ko")
        if not os.path.isdir(folder):
            for i, name in enumerate(LINES):
                os.makedirs(f"{folder}/bank/line{i}")
                self.put(f"{folder}/bank/line{i}/name", name)
            self.put(f"{folder}/bank/num_lines", str(len(LINES)))
            self.put(f"{folder}/live", "1")
        self.name = open(f"{folder}/bank/chip_name").read().strip()
        self.folder = f"/sys/devices/platform/{open(f'{folder}/dev_name').read().strip()}/{self.name}"

    @staticmethod
    def put(path, text):
        with open(path, "w") as file:
            file.write(text)

    def pull(self, line, up):
        self.put(f"{self.folder}/sim_gpio{LINES.index(line)}/pull", "pull-up" if up else "pull-down")

    def value(self, line):
        return int(open(f"{self.folder}/sim_gpio{LINES.index(line)}/value").read())


class Lines(unittest.TestCase):
    """tests/kernel: digital lines, channels of four kinds in one rig."""

    def setUp(self):
        self.chip = Chip()
        for line in LINES:
            self.chip.pull(line, False)  # not pressed, no limit; valve power is active low
        self.board = Board()
        self.board.write(0, 7.0)         # the supply's sensor
        self.interface = make_vcan("vcan0")
        self.plant = device(self.interface, "--priority", "60", config=MIXED)

    def tearDown(self):
        self.plant.end(terminate=True)
        self.board.close()

    def control(self, duration_s, *more):
        # The board's voltage stands still: a sensor without noise.
        return controller(self.interface, duration_s, "--set", "hal.bench=true", "--set", "sensors.supply_pressure.noise_Pa=0", *more,
                          config=MIXED)

    def wait_until_enabled(self):
        end = time.monotonic() + 10
        while self.chip.value("ENABLE") != 1:
            self.assertLess(time.monotonic(), end, "the enable output never went on")
            time.sleep(0.01)

    def test_channels_mix(self):
        run = self.control(2, "--record", "/tmp/mixed.csv.gz", "--force")
        self.wait_until_enabled()
        self.assertIn("pneuservo emergency_stop", sh(f"gpioinfo {self.chip.name}"))
        run, said = finished(run)
        self.assertEqual(run["faults"], [], said)
        self.assertEqual(self.chip.value("ENABLE"), 0)
        head, rows = rows_of("/tmp/mixed.csv.gz")
        self.assertTrue(any("x: real, p1_port: simulated, p2_port: simulated, p1_chamber: absent, p2_chamber: absent, p_supply: real"
                            in line for line in head), head[:20])
        # 16 bits over 20 V, 1e5 Pa/V: 31 Pa a count.
        self.assertLess(max(abs(row["p_supply_Pa"] - 700e3) for row in rows), 32.0)
        positions = [row["x_m"] for row in rows if row["x_m"] is not None]
        self.assertGreater(max(positions) - min(positions), 0.1)
        figures["mixed"] = {"overruns": run["overruns"], "backend_us": run["backend_us"], "lateness_us": run["lateness_us"]}

    def fault_by(self, line, fault, change):
        """Pulls a line while the axis moves; the fault, the valve on the bus and the enable output. Then the way back."""
        log = "/tmp/lines.log"
        witness = subprocess.Popen(["candump", "-L", self.interface], stdout=open(log, "w"))
        run = self.control(6, "--record", "/tmp/lines.csv.gz", "--force")
        self.wait_until_enabled()
        time.sleep(1.0)
        pulled = time.time()
        change()
        time.sleep(0.02)
        self.assertEqual(self.chip.value("ENABLE"), 0)
        _, said = finished(run, status=1)
        witness.terminate()
        witness.wait()
        self.assertIn(f"fault: {fault}", said)
        commands = []
        with open(log) as file:
            for text in file:
                stamp, _, frame = text.split()
                if frame.startswith("302#"):
                    commands.append((float(stamp[1:-1]), frame[4:8]))
        last = max(t for t, counts in commands if counts != "0000")
        figures[f"safe_after_{line}"] = {"last_command_after_edge_us": round((last - pulled) * 1e6)}
        self.assertLess(last - pulled, 0.002)  # the tick under way, and the next one sends the safe output
        _, rows = rows_of("/tmp/lines.csv.gz")
        first = next(k for k, row in enumerate(rows) if int(row["fault"]))
        self.assertEqual([row["u_V"] for row in rows[first:] if row["u_V"] != 0.0], [])
        self.assertNotEqual(rows[first - 1]["u_V"], 0.0)
        self.chip.pull(line, False)
        run, said = finished(self.control(0.5))
        self.assertEqual(run["faults"], [], said)

    def test_emergency_stop(self):
        self.fault_by("ESTOP", "emergency_stop", lambda: self.chip.pull("ESTOP", True))

    def test_emergency_stop_let_go_at_once(self):
        """Pressed and let go within a tick, by its edges alone."""
        def pulse():
            self.chip.pull("ESTOP", True)
            self.chip.pull("ESTOP", False)
        self.fault_by("ESTOP", "emergency_stop", pulse)

    def test_limit_and_valve_power(self):
        self.fault_by("LIMIT_HIGH", "limit_switch", lambda: self.chip.pull("LIMIT_HIGH", True))
        self.fault_by("VALVE_POWER", "valve_power", lambda: self.chip.pull("VALVE_POWER", True))

    def refused(self, words, *sets):
        run = self.control(1, *sets)
        run.end()
        self.assertEqual(run.status, 1)
        for word in words:
            self.assertIn(word, run.said())

    def test_refusals(self):
        taken = subprocess.Popen(["gpioset", "--mode=signal", self.chip.name, f"{LINES.index('OTHER')}=1"])
        time.sleep(0.3)
        self.refused(["hal.gpio.limit_low", "'OTHER'", "is taken by 'gpioset'"], "--set", "hal.gpio.limit_low.line=OTHER")
        taken.terminate()
        taken.wait()
        self.refused(["hal.gpio.enable", "'NOWHERE'", "no chip has a line of this name"], "--set", "hal.gpio.enable.line=NOWHERE")
        self.refused(["no such chip"], "--set", "hal.gpio.enable.chip=gpiochip77")
        self.refused(["has no such line"], "--set", f"hal.gpio.enable.chip={self.chip.name}", "--set", "hal.gpio.enable.line=77")
        # A resistor of the chip: pulled up, an open emergency stop is pressed.
        self.refused(["fault: emergency_stop"], "--set", "hal.gpio.emergency_stop.bias=pull_up")
