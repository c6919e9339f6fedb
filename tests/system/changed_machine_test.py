#!/usr/bin/env python3
# Verb diagnose with --changed: what it refuses, and a recording at another supply pressure that is consistent when told.
import json, pathlib, tempfile

from program import CONFIG, expect, expect_refusal, run

folder = pathlib.Path(tempfile.mkdtemp())
first, second, other = (folder / name for name in ("first.csv.gz", "second.csv.gz", "other/second.csv.gz"))
other.parent.mkdir()
for path, seed, more in ((first, 1, []), (second, 2, ["--set", "supply.pressure_Pa=500e3", "--set", "initial.pressure_1_Pa=330e3"])):
    done = run("run", CONFIG, "--duration-s", "4", "--set", f"seed={seed}", *more, "--record", str(path))
    expect(done.returncode == 0, f"recording: {done.stderr}")
other.write_bytes(second.read_bytes())


def diagnose(*arguments):
    return run("diagnose", CONFIG, str(first), str(second), "--quiet", "--json", "-", *arguments)


for stated, words in (("third.csv.gz:supply.pressure_Pa=5e5", ["no recording of that name", "first.csv.gz"]),
                      ("second.csv.gz:supply.pressure_Pa", ["no value", "RECORDING:PATH=VALUE"]),
                      ("second.csv.gz:supply.pressure_Pa=5 bar", ["found '5 bar'", "a number"]),
                      ("second.csv.gz:supply.presure_Pa=5e5", ["second.csv.gz", "supply.pressure_Pa"]),
                      ("second.csv.gz:supply.pressure_Pa=-1", ["second.csv.gz", "supply.pressure_Pa", "-1"]),
                      ("second.csv.gz:controller.position_gain_N_per_m=1", ["a number of air, supply"])):
    expect_refusal(diagnose("--changed", stated), words, stated)
expect_refusal(diagnose(str(other), "--changed", "second.csv.gz:supply.pressure_Pa=5e5"),
               ["several recordings of that name"], "two of one name")

told = diagnose("--changed", f"{second}:supply.pressure_Pa=500e3")
expect(told.returncode == 0, f"told: {told.stderr}")
answer = json.loads(told.stdout)
expect(answer["verdict"] == "consistent", f"told: {answer['verdict']} {answer['answers']}")
said = [w for w in answer["data"]["warnings"] if "second.csv.gz: made with supply.pressure_Pa = 500000 instead of" in w]
expect(len(said) == 1, f"the change is not repeated: {answer['data']['warnings']}")
untold = json.loads(diagnose().stdout)
expect(untold["verdict"] != "consistent", "a supply that was 200 kPa lower went unseen")
