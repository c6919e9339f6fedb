# Runs what the package's unit pneuservo@.service runs, as systemd would, where no systemd is; for tools/package-test.
"""usage: package_service.py UNIT INSTANCE FOLDER [COMMAND...]

As the user who is to serve: ExecStartPre, then ExecStart with a notify socket, in FOLDER for state and runtime. When the
unit says READY=1 the axis is enabled and moved by `pneuservo command`, COMMAND is run, WATCHDOG=1 is waited for, and
SIGTERM ends it. Status 1 with a sentence where something is not as the unit promises."""
import os
import pathlib
import re
import resource
import signal
import socket
import subprocess
import sys

PATIENCE_S = 60


def lines_of(unit, key, instance, folder):
    found = re.findall(rf"^{key}=(.+)$", unit, re.MULTILINE)
    return [line.replace("%i", instance).replace("%S", str(folder)).split() for line in found]


def ask(*words, socket_path):
    done = subprocess.run(["pneuservo", "command", *words, "--socket", socket_path], capture_output=True, text=True, timeout=PATIENCE_S, check=False)
    if done.returncode != 0:
        sys.exit(f"command {' '.join(words)}: status {done.returncode}: {done.stdout}{done.stderr}")
    return done.stdout.strip()


def until_said(manager, word):
    said = []
    while word not in (said[-1] if said else ""):
        try:
            said.append(manager.recv(4096).decode())
        except TimeoutError:
            sys.exit(f"the service did not say {word} within {PATIENCE_S} s: {said}")


def main():
    unit, instance, folder = pathlib.Path(sys.argv[1]).read_text(encoding="utf-8"), sys.argv[2], pathlib.Path(sys.argv[3])
    runtime = folder / "run"
    (folder / "pneuservo").mkdir(exist_ok=True)
    runtime.mkdir(exist_ok=True)
    for line in lines_of(unit, "ExecStartPre", instance, folder):
        judged = subprocess.run(line, check=False, stdout=subprocess.DEVNULL).returncode
        # Without the unit's limits, which not every machine lets root give, check rightly calls the machine bad.
        has_limits = resource.getrlimit(resource.RLIMIT_RTPRIO)[1] >= int(re.search(r"^LimitRTPRIO=(\d+)$", unit, re.MULTILINE)[1])
        if judged != 0 and (has_limits or judged != 1):
            sys.exit(f"{' '.join(line)}: status {judged}")
    manager = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
    manager.bind(str(folder / "notify"))
    manager.settimeout(PATIENCE_S)
    watchdog_us = 1_000_000 * int(re.search(r"^WatchdogSec=(\d+)$", unit, re.MULTILINE)[1])
    environment = {**os.environ, "NOTIFY_SOCKET": str(folder / "notify"), "WATCHDOG_USEC": str(watchdog_us), "RUNTIME_DIRECTORY": str(runtime)}
    [start] = lines_of(unit, "ExecStart", instance, folder)
    service = subprocess.Popen(start, env=environment, cwd=folder / "pneuservo")
    until_said(manager, "READY=1")
    path = str(runtime / f"{instance}.sock")
    print(ask("enable", socket_path=path))
    print(ask("move", "20 mm", "--wait", socket_path=path))
    print(ask("status", socket_path=path))
    print(ask("disable", socket_path=path))
    if len(sys.argv) > 4:
        subprocess.run(sys.argv[4:], check=True, timeout=PATIENCE_S)
    until_said(manager, "WATCHDOG=1")
    service.send_signal(signal.SIGTERM)
    until_said(manager, "STOPPING=1")
    if (status := service.wait(timeout=PATIENCE_S)) != 0:
        sys.exit(f"the service ended with status {status}")
    if not list((folder / "pneuservo" / instance).glob("*.csv.gz")):
        sys.exit("the service left no recording")


if __name__ == "__main__":
    main()
