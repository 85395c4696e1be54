"""Plans: rows counted and made one by one."""

import itertools
from collections.abc import Callable
from functools import partial

import numpy as np
import pytest

import presswear as pw
from presswear.sweeps.plan import Plan, scene_digest
from presswear.tools.documents import plain

SCENE = pw.scenes.wear_times(engine="dae", wear_updates=0, cycles=1)
VARY = ("clearance=0.2mm,0.4mm", "A.friction=0.1,0.2 & C.friction=0.3,0.4", "engine=dae,exudyn")


def test_every_value_goes_with_every_other() -> None:
    plan = Plan(SCENE, VARY, draws=3)
    assert (plan.points, plan.rows) == (8, 24)
    found = [tuple(plan.point(row)) for row in range(0, plan.rows, plan.draws)]
    pairs = itertools.product((2e-4, 4e-4), ((0.1, 0.3), (0.2, 0.4)), (0.0, 1.0))
    assert found == [(c, *both, e) for c, both, e in pairs]
    assert [plan.draw(row) for row in range(4)] == [0, 1, 2, 0]


def test_a_row_is_the_scene_with_its_values() -> None:
    plan = Plan(SCENE, VARY, draws=2)
    scene = plan.scene_of(plan.rows - 1)
    found = (scene.bearing("A").clearance, scene.bearing("A").friction, scene.bearing("C").friction)
    assert found == (4e-4, 0.2, 0.4)
    assert (scene.engine, scene.seed) == ("exudyn", SCENE.seed + 1)


def test_a_sample_takes_the_values_of_its_distributions() -> None:
    ranges = ("clearance=0.2mm:1mm", "friction=normal(0.05, 0.01)")
    plan = Plan(SCENE, ("engine=dae,exudyn",), "sobol:64", ranges)
    assert plan.rows == 128
    points = np.array([plan.point(row) for row in range(0, 128, 2)])
    # A scrambled Sobol' sequence of 64 has one point in each 64th of a range.
    places = np.sort((points[:, 0] - 2e-4) / 8e-4 * 64.0).astype(int)
    assert places.tolist() == list(range(64))
    assert np.mean(points[:, 1]) == pytest.approx(0.05, abs=5e-4)
    assert np.std(points[:, 1]) == pytest.approx(0.01, abs=1e-3)
    assert Plan(SCENE, (), "sobol:64", ranges, seed=1).point(0)[0] != points[0, 0]


def test_names_are_of_what_decides_the_numbers() -> None:
    plan = Plan(SCENE, ("clearance=0.2mm,0.4mm",), draws=2)
    assert len({plan.shortcut(row) for row in range(4)}) == 4
    assert len({scene_digest(plan.scene_of(row)) for row in range(4)}) == 4
    # The same scene, however it came about, is one: of another plan, or under another title.
    other = Plan(pw.scenes.wear_times(wear_updates=0, cycles=1, clearance="0.4mm"), ("engine=dae",))
    assert scene_digest(other.scene_of(0)) == scene_digest(plan.scene_of(2))
    assert other.shortcut(0) != plan.shortcut(2)


def test_plans_come_back_from_plain_data() -> None:
    ranges = ("friction=uniform(0, 0.1)",)
    plan = Plan(SCENE, ("clearance=0.2mm,0.4mm",), "latin:5", ranges, 2, 3)
    again = Plan.from_dict(plain(plan.as_dict()))
    assert again == plan
    assert [again.shortcut(row) for row in range(20)] == [plan.shortcut(row) for row in range(20)]


SAMPLED = partial(Plan, SCENE, sample="sobol:8")


@pytest.mark.parametrize(
    ("make", "told"),
    [
        (partial(Plan, SCENE), "nothing is varied"),
        (SAMPLED, "--sample and --range go together"),
        (partial(Plan, SCENE, ranges=("friction=0:0.1",)), "--sample and --range go together"),
        (partial(SAMPLED, ranges=("friction=0:0.1",), sample="sobol"), "KIND:SIZE is expected"),
        (partial(SAMPLED, ranges=("friction=0:0.1",), sample="sobl:8"), "did you mean sobol"),
        (partial(SAMPLED, ranges=("engine=dae",)), "engine is no number"),
        (partial(SAMPLED, ranges=("frction=0:0.1",)), "did you mean friction"),
        (partial(SAMPLED, ranges=("friction",)), "KEY=DISTRIBUTION is expected"),
        (partial(Plan, SCENE, ("friction=0.1", "friction=0.2")), "friction is varied twice"),
        (partial(Plan, SCENE, ("seed=1,2",), draws=2), "seed is varied, and draws ask"),
        (partial(Plan, SCENE, ("friction=0.1",), draws=0), "draws = 0: allowed is 1"),
        (partial(Plan, SCENE, ("length_3=0.1m,0.11m",)), "no scene of this plan .*assembled"),
        (
            partial(Plan, SCENE, ("friction=0:0.1:10000", "clearance=0.1mm:1mm:10000")),
            "100000000 rows are planned",
        ),
    ],
)
def test_what_cannot_run_is_refused_before_anything_runs(
    make: Callable[[], Plan], told: str
) -> None:
    with pytest.raises(pw.InputError, match=told):
        make()


def test_one_point_that_cannot_be_put_together_is_no_reason_to_refuse_the_others() -> None:
    plan = Plan(SCENE, ("length_3=0.1m,0.2m",))
    with pytest.raises(pw.InputError, match="assembled"):
        plan.scene_of(0)
    assert plan.example == plan.scene_of(1)


def test_keys_of_a_process_are_known_once_it_is_varied() -> None:
    plan = Plan(SCENE, ("process=blanking", "process.height=6mm,8mm"))
    assert plan.scene_of(1).process is not None
    with pytest.raises(pw.InputError, match=r"unknown key 'process\.height'"):
        Plan(SCENE, ("process.height=6mm,8mm",))
