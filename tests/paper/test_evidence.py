"""Quantities of a study: each against numbers put in by hand."""

import math
from functools import partial

import numpy as np
import pytest
from invented import BINS, CYCLES, EVEN, every_evidence, evidence_of, stage

from presswear.paper.evidence import Evidence, Measured
from presswear.paper.printed import Place
from presswear.paper.variants import BASE, base_scene, variant_key
from presswear.paper.words import QUANTITIES
from presswear.recording.observe import CYCLE_FIXED, CYCLE_JOINT
from presswear.recording.statistics import STARTUP_CYCLES, half_width
from presswear.scene.bearing import Conventions

SETTING = "wear-times"
FORCE = len(CYCLE_FIXED) + CYCLE_JOINT.index("force_max")
"""Column of the peak force of the first joint."""
SLIDER = ("displacement", "velocity", "acceleration", "lag", "stroke")
one = partial(stage, SETTING)


def known(evidence: Evidence, quantity: str, wear_updates: int = 0, joint: str = "") -> Measured:
    found = evidence.measured("standard", Place(SETTING, wear_updates, joint), quantity)
    assert found is not None
    return found


def test_a_peak_is_the_mean_over_cycles_behind_the_startup_of_each_start() -> None:
    arrays = one(0, 1, force=[EVEN] * 3)
    found = known(evidence_of(SETTING, arrays), "force", joint="A")
    samples = arrays["cycles"].reshape(3, CYCLES, -1)[:, STARTUP_CYCLES:, FORCE]
    assert found.value == pytest.approx(samples.mean())
    assert (found.samples, found.replicates, found.differ) == (
        3 * (CYCLES - STARTUP_CYCLES),
        3,
        False,
    )
    assert found.ends is not None
    assert found.ends[0] < 200.0 < found.ends[1]
    assert found.draws is not None
    assert found.draws[0] < 170.0
    assert found.draws[1] > 225.0


def test_contacts_are_counted_by_cycle_and_start_and_given_by_second() -> None:
    evidence = evidence_of(SETTING, one(0, 1, force=[EVEN] * 2))
    period = base_scene(SETTING).mechanism.period
    assert known(evidence, "contact_rate", joint="C").value == pytest.approx(7.0 / period)


def test_recorded_cycles_are_read_by_their_columns() -> None:
    evidence = evidence_of(SETTING, one(0, 1))
    values = [known(evidence, name).value for name in ("displacement_off", "velocity_off", "lag")]
    assert values == pytest.approx([3e-4, 0.02, 1e-4])
    assert known(evidence, "stroke").value == pytest.approx(0.1071)
    assert known(evidence, "flight", joint="A").value == pytest.approx(0.1)


def test_depths_add_up_over_wears() -> None:
    evidence = evidence_of(
        SETTING,
        one(0, 1, peak=(20e-6, 8e-6)),
        one(1, 6, peak=(30e-6, 4e-6)),
    )

    def value(quantity: str, wear_updates: int, joint: str = "A") -> float:
        return known(evidence, quantity, wear_updates, joint).value

    assert value("depth", 1) == pytest.approx(20e-6, rel=0.05)
    assert value("depth", 2) == pytest.approx(50e-6, rel=0.05)
    assert value("added_depth", 2) == pytest.approx(30e-6, rel=0.05)
    assert value("depth", 2, "C") == pytest.approx(12e-6, rel=0.05)
    assert value("angle", 1) == pytest.approx(2.0 * math.pi * 18.5 / BINS)
    # A bell of standard deviation 4 bins is at least a twentieth deep within 2.45 of those.
    assert value("range", 1) == pytest.approx(2.0 * math.pi * 19 / BINS, rel=0.06)
    drawn = evidence.wear_map("standard", Place(SETTING, 2, "A"))
    assert drawn is not None
    assert drawn.mean.max() == pytest.approx(value("depth", 2))
    assert np.all((drawn.low <= drawn.mean) & (drawn.mean <= drawn.high))


def test_the_error_of_a_map_falls_with_the_starts() -> None:
    for replicates, tolerance in ((1, 0.5), (4, 0.3), (16, 0.15)):
        evidence = evidence_of(SETTING, one(0, 1, force=[EVEN] * replicates))
        expected = 0.05 / math.sqrt(replicates * (CYCLES - 1))
        error = evidence.map_error("standard", Place(SETTING, 1, "A"))
        assert error == pytest.approx(expected, rel=tolerance)


def test_starts_that_differ_widen_the_interval() -> None:
    apart = [{"A": mean, "C": 100.0} for mean in (150.0, 200.0, 250.0)]
    narrow = known(evidence_of(SETTING, one(0, 1, force=[EVEN] * 3)), "force", joint="A")
    wide = known(evidence_of(SETTING, one(0, 1, force=apart)), "force", joint="A")
    assert wide.differ
    assert wide.ends is not None
    assert narrow.ends is not None
    assert np.ptp(wide.ends) > 10.0 * np.ptp(narrow.ends)


def test_a_wear_of_few_cycles_has_a_value_and_no_interval() -> None:
    arrays = one(0, 1)
    arrays["A_wear_batches"] = arrays["A_wear_batches"][:0]
    arrays["wear_batch_cycles"] = np.zeros(0)
    evidence = evidence_of(SETTING, arrays)
    found = known(evidence, "depth", 1, "A")
    assert found.value == pytest.approx(20e-6, rel=0.05)
    assert found.ends is None
    assert evidence.map_error("standard", Place(SETTING, 1, "A")) is None


def test_what_did_not_run_is_missing() -> None:
    evidence = evidence_of(SETTING, one(0, 1))
    assert evidence.measured("standard", Place(SETTING, 1, "A"), "force") is None
    assert evidence.measured("standard", Place(SETTING, 2, "A"), "depth") is None
    assert evidence.measured("standard", Place(SETTING, 0, "A"), "depth") is None
    assert evidence.measured("swapped", Place(SETTING, 0, "A"), "force") is None
    none = evidence_of(SETTING, one(0, 1), status="failed")
    assert none.measured("standard", Place(SETTING, 0, "A"), "force") is None


def test_behind_a_wear_the_starts_alone_give_the_interval() -> None:
    """The value is of the first set of starts; the other says how far it may be off."""
    even, higher = dict(EVEN), {name: 1.5 * force for name, force in EVEN.items()}
    evidence = evidence_of(
        SETTING, one(0, 1), one(1, 2, force=[even] * 2 + [higher] * 2), replicates=2
    )
    found = known(evidence, "force", 1, "A")
    rows = evidence.results[variant_key(BASE, SETTING)].stages[1].arrays["cycles"]
    each = rows.reshape(4, CYCLES, -1)[:, STARTUP_CYCLES:, FORCE].mean(axis=1)
    assert found.value == pytest.approx(each[:2].mean())
    assert found.replicates == 2
    assert found.ends is not None
    half = math.hypot(half_width(each[2:]) or 0.0, each[:2].mean() - each[2:].mean())
    assert found.ends[1] - found.value == pytest.approx(half)


def test_every_quantity_has_words_and_can_be_measured() -> None:
    for quantity in QUANTITIES:
        joint = "" if quantity.endswith("_off") or quantity in SLIDER else "A"
        assert math.isfinite(known(every_evidence(), quantity, 1, joint).value)


turning = partial(evidence_of, SETTING, conventions=Conventions(map_frame="body"))


def test_maps_that_turn_are_not_added_up_by_their_angles() -> None:
    """Each surface's own deepest place counts, wherever it is; there is no common angle."""
    arrays = one(0, 1)
    arrays["A_wear_batches"][:, 1] = np.roll(arrays["A_wear_batches"][:, 1], 30, axis=-1)
    arrays["A_wear_pin"] = np.roll(arrays["A_wear_pin"], 30)
    fixed = known(evidence_of(SETTING, arrays), "depth", 1, "A").value
    turned = known(turning(arrays), "depth", 1, "A").value
    assert turned == pytest.approx(20e-6, rel=0.05)
    assert fixed == pytest.approx(10e-6, rel=0.05)
    assert turning(arrays).measured("standard", Place(SETTING, 1, "A"), "angle") is None


def test_a_jump_after_the_last_stage_is_no_wear_in_steps() -> None:
    place = Place(SETTING, 1, "A")
    assert turning(one(0, 1), wear_updates=0).measured("standard", place, "depth") is not None
    stepped = turning(one(0, 1), wear_updates=0, extrapolation="steps")
    assert stepped.measured("standard", place, "depth") is None
