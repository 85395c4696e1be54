"""Quantities of a study: each against numbers put in by hand."""

import math

import numpy as np
import pytest
from invented import BINS, CYCLES, every_result, evidence_of, result, stage

from presswear.paper.evidence import Evidence, Place
from presswear.paper.words import QUANTITIES

SETTING = "wear-times"


def one(wears: int = 0, seed: int = 1, **numbers: object) -> dict[str, np.ndarray]:
    return stage(SETTING, wears, seed, **numbers)


def test_a_peak_is_the_mean_over_cycles_behind_the_first() -> None:
    runs = [[one(seed=seed)] for seed in (1, 2, 3)]
    found = evidence_of(SETTING, *runs).measured("standard", Place(SETTING, 0, "A"), "force")
    assert found is not None
    samples = np.concatenate([run[0]["cycles"][1:, 5] for run in runs])
    assert found.value == pytest.approx(samples.mean())
    assert (found.samples, found.runs, found.differ) == (3 * (CYCLES - 1), 3, False)
    assert found.low is not None
    assert found.high is not None
    assert found.low < 200.0 < found.high
    assert found.draws is not None
    assert found.draws[0] < 170.0
    assert found.draws[1] > 230.0


def test_contacts_are_counted_by_cycle_and_given_by_second() -> None:
    evidence = evidence_of(SETTING, [one()])
    found = evidence.measured("standard", Place(SETTING, 0, "C"), "contact_rate")
    assert found is not None
    period = evidence.runs["standard", SETTING][0].scene.mechanism.period
    assert found.value == pytest.approx(7.0 / period)


def test_a_late_slider_lags_by_its_delay() -> None:
    late = 1e-4
    evidence = evidence_of(SETTING, [one(lag=late)])
    found = evidence.measured("standard", Place(SETTING, 0), "lag")
    assert found is not None
    assert found.value == pytest.approx(late, rel=1e-3)
    exact = evidence_of(SETTING, [one()]).measured("standard", Place(SETTING, 0), "velocity_off")
    assert exact is not None
    assert exact.value == pytest.approx(0.0, abs=1e-12)


def test_flight_is_the_part_of_the_time_out_of_contact() -> None:
    found = evidence_of(SETTING, [one()]).measured("standard", Place(SETTING, 0, "A"), "flight")
    assert found is not None
    assert found.value == pytest.approx(0.5, abs=0.01)


def test_depths_add_up_over_wears_and_pool_over_runs() -> None:
    runs = [
        [one(0, s, peak={"A": 20e-6, "C": 8e-6}), one(1, s + 5, peak={"A": 30e-6, "C": 4e-6})]
        for s in (1, 20)
    ]
    evidence = evidence_of(SETTING, *runs)

    def value(quantity: str, wears: int, joint: str = "A") -> float:
        found = evidence.measured("standard", Place(SETTING, wears, joint), quantity)
        assert found is not None
        return found.value

    assert value("depth", 1) == pytest.approx(20e-6, rel=0.05)
    assert value("depth", 2) == pytest.approx(50e-6, rel=0.05)
    assert value("added_depth", 2) == pytest.approx(30e-6, rel=0.05)
    assert value("depth", 2, "C") == pytest.approx(12e-6, rel=0.05)
    assert value("angle", 1) == pytest.approx(2.0 * math.pi * 18.5 / BINS)
    # A bell of standard deviation 4 bins is at least a twentieth deep within 2.45 of those.
    assert value("range", 1) == pytest.approx(2.0 * math.pi * 19 / BINS, rel=0.06)
    drawn = evidence.wear_map("standard", SETTING, "A", 2)
    assert drawn is not None
    assert drawn.mean.max() == pytest.approx(value("depth", 2))
    assert np.all((drawn.low <= drawn.mean) & (drawn.mean <= drawn.high))


def test_the_error_of_a_pooled_map_falls_with_the_runs() -> None:
    errors = [
        evidence_of(SETTING, *([one(seed=s)] for s in range(runs))).map_error(
            "standard", SETTING, "A", 0
        )
        for runs in (1, 4, 16)
    ]
    assert errors[0] == pytest.approx(0.05 / math.sqrt(CYCLES - 1), rel=0.5)
    assert errors[1] == pytest.approx(0.05 / math.sqrt(4 * (CYCLES - 1)), rel=0.3)
    assert errors[2] == pytest.approx(0.05 / math.sqrt(16 * (CYCLES - 1)), rel=0.15)


def test_runs_that_differ_widen_the_interval() -> None:
    same = [[one(seed=s)] for s in (1, 2, 3)]
    apart = [
        [one(seed=s, force={"A": mean, "C": 100.0})]
        for s, mean in ((1, 150.0), (2, 200.0), (3, 250.0))
    ]
    narrow = evidence_of(SETTING, *same).measured("standard", Place(SETTING, 0, "A"), "force")
    wide = evidence_of(SETTING, *apart).measured("standard", Place(SETTING, 0, "A"), "force")
    assert narrow is not None
    assert wide is not None
    assert wide.differ
    assert wide.high is not None
    assert narrow.high is not None
    assert wide.high - wide.value > 10.0 * (narrow.high - narrow.value)


def test_what_did_not_run_is_missing() -> None:
    evidence = evidence_of(SETTING, [one()])
    assert evidence.measured("standard", Place(SETTING, 1, "A"), "force") is None
    assert evidence.measured("standard", Place(SETTING, 2, "A"), "depth") is None
    assert evidence.measured("standard", Place(SETTING, 0, "A"), "depth") is None
    assert evidence.measured("swapped", Place(SETTING, 0, "A"), "force") is None
    broken = result(SETTING, [one()], status="failed")
    broken.document["stages"][0]["status"] = "failed"
    none = Evidence({("standard", SETTING): (broken,)})
    assert none.measured("standard", Place(SETTING, 0, "A"), "force") is None


def test_every_quantity_has_words_and_can_be_measured() -> None:
    evidence = Evidence.of(every_result())
    for quantity in QUANTITIES:
        joint = "" if "off" in quantity or quantity in SLIDER else "A"
        found = evidence.measured("standard", Place(SETTING, 1, joint), quantity)
        assert found is not None, quantity
        assert math.isfinite(found.value)


SLIDER = ("displacement", "velocity", "acceleration", "lag")
