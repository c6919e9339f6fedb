# What an answer is worth beside the truth: names, elements, probabilities and sizes, with exact intervals.
"""Names that nobody can tell apart count as one (E1 to E8 of the rules in docs/proof.md). A name that the machine's small
physics really holds (`fair`) is no error and no find."""
import math


def beta_quantile(share, a, b):
    """x where the regularised incomplete beta function of whole a, b is `share`; by its sum of binomial terms."""
    n = a + b - 1

    def at(x):
        return sum(math.comb(n, k) * x**k * (1 - x) ** (n - k) for k in range(a, n + 1))

    low, high = 0.0, 1.0
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if at(middle) < share else (low, middle)
    return 0.5 * (low + high)


def interval(right, of, sure=0.95):
    """Clopper and Pearson's interval of a rate."""
    tail = 0.5 * (1 - sure)
    low = 0.0 if right == 0 else beta_quantile(tail, right, of - right + 1)
    high = 1.0 if right == of else beta_quantile(1 - tail, right + 1, of - right)
    return low, high


def value(parameters, key, default):
    one = (parameters or {}).get(key, default)
    return float(one["value"] if isinstance(one, dict) else one)


def canonical(name, parameters=None):
    of = lambda key, default: value(parameters, key, default)
    if name == "stribeck_friction" and abs(of("extra_force_N", 1e9)) <= 0.25 * abs(of("coulomb_force_N", 0)):
        return "coulomb_friction"
    if name == "direction_dependent_friction" and abs(of("forward_N", 0) - of("backward_N", 1e9)) <= 0.125 * abs(of("forward_N", 0) + of("backward_N", 1e9)):
        return "coulomb_friction"
    if name == "friction_zone" and abs(of("width_m", 0)) > 0.15:
        return "coulomb_friction"
    if name == "spring_load" and abs(of("rest_m", 0)) > 0.75:
        return "constant_force"
    if name.startswith("line_leak_") and of("position", 0.5) >= 0.9:
        return "chamber_leak_" + name[-1]
    return {"parameter:slider.payload_kg": "parameter:slider.mass_kg", "sensor_offset:u": "valve_offset"}.get(name, name)


def hidden_names(truth):
    out = {canonical(name, parameters): parameters for name, parameters in truth.get("effects", {}).items()}
    out |= {name: None for name in truth.get("law", [])}  # an outside kind that the vocabulary knows by now
    return out | {canonical(f"parameter:{path}"): {"value": number} for path, number in truth.get("parameters", {}).items()}


def fair_names(truth):
    return {canonical(name) for name in truth["fair"]} | ({"stribeck_friction", "valve_lag"} if truth["background"] else set())


def first_element(answer):
    if answer["verdict"] == "unknown" and answer["answers"]:
        return answer["answers"][0]["element"]
    return max(answer["elements"], key=lambda e: e["share"])["element"] if answer["elements"] else None


def same_element(element, truth):
    wanted = set(truth["elements"])
    for name, parameters in truth.get("effects", {}).items():
        if name.startswith(("chamber_leak_", "line_leak_")) and value(parameters, "position", 1.0) >= 0.5:
            wanted |= {f"line_{name[-1]}", f"chamber_{name[-1]}"}
    return element in wanted


def named_first(names, hidden, fair):
    beside = [name for name in names if name in hidden or name not in fair]  # what the background holds stands aside
    return bool(beside) and beside[0] in hidden


def outcome(truth, answer):
    """What became of the case, in one word; and what of it is right."""
    hidden, fair = hidden_names(truth), fair_names(truth)
    said = [(canonical(a["effect"], a.get("parameters")), a["probability"]) for a in answer["answers"] if a["effect"] != "unknown"]
    names = [name for name, _ in said]
    rivals = {canonical(r if isinstance(r, str) else r["effect"]) for a in answer["answers"] for r in a.get("ambiguous_with") or []}
    false = [(name, p) for name, p in said if name not in hidden and name not in fair]
    element = same_element(first_element(answer), truth)
    row = {"names": names, "false": [name for name, _ in false], "false_sure": [name for name, p in false if p >= 0.5], "element": element,
           "verdict": answer["verdict"], "in_set": bool(set(hidden) & (set(names) | rivals))}
    kind = truth["kind"]
    if kind in ("clean", "mounting"):
        row["right"] = not false and (answer["verdict"] == "consistent" or truth["background"])
        if kind == "mounting":
            told = " ".join(answer["data"]["warnings"])
            words = {"ports exchanged": "are exchanged", "command reversed": "u_V has the other sign", "position reversed": "x_m counts the other way"}
            row["told"] = words[truth["mounting"]] in told
            row["right"] = row["right"] and row["told"]
    elif kind == "outside":
        near = {canonical(name) for name in truth["near"]}
        row["near"] = bool(near & set(names))
        row["false_sure"] = [name for name in row["false_sure"] if name not in near]
        row["right"] = named_first(names, hidden, fair) if truth.get("law") else answer["verdict"] == "unknown" and element
    elif kind == "pair":
        row["right"] = set(hidden) <= set(names) and not false
        row["one"] = bool(set(hidden) & set(names))
    else:
        row["right"] = named_first(names, hidden, fair)
    row["word"] = word_of(kind, row, answer)
    return row


def word_of(kind, row, answer):
    if row["right"]:
        return "right"
    if kind in ("clean", "mounting"):
        return "false name" if row["false"] else "not told" if kind == "mounting" else "unknown"
    if answer["verdict"] == "consistent":
        return "not seen"
    if kind == "outside":
        unknown = "unknown" if row["element"] else "unknown, other element"
        return "near law" if row["near"] else unknown if answer["verdict"] == "unknown" else "wrong name"
    if row["false"]:
        return "true one a rival" if row["in_set"] else "wrong name"
    return "one of two" if row.get("one") else "true one a rival" if row["in_set"] else "unknown" if answer["verdict"] == "unknown" else "background named"


def said_and_right(truth, answer, row):
    """(probability, right) of every answer; a fair name is right, `unknown` where something outside is at its element."""
    hidden, fair = hidden_names(truth), fair_names(truth)
    out = []
    for a in answer["answers"]:
        name = canonical(a["effect"], a.get("parameters"))
        if name == "unknown":
            out.append((a["probability"], truth["background"] or (truth["kind"] == "outside" and not truth.get("law") and same_element(a["element"], truth))))
        else:
            out.append((a["probability"], name in hidden or name in fair))
    return out


def standard_errors_off(truth, answer):
    """How many standard errors the sizes of rightly named effects are off."""
    hidden, out = hidden_names(truth), []
    for a in answer["answers"]:
        true = hidden.get(canonical(a["effect"], a.get("parameters")))
        for key, told in (a.get("parameters") or {}).items():
            if true and key in true and isinstance(told, dict) and told.get("standard_error"):
                out.append((told["value"] - true[key]) / told["standard_error"])
    return out


def rate(rows, test):
    of = len(rows)
    right = sum(bool(test(row)) for row in rows)
    low, high = interval(right, of) if of else (0.0, 1.0)
    return {"right": right, "of": of, "low": low, "high": high}


def calibration(pairs):
    bins = []
    for low, high in ((0.0, 0.5), (0.5, 0.7), (0.7, 0.9), (0.9, 1.01)):
        inside = [(p, r) for p, r in pairs if low <= p < high]
        if inside:
            bins.append({"from": low, "to": min(high, 1.0), "said": sum(p for p, _ in inside) / len(inside), **rate(inside, lambda one: one[1])})
    error = sum(abs(b["said"] - b["right"] / b["of"]) * b["of"] for b in bins) / max(len(pairs), 1)
    return {"bins": bins, "expected_calibration_error": error, "brier": sum((p - r) ** 2 for p, r in pairs) / max(len(pairs), 1), "answers": len(pairs)}


def table(cases):
    """All figures of a run; a case is {"name", "truth", "answer"}."""
    rows = [outcome(c["truth"], c["answer"]) | {"name": c["name"], "truth": c["truth"], "answer": c["answer"]} for c in cases]
    of = lambda *kinds: [r for r in rows if r["truth"]["kind"] in kinds]
    beyond = [r for r in of("outside") if not r["truth"].get("law")]
    named = of("single", "pair", "parameter", "sensor")
    figures = {
        "clean: without a false name": rate(of("clean"), lambda r: not r["false"]),
        "clean: called consistent": rate(of("clean"), lambda r: r["verdict"] == "consistent"),
        "one effect: named first": rate(of("single"), lambda r: r["right"]),
        "one effect, from twice the smallest size: named first": rate([r for r in of("single") if r["truth"]["times_smallest"] >= 2], lambda r: r["right"]),
        "one effect: named, or told as a rival": rate(of("single"), lambda r: r["in_set"]),
        "one effect: a wrong name beside or instead": rate(of("single"), lambda r: r["false"]),
        "two effects: both named, nothing else": rate(of("pair"), lambda r: r["right"]),
        "two effects: at least one named": rate(of("pair"), lambda r: r.get("one")),
        "parameter off: named first": rate(of("parameter"), lambda r: r["right"]),
        "sensor at fault: named first": rate(of("sensor"), lambda r: r["right"]),
        "mounting fault: told, no false name": rate(of("mounting"), lambda r: r["right"]),
        "outside, with a law by now: named first": rate([r for r in of("outside") if r["truth"].get("law")], lambda r: r["right"]),
        "outside: unknown at the right element": rate(beyond, lambda r: r["right"]),
        "outside: not called consistent": rate(beyond, lambda r: r["verdict"] != "consistent"),
        "outside: a wrong law said with 0.5 or more": rate(beyond, lambda r: r["false_sure"]),
        "right element first (effects, parameters, sensors)": rate(named, lambda r: r["element"]),
    }
    pairs = [one for r in rows for one in said_and_right(r["truth"], r["answer"], r)]
    off = [z for r in rows for z in standard_errors_off(r["truth"], r["answer"])]
    coverage = {f"{share:.0%}": rate(off, lambda z, most=most: abs(z) <= most) for share, most in ((0.5, 0.674), (0.9, 1.645))}
    return rows, {"rates": figures, "calibration": calibration(pairs), "coverage": coverage}
