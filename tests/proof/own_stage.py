# Stage A: machines of the program's own simulator, as tools/diagnosis-trial draws them, sealed and scored alike.
import hashlib
import json
import secrets

import yaml

import trial_machines

KINDS = {"clean": "clean", "single": "effect", "pair": "pair", "parameter": "parameter", "sensor": "sensor", "outside": "outside"}
BLOCK = ["clean"] * 5 + ["single"] * 6 + ["pair"] * 2 + ["parameter"] * 2 + ["sensor"] + ["outside"] * 2


class Options:
    """What tools/diagnosis-trial's machines need to know."""

    def __init__(self, options, kind):
        self.program, self.out, self.seed, self.kind, self.effects = options.program, options.out, options.seed, kind, None
        self.rigs = sorted((options.program.parents[2] / "config").glob("cylinder-*.yaml"))


def make_case(number, options, _vocabulary_of):
    name = f"case-{number:03d}"
    folder, sealed = options.out / name, options.out / "sealed" / f"{name}.json"
    if sealed.is_file():
        return name
    sealed.parent.mkdir(exist_ok=True)
    kind = options.kind or BLOCK[number % len(BLOCK)]
    if not trial_machines.make_case(KINDS[kind], number, folder, Options(options, KINDS[kind])):
        raise RuntimeError(f"{name}: no draw of this machine runs without a fault")
    truth = yaml.safe_load((folder / "truth.yaml").read_text(encoding="utf-8"))
    (folder / "truth.yaml").unlink()
    element = truth.get("element", "none")
    truth |= {"kind": kind, "background": False, "fair": [], "visible": 0.0, "elements": [element], "near": [], "salt": secrets.token_hex(16),
              "times_smallest": 2.0 ** truth.get("rung", 0), "tolerances_off": truth.get("tolerances", 0.0)}
    if kind == "outside":
        truth |= {"outside": ", ".join(truth["effects"]) or "edges that follow a power", "effects": {}}
    text = json.dumps(truth, indent=1, sort_keys=True)
    with open(options.out / "commitments.txt", "a", encoding="utf-8") as file:
        file.write(f"{hashlib.sha256(text.encode()).hexdigest()}  {name}\n")
    sealed.write_text(text, encoding="utf-8")
    return name
