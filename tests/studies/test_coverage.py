"""The study of coverage, on campaigns whose intervals are known to hold or not."""

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from presswear.studies.coverage.report import answer, coverages, estimates
from presswear.studies.coverage.variants import CAMPAIGNS, TRUTHS, make
from presswear.studies.plan import results_of
from presswear.studies.rows import run_study

SPREAD, TRUE = 4.0, 200.0


def stage(force: float, half: float) -> dict[str, Any]:
    """As many statistics of a stage as are looked at."""
    mean = {"mean": force, "half_width": half}
    joint = {
        "force_max_per_cycle_N": mean,
        "wear_volume_m3": 1e-9,
        "wear_volume_half_width_m3": None,
        "wear_depth_max_both_m": 1e-5,
        "wear_depth_max_both_interval_m": [0.9e-5, 1.1e-5],
    }
    return {"slider": {"acceleration_max_per_cycle_m_s2": mean}, "joints": {"A": joint}}


@pytest.mark.parametrize(
    ("half", "bias", "passes"), [(2.0, 0.0, True), (1.0, 0.0, False), (2.0, 1.0, False)]
)
def test_intervals_that_hold_are_told_from_those_that_do_not(
    half: float, bias: float, passes: bool
) -> None:
    """Half widths in standard deviations of the estimates: 1 holds in 68 %."""
    draws = TRUE + SPREAD * (bias + np.random.default_rng(3).standard_normal(400))
    campaigns = [[stage(float(draw), half * SPREAD)] for draw in draws]
    truths = [[stage(TRUE + off, 0.1)] for off in (-1.0, 0.0, 1.0)]
    found = {one.quantity: one for one in coverages("paper", truths, campaigns)}
    force = found["force_max_per_cycle_N, A"]
    assert force.passes == passes
    assert force.truth.value == TRUE
    assert force.truth.high == pytest.approx(TRUE + 4.3027 / math.sqrt(3.0), rel=1e-4)
    assert force.bias == pytest.approx(bias / half, abs=0.06)
    assert found["wear_depth_max_both_m, A"].row()[5] == "400 of 400"
    # Without an interval nothing can hold.
    assert "wear_volume_m3, A" not in found
    said = answer(list(found.values()))
    assert said.startswith(f"Of 3 quantities {3 if half == 2.0 and not bias else 1} are held")


def test_the_error_of_the_step_belongs_to_the_volume() -> None:
    own = stage(TRUE, 1.0)
    own["joints"]["A"] |= {"wear_volume_half_width_m3": 3e-11, "wear_volume_step_m3": 4e-11}
    found = estimates(own)["wear_volume_m3, A"]
    assert found.high == pytest.approx(1e-9 + 5e-11)


def test_campaigns_share_no_start_with_each_other_or_the_truth() -> None:
    study = make()
    seeds = [variant.scene.seed for variant in study.variants]
    assert sorted(seeds) == sorted([*range(1, CAMPAIGNS + TRUTHS + 1)] * 2)
    for variant in study.variants:
        assert (variant.scene.seed > CAMPAIGNS) == (variant.scene.cycles == 200)


@pytest.mark.slow
def test_intervals_of_a_wear_cycle_by_cycle_hold(tmp_path: Path) -> None:
    """Of twenty intervals of 95 % fewer than seventeen hold by chance in one of forty."""
    whole = make(lambda scene: replace(scene, wear_updates=1))
    refined = [variant for variant in whole.variants if variant.key.startswith("refined")]
    long = [replace(v, scene=replace(v.scene, cycles=100)) for v in refined[:8]]
    campaigns = refined[TRUTHS : TRUTHS + 20]
    study = replace(whole, variants=(*long, *campaigns))
    run_study(study, tmp_path, 2, resume=False)
    stages = [
        [stage.statistics for stage in result.stages]
        for _, result in results_of(study, tmp_path)
        if result is not None
    ]
    assert len(stages) == 28
    found = list(coverages("refined", stages[:8], stages[8:]))
    wear = [one for one in found if one.stage == 0]
    assert len(wear) == 1 + 2 * 4
    for one in wear:
        assert one.held.sum() >= 17, one.row()
