# The pages of a trend: sizes against weeks with their errors, and a table of the fleet.
"""Self-contained HTML with pictures in SVG."""
import html
import os
import pathlib
import re
from typing import Any, List, Tuple, Union

import numpy

from .sizes import SIZES
from .trend import AxisTrend, Series, monday_of, name_of, rounded, words_of

_STYLE = """body { margin: 0 auto; max-width: 980px; padding: 32px 24px; color: #1b1f24; background: #fff;
  font: 16px/1.5 system-ui, "DejaVu Sans", sans-serif; }
h1 { font-size: 25px; } h2 { font-size: 19px; margin: 32px 0 4px; } p { color: #5b6470; max-width: 72ch; }
table { border-collapse: collapse; font-size: 14px; } th, td { text-align: left; padding: 6px 14px 6px 0; border-bottom: 1px solid #dfe3e8; }
.changed { color: #b3261e; } svg { width: 100%; height: auto; }"""
WIDTH, HEIGHT, LEFT, RIGHT, TOP, BOTTOM = 760, 190, 76, 14, 12, 26


def _ticks(low: float, high: float) -> List[float]:
    """Three to seven round numbers in a range."""
    step = 10.0 ** numpy.floor(numpy.log10((high - low) / 2.0))
    step *= next(factor for factor in (5, 2, 1) if (high - low) / (factor * step) >= 2)
    return [float(tick) for tick in numpy.arange(numpy.ceil(low / step), numpy.floor(high / step) + 1) * step + 0.0]


def _range(series: Series) -> Tuple[float, float]:
    low = float((series.values - series.standard_errors).min())
    high = float((series.values + series.standard_errors).max())
    margin = 0.08 * (high - low) or 0.05 * abs(high) or 1.0
    return low - margin, high + margin


def svg_of(series: Series) -> str:
    """Values with one standard error against weeks; since when it changed, and when that was told."""
    low, high = _range(series)
    first, last = int(series.weeks[0]), max(int(series.weeks[-1]), int(series.weeks[0]) + 1)

    def x(week: float) -> float:
        return LEFT + (WIDTH - LEFT - RIGHT) * (week - first) / (last - first)

    def y(value: float) -> float:
        return HEIGHT - BOTTOM - (HEIGHT - BOTTOM - TOP) * (value - low) / (high - low)

    out = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" font-family="sans-serif" font-size="12" fill="#5b6470">']
    if series.change:
        since, told = x(series.change.since_week), x(series.change.told_week)
        out.append(f'<rect x="{since:.1f}" y="{TOP}" width="{WIDTH - RIGHT - since:.1f}" height="{HEIGHT - TOP - BOTTOM}" fill="#fdeceb"/>')
        out.append(f'<line x1="{told:.1f}" x2="{told:.1f}" y1="{TOP}" y2="{HEIGHT - BOTTOM}" stroke="#b3261e" stroke-dasharray="4 3"/>')
    for tick in _ticks(low, high):
        out.append(f'<line x1="{LEFT}" x2="{WIDTH - RIGHT}" y1="{y(tick):.1f}" y2="{y(tick):.1f}" stroke="#dfe3e8"/>'
                   f'<text x="{LEFT - 8}" y="{y(tick) + 4:.1f}" text-anchor="end">{tick:.6g}</text>')
    for week in sorted({first, (first + last) // 2, last}):
        anchor = "start" if week == first else "end" if week == last else "middle"
        out.append(f'<text x="{x(week):.1f}" y="{HEIGHT - 6}" text-anchor="{anchor}">{monday_of(week)}</text>')
    for week, value, error in zip(series.weeks, series.values, series.standard_errors):
        out.append(f'<path d="M{x(week):.1f} {y(value - error):.1f}V{y(value + error):.1f}" stroke="#8fb8de" stroke-width="2"/>'
                   f'<circle cx="{x(week):.1f}" cy="{y(value):.1f}" r="2.6" fill="#1765b3"/>')
    return "".join(out) + "</svg>"


def _page(title: str, body: List[str]) -> str:
    return (f'<!DOCTYPE html><html lang="en"><head><meta charset="utf-8"><title>{html.escape(title)}</title>'
            f"<style>{_STYLE}</style></head><body><h1>{html.escape(title)}</h1>\n" + "\n".join(body) + "\n</body></html>\n")


def _axis_page(trend: AxisTrend) -> str:
    body = [f"<p>{html.escape(trend.sentence[:1].upper() + trend.sentence[1:])}.</p>"]
    for one in trend.series:
        body.append(f"<h2>{name_of(one.size)} [{SIZES[one.size]}]</h2>")
        if one.change:
            body.append(f'<p class="changed">{html.escape(words_of(one))}</p>')
        if trend.is_judged:
            body.append(f"<p>A step of {rounded(one.smallest_visible, 3)} {SIZES[one.size]} is told within four weeks, nine times in ten.</p>")
        body.append(svg_of(one))
    if trend.failed or trend.undated:
        told = [*trend.failed, *trend.undated]
        body.append("<h2>Recordings without an answer</h2><ul>" + "".join(f"<li>{html.escape(s)}</li>" for s in told) + "</ul>")
    body.append("<p>Bars: one standard error of a week. Red ground: since when it changed. Dashed: the week that told it.</p>")
    return _page(trend.axis, body)


def _last(trend: AxisTrend, size: str) -> str:
    one = next((series for series in trend.series if series.size == size), None)
    if one is None:
        return "<td>-</td>"
    text = f"{rounded(one.values[-1], 4)} &plusmn; {rounded(one.standard_errors[-1], 1)}"
    return f'<td class="changed">{text}</td>' if one.change else f"<td>{text}</td>"


def _fleet_page(found: List[AxisTrend], files: List[str], rate: float) -> str:
    changed = sum(any(one.change for one in trend.series) for trend in found)
    judged = sum(trend.is_judged for trend in found)
    short = f" With too few weeks to tell: {len(found) - judged}." if judged < len(found) else ""
    body = [f"<p>{changed} of {judged} axes changed.{short} An axis that did not change is called changed with probability {rate:g} "
            "over its whole series, all its sizes together.</p><table><tr><th>axis</th>"]
    body += [f"<th>{name_of(size)} [{unit}]</th>" for size, unit in SIZES.items()] + ["<th>what changed</th></tr>"]
    for trend, file in zip(found, files):
        body.append(f'<tr><td><a href="{html.escape(file)}">{html.escape(trend.axis)}</a></td>'
                    + "".join(_last(trend, size) for size in SIZES) + f"<td>{html.escape(trend.sentence)}</td></tr>")
    return _page("Fleet", [*body, "</table>"])


def write_pages(found: List[AxisTrend], report: Union[str, os.PathLike], rate: float) -> List[Any]:
    """The page of the fleet at the path given, and one for each axis beside it; their paths."""
    page = pathlib.Path(report)
    files = [f"{page.stem}-{number}-{re.sub(r'[^A-Za-z0-9._-]', '_', one.axis)}.html" for number, one in enumerate(found, 1)]
    for one, file in zip(found, files):
        page.with_name(file).write_text(_axis_page(one), encoding="utf-8")
    page.write_text(_fleet_page(found, files, rate), encoding="utf-8")
    return [page, *(page.with_name(file) for file in files)]
