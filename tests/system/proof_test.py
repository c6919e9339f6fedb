#!/usr/bin/env python3
# The independent machine: its folder compiles alone, it agrees with the program's plant, and tools/proof plays one machine end to end.
import gzip, hashlib, json, pathlib, shutil, subprocess, sys, tempfile

from program import expect, program, run

build = pathlib.Path(sys.argv[1])
machine = build / "tests/proof/machine/proof_machine"
folder = pathlib.Path(tempfile.mkdtemp())
alone = folder / "alone"
shutil.copytree("tests/proof/machine", alone)
for source in sorted(alone.glob("*.cpp")):
    done = subprocess.run(["c++", "-std=c++20", "-fsyntax-only", source], capture_output=True, text=True, timeout=300)
    expect(done.returncode == 0, f"{source.name} does not compile away from the repository: {done.stderr}")

# The nominal machine under its own loop, and the program's plant under the same command.
CONFIG = "config/cylinder-5m-6.10mm.yaml"
SCENARIO = """side_1.piston 1.257e-3
side_2.piston 1.056e-3
loop.position_gain 7550
loop.speed_gain 95.6
loop.force_gain 0.003
loop.at_chambers 1
move.wave 0.08 1 0
first 0
length 4
""" + "".join(f"tube_{s}.length 5\ntube_{s}.bore 0.0061\n" for s in (1, 2))
done = subprocess.run([machine], input=SCENARIO, capture_output=True, text=True, timeout=300)
expect(done.returncode == 0, f"the machine: {done.stderr}")
with gzip.open(folder / "machine.csv.gz", "wt") as file:
    file.write("# format: pneuservo-recording/1\n# rig: cylinder-5m-6.10mm\n# period_s: 0.001\n" + done.stdout)
done = run("simulate", CONFIG, "--set", "simulation.cells_per_m=16", "--command", str(folder / "machine.csv.gz"), "--json", "-")
expect(done.returncode == 0, f"simulate: {done.stderr}")
difference = json.loads(done.stdout)["difference"]
for channel, most in (("p1_port_Pa", 60), ("p2_port_Pa", 60), ("p1_chamber_Pa", 20), ("p2_chamber_Pa", 20), ("x_m", 2e-6)):
    expect(difference[channel]["rms"] <= most, f"machine and plant differ by {difference[channel]['rms']} rms in {channel}, at most {most}")


def proof(out, *arguments):
    return subprocess.run(["tools/proof", folder / out, "--program", program, "--machine", machine, "--seed", "2", "--length-s", "2.5", "--background", "no", *arguments],
                          capture_output=True, text=True, timeout=1000)


# A drawn machine depends on seed and number alone; only the salt of the seal is new.
for out in ("a", "b"):
    done = proof(out, "--count", "1", "--kind", "single", "--draw-only")
    expect(done.returncode == 0, f"draw: {done.stdout}{done.stderr}")
for name in ("rig.yaml", "recording-1.csv.gz"):
    one, other = ((gzip.decompress if name.endswith("gz") else bytes)((folder / out / "case-000" / name).read_bytes()) for out in ("a", "b"))
    expect(one == other, f"{name} of two draws differs")
hidden = json.loads((folder / "a/sealed/case-000.json").read_text())
expect(len(hidden["effects"]) == 1 and next(iter(hidden["effects"])) not in (folder / "a/case-000/rig.yaml").read_text(),
       "the secret stands in what the owner has")

# End to end; the page, the order of the hashes, and a truth that was changed after its seal.
done = proof("whole", "--count", "1", "--kind", "mounting")
expect(done.returncode == 0, f"proof: {done.stdout}{done.stderr}")
lines = (folder / "whole/commitments.txt").read_text().splitlines()
expect([line.split()[1] for line in lines] == ["case-000", "case-000.json"], f"order of the hashes: {lines}")
for line in lines:
    digest, name = line.split()
    file = folder / "whole" / (name if name.endswith(".json") else f"sealed/{name}.json")
    expect(hashlib.sha256(file.read_bytes()).hexdigest() == digest, f"hash of {file}")
told = json.loads((folder / "whole/proof.json").read_text())
expect(told["rates"]["mounting fault: told, no false name"]["of"] == 1, f"rates: {told['rates']}")
expect((folder / "whole/proof.html").read_text().count("<svg") >= 2, "the page has no pictures")
truth = folder / "whole/sealed/case-000.json"
truth.write_text(truth.read_text().replace("mounting", "mountinG", 1))
done = proof("whole", "--count", "1", "--kind", "mounting")
expect(done.returncode == 1 and "case-000: the truth is not the one that was sealed" in done.stdout, f"a changed truth: {done.stdout}")
done = proof("none", "--machine", folder / "nothing")
expect(done.returncode == 2 and "not found" in done.stderr, f"no machine: {done.stderr}")

# The sealed sets of the repository: answers and truths are those whose hashes stand there, and their page tells the scores.
for sealed in sorted(pathlib.Path("tests/proof/sealed").iterdir()):
    kept = folder / sealed.name
    shutil.copytree(sealed, kept)
    commitments = [line.split() for line in (kept / "commitments.txt").read_text().splitlines()]
    machines = sum(not name.endswith(".json") for _, name in commitments)
    done = subprocess.run(["tools/proof", kept, "--seed", sealed.name, "--count", str(machines), "--score-only", "--baselines"], capture_output=True, text=True, timeout=300)
    is_whole = len(commitments) == 2 * machines  # of the first set one machine has no answer
    expect(done.returncode == (0 if is_whole else 1) and "is not the one" not in done.stdout, f"{sealed}: {done.stdout[-400:]}{done.stderr}")
    for digest, name in commitments:
        file = kept / (name if name.endswith(".json") else f"sealed/{name}.json")
        expect(hashlib.sha256(file.read_bytes()).hexdigest() == digest, f"hash of {file}")
    expect((kept / "proof.md").read_text() in pathlib.Path("docs/proof-sealed.md").read_text(), f"docs/proof-sealed.md is not what tools/proof writes of {sealed}")
