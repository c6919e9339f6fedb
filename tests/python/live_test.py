# The live client against `pneuservo serve` on the simulated axis, and against what is no axis.
import os
import signal
import socket
import subprocess
import tempfile
import threading
import time

import pytest

from conftest import SOURCE
from pneuservo import AxisRefused
from pneuservo.live import Axis

PROGRAM = os.environ.get("PNEUSERVO_PROGRAM", "")


@pytest.fixture
def served():
    """The path of a served axis' socket; short, for a socket's path has some 100 bytes at most."""
    if not os.path.exists(PROGRAM):
        pytest.skip("PNEUSERVO_PROGRAM names no program")
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "axis.sock")
        process = subprocess.Popen([PROGRAM, "serve", str(SOURCE / "config/served/cylinder-10m-7.65mm.yaml"), "--time", "simulated", "--socket", path],
                                   stderr=subprocess.DEVNULL)
        try:
            while not os.path.exists(path):
                assert process.poll() is None, "serve ended"
                time.sleep(0.02)
            yield path
        finally:
            process.send_signal(signal.SIGTERM)
            process.wait(timeout=60)


def test_an_axis_is_enabled_moved_and_watched(served):
    with Axis(served, timeout_s=30) as axis:
        with pytest.raises(AxisRefused, match="enable"):
            axis.move_to(0.05)
        axis.enable()
        for _ in range(200):  # until the axis is active
            try:
                answer = axis.move_to(0.05)
                break
            except AxisRefused:
                time.sleep(0.02)
        assert answer["target_m"] == 0.05 and answer["ends_s"] > answer["t_s"]
        with pytest.raises(AxisRefused, match="position_m: found 0.5, expected -0.12 to 0.12"):
            axis.move_to(0.5)
        assert "status" in axis.status()
        with Axis(served, timeout_s=30) as other, pytest.raises(AxisRefused):
            other.move_to(0.0)
        axis.disable()


def test_nobody_there_is_said(tmp_path):
    with pytest.raises(ConnectionError, match="found no axis there"):
        Axis(tmp_path / "nowhere.sock")


def test_an_end_in_the_midst_is_said():
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "s")
        with socket.socket(socket.AF_UNIX) as listening:
            listening.bind(path)
            listening.listen()

            def answer_half():
                connection, _ = listening.accept()
                connection.recv(4096)
                connection.sendall(b'{"id": 1')
                connection.close()

            thread = threading.Thread(target=answer_half)
            thread.start()
            axis = Axis(path, timeout_s=30)
            with pytest.raises(ConnectionError, match="ended the connection"):
                axis.stop()
            axis.close()
            thread.join()


def test_a_late_answer_is_left_and_junk_is_no_answer(tmp_path):
    """After a time-out the next request gets its own answer; what is no object of JSON ends in a sentence."""
    path = os.path.join(tempfile.mkdtemp(dir="/tmp"), "axis.sock")
    listening = socket.socket(socket.AF_UNIX)
    listening.bind(path)
    listening.listen(1)
    asked = threading.Event()

    def late():
        connection, _ = listening.accept()
        lines = connection.makefile("rb")
        lines.readline()
        asked.wait(10)
        lines.readline()
        connection.sendall(b'{"id": 1, "ok": true}\n{"id": 2, "ok": true, "state": "active"}\n')
        lines.readline()
        connection.sendall(b"[1]\n")
        lines.readline()
        connection.close()

    thread = threading.Thread(target=late)
    thread.start()
    axis = Axis(path, timeout_s=0.05)
    with pytest.raises(TimeoutError, match="no answer came"):
        axis.status()
    asked.set()
    axis._socket.settimeout(10)
    assert axis.status()["state"] == "active"
    with pytest.raises(ConnectionError, match="expected an answer"):
        axis.status()
    with pytest.raises(ConnectionError, match="ended the connection"):
        axis.status()
    axis.close()
    thread.join()
    listening.close()


def test_numbers_of_numpy_are_sent_as_numbers():
    import json

    import numpy

    with tempfile.TemporaryDirectory() as folder, socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as listening:
        listening.bind(os.path.join(folder, "axis.sock"))
        listening.listen()
        axis = Axis(os.path.join(folder, "axis.sock"))
        served, _ = listening.accept()
        with served:
            served.sendall(b'{"id": 1, "ok": true}\n')
            axis.move_to(numpy.float32(0.125), speed_mps=numpy.int64(1))
            assert json.loads(served.recv(4096))["position_m"] == 0.125
            with pytest.raises(TypeError, match="found set in a request, expected numbers and text"):
                axis.move_to({1})
        axis.close()
