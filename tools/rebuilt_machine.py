# Settings that make the simulated machine of a config the true one, for tools that run a machine under several configs.
"""The truth is a dictionary: `true_parameters` and `parameters` hold numbers by the config's paths, `effects` what the
machine has beside the nominal model."""
import json

import yaml

# Supervision of the motion: without a pass the config does not know the machine.
UNWATCHED = ["limits.deviation_m=0", "limits.speed_deviation_mps=0", "limits.stall_force_N=0", "limits.flow_mismatch_share=0",
             "limits.chamber_mismatch_Pa=0", "limits.speed_mps=20", "simulation.cells_per_m=4"]
NEUTRAL = {"gain": 1.0, "exhaust_ratio": 1.0}
# Further sizes of effects that have more than one.
MORE_SIZES = ("backward_N", "coulomb_force_N", "wide_open")


def value_at(config, path):
    node = config
    for key in path.split("."):
        node = node[key]
    return float(node)


def machine_sets(config, truth):
    """Settings that make the simulated machine of a config the true one, whatever the config believes."""
    real = dict(truth["true_parameters"]) | dict(truth.get("parameters") or {})
    deviations = {path: value / value_at(config, path) - 1 for path, value in real.items() if not path.startswith("effects.")}
    # What was found and is not there: its size is none, its shape is anything.
    concealed = {}
    for name, numbers in (config.get("effects") or {}).items():
        size = next(iter(numbers))
        concealed[name] = numbers | {size: NEUTRAL.get(size, 0.0)} | {key: 0.0 for key in MORE_SIZES if key in numbers}
    # The size of an effect that the owner knows is a number of the machine, too.
    for path, value in real.items():
        if path.startswith("effects."):
            _, name, size = path.split(".")
            concealed.setdefault(name, {})[size] = value
    concealed |= truth["effects"] or {}
    return [f"deviations={json.dumps(deviations)}", f"concealed={json.dumps(concealed)}"]


def drawn_truth(config, deviations):
    """What a machine is that differs from a config by relative deviations alone."""
    parameters = {path: value_at(config, path) * (1 + share) for path, share in deviations.items()}
    return {"true_parameters": parameters, "effects": {}}


def read(path):
    return yaml.safe_load(path.read_text(encoding="utf-8"))
