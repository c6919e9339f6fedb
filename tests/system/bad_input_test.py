#!/usr/bin/env python3
# Unusable input to the verbs: exit status 2 and one sentence that names file, line and key, before anything is run.
import gzip, os, resource, sys, tempfile

from program import CONFIG, edited_config, expect, expect_refusal, run

folder = tempfile.mkdtemp()

# Configs: file, line, key.
for what, pattern, replacement, words in [
        ("a typo", r"velocity_gain_Ns_per_m:", "velocity_gian_Ns_per_m:", ["velocity_gian_Ns_per_m", "velocity_gain_Ns_per_m"]),
        ("a wrong unit", r"mass_kg: 2.0", "mass_g: 2000", ["mass_g", "mass_kg"]),
        ("text for a number", r"pressure_Pa: 700000", "pressure_Pa: 7 bar", ["supply.pressure_Pa", "7 bar"]),
        ("an impossible value", r"stroke_m: 0.300", "stroke_m: -0.3", ["cylinder.stroke_m", "-0.3"]),
        ("nan", r"position_gain_N_per_m: 7550", "position_gain_N_per_m: .nan", ["controller.position_gain_N_per_m", "nan"]),
        ("a missing key", r"^  stroke_m: 0.300\n", "", ["cylinder", "stroke_m"]),
        ("a key twice", r"^period_s: 0.001", "period_s: 0.001\nperiod_s: 0.002", ["period_s"]),
        ("reference out of stroke", r"amplitude_m: 0.080", "amplitude_m: 0.180", ["reference", "stroke_m"]),
        ("an unknown reference", r"kind: sine", "kind: sinus", ["sinus", "sine"])]:
    path, line = edited_config(folder, pattern, replacement)
    for verb in (["run", path], ["check", path], ["replay", path, "none.csv.gz"], ["latency", path]):
        done = run(*verb)
        expect_refusal(done, [path] + words, f"{verb[0]}, {what}")
    named = {int(part) for part in done.stderr.replace(":", " ").replace(",", " ").split() if part.isdigit()}
    expect(named & {line, line + 1} or what == "a missing key", f"{what}: line {line} is not named: {done.stderr}")

expect_refusal(run("run", "none.yaml"), ["none.yaml"], "no such config")
expect_refusal(run("run", CONFIG, "--set", "slider.mass=2"), ["--set", "slider.mass", "mass_kg"], "--set of an unknown key")
expect_refusal(run("run", CONFIG, "--set", "slider.mass_kg=heavy"), ["--set", "slider.mass_kg", "heavy"], "--set of text")
expect_refusal(run("run", CONFIG, "--set", "nonsense"), ["--set", "nonsense"], "--set without a value")
expect_refusal(run("run", CONFIG, "--fault", "obstacle:-0.02"), ["--fault", "obstacle", "-0.02", "above 0"], "an obstacle that cannot be")
expect_refusal(run("run", CONFIG, "--fault", "leak:1:-1e-6"), ["--fault", "leak", "-1e-06", "above 0"], "a leak of less than nothing")
expect_refusal(run("run", CONFIG, "--hal", "nonsense"), ["--hal", "nonsense", "sim"], "an unknown backend")
expect_refusal(run("run", CONFIG, "--moves", "0"), ["--moves", "0"], "no moves")
expect(run("run", CONFIG, "--time", "sometimes").returncode == 2, "--time of nonsense is accepted")
expect(run("run", CONFIG, "--pressure-source", "guess").returncode == 2, "--pressure-source of nonsense is accepted")
expect(run("nonsense").returncode == 2, "an unknown verb is accepted")

# Inputs that never end are told from files, in the memory of any other run.
limit = lambda: resource.setrlimit(resource.RLIMIT_AS, (1 << 30, 1 << 30))
for verb in (["check", "/dev/zero"], ["run", CONFIG, "--zeros", "/dev/zero"], ["run", CONFIG, "--scenario", "/dev/zero"],
             ["replay", CONFIG, "/dev/zero"], ["simulate", CONFIG, "--command", "/dev/zero"], ["import", "/dev/zero"]):
    expect_refusal(run(*verb, preexec_fn=limit), ["/dev/zero", "67108864 bytes"], f"{verb[0]} of what never ends")

# Results that could not be kept are refused before the run, which would take hours here.
long = ["--set", "duration_s=100000"]
for option in ("--record", "--report", "--json"):
    name = os.path.join(folder, "no", "such", "folder", "run.csv.gz")
    expect_refusal(run("run", CONFIG, *long, option, name), [option, name], f"{option} into no folder")
    expect_refusal(run("run", CONFIG, *long, option, folder + "/"), [option], f"{option} onto a folder")
expect_refusal(run("run", CONFIG, *long, "--record", folder + "/run.csv"), ["--record", ".csv.gz"], "a recording by another name")
expect(sorted(os.listdir(folder)) == ["edited.yaml"], f"refused runs left files behind: {os.listdir(folder)}")

# No arguments: help to learn from.
done = run()
expect(done.returncode == 2 and "pneuservo run config/" in done.stdout and "latency" in done.stdout, "no arguments: no help")
for verb in ("run", "check", "latency", "replay", "simulate", "index"):
    done = run(verb, "--help")
    expect(done.returncode == 0 and "Usage" in done.stdout, f"{verb} --help: status {done.returncode}")

# Recordings.
good = os.path.join(folder, "good.csv.gz")
expect(run("run", CONFIG, "--duration-s", "0.5", "--record", good).returncode == 0, "a short run fails")
with gzip.open(good, "rt") as file:
    lines = file.read().splitlines()
first = next(i for i, line in enumerate(lines) if not line.startswith("#"))
names = lines[first].split(",")


def recording(name, edit):
    path = os.path.join(folder, name + ".csv.gz")
    with gzip.open(path, "wt") as file:
        file.write("\n".join(edit(list(lines))) + "\n")
    return path


def without(column):
    def edit(all_lines):
        at = names.index(column)
        return all_lines[:first] + [",".join(f for i, f in enumerate(line.split(",")) if i != at) for line in all_lines[first:]]
    return edit


def with_nan(all_lines):
    fields = all_lines[first + 100].split(",")
    fields[names.index("p1_port_Pa")] = "nan"
    fields[names.index("u_V")] = "nan"
    all_lines[first + 100] = ",".join(fields)
    return all_lines


both = lambda path: (("replay", CONFIG, path), ("simulate", CONFIG, "--command", path))
# Still of use: said with file and line, the rest is used.
for name, edit, words in [("gap", lambda l: l[:first + 100] + l[first + 103:], ["line %d" % (first + 101), "3 rows are missing"]),
                          ("nan", with_nan, ["line %d" % (first + 101), "nan"]),
                          ("repeated", lambda l: l[:first + 100] + [l[first + 99]] + l[first + 100:], ["line %d" % (first + 101), "again"])]:
    path = recording(name, edit)
    for verb in both(path):
        done = run(*verb)
        expect(all(word in done.stderr for word in [path] + words), f"{verb[0]} of a recording with {name}: {done.stderr}")
        expect(done.returncode == (0 if verb[0] == "simulate" or name == "repeated" else 1), f"{verb[0]}, {name}: status {done.returncode}")
cut = os.path.join(folder, "cut.csv.gz")
with open(good, "rb") as source, open(cut, "wb") as target:
    data = source.read()
    target.write(data[:len(data) * 2 // 3])
for verb in both(cut):
    done = run(*verb)
    expect(done.returncode == 0 and "cut off" in done.stderr and cut in done.stderr, f"{verb[0]} of a truncated gzip: {done.returncode} {done.stderr}")
expect("bit for bit as recorded" in run("replay", CONFIG, cut).stdout, "a truncated recording does not replay as far as it goes")
# Not of use.
for name, edit, words in [("no ports", without("p1_port_Pa"), ["p1_port_Pa", "missing"]),
                          ("no times", without("t_s"), ["t_s", "missing"]), ("empty", lambda l: l[:first + 1], ["row"])]:
    path = recording(name, edit)
    expect_refusal(run("replay", CONFIG, path), [path] + words, f"replay, {name}")
pressure = os.path.join(folder, "pressure.csv.gz")
expect(run("run", "config/pressure-3m-4mm.yaml", "--duration-s", "0.3", "--record", pressure).returncode == 0, "a pressure's run fails")
for verb in both(pressure):
    expect_refusal(run(*verb), [pressure, "pressure-3m-4mm", "kind pressure", "kind cylinder", CONFIG], f"{verb[0]} of another kind of rig")
path = recording("no command", without("u_V"))
expect_refusal(run("simulate", CONFIG, "--command", path), [path, "u_V", "missing"], "simulate, no command")
for key, value in (("moves", "abc"), ("period_s", "[1, 2]")):
    path = recording("header", lambda l: [f"# {key}: {value}" if line.startswith(f"# {key}: ") else line for line in l])
    done = run("replay", CONFIG, path)
    expect(done.returncode == 2 and f"{path}: header: {key}: found" in done.stderr,
           f"replay, {key} of another type: {done.returncode} {done.stderr}")
path = recording("period", lambda l: [line.replace("# period_s: 0.001", "# period_s: 0.002") for line in l])
done = run("replay", CONFIG, path)
expect(done.returncode == 2 and "period_s" in done.stderr, f"replay of another period: {done.returncode} {done.stderr}")
plain = os.path.join(folder, "plain.csv.gz")
with open(plain, "w") as file:
    file.write("\n".join(lines))
expect_refusal(run("replay", CONFIG, plain), [plain], "replay of what is no gzip")
expect_refusal(run("replay", CONFIG, folder + "/none.csv.gz"), ["none.csv.gz"], "replay of no file")
expect_refusal(run("replay", CONFIG, good, "--record", folder + "/no/x.csv.gz"), ["--record"], "replay --record into no folder")
