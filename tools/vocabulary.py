# The vocabulary of effects as `pneuservo effects` tells it.
"""Each effect by its name, in the order of the vocabulary: words, element, smallest sizes, signature and what else stands in
the program's JSON. With a rig the sizes are in its numbers."""
import functools
import json
import pathlib
import subprocess
import tempfile

import yaml



@functools.lru_cache(maxsize=64)
def told(program, rig_text):
    """Effects by name; of the rig whose config this is, or of all rigs for an empty text."""
    with tempfile.TemporaryDirectory() as folder:
        config = pathlib.Path(folder) / "rig.yaml"
        config.write_text(rig_text, encoding="utf-8")
        done = subprocess.run([program, "effects", *([config] if rig_text else []), "--json", "-"], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise RuntimeError(f"{program} effects: {done.stderr.strip()}")
    return {one["name"]: one for one in json.loads(done.stdout)["effects"]}


def effects(program, rig=None):
    return told(str(program), yaml.safe_dump(rig, sort_keys=False) if rig else "")


def with_sizes(known):
    """Names that trial machines have, in the order of the vocabulary."""
    return [name for name, one in known.items() if one["smallest"]]


def sized(effect, rung, largest_mass_kg):
    """Parameters of an effect at a rung: each twice as far from its neutral value as a rung before, an opening so much narrower that
    its resistance is twice as large, a mass no larger than it can be."""
    out = {}
    for key, size in effect["smallest"].items():
        value, neutral = size["value"], size["neutral"]
        if size["growth"] == "twice":
            value = neutral + (value - neutral) * 2**rung
        elif size["growth"] == "narrower":
            value /= 2 ** (rung / 2)
        out[key] = min(value, largest_mass_kg) if size["scale"] == "moving_mass" else value
    return out


def drawn(rng, recipe):
    """Numbers of a recipe of tools/trials: a number, or a range to draw from evenly."""
    return {key: rng.uniform(*value) if isinstance(value, list) else value for key, value in recipe.items()}
