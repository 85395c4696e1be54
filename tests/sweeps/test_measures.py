"""Measures of a result, against its arrays and statistics."""

import math
from typing import cast

import numpy as np
import pytest

import presswear as pw
from presswear.physics.statics import total_clearance
from presswear.sweeps.measures import (
    MEASURES,
    Found,
    Own,
    at_last,
    measured,
    measures_asked,
    usual_names,
)

SCENE = pw.scenes.wear_times(
    engine="dae",
    integrator="dopri5",
    integration_tolerance=1e-6,
    wear_updates=1,
    cycles=3,
    replicates=3,
)


@pytest.fixture(scope="module")
def result() -> pw.Result:
    return pw.run(SCENE, jobs=1)


def test_peak_forces_are_means_over_the_settled_strokes(result: pw.Result) -> None:
    for index, stage in enumerate(result.stages):
        told = stage.joints["A"].statistics.peak_force_per_cycle
        found = measured(result)[f"A.force_max@{index}"]
        assert found == Found(told.mean, told.half_width or math.nan)
        forces = stage.joints["A"].each_cycle("force_max")
        assert forces.min() <= found.value <= forces.max()


def test_depth_and_volume_are_those_of_the_surfaces(result: pw.Result) -> None:
    found, bearing = measured(result), SCENE.bearing("A")
    for index in (0, 1):
        sides = result.stages[index].surfaces["A"]
        depths = [side.depth for side in sides]
        assert found[f"A.depth@{index}"].value == max(own.max() for own in depths)
        # The mean depth times the area of the bearing.
        area = 2.0 * math.pi * bearing.bearing_radius * bearing.width
        volume = area * sum(float(own.mean()) for own in depths)
        assert found[f"A.wear_volume@{index}"].value == pytest.approx(volume, rel=1e-12, abs=0)
    assert found["A.depth@1"].value > 0.0
    told = result.stages[0].joints["A"].statistics
    assert found["A.wear_volume@1"].value == pytest.approx(told.wear_volume.mean, rel=1e-9, abs=0)
    assert found["A.wear_volume@1"].half == told.wear_volume.half_width
    ends = [told.wear_peaks[side].depth.half_width for side in ("bearing", "pin")]
    assert found["A.depth@1"].half in ends


def test_a_rate_is_a_wear_over_the_strokes_that_it_stands_for(result: pw.Result) -> None:
    told = result.stages[0].joints["A"].statistics
    found = measured(result)["A.wear_rate@0"]
    strokes = SCENE.cycles_per_update
    assert found.value == pytest.approx(told.wear_volume.mean / strokes, abs=0)
    assert found.half == pytest.approx(told.wear_volume.scaled(1.0 / strokes).half_width, abs=0)


def test_bottom_dead_centre_is_held_against_the_ideal(result: pw.Result) -> None:
    found = measured(result)
    errors = [found[f"bdc_error@{index}"] for index in (0, 1)]
    low, high = (
        end(result.stages[1].each_cycle("bottom_height")) - SCENE.bottom for end in (min, max)
    )
    assert low <= errors[1].value <= high
    drift = found["bdc_drift@1"]
    assert drift.value == pytest.approx(errors[1].value - errors[0].value, rel=1e-9, abs=0)
    assert drift.half == pytest.approx(math.hypot(errors[0].half, errors[1].half), abs=0)
    assert found["bdc_drift@0"] == Found(0.0, 0.0)


def test_what_is_dear_is_found_where_it_is_asked_for(result: pw.Result) -> None:
    assert not any(key.startswith("total_clearance") for key in measured(result))
    found = measured(result, ["total_clearance"])["total_clearance@1"]
    worn = SCENE.linkage(result.stages[1].surfaces)
    assert found.value == total_clearance(worn)


def test_a_life_that_no_limit_ends_is_a_lower_bound() -> None:
    scene = pw.scenes.press_blanking(
        engine="dae",
        integrator="dopri5",
        integration_tolerance=1e-6,
        conventions="refined",
        replicates=2,
        wear_updates=1,
        cycles=1,
        **{"life": "limits", "life.until": "depth > 1 um", "life.max_cycles": 64},
    )
    result = pw.run(scene, jobs=1, check=False)
    assert result.life is not None
    found = measured(result)["life"]
    assert found.value == result.life.strokes
    assert found.is_beyond == (result.life.first is None)
    assert "life" in usual_names(scene)
    assert "life" not in usual_names(SCENE)


def peak(result: pw.Result) -> float:
    """Highest force at A in all stages."""
    return max(float(stage.joints["A"].statistics.peak_force) for stage in result.stages)


def highest(result: pw.Result) -> float:
    return peak(result)


def word(result: pw.Result) -> str:
    return "a word"


def test_a_measure_of_ones_own_gives_a_number(result: pw.Result) -> None:
    with pytest.raises(pw.InputError, match="measure word gives 'a word': a number is expected"):
        measured(result, own=[cast(Own, word)])


def test_measures_of_ones_own_are_functions_of_a_result(result: pw.Result) -> None:
    asked = measures_asked(SCENE, [peak, "A.force_max"])
    assert [own.key for own in asked.columns] == ["peak", "A.force_max"]
    assert asked.columns[0].text == "Highest force at A in all stages."
    found = measured(result, own=asked.own)["peak"]
    assert found.value == peak(result)
    assert math.isnan(found.half)
    assert asked.further
    assert asked.further != measures_asked(SCENE, [highest]).further
    assert not measures_asked(SCENE, ["A.force_max"]).further


def test_names_are_of_the_last_stage_or_of_a_given_one(result: pw.Result) -> None:
    asked = measures_asked(SCENE, ["A.force_max", "A.force_max@0", "bdc_error"])
    keys = [at_last(key, len(result.stages)) for key in asked.keys]
    assert keys == ["A.force_max@1", "A.force_max@0", "bdc_error@1"]
    assert set(keys) <= measured(result).keys()
    assert [own.unit for own in asked.columns] == ["N", "N", "m"]


def test_all_usual_measures_are_found_and_asked_for_where_none_is_named(
    result: pw.Result,
) -> None:
    asked = measures_asked(SCENE, [])
    found = measured(result)
    assert {at_last(key, 2) for key in asked.keys} <= found.keys() | {"repeatability@1"}
    assert {own.key.rpartition(".")[2] for own in asked.columns} == {
        name for name, own in MEASURES.items() if not own.is_dear and name != "life"
    }
    assert all(np.isfinite(own.value) for own in found.values())


@pytest.mark.parametrize(
    ("name", "told"),
    [
        ("A.forcemax", r"did you mean A\.force_max"),
        ("B.depth", "unknown measure 'B.depth'"),
        ("bdc_eror", "did you mean bdc_error"),
        ("A.depth@2", "a stage from 0 to wear_updates = 1"),
        ("A.depth@x", "NAME@STAGE"),
        ("life", "unknown measure 'life'"),
    ],
)
def test_what_is_no_measure_is_refused(name: str, told: str) -> None:
    with pytest.raises(pw.InputError, match=told):
        measures_asked(SCENE, [name])


def test_a_measure_is_asked_for_once() -> None:
    with pytest.raises(pw.InputError, match="asked for twice"):
        measures_asked(SCENE, ["A.depth", "A.depth"])
