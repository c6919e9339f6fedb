#!/usr/bin/env python3
# Verb diagnose on a recording of 40 s: progress without a terminal, and what a stop in each phase leaves behind.
import json, pathlib, signal, subprocess, tempfile

from program import CONFIG, expect, program, run

folder = pathlib.Path(tempfile.mkdtemp())
recording = folder / "machine.csv.gz"
done = run("run", CONFIG, "--duration-s", "40", "--set", "effects.valve_dead_band.width_V=0.03", "--record", str(recording))
expect(done.returncode == 0, f"recording: {done.stderr}")


def stopped_at(phases, number):
    """What is left by a diagnosis that got the signal once it told one of these phases."""
    result, improved = folder / f"{number}.json", folder / f"{number}.yaml"
    process = subprocess.Popen([program, "diagnose", CONFIG, str(recording), "--jobs", "1",
                                "--json", str(result), "--improved", str(improved)],
                               stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    lines = []
    for line in process.stderr:
        lines.append(line)
        if any(phase in line for phase in phases):
            process.send_signal(number)
            break
    said, more = process.communicate(timeout=300)
    return process.returncode, said, "".join(lines) + more, result, improved


status, said, told, result, improved = stopped_at([""], signal.SIGINT)  # the first line, whatever it tells
expect(status == 128 + signal.SIGINT and "%, " in told, f"at the first line: status {status}: {told}")
if "stopped before anything was known" in told:
    expect(said == "" and not result.exists() and not improved.exists(), f"nothing was known, and this was written: {said}")

status, said, told, result, improved = stopped_at(["screening", "refits", "effects"], signal.SIGTERM)
expect(status == 128 + signal.SIGTERM, f"while it searches: status {status}: {told}")
expect(said.startswith("Stopped early"), f"while it searches: {said}")
found = json.loads(result.read_text())
expect(found["data"]["stopped"], "the JSON does not say that it was stopped")
coverage = found["data"]["coverage"]
compared_s = sum(span["to_s"] - span["from_s"] for span in coverage["spans"])
expect(abs(coverage["recorded_s"] - 40) < 0.1 and 20 < compared_s < 30.1, f"coverage: {coverage}")
expect("D-optimal" in coverage["choice"] and "D-optimal" in said, "how the spans were chosen is not told")
expect(improved.read_text().splitlines()[0].startswith("# Stopped early"), "the improved config's first line")
