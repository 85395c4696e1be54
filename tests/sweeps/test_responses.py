"""Responses of a result, against its arrays and statistics."""
# mypy: disable-error-code="union-attr,operator"

import math
from dataclasses import replace
from typing import cast

import numpy as np
import pytest
from bush import bush
from refusals import refused

import presswear as pw
from presswear.sweeps import responses
from presswear.sweeps.parameters import Column
from presswear.sweeps.response_limits import ResponseLimit, parse_limits
from presswear.sweeps.response_readers import Response

QUICK = {
    "engine": "dae",
    "integrator": "dopri5",
    "integration_tolerance": 1e-6,
    "wear_updates": 1,
}
SCENE = pw.scenes.wear_times(**QUICK, cycles=3, replicates=3)
USUAL = responses.request(SCENE)


@pytest.fixture(scope="module")
def result():
    return pw.run(SCENE, jobs=1)


def test_forces_depth_and_volume_are_those_of_the_arrays(result):
    values = responses.responses_of(result, USUAL)
    bearing = SCENE.bearing("A")
    forces = result.stages[1].joints["A"].each_cycle("force_max")
    force = values["A.force_max@1"]
    assert forces.min() <= cast(float, force.value) <= forces.max()
    peaks = result.stages[1].statistics.joints["A"].peak_force_per_cycle
    assert force.half_width == peaks.half_width
    for index in (0, 1):
        depths = [side.depth for side in result.stages[index].surfaces["A"]]
        assert values[f"A.depth@{index}"].value == max(depth.max() for depth in depths)
        area = 2.0 * math.pi * bearing.bearing_radius * bearing.width
        volume = area * sum(float(depth.mean()) for depth in depths)
        assert values[f"A.wear_volume@{index}"].value == pytest.approx(
            volume, rel=1e-12, abs=0
        )
    worn = values["A.wear_volume@1"]
    rate = values["A.wear_rate@0"]
    assert worn.value > 0.0
    assert rate.value == pytest.approx(
        worn.value / SCENE.cycles_per_update, rel=1e-9, abs=0
    )
    half_width = cast(float, worn.half_width) / SCENE.cycles_per_update
    assert rate.half_width == pytest.approx(half_width, rel=1e-9, abs=0)
    # As in a life, whose stages divide it into parts of another length
    other = replace(result, scene=replace(SCENE, cycles_per_update=None))
    assert responses.responses_of(other, USUAL)["A.wear_rate@0"] == rate


def test_bottom_dead_centre_is_compared_with_the_ideal(result):
    values = responses.responses_of(result, USUAL)
    first, second = (cast(float, values[f"bdc_error@{k}"].value) for k in (0, 1))
    heights = result.stages[1].each_cycle("bottom_height") - SCENE.bottom
    assert heights.min() <= second <= heights.max()
    assert values["bdc_drift@1"].value == pytest.approx(second - first, rel=1e-9, abs=0)
    assert values["bdc_drift@0"] == Response(0.0, 0.0)
    assert min(first, second) < 0.0


def test_declared_means_are_stored_and_reported_on_request(result):
    columns = [column.key for column in USUAL.columns]
    assert not any(key.endswith((".closed_time", "steps")) for key in columns)
    requested = responses.request(SCENE, ["A.closed_time@0", "steps"])
    assert requested.extra == USUAL.extra
    assert [column.unit for column in requested.columns] == ["s", ""]
    values = responses.responses_of(result, USUAL)
    first, last = (stage.statistics for stage in result.stages)
    estimate = first.joints["A"].means["closed_time"]
    expected = Response(estimate.mean, estimate.half_width)
    assert values["A.closed_time@0"] == expected
    assert values["steps"].value == last.means["steps"].mean
    assert "A.least_film" not in responses.available(SCENE)


def test_total_clearance_is_computed_on_request(result):
    usual = responses.responses_of(result, USUAL)
    assert not any(key.startswith("total_clearance") for key in usual)
    requested = responses.request(SCENE, ["total_clearance"])
    assert requested.extra != USUAL.extra
    value = responses.responses_of(result, requested)["total_clearance@1"].value
    assert value == pw.statics.total_clearance(SCENE.linkage(result.stages[1].surfaces))


@pytest.mark.parametrize("at_most", [1e12, 1e3])
def test_a_life_that_did_not_end_is_censored(at_most):
    limits = pw.Life(until="B.depth > 6 um", at_most=at_most)
    scene = bush(life=limits, replicates=2, wear_updates=1, cycles=3, tolerance=0.5)
    result = pw.run(scene, jobs=1)
    response = responses.responses_of(result, responses.request(scene))["life"]
    assert response.value == result.life.strokes
    assert response.censored == (at_most == 1e3)
    assert "life" in responses.available(scene)
    assert "life" not in responses.available(SCENE)


def peak(result: pw.Result) -> float:
    """Highest force at A in all stages."""
    return max(float(stage.joints["A"].force.max()) for stage in result.stages)


def highest(result: pw.Result) -> float:
    return peak(result)


def word(result: pw.Result) -> str:
    return "a word"


def test_responses_may_be_user_functions(result):
    requested = responses.request(SCENE, [peak, "A.force_max"])
    assert [column.key for column in requested.columns] == ["peak", "A.force_max"]
    assert requested.columns[0].text == "Highest force at A in all stages."
    values = responses.user_responses(result, requested.functions)
    assert values == {"peak": Response(peak(result))}
    assert requested.extra != responses.request(SCENE, [highest]).extra
    with refused("response word = 'a word': must be a number"):
        responses.user_responses(result, [cast(responses.User, word)])


def test_names_are_of_the_last_stage_or_of_a_given_one(result):
    requested = responses.request(SCENE, ["A.force_max", "A.force_max@00", "bdc_error"])
    values = responses.responses_of(result, requested)
    keys = [column.key for column in requested.columns]
    assert [values[key] for key in keys] == [
        values[key] for key in ("A.force_max@1", "A.force_max@0", "bdc_error@1")
    ]
    assert [column.unit for column in requested.columns] == ["N", "N", "m"]
    assert {column.key.rpartition(".")[2] for column in USUAL.columns} == {
        name
        for name, item in responses.RESPONSES.items()
        if item.in_table and not (item.optional or item.needs)
    }


COLUMNS = (Column("life", "", "strokes"), Column("A.force_max", "N", "peak"))


def test_limits_have_units():
    limits = parse_limits(["life >= 2e6", "A.force_max<=15kN"], COLUMNS)
    assert limits == {
        "life": ResponseLimit(2e6, True),
        "A.force_max": ResponseLimit(15e3, False),
    }


def test_lower_bounds_may_leave_a_violation_open():
    values = np.array([1.0, 1.0, 3.0, 3.0])
    censored = np.array([True, False, True, False])
    assert ResponseLimit(2.0, True).count(values, censored) == (1, 2)
    assert ResponseLimit(2.0, False).count(values, censored) == (2, 3)


@pytest.mark.parametrize(
    ("key", "expected"),
    [
        ("A.force_max@0", 15.0),  # 4 replicates of 4 settled cycles
        ("A.force_max", 3.0),
        ("repeatability", 15.0),
        ("A.wear_volume@1", 15.0),  # of the cycles before the wear update
        ("A.wear_volume", 3.0),
        ("life", 3.0),
    ],
)
def test_degrees_of_freedom_are_those_of_the_samples(key, expected):
    scene = pw.scenes.wear_times(engine="dae", cycles=6, replicates=4)
    assert responses.freedom_of(scene, key) == expected
    steps = pw.changed(scene, {"conventions": "refined"})
    assert responses.freedom_of(steps, "A.wear_volume@1") == 3.0
    assert (
        responses.freedom_of(pw.changed(scene, {"cycles": None}), "A.contacts@0")
        == math.inf
    )


def test_wear_of_surfaces_that_stay_new_is_no_usual_response():
    unworn = pw.scenes.wear_times(**QUICK | {"wear_updates": 0})
    names = {column.key for column in responses.request(unworn).columns}
    assert "A.wear_rate" in names
    assert not names & {"A.depth", "A.wear_volume"}
