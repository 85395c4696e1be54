"""What a sweep says of a measure, in sentences and tables; every number is computed."""

from collections.abc import Iterator
from itertools import combinations

import numpy as np

from presswear.recording.statistics import Estimate
from presswear.show.page import NOTHING, Line, Table
from presswear.sweeps.analysis import Analysis
from presswear.sweeps.estimates import as_share
from presswear.sweeps.figures.scales import Scale, scales_of
from presswear.sweeps.spread import PROBABILITIES, Required, Spread
from presswear.sweeps.surface import noise_share
from presswear.tools.numbers import readable, whole

_TOLD = (5, 50, 95)
"""Percentages whose quantiles are told."""


def part(value: float) -> str:
    """A share, in percent."""
    return f"{100.0 * value:.3g} %".replace("-", "−")


def parts(own: Estimate) -> str:
    """A share with its interval, in percent."""
    own = as_share(own)
    if own.low is None or own.high is None:
        return part(own.mean)
    return f"{part(own.mean)} ({part(own.low)} to {part(own.high)})"


def amount(own: Estimate, scale: Scale) -> str:
    """A value with its interval and unit; an end that cannot be told is open."""
    value = NOTHING if np.isnan(own.mean) else scale.told(own.mean)
    if own.low is not None and own.high is not None:
        low, high = (readable(scale.factor * end) for end in (own.low, own.high))
        return f"{value} ({low} to {high})"
    if own.high is not None:
        return f"{value} (at most {scale.told(own.high)})"
    return value if own.low is None else f"{value} (at least {scale.told(own.low)})"


def lines(found: Analysis) -> Iterator[str]:
    """Sentences on a measure."""
    own, key = found.own, found.own.measure.key
    yield f"{own.measure.text[:1].upper()}{own.measure.text[1:]}."
    bounds = int(np.count_nonzero(own.is_beyond))
    if bounds:
        bound = f"At {whole(bounds)} of {whole(len(own.means))} points the value is a lower bound."
        if found.indices or found.screening or found.swings:
            bound += " Shares of the variance and effects take the bound for the value."
        if found.surface or found.rows:
            bound += " The spread takes them for values that may be larger."
        yield bound
    if found.is_constant:
        same = measure_scale(found).told(float(own.means[own.has_value][0]))
        yield f"It is {same} at all points."
        return
    yield _chaos(found)
    for first, second in _together(found):
        yield f"{first} and {second} vary together: what is told of one is told of both."
    if found.indices is not None:
        yield (
            f"The shares of the variance are {found.indices.method}, "
            f"{whole(found.indices.used)} points."
        )
    if found.surface is not None:
        left_out = found.surface.left_out
        logarithm = "the logarithm of " if found.surface.scale == "logarithmic" else ""
        told = noise_share(found.surface)
        chaos = f"; chaos is {part(told)} of it" if told > 0.0 else ""
        yield (
            f"A response surface (a Gaussian process through {logarithm}{key} at "
            f"{whole(len(found.surface.own.means))} points) is good enough: predicted from all "
            f"other points, it explains {part(left_out.explained)} of the variance{chaos}."
        )
    else:
        yield f"{found.refusal[:1].upper()}{found.refusal[1:]}."
    if found.out_of_reach:
        yield f"No spread follows from the surface: {found.out_of_reach}."


def _together(found: Analysis) -> Iterator[tuple[str, str]]:
    """Pairs of factors of which each value of one goes with one value of the other."""
    points, factors = found.own.points, found.own.factors
    counts = [len(np.unique(values)) for values in points.T]
    for first, second in combinations(range(len(factors)), 2):
        both = len(np.unique(points[:, [first, second]], axis=0))
        if not counts[first] == counts[second] == both > 1:
            continue
        # In a sample no value comes twice: there only an order tells that they hang together.
        steps = np.diff(points[np.argsort(points[:, first]), second])
        if both < len(points) or (steps > 0.0).all() or (steps < 0.0).all():
            yield factors[first].key, factors[second].key


def answer(found: Analysis) -> Iterator[str]:
    """What a reader wants to know of a measure first."""
    if found.indices is not None:
        yield _dependence(found)
    scale, strongest = measure_scale(found), found.strongest[0]
    key = found.own.factors[strongest].key
    if found.screening is not None:
        yield (
            f"Of all factors {key} changes {found.own.measure.key} most when it goes up by half of "
            f"its range, by {amount(found.screening[strongest].size, scale)} as a mean."
        )
    swing = None if found.swings is None else found.swings[strongest]
    if swing is not None:
        told = scales_of(found.own.factors, found.own.points)[strongest].told
        yield (
            f"Alone, {key} moves {found.own.measure.key} most: by {amount(swing.at_low, scale)} at "
            f"{told(swing.low)}, by {amount(swing.at_high, scale)} at {told(swing.high)}."
        )
    yield from _spread(found)


def _chaos(found: Analysis) -> str:
    key = found.own.measure.key
    if found.chaos is None:
        told = f"How much of the variance of {key} is chaos cannot be told: "
        if found.own.noise_source == "intervals":
            told += "the intervals of the runs are wider than the runs differ, and "
        told += "it takes several draws at the points (--draws)."
        if found.indices:
            told += " Without it, shares of the variance are of chaos as well."
        return told
    by = {
        "draws": "the scatter of runs at one point that differ by their seed alone",
        "intervals": "as the intervals of the runs themselves tell it",
        "nothing": "",
    }[found.own.noise_source]
    return f"Of the variance of one run of {key} {parts(found.chaos)} is chaos: {by}."


def _dependence(found: Analysis) -> str:
    assert found.indices is not None, "it is asked of those that have them"
    indices, key = found.indices, found.own.measure.key
    told = indices.total or indices.first
    strong = [k for k in found.strongest if (told[k].low or 0.0) > 0.0]
    word = "with others" if indices.total else "alone"
    if not strong:
        listed = f"No factor stands out: the intervals of all shares of {key} reach 0"
    else:
        listed = f"The means of {key} depend on " + "; ".join(
            f"{found.own.factors[k].key}, {word} {parts(told[k])}" for k in strong
        )
        rest = len(told) - len(strong)
        if rest:
            listed += f"; on {rest} other{'s' * (rest > 1)} perhaps not at all"
    return f"{listed}."


def _spread(found: Analysis) -> Iterator[str]:
    told = found.spread or found.rows
    key, scale = found.own.measure.key, measure_scale(found)
    if told is None:
        if found.required is not None:
            yield _counted(found, found.required)
        return
    by = "By the response surface" if found.spread is not None else "By the rows alone"
    five = told.quantile(_TOLD[0])
    if np.isnan(five.mean):
        yield (
            f"{by}, lower bounds leave open which value {key} is below with a probability of "
            f"{_TOLD[0]} %."
        )
    else:
        yield f"{by}, {key} is below {amount(five, scale)} with a probability of {_TOLD[0]} %."
    if found.required is not None and told.misses is not None:
        yield (
            f"{by}, the probability that {key} misses what is required, "
            f"{_wanted(found.required, scale)}, is {parts(told.misses)}"
            f"{_open(found, found.required)}."
        )
    if found.without:
        left = (
            f"{whole(found.without)} of {whole(found.runs)} runs have no value of {key} and are "
            "not in this spread"
        )
        if told.misses is not None:
            share = found.without / found.runs
            left += f"; if all of them miss, {part(share + (1.0 - share) * told.misses.mean)} do"
        yield f"{left}."


def _wanted(required: Required, scale: Scale) -> str:
    return f"{'at least' if required.is_least else 'at most'} {scale.told(required.value)}"


def _counted(found: Analysis, required: Required) -> str:
    """How many points miss what is required, where nothing tells how probable they are."""
    own = found.own
    surely, _ = required.counted(own.means[own.has_value], own.is_beyond[own.has_value])
    return (
        f"{whole(surely)} of {whole(int(own.has_value.sum()))} points miss what is required of "
        f"{own.measure.key}, {_wanted(required, measure_scale(found))}{_open(found, required)}. "
        "How probable a miss is takes a distribution of every factor."
    )


def _open(found: Analysis, required: Required) -> str:
    """How many points do not tell whether they miss, since they are lower bounds."""
    own = found.own
    surely, perhaps = required.counted(own.means[own.has_value], own.is_beyond[own.has_value])
    if perhaps == surely:
        return ""
    return (
        f"; at {whole(perhaps - surely)} of {whole(int(own.has_value.sum()))} points a lower bound "
        "leaves it open"
    )


def measure_scale(found: Analysis) -> Scale:
    """The scale of a measure in texts."""
    return Scale.of(found.own.measure, found.own.means)


def tables(found: Analysis) -> list[tuple[str, Table]]:
    """Tables on a measure with their headings."""
    tables = []
    keys = [own.key for own in found.own.factors]
    order = found.strongest
    if found.indices is not None:
        first, total = found.indices.first, found.indices.total
        head = ("factor", "alone (first order)", *(["with others (total)"] if total else []))
        kinds = [first, *([total] if total else [])]
        rows = tuple((keys[k], *(parts(kind[k]) for kind in kinds)) for k in order)
        tables.append(("Shares of the variance of the means", _table(head, rows)))
    scale = measure_scale(found)
    if found.screening is not None:
        told = found.screening
        head = ("factor", "mean size of the effect", "scatter", "chaos alone")
        rows = tuple(
            (
                keys[k],
                amount(told[k].size, scale),
                amount(told[k].scatter, scale),
                NOTHING if np.isnan(told[k].floor) else scale.told(told[k].floor),
            )
            for k in order
        )
        tables.append(("Effects of jumps by half of the range", _table(head, rows)))
    if found.swings is not None:
        tables.append(("One factor at a time", _swings(found)))
    spreads: dict[str, Spread | None] = {
        "single runs, by the surface": found.spread,
        "means of runs, by the surface": found.mean_spread,
        "single runs, by the rows alone": found.rows,
    }
    told_spreads = {label: own for label, own in spreads.items() if own is not None}
    if told_spreads:
        head = ("", *(f"{100.0 * PROBABILITIES[p - 1]:.0f} % below" for p in _TOLD))
        misses = found.required is not None
        rows = tuple(
            (
                label,
                *(amount(own.quantile(p), scale) for p in _TOLD),
                *([parts(own.misses)] if own.misses is not None else []),
            )
            for label, own in told_spreads.items()
        )
        if misses:
            head = (*head, "misses what is required")
        tables.append(("Spread", _table(head, rows)))
    return tables


def _swings(found: Analysis) -> Table:
    assert found.swings is not None, "it is asked of those that have them"
    scale, factors = measure_scale(found), scales_of(found.own.factors, found.own.points)
    rows = []
    for k in found.strongest:
        swing = found.swings[k]
        key = found.own.factors[k].key
        if swing is None:
            rows.append((key, NOTHING, NOTHING, NOTHING, NOTHING))
            continue
        rows.append(
            (
                key,
                factors[k].told(swing.low),
                amount(swing.at_low, scale),
                factors[k].told(swing.high),
                amount(swing.at_high, scale),
            )
        )
    return _table(("factor", "low", "change", "high", "change"), tuple(rows))


def _table(head: Line, rows: tuple[Line, ...]) -> Table:
    return Table(head, (("", rows),))
