# The evidence page: what each row asks, a row's file, and the table of docs/diagnosis-results.md that is written from the files.
"""A row is measured by one run of tools/evidence and kept in docs/evidence/ROW.json with its date and commit, so that rows of different
days stand side by side. A row without a file reads "not measured"."""
import json
import typing

import page
import scores

BEGIN, END = "<!-- evidence: written by tools/evidence --page -->", "<!-- evidence: end -->"
MOST_TOLD = 6  # cases that were not right, a row


class Row(typing.NamedTuple):
    name: str
    measurement: str  # of tools/evidence --rows
    what: str
    asked: str
    met: typing.Callable  # of the row's figures; None: nothing is asked


def share(figures):
    return figures["right"] / figures["of"]


def all_right(figures):
    return figures["right"] == figures["of"]


ROWS = [
    Row("numbers", "numbers", "numbers that decide a verdict (`DecisionRules`)", "at most 15", lambda f: f["value"] <= 15),
    Row("numbers-source", "numbers", "of them with statistics or a measurement behind them, by the [method](physics/diagnosis-method.md#4-verdict)", "all", all_right),
    *(Row(name + more, name, f"{words}: {what}", asked, met)
      for name, words in (("labelled", "44 labelled cases"), ("background", "10 with a background"), ("others", "19 unlike the thesis'"))
      for more, what, asked, met in (("", "right", "-", None), ("-sizes", "sizes within two standard errors", "about 95 %", lambda f: f["low"] <= 0.954 <= f["high"]),
                                     ("-names", "without a false name", "all", all_right))),
    Row("ablation-labelled", "ablation-labelled", "labelled single effects, the true name left out: `unknown` at its element", "85 %", lambda f: share(f) >= 0.85),
    Row("ablation-labelled-wrong", "ablation-labelled", "the same: a wrong law said with 0.5 or more", "at most 8 %", lambda f: share(f) <= 0.08),
    Row("ablation-own", "ablation-own", "own machines, 4 to 16 times the smallest size, the true name left out: `unknown` at its element", "85 %", lambda f: share(f) >= 0.85),
    Row("ablation-own-wrong", "ablation-own", "the same: a wrong law said with 0.5 or more", "at most 8 %", lambda f: share(f) <= 0.08),
    Row("real", "real", "verdicts on [real machines](real-machines.md) without a wrong name of 0.5 or more", "all", all_right),
    Row("calibration-sure", "calibration", "fresh independent machines with a background: said with 0.9 or more, right", "lower bound 90 %", lambda f: f["low"] >= 0.9),
    Row("calibration-error", "calibration", "the same: expected calibration error", "at most 0.05", lambda f: f["value"] <= 0.05),
    Row("calibration-sizes", "calibration", "the same: sizes inside their 90 % interval", "85 to 95 %", lambda f: 0.85 <= share(f) <= 0.95),
    Row("clean", "clean", "fresh clean machines of the own simulator without a false name", "all", all_right),
    Row("dose-slope", "dose", "dose and response, an effect at four sizes: slope of found over set within 0.95 to 1.05, sure to 0.05", "all", all_right),
    Row("dose-named", "dose", "the same: doses whose effect is named", "-", None),
    Row("dose-zero", "dose", "the same machines at zero: called consistent", "all", all_right),
    Row("decoys", "decoys", "an effect beside a number 2 to 3 tolerances off that favours a rival: the effect first", "-", None),
    Row("decoys-wrong", "decoys", "the same: a wrong name said with 0.5 or more", "none", lambda f: f["right"] == 0),
    Row("time", "time", "time of a labelled case on two cores: median, most", "-", None),
]


def measured(row, right=None, of=None, value=None, found="", wrong=(), exact=False, **more):
    """The figures of a row: a rate with its exact 95 % interval, of all there are (`exact`) without one, or a number and its words; `more` is kept in its file."""
    figures = {"row": row.name, "what": row.what, "asked": row.asked, "value": value}
    if of is not None:
        low, high = (None, None) if exact else scores.interval(right, of) if of else (0.0, 1.0)
        figures |= {"right": right, "of": of, "low": low, "high": high}
        found = found or f"{right} of {of}"
    met = None if row.met is None or of == 0 else bool(row.met(figures))
    return figures | {"found": found, "met": met, "not_right": list(wrong)} | more


def write_row(folder, figures, provenance):
    folder.mkdir(parents=True, exist_ok=True)
    (folder / f"{figures['row']}.json").write_text(json.dumps(figures | provenance, indent=1) + "\n", encoding="utf-8")


def rows_measured(folder):
    """{name: figures} of the rows that have a file."""
    return {row.name: json.loads(file.read_text(encoding="utf-8")) for row in ROWS if (file := folder / f"{row.name}.json").is_file()}


def interval_words(figures):
    return f'{100 * figures["low"]:.0f} to {100 * figures["high"]:.0f} %' if figures.get("low") is not None else ""


def line(row, figures):
    if figures is None:
        return (row.what, "not measured", "", row.asked, "", "")
    met = {True: "yes", False: "no", None: ""}[figures["met"]]
    return (figures["what"], figures["found"], interval_words(figures), figures["asked"], met, f'{figures["date"]}, `{figures["commit"]}`')


def told(figures):
    """Its command, and the cases that were not right."""
    wrong = figures["not_right"]
    more = f"; {len(wrong) - MOST_TOLD} more in `docs/evidence/{figures['row']}.json`" if len(wrong) > MOST_TOLD else ""
    return "; ".join(wrong[:MOST_TOLD]) + more


def section(folder):
    """What stands between the marks: the table, the commands, the cases that were not right."""
    kept = rows_measured(folder)
    out = page.markdown_table(("what", "found", "95 % interval", "asked", "met", "measured"), [line(row, kept.get(row.name)) for row in ROWS])
    commands = dict.fromkeys(figures["command"] for figures in kept.values())
    out += "\nEach row's command; `OUT` keeps cases and answers:\n\n" + "".join(f"- `{command}`\n" for command in commands) if commands else ""
    wrong = [figures for figures in kept.values() if figures["not_right"]]
    out += "\nWhat was not right:\n\n" + "".join(f'- `{figures["row"]}`: {told(figures)}\n' for figures in wrong) if wrong else ""
    return out


def write_page(file, folder):
    """Puts the section between the marks of the page; a sentence where the marks are not there."""
    text = file.read_text(encoding="utf-8")
    if text.count(BEGIN) != 1 or text.count(END) != 1 or text.index(BEGIN) > text.index(END):
        return f"{file}: found no pair of marks, expected one line `{BEGIN}` and one line `{END}` after it; put them where the table shall stand"
    before, _, rest = text.partition(BEGIN)
    file.write_text(before + BEGIN + "\n" + section(folder) + END + rest.partition(END)[2], encoding="utf-8")
    return ""
