# What tools/evidence measures: each function makes the cases that are not there yet and returns its rows' figures by name.
"""`options` has root, out, program, machine, shared, seed, jobs and count; `run` starts a sibling tool and tells whether it ended well."""
import importlib.util
import json
import re
import statistics
import subprocess
import sys
import types

import yaml

import decoys
import diagnosed
import dose
import page
import real
import scores
import vocabulary


def run(options, tool, *words, may_end=(0,)):
    """Runs a tool of this folder, its words shown; an error with its last line where it ends otherwise."""
    done = subprocess.run([sys.executable, str(options.root / "tools" / tool), *map(str, words)], stderr=subprocess.PIPE, text=True, check=False)
    if done.returncode not in may_end:
        raise RuntimeError(f"tools/{tool} ended with status {done.returncode}: {(done.stderr.strip().splitlines() or ['?'])[-1]}")


def folder_of(options, measurement):
    """Options of a row that draws machines: its own folder of OUT."""
    out = options.out / measurement
    out.mkdir(parents=True, exist_ok=True)
    return types.SimpleNamespace(out=out, program=options.program, machine=options.machine, seed=options.seed, length_s=None)


def vocabulary_of(options):
    return lambda rig: (vocabulary.effects(options.program, rig), vocabulary.sized)


def numbers(options):
    """Members of DecisionRules, and those that by the method's page have statistics or a measurement behind them."""
    text = (options.root / "src/diagnosis/verdict/decision_rules.hpp").read_text(encoding="utf-8")
    names = re.findall(r"^  (?:double|std::size_t|int|bool) (\w+) =", text, re.MULTILINE)
    method = (options.root / "docs/physics/diagnosis-method.md").read_text(encoding="utf-8")
    kinds = dict(re.findall(r"^\| `(\w+)` [\d.]+ \| (statistics|measured|labelled) \|", method, re.MULTILINE))
    without = [name for name in names if kinds.get(name, "labelled") == "labelled"]
    return {"numbers": {"value": len(names), "found": str(len(names))},
            "numbers-source": {"right": len(names) - len(without), "of": len(names), "exact": True, "wrong": [", ".join(without)] if without else []}}


def shared_score(options):
    """The shared cases' own score, as a module."""
    spec = importlib.util.spec_from_file_location("shared_score", options.shared / "concealed/score.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def false_names(score, truth, answer):
    """Names that are neither concealed nor of the case's background; an outside kind's own word is none."""
    names = [name for name in map(score.answer_name, answer["answers"]) if name != "unknown"]
    fair = {score.canonical(name, lambda _, default: default) for name in truth.get("fair_effects") or {}}
    if score.klass(truth) == "outside" and score.outside_right(truth, answer):
        return []
    return sorted(score.match(score.truth_names(truth), names)[2] - fair)


def answers_in(folder):
    return {file.stem: json.loads(file.read_text(encoding="utf-8")) for file in sorted(folder.glob("case-*.json"))}


def shared_cases(options, name):
    """Right, sizes and false names of one set of the shared cases, by its own rules."""
    root, out = options.shared / "concealed" / name, options.out / name
    run(options, "diagnose-cases", root, out, "--program", options.program, "--jobs", options.jobs, "--missing", may_end=(0, 1))
    score = shared_score(options)
    truths, answers = score.load_truths(str(root)), answers_in(out)
    _, lines, figures = score.score(truths, answers)
    wrong = [f"{case}, {hidden}: {said}" for case, _, ok, hidden, said in lines if not ok.startswith("ok")]
    within, of = figures["within"]
    false = {case: false_names(score, truths[case], answers[case]) for case in answers if case in truths}
    return {name: {"right": len(lines) - len(wrong), "of": len(lines), "wrong": wrong}, f"{name}-sizes": {"right": within, "of": of},
            f"{name}-names": {"right": sum(not names for names in false.values()), "of": len(false),
                              "wrong": [f"{case}: {', '.join(names)}" for case, names in false.items() if names]}}


def case_time(options):
    """Wall time of each labelled case on two cores, nothing else running: the tool cannot know whether that is so."""
    out = options.out / "time"
    run(options, "diagnose-cases", options.shared / "concealed/labelled", out, "--program", options.program, "--jobs", 2, "--missing", may_end=(0, 1))
    rows = [row.split(",") for row in (out / "times.csv").read_text(encoding="utf-8").splitlines()[1:]]
    times = list({case: float(wall_s) for case, wall_s, _ in rows}.values())
    middle, most = statistics.median(times), max(times)
    return {"time": {"value": middle, "found": f"{middle:.1f} s, {most:.1f} s of {len(times)}"}}


def ablation(options, name, *words):
    """`unknown` at the element of the name that was left out; a law said with 0.5 or more in its place."""
    out = options.out / name
    *more, root = words
    run(options, "ablation-trial", *more, root, out, "--program", options.program, "--jobs", options.jobs, may_end=(0, 1))
    cases = json.loads((out / "ablation.json").read_text(encoding="utf-8"))["cases"]
    told = lambda c: f"{c['case']} without `{c['left_out']}`: " + (f"`{c['said']}` at {c['said_element']} ({c['probability']:.2f})" if c["said"] else c["verdict"])
    rows = {}
    for row, words_of_row in ((name, ("right",)), (f"{name}-wrong", ("wrong",))):
        counted = [c for c in cases if c["judged"] in words_of_row]
        rows[row] = {"right": len(counted), "of": len(cases), "wrong": [told(c) for c in (counted if "wrong" in words_of_row else cases) if c["judged"] != "right"]}
    return rows


def ablation_labelled(options):
    return ablation(options, "ablation-labelled", options.shared / "concealed/labelled")


def ablation_own(options):
    return ablation(options, "ablation-own", "--own", options.count["ablation-own"], "--seed", options.seed, options.out / "ablation-own" / "machines")


def real_machines(options):
    """Names of 0.5 or more on real machines that none of their sources bears out."""
    out = options.out / "real"
    run(options, "real-machines-table", options.program.parent, "--recordings", options.shared / "recordings", "--jobs", options.jobs, "--answers", out)
    kept = [json.loads(file.read_text(encoding="utf-8")) for file in sorted(out.glob("row-*.json"))]
    wrong = {one["machine"]: names for one in kept if (names := real.wrong_names(one["command"], one["answer"]))}
    return {"real": {"right": len(kept) - len(wrong), "of": len(kept), "wrong": [f"{machine}: {', '.join(names)}" for machine, names in wrong.items()]}}


def proof(options, name, *words):
    """The figures that tools/proof writes of its machines."""
    out = options.out / name
    run(options, "proof", out, "--seed", options.seed, "--count", options.count[name], "--program", options.program, "--machine", options.machine,
        "--jobs", options.jobs, *words, may_end=(0, 1))
    return json.loads((out / "proof.json").read_text(encoding="utf-8"))


def calibration(options):
    figures = proof(options, "calibration", "--background", "yes")
    sure = [b for b in figures["calibration"]["bins"] if b["from"] == 0.9]
    error, answers = figures["calibration"]["expected_calibration_error"], figures["calibration"]["answers"]
    sizes = figures["coverage"]["90%"]
    return {"calibration-sure": {"right": sum(b["right"] for b in sure), "of": sum(b["of"] for b in sure)},
            "calibration-error": {"value": error, "found": f"{error:.3f} of {answers} answers"},
            "calibration-sizes": {"right": sizes["right"], "of": sizes["of"]}}


def clean(options):
    figures = proof(options, "clean", "--stage", "own", "--kind", "clean")
    kept = figures["rates"]["clean: without a false name"]
    return {"clean": {"right": kept["right"], "of": kept["of"], "wrong": [f"{c['name']}: {', '.join(c['false'])}" for c in figures["cases"] if c["false"]]}}


def answer_of(options, name):
    """The answer to a case of a row that draws machines; None: there is none."""
    file = options.out / f"{name}.json"
    return json.loads(file.read_text(encoding="utf-8")) if diagnosed.answered(options.program, options.out / name, file) else None


def points_of(own, effect):
    """(set, found, answer) of each dose of one machine; a dose without an answer counts as nothing found."""
    points = []
    for name in dose.make_doses(effect, own, vocabulary_of(own)):
        truth = json.loads((own.out / "sealed" / f"{name}.json").read_text(encoding="utf-8"))
        answer = answer_of(own, name) or {"verdict": "no answer", "answers": []}
        points.append((truth["set"], dose.found(answer, effect), answer))
        print(f"{name}: set {points[-1][0]:.4g}, found {points[-1][1]:.4g}; {page.told(answer)}", flush=True)
    return points


def doses(options):
    """Slope and intercept of each effect; at zero, machines that are given a name all the same."""
    own, lines, named = folder_of(options, "dose"), {}, []
    for effect in dose.EFFECTS:
        points = points_of(own, effect)
        lines[effect] = dose.line([point[:2] for point in points]) | {"points": [(point[0], point[1], page.told(point[2])) for point in points]}
        if points[0][2]["verdict"] != "consistent":
            named.append(f"`{effect}`: {page.told(points[0][2])}")
    said = {effect: f"`{effect}` {one['slope']:.3f} ± {one['slope_error']:.3f}, intercept {one['intercept']:.2g} ± {one['intercept_error']:.1g}" for effect, one in lines.items()}
    unnamed = [f"`{effect}` {at:.3g}: {words}" for effect, one in lines.items() for at, size, words in one["points"] if at and not size]
    print("\n".join(said.values()))
    (own.out / "lines.json").write_text(json.dumps(lines, indent=1), encoding="utf-8")
    off = [effect for effect, one in lines.items() if not dose.is_one(one)]
    return {"dose-slope": {"right": len(lines) - len(off), "of": len(lines), "wrong": [said[effect] for effect in off], "lines": lines},
            "dose-named": {"right": dose.DOSES * len(lines) - len(unnamed), "of": dose.DOSES * len(lines), "wrong": unnamed},
            "dose-zero": {"right": len(lines) - len(named), "of": len(lines), "wrong": named}}


def favoured(options):
    """Whether the effect is first although a number of the config speaks for a rival."""
    own, rows = folder_of(options, "decoys"), []
    for number in range(options.count["decoys"]):
        name = decoys.make_case(number, own, vocabulary_of(own))
        truth, answer = json.loads((own.out / "sealed" / f"{name}.json").read_text(encoding="utf-8")), answer_of(own, name)
        row = scores.outcome(truth, answer or {"verdict": "no answer", "answers": [], "elements": [], "data": {"warnings": []}})
        off = f"`{truth['decoy']['path']}` {truth['decoy']['tolerances_off']:+.1f} tolerances"
        rows.append(row | {"told": f"{name}, {page.secret(truth)} beside {off}: {page.told(answer) if answer else 'no answer'}"})
        print(f"{row['word']:<22} {rows[-1]['told']}", flush=True)
    return {"decoys": {"right": sum(row["right"] for row in rows), "of": len(rows), "wrong": [row["told"] for row in rows if not row["right"]]},
            "decoys-wrong": {"right": sum(bool(row["false_sure"]) for row in rows), "of": len(rows), "wrong": [row["told"] for row in rows if row["false_sure"]]}}


class Measurement(types.SimpleNamespace):
    """A function of this page, the programs it is made by, the shared folder that it needs, and how many machines it draws unless told."""


def of(make, by=("program",), needs="", count=0):
    return Measurement(make=make, by=by, needs=needs, count=count)


BOTH = ("program", "machine")
MEASUREMENTS = {
    "numbers": of(numbers, by=()),
    "labelled": of(lambda o: shared_cases(o, "labelled"), needs="concealed/labelled"),
    "background": of(lambda o: shared_cases(o, "background"), needs="concealed/background"),
    "others": of(lambda o: shared_cases(o, "others"), needs="concealed/others"),
    "ablation-labelled": of(ablation_labelled, needs="concealed/labelled"),
    "ablation-own": of(ablation_own, count=100),
    "real": of(real_machines, needs="recordings"),
    "calibration": of(calibration, by=BOTH, count=84),
    "clean": of(clean, count=300),
    "dose": of(doses, by=BOTH),
    "decoys": of(favoured, by=BOTH, count=16),
    "time": of(case_time, needs="concealed/labelled"),
}
# Those that draw their machines from a seed.
DRAWN = ("ablation-own", "calibration", "clean", "dose", "decoys")
