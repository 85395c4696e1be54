"""Which joint to improve first."""

import math

import pytest
from refusals import refused

import presswear as pw
from presswear.recording.statistics import Estimate
from presswear.sweeps.improve import (
    BOTTOM,
    FORCE,
    LIFE,
    TILT,
    Improvement,
    _effect,
    changes_of,
    improve,
    write_report,
)
from presswear.tools.numbers import large

SMALL = {"engine": "dae", "cycles": 3, "replicates": 2, "cycles_per_update": 1e3}
CHANGE = "joint B, clearance times 0.5"


def test_each_joint_is_changed_in_each_way():
    scene = pw.scenes.wear_times()
    changes = changes_of(scene)
    assert {change.split(",")[0] for change in changes} == {"joint A", "joint C"}
    half = {"C.clearance": 0.5 * scene.bearing("C").clearance}
    assert changes["joint C, clearance times 0.5"] == half
    # One side of each other pair wears more than both of the paper's.
    assert not any("materials" in change for change in changes)
    changes = changes_of(pw.scenes.wear_times(materials="304L-304L"))
    words = {change.rpartition(" ")[2] for change in changes if "materials" in change}
    assert words == {"paper", "316L-304L"}
    with refused("no joint has clearance"):
        changes_of(pw.scenes.ideal())


@pytest.fixture
def sizes_alone(monkeypatch):
    """Leave out other materials, each of which takes a run."""
    monkeypatch.setattr("presswear.sweeps.improve.MATERIALS", {})


@pytest.mark.usefixtures("sizes_alone")
def test_a_guide_is_improved(tmp_path):
    """Half of the clearance is half of the tilt, and wear of the walls goes as 1 / width."""
    settings = {"cycles": 4, "replicates": 2, "cycles_per_update": 1e3}
    found = improve(pw.scenes.press_off_centre(**settings), tmp_path, jobs=1)
    assert list(found.effects) == [LIFE, FORCE, TILT]
    factors = {
        key: {item.change: item.factor.mean for item in items}
        for key, items in found.effects.items()
    }
    half, wide = "joint guide, clearance times 0.5", "joint guide, width times 1.25"
    assert factors[LIFE][wide] == pytest.approx(1.25, rel=0.1)
    assert factors[FORCE][half] < 0.8
    # Of 254 um/m, 250 are those of the clearance.
    assert factors[TILT][half] == pytest.approx(0.5, abs=0.05)
    assert found.heading(TILT).endswith("µm/m after 1\u202f000 strokes")


def test_factors_have_the_intervals_of_ratios():
    """Relative errors of 3 and 4 per cent add to 5; a shorter life is a larger depth."""
    new = Estimate.symmetric(2.0, 0.06).positive
    old = Estimate.symmetric(1.0, 0.04).positive
    force = _effect(CHANGE, FORCE, new, old)
    life = _effect(CHANGE, LIFE, new, old)
    assert (force.factor.mean, life.factor.mean) == (2.0, 0.5)
    assert force.factor.high == pytest.approx(2.0 * math.exp(0.05))
    assert life.factor.low == pytest.approx(0.5 * math.exp(-0.05))
    assert not force.is_better
    assert not life.is_better
    assert _effect(CHANGE, FORCE, old, new).is_better
    below = Estimate(-1.0, -math.exp(0.04), -math.exp(-0.04))  # of bottom dead centre
    assert _effect(CHANGE, BOTTOM, below, below).factor.high == pytest.approx(
        math.exp(0.04 * 2**0.5)
    )
    wide = Estimate.symmetric(1.0, 1.0)
    assert not _effect(CHANGE, FORCE, wide, new).is_better
    assert not _effect(CHANGE, FORCE, Estimate(1.0), new).is_better


def test_the_report_has_answers_factors_and_failed_runs(tmp_path):
    one = Estimate.symmetric(1.0, 0.01)
    two = Estimate.symmetric(2.0, 0.01)
    effect = _effect(CHANGE, LIFE, one, two)
    effects = {LIFE: [effect], FORCE: [_effect("worse", FORCE, two, one)]}
    found = Improvement(effects, {"joint A, <b>": "it <i>ended</i>"})
    file = write_report(found, pw.scenes.wear_times(), tmp_path)
    page = file.read_text().replace("\xa0", " ")
    assert "Life: best is joint B, clearance times 0.5: 2.00 (1.98 to 2.02)" in page
    assert "<td>1.98 to 2.02</td><td>certainly worse</td>" in page
    assert "it &lt;i&gt;ended&lt;/i&gt;" in page
    assert "no tried change improves it" in page
    assert f"presswear report {tmp_path}/as-it-is {tmp_path}/joint-B" in page
    assert (tmp_path / "figures" / "improve.svg").stat().st_size > 5000


@pytest.mark.parametrize(
    ("factor", "verdict"),
    [
        (0.98, "certain improvement"),
        (0.9975, "no effect"),
        (1.001, "no effect"),
        (1.02, "certainly worse"),
    ],
)
def test_a_factor_that_is_printed_as_one_is_no_improvement(factor, verdict):
    """Equal replicates have intervals of 0.01 %, beyond which a gain of 0.25 % lies."""
    present = Estimate.symmetric(1.0, 1e-4)
    effect = _effect(CHANGE, FORCE, present.scaled(factor), present)
    assert effect.verdict == verdict
    sentence = Improvement({FORCE: [effect]}, {}).sentences[0]
    assert ("best is" in sentence) == (verdict == "certain improvement")
    longer = _effect(CHANGE, LIFE, present.scaled(factor), present)
    assert longer.verdict == verdict
    wide = _effect(CHANGE, FORCE, Estimate.symmetric(factor, 0.1), present)
    assert wide.verdict == "not certain"


def test_changes_are_compared_after_the_same_strokes(tmp_path):
    """Half the clearance would be worn by a tenth after half as many."""
    settings = {
        "engine": "dae",
        "cycles": 3,
        "replicates": 1,
        "cycles_per_update": None,
    }
    scene = pw.changed(pw.scenes.slider_crank(**settings), {"extrapolation": "single"})
    found = improve(scene, tmp_path, jobs=1)
    results = [pw.load(file.parent) for file in tmp_path.glob("*/result.json")]
    assert len(results) == 1 + len(changes_of(scene))
    (strokes,) = {result.stages[0].cycles_per_update for result in results}
    assert found.heading(FORCE).endswith(f"N after {large(strokes)} strokes")


def test_a_mechanism_is_improved(tmp_path):
    scene = pw.scenes.slider_crank(**SMALL)
    found = improve(scene, tmp_path, jobs=1)
    assert list(found.effects) == [LIFE, FORCE, BOTTOM]
    for items in found.effects.values():
        assert {item.change for item in items} | found.failures.keys() == changes_of(
            scene
        ).keys()
        assert all(item.factor.mean > 0.0 for item in items)
    # Finished runs are not repeated.
    files = {file: file.stat().st_mtime_ns for file in tmp_path.rglob("stage-*.npz")}
    assert improve(scene, tmp_path, jobs=1) == found
    assert {
        file: file.stat().st_mtime_ns for file in tmp_path.rglob("stage-*.npz")
    } == files
