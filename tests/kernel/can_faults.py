# What goes wrong on a bus, forced on a real CAN stack: the fault, the valve, and the way back.
import re, threading, unittest

from guest_tools import *
from serial_adapter import SerialAdapter

SYNC = 0x080
PROBES = 3  # SYNC before the loop's own
BUS_OFF, LINK_DOWN, NODE_LOST, OUTPUT_MISSED = 1 << 20, 1 << 21, 1 << 22, 1 << 15
# A Python script carries the frames of the serial adapter: ten times the period leaves it the time.
SLOW = settings({"period_s": 0.01, "hal.can.heartbeat_s": 0.1, "hal.can.watchdog_s": 0.3, "hal.can.nodes.io.heartbeat_s": 0.1,
                 "hal.can.nodes.encoder.heartbeat_s": 0.1, "estimator.cells_per_m": 0.5, "controller.velocity_filter_s": 0.05,
                 "controller.position_gain_N_per_m": 1500, "controller.force_gain_V_per_N": 0.0008,
                 "reference.amplitude_m": 0.02, "reference.frequency_Hz": 0.2})


def first_row_with(rows, bit):
    return next((k for k, row in enumerate(rows) if int(row["fault"]) & bit), None)


def half_a_second_of_sync(interface):
    """The axis is active then, however long the start took."""
    subprocess.run(["candump", "-n", "500", interface + ",080:7FF"], stdout=subprocess.DEVNULL, timeout=60, check=True)


class Faults(unittest.TestCase):
    """tests/kernel: faults on a real CAN stack."""

    def running(self, *more):
        """Device and controller in the middle of a run of 6 s on a new bus."""
        interface = make_vcan("vcan0")
        plant = device(interface, "--priority", "60")
        run = controller(interface, 6, *more)
        half_a_second_of_sync(interface)
        return interface, plant, run

    def expect_safe(self, record, bit):
        """The fault is there, and from its first tick on the command is the safe one. Its row, all rows."""
        _, rows = rows_of(record)
        first = first_row_with(rows, bit)
        self.assertIsNotNone(first, [row["fault"] for row in rows[-3:]])
        self.assertEqual([row["u_V"] for row in rows[first:] if row["u_V"] != 0.0], [])
        return first, rows

    def expect_works(self, interface, *more):
        """The way back: the same command again, without a fault."""
        run, said = finished(controller(interface, 0.5, *more))
        self.assertEqual(run["faults"], [], said)

    def test_device_killed(self):
        interface, plant, run = self.running("--record", "/tmp/killed.csv.gz", "--force")
        plant.kill()
        _, said = finished(run, status=1)
        first, rows = self.expect_safe("/tmp/killed.csv.gz", 1)  # position_missing: three answers did not come
        lost = first_row_with(rows, NODE_LOST)
        self.assertIsNotNone(lost, said)
        self.assertRegex(said, r"node (io \(2\)|encoder \(3\)): no heartbeat any more")
        # 2.5 times 20 ms after the last one.
        self.assertTrue(25 <= lost - first <= 55, (first, lost))
        figures["device_killed"] = {"ticks_from_missing_to_lost": lost - first}
        plant = device(interface, "--priority", "60")
        self.expect_works(interface)
        plant.end(terminate=True)

    def test_heartbeat_alone(self):
        interface = make_vcan("vcan0")
        plant = device(interface, "--priority", "60", "--fault", "no_heartbeat:encoder@1")
        _, said = finished(controller(interface, 6, "--record", "/tmp/silent.csv.gz", "--force"), status=1)
        self.assertIn("fault: node_lost", said)
        self.assertIn("node encoder (3): no heartbeat any more", said)
        first, _ = self.expect_safe("/tmp/silent.csv.gz", NODE_LOST)
        self.assertTrue(1000 - 1 <= first <= 1000 + 55, first)
        plant.end(terminate=True)

    def test_controller_killed(self):
        """The watchdog of the device closes the valve, as 0x1016 and 0x6444 were written."""
        interface = make_vcan("vcan0")
        witness = subprocess.Popen(["candump", "-L", interface + ",082:7FF,080:7FF"], stdout=open("/tmp/watchdog.log", "w"))
        plant = device(interface, "--priority", "60")
        run = controller(interface, 6)
        half_a_second_of_sync(interface)
        run.kill()
        time.sleep(0.5)
        witness.terminate()
        witness.wait()
        self.assertTrue(plant.end(terminate=True).rstrip().endswith("valve 0.0000 V"))
        lines = open("/tmp/watchdog.log").read().splitlines()
        last_sync = max(k for k, line in enumerate(lines) if " 080#" in line)
        emergency = lines[last_sync + 1]
        self.assertIn(" 082#30811", emergency)  # 0x8130, register 0x11
        after_s = float(emergency[1:].split(")")[0]) - float(lines[last_sync][1:].split(")")[0])
        figures["controller_killed"] = {"emergency_after_last_sync_s": round(after_s, 4)}
        self.assertTrue(0.04 <= after_s <= 0.0625, after_s)  # watchdog_s 0.06 after the last heartbeat

    def test_bus_off(self):
        """Reported by an adapter behind the kernel's slcan driver. Nothing is handed over afterwards."""
        plant = device(make_vcan("vcan1"), *SLOW)
        adapter = SerialAdapter("vcan1").up()
        self.expect_works(adapter.name, *SLOW)
        run = controller(adapter.name, 6, "--record", "/tmp/off.csv.gz", "--force", *SLOW)
        began = len(adapter.heard)
        while adapter.heard[began:].count(SYNC) < 60:
            time.sleep(0.005)
        heard = adapter.bus_off()
        time.sleep(0.05)
        state = sh(f"ip -d link show {adapter.name}")
        _, said = finished(run, status=1)
        self.assertIn("BUS-OFF", state)
        self.assertIn("fault: bus_off", said)
        self.assertIn("the controller went bus-off", said)
        first, rows = self.expect_safe("/tmp/off.csv.gz", BUS_OFF)
        ticks = adapter.heard[began:heard].count(SYNC) - PROBES
        figures["bus_off"] = {"ticks_to_the_fault": first - ticks + 1}
        self.assertLessEqual(first - (ticks - 1), 2)
        self.assertLessEqual(adapter.heard[heard:].count(SYNC), 1)
        # Down and up again empties the queue and brings the controller back.
        adapter.down()
        adapter.passes = True
        adapter.up()
        self.expect_works(adapter.name, *SLOW)
        adapter.down()
        adapter.close()
        plant.end(terminate=True)

    def test_queue_full(self):
        """A bus that takes nothing: a full queue is a missed output, and no old command is sent when it takes again."""
        interface, plant, run = self.running("--record", "/tmp/full.csv.gz", "--force")
        sh(f"tc qdisc replace dev {interface} root tbf rate 8bit burst 20 limit 160")
        _, said = finished(run, status=1)
        sh(f"tc qdisc del dev {interface} root")
        self.assertIn("output_missed", said)
        self.assertRegex(said, r"[1-9]\d* outputs not sent")
        self.expect_safe("/tmp/full.csv.gz", OUTPUT_MISSED)
        self.expect_works(interface)
        plant.end(terminate=True)

    def test_link_down(self):
        interface, plant, run = self.running("--record", "/tmp/down.csv.gz", "--force")
        sh(f"ip link set {interface} down")
        _, said = finished(run, status=1)
        self.assertIn("the link went down", said)
        # The kernel drops frames in silence while it closes the interface; the answers miss before it says so.
        first, rows = self.expect_safe("/tmp/down.csv.gz", LINK_DOWN)
        safe = next(k for k, row in enumerate(rows) if int(row["fault"]))
        figures["link_down"] = {"ticks_from_first_fault_to_link_down": first - safe}
        self.assertLessEqual(first - safe, 30)
        plant.end(terminate=True)
        refused = controller(interface, 1)
        refused.end()
        self.assertEqual(refused.status, 1)
        self.assertIn(f"ip link set {interface}", refused.said())
        sh(f"ip link set {interface} txqueuelen 16 up")
        plant = device(interface, "--priority", "60")
        self.expect_works(interface)
        plant.end(terminate=True)
