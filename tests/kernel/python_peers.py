# The library canopen for Python, written by others, at the other end of the bus: as master of our device, and as the
# devices of our controller.
import random, threading, unittest

import canopen
from canopen.objectdictionary import INTEGER16, INTEGER32, UNSIGNED8, UNSIGNED16, UNSIGNED32, VISIBLE_STRING
from canopen.objectdictionary import ObjectDictionary, ODRecord, ODVariable

from guest_tools import *

IO, ENCODER, US = 2, 3, 126
PA, VOLT, METER = 25.0, 3.0517578125e-4, 5.0e-6  # of one count


def variable(index, sub, kind, value=0, access="rw"):
    v = ODVariable(f"{index:04X}sub{sub:X}", index, sub)
    v.data_type, v.default, v.access_type, v.pdo_mappable = kind, value, access, True
    return v


def record(dictionary, index, members):
    r = ODRecord(f"{index:04X}", index)
    r.add_member(variable(index, 0, UNSIGNED8, max(sub for sub, _, _ in members)))
    for sub, kind, value in members:
        r.add_member(variable(index, sub, kind, value))
    dictionary.add_object(r)


def dictionary_of(node, device_type, application):
    """What CiA 301 asks of a device, PDOs off or at the maker's presets, and the application's records."""
    od = ObjectDictionary()
    od.add_object(variable(0x1000, 0, UNSIGNED32, device_type, "ro"))
    od.add_object(variable(0x1001, 0, UNSIGNED8, 0, "ro"))
    od.add_object(variable(0x1008, 0, VISIBLE_STRING, "a name longer than four bytes", "const"))
    od.add_object(variable(0x1017, 0, UNSIGNED16))
    record(od, 0x1016, [(1, UNSIGNED32, 0)])
    record(od, 0x1018, [(1, UNSIGNED32, 0)])
    record(od, 0x1029, [(1, UNSIGNED8, 1)])
    for i in range(4):
        record(od, 0x1400 + i, [(1, UNSIGNED32, 0x80000200 + 0x100 * i + node), (2, UNSIGNED8, 255)])
        record(od, 0x1800 + i, [(1, UNSIGNED32, 0xC0000180 + 0x100 * i + node), (2, UNSIGNED8, 255), (3, UNSIGNED16, 100),
                                (5, UNSIGNED16, 0)])
        for mapping in (0x1600, 0x1A00):
            record(od, mapping + i, [(sub, UNSIGNED32, 0) for sub in range(1, 9)])
            od[mapping + i][0].default = 0
    for index, members in application.items():
        record(od, index, members)
    return od


def io_dictionary():
    return dictionary_of(IO, 0x000F0191, {
        0x6401: [(sub, INTEGER16, 0) for sub in (1, 2, 3, 4)], 0x6411: [(1, INTEGER16, 0)], 0x6443: [(1, UNSIGNED8, 0)],
        0x6444: [(1, INTEGER32, 1)]})


class Master(unittest.TestCase):
    """tests/kernel: canopen for Python as master of our device."""

    def setUp(self):
        self.interface = make_vcan("vcan0", queue=256)
        self.plant = device(self.interface)
        self.network = canopen.Network()
        self.network.connect(interface="socketcan", channel=self.interface)
        self.node = self.network.add_node(IO, io_dictionary())
        self.encoder = self.network.add_node(ENCODER, dictionary_of(ENCODER, 406, {0x6020: [(1, INTEGER32, 0)]}))

    def tearDown(self):
        self.network.disconnect()
        self.plant.end(terminate=True)

    def reset(self, node):
        came = threading.Event()
        self.network.subscribe(0x700 + node.id, lambda _, data, __: came.set() if data[0] == 0 else None)
        node.nmt.send_command(0x82)
        self.assertTrue(came.wait(5.0), "no boot-up message")

    def test_objects(self):
        self.reset(self.node)
        sdo = self.node.sdo
        self.assertEqual(sdo[0x1000].raw & 0xFFFF, 401)
        self.assertEqual(sdo[0x1008].raw, "io")
        sdo[0x1016][1].raw = US << 16 | 100
        self.assertEqual(sdo[0x1016][1].raw, US << 16 | 100)
        for index, sub, code in ((0x7777, 0, 0x06020000), (0x1016, 9, 0x06090011)):
            with self.assertRaises(canopen.SdoAbortedError) as refused:
                sdo.upload(index, sub)
            self.assertEqual(refused.exception.code, code)
        with self.assertRaises(canopen.SdoAbortedError) as refused:
            sdo.download(0x1000, 0, b"\0\0\0\0")
        self.assertEqual(refused.exception.code, 0x06010002)
        with self.assertRaises(canopen.SdoAbortedError) as refused:
            sdo.download(0x1017, 0, b"\0\0\0")
        self.assertEqual(refused.exception.code & 0xFFFF0000, 0x06070000)

    def test_process_data(self):
        self.reset(self.node)
        self.reset(self.encoder)
        self.node.tpdo.read()
        self.node.rpdo.read()
        inputs, outputs = self.node.tpdo[2], self.node.rpdo[2]
        for pdo, objects in ((inputs, [(0x6401, 1), (0x6401, 2), (0x6401, 3)]), (outputs, [(0x6411, 1)])):
            pdo.clear()
            for index, sub in objects:
                pdo.add_variable(index, sub)
            pdo.trans_type, pdo.enabled, pdo.cob_id = 1, True, (0x280 if pdo is inputs else 0x300) + IO
            pdo.save()
        self.encoder.tpdo.read()  # its mapping is the maker's
        position = self.encoder.tpdo[1]
        self.assertEqual([(v.index, v.subindex, v.length) for v in position.map], [(0x6020, 1, 32)])
        position.trans_type = 1
        position.save()
        for node in (self.node, self.encoder):
            node.nmt.state = "OPERATIONAL"
        positions, pressures, answers = [], [], threading.Semaphore(0)
        for pdo in (inputs, position):
            pdo.add_callback(lambda _: answers.release())
        for tick in range(40):
            outputs.map[0].raw = round(1.0 / VOLT) if tick >= 10 else 0
            outputs.transmit()
            self.network.sync.transmit()
            for _ in range(2):
                self.assertTrue(answers.acquire(timeout=1.0), f"SYNC {tick}: not both nodes answered")
            positions.append(position.map[0].raw * METER)
            pressures.append([v.raw * PA for v in inputs.map])
        self.assertTrue(all(abs(p[2] - 700e3) < 5e3 for p in pressures), pressures[:3])
        self.assertLess(abs(pressures[5][0] - 470e3), 5e3)
        # 1 V opens supply to port 1 and port 2 to the outside.
        self.assertGreater(pressures[-1][0], pressures[9][0] + 20e3)
        self.assertLess(pressures[-1][1], pressures[9][1] - 20e3)
        self.assertLess(max(positions) - min(positions), 0.05)

    def test_watch_and_emergency(self):
        self.reset(self.node)
        self.node.sdo[0x1017].raw = 50
        self.assertEqual(self.node.nmt.wait_for_heartbeat(1.0), "PRE-OPERATIONAL")
        self.node.sdo[0x6443][1].raw = 1
        self.node.sdo[0x6444][1].raw = -1000
        self.node.sdo[0x1016][1].raw = US << 16 | 100
        self.node.nmt.state = "OPERATIONAL"
        self.assertEqual(self.node.nmt.wait_for_heartbeat(1.0), "OPERATIONAL")
        alive = self.network.send_periodic(0x700 + US, [5], 0.02)
        self.assertIsNone(self.node.emcy.wait(timeout=0.5))
        alive.stop()
        lost = self.node.emcy.wait(timeout=1.0)
        self.assertIsNotNone(lost)
        self.assertEqual(lost.code, 0x8130)
        self.assertEqual(self.node.nmt.wait_for_heartbeat(1.0), "PRE-OPERATIONAL")
        self.assertEqual(self.node.sdo[0x6411][1].raw, -1000)
        self.network.sync.transmit()  # the device's time begins with it
        self.plant.type("emergency:io:0x3100")
        ordered = self.node.emcy.wait(0x3100, timeout=1.0)
        self.assertIsNotNone(ordered)


class PythonDevices:
    """An analog module and an encoder as LocalNodes, with a slider that follows the valve."""

    def __init__(self, interface, period_s):
        self.network = canopen.Network()
        self.network.connect(interface="socketcan", channel=interface)
        self.io = self.network.create_node(IO, io_dictionary())
        encoder = dictionary_of(ENCODER, 0x00000196, {0x6020: [(1, INTEGER32, 0)]})
        encoder[0x1800][1].default = 0x40000180 + ENCODER   # on, by its own timer
        encoder[0x1800][2].default = 254
        encoder[0x1A00][0].default, encoder[0x1A00][1].default = 1, 0x60200120
        self.encoder = self.network.create_node(ENCODER, encoder)
        self.period_s, self.x_m, self.u_V, self.syncs, self.noise = period_s, 0.0, 0.0, 0, random.Random(1)
        self.network.subscribe(0x000, self.on_nmt)
        self.network.subscribe(0x080, self.on_sync)

    # LocalNode itself neither announces itself after a reset nor answers SYNC.
    def on_nmt(self, _, data, __):
        for node in (self.io, self.encoder):
            if data[1] not in (0, node.id):
                continue
            if data[0] in (0x81, 0x82):
                node.data_store.clear()
                node.nmt.send_command(0x82)   # announces itself
                node.nmt.send_command(0x80)
            elif data[0] == 0x01:
                node.tpdo.read()
                node.rpdo.read()

    def on_sync(self, _, data, __):
        self.syncs += 1
        operational = [node for node in (self.io, self.encoder) if node.nmt.state == "OPERATIONAL"]
        if self.io in operational:
            self.u_V = self.io.rpdo[2].map[0].raw * VOLT
        self.x_m = max(-0.14, min(0.14, self.x_m + self.period_s * 0.5 * self.u_V))
        pressures = [470e3, 540.2e3, 700e3]
        for node in operational:
            pdo = node.tpdo[2] if node is self.io else node.tpdo[1]
            # Behind the pressures the module shows its output, where it is mapped.
            values = [round((p + self.noise.gauss(0, 300)) / PA) for p in pressures] + [round(self.u_V / VOLT)] if node is self.io else [round(self.x_m / METER)]
            for v, value in zip(pdo.map, values):
                v.raw = value
            pdo.transmit()

    def close(self):
        self.network.disconnect()


class Devices(unittest.TestCase):
    """tests/kernel: our controller on devices of canopen for Python."""

    def test_run(self):
        period_s = 0.02
        sets = settings({"period_s": period_s, "hal.can.heartbeat_s": 0.1, "hal.can.watchdog_s": 0.5,
                         "hal.can.nodes.io.heartbeat_s": 0.2, "hal.can.nodes.encoder.heartbeat_s": 0.2,
                         "estimator.cells_per_m": 0.5, "controller.velocity_filter_s": 0.05,
                         "controller.position_gain_N_per_m": 1500, "controller.force_gain_V_per_N": 0.0008,
                         "controller.pressure_source": "valve", "reference.amplitude_m": 0.02, "reference.frequency_Hz": 0.2,
                         "hal.bench": "true", "limits.flow_mismatch_share": 0, "limits.deviation_m": 0, "limits.speed_deviation_mps": 0,
                         "limits.stall_force_N": 0, "limits.speed_mps": 1})  # this slider's pressures know nothing of its valve
        devices = PythonDevices(make_vcan("vcan0"), period_s)
        try:
            run, said = finished(controller("vcan0", 5, "--record", "/tmp/peer.csv.gz", "--force", *sets))
        finally:
            devices.close()
        self.assertEqual(run["faults"], [], said)
        self.assertRegex(said, r"\d+ samples, 0 missed, 0 late, 0 out of limits, 0 malformed, 0 error frames, 0 outputs not sent")
        figures["python_devices"] = {"ticks": run["ticks"], "overruns": run["overruns"]}
        stored = devices.io.data_store
        self.assertEqual(stored[0x6443][1], b"\1")
        self.assertEqual(stored[0x6444][1], b"\0\0\0\0")
        self.assertEqual(stored[0x1029][1], b"\0")
        self.assertEqual(int.from_bytes(stored[0x1016][1], "little"), US << 16 | 500)
        self.assertEqual(int.from_bytes(stored[0x1803 - 2][3], "little"), 0)   # no inhibit time
        self.assertEqual(devices.u_V, 0.0)  # the safe output was the last one
        positions = [row["x_m"] for row in rows_of("/tmp/peer.csv.gz")[1] if row["x_m"] is not None]
        self.assertGreater(max(positions) - min(positions), 0.002)
