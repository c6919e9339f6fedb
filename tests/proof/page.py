# The page of a proof: protocol, rates with exact intervals, reliability, coverage, and every case that went wrong.
import csv
import gzip
import html

STYLE = ("body{font:15px/1.5 sans-serif;max-width:64em;margin:2em auto;padding:0 1em;color:#222}table{border-collapse:collapse;margin:1em 0}"
         "td,th{border-bottom:1px solid #ddd;padding:.25em .7em;text-align:left;vertical-align:top}.n{text-align:right}svg{margin:1em 0}code{background:#f4f4f4}")


def cell(text, right=False):
    return f'<td{" class=n" if right else ""}>{html.escape(str(text))}</td>'


def rows_of(lines, heads):
    out = "<table><tr>" + "".join(f"<th>{html.escape(h)}</th>" for h in heads) + "</tr>"
    return out + "".join("<tr>" + "".join(cell(c) for c in line) + "</tr>" for line in lines) + "</table>"


def bar(rate):
    """A rate as a point in its interval."""
    x = lambda share: 5 + 190 * share
    if not rate["of"]:
        return "no case"
    at = rate["right"] / rate["of"]
    return (f'<svg width="200" height="14"><line x1="5" y1="7" x2="195" y2="7" stroke="#ddd"/><line x1="{x(rate["low"]):.1f}" y1="7" x2="{x(rate["high"]):.1f}" y2="7" '
            f'stroke="#36c" stroke-width="4" opacity=".4"/><circle cx="{x(at):.1f}" cy="7" r="4" fill="#36c"/></svg>')


def percent(rate):
    return f'{rate["right"]} of {rate["of"]}', f'{100 * rate["low"]:.0f} to {100 * rate["high"]:.0f} %'


def rates_table(rates):
    out = "<table><tr><th>what</th><th>cases</th><th>95 % interval</th><th></th></tr>"
    for name, rate in rates.items():
        if rate["of"]:
            out += "<tr>" + "".join(cell(c) for c in (name, *percent(rate))) + f"<td>{bar(rate)}</td></tr>"
    return out + "</table>"


# What answers without probabilities can be compared by.
COMPARED = ("clean: without a false name", "one effect: named first", "one effect: a wrong name beside or instead", "two effects: both named, nothing else",
            "parameter off: named first", "sensor at fault: named first", "outside, with a law by now: named first", "outside: a wrong law said with 0.5 or more")


def compared(figures):
    """Rates of the diagnosis and of each baseline on the same cases: lines and heads."""
    beside = figures.get("baselines", {})
    lines = [(what, *(percent(one["rates"][what])[0] for one in (figures, *beside.values()))) for what in COMPARED if figures["rates"][what]["of"]]
    return lines, ("what", "diagnosis", *beside)


def reliability(bins):
    """Share that was right against the probability said, with intervals."""
    x, y = (lambda p: 45 + 240 * p), (lambda p: 260 - 240 * p)
    out = '<svg width="320" height="300" font-size="12"><rect x="45" y="20" width="240" height="240" fill="none" stroke="#ccc"/>'
    out += f'<line x1="{x(0)}" y1="{y(0)}" x2="{x(1)}" y2="{y(1)}" stroke="#bbb" stroke-dasharray="4"/>'
    for b in bins:
        at = b["right"] / b["of"]
        out += (f'<line x1="{x(b["said"]):.1f}" x2="{x(b["said"]):.1f}" y1="{y(b["low"]):.1f}" y2="{y(b["high"]):.1f}" stroke="#36c" stroke-width="2"/>'
                f'<circle cx="{x(b["said"]):.1f}" cy="{y(at):.1f}" r="4" fill="#36c"/><text x="{x(b["said"]) - 30:.1f}" y="{y(at) - 8:.1f}">{b["right"]}/{b["of"]}</text>')
    return out + '<text x="110" y="290">probability said</text><text x="0" y="140">right</text></svg>'


def secret(truth):
    hidden = [f"{name} {', '.join(f'{k} {v:.3g}' for k, v in p.items())}" for name, p in truth.get("effects", {}).items()]
    hidden += [f"{path} = {number:.4g} ({truth['tolerances_off']:+.1f} tolerances)" for path, number in truth.get("parameters", {}).items()]
    return "; ".join(hidden) or truth.get("outside") or truth.get("mounting") or "nothing"


def told(answer):
    return "; ".join(f"{a['effect']} ({a['probability']:.2f})" for a in answer["answers"]) or answer["verdict"]


def case_lines(rows):
    for r in rows:
        size = r["truth"].get("times_smallest")
        yield (r["name"], r["truth"]["kind"], secret(r["truth"]), f"{size:.1f}" if size else "", f'{r["truth"]["visible"]:.1f}',
               "yes" if r["truth"]["background"] else "no", told(r["answer"]), r["word"])


def by_size(rows):
    """Named first, by size in units of the smallest one, and by how far it moves the ports in sensor floors."""
    single = [r for r in rows if r["truth"]["kind"] == "single"]
    for low, high in ((0, 1), (1, 2), (2, 4), (4, 8), (8, 17)):
        inside = [r for r in single if low <= r["truth"]["times_smallest"] < high]
        if inside:
            yield f"size {low} to {high} times the smallest", sum(r["right"] for r in inside), len(inside)
    for low, high in ((0, 0.3), (0.3, 1), (1, 3), (3, 10), (10, 1e9)):
        inside = [r for r in single if low <= r["truth"]["visible"] < high]
        if inside:
            yield f"moves a port by {low:g} to {high:g} floors" if high < 1e9 else f"moves a port by {low:g} floors and more", sum(r["right"] for r in inside), len(inside)


def curve(rows, column, left, top, width, height, colour):
    """A column over the rows, thinned to two points a pixel: the least and the largest value of each."""
    values = [float(row[column]) for row in rows]
    low, high = min(values), max(values)
    step = max(1, len(values) // width)
    points = []
    for k in range(0, len(values), step):
        piece = values[k:k + step]
        x = left + width * k / len(values)
        points += [f"{x:.1f},{top + height * (high - y) / ((high - low) or 1):.1f}" for y in (min(piece), max(piece))]
    return f'<polyline fill="none" stroke="{colour}" points="{" ".join(points)}"/><text x="{left}" y="{top - 4}" fill="{colour}">{column} {low:.4g} to {high:.4g}</text>'


def course(folder):
    """Position, command and ports of a case's first recording, where it is there."""
    if not (folder / "recording-1.csv.gz").is_file():
        return ""
    with gzip.open(folder / "recording-1.csv.gz", "rt", encoding="utf-8") as file:
        rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
    out = '<svg width="820" height="110" font-size="11">'
    for k, (column, colour) in enumerate((("x_m", "#333"), ("u_V", "#a50"), ("p1_port_Pa", "#36c"), ("p2_port_Pa", "#093"))):
        out += curve(rows, column, 205 * k, 20, 190, 80, colour)
    return out + "</svg>"


def write_picture(path, figures):
    """The rates with their exact 95 % intervals, as a picture for a page of its own."""
    rates = [(name, rate) for name, rate in figures["rates"].items() if rate["of"]]
    x = lambda share: 430 + 260 * share
    out = f'<svg xmlns="http://www.w3.org/2000/svg" width="800" height="{24 * len(rates) + 40}" font-family="sans-serif" font-size="13">'
    out += '<rect width="100%" height="100%" fill="white"/>'
    for i, (name, rate) in enumerate(rates):
        y = 24 * i + 20
        out += (f'<text x="420" y="{y + 4}" text-anchor="end">{html.escape(name)}</text><line x1="{x(0)}" x2="{x(1)}" y1="{y}" y2="{y}" stroke="#ddd"/>'
                f'<line x1="{x(rate["low"]):.1f}" x2="{x(rate["high"]):.1f}" y1="{y}" y2="{y}" stroke="#36c" stroke-width="6" opacity=".4"/>'
                f'<circle cx="{x(rate["right"] / rate["of"]):.1f}" cy="{y}" r="4.5" fill="#36c"/><text x="705" y="{y + 4}">{rate["right"]} of {rate["of"]}</text>')
    for share in (0, 0.5, 1):
        out += f'<text x="{x(share)}" y="{24 * len(rates) + 30}" text-anchor="middle" fill="#666">{share:.0%}</text>'
    path.write_text(out + "</svg>\n", encoding="utf-8")


def markdown_table(heads, lines):
    return "\n".join(["| " + " | ".join(heads) + " |", "|" + "---|" * len(heads), *("| " + " | ".join(str(c) for c in line) + " |" for line in lines)]) + "\n"


def write_markdown(path, told_of_run, rows, figures):
    """The tables of the page as Markdown, for a page in docs."""
    calibration = figures["calibration"]
    found = [(name, *percent(rate)) for name, rate in figures["rates"].items() if rate["of"]]
    found += [(f"sizes inside their {name} interval", *percent(rate)) for name, rate in figures["coverage"].items() if rate["of"]]
    found += [(f'said with {b["from"]:g} to {b["to"]:g}, right', *percent(b)) for b in calibration["bins"]]
    out = told_of_run + "\n\n" + markdown_table(("what", "cases", "95 % interval"), found)
    out += f'\nExpected calibration error {calibration["expected_calibration_error"]:.2f}, Brier score {calibration["brier"]:.2f}, {calibration["answers"]} answers.\n'
    if "baselines" in figures:
        lines, heads = compared(figures)
        out += "\n" + markdown_table(heads, lines)
    out += "\n" + markdown_table(("case", "kind", "hidden", "times smallest", "floors", "background", "answer", "result"), case_lines(rows))
    path.write_text(out, encoding="utf-8")


def wrong_cases(folder, rows, heads):
    """Each with its first recording."""
    out = ""
    for row in rows:
        out += rows_of(case_lines([row]), heads) + course(folder / row["name"])
    return out or "<p>Nothing.</p>"


def write_page(path, told_of_run, rows, figures):
    calibration = figures["calibration"]
    heads = ("case", "kind", "hidden", "times smallest", "floors", "background", "answer", "result")
    body = "<h1>What was hidden, and how often it was found</h1>"
    body += "<p>" + html.escape(told_of_run) + "</p><h2>Protocol</h2><ol>"
    for step in ("A generator that shares no code with the program draws a machine, its user's loop and moves, and a secret.",
                 "It writes the owner's config and two recordings; the SHA-256 of the salted truth goes into commitments.txt.",
                 "The program diagnoses, once, without the truth. The SHA-256 of each answer goes into commitments.txt.",
                 "The truth is opened, checked against its hash, and every answer is scored. No case is left out."):
        body += f"<li>{step}</li>"
    body += "</ol><h2>Rates</h2>" + rates_table(figures["rates"])
    body += "<h2>By size</h2>" + rows_of(by_size(rows), ("one effect", "named first", "of"))
    body += f'<h2>Are the probabilities honest?</h2>{reliability(calibration["bins"])}<p>Expected calibration error {calibration["expected_calibration_error"]:.3f}, Brier score {calibration["brier"]:.3f}, {calibration["answers"]} answers.</p>'
    body += "<h2>Do the intervals of sizes hold the truth?</h2>" + rates_table(figures["coverage"])
    if "baselines" in figures:
        body += "<h2>Simpler ways on the same data</h2>" + rows_of(*compared(figures))
    body += "<h2>What went wrong</h2>" + wrong_cases(path.parent, [r for r in rows if not r["right"]], heads)
    body += "<h2>All cases</h2>" + rows_of(case_lines(rows), heads)
    path.write_text(f'<!doctype html><meta charset="utf-8"><title>Proof</title><style>{STYLE}</style>{body}\n', encoding="utf-8")
