# What a diagnosis says of an axis' health: friction, leak, valve, supply, as one row.
"""Sizes of wear from a diagnosis, each with its standard error, for a table over months."""
import math
from typing import Any, Dict, Mapping, Sequence

import numpy

from . import Config, Diagnosis, Recording, Refit, to_dict

# The effects whose keys add up to a size; then each size's unit.
FRICTION = {"coulomb_friction": ("force_N",), "direction_dependent_friction": ("forward_N", "backward_N")}
LEAKS = {"chamber_leak_1": ("area_m2",), "chamber_leak_2": ("area_m2",), "line_leak_1": ("area_m2",),
         "line_leak_2": ("area_m2",), "piston_leak": ("area_m2",)}
VALVE = {"valve_lag": ("time_constant_s",), "command_delay": ("delay_s",)}
REFITTED = ("coulomb_friction", "chamber_leak_1", "chamber_leak_2", "valve_lag")  # by a refit
SIZES = {"friction_N": "N", "leak_nlpm": "Nl/min", "valve_delay_s": "s", "supply_Pa": "Pa"}
NORMAL_DENSITY = 101325.0 / 273.15  # of DIN 1343, times the gas constant [kg/m3 J/kgK]


def leak_nlpm_of(area_m2: float, config: Config) -> float:
    """Normal litres (DIN 1343) a minute through a sonic hole from the supply's pressure."""
    gamma, R = config["air.heat_capacity_ratio"], config["air.gas_constant_J_per_kgK"]
    flow_constant = math.sqrt(gamma * (2.0 / (gamma + 1.0)) ** ((gamma + 1.0) / (gamma - 1.0)))
    flow_kgps = flow_constant * area_m2 * config["supply.pressure_Pa"] / math.sqrt(R * config["air.temperature_K"])
    return flow_kgps / (NORMAL_DENSITY / R) * 60e3


def _stated(config: Config, effects: Mapping[str, Sequence[str]]) -> float:
    """What the config has of these effects; of those with a key a direction the mean."""
    found = config.to_dict().get("effects") or {}
    return sum(sum(float(found[name][key]) for key in keys) / len(keys) for name, keys in effects.items() if name in found)


def _size(answer: Mapping[str, Any], improved: Config, effects: Mapping[str, Sequence[str]]) -> Dict[str, Any]:
    """What the improved config has of the effects; the standard error of what was named."""
    named = [(one["parameters"], effects[one["effect"]]) for one in answer["answers"] if one["effect"] in effects]
    variances = [sum(parameters[key]["standard_error"] ** 2 for key in keys) / len(keys) ** 2 for parameters, keys in named]
    smallest = [one["value"] for one in answer["detectable"] if one["effect"] in effects]
    return {"value": _stated(improved, effects), "standard_error": math.sqrt(sum(variances)) if named else math.nan,
            "smallest_visible": math.nan if named else min(smallest, default=math.nan), "named": bool(named)}


def _supply(recordings: Sequence[Recording], config: Config, improved: Config) -> Dict[str, Any]:
    """The measured supply; without its sensor the number that the diagnosis moved within its tolerance."""
    parts = [run["p_supply_Pa"] for run in recordings if "p_supply_Pa" in run.keys()]
    measured = numpy.concatenate([part[numpy.isfinite(part)] for part in parts]) if parts else numpy.empty(0)
    if len(measured):
        # Neighbours are alike while the pressure swings: the scatter itself bounds the error of the mean.
        return {"value": float(measured.mean()), "standard_error": float(measured.std()), "named": True,
                "smallest_visible": math.nan}
    stated = improved["supply.pressure_Pa"]
    tolerance = (config.to_dict().get("tolerances") or {}).get("supply.pressure_Pa", math.nan)
    return {"value": stated, "standard_error": float(tolerance) * stated, "named": False, "smallest_visible": math.nan}


def refitted_sizes(result: Refit, recordings: Sequence[Recording], config: Config) -> Dict[str, Any]:
    """The columns of sizes() from a refit: every size is named, and the errors of a sum go with their covariance."""
    def size(effects: Mapping[str, Sequence[str]]) -> Dict[str, Any]:
        share = {f"effects.{name}.{key}": 1.0 / len(keys) for name, keys in effects.items() for key in keys}
        weights = numpy.array([share.get(path, 0.0) for path in result.paths])
        return {"value": float(weights @ result.values), "standard_error": math.sqrt(weights @ result.covariance @ weights),
                "smallest_visible": math.nan, "named": True}

    return _columns({"friction_N": size(FRICTION), "leak_nlpm": _in_nlpm(size(LEAKS), config), "valve_delay_s": size(VALVE),
                     "supply_Pa": _supply(recordings, config, result.refitted)})


def _in_nlpm(leak: Dict[str, Any], config: Config) -> Dict[str, Any]:
    """Areas of holes as their flow."""
    return {**leak, **{key: leak_nlpm_of(leak[key], config) for key in ("value", "standard_error", "smallest_visible")}}


def _columns(found: Mapping[str, Mapping[str, Any]]) -> Dict[str, Any]:
    row: Dict[str, Any] = {}
    for name, one in found.items():
        row[name] = one["value"]
        row.update({f"{name}_{key}": one[key] for key in ("standard_error", "smallest_visible", "named")})
    return row


def sizes(result: Diagnosis, recordings: Sequence[Recording], config: Config) -> Dict[str, Any]:
    """Columns SIZE, SIZE_standard_error, SIZE_smallest_visible and SIZE_named of each of SIZES."""
    answer = to_dict(result)
    return _columns({"friction_N": _size(answer, result.improved, FRICTION),
                     "leak_nlpm": _in_nlpm(_size(answer, result.improved, LEAKS), config),
                     "valve_delay_s": _size(answer, result.improved, VALVE),
                     "supply_Pa": _supply(recordings, config, result.improved)})
