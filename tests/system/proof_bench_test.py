#!/usr/bin/env python3
# tools/proof-bench on answers made up from its own plan: slopes and placebos are found, a changed plan and a missing answer too.
import json, pathlib, subprocess, tempfile

from program import expect

out = pathlib.Path(tempfile.mkdtemp()) / "bench"


def bench(what):
    return subprocess.run(["tools/proof-bench", what, out, "--seed", "4"], capture_output=True, text=True, timeout=60)


expect(bench("score").returncode == 2, "a score without a plan")
expect(bench("plan").returncode == 0, "a plan")
expect(bench("plan").returncode == 2, "a plan over a plan")
runs = json.loads((out / "plan.json").read_text())["runs"]
orders = (out / "operator.txt").read_text().splitlines()
expect(len(orders) == len(runs) == 56 and sum(run["name"] is None for run in runs) == 28, "28 doses and 28 placebos")
for k, run in enumerate(runs, 1):
    answer = {"verdict": "consistent", "answers": []}
    if run["name"]:  # ten percent too large throughout
        answer = {"verdict": "missing_physics", "answers": [{"effect": run["name"], "parameters": {run["parameter"]: {"value": 1.1 * run["set"]}}}]}
    (out / f"run-{k:02d}.json").write_text(json.dumps(answer))
done = bench("score")
expect(done.returncode == 0 and "28 of 28" in done.stdout, f"score: {done.stdout}{done.stderr}")
expect(done.stdout.count("named first 4 of 4; found = 1.100 x set, R2 1.000") == 6 + 1, f"slopes: {done.stdout}")
(out / "run-07.json").rename(out / "away.json")
done = bench("score")
expect(done.returncode == 1 and "run 7" in done.stdout, f"a missing answer: {done.stdout}")
(out / "plan.json").write_text((out / "plan.json").read_text().replace("runs", "runs ", 1))
done = bench("score")
expect(done.returncode == 1 and "not the one that was sealed" in done.stdout, f"a changed plan: {done.stdout}")
