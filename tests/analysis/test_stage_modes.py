"""Modes, sections and periods of stages that ran."""

import numpy as np
import pytest

import presswear as pw
from presswear.analysis.contact_modes import MODES, resonance, timeline_of
from presswear.analysis.periods import impacts_of, period_of, section_of
from presswear.results.press_analysis import settled_span
from presswear.results.result import Result


@pytest.fixture(scope="module")
def result() -> Result:
    scene = pw.scenes.slider_crank(cycles=6, replicates=1, recorded_cycles=6, sections=1)
    return pw.run(scene, engine="dae", jobs=1)


def test_shares_are_those_of_the_penetration(result: Result) -> None:
    """Time with penetration above 0, by the rows, is the time that is no free flight."""
    scene, stage = result.scene, result.stages[0]
    own = timeline_of(scene, stage, "B")
    begin, end = settled_span(scene, stage)
    assert own.edges[[0, -1]] == pytest.approx([begin, end], rel=1e-3)
    time = np.linspace(begin, end, 400_001)
    inside = np.interp(time, stage.time, stage.joints["B"].penetration) > 0.0
    assert 1.0 - own.shares["free flight"] == pytest.approx(inside.mean(), abs=2e-3)
    assert sum(own.shares[name] for name in MODES) == pytest.approx(1.0, rel=1e-12)
    visits = own.visits("impact")
    assert visits.size > 5
    assert resonance(stage, "B") == pytest.approx(0.5 / np.median(visits), rel=0.5)


def test_sections_that_were_kept_are_those_of_the_series(result: Result) -> None:
    """At the ends of the cycles, to the straight lines between rows."""
    scene, stage = result.scene, result.stages[0]
    kept, phase = section_of(scene, stage, "B")
    assert phase == 1.0
    eccentricity = stage.joints["B"].eccentricity
    at = scene.mechanism.period * np.arange(3, 6)
    for axis in range(2):
        found = np.interp(at, stage.time, eccentricity[:, axis])
        np.testing.assert_allclose(kept[:3, axis], found, rtol=0.0, atol=1e-6)
    assert period_of(scene, stage).period is None


def test_sections_at_touchdown_are_those_of_the_penetration(result: Result) -> None:
    """Where it rises through 0, and as fast as the pin then moves away from the centre."""
    scene, stage = result.scene, result.stages[0]
    phase, speed = impacts_of(scene, stage, "B")
    begin, end = settled_span(scene, stage)
    time, kept = np.unique(stage.time, return_index=True)
    own = stage.joints["B"]
    overlap, away = own.penetration[kept], np.hypot(*own.eccentricity[kept].T)
    inside = (time[:-1] > begin) & (time[1:] < end)
    (k,) = np.nonzero(inside & (overlap[:-1] < 0.0) & (overlap[1:] > 0.0))
    part = overlap[k] / (overlap[k] - overlap[k + 1])
    moment = time[k] + part * (time[k + 1] - time[k])
    found = moment / scene.mechanism.period % 1.0
    # A contact that goes on at the end is not among those kept.
    assert len(found) - len(phase) in (0, 1)
    assert len(phase) > 20
    np.testing.assert_allclose(phase, found[: len(phase)], rtol=0.0, atol=1e-4)
    rate = np.interp(moment, time, np.gradient(away, time))
    np.testing.assert_allclose(speed, rate[: len(phase)], rtol=0.05)
