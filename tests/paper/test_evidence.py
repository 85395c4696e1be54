"""Quantities of the study against known numbers."""
# mypy: disable-error-code="union-attr,operator,index,arg-type"

import math
from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from known_results import BINS, CYCLES, EVEN, every_evidence, evidence_of, stage

from presswear.paper.evidence import QUANTITIES, Evidence, Measured
from presswear.paper.printed import Place
from presswear.paper.settings import BASE, base_scene
from presswear.recording.columns import cycle_column
from presswear.recording.statistics import STARTUP_CYCLES, half_width
from presswear.scene.conventions import CONVENTIONS

SETTING = "wear-times"
FORCE = cycle_column("force_max", 0)  # column of the first joint
SLIDER = ("displacement", "velocity", "acceleration", "lag", "stroke")
one = partial(stage, SETTING)
BODY = replace(CONVENTIONS["paper"], map_frame="body")
body_maps = partial(evidence_of, SETTING, conventions=BODY)


def measured(
    evidence: Evidence, quantity: str, wear_updates: int = 0, joint: str = ""
) -> Measured:
    result = evidence.measured(BASE, Place(SETTING, wear_updates, joint), quantity)
    assert result is not None
    return result


def test_a_peak_is_the_mean_over_cycles_after_the_startup_of_each_replicate():
    arrays = one(0, 1, force=[EVEN] * 3)
    result = measured(evidence_of(SETTING, arrays), "force", joint="A")
    samples = arrays["cycles"].reshape(3, CYCLES, -1)[:, STARTUP_CYCLES:, FORCE]
    assert result.estimate.mean == pytest.approx(samples.mean())
    assert (result.estimate.samples, result.replicates) == (samples.size, 3)
    assert result.estimate.low < 200.0 < result.estimate.high
    assert result.single_cycles[0] < 170.0 < 225.0 < result.single_cycles[1]


def test_recorded_numbers_of_cycles_are_read_by_name():
    evidence = evidence_of(SETTING, one(0, 1, force=[EVEN] * 2))
    names = ("displacement_off", "velocity_off", "lag", "stroke")
    values = [measured(evidence, name).estimate.mean for name in names]
    assert values == pytest.approx([3e-4, 0.02, 1e-4, 0.1071])
    assert measured(evidence, "flight", joint="A").estimate.mean == pytest.approx(0.1)
    rate = measured(evidence, "contact_rate", joint="C").estimate.mean
    assert rate == pytest.approx(7.0 / base_scene(SETTING).mechanism.period)


def test_depths_add_up_over_wears():
    evidence = evidence_of(SETTING, one(0, 1), one(1, 6, peak=(30e-6, 4e-6)))

    def value(quantity: str, wear_updates: int, joint: str = "A") -> float:
        return measured(evidence, quantity, wear_updates, joint).estimate.mean

    assert value("depth", 1) == pytest.approx(20e-6, rel=0.05)
    assert value("depth", 2) == pytest.approx(50e-6, rel=0.05)
    assert value("added_depth", 2) == pytest.approx(30e-6, rel=0.05)
    assert value("depth", 2, "C") == pytest.approx(12e-6, rel=0.05)
    assert value("angle", 1) == pytest.approx(2.0 * math.pi * 18.5 / BINS)
    # A bell of standard deviation 4 bins is at least a twentieth deep within 2.45 of
    # those.
    assert value("range", 1) == pytest.approx(2.0 * math.pi * 19 / BINS, rel=0.06)
    worn = evidence.wear_map(BASE, Place(SETTING, 2, "A"))
    assert worn.mean.max() == pytest.approx(value("depth", 2))
    assert np.all((worn.low <= worn.mean) & (worn.mean <= worn.high))


def test_after_a_wear_the_replicates_alone_give_the_interval():
    """The value is of the runs on common surfaces; the others say how far it may be off."""
    force = [EVEN] * 2 + [{name: 1.5 * value for name, value in EVEN.items()}] * 2
    second = one(1, 2, force=force)
    result = measured(
        evidence_of(SETTING, one(0, 1), second, replicates=2), "force", 1, "A"
    )
    each = (
        second["cycles"].reshape(4, CYCLES, -1)[:, STARTUP_CYCLES:, FORCE].mean(axis=1)
    )
    assert result.estimate.mean == pytest.approx(each[:2].mean())
    half = math.hypot(half_width(each[2:]) or 0.0, each[:2].mean() - each[2:].mean())
    assert result.estimate.half_width == pytest.approx(half)


def test_a_wear_of_few_cycles_has_no_interval_and_what_did_not_run_is_missing():
    arrays = one(0, 1)
    arrays["A_wear_batches"] = arrays["A_wear_batches"][:0]
    arrays["wear_batch_cycles"] = np.zeros(0)
    evidence = evidence_of(SETTING, arrays)
    estimate = measured(evidence, "depth", 1, "A").estimate
    assert estimate.mean == pytest.approx(20e-6, rel=0.05)
    assert estimate.low is None
    for wear_updates, quantity in ((1, "force"), (2, "depth"), (0, "depth")):
        assert (
            evidence.measured(BASE, Place(SETTING, wear_updates, "A"), quantity) is None
        )
    assert evidence.measured("swapped", Place(SETTING, 0, "A"), "force") is None
    failed = evidence_of(SETTING, one(0, 1), status="failed")
    assert failed.measured(BASE, Place(SETTING, 0, "A"), "force") is None


def test_every_quantity_can_be_measured():
    for quantity in QUANTITIES:
        joint = "" if quantity.endswith("_off") or quantity in SLIDER else "A"
        assert math.isfinite(
            measured(every_evidence(), quantity, 1, joint).estimate.mean
        )


def test_maps_that_turn_with_the_bodies_are_not_added_up_by_their_angles():
    arrays = one(0, 1)
    arrays["A_wear_batches"][:, 1] = np.roll(
        arrays["A_wear_batches"][:, 1], 30, axis=-1
    )
    arrays["A_wear_pin"] = np.roll(arrays["A_wear_pin"], 30)
    fixed = measured(evidence_of(SETTING, arrays), "depth", 1, "A").estimate.mean
    turned = measured(body_maps(arrays), "depth", 1, "A").estimate.mean
    assert (turned, fixed) == pytest.approx((20e-6, 10e-6), rel=0.05)
    place = Place(SETTING, 1, "A")
    assert body_maps(arrays).measured(BASE, place, "angle") is None
    # A jump after the last stage says nothing of wear in steps.
    assert (
        body_maps(one(0, 1), wear_updates=0).measured(BASE, place, "depth") is not None
    )
    stepped = body_maps(one(0, 1), wear_updates=0, extrapolation="steps")
    assert stepped.measured(BASE, place, "depth") is None
