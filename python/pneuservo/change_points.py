# Where a series of weekly sizes changes: generalised likelihood ratio, with a stated false-alarm rate.
"""Steps and ramps in a series with known and estimated noise, week after week as it comes in.

For each week the likelihood ratio of "a step or a ramp began in week k" against "nothing changed" is largest over k
(Basseville & Nikiforov, Detection of Abrupt Changes, 1993, ch. 2.4). The threshold is the quantile of the largest such
ratio over a whole series without a change, from seeded draws that run through the same code.
"""
import functools
import math
from typing import NamedTuple, Optional, Tuple

import numpy

LEAST_BEFORE = 8  # weeks that say what is normal, and how it scatters
LEAST_AFTER = 2  # one week alone is an outlier
BEYOND = 20  # draws above the threshold: its rate is known to a quarter
REACTION_WEEKS = 4
NINE_IN_TEN = 1.2816  # of the normal distribution
CONFIRMED = 3.0  # sigmas that are left of a change without whichever week speaks most for it
GONE = 2.0  # sigmas below which the last weeks do not show a change any more


class Change(NamedTuple):
    """In which week it was told, since when it is so, by how much, and how many sigmas told it."""

    told_week: int
    since_week: int
    size: float
    standard_error: float
    score: float
    has_gone: bool = False  # the last weeks are as those before it; the size is that of the week that told it


def with_others(standard_errors: numpy.ndarray) -> numpy.ndarray:
    """Errors that are 0 or unknown as those of the other weeks; 0 where none is known."""
    is_known = numpy.isfinite(standard_errors) & (standard_errors > 0)
    others = math.sqrt(float((standard_errors[is_known] ** 2).mean())) if is_known.any() else 0.0
    return numpy.where(is_known, standard_errors, others)


def scatter(values: numpy.ndarray, variances: numpy.ndarray) -> numpy.ndarray:
    """Variance between weeks beyond the known one, of each row: from neighbours (von Neumann), which a trend moves little."""
    differences = numpy.diff(values, axis=-1)
    return numpy.maximum(0.0, (differences ** 2).mean(axis=-1) / 2.0 - variances.mean(axis=-1))


def _shapes(weeks: numpy.ndarray) -> Tuple[numpy.ndarray, numpy.ndarray]:
    """Steps and ramps that begin at each row that leaves enough before and after; and those rows."""
    begins = numpy.arange(LEAST_BEFORE, len(weeks) - LEAST_AFTER + 1)
    since = weeks[None, :] - weeks[begins - 1, None]
    return numpy.concatenate([since > 0, numpy.maximum(since, 0)]).astype(float), numpy.concatenate([begins, begins])


def _fits(values: numpy.ndarray, variances: numpy.ndarray, shapes: numpy.ndarray) -> Tuple[numpy.ndarray, numpy.ndarray]:
    """Amplitude of each shape beside a constant, and its standard error; weighted least squares."""
    weights = 1.0 / variances
    centred = shapes - (shapes @ weights / weights.sum())[:, None]
    information = (centred ** 2) @ weights
    return (centred * weights) @ (values - numpy.average(values, weights=weights)) / information, information ** -0.5


def _largest_in_noise(length: int, draws: int) -> numpy.ndarray:
    """The largest score of whole series of white noise whose scatter is estimated as the data's is."""
    noise = numpy.random.default_rng(length).standard_normal((draws, length))
    largest = numpy.zeros(draws)
    weeks = numpy.arange(length)
    for end in range(LEAST_BEFORE + LEAST_AFTER, length + 1):
        shapes, _ = _shapes(weeks[:end])
        centred = shapes - shapes.mean(axis=1)[:, None]
        scores = noise[:, :end] @ (centred / numpy.sqrt((centred ** 2).sum(axis=1))[:, None]).T
        sigma = numpy.sqrt(scatter(noise[:, :end], numpy.zeros((1, end))))
        largest = numpy.maximum(largest, numpy.abs(scores).max(axis=1) / sigma)
    return numpy.sort(largest)


@functools.lru_cache(maxsize=None)
def threshold(length: int, false_alarm_rate: float) -> float:
    """Score that a series of this length without a change reaches with this probability, once or more."""
    if not 1e-4 <= false_alarm_rate <= 0.5:
        raise ValueError(f"false_alarm_rate: found {false_alarm_rate} a series, expected 0.0001 to 0.5")
    return float(_largest_in_noise(length, math.ceil(BEYOND / false_alarm_rate))[-BEYOND])


def _is_confirmed(values: numpy.ndarray, known: numpy.ndarray, shape: numpy.ndarray, sign: float) -> bool:
    """Whether the change stays without any one week: one week alone is an outlier, whatever its size."""
    for week in range(len(values)):
        rest = numpy.arange(len(values)) != week
        variances = known[rest] + scatter(values[rest], known[rest])
        if (variances > 0).all():
            amplitude, error = _fits(values[rest], variances, shape[None, rest])
            if sign * amplitude[0] < CONFIRMED * error[0]:
                return False
    return True


def _best(weeks: numpy.ndarray, values: numpy.ndarray, standard_errors: numpy.ndarray, limit: float) -> Optional[Change]:
    """The change above the limit that the weeks show best, told in the last of them. None: there is none."""
    known = with_others(standard_errors) ** 2
    variances = known + scatter(values, known)
    if not (variances > 0).all():
        return None  # nothing scatters, nothing to compare with
    shapes, begins = _shapes(weeks)
    amplitudes, errors = _fits(values, variances, shapes)
    scores = numpy.abs(amplitudes) / errors
    for best in numpy.argsort(-scores):
        if scores[best] <= limit:
            break
        if _is_confirmed(values, known, shapes[best], math.copysign(1.0, amplitudes[best])):
            reach = shapes[best, -1]
            return Change(int(weeks[-1]), int(weeks[begins[best]]), float(amplitudes[best] * reach), float(errors[best] * reach),
                          float(scores[best]))
    return None


def _sized(change: Change, weeks: numpy.ndarray, values: numpy.ndarray, standard_errors: numpy.ndarray) -> Change:
    """With the mean of the last weeks beyond that of the weeks before it, whatever the course between."""
    known = with_others(standard_errors) ** 2
    variances = known + scatter(values, known)
    weights = 1.0 / numpy.maximum(variances, numpy.finfo(float).tiny)
    before = weeks < change.since_week
    after = ~before & (weeks > weeks[-1] - REACTION_WEEKS)
    means = [float(numpy.average(values[part], weights=weights[part])) for part in (before, after)]
    error = math.sqrt(sum(1.0 / weights[part].sum() for part in (before, after)))
    return change._replace(size=means[1] - means[0], standard_error=error)


def _is_shown(sized: Change, told: Change) -> bool:
    """Whether a size that was measured anew is that of the change."""
    return math.copysign(1.0, told.size) * sized.size > GONE * sized.standard_error


def first_change(weeks: numpy.ndarray, values: numpy.ndarray, standard_errors: numpy.ndarray,
                 false_alarm_rate: float) -> Optional[Change]:
    """The first change that is told, and its begin, by what was known in that week; its size by the last weeks.

    false_alarm_rate: of the whole series.
    """
    least = LEAST_BEFORE + LEAST_AFTER
    limit = threshold(len(weeks), false_alarm_rate) if len(weeks) >= least else math.inf
    for end in range(least, len(weeks) + 1):
        told = _best(weeks[:end], values[:end], standard_errors[:end], limit)
        if told:
            now = _sized(told, weeks, values, standard_errors)
            if _is_shown(now, told):
                return now
            then = _sized(told, weeks[:end], values[:end], standard_errors[:end])
            return (then if _is_shown(then, told) else told)._replace(has_gone=True)
    return None


def smallest_visible(values: numpy.ndarray, standard_errors: numpy.ndarray, false_alarm_rate: float) -> float:
    """The step that is told within REACTION_WEEKS nine times in ten, with as many weeks before as there are."""
    known = with_others(standard_errors) ** 2
    variance = float(known.mean() + scatter(values, known))
    limit = threshold(max(len(values), LEAST_BEFORE + LEAST_AFTER), false_alarm_rate)
    return (limit + NINE_IN_TEN) * math.sqrt(variance * (1.0 / REACTION_WEEKS + 1.0 / len(values)))
