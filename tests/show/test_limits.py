"""Numbers beside their limits, and their verdicts."""

from dataclasses import replace

import made_up_result as made
import pytest
from made_up_result import made_up

import presswear as pw
from presswear.recording.statistics import Estimate
from presswear.show.limits import limit_lines, verdict_on
from presswear.show.page import LimitLine
from presswear.show.report import render_report
from presswear.show.warnings import warnings


@pytest.mark.parametrize(
    ("estimate", "word"),
    [
        (Estimate.symmetric(0.5, 0.1, 30), "within the limit"),
        (Estimate.symmetric(0.8, 0.3, 30), "near the limit"),  # it may be above
        (Estimate(0.95), "near the limit"),
        (Estimate(0.85), "within the limit"),
        (Estimate.symmetric(1.1, 0.5, 30), "above the limit"),
    ],
)
def test_a_verdict_is_a_word_and_a_colour(estimate, word):
    assert verdict_on(estimate, 1.0).word == word
    assert verdict_on(estimate.scaled(3.0), 3.0) == verdict_on(estimate, 1.0)


def lines_of(scene: pw.Scene) -> dict[str, LimitLine]:
    stage = made_up(scene, 2).stages[1]
    return {line.number.name: line for line in limit_lines(scene, stage)}


def test_loads_of_bearings_stand_beside_their_limits():
    bearing = pw.Bearing(bearing_radius=0.01, width=0.02, pressure_limit=1e5)
    scene = pw.changed(replace(made.ONE, bearings={"C": bearing}), {"slip": "sliding"})
    result = made_up(scene, 2)
    force = result.stages[1].statistics.joints["C"].peak_force_per_cycle.mean
    lines = lines_of(scene)
    number, limit, verdict = lines["Pin pressure p"]
    assert number.value == f"{1e-6 * force / 4e-4:.2f} MPa"
    assert (limit, verdict.word) == ("0.100 MPa", "above the limit")
    assert lines["p v"].verdict.word == "no limit is set"
    assert lines["p v"].limit == "set pv_limit"
    page = render_report(result)
    assert '<span class="light bad"><span aria-hidden="true">■</span> above the' in page
    near = replace(bearing, pressure_limit=1.001 * force / 4e-4)
    near_line = lines_of(replace(scene, bearings={"C": near}))["Pin pressure p"]
    assert near_line.verdict.word == "near the limit"
    # The convention of the paper counts another distance.
    turned = pw.changed(scene, {"slip": "angle", "C.pv_limit": "1 MPa m/s"})
    assert "p v" not in lines_of(turned)
    assert any(
        "pv_limit is not compared" in line for line in warnings(made_up(turned, 2))
    )


def test_the_report_states_the_command_version_and_date():
    result = made_up(made.BOTH, 1)
    assert "Made by presswear 0.1.0, 2024-01-01 00:00:00 UTC" in render_report(result)
    origin = {**result.provenance, "command": "presswear run 'my press.toml'"}
    page = render_report(replace(result, provenance=origin))
    assert "Made by presswear run &#39;my press.toml&#39;, presswear 0.1.0" in page
