"""Diagrams: what is typed, how a run goes on at another value, and a folder that was stopped."""

from pathlib import Path

import numpy as np
import pytest

import presswear as pw
from presswear.bifurcation import branch
from presswear.bifurcation.branch import OPEN, Branch, moved, point, read_points
from presswear.bifurcation.diagram import WAYS, Diagram, compute, load
from presswear.bifurcation.figure import draw
from presswear.bifurcation.over import Extent, Over
from presswear.campaign.replicates import start_of
from presswear.engines.base import Plan
from presswear.physics.constraints import constraints_of

SCENE = pw.scenes.slider_crank()
EXTENT = Extent(12, 6, 0, 0)


def test_a_quantity_is_read_with_its_unit() -> None:
    over = Over.parsed("clearance=0.01:0.05:5 mm", SCENE)
    np.testing.assert_allclose(over.values, 1e-5 * np.arange(1, 6), rtol=1e-12)
    assert over.scene(SCENE, 2e-5).bearing("B").clearance == 2e-5
    turning = Over.parsed("speed=2pi:12pi:3 rad/s", SCENE)
    # Values of a range have 12 digits.
    np.testing.assert_allclose(turning.values, np.pi * np.array([2.0, 7.0, 12.0]), rtol=5e-12)
    assert turning.unit == "rad/s"
    assert Over.parsed("B.friction=0.1:0:2", SCENE).values == (0.0, 0.1)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("speed", "KEY=FIRST:LAST:COUNT"),
        ("speed=1:2", "FIRST:LAST:COUNT"),
        ("speed=1:2:3", "no unit"),
        ("speed=1 rad/s", "two values that differ"),
        ("sped=1:2:3", "did you mean speed"),
        ("speed=1:2:1 rad/s", "a whole number of values from 2"),
        ("speed=0:20:5 rad/s", "speed = 0"),
        ("speed=1:20:5 mm", "unknown unit 'mm'"),
        ("cycles=1:20:5", "not a count"),
        ("engine=dae,exudyn", "not a count or a choice"),
    ],
)
def test_what_is_no_range_is_refused(text: str, words: str) -> None:
    with pytest.raises(pw.InputError, match=words):
        Over.parsed(text, SCENE)


def test_pins_keep_their_places_in_parts_of_the_clearance() -> None:
    before = SCENE.linkage()
    other = pw.scenes.slider_crank(clearance="0.4 mm", speed="500 rad/s")
    start = start_of(SCENE)
    run = branch.ENGINE.simulate(before, start, Plan(SCENE.mechanism.period, 3, 1))
    linkage = other.linkage()
    went = moved(linkage, before, run.end, start_of(other))
    phi, phi_t, *_ = constraints_of(linkage).evaluate(0.0, went.position, went.velocity)
    assert np.abs(phi).max() < 1e-12
    assert np.abs(phi_t).max() < 1e-9
    old, new = (
        branch._eccentricities(own)(at)
        for own, at in ((before, run.end.position), (linkage, went.position))
    )
    cap = min(1.0, (1.0 - OPEN) * 5e-4 / np.hypot(*old))
    np.testing.assert_allclose(new, 0.8 * cap * old, rtol=1e-6)
    np.testing.assert_allclose(
        went.velocity, 500.0 / before.drives[0].speed * run.end.velocity, rtol=0.0, atol=0.3
    )


def test_a_stopped_branch_goes_on_as_if_it_had_not(tmp_path: Path) -> None:
    over = Over.parsed("clearance=0.01:0.05:4 mm", SCENE)
    values = over.values
    whole = Branch(SCENE, over, values, EXTENT, tmp_path / "whole.npz")
    whole(lambda done, word="", rows=None: None)
    Branch(SCENE, over, values[:2], EXTENT, tmp_path / "parts.npz")(lambda *told: None)
    Branch(SCENE, over, values, EXTENT, tmp_path / "parts.npz")(lambda *told: None)
    found = read_points(tmp_path / "parts.npz")
    for name, own in vars(read_points(tmp_path / "whole.npz")).items():
        np.testing.assert_array_equal(getattr(found, name), own)
    assert found.value.tolist() == list(values)


def test_periods_of_a_small_clearance(tmp_path: Path) -> None:
    """At 10 um the motion settles to the crank's; at 0.3 mm it does not within 60 cycles."""
    over = Over.parsed("clearance=0.01:0.3:2 mm", SCENE)
    diagram = compute(SCENE, over, Extent(60, 30, 4, 0), tmp_path, 1, lambda way, part: None)
    for way in WAYS:
        points = diagram.branches[way]
        periods = dict(zip(points.value, diagram.periods(way), strict=True))
        small, large = periods[1e-5], periods[3e-4]
        assert small is not None
        assert large is not None
        assert small.period == 1
        assert large.period is None
        chaotic = points.exponent[points.value == 3e-4][0]
        assert chaotic[0] > 0.0
    assert "at 1 (period 1 at 1)" in diagram.words[0]
    assert load(tmp_path).words == diagram.words
    drawing = draw(diagram)
    assert "(degrees)" in drawing.sheet.axes[0].get_ylabel()
    with pytest.raises(pw.InputError, match="a diagram with another extent"):
        compute(SCENE, over, EXTENT, tmp_path, 1, lambda way, part: None)


def test_a_run_that_fails_leaves_gaps(monkeypatch: pytest.MonkeyPatch) -> None:
    """Steps that vanish: the numbers of that value are none, and the next one begins anew."""
    monkeypatch.setattr(branch, "ENGINE", pw.InHouse("rk4", equal_step=1e-2))
    found = point(SCENE, start_of(SCENE), EXTENT)
    assert np.isnan(found.force).all()
    assert np.isnan(found.sections).all()
    np.testing.assert_array_equal(found.end.position, start_of(SCENE).position)
    points = branch._nothing(found).and_point(1.0, found)
    told = Diagram(SCENE, Over.parsed("speed=1:2:2 rad/s", SCENE), EXTENT, {"up": points})
    assert told.periods("up") == [None]
    assert "1 runs failed" in told.words[0]
