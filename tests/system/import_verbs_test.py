#!/usr/bin/env python3
# One file of another logger through every verb that reads recordings, with the section that import writes; and sensors that a config lacks.
import csv, gzip, json, os, re, subprocess, tempfile

from program import CONFIG, expect, run

folder = tempfile.mkdtemp()
path_of = lambda name: os.path.join(folder, name)


def read(name):
    with gzip.open(path_of(name), "rt") as file:
        return list(csv.DictReader(line for line in file if not line.startswith("#")))


def put(name, text):
    with open(path_of(name), "w") as file:
        file.write(text)
    return path_of(name)


# A builder's logger: from the retracted end in mm, 0 to 10 V, bar gauge, ms, decimal commas. It has no supply pressure, which a
# command pass takes as it is measured.
WITHOUT_SUPPLY = ("--set", "controller.flow_feedforward=off")
made = run("run", CONFIG, "--duration-s", "4", *WITHOUT_SUPPLY, "--record", path_of("machine.csv.gz"))
expect(made.returncode == 0, f"run: {made.stderr}")
rows = read("machine.csv.gz")
lines = ["Zeit [ms];Weg [mm];Ventil [V];p1 [bar];p2 [bar]"]
for row in rows:
    value = {name: float(row[name]) for name in ("t_s", "x_m", "u_V", "p1_port_Pa", "p2_port_Pa")}
    lines.append(f"{1e3 * value['t_s']:.3f};{1e3 * value['x_m'] + 150:.6f};{value['u_V'] + 5:.7f};"
                 f"{1e-5 * (value['p1_port_Pa'] - 101325):.7f};{1e-5 * (value['p2_port_Pa'] - 101325):.7f}".replace(".", ","))
log = put("log.csv", "\n".join(lines) + "\n")

# All three mistakes are seen together and written into the section; with it nothing is doubted any more.
mine = path_of("mine.yaml")
done = run("import", log, CONFIG, "--write", mine, "--json", "-")
expect(done.returncode == 0, f"import: {done.stderr}")
done_import = done
doubts = json.loads(done.stdout)["doubts"]
for word in ("retracted end", "gauge", "neutral in the middle"):
    expect(sum(word in line for line in doubts) == 1, f"import: {word} is not told once: {doubts}")
with open(mine) as file:
    section = file.read().split("import:")[1]
for words in ('x_m: {column: "Weg [mm]", factor: 0.001, offset: -0.15}', 'u_V: {column: "Ventil [V]", offset: -5}',
              'p2_port_Pa: {column: "p2 [bar]", factor: 100000, offset: 101325}'):
    expect(words in section, f"import --write: no {words} in {section}")
again = json.loads(run("import", log, mine, "--json", "-").stdout)
expect(again["doubts"] == [], f"import of what import wrote: {again['doubts']}")

# A section that a config has is replaced, a column that is missing is told, and simulate corrects what is certain.
bare = path_of("bare.yaml")
with open(mine) as file, open(bare, "w") as out:
    out.write(file.read().replace(", offset: -0.15", "").replace(", offset: 101325", "").replace(", offset: -5", ""))
mended = path_of("mended.yaml")
expect(run("import", log, bare, "--write", mended).returncode == 0, "import of a config with a section")
with open(mended) as file:
    text = file.read()
expect(text.count("import:") == 1 and text.split("import:")[1] == section, f"import --write of a config with a section: {text[-600:]}")
done = run("simulate", bare, "--command", log, "--json", "-")
expect(done.returncode == 0 and done.stderr.count("doubt: ") == 3, f"simulate: {done.stderr}")
expect(json.loads(done.stdout) == json.loads(run("simulate", mine, "--command", log, "--json", "-").stdout), "simulate on doubted channels")
one_port = put("one-port.csv", "\n".join(line.rpartition(";")[0] for line in lines) + "\n")
done = run("import", one_port, CONFIG)
expect("p2_port_Pa: found no column for it" in done.stdout, f"import without a port: {done.stdout}")

# replay runs estimator and controller on it: apart from the text's last digit, 1e-7 V, what the machine's own loop computed.
done = run("replay", mine, log, *WITHOUT_SUPPLY, "--record", path_of("replayed.csv.gz"), "--json", "-")
expect(done.returncode == 0, f"replay: {done.stderr}")
answer = json.loads(done.stdout)
expect(answer["compared_rows"] == len(rows) and answer["largest_difference"]["u_V"] < 0.6e-7, f"replay: {answer}")
worst = max(abs(float(a["p1_estimated_Pa"]) - float(b["p1_estimated_Pa"])) for a, b in zip(read("replayed.csv.gz")[1000:], rows[1000:]))
expect(worst < 1e-6, f"replay: the estimated pressure is {worst} Pa off")

# simulate runs the plant on its command. The difference is the ports' noise and quantum, 301 Pa, beside what a start from one
# sample of them leaves, at most as much again; of 4 000 rows a mean square is known to 1.1 %. In position that start is
# 300 Pa of 0.5 MPa over half the stroke, 0.1 mm a chamber, three standard deviations of both: 0.4 mm.
done = run("simulate", mine, "--command", log, "--json", "-")
expect(done.returncode == 0, f"simulate: {done.stderr}")
difference = json.loads(done.stdout)["difference"]
expect(difference["x_m"]["rms"] < 0.4e-3, f"simulate: {difference}")
expect(all(285 < difference[name]["rms"] < 425 for name in ("p1_port_Pa", "p2_port_Pa")), f"simulate: {difference}")
wrong = json.loads(run("simulate", mine, "--command", log, "--json", "-", "--set", "supply.pressure_Pa=600000").stdout)["difference"]
expect(wrong["p1_port_Pa"]["rms"] > 5 * difference["p1_port_Pa"]["rms"], f"simulate with another supply: {wrong}")

# diagnose agrees with itself: the machine is the config.
done = run("diagnose", mine, log, "--quiet", "--json", "-")
expect(done.returncode == 0 and json.loads(done.stdout)["verdict"] == "consistent", f"diagnose: {done.stdout[:300]}{done.stderr}")

# A pipe is read once, and says the same as the file.
cat = subprocess.Popen(["cat", log], stdout=subprocess.PIPE)
through = run("import", "/dev/stdin", CONFIG, "--json", "-", stdin=cat.stdout)
expect(cat.wait() == 0 and through.returncode == 0, f"import of a pipe: {through.stderr}")
expect(json.loads(through.stdout)["columns"] == json.loads(done_import.stdout)["columns"], f"import of a pipe: {through.stdout}")

# Without their sections chambers and supply have no sensor: no column, "absent" in the header, and the replay is exact.
with open(CONFIG) as file:
    text = file.read()
bare = put("bare.yaml", re.sub(r"^  (chamber|supply)_pressure:.*\n", "", text, flags=re.MULTILINE))
done = run("run", bare, "--duration-s", "1", "--record", path_of("bare.csv.gz"))
expect(done.returncode == 0, f"run without the sensors: {done.stderr}")
columns = read("bare.csv.gz")[0].keys()
expect(not {"p1_chamber_Pa", "p2_chamber_Pa", "p_supply_Pa"} & columns and "p1_port_Pa" in columns, f"run without the sensors: {columns}")
with gzip.open(path_of("bare.csv.gz"), "rt") as file:
    header = [line for line in file if line.startswith("# channels:")][0]
expect("p_supply: absent" in header and "p1_chamber: absent" in header and "p1_port: simulated" in header, header)
done = run("replay", bare, path_of("bare.csv.gz"))
expect(done.returncode == 0 and "bit for bit" in done.stdout, f"replay without the sensors: {done.stdout}{done.stderr}")
