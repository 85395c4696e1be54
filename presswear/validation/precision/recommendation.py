"""Recommended settings: the cheapest that is good enough, by a stated rule, and what the code
takes."""

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import product, takewhile
from operator import attrgetter

from presswear.recording.sampling import Interval
from presswear.scene.numerics import Numerics
from presswear.validation.crosscheck.check import (
    CLOSING_BOUND,
    FORCE_BOUND,
    SLIDER_BOUND,
    TIME_BOUND,
)
from presswear.validation.precision.chaos import Chaos, StatisticPoint
from presswear.validation.precision.diagram import Diagram, TaskPoint
from presswear.validation.precision.methods import Method, grouped, method_of
from presswear.validation.precision.statistic import ONE_SIDED, is_for_wear, together
from presswear.validation.precision.study import Precision
from presswear.validation.precision.wear import (
    QUANTITIES,
    TITLES,
    Group,
    WearPoint,
    WearStudy,
    change,
)

TRAJECTORIES = "Trajectories up to the horizon"
STATISTICS = "Statistics of wear"
WEAR = "Wear maps"

BOUNDS = {
    "slider position": SLIDER_BOUND,
    "touch times": TIME_BOUND,
    "closing speeds": CLOSING_BOUND,
    "peak forces": FORCE_BOUND,
}
"""Errors that trajectories may have up to the horizon: those that the cross-check allows."""

WEAR_BOUND = 0.2
"""Part by which wear may be wrong: twice the tolerance to which scenes know their maps."""

RULES = {
    TRAJECTORIES: "the cheapest setting that keeps the bounds of the cross-check up to the "
    f"horizon: slider {SLIDER_BOUND:g} m, touch times {TIME_BOUND:g} s, closing speeds "
    f"{CLOSING_BOUND:g} and peak forces {FORCE_BOUND:g} relative; all finer settings of its "
    "family have to keep them too, so that none is taken for its luck",
    STATISTICS: "the cheapest setting whose step error in wear total and wear map is not seen "
    "(95 %, all statistics together) and, at the largest that the cycles allow (95 %), is below "
    "the sampling error of a stage that the scene ends by itself",
    WEAR: "the coarsest value from which on no depth and no volume of the first wear differs from "
    f"the finest's for certain (95 %, all together), or may differ by {100.0 * WEAR_BOUND:.0f} % "
    "or more (95 %)",
}
"""By purpose."""


@dataclass(frozen=True)
class Recommendation:
    """The setting to take for a purpose.

    Attributes
    ----------
    purpose : str
        A key of RULES.
    subject : str
        The engine, or what is chosen for wear maps.
    recommended : str
        In words; empty where nothing meets the rule.
    taken : str
        The setting that the code takes, in words.
    agrees : bool or None
        True where that is the same; None where there is nothing to compare with.
    meets : bool or None
        True where what the code takes meets the rule, if at a higher price.
    detail : str
        Errors and times of both, in words.
    """

    purpose: str
    subject: str
    recommended: str
    taken: str
    agrees: bool | None
    meets: bool | None
    detail: str

    @property
    def verdict(self) -> str:
        """Judgement on what the code takes, in words."""
        if self.agrees:
            return "the code takes it"
        if self.agrees is None or not self.recommended:
            return f"the code takes {self.taken}"
        word = "meets the rule as well" if self.meets else "does not"
        return f"the code takes another that {word}: {self.taken}"


def is_same(one: Method, other: Method) -> bool:
    """True where two methods are one setting of one engine."""
    return (one.family, one.knob) == (other.family, other.knob) and math.isclose(
        one.value, other.value, rel_tol=1e-6
    )


def _of_engine(
    purpose: str,
    engine: str,
    best: TaskPoint | StatisticPoint | None,
    taken: Method | None,
    nothing: str,
    meets: bool | None,
    details: Iterable[str],
) -> Recommendation:
    """Recommend a method of an engine; ``nothing`` says that the code takes none of its own."""
    return Recommendation(
        purpose,
        engine,
        "" if best is None else best.method.setting,
        nothing if taken is None else taken.setting,
        None if taken is None else best is not None and is_same(best.method, taken),
        meets,
        "; ".join(details),
    )


def good_points(points: Sequence[TaskPoint], bounds: Mapping[str, float]) -> list[TaskPoint]:
    """The points of a family, coarse to fine, from which on all ran and keep all bounds."""

    def is_good(point: TaskPoint) -> bool:
        errors = ((point.errors.get(name, math.inf), bound) for name, bound in bounds.items())
        return not point.failure and all(error <= bound for error, bound in errors)

    found = takewhile(is_good, reversed(points))
    return [point for point in found if point.timing is not None]


def for_trajectories(
    diagram: Diagram, bounds: Mapping[str, float] = BOUNDS
) -> Iterator[Recommendation]:
    """Recommend for each engine in a diagram of trajectories up to the horizon.

    Parameters
    ----------
    bounds : mapping of str to float
        By quantity; those that the diagram does not have do not count.
    """
    bounds = {own.name: bounds[own.name] for own in diagram.quantities if own.name in bounds}
    if not bounds:
        return
    for engine, points in grouped(diagram.points, attrgetter("engine.word")).items():
        good = [p for family in grouped(points).values() for p in good_points(family, bounds)]
        best = min(good, key=_wall, default=None)
        taken = next((point for point in points if point.method.is_default), None)
        details = [] if best is None else [_point_words(best, bounds)]
        if taken is not None and taken is not best:
            details.append(f"what is taken: {_point_words(taken, bounds)}")
        yield _of_engine(
            TRAJECTORIES,
            engine,
            best,
            None if taken is None else taken.method,
            "nothing of this diagram",
            None if taken is None else any(point is taken for point in good),
            details,
        )


def _wall(point: TaskPoint) -> float:
    return math.inf if point.timing is None else point.timing.wall


def _point_words(point: TaskPoint, bounds: Mapping[str, float]) -> str:
    """Time of a point, and how near it comes to the bound that is nearest."""
    if point.failure:
        return f"failed: {point.failure}"
    parts = {name: point.errors.get(name, math.nan) / bound for name, bound in bounds.items()}
    nearest = max(parts, key=lambda name: parts[name])
    return f"{1e3 * _wall(point):.3g} ms, {nearest} at {parts[nearest]:.2g} of its bound"


def for_statistics(chaos: Chaos, taken: Iterable[Method]) -> Iterator[Recommendation]:
    """Recommend for each engine with statistics.

    Parameters
    ----------
    taken : iterable of Method
        Methods that the code takes, one an engine.
    """
    by_engine = {method.engine.word: method for method in taken}
    for engine, points in grouped(chaos.points, attrgetter("engine.word")).items():
        best, own = chaos.cheapest(points), by_engine.get(engine)
        same = next((p for p in points if own is not None and is_same(p.method, own)), None)
        details = [] if best is None else [f"{best.cost:.2g} s for a simulated second"]
        if same is not None and same is not best:
            details.append(f"what is taken: {same.cost:.2g} s, {standing(chaos, same)}")
        meets = None if same is None else chaos.is_honest(same)
        yield _of_engine(STATISTICS, engine, best, own, "nothing of its own", meets, details)


def standing(chaos: Chaos, point: StatisticPoint) -> str:
    """Say that a setting is honest for wear, or why it is not."""
    if point.failure:
        return f"failed: {point.failure}"
    wear = [name for name in chaos.names if is_for_wear(name)]
    seen = [name for name in wear if point.step_errors[name].is_seen]
    if seen:
        return f"step error seen in {', '.join(seen)}"
    short = [name for name in wear if not chaos.honest_cycles(point, name) >= chaos.stage_cycles]
    if short:
        return f"no step error seen, but too few cycles to exclude one in {', '.join(short)}"
    fewest = min(chaos.honest_cycles(point, name) for name in wear)
    return "honest" if math.isinf(fewest) else f"honest up to {fewest:.0f} cycles"


GROUPS: tuple[Group, ...] = ("angles", "cycles")
"""Groups that have a finest value."""


def for_wear(wear: WearStudy) -> Iterator[Recommendation]:
    """Recommend for each numerical choice of wear maps, under each set of conventions."""
    for group, conventions in product(GROUPS, wear.conventions):
        points = wear.of(group, conventions)
        if len(points) > 1:
            yield _wear_choice(f"{TITLES[group]}, {conventions} conventions", points)


def _wear_choice(subject: str, points: Sequence[WearPoint]) -> Recommendation:
    *coarser, finest = points

    def is_good(point: WearPoint) -> bool:
        return not (point.failure or finest.failure) and is_alike(point, finest)

    good = list(takewhile(is_good, reversed(coarser)))
    best = good[-1].varied.label if good else ""
    taken = next((point for point in points if point.varied.is_default), None)
    moves = changes(good[-1] if good else coarser[-1], finest).items()
    known = [(name, moved.value) for name, moved in moves if math.isfinite(moved.value)]
    detail = ""
    if known:
        name, moved = max(known, key=lambda one: abs(one[1]))
        word = "largest change from" if good else f"{coarser[-1].varied.label} differs from"
        detail = f"{word} {finest.varied.label}: {100.0 * moved:+.0f} % in {name}"
    is_cycles = finest.varied.group == "cycles"
    usual = "as many as the wear maps' tolerance takes" if is_cycles else "another"
    return Recommendation(
        WEAR,
        subject,
        best,
        usual if taken is None else taken.varied.label,
        None if taken is None else best == taken.varied.label,
        None if taken is None else bool(good) and any(p is taken for p in (*good, finest)),
        detail,
    )


def changes(point: WearPoint, finest: WearPoint) -> dict[str, Interval]:
    """Relative change of each first wear from the finest's, 95 % for all together."""
    wanted = [
        (joint, name) for joint in finest.first if joint in point.first for name in QUANTITIES
    ]
    found = {}
    for joint, name in wanted:
        moved = change(point.first[joint][name], finest.first[joint][name])
        if moved.low is not None and moved.high is not None:
            widening = together(len(wanted))
            moved = Interval(
                moved.value,
                moved.value - widening * (moved.value - moved.low),
                moved.value + widening * (moved.high - moved.value),
            )
        found[f"{name} at {joint}"] = moved
    return found


def is_alike(point: WearPoint, finest: WearPoint) -> bool:
    """True where no first wear differs from the finest's for certain, or may by WEAR_BOUND."""
    found = changes(point, finest)

    def is_small(moved: Interval) -> bool:
        if moved.low is None or moved.high is None or not moved.low <= 0.0 <= moved.high:
            return False
        # One of several changes does not exceed this, at 95 %.
        half = ONE_SIDED * (moved.high - moved.value) / together(len(found))
        return abs(moved.value) + half < WEAR_BOUND

    return bool(found) and all(map(is_small, found.values()))


def recommend(precision: Precision, taken: Numerics) -> tuple[Recommendation, ...]:
    """Give all recommendations.

    Parameters
    ----------
    taken : Numerics
        Engines that the study of the paper takes for statistics.
    """
    diagrams = [diagram for diagram in precision.diagrams if diagram.key == "horizon"]
    found = [one for diagram in diagrams for one in for_trajectories(diagram)]
    taken = taken.resolved("wear", precision.scene.tolerance)
    tree = taken.tree.over(precision.scene.mechanism.period)
    own = (method_of(tree, tree), method_of(taken.dae, taken.dae))
    return (*found, *for_statistics(precision.chaos, own), *for_wear(precision.wear))
