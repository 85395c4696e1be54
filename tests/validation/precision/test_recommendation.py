"""What is recommended, from made-up results, and whether the code takes it."""

from collections.abc import Iterable
from dataclasses import replace

from precision.made_up_precision import (
    METHODS,
    chaos,
    diagram,
    interval,
    precision,
    wear,
    wear_point,
)
from presswear.recording.sampling import Interval
from presswear.studies.paper.variants import base_scene
from presswear.validation.precision.diagram import Diagram, TaskPoint
from presswear.validation.precision.methods import Method, method_of
from presswear.validation.precision.recommendation import (
    BOUNDS,
    RULES,
    STATISTICS,
    TRAJECTORIES,
    WEAR,
    Recommendation,
    for_statistics,
    for_trajectories,
    for_wear,
    is_same,
    recommend,
)
from presswear.validation.precision.wear import DEEPEST, VOLUME, WearStudy

TAKEN = tuple(
    method
    for method in METHODS
    if method.label in ("exudyn-tree, DOPRI5, tolerance 1e-06", "dae, DOPRI5, tolerance 1e-07")
)
"""Taken for statistics here, whatever the code takes."""


def of(found: Iterable[Recommendation], subject: str) -> Recommendation:
    return next(one for one in found if one.subject == subject)


def changed_errors(shown: Diagram, label: str, error: float) -> Diagram:
    points = tuple(
        replace(point, errors={**point.errors, "slider position": error})
        if point.method.label == label
        else point
        for point in shown.points
    )
    return replace(shown, points=points)


def slider(bound: float) -> dict[str, float]:
    return {"slider position": bound, "what is not in the diagram": 0.0}


def test_cheapest_within_the_bound() -> None:
    """Errors are 100 times the tolerance: 1e-8 is the first below 1e-6 m."""
    found = list(for_trajectories(diagram(), slider(1.01e-6)))
    tree = of(found, "exudyn-tree")
    assert tree.recommended == "DOPRI5, tolerance 1e-08"
    assert tree.agrees
    assert tree.verdict == "the code takes it"
    dae = of(found, "dae")
    assert dae.recommended in ("DOP853, tolerance 1e-08", "DOPRI5, tolerance 1e-08")
    assert dae.agrees is False
    assert dae.meets
    assert dae.verdict == (
        "the code takes another that meets the rule as well: DOP853, tolerance 1e-09"
    )


def test_the_bound_decides() -> None:
    found = list(for_trajectories(diagram(), slider(1.01e-3)))
    assert of(found, "exudyn-tree").recommended == "DOPRI5, tolerance 1e-05"
    assert of(found, "exudyn-tree").agrees is False
    assert of(found, "exudyn-tree").meets
    none = of(for_trajectories(diagram(), slider(1e-12)), "exudyn-tree")
    assert none.recommended == ""
    assert none.verdict == "the code takes DOPRI5, tolerance 1e-08"


def test_every_bound_counts() -> None:
    """Velocities are wrong by 50 times as much as positions."""
    bounds = {"slider position": 1.01e-6, "slider velocity": 5.01e-6}
    tree = of(for_trajectories(diagram(), bounds), "dae")
    assert tree.recommended.endswith("1e-09")
    assert "slider velocity at 1 of its bound" in tree.detail


def test_without_a_bound_nothing_is_recommended() -> None:
    assert not list(for_trajectories(diagram(), {"what is not in the diagram": 1.0}))


def test_bounds_are_those_of_the_cross_check() -> None:
    assert BOUNDS == {
        "slider position": 1e-6,
        "touch times": 1e-6,
        "closing speeds": 1e-4,
        "peak forces": 1e-3,
    }


def test_a_lucky_point_is_not_recommended() -> None:
    """A coarse setting that happens to be right, with a finer one that is wrong."""
    lucky = changed_errors(diagram(), "exudyn-tree, DOPRI5, tolerance 0.0001", 1e-9)
    assert of(for_trajectories(lucky, slider(1.01e-6)), "exudyn-tree").recommended.endswith("1e-08")
    spoilt = changed_errors(diagram(), "exudyn-tree, DOPRI5, tolerance 1e-08", 1.0)
    assert of(for_trajectories(spoilt, slider(1.01e-4)), "exudyn-tree").recommended == ""


def test_what_failed_is_not_recommended() -> None:
    found = of(for_trajectories(diagram(), slider(1.0)), "exudyn-joints")
    assert found.recommended == ""
    assert found.agrees is None


def test_families_of_an_engine_compete_by_time() -> None:
    """Of two integrators that are good enough the quicker one is taken."""
    slow = diagram()

    def slower(point: TaskPoint) -> TaskPoint:
        if point.timing is None or point.method.integrator != "DOPRI5":
            return point
        walls = tuple(10.0 * wall for wall in point.timing.walls)
        return replace(point, timing=replace(point.timing, walls=walls))

    slow = replace(slow, points=tuple(map(slower, slow.points)))
    assert (
        of(for_trajectories(slow, slider(1.01e-6)), "dae").recommended == "DOP853, tolerance 1e-08"
    )


def test_statistics_take_the_cheapest_honest_setting() -> None:
    found = list(for_statistics(chaos(coarsest_honest=1e-6), TAKEN))
    assert of(found, "exudyn-tree").agrees
    assert of(found, "exudyn-tree").recommended == "DOPRI5, tolerance 1e-06"
    assert of(found, "dae").agrees is False
    assert "honest up to 44 cycles" in of(found, "dae").detail


def test_a_dishonest_setting_of_the_code_is_told() -> None:
    found = of(for_statistics(chaos(coarsest_honest=1e-8), TAKEN), "dae")
    assert found.recommended.endswith("1e-08")
    assert found.meets is False
    assert "step error seen in wear total at A" in found.detail
    few = of(for_statistics(chaos(bound=1.0), TAKEN), "dae")
    assert few.recommended == ""
    assert "too few cycles to exclude one" in few.detail


def test_same_setting() -> None:
    numerics = base_scene("wear-times").numerics
    tree = method_of(numerics.tree, numerics.tree)
    assert is_same(tree, replace(tree, is_default=False))
    assert not is_same(tree, replace(tree, value=2.0 * tree.value))
    assert not is_same(tree, replace(tree, engine=numerics.dae))


def test_wear_takes_the_coarsest_that_does_not_differ() -> None:
    found = list(for_wear(wear()))
    refined = of(found, "angles of a wear map, refined conventions")
    assert refined.recommended == "90"
    assert refined.agrees is False
    paper = of(found, "angles of a wear map, paper conventions")
    assert paper.recommended == ""
    assert "360 differs from 1440: +300 %" in paper.detail
    assert refined.meets
    assert paper.meets is False


def test_wear_that_is_hardly_known_is_no_reason_to_be_coarse() -> None:
    """Intervals of 50 % hold everything, and show nothing."""
    blurred = {
        joint: {DEEPEST: interval(1e-5, 0.5), VOLUME: interval(1e-8, 0.5)} for joint in ("A", "C")
    }
    points = tuple(
        replace(wear_point("angles", "paper", f"{n}", n, 1.0), first=blurred) for n in (90, 360)
    )
    (found,) = for_wear(WearStudy(points, {}, "dae"))
    assert found.recommended == ""
    assert found.meets is False
    unknown = tuple(
        replace(point, first={"A": {DEEPEST: Interval(1.0, None, None), VOLUME: interval(1.0)}})
        for point in points
    )
    assert next(for_wear(WearStudy(unknown, {}, "dae"))).recommended == ""


def test_wear_does_not_trust_a_failed_finest() -> None:
    points = (
        wear_point("angles", "paper", "90", 90, 1.0),
        wear_point("angles", "paper", "360", 360, 1.0),
        replace(wear_point("angles", "paper", "1440", 1440, 1.0), first={}, failure="no"),
    )
    (found,) = for_wear(WearStudy(points, {}, "dae"))
    assert found.recommended == ""


def test_everything_together() -> None:
    numerics = base_scene("wear-times").numerics
    found = recommend(precision(), numerics)
    purposes = list(dict.fromkeys(one.purpose for one in found))
    assert purposes == [TRAJECTORIES, STATISTICS, WEAR] == list(RULES)
    # The diagram of the horizon alone speaks of trajectories.
    engines = [one.subject for one in found if one.purpose == TRAJECTORIES]
    assert len(engines) == len(set(engines)) == 3
    taken = {one.subject: one.taken for one in found if one.purpose == STATISTICS}
    own = numerics.resolved("wear")
    settings = [method_of(each, each).setting for each in (own.tree, own.dae)]
    assert list(taken.values()) == settings
    assert all(one.verdict.startswith("the code takes") for one in found)


def test_no_method_is_recommended_for_another_engine() -> None:
    methods: list[Method] = [point.method for point in diagram().points]
    for one in for_trajectories(diagram(), slider(1.0)):
        if one.recommended:
            own = [m.label for m in methods if m.engine.word == one.subject]
            assert f"{one.subject}, {one.recommended}" in own
