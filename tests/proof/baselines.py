# What simpler ways of naming make of the same data: the nearest signature, and a fit of everything at once.
"""Both see what the diagnosis sees: the owner's config and the recordings. Their answers have the form of its JSON, so that
scores.py scores all three alike. They compute on the owner's model: the residual is the recording less its simulation under
the recorded command, of the position its change over 0.1 s, for a free position drifts. Each channel is in units of what
noise and the owner's tolerances make there. A signature is how an effect, a sensor's fault or a parameter moves the simulation."""
import math
import pathlib

import numpy
import pneuservo
import scipy.optimize

SENSORS = {"p1_port_Pa": "port_pressure", "p2_port_Pa": "port_pressure", "p1_chamber_Pa": "chamber_pressure", "p2_chamber_Pa": "chamber_pressure",
           "p_supply_Pa": "supply_pressure", "x_m": "position"}
RUNGS = (1, 3)  # 2 and 8 times the smallest size of an effect: where its shape changes with size, the nearer one counts
CHANGE_S = 0.1
NAMES = ("nearest signature", "fit of everything")


class Machine:
    """What an owner has of one machine; signals are matrices of one row a channel."""

    def __init__(self, folder):
        self.config = pneuservo.Config(str(folder / "rig.yaml"))
        self.recordings = [r for path in sorted(folder.glob("recording-*.csv.gz")) for r in pneuservo.read_recordings(str(path), self.config)]
        self.channels = [c for c in SENSORS if all(c in r for r in self.recordings)]
        self.rig = self.config.to_dict()
        simulated = [pneuservo.simulate(self.config, r) for r in self.recordings]
        self.simulated = self.signals(simulated)
        self.residual = self.signals(self.recordings) - self.simulated
        changes = {path: {path: float(self.config[path]) * (1 + tolerance)} for path, tolerance in self.rig.get("tolerances", {}).items()}
        self.tolerances = {path: vector for path, change in changes.items() if (vector := self.moved(self.config.replace(change))) is not None}
        self.spread = numpy.sqrt(numpy.square(self.noise()) + sum(numpy.mean(numpy.square(t), axis=1) for t in self.tolerances.values()))

    def signals(self, columns):
        lag = max(1, round(CHANGE_S / self.config.period_s))
        change = lambda v: v - numpy.concatenate([numpy.full(lag, v[0]), v[:-lag]])
        values = [{c: numpy.asarray(one[c], dtype=float) for c in self.channels} for one in columns]
        return numpy.array([numpy.concatenate([change(one[c]) if c == "x_m" else one[c] for one in values]) for c in self.channels])

    def noise(self):
        sensors = {c: self.rig["sensors"][SENSORS[c]] for c in self.channels}
        unit = lambda c: "_m" if c == "x_m" else "_Pa"
        return numpy.array([math.hypot(s[f"noise{unit(c)}"], s[f"quantum{unit(c)}"] / math.sqrt(12)) for c, s in sensors.items()])

    def moved(self, config):
        """How another config moves the simulation; nothing where it does not or cannot run."""
        try:
            vector = self.signals([pneuservo.simulate(config, r) for r in self.recordings]) - self.simulated
        except (ValueError, RuntimeError):
            return None
        return vector if numpy.isfinite(vector).all() and vector.any() else None

    def weighed(self, signals):
        return (signals / self.spread[:, None]).ravel()


def effect_signatures(machine, known, sized):
    """(name, vector): effects that have sizes at two of them; offset, gain and lag of each sensor, either way."""
    out = []
    for name, effect in known.items():
        for rung in RUNGS if effect["smallest"] else ():
            vector = machine.moved(machine.config.with_effects({name: sized(effect, rung, 0.5 * machine.rig["slider"]["mass_kg"])}))
            if vector is not None:
                out.append((name, machine.weighed(vector)))
    for row, channel in enumerate(machine.channels):
        for fault, shape in (("offset", numpy.ones_like), ("gain", lambda v: v), ("lag", numpy.gradient)):
            vector = numpy.zeros_like(machine.simulated)
            vector[row] = shape(machine.simulated[row])
            if vector.any():
                out += [(f"sensor_{fault}:{channel.rsplit('_', 1)[0]}", sign * machine.weighed(vector)) for sign in (1, -1)]
    return out


def answer(names, elements):
    return {"verdict": "explained" if names else "consistent", "answers": [{"effect": n, "element": elements.get(n, ""), "probability": 1.0} for n in names],
            "elements": [{"element": elements.get(names[0], ""), "share": 1.0}] if names else [], "data": {"warnings": []}}


def nearest_signature(residual, tolerances, effects):
    """The one name whose signature, of an effect or of a parameter either way, has the smallest angle to the residual. None where
    the residual is at most twice what noise and tolerances make: two standard deviations."""
    if residual @ residual <= 4 * len(residual):
        return []
    both = effects + [(f"parameter:{path}", sign * vector) for path, vector in tolerances.items() for sign in (1, -1)]
    return [max(both, key=lambda one: float(one[1] @ residual) / math.sqrt(one[1] @ one[1]))[0]]


def fit_of_everything(residual, tolerances, effects):
    """All signatures at once by least squares, sizes not below 0, each tolerance at its price. Named is what moves the signals by
    more than noise and tolerances do, and a parameter beyond three tolerances; the largest first."""
    signed = [(path, sign * vector) for path, vector in tolerances.items() for sign in (1, -1)]
    columns = numpy.array([vector for _, vector in effects + signed]).T
    scale = numpy.sqrt(numpy.sum(numpy.square(columns), axis=0))
    price = numpy.zeros((len(signed), len(scale)))
    price[:, len(effects):] = numpy.diag(1 / scale[len(effects):])
    size, _ = scipy.optimize.nnls(numpy.vstack([columns / scale, price]), numpy.concatenate([residual, numpy.zeros(len(signed))]), maxiter=100 * len(scale))
    size /= scale
    moved = {}
    for k, (name, vector) in enumerate(effects):
        moved[name] = moved.get(name, 0.0) + size[k] * vector
    rms = {name: math.sqrt(numpy.mean(numpy.square(vector))) for name, vector in moved.items()}
    off = {}
    for k, (path, _) in enumerate(signed):
        off[path] = max(off.get(path, 0.0), size[len(effects) + k])
    rms |= {f"parameter:{path}": o * math.sqrt(numpy.mean(numpy.square(tolerances[path]))) if o > 3 else 0.0 for path, o in off.items()}
    largest = sorted(rms.items(), key=lambda one: -one[1])
    return [name for name, r in largest if r > (0 if name.startswith("parameter:") else 1)]


def answers(folder, known, sized):
    """{baseline: answer} for one case."""
    machine = Machine(pathlib.Path(folder))
    residual = machine.weighed(machine.residual)
    tolerances = {path: machine.weighed(vector) for path, vector in machine.tolerances.items()}
    effects = effect_signatures(machine, known, sized)
    elements = {name: effect["element"] for name, effect in known.items()}
    return {name: answer(way(residual, tolerances, effects), elements) for name, way in zip(NAMES, (nearest_signature, fit_of_everything))}
