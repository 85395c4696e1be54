"""What to take: the cheapest setting that is good enough, by a stated rule, and what the
code takes."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from presswear.engines.base import DaeAccuracy, TreeAccuracy
from presswear.numerics import Numerics
from presswear.paper.variants import base_scene
from presswear.precision.chaos import Chaos, StatisticPoint
from presswear.precision.growth import PARTED
from presswear.precision.ladder import dae_method, tree_method
from presswear.precision.points import Diagram, Method, Point
from presswear.precision.statistic import is_for_wear, together
from presswear.precision.wear import QUANTITIES, TITLES, Group, WearPoint, WearStudy, change
from presswear.sampling import Interval
from presswear.scene import Scene

TRAJECTORIES = "trajectories up to the horizon"
STATISTICS = "statistics of wear"
WEAR = "wear maps"

BOUND = PARTED
"""Error of the slider's position that trajectories may have up to the horizon, m: what a
disturbance of 1e-9 m at the start has become there."""

RULES = {
    TRAJECTORIES: f"the cheapest setting whose slider is wrong by at most {BOUND:g} m up to the "
    "horizon, which is what a start moved by 1e-9 m makes of it; all finer settings of its "
    "family have to be as good, so that none is taken for its luck",
    STATISTICS: "the cheapest setting whose step error in wear total and wear map is not seen "
    "(95 %, all statistics together) and, at the largest that the cycles allow (95 %), is below "
    "the sampling error of a stage that the scene ends by itself",
    WEAR: "the coarsest value from which on no wear of the first one differs for certain (95 %, "
    "all together) from that of the finest",
}
"""By purpose."""


@dataclass(frozen=True)
class Recommendation:
    """What to take for a purpose.

    Attributes
    ----------
    purpose : str
        A key of RULES.
    subject : str
        The engine, or what is chosen for wear maps.
    recommended : str
        In words; empty where nothing meets the rule.
    taken : str
        What the code takes, in words.
    agrees : bool or None
        Whether that is the same; None where there is nothing to compare with.
    detail : str
        Errors and times of both, in words.
    """

    purpose: str
    subject: str
    recommended: str
    taken: str
    agrees: bool | None
    detail: str

    @property
    def verdict(self) -> str:
        """Whether the code takes it, in words."""
        if not self.recommended:
            return f"nothing can be recommended; the code takes {self.taken}"
        if self.agrees is None:
            return f"the code takes {self.taken}"
        return "the code takes it" if self.agrees else f"the code takes another: {self.taken}"

    @property
    def sentence(self) -> str:
        """All of it in a sentence."""
        what = self.recommended or "none"
        detail = f" ({self.detail})" if self.detail else ""
        return f"{self.subject}: {what}{detail}; {self.verdict}."


def is_same(one: Method, other: Method) -> bool:
    """Whether two methods are one setting of one engine."""
    return (one.engine, one.integrator, one.knob) == (
        other.engine,
        other.integrator,
        other.knob,
    ) and math.isclose(one.value, other.value, rel_tol=1e-6)


def described(method: Method) -> str:
    """A method without its engine."""
    return method.label.removeprefix(f"{method.engine}, ")


def quantity_of(diagram: Diagram) -> str | None:
    """The slider's position among a diagram's quantities: the first length."""
    return next((name for name, unit in diagram.quantities.items() if unit == "m"), None)


def is_good(point: Point, quantity: str, bound: float) -> bool:
    """Whether a point ran and its error is within a bound."""
    return not point.failure and point.errors.get(quantity, math.inf) <= bound


def good_points(points: Sequence[Point], quantity: str, bound: float) -> list[Point]:
    """The points of a family, coarse to fine, from which on all are within a bound."""
    found: list[Point] = []
    for point in reversed(points):
        if not is_good(point, quantity, bound):
            break
        found.append(point)
    return [point for point in found if point.effort is not None]


def for_trajectories(
    diagram: Diagram, bound: float = BOUND, quantity: str | None = None
) -> list[Recommendation]:
    """Of each engine in a diagram of trajectories up to the horizon."""
    quantity = quantity or quantity_of(diagram)
    if quantity is None:
        return []
    found = []
    for engine in dict.fromkeys(point.method.engine for point in diagram.points):
        families = [own for own in diagram.families().values() if own[0].method.engine == engine]
        good = [point for own in families for point in good_points(own, quantity, bound)]
        best = min(good, key=_wall, default=None)
        own_points = (point for own in families for point in own)
        taken = next((point for point in own_points if point.method.is_default), None)
        found.append(
            Recommendation(
                TRAJECTORIES,
                engine,
                "" if best is None else described(best.method),
                "nothing of this diagram" if taken is None else described(taken.method),
                None if taken is None else best is not None and is_same(best.method, taken.method),
                "; ".join(
                    f"{word} {_point_words(point, quantity, diagram.quantities[quantity])}"
                    for word, point in _both(best, taken)
                ),
            )
        )
    return found


def _wall(point: Point) -> float:
    return math.inf if point.effort is None else point.effort.wall


def _both(best: Point | None, taken: Point | None) -> list[tuple[str, Point]]:
    """What is recommended and what is taken, once where they are the same."""
    found = [] if best is None else [("wrong by", best)]
    if taken is not None and (best is None or not is_same(best.method, taken.method)):
        found.append(("what is taken:", taken))
    return found


def _point_words(point: Point, quantity: str, unit: str) -> str:
    if point.failure:
        return f"failed: {point.failure}"
    return f"{point.errors.get(quantity, math.nan):.1e} {unit} in {_wall(point):.2g} s"


def study_methods(scene: Scene) -> tuple[Method, Method]:
    """What the study of the paper takes for statistics: of the open tree, of dae."""
    numerics: Numerics = base_scene("wear-times").numerics
    tree: TreeAccuracy = numerics.tree(scene.mechanism.period)
    dae: DaeAccuracy = numerics.dae()
    return tree_method(tree), dae_method(dae)


def for_statistics(chaos: Chaos, taken: Iterable[Method]) -> list[Recommendation]:
    """Of each engine with a ladder of statistics.

    Parameters
    ----------
    taken : iterable of Method
        What the code takes, one an engine.
    """
    by_engine = {method.engine: method for method in taken}
    found = []
    for engine in dict.fromkeys(point.method.engine for point in chaos.points):
        points = [point for point in chaos.points if point.method.engine == engine]
        best = chaos.cheapest(points)
        own = by_engine.get(engine)
        same = next((p for p in points if own is not None and is_same(p.method, own)), None)
        details = []
        if best is not None:
            details.append(f"{best.cost:.2g} s for a simulated second")
        if same is not None and (best is None or same is not best):
            details.append(f"what is taken: {same.cost:.2g} s, {standing(chaos, same)}")
        found.append(
            Recommendation(
                STATISTICS,
                engine,
                "" if best is None else described(best.method),
                "nothing of its own" if own is None else described(own),
                None if own is None else best is not None and is_same(best.method, own),
                "; ".join(details),
            )
        )
    return found


def standing(chaos: Chaos, point: StatisticPoint) -> str:
    """Whether a setting is honest for wear, and if not, why, in words."""
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


GROUPS: tuple[Group, ...] = ("angles", "cycles", "depth step")
"""What has a finest value."""


def for_wear(wear: WearStudy) -> list[Recommendation]:
    """Of each numerical choice of wear maps, under each set of conventions."""
    found = []
    for group in GROUPS:
        for conventions in dict.fromkeys(point.conventions for point in wear.points):
            points = wear.of(group, conventions)
            if len(points) > 1:
                found.append(_wear_choice(group, conventions, points))
    return found


def _wear_choice(group: Group, conventions: str, points: Sequence[WearPoint]) -> Recommendation:
    finest = points[-1]
    best: WearPoint | None = None
    for point in reversed(points[:-1]):
        if point.failure or finest.failure or is_changed(point, finest):
            break
        best = point
    taken = next((point for point in points if point.is_default), None)
    last = points[-2]
    largest = largest_change(best or last, finest)
    detail = ""
    if largest is not None:
        name, moved = largest
        word = "largest change from" if best is not None else f"{last.label} differs from"
        detail = f"{word} {finest.label}: {100.0 * moved.value:+.0f} % in {name}"
    return Recommendation(
        WEAR,
        f"{TITLES[group]}, {conventions} conventions",
        "" if best is None else best.label,
        "as many as the wear maps' tolerance takes"
        if taken is None and group == "cycles"
        else ("another" if taken is None else taken.label),
        None if taken is None else best is not None and best.label == taken.label,
        detail,
    )


def changes(point: WearPoint, finest: WearPoint) -> dict[str, Interval]:
    """Relative change of each first wear from the finest's, 95 % for all together."""
    wanted = [
        (joint, name) for joint in finest.first if joint in point.first for name in QUANTITIES
    ]
    found = {}
    for joint, name in wanted:
        read = QUANTITIES[name][1]
        moved = change(read(point.first[joint]), read(finest.first[joint]))
        if moved.low is not None and moved.high is not None:
            widening = together(len(wanted))
            moved = Interval(
                moved.value,
                moved.value - widening * (moved.value - moved.low),
                moved.value + widening * (moved.high - moved.value),
            )
        found[f"{name} at {joint}"] = moved
    return found


def is_changed(point: WearPoint, finest: WearPoint) -> bool:
    """Whether any first wear differs from the finest's for certain."""
    return any(
        moved.low is not None and moved.high is not None and not moved.low <= 0.0 <= moved.high
        for moved in changes(point, finest).values()
    )


def largest_change(point: WearPoint, finest: WearPoint) -> tuple[str, Interval] | None:
    """The quantity that changes most, and by how much."""
    found = {k: v for k, v in changes(point, finest).items() if math.isfinite(v.value)}
    return max(found.items(), key=lambda item: abs(item[1].value), default=None)


def recommend(
    scene: Scene,
    diagrams: Iterable[Diagram],
    chaos: Chaos | None,
    wear: WearStudy | None,
) -> tuple[Recommendation, ...]:
    """All recommendations that the results allow."""
    found: list[Recommendation] = []
    for diagram in diagrams:
        if diagram.key == HORIZON:
            found += for_trajectories(diagram)
    if chaos is not None:
        found += for_statistics(chaos, study_methods(scene))
    if wear is not None:
        found += for_wear(wear)
    return tuple(found)


HORIZON = "horizon"
"""Key of the diagram of trajectories."""
