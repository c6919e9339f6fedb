#!/usr/bin/env python3
# The example of docs/your-recording.md, by the tool that makes it; at full length with its verdict.
# tags: long
import json
import os
import pathlib
import subprocess
import sys
import tempfile

from program import expect, program

is_long = os.environ.get("PNEUSERVO_LONG") == "1"
with tempfile.TemporaryDirectory() as name:
    folder = pathlib.Path(name)
    done = subprocess.run([sys.executable, "tools/your-recording-figures", folder, "--program", program,
                           "--verdict" if is_long else "--no-verdict"], capture_output=True, text=True, check=False)
    expect(done.returncode == 0, f"status {done.returncode}: {done.stderr}")
    section = (folder / "mine.yaml").read_text(encoding="utf-8")
    for line in ('x_m: {column: "Istposition [mm]", factor: 0.001, offset: -0.15}', 'u_V: {column: "Ventil [V]", offset: -5}',
                 'p1_port_Pa: {column: "Druck A [bar rel]", factor: 100000, offset: 101325}'):
        expect(line in section, f"mine.yaml does not state {line}: {section[section.find('import:'):]}")
    expect((folder / "your-recording-import.svg").read_text(encoding="utf-8").count('class="curve"') >= 4, "no picture of the channels")
    if is_long:
        answer = json.loads((folder / "diagnosis.json").read_text(encoding="utf-8"))
        expect([one["effect"] for one in answer["answers"]] == ["valve_dead_band"], answer["sentence"])
        width = answer["answers"][0]["parameters"]["width_V"]
        expect(abs(width["value"] - 0.08) <= 3 * width["standard_error"] + 1e-4, f"another width: {width}")  # 0.1 mV is the log's last digit
page = pathlib.Path("docs/your-recording.md").read_text(encoding="utf-8")
for word in ("Zeit [ms]", "Istposition [mm]", "Druck A [bar rel]", "figures/your-recording-import.svg",
             "figures/your-recording-verdict.svg"):
    expect(word in page, f"docs/your-recording.md does not show {word}")
