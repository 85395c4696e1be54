"""Section of a report on the service life."""

import math

from presswear.linkage.surface import SIDES
from presswear.results.life import (
    WITHOUT_CURVES,
    LifeResult,
    LimitResult,
    digits_of,
    span_of,
    words_of,
)
from presswear.results.life_from_readings import remaining_life
from presswear.results.motor_load import mean_period
from presswear.results.readings import FILE as READINGS
from presswear.results.result import Result
from presswear.show.figures.life import limit_text, services_done
from presswear.show.page import NOTHING, Line
from presswear.show.tables import Record, line_table
from presswear.tools import numbers
from presswear.tools.errors import InputError
from presswear.tools.numbers import MM3_PER_MILLION


def life_section(result: Result, life: LifeResult) -> Record:
    """Return the values of the section on the service life in ``report.html``."""
    first = life.first if life.ended in ("limit", *WITHOUT_CURVES) else None
    period = mean_period(result)
    limits = [_limit_line(period, limit) for limit in life.limits]
    wear_rates = []
    for rate in life.wear_rates:
        span = numbers.large(rate.since, rate.until)
        volume = MM3_PER_MILLION * rate.rate
        half_width = MM3_PER_MILLION * rate.half_width
        value = numbers.with_interval(volume, half_width)
        wear_rates.append((f"{rate.joint}: {rate.surfaces}", span, value))
    last = float(life.curves["strokes"][-1]) if life.curves else life.strokes
    end = numbers.large(last)
    return {
        "result": life,
        "period": period,
        "first": first,
        "rivals": [] if first is None else _rivals_of(first, life),
        "services": services_done(result),
        "repeating": _repeating(life),
        "pin": _pin_that_ends(result, life),
        "remaining": _remaining(result),
        "limits": line_table("limits", result, limits, numeric=True, end=end),
        "wear_rates": line_table(
            "wear_rates", result, wear_rates, numeric=True, end=end
        ),
    }


def _rivals_of(first: LimitResult, life: LifeResult) -> list[str]:
    """Return the limits that may be exceeded before the first one, in words."""
    latest = life.interval.high or 0.0
    rivals = []
    for limit in life.limits:
        if limit is not first and limit.strokes is not None:
            earliest = limit.strokes / math.exp(limit.error or 0.0)
            if earliest <= latest:
                rivals.append(words_of(limit.key))
    return rivals


def _remaining(result: Result) -> tuple[str, ...]:
    """Return lines on the remaining life, computed from the readings in the result folder."""
    if result.path is None or not (result.path / READINGS).exists():
        return ()
    try:
        return remaining_life(result, result.path / READINGS).lines
    except InputError as error:
        return (f"{error}",)


def _repeating(life: LifeResult) -> str:
    """Return a sentence on the load blocks after which most wear histories repeat, or nothing."""
    counts = [settled for settled in life.settled if settled is not None]
    if not any(counts):
        return ""
    most = max(counts)
    blocks = numbers.counted(len(counts), "load block")
    return (
        f"At the end of {counts.count(most)} of {blocks} {most} wear histories repeat."
    )


def _pin_that_ends(result: Result, life: LifeResult) -> str:
    """Return a sentence if a pin ends a life in which only its bushing was serviced, or nothing."""
    first = life.first
    stages = result.stages
    joint, _, name = first.key.partition(".") if first else ("", "", "")
    serviced = {service.joint for service in services_done(result)}
    is_complete = len(stages) == result.scene.wear_updates + 1
    if life.ended != "limit" or not is_complete or stages[-1].failed:
        return ""
    is_serviced_pin = joint in serviced and joint in result.scene.loose_pins
    if name != "depth" or not is_serviced_pin:
        return ""
    end = stages[-1].joints[joint]  # on the surfaces at the end of the life
    bearing_depth, pin_depth = (float(end.depth(side).max()) for side in SIDES)
    if pin_depth <= bearing_depth:
        return ""
    bearing = numbers.quantity_text(bearing_depth, "m")
    pin = numbers.quantity_text(pin_depth, "m")
    return (
        f"The pin of {joint} ends this life: it is worn by {pin} at the end, its bushing by "
        f"{bearing}. A new or rotated bushing does not renew the pin."
    )


def _limit_line(period: float, limit: LimitResult) -> Line:
    """Return the line of a limit; ``period`` is the mean duration of a stroke, s."""
    factor, unit = numbers.unit_scale(limit.unit, limit.value)
    half = None if limit.last_half_width is None else factor * limit.last_half_width
    # A level curve has no drift and no meaningful half width.
    is_level = limit.last == 0.0 and not half
    last = (
        "no trend"
        if is_level
        else f"{numbers.with_interval(factor * limit.last, half)} {unit}"
    )
    name = f"{words_of(limit.key)} over {limit_text(limit)}"
    if limit.strokes is None:
        return name, "not exceeded", NOTHING, NOTHING, last
    error = limit.error
    digits = digits_of(error)
    hours = limit.strokes * period / 3600.0
    interval = span_of(limit.strokes, error) or "unknown"
    strokes = numbers.large(limit.strokes, digits=digits)
    return name, strokes, interval, numbers.readable(hours, digits), last
