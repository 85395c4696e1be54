"""The head of the report on how long a press lasts: the answer, and how sure it is."""

import math
from dataclasses import dataclass

from presswear.results.life import LifeResult, LimitResult, digits_of, span_of, words_of
from presswear.results.result import Result
from presswear.scene.life import Service
from presswear.scene.scene import Scene
from presswear.show.figures.life import limit_told, services_done
from presswear.show.figures.style import unit_scale
from presswear.show.report.parts import Row, Table
from presswear.tools.numbers import large, readable, whole, with_interval

_NOTHING = "–"


@dataclass(frozen=True)
class LifeHead:
    """What the page says of a life.

    Attributes
    ----------
    answer : str
        In a sentence.
    lines : tuple of str
        What else is to be known.
    limits, causes, passes, phases : Table
    """

    answer: str
    lines: tuple[str, ...]
    limits: Table
    causes: Table | None
    passes: Table
    phases: Table


def life_head(result: Result) -> LifeHead | None:
    """The head on the life of a result; None where it has none."""
    life = result.life
    if life is None:
        return None
    return LifeHead(
        answer(result.scene, life),
        tuple(_lines(result, life)),
        _limits(result.scene, life),
        _causes(result.scene, life) if life.ended == "limit" else None,
        _passes(life),
        _phases(life),
    )


def answer(scene: Scene, life: LifeResult) -> str:
    """How long it lasts, in a sentence."""
    first = life.first
    if life.ended != "limit" or first is None:
        reached = "; ".join(f"{words_of(own.key)} {_reached(own)}" for own in life.limits)
        return (
            f"No limit is passed within {large(life.strokes)} strokes, {_time(scene, life)}; "
            f"reached there: {reached}."
        )
    known = ", how well that is known cannot be told" if life.error is None else ""
    total = span_of(life.strokes, life.total_error)
    worst = max(scene.bearing(name).materials.wear_scatter for name in scene.clearance_joints)
    scatter = (
        f" The wear coefficient itself scatters by {100.0 * worst:g} %: with that, {total} strokes."
    )
    return (
        f"The first limit, {words_of(first.key)} over {limit_told(first)}, is passed after "
        f"{life.words}{known}, {_time(scene, life)}.{scatter if total else ''}"
    )


def _time(scene: Scene, life: LifeResult) -> str:
    rate = 60.0 / scene.mechanism.period
    hours = readable(life.hours(scene), digits_of(life.error))
    return f"{hours} hours at {readable(rate)} strokes a minute"


def _error(limit: LimitResult) -> float | None:
    if limit.sampling is None or limit.step is None:
        return None
    return math.hypot(limit.sampling, limit.step)


def _reached(limit: LimitResult) -> str:
    scale, _ = unit_scale(limit.unit, limit.value)
    return f"{readable(scale * limit.last)} of {limit_told(limit)}"


def _lines(result: Result, life: LifeResult) -> list[str]:
    first = life.first
    found = []
    match life.ended:
        case "at_most":
            found.append("There the wear was followed no further, as was asked (life.at_most).")
        case "worn":
            found.append(f"There the model ends: {life.message}.")
        case "cycles":
            found.append("There the cycles that may run (life.max_cycles) were used up.")
        case "limit" if first is not None and life.interval.high is not None:
            later = [own for own in life.limits if own.strokes is not None and own is not first]
            may = [words_of(own.key) for own in later if _low(own) <= life.interval.high]
            if may:
                found.append(
                    f"Another limit may be the first: the interval of {' and of '.join(may)} "
                    "begins before that of the life ends."
                )
    found += [_service(own) for own in services_done(result)]
    return found


def _service(service: Service) -> str:
    return f"After {large(service.strokes)} strokes: {service.words}."


def _low(limit: LimitResult) -> float:
    assert limit.strokes is not None, "only a limit that is passed has an interval"
    return limit.strokes / math.exp(_error(limit) or 0.0)


def _limits(scene: Scene, life: LifeResult) -> Table:
    """When each limit is passed, and what was reached."""
    rows: list[Row] = []
    for own in life.limits:
        scale, unit = unit_scale(own.unit, own.value)
        half = None if own.last_half_width is None else scale * own.last_half_width
        # A level line has no drift, and no half width that would mean anything.
        is_level = own.last == 0.0 and not half
        last = "no trend seen" if is_level else f"{with_interval(scale * own.last, half)} {unit}"
        name = f"{words_of(own.key)} over {limit_told(own)}"
        if own.strokes is None:
            rows.append((name, "not passed", _NOTHING, _NOTHING, last))
            continue
        error = _error(own)
        hours = own.strokes * scene.mechanism.period / 3600.0
        rows.append(
            (
                name,
                large(own.strokes, digits=digits_of(error)),
                span_of(own.strokes, error) or "not known",
                readable(hours, digits_of(error)),
                last,
            )
        )
    end = large(float(life.curves["strokes"][-1]))
    head = ("limit", "passed after (strokes)", "interval", "hours", f"after {end} strokes")
    return Table(head, (("", tuple(rows)),))


def _causes(scene: Scene, life: LifeResult) -> Table:
    """What the interval of a life holds, each cause apart."""
    causes = {
        f"chance in the motion: {scene.draws} starts differ": life.sampling,
        "step of the wear, by passes in coarser steps": life.step,
        "scatter of the wear coefficients": life.scatter,
        "all together": life.total_error,
    }
    rows = tuple(
        (
            name,
            "not known" if error is None else f"{readable(_percent(error), 2)}",
            span_of(life.strokes, error) or _NOTHING,
        )
        for name, error in causes.items()
    )
    return Table(("cause", "half width (%)", "by it alone (strokes)"), (("", rows),))


def _percent(error: float) -> float:
    """Per cent by which a half width of a logarithm lengthens."""
    return 100.0 * math.expm1(error)


def _passes(life: LifeResult) -> Table:
    rows = tuple(
        (
            str(number),
            readable(100.0 * own.change),
            whole(own.cycles),
            _NOTHING if own.strokes is None else large(own.strokes),
            _NOTHING if own.sampling is None else readable(_percent(own.sampling), 2),
        )
        for number, own in enumerate(life.passes, start=1)
    )
    head = ("pass", "a cycle wears (% of the clearance)", "cycles", "life (strokes)", "chance (%)")
    return Table(head, (("", rows),))


def _phases(life: LifeResult) -> Table:
    rows = tuple(
        (
            f"{own.joint}: {own.name}",
            large(own.since, own.until),
            with_interval(1e15 * own.rate, 1e15 * own.half_width),
        )
        for own in life.phases
    )
    return Table(("wear", "strokes", "mm³ in a million strokes"), (("", rows),))
