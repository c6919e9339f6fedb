# An axis over months: its sizes week by week, what changed and since when, as pages.
"""python -m pneuservo.trend RESULTS... --report page.html [--false-alarm-rate RATE]

RESULTS: folders or Parquet files of pneuservo.fleet. Writes the page of the fleet, and beside it one for each axis.
"""
import argparse
import datetime
import math
import os
import pathlib
import sys
from typing import Any, Dict, Iterable, List, NamedTuple, Optional, Tuple, Union

import numpy

from .change_points import LEAST_AFTER, LEAST_BEFORE, Change, first_change, smallest_visible, with_others
from .errors import InputError
from .sizes import SIZES

LEAST_WEEKS = LEAST_BEFORE + LEAST_AFTER
FALSE_ALARM_RATE = 0.004  # of an axis, all its sizes together, over the whole series: one in 250


class Series(NamedTuple):
    """One size of one axis, a value a week."""

    size: str
    weeks: numpy.ndarray  # Mondays, in weeks since 1970
    values: numpy.ndarray
    standard_errors: numpy.ndarray  # 0: not known of any week
    change: Optional[Change]
    smallest_visible: float


class AxisTrend(NamedTuple):
    """What is known of one axis."""

    axis: str
    series: List[Series]
    failed: List[str]
    undated: List[str] = []  # a sentence each recording that was left out for its date

    @property
    def weeks(self) -> int:
        """Of the longest series."""
        return max((len(one.weeks) for one in self.series), default=0)

    @property
    def is_judged(self) -> bool:
        """Whether there are weeks enough to tell a change."""
        return self.weeks >= LEAST_WEEKS

    @property
    def sentence(self) -> str:
        """What changed, that nothing did, or that nobody can say yet."""
        if not self.is_judged:
            return f"too short: {self.weeks} of {LEAST_WEEKS} weeks"
        changed = [words_of(one) for one in self.series if one.change]
        return "; ".join(changed) if changed else "no change"


def week_of(date: str) -> int:
    """Weeks since the Monday of 1970-01-01."""
    return (datetime.date.fromisoformat(date).toordinal() - datetime.date(1969, 12, 29).toordinal()) // 7


def monday_of(week: int) -> str:
    """The date on which a week begins."""
    return (datetime.date(1969, 12, 29) + datetime.timedelta(weeks=int(week))).isoformat()


def name_of(size: str) -> str:
    """friction_N as friction, for a reader."""
    return size.rsplit("_", 1)[0].replace("_", " ")


def rounded(value: float, digits: int) -> str:
    """A number to so many digits, without an exponent where it needs none."""
    return f"{float(f'{value:.{digits}g}'):.6g}"


def words_of(series: Series) -> str:
    """The change in a sentence."""
    change = series.change
    assert change is not None
    verb = {(False, False): "falls since", (True, False): "rises since", (False, True): "fell in the week of",
            (True, True): "rose in the week of"}[change.size > 0, change.has_gone]
    return (f"{name_of(series.size)} {verb} {monday_of(change.since_week)} by {rounded(abs(change.size), 3)} +- "
            f"{rounded(change.standard_error, 1)} {SIZES[series.size]} (told {monday_of(change.told_week)})"
            + (", and is as before by now" if change.has_gone else ""))


def read_results(sources: Iterable[Union[str, os.PathLike]]) -> Any:
    """The rows of fleets as one DataFrame. Raises InputError."""
    import pandas

    frames = []
    for source in map(pathlib.Path, sources):
        path = source / "results.parquet" if source.is_dir() else source
        try:
            frame = pandas.read_parquet(path)
        except (OSError, ValueError) as error:
            raise InputError(f"{path}: found no table of results, expected one of python -m pneuservo.fleet ({error})") from None
        lacking = {"axis", "date", "status", "sentence"} - set(frame.columns)
        if len(frame) and lacking:
            raise InputError(f"{path}: found no column {', '.join(sorted(lacking))}, expected a table of python -m pneuservo.fleet")
        frames.append(frame)
    return pandas.concat(frames, ignore_index=True)


def _dated(rows: Any) -> Tuple[Any, List[str]]:
    """The rows whose date is one, and a sentence for each of the others."""
    def is_date(text: Any) -> bool:
        try:
            return week_of(text) is not None
        except (TypeError, ValueError):
            return False

    has_date = numpy.array([is_date(date) for date in rows["date"]], dtype=bool)
    left_out = rows[~has_date].to_dict("records")
    return rows[has_date], [f"{row.get('recording', row['axis'])}: left out: found the date '{row['date']}', expected one "
                            "such as 2026-03-30" for row in left_out]


def _weekly(rows: Any, size: str) -> List[numpy.ndarray]:
    """Weeks, values and standard errors; of several recordings in a week the mean by their information.

    NaN is the error of a week in which that of a recording is not known, or 0.
    """
    by_week: Dict[int, List[List[float]]] = {}
    for row in rows.to_dict("records"):
        value, error = float(row.get(size, math.nan)), float(row.get(f"{size}_standard_error", math.nan))
        if not math.isfinite(error):
            # Not named: it may be anything up to the smallest size that would have shown, all of it as likely.
            error = float(row.get(f"{size}_smallest_visible", math.nan)) / math.sqrt(3.0)
        if math.isfinite(value):
            by_week.setdefault(week_of(row["date"]), []).append([value, error if error > 0 else math.nan])
    weeks = sorted(by_week)
    values, errors = [], []
    for week in weeks:
        found = numpy.array(by_week[week])
        weights = 1.0 / found[:, 1] ** 2 if numpy.isfinite(found[:, 1]).all() else numpy.ones(len(found))
        values.append(float(numpy.average(found[:, 0], weights=weights)))
        errors.append(float(math.sqrt((weights ** 2 @ found[:, 1] ** 2)) / weights.sum()))
    return [numpy.array(weeks, dtype=int), numpy.array(values), numpy.array(errors)]


def trend_of(axis: str, rows: Any, false_alarm_rate: float = FALSE_ALARM_RATE) -> AxisTrend:
    """The trend of one axis from its rows. false_alarm_rate: of all its sizes together."""
    series = []
    done, undated = _dated(rows[rows["status"] == "done"])
    each = false_alarm_rate / len(SIZES)
    for size in SIZES:
        weeks, values, errors = _weekly(done, size)
        if len(weeks):
            series.append(Series(size, weeks, values, with_others(errors), first_change(weeks, values, errors, each),
                                 smallest_visible(values, errors, each) if len(weeks) > 1 else math.nan))
    return AxisTrend(axis, series, list(rows.loc[rows["status"] != "done", "sentence"]), undated)


def trends(frame: Any, false_alarm_rate: float = FALSE_ALARM_RATE) -> List[AxisTrend]:
    """The trend of each axis; those that changed come first."""
    found = [trend_of(str(axis), rows, false_alarm_rate) for axis, rows in frame.groupby("axis")] if len(frame) else []
    return sorted(found, key=lambda one: (all(series.change is None for series in one.series), one.axis))


def main(arguments: List[str]) -> int:
    """The command; its exit status."""
    from .trend_page import write_pages

    parser = argparse.ArgumentParser(prog="python -m pneuservo.trend", description="Axes over months: what changed, and since when.")
    parser.add_argument("results", nargs="+", metavar="RESULTS", help="folders or Parquet files of pneuservo.fleet")
    parser.add_argument("--report", required=True, metavar="PAGE.html", help="page of the fleet; those of the axes stand beside it")
    parser.add_argument("--false-alarm-rate", type=float, default=FALSE_ALARM_RATE, metavar="RATE",
                        help=f"of an axis over its whole series; default: {FALSE_ALARM_RATE}")
    given = parser.parse_args(arguments)
    try:
        found = trends(read_results(given.results), given.false_alarm_rate)
        for path in write_pages(found, given.report, given.false_alarm_rate):
            print(f"written: {path}")
    except (InputError, OSError, ValueError) as error:
        print(f"trend: {error}", file=sys.stderr)
        return 2
    for one in found:
        for sentence in one.undated:
            print(f"trend: {sentence}", file=sys.stderr)
        print(f"{one.axis}: {one.sentence}")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
