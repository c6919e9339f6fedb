# Change points keep their stated false-alarm rate, find steps and ramps when they begin; pages show them.
import re

import numpy
import pandas
import pytest

from pneuservo import InputError, change_points, trend
from pneuservo.trend_page import svg_of, write_pages

WEEKS = numpy.arange(20)
RATE = 0.05


def noise(seed, rows=1, sigma=1.0):
    return sigma * numpy.random.default_rng(seed).standard_normal((rows, len(WEEKS)))


def test_series_without_a_change_are_told_as_often_as_stated():
    found = sum(change_points.first_change(WEEKS, row, numpy.zeros(20), RATE) is not None for row in noise(7, 400, 3.0))
    assert 8 <= found <= 34  # 20 are expected; the binomial leaves this range once in a thousand


def test_known_errors_make_no_alarms_more():
    errors = numpy.where(WEEKS % 2, 0.5, 2.0)
    found = sum(change_points.first_change(WEEKS, row * errors, errors, RATE) is not None for row in noise(8, 200))
    assert found <= 20  # at most 10 are expected


@pytest.mark.parametrize("shape, size", [(WEEKS >= 12, 8.0), (numpy.clip(WEEKS - 11, 0, 4), 12.0)])
def test_steps_and_ramps_are_told_with_their_week_and_size(shape, size):
    shape = shape / shape.max()
    change = change_points.first_change(WEEKS, 5.0 + size * shape + noise(3)[0], numpy.full(20, 0.2), RATE)
    assert abs(change.since_week - 12) <= 2 and change.since_week < change.told_week <= 18
    assert abs(change.size - size) < 4.0 * change.standard_error
    later = change_points.first_change(WEEKS, 5.0 + 0.0 * WEEKS + noise(3)[0], numpy.full(20, 0.2), RATE)
    assert later is None


def test_the_smallest_visible_step_is_told_within_four_weeks():
    told = 0
    for row in noise(11, 100):
        step = change_points.smallest_visible(row[:16], numpy.zeros(16), RATE)
        change = change_points.first_change(WEEKS, row + 1.15 * step * (WEEKS >= 16), numpy.zeros(20), RATE)
        told += change is not None
    assert told >= 80  # of 100; 90 are meant at the step itself


def rows(axis, leak, seed, first="2026-01-05"):
    dates = pandas.date_range(first, periods=len(WEEKS), freq="7D").strftime("%Y-%m-%d")
    friction = 6.0 + noise(seed, 1, 0.1)[0]
    return pandas.DataFrame({"axis": axis, "date": dates, "status": "done", "sentence": "", "recording": dates,
                             "friction_N": friction, "friction_N_standard_error": 0.08,
                             "leak_nlpm": leak, "leak_nlpm_standard_error": numpy.where(leak > 0, 0.01, numpy.nan),
                             "leak_nlpm_smallest_visible": 0.2})


@pytest.fixture
def table(tmp_path):
    leak = numpy.where(WEEKS >= 13, 0.5, 0.0)
    bad = pandas.DataFrame([{"axis": "press <1>", "date": "", "status": "failed", "sentence": "run.csv: found no column t_s"}])
    frame = pandas.concat([rows("press <1>", leak, 21), bad, rows("feeder", 0.0 * WEEKS, 22)], ignore_index=True)
    frame.to_parquet(tmp_path / "results.parquet")
    return tmp_path


def test_pages_name_the_axis_that_changed_and_since_when(table):
    found = trend.trends(trend.read_results([table]), RATE)
    assert [one.axis for one in found] == ["press <1>", "feeder"]
    assert re.match(r"leak rises since 2026-0(3-30|4-06) by 0.5 \+- \S+ Nl/min \(told 2026-04-\d\d\)$", found[0].sentence)
    assert found[1].sentence == "no change"
    page, pressed, feeder = write_pages(found, table / "fleet.html", RATE)
    assert "1 of 2 axes changed" in page.read_text() and pressed.name in page.read_text()
    text = pressed.read_text()
    assert "press &lt;1&gt;" in text and "run.csv: found no column t_s" in text
    leak = next(one for one in found[0].series if one.size == "leak_nlpm")
    assert svg_of(leak) in text and svg_of(leak).count("<circle") == 20 and "stroke-dasharray" in svg_of(leak)
    assert "stroke-dasharray" not in feeder.read_text()


def test_an_axis_with_few_weeks_is_not_called_unchanged(table, capsys):
    frame = pandas.read_parquet(table / "results.parquet")
    frame = frame[(frame["axis"] != "feeder") | (frame["date"] < "2026-01-19")]
    frame.to_parquet(table / "results.parquet")
    found = trend.trends(frame, RATE)
    assert [one.sentence for one in found][1] == "too short: 2 of 10 weeks"
    page, _, feeder = write_pages(found, table / "fleet.html", RATE)
    assert "1 of 1 axes changed. With too few weeks to tell: 1." in page.read_text()
    assert "Too short: 2 of 10 weeks." in feeder.read_text() and "A step of" not in feeder.read_text()
    assert trend.main([str(table), "--report", str(table / "page.html")]) == 0
    assert "feeder: too short: 2 of 10 weeks" in capsys.readouterr().out


def test_weeks_with_several_recordings_count_by_their_information():
    frame = pandas.concat([rows("a", 0.0 * WEEKS, 5)] * 2, ignore_index=True)
    weeks, values, errors = trend._weekly(frame, "friction_N")
    assert len(weeks) == 20 and errors == pytest.approx(0.08 / 2 ** 0.5)
    assert trend.monday_of(weeks[0]) == "2026-01-05" and trend.week_of("2026-01-11") == weeks[0]


def test_what_is_no_table_is_told(tmp_path, capsys):
    with pytest.raises(InputError, match="found no table of results, expected one of python -m pneuservo.fleet"):
        trend.read_results([tmp_path])
    assert trend.main([str(tmp_path), "--report", str(tmp_path / "page.html")]) == 2
    assert "trend: " in capsys.readouterr().err


@pytest.mark.parametrize("size", [0.5, 3.0, 1e3])
def test_one_week_alone_is_an_outlier_at_any_size(size):
    weeks = numpy.arange(52)
    for seed in range(20):
        draw = numpy.random.default_rng(seed)
        values = 6.0 + 0.08 * draw.standard_normal(52)
        values[draw.integers(5, 52)] += size
        assert change_points.first_change(weeks, values, numpy.full(52, 0.08), 0.001) is None, seed
        values[26:] += 3.0 * size  # a change beside it is told
        assert change_points.first_change(weeks, values, numpy.full(52, 0.08), 0.001), seed


def test_a_change_that_has_gone_is_told_with_the_size_that_it_had():
    shape = (WEEKS >= 9) & (WEEKS < 14)
    errors = numpy.full(20, 0.2)
    change = change_points.first_change(WEEKS, 5.0 + 3.0 * shape + noise(3, 1, 0.2)[0], errors, RATE)
    assert change.has_gone and change.size == pytest.approx(3.0, abs=0.5)
    words = trend.words_of(trend.Series("friction_N", WEEKS, 0.0 * WEEKS, errors, change, 1.0))
    assert words.startswith("friction rose in the week of ") and words.endswith(", and is as before by now")


@pytest.mark.parametrize("unknown", [0.0, numpy.nan])
def test_a_week_without_an_error_counts_as_the_others(unknown):
    errors = numpy.full(20, 0.2)
    errors[15] = unknown
    assert change_points.with_others(errors) == pytest.approx(0.2)
    for row in noise(5, 50, 0.2):
        assert change_points.first_change(WEEKS, row, errors, 0.001) is None
    frame = rows("a", 0.0 * WEEKS, 5)
    frame.loc[3, "friction_N_standard_error"] = unknown
    _, _, weekly = trend._weekly(frame, "friction_N")
    assert numpy.isnan(weekly[3]) and weekly[4] == 0.08


def test_a_recording_whose_date_is_none_is_left_out_and_told(table, capsys):
    frame = pandas.read_parquet(table / "results.parquet")
    frame.loc[2, "date"] = "2026-13-45"
    frame.to_parquet(table / "results.parquet")
    assert trend.main([str(table), "--report", str(table / "page.html")]) == 0
    told = capsys.readouterr()
    assert "found the date '2026-13-45', expected one such as 2026-03-30" in told.err and "leak rises since" in told.out
    assert "2026-13-45" in (table / "page-1-press__1_.html").read_text()
