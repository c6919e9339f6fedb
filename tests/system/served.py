# A rig that is served in simulated time, and a client of it; for the tests of serve.
import atexit, glob, json, os, signal, socket, subprocess, sys, tempfile, time

from program import expect, program, run

folder = tempfile.TemporaryDirectory()


def at(name):
    return os.path.join(folder.name, name)


class Served:
    """`serve` in simulated time, as fast as it goes."""

    def __init__(self, config, name, *options, **environment):
        self.socket, self.records, self.log = at(name + ".sock"), at(name), at(name + ".log")
        self.process = subprocess.Popen([program, "serve", config, "--time", "simulated", "--socket", self.socket, "--record", self.records, *options],
                                        stderr=open(self.log, "w"), env={**os.environ, **environment})
        atexit.register(self.process.kill)  # of a test that fails, too
        for _ in range(400):
            if os.path.exists(self.socket) and self.process.poll() is None:
                return
            time.sleep(0.05)
        sys.exit(f"serve did not start: {open(self.log).read()}")

    def command(self, *words):
        return run("command", *words, "--socket", self.socket)

    def status(self):
        return json.loads(self.command("status", "--json").stdout)

    def until(self, holds, what):
        for _ in range(400):
            status = self.status()
            if holds(status):
                return status
            time.sleep(0.02)
        sys.exit(f"{what} did not come: {status}")

    def end(self):
        self.process.send_signal(signal.SIGTERM)
        status = self.process.wait(timeout=30)
        return status, open(self.log).read()

    def parts(self):
        return sorted(glob.glob(self.records + "/*.csv.gz") + glob.glob(self.records + "/kept/*.csv.gz"), key=os.path.basename)


class Client:
    def __init__(self, path):
        self.socket = socket.socket(socket.AF_UNIX)
        self.socket.settimeout(10)
        self.socket.connect(path)
        self.lines = self.socket.makefile("rb")

    def send(self, data):
        self.socket.sendall(data if isinstance(data, bytes) else (json.dumps({"version": 1, **data}) + "\n").encode())

    def answer(self):
        return json.loads(self.lines.readline())

    def ask(self, data):
        self.send(data)
        return self.answer()

    def close(self):
        self.lines.close()
        self.socket.close()


def refused(answer, *words):
    expect(answer["ok"] is False and all(word in answer["error"] for word in words), f"not refused with {words}: {answer}")
