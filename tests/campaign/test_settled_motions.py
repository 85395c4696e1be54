"""Motions that the replicates of a stage came to: settled, irregular, or some of both."""
# mypy: disable-error-code="union-attr,operator,index,arg-type"

import math
import re
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import presswear as pw
from presswear.campaign.settled_motions import settling_of
from presswear.recording.columns import cycle_column, cycle_columns
from presswear.results.motions import needs_warning, sentence_of, state_of
from presswear.results.stage_statistics import StageStatistics
from presswear.scene.scene import Scene
from presswear.show.key_numbers import key_numbers
from presswear.show.limits import limit_lines
from presswear.show.warnings import warnings
from presswear.tools.arrays import Array


@pytest.fixture(scope="module")
def slow_crank():
    """A slider-crank that rattles for some 40 cycles and then runs with 299 N and no touchdown."""
    return pw.Scene(
        pw.SliderCrank(speed=2.0 * math.pi * 1000.0 / 60.0, slide_angle=0.0),
        bearings={"B": pw.Bearing(clearance=5e-4)},
        engine="dae",
        replicates=4,
        wear_updates=0,
        max_cycles=1600,
    )


def rows_of(
    irregular: int, regular: int, force: float = 300.0, place: float = 0.0
) -> Array:
    """Return rows of a run that is irregular for some cycles, then regular for others."""
    generator = np.random.default_rng(irregular + 100)
    rows = np.zeros((irregular + regular, cycle_columns(1, 0)))
    forces = rows[:, cycle_column("force_max", 0)]
    forces[:irregular] = generator.uniform(200.0, 4000.0, irregular)
    forces[irregular:] = force
    ends = rows[:, cycle_column("eccentricity_x", 0)]
    ends[:irregular] = generator.uniform(-5e-4, 5e-4, irregular)
    ends[irregular:] = place
    rows[:irregular, cycle_column("contacts", 0)] = 20.0
    return rows


@pytest.fixture(scope="module")
def joints(slow_crank):
    return slow_crank.linkage().clearances


def test_runs_of_which_some_have_settled_are_mixed(joints):
    settling = settling_of(joints, [rows_of(30, 40), rows_of(12, 58), rows_of(70, 0)])
    assert settling.verdict == "mixed"
    assert settling.starts == (30, 12, None)
    regular, irregular = settling.motions
    assert (regular.replicates, irregular.replicates) == (2, 1)
    assert regular.peak_force["B"].mean == pytest.approx(300.0)
    assert regular.contacts["B"].mean == 0.0
    assert irregular.contacts["B"].mean == pytest.approx(20.0)
    assert irregular.period is None
    # Settled 28 and 10 cycles after the start-up, irregular for 58 at least: 96 cycles,
    # two ends.
    assert settling.half_life.mean == pytest.approx(np.log(2.0) * 96.0 / 2.0)
    assert "2 of 3 runs came to rest" in sentence_of(settling)
    assert state_of(settling) == "not settled, regular in 2 of 3 runs"
    assert not any(settling.skipped(k) for k in range(3))


def test_motions_of_different_forces_coexist(joints):
    settling = settling_of(
        joints, [rows_of(5, 40), rows_of(9, 40), rows_of(5, 40, 600.0)]
    )
    assert settling.verdict == "coexisting"
    assert settling.is_mixture
    assert "2 with 300 N at B, 1 with 600 N at B" in sentence_of(settling)
    assert state_of(settling) == "settled on 2 different regular motions in 3 runs"


def test_settled_runs_have_their_samples_from_the_regular_motion(joints):
    settling = settling_of(joints, [rows_of(20, 40), rows_of(33, 40)])
    assert settling.verdict == "settled"
    # The first two cycles of the regular motion count as start-up.
    assert [settling.skipped(k) for k in range(2)] == [20, 33]
    assert needs_warning(settling)


def test_irregular_runs_bound_the_half_life(joints):
    settling = settling_of(joints, [rows_of(60, 0)] * 4)
    assert settling.half_life is None
    # No end in 4 x 48 cycles: 2^(-192 / T) = 0.05.
    assert settling.least_half_life == pytest.approx(
        -192.0 * np.log(2.0) / np.log(0.05)
    )
    assert "none of 4 runs came to rest" in sentence_of(settling)
    assert state_of(settling) == "not settled, irregular in 4 runs of 60 strokes"


def test_few_cycles_show_nothing(joints):
    settling = settling_of(joints, [rows_of(7, 0)] * 4)
    assert settling.verdict == "unwatched"
    assert state_of(settling) == "7 strokes are too few to see whether it settles"


def test_a_linkage_without_clearance_has_nothing_to_settle():
    result = pw.run(pw.changed(pw.scenes.ideal(), {"engine": "dae", "cycles": 3}))
    assert result.stages[0].statistics.settling is None


def statistics_of(scene: Scene) -> tuple[pw.Result, StageStatistics]:
    result = pw.run(scene, jobs=1)
    return result, result.stages[0].statistics


def test_a_run_goes_on_until_all_replicates_agree(slow_crank):
    """The peak of 298.9 N was found by another simulator; the first strokes have 1,900 N.

    With a half-life of 30 to 40 cycles, one of a thousand runs of 400 cycles is still
    irregular.
    """
    result, statistics = statistics_of(replace(slow_crank, replicates=2))
    settling = statistics.settling
    assert settling.verdict == "settled"
    assert result.status == "completed"
    peak = statistics.joints["B"].peak_force_per_cycle
    assert peak.mean == pytest.approx(298.9, abs=2.0)
    assert statistics.joints["B"].contacts_per_cycle.mean == 0.0
    # The rattle before is not in the mean.
    assert statistics.joints["B"].contact_time_fraction == pytest.approx(1.0)
    assert [f"{warning:.3}" for warning in warnings(result)] == ["No "]
    assert "same regular motion" in warnings(result)[0]


def test_runs_that_do_not_agree_are_unconverged(slow_crank):
    """In 24 of some 40 cycles some of eight runs settle and others do not, for most seeds."""
    for seed in range(1, 40):
        scene = pw.changed(slow_crank, {"cycles": 24, "seed": seed, "replicates": 8})
        result, statistics = statistics_of(scene)
        if statistics.settling.verdict == "mixed":
            break
    assert result.status == "unconverged"
    assert "runs came to rest on a regular motion" in result.message
    joint = statistics.joints["B"]
    assert joint.peak_force_per_cycle.low is None
    assert joint.contacts_per_cycle.low is None
    assert joint.load_distance_per_cycle.low is not None
    peak = next(key for key in key_numbers(result) if key.name == "Peak joint force")
    assert " or " in peak.value
    assert peak.note == "2 motions"
    pressure, *_ = limit_lines(result.scene, result.stages[-1])[0]
    assert "of the motion with the largest force, at joint B" in pressure.meaning
    force = statistics.settling.motions[-1].peak_force["B"].mean  # on 30 mm x 20 mm
    assert float(pressure.value.removesuffix(" MPa")) == pytest.approx(
        1e-6 * force / 6e-4, rel=0.05
    )


def test_a_life_wears_in_the_motion_that_goes_on(slow_crank):
    """Of 50 strokes; for some seeds neither of two runs settles in them."""
    life = pw.Life(until="B.depth > 5 um")
    changes: dict[str, Any] = {
        "wear_updates": 1,
        "cycles": 12,
        "tolerance": 0.5,
        "replicates": 2,
    }
    for seed in (2, 0, 1, 3):
        result = pw.run(replace(slow_crank, life=life, seed=seed, **changes), jobs=2)
        if result.life and "same regular motion" in result.life.motion:
            break
    peak = re.search(
        r"same regular motion \(peak force (\d+) N at B\)", result.life.motion
    )
    assert float(peak[1]) == pytest.approx(298.9, abs=1.5)
    assert result.life.motion.endswith("The histories begin in this motion")
    # The motion without touchdown goes on while the surfaces wear by a hundredth of the
    # clearance.
    assert result.life.settled[0] == 2
    forces = result.life.curves["B.force_max"][:, 0]
    assert forces.max() < 450.0
