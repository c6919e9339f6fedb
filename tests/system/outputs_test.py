#!/usr/bin/env python3
# What the program may write over and what never: recordings, inputs, files of another kind, sockets; files that block or
# never end; long runs in bounded memory; gaps in a recorded command; keys with control characters.
import gzip, json, os, resource, shutil, signal, subprocess, sys, tempfile, time

from program import CONFIG, catches, edited_config, expect, expect_refusal, program, run, wait_until

TABLE = "config/servo-table-1m-8mm.yaml"
folder = tempfile.mkdtemp()
at = lambda name: os.path.join(folder, name)
content = lambda path: open(path, "rb").read()
short = ["--duration-s", "0.3"]

# A recording is never overwritten, unless that is said.
first = at("first.csv.gz")
expect(run("run", CONFIG, *short, "--record", first).returncode == 0, "a short run fails")
kept = content(first)
for verb in (["run", CONFIG, *short], ["replay", CONFIG, first], ["simulate", CONFIG, "--command", first]):
    refused = run(*verb, "--record", first)
    expect_refusal(refused, ["--record", first], f"{verb[0]} over a recording")
    other = at("other.csv.gz")
    shutil.copy(first, other)
    expect_refusal(run(*verb, "--record", other), [other, "--force"], f"{verb[0]} over another recording")
    expect(run(*verb, "--record", other, "--force").returncode in (0, 1), f"{verb[0]} --force")
    expect(content(other) != kept or verb[0] == "run", f"{verb[0]} --force wrote nothing")
for verb in (["replay", CONFIG, first], ["simulate", CONFIG, "--command", first]):
    expect_refusal(run(*verb, "--record", first, "--force"), ["--record", first, "reads"], f"{verb[0]} --force over its input")
expect_refusal(run("run", CONFIG, "--pressure-source", "all", *short, "--record", at("a.csv.gz"), "--json", at("a-valve.csv.gz")),
               ["--json", "a-valve.csv.gz", "--record"], "one file for two options")
expect(content(first) == kept, "the first recording changed")

# No output over an input, under any of its names; none over what is not an older result of its kind.
mine = at("mine.yaml")
shutil.copy(CONFIG, mine)
os.link(mine, at("hard.yaml"))
os.symlink(mine, at("soft.yaml"))
config = content(mine)
for name in ("mine.yaml", "hard.yaml", "soft.yaml", "../" + os.path.basename(folder) + "/mine.yaml"):
    for verb, option in (("run", "--json"), ("run", "--report"), ("design", "--write"), ("design", "--json"), ("index", "--report"),
                         ("check", "--json"), ("latency", "--json")):
        expect_refusal(run(verb, mine, option, at(name)), [option, "reads", mine], f"{verb} {option} over {name}")
for option in ("--improved", "--json", "--report", "--next-experiment"):
    expect_refusal(run("diagnose", mine, first, option, first), [option, first, "reads"], f"diagnose {option} over the recording")
    expect_refusal(run("diagnose", mine, first, option, mine), [option, mine, "reads"], f"diagnose {option} over the config")
shutil.copy(CONFIG, at("yours.yaml"))
for verb, option in ((["run", mine, *short], "--json"), (["run", mine, *short], "--report"), (["design", mine], "--write")):
    expect_refusal(run(*verb, option, at("yours.yaml")), [option, "something else"], f"{option} over another's config")
expect_refusal(run("run", mine, *short, "--json", at("new.json"), "--report", at("./new.json")), ["--json", "writes"], "one new file for two options")
expect(content(mine) == config and content(at("yours.yaml")) == config, "a config changed")
for _ in range(2):  # an older result of its own kind may go
    done = run("run", mine, *short, "--json", at("r.json"), "--report", at("r.html"))
    expect(done.returncode == 0, f"results twice: {done.stderr}")
    expect(run("design", mine, "--write", at("designed.yaml")).returncode == 0, "design --write twice")
expect(run("run", mine, *short, "--json", "/dev/null").returncode == 0, "--json to a device")

# A result that did not arrive is none, and a stream that is closed at the start lends its number to no file.
for verb in (["run", CONFIG, *short], ["run", CONFIG, *short, "--json", "-"], ["design", CONFIG], ["keys"], ["run", "--help"]):
    with open("/dev/full", "w") as full:
        done = subprocess.run([program, *verb], stdout=full, stderr=subprocess.PIPE, text=True, timeout=300)
    expect(done.returncode == 1 and "standard output: found no way" in done.stderr,
           f"{verb} onto a full disk: {done.returncode} {done.stderr}")
with subprocess.Popen([program, "keys"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
    process.stdout.readline()
    process.stdout.close()  # as `head` does
    said = process.stderr.read()
expect(process.returncode == 0 and said == "", f"a reader that leaves: {process.returncode} {said}")
process = subprocess.Popen([program, "run", CONFIG, "--duration-s", "100000", "--record", at("closed.csv.gz")],
                           preexec_fn=lambda: [os.close(stream) for stream in (0, 1, 2)])
wait_until(lambda: os.path.exists(at("closed.csv.gz")) and catches(process, signal.SIGTERM), "a run without streams")
places = [os.readlink(f"/proc/{process.pid}/fd/{stream}") for stream in (0, 1, 2)]
process.terminate()
expect(process.wait(timeout=30) == 1 and places == 3 * ["/dev/null"], f"closed streams: {process.returncode} {places}")

# An older result stays until the new one is whole: here no file may become larger than a part of it.
small = lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (500, 500))
for verb, name in ((["design", mine, "--write"], "designed.yaml"), (["run", mine, *short, "--json"], "r.json"),
                   (["run", mine, *short, "--report"], "r.html")):
    older = content(at(name))
    done = run(*verb, at(name), preexec_fn=small)
    expect(done.returncode == 2 and name in done.stderr and "File too large" in done.stderr, f"{verb}: {done.returncode} {done.stderr}")
    expect(content(at(name)) == older and not [f for f in os.listdir(folder) if f.startswith(name + ".")], f"{verb} cost {name}")

# Owner, mode and further names of an older result stay.
os.chmod(at("designed.yaml"), 0o640)
os.link(at("r.json"), at("r-again.json"))
expect(run("design", mine, "--write", at("designed.yaml")).returncode == 0, "design --write over 0640")
expect(os.stat(at("designed.yaml")).st_mode & 0o777 == 0o640, "the mode of an older result is lost")
expect(run("run", mine, *short, "--json", at("r.json")).returncode == 0 and content(at("r.json")) == content(at("r-again.json")),
       "the other name of an older result holds another one")

for verb in (["replay", mine, first], ["simulate", mine, "--command", first]):
    done = run(*verb, "--record", at("large.csv.gz"), "--force", preexec_fn=small)
    expect(done.returncode == 2 and "large.csv.gz" in done.stderr and "File too large" in done.stderr, f"{verb}: {done.returncode} {done.stderr}")

# device takes away what is a socket and nothing else.
CAN = "config/can/cylinder-10m-7.65mm.yaml"
with open(at("data.txt"), "w") as file:
    file.write("data")
os.symlink(at("data.txt"), at("link"))
os.mkfifo(at("pipe"))
for name in ("data.txt", "link", "pipe"):
    done = run("device", CAN, "--can", "unix:" + at(name), "--duration-s", "0.1")
    expect(done.returncode == 1 and "something else than a socket" in done.stderr, f"device onto {name}: {done.returncode} {done.stderr}")
    expect(os.path.lexists(at(name)), f"device took {name} away")
expect(content(at("data.txt")) == b"data", "device wrote into a file")
process = subprocess.Popen([program, "device", CAN, "--can", "unix:" + at("bus")], stdin=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
process.stderr.readline()
process.kill()
process.wait()
expect(os.path.exists(at("bus")), "no socket was left behind")
process = subprocess.Popen([program, "device", CAN, "--can", "unix:" + at("bus")], stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                           stderr=subprocess.PIPE, text=True)
expect("are on the bus" in process.stderr.readline(), "device after a killed one")
process.terminate()
expect(process.wait(timeout=30) == 0 and not os.path.exists(at("bus")), "device leaves its socket behind")

# Gains from what blocks or never ends.
for name in (at("pipe"), "/dev/zero", folder):
    expect_refusal(run("run", TABLE, "--gains", name), [name, "no regular file"], f"--gains {name}")
with open(at("large.yaml"), "w") as file:
    file.truncate(1 << 33)
expect_refusal(run("run", TABLE, "--gains", at("large.yaml")), ["large.yaml", "bytes"], "--gains of 8 GB")

# Long runs start in the memory of short ones, or are refused.
limit = lambda: resource.setrlimit(resource.RLIMIT_AS, (1 << 30, 1 << 30))
for long in (["--duration-s", "86400"], ["--duration-s", "1e6"], ["--moves", "2000000000"]):
    process = subprocess.Popen([program, "run", CONFIG, "--time", "real", *long], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                               preexec_fn=limit, text=True)
    wait_until(lambda: catches(process, signal.SIGTERM), "a run that can be stopped")
    process.terminate()
    _, said = process.communicate(timeout=300)
    expect(process.returncode == 0 and "stopped by SIGTERM" in said, f"{long}: status {process.returncode}: {said}")
expect_refusal(run("run", "config/servo-table-0.5m-4mm.yaml", "--duration-s", "86400"), ["duration_s", "--moves"], "a plan of a day")
done = run("run", CONFIG, "--duration-s", "300", "--json", at("long.json"))
with open(at("long.json")) as file:
    shown = json.load(file)
expect(done.returncode == 0 and "shown from t = 37.856 s on" in done.stdout, f"what a long run shows is not told: {done.stdout}")
expect(shown["shown_from_s"] == 37.856 and shown["runs"][0]["ticks"] == 300000, f"what a long run shows: {shown['runs'][0]['ticks']}")

# A command with a gap that no axis waits through.
with gzip.open(first, "rt") as file:
    lines = file.read().splitlines()
damaged = at("damaged.csv.gz")
with gzip.open(damaged, "wt") as file:
    for number, line in enumerate(lines):
        late = number >= len(lines) - 3
        file.write((f"{float(line.split(',')[0]) + 8e6},{line.split(',', 1)[1]}" if late else line) + "\n")
expect_refusal_lines = run("simulate", CONFIG, "--command", damaged)
expect(expect_refusal_lines.returncode == 2 and f"line {len(lines) - 2}: " in expect_refusal_lines.stderr.splitlines()[-1]
       and "a gap of 8e+06 s" in expect_refusal_lines.stderr, f"a gap of 8e6 s: {expect_refusal_lines.stderr}")

# Control characters of keys and texts do not reach the terminal.
for key in ('"\\e[2Jkey": 1', '"a\\x9bb": 1', 'name: "\\e]0;title\\a"', '"\\u009b31mx": 1'):
    path, _ = edited_config(folder, r"^name: .*$", key)
    done = run("check", path)
    expect(done.returncode == 2 and len(done.stderr.splitlines()) == 1, f"{key}: {done.returncode} {done.stderr!r}")
    expect(not any(ord(c) < 32 or 126 < ord(c) < 160 for c in done.stderr.strip()), f"{key}: raw: {done.stderr!r}")

# The service starts nothing at boot, moves nothing by itself, and is watched.
with open("cmake/debian/pneuservo@.service") as file:
    unit = [line.strip() for line in file if not line.startswith("#")]
starts = [line for line in unit if line.startswith("ExecStart=")]
expect("[Install]" not in unit and "Restart=no" in unit, "the service may start by itself")
expect(starts == ["ExecStart=/usr/bin/pneuservo serve /etc/pneuservo/%i.yaml --record %S/pneuservo/%i"], f"the service: {starts}")
expect("Type=notify" in unit and any(line.startswith("WatchdogSec=") for line in unit), "the service is not watched")

# The guard's service watches the same config under the same account, and neither of the two is unknown to systemd.
with open("cmake/debian/pneuservo-guard@.service") as file:
    guard = [line.strip() for line in file if not line.startswith("#")]
expect("ExecStart=/usr/bin/pneuservo guard /etc/pneuservo/%i.yaml" in guard and "Before=pneuservo@%i.service" in guard, "the guard's service")
for key in ("User=", "Group=", "LimitRTPRIO=", "LimitMEMLOCK="):
    expect([line for line in guard if line.startswith(key)] == [line for line in unit if line.startswith(key)], f"the services differ in {key}")
expect(shutil.which("systemd-analyze"), "systemd-analyze is not installed, which judges the units; run tools/setup")
units = at("units")
os.mkdir(units)
for name in ("pneuservo", "pneuservo-guard"):
    with open(f"cmake/debian/{name}@.service") as file, open(f"{units}/{name}@.service", "w") as copy:
        copy.write(file.read().replace("/usr/bin/pneuservo", os.path.abspath(program)))
    done = subprocess.run(["systemd-analyze", "--man=no", "verify", f"{units}/{name}@axis.service"], capture_output=True, text=True)
    expect(done.returncode == 0 and not done.stderr.strip(), f"systemd-analyze verify {name}: {done.stderr}")

# A recording cut off by kill -9 is drawn up to the cut.
whole = content(first)
for share in (0.5, 0.8, 0.99):
    with open(at("cut.csv.gz"), "wb") as file:
        file.write(kept[:int(share * len(kept))])
    done = subprocess.run(["tools/plot-run", at("cut.csv.gz"), at("cut.svg")], capture_output=True, text=True)
    expect(done.returncode == 0 and "cut off" in done.stderr, f"plot-run of {share} of a recording: {done.stderr}")
