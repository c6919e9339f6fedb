# All channels of a rig on the kernel's Industrial I/O: two devices of iio_dummy, whose inputs a slider writes.
import os, unittest

from guest_tools import *

IIO = "/tmp/config/iio/cylinder-10m-7.65mm.yaml"
DEVICES, CONFIGFS = "/sys/bus/iio/devices", "/sys/kernel/config/iio"
PERIOD_S, RATE_HZ = 0.01, 100
# As the driver states them: volts of a count, and the offset of its unsigned input of 13 bits.
SINGLE_V, OFFSET, DIFFERENTIAL_V = 1.333e-6, 7, 1.344e-9
X_M, P1_PA, P2_PA, U_V, NEUTRAL, P2_ZERO_PA = 8e-5, 100.0, 400.0, 1.25e-3, 4096, 400e3  # of a count; U: neutral code


def channel(name, device, channel, **more):
    return {f"hal.channels.{name}.iio.{key}": value for key, value in {"device": device, "channel": channel, **more}.items()}


WIRED = settings({
    **channel("x", "adc", "voltage1-voltage2", scale_m_per_V=X_M / DIFFERENTIAL_V),
    **channel("p1_port", "adc", "voltage0", scale_Pa_per_V=P1_PA / SINGLE_V),
    **channel("p2_port", "adc", "voltage3-voltage4", scale_Pa_per_V=P2_PA / DIFFERENTIAL_V, zero_Pa=P2_ZERO_PA),
    **channel("u", "dac", "voltage0", V_per_count=SINGLE_V, scale_V_per_V=U_V / SINGLE_V, zero_V=-U_V * NEUTRAL),
    "hal.channels.u.iio.readback.device": "dac", "hal.channels.u.iio.readback.channel": "voltage0",
    "hal.channels.u.iio.readback.tolerance_V": 2 * SINGLE_V}) + slow_axis(PERIOD_S)
LOCKED = settings({"hal.iio.trigger": "clock"})


def name_of(folder):
    with open(f"{DEVICES}/{folder}/name") as file:
        return file.read().strip()


def folder_of(name):
    return next(f"{DEVICES}/{folder}" for folder in os.listdir(DEVICES) if name_of(folder) == name)


def make_devices():
    """The driver, two devices and a trigger, once."""
    if not os.path.isdir(CONFIGFS):
        for module in ("industrialio-configfs", "industrialio-sw-device", "industrialio-sw-trigger", "iio-trig-hrtimer", "iio_dummy"):
            sh(f"insmod /share/{module}.ko")
    for folder in ("devices/dummy/adc", "devices/dummy/dac", "triggers/hrtimer/clock"):
        os.makedirs(f"{CONFIGFS}/{folder}", exist_ok=True)
    set_rate(RATE_HZ)


def set_rate(rate_Hz):
    with open(f"{folder_of('clock')}/sampling_frequency", "w") as file:
        file.write(str(rate_Hz))


class Terminal:
    """A file of a device, as raw counts."""

    def __init__(self, device, attribute):
        self.file = os.open(f"{folder_of(device)}/{attribute}", os.O_RDWR)

    def read(self):
        return int(os.pread(self.file, 32, 0))

    def write(self, code):
        os.pwrite(self.file, str(code).encode(), 0)


class Slider(SliderThread):
    """At the terminals: a slider whose speed follows the valve's voltage, pressures that rest but for noise, a wire back."""

    def __init__(self):
        super().__init__(PERIOD_S)
        self.fixed, self.wire_is_cut = {}, False
        self.valve, self.back = Terminal("dac", "out_voltage0_raw"), Terminal("dac", "in_voltage0_raw")
        self.inputs = {"x": Terminal("adc", "in_voltage1-voltage2_raw"), "p1_port": Terminal("adc", "in_voltage0_raw"),
                       "p2_port": Terminal("adc", "in_voltage3-voltage4_raw")}
        self.valve.write(NEUTRAL)
        self.step(0.0)

    def step(self, dt_s):
        code = self.valve.read()
        if not self.wire_is_cut:
            self.back.write(code - OFFSET)
        self.x_m += dt_s * 0.5 * (code - NEUTRAL) * U_V
        codes = {"x": self.x_m / X_M, "p1_port": (470e3 + self.noise.gauss(0, 300)) / P1_PA - OFFSET,
                 "p2_port": (540.2e3 - P2_ZERO_PA + self.noise.gauss(0, 300)) / P2_PA}
        for name, terminal in self.inputs.items():
            terminal.write(round(self.fixed.get(name, codes[name])))


class Industrial(unittest.TestCase):
    """tests/kernel: the kernel's Industrial I/O."""

    def setUp(self):
        make_devices()
        self.slider = Slider()
        self.slider.start()

    def tearDown(self):
        self.slider.stop()

    def control(self, duration_s, *more):
        return Program("run", IIO, "--time", "real", "--duration-s", str(duration_s), "--json", "-", *WIRED, *more)

    def run_whole(self, name, *more):
        record = f"/tmp/{name}.csv.gz"
        run, said = finished(self.control(plan["duration_s"], "--record", record, "--force", *more))
        self.assertEqual(run["faults"], [], said)
        self.assertIn("0 samples at the converter's end, 0 out of limits, 0 calls refused", said)
        self.assertNotIn("check its wire", said)
        head, rows = rows_of(record)
        self.assertTrue(any("x: real, p1_port: real, p2_port: real" in line for line in head))
        positions = [row["x_m"] for row in rows]
        self.assertGreater(max(positions) - min(positions), 0.002)
        self.assertLess(abs(sum(row["p1_port_Pa"] for row in rows) / len(rows) - 470e3), 100.0)
        self.assertLess(abs(sum(row["p2_port_Pa"] for row in rows) / len(rows) - 540.2e3), 100.0)
        self.assertEqual(self.slider.valve.read(), NEUTRAL)  # the safe output stays
        replay = replayed(IIO, record, *WIRED, *more)
        self.assertTrue(replay["identical"], replay)
        figures[name] = {"ticks": run["ticks"], "overruns": run["overruns"], "backend_us": run["backend_us"],
                         "lateness_us": run["lateness_us"], "replay_identical": replay["identical"]}
        self.assertEqual(run["overruns"], 0, said)
        return said

    def test_direct(self):
        said = self.run_whole("iio_direct")
        self.assertIn("p1_port.iio: input voltage0 of adc (iio:device", said)
        self.assertIn("1.333e-06 V a count, offset 7", said)
        self.assertIn("4 inputs are read one by one", said)

    def test_locked_to_a_trigger(self):
        said = self.run_whole("iio_locked", *LOCKED)
        self.assertIn("inputs by scans, stamped by the kernel", said)

    def test_trigger_that_stops(self):
        run = self.control(30, *LOCKED)
        self.slider.wait_until_driven(run)
        set_rate(0.01)
        _, said = finished(run, status=1)
        self.assertIn("fault: position_missing", said)
        self.assertEqual(self.slider.valve.read(), NEUTRAL)

    def test_wire_of_the_output(self):
        run = self.control(10)
        self.slider.wait_until_driven(run)
        self.slider.wire_is_cut = True
        _, said = finished(run, status=1)
        self.assertIn("fault: output_unconfirmed", said)

    def test_input_at_the_end_of_its_converter(self):
        for more in ((), LOCKED):
            run = self.control(10, "--record", "/tmp/end.csv.gz", "--force", "--set", "hal.channels.x.iio.highest_m=1", *more)
            self.slider.wait_until_driven(run)
            self.slider.fixed["x"] = 2047  # 12 bits, signed
            _, said = finished(run, status=1)
            self.assertIn("fault: position_missing", said)
            self.slider.fixed.clear()

    def test_program_killed(self):
        guarded = settings({"hal.iio.watchdog": "guard", "hal.guard": "{}"})
        guard = Program("guard", IIO, *WIRED, *guarded).wait_for("acts after")
        self.slider.fixed["x"] = 250  # the valve does not move it: its command stands
        run = self.control(30, *guarded)
        self.slider.wait_until_driven(run)
        self.assertIsNone(run.process.poll(), run.said())
        self.assertNotEqual(self.slider.valve.read(), NEUTRAL)
        run.kill()
        time.sleep(0.5)
        self.assertEqual(self.slider.valve.read(), NEUTRAL, guard.said())
        guard.end(terminate=True)

    def test_one_program_a_device(self):
        run = self.control(3)
        self.slider.wait_until_driven(run)
        second = self.control(1)
        second.end()
        self.assertEqual(second.status, 1)
        self.assertRegex(second.said(), r"(adc|dac) \(iio:device\d\): held by process \d+ \(pneuservo\)")
        finished(run)

    def test_refusals(self):
        for word, *sets in (("found the devices", "hal.channels.x.iio.device=ad7606-8"),
                            ("found no input of volts 'voltage9', expected one of: voltage0, voltage1-voltage2, voltage3-voltage4",
                             "hal.channels.x.iio.channel=voltage9"),
                            ("found no output of volts 'voltage1'", "hal.channels.u.iio.channel=voltage1"),
                            ("found a driver that states no scale of voltage0", "hal.channels.u.iio.V_per_count=0"),
                            ("beside the driver's own scale of 1.333e-06 V", "hal.channels.p1_port.iio.V_per_count=1"),
                            ("found no trigger 'none', expected one of: clock", "hal.iio.trigger=none")):
            run = self.control(1, "--set", *sets)
            run.end()
            self.assertEqual(run.status, 1, run.said())
            self.assertIn(word, run.said())
        set_rate(50)
        run = self.control(1, *LOCKED)
        run.end()
        self.assertIn("found a scan every 0.02 s by trigger 'clock', expected one every 0.01 s", run.said())

    @unittest.skipUnless(plan["long"], "grading a config draws machines: many seconds under emulation")
    def test_check_lists_the_devices(self):
        said = Program("check", IIO).end()
        self.assertRegex(said, r"adc \(iio:device\d\): inputs voltage0, voltage1-voltage2, voltage3-voltage4; outputs voltage0")
        self.assertIn("triggers clock", said)
        self.assertRegex(said, r"bad +I/O channel +ad7606-8: hal.channels.x.iio.device: found the devices")
