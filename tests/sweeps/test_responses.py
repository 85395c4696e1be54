"""Responses of a result, against its arrays and statistics."""

import math
from typing import cast

import numpy as np
import pytest

import presswear as pw
from presswear.physics.statics import total_clearance
from presswear.sweeps.parameters import Column
from presswear.sweeps.responses import (
    RESPONSES,
    Limit,
    Response,
    User,
    available,
    parse_limits,
    request,
    responses_of,
)
from presswear.sweeps.runner import Outcome
from presswear.tools.errors import InputError

SCENE = pw.scenes.wear_times(
    engine="dae",
    integrator="dopri5",
    integration_tolerance=1e-6,
    wear_updates=1,
    cycles=3,
    replicates=3,
)
USUAL = request(SCENE)


@pytest.fixture(scope="module")
def result() -> pw.Result:
    return pw.run(SCENE, jobs=1)


def test_forces_depth_and_volume_are_those_of_the_arrays(result: pw.Result) -> None:
    values, bearing = responses_of(result, USUAL), SCENE.bearing("A")
    forces = result.stages[1].joints["A"].each_cycle("force_max")
    force = values["A.force_max@1"]
    assert forces.min() <= cast(float, force.value) <= forces.max()
    assert force.half_width is not None
    for index in (0, 1):
        depths = [side.depth for side in result.stages[index].surfaces["A"]]
        assert values[f"A.depth@{index}"].value == max(depth.max() for depth in depths)
        area = 2.0 * math.pi * bearing.bearing_radius * bearing.width
        volume = area * sum(float(depth.mean()) for depth in depths)
        assert values[f"A.wear_volume@{index}"].value == pytest.approx(volume, rel=1e-12, abs=0)
    worn = values["A.wear_volume@1"]
    rate = values["A.wear_rate@0"]
    assert worn.value is not None
    assert worn.value > 0.0
    assert rate.value == pytest.approx(worn.value / SCENE.cycles_per_update, rel=1e-9, abs=0)
    half_width = cast(float, worn.half_width) / SCENE.cycles_per_update
    assert rate.half_width == pytest.approx(half_width, rel=1e-9, abs=0)


def test_bottom_dead_centre_is_compared_with_the_ideal(result: pw.Result) -> None:
    values = responses_of(result, USUAL)
    first, second = (cast(float, values[f"bdc_error@{k}"].value) for k in (0, 1))
    heights = result.stages[1].each_cycle("bottom_height") - SCENE.bottom
    assert heights.min() <= second <= heights.max()
    assert values["bdc_drift@1"].value == pytest.approx(second - first, rel=1e-9, abs=0)
    assert values["bdc_drift@0"] == Response(0.0, 0.0)


def test_total_clearance_is_computed_on_request(result: pw.Result) -> None:
    assert not any(key.startswith("total_clearance") for key in responses_of(result, USUAL))
    requested = request(SCENE, ["total_clearance"])
    assert requested.extra != USUAL.extra
    value = responses_of(result, requested)["total_clearance@1"].value
    assert value == total_clearance(SCENE.linkage(result.stages[1].surfaces))


def test_a_life_that_did_not_end_is_censored() -> None:
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
    response = responses_of(result, request(scene))["life"]
    assert response.value == result.life.strokes
    assert response.censored == (result.life.first is None)
    assert "life" in available(scene)
    assert "life" not in available(SCENE)


def peak(result: pw.Result) -> float:
    """Highest force at A in all stages."""
    return max(float(stage.joints["A"].force.max()) for stage in result.stages)


def highest(result: pw.Result) -> float:
    return peak(result)


def word(result: pw.Result) -> str:
    return "a word"


def test_responses_may_be_user_functions(result: pw.Result) -> None:
    requested = request(SCENE, [peak, "A.force_max"])
    assert [column.key for column in requested.columns] == ["peak", "A.force_max"]
    assert requested.columns[0].text == "Highest force at A in all stages."
    assert responses_of(result, requested)["peak"] == Response(peak(result))
    assert requested.extra != request(SCENE, [highest]).extra
    with pytest.raises(InputError, match="response word = 'a word': must be a number"):
        responses_of(result, request(SCENE, [cast(User, word)]))


def test_names_are_of_the_last_stage_or_of_a_given_one(result: pw.Result) -> None:
    requested = request(SCENE, ["A.force_max", "A.force_max@0", "bdc_error"])
    outcome = Outcome(responses_of(result, USUAL), len(result.stages))
    expected = ("A.force_max@1", "A.force_max@0", "bdc_error@1")
    for key, name in zip(requested.keys, expected, strict=True):
        assert outcome.response(key) == outcome.values[name]
    assert [column.unit for column in requested.columns] == ["N", "N", "m"]
    assert {column.key.rpartition(".")[2] for column in USUAL.columns} == {
        name for name, item in RESPONSES.items() if not item.optional and name != "life"
    }


COLUMNS = (Column("life", "", "strokes"), Column("A.force_max", "N", "peak"))


def test_limits_have_units() -> None:
    limits = parse_limits(["life >= 2e6", "A.force_max<=15kN"], COLUMNS)
    assert limits == {"life": Limit(2e6, True), "A.force_max": Limit(15e3, False)}


def test_lower_bounds_may_leave_a_violation_open() -> None:
    values, censored = np.array([1.0, 1.0, 3.0, 3.0]), np.array([True, False, True, False])
    assert Limit(2.0, True).count(values, censored) == (1, 2)
    assert Limit(2.0, False).count(values, censored) == (2, 3)
