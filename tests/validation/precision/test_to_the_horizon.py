"""The press with clearance: references that agree, errors that fall, failures that stay."""

import math
from dataclasses import replace

import pytest

from precision.short_study import SHORT, silent
from presswear.engines.base import Plan
from presswear.engines.settings import InHouse
from presswear.scene.catalog import scene_named
from presswear.tools.errors import InputError, RunFailed
from presswear.validation.precision.diagram import Diagram, Task, first_run
from presswear.validation.precision.horizon import horizon_of, second_reference, with_clearance
from presswear.validation.precision.methods import contact_methods, method_of
from presswear.validation.precision.study import study

SCENE = scene_named("wear-times")


@pytest.fixture(scope="module")
def task() -> Task:
    found, horizon = with_clearance(SCENE, SHORT.rungs, SHORT.longest, silent)
    assert horizon == SHORT.longest
    return found


def test_two_references_agree(press: Diagram) -> None:
    known = {quantity.name: quantity.known for quantity in press.quantities}
    assert known["slider position"] < 1e-12
    assert known["touch times"] < 1e-10
    assert known["peak forces"] < 1e-4


def test_the_papers_setting_stays_in_as_a_failure(press: Diagram) -> None:
    failed = [point for point in press.points if point.failure]
    assert [point.method.is_paper for point in failed] == [True, False]
    assert {point.method.label for point in failed} == {
        "dae, RK4, step 0.0001",
        "dae, RK4, step 2e-05",
    }
    assert all("do not add up" in point.failure for point in failed)


def test_finer_is_better_in_every_family(press: Diagram) -> None:
    for points in press.families.values():
        sound = [point for point in points if not point.failure]
        if len(sound) > 1:
            for quantity in ("touch times", "energy residual / exchanged"):
                assert sound[-1].errors[quantity] < sound[0].errors[quantity]


def test_defaults_are_the_scenes_own(press: Diagram) -> None:
    own = [point.method.engine for point in press.points if point.method.is_default]
    numerics, period = SCENE.numerics.resolved("trajectory"), SCENE.mechanism.period
    dae = replace(numerics.dae, free_step=period / 500.0)
    assert own == [numerics.joints.over(period), numerics.tree.over(period), dae]


def test_a_scenes_own_numerics_are_marked() -> None:
    numerics = SCENE.numerics.having(
        steps_per_contact=70,
        tree_tolerance=3e-7,
        integrator="rk4",
        equal_step=3e-5,
    )
    methods = contact_methods(SHORT.rungs, numerics, 0.5, 1e-3, tree=True)
    marked = {method.label for method in methods if method.is_default}
    assert marked == {
        "exudyn-joints, trapezoidal rule, steps in an impact 70",
        "exudyn-tree, DOPRI5, tolerance 3e-07",
        "dae, RK4, step 3e-05",
    }


def test_without_an_open_tree_another_integrator_is_the_second_reference() -> None:
    words, engine = second_reference(scene_named("clearance-a"))
    assert "no open tree" in words
    assert engine == InHouse("dopri5", 1e-13)


def test_a_scene_without_clearance_is_refused() -> None:
    with pytest.raises(InputError, match="no clearance"):
        study(scene_named("ideal"), SHORT, silent)


def test_whatever_a_method_does_is_a_point(task: Task) -> None:
    engine = InHouse(integration_tolerance=1e-6)
    method = method_of(engine, engine)

    def short(run: object) -> tuple[dict[str, float], dict[str, float]]:
        raise RunFailed("3 of the first 10 touches missing")

    def lost(run: object) -> tuple[dict[str, float], dict[str, float]]:
        return {own.name: math.nan for own in task.diagram.quantities}, {}

    plan = Plan(1e-4, 1, 1, torques=False)
    for assess, words in ((short, "touches missing"), (lost, "no number for slider position")):
        found = first_run(replace(task, plan=plan, assess=assess), method)
        assert words in found.failure
        assert not found.errors
    start = replace(task.start, position=task.start.position + 1.0)
    assert "violates" in first_run(replace(task, start=start), method).failure


@pytest.mark.slow
def test_the_horizon_is_where_starts_have_parted() -> None:
    assert 0.06 < horizon_of(SCENE, 1.0) < 0.3
