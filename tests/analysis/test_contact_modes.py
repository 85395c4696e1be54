"""Contact modes of made-up penetrations, and modes, sections and periods of stages that ran."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_less

import presswear as pw
from presswear.analysis.contact_modes import (
    FREE,
    IMPACT,
    MODES,
    STICKING,
    SUSTAINED,
    Timeline,
    impact_limits,
    timeline,
    timeline_of,
)
from presswear.analysis.periods import impacts_of
from presswear.results.sampled_cycles import sampled_span

CONTACTS = np.array([[1.0, 1.01], [2.0, 2.01], [3.0, 5.0], [6.0, 6.01], [7.0, 7.01]])
CLOSING = np.array([1.0, 1.0, 0.1, 1.0, 1.0])
TIME = np.linspace(0.0, 8.0, 801)
SLIDING = TIME - 4.0


def made(slow: float = 0.5) -> Timeline:
    return timeline((0.0, 8.0), CONTACTS, CLOSING, (TIME, SLIDING), slow)


def test_modes_follow_each_other():
    """The long contact sticks while it slides at less than 0.5 m/s, from 3.5 to 4.5 s."""
    line = made()
    edges = [0.0, 1.0, 1.01, 2.0, 2.01, 3.0, 3.5, 4.5, 5.0, 6.0, 6.01, 7.0, 7.01, 8.0]
    assert_allclose(line.edges, edges, rtol=0.0, atol=1e-12)
    rest = [SUSTAINED, STICKING, SUSTAINED]
    hits = [FREE, IMPACT]
    assert line.mode.tolist() == [*hits, *hits, FREE, *rest, *hits, *hits, FREE]


def test_shares_transitions_and_visits():
    line = made()
    shares = line.shares
    counts = line.transitions
    assert sum(shares.values()) == pytest.approx(1.0, rel=1e-12)
    assert shares["impact"] == pytest.approx(0.04 / 8.0, rel=1e-9)
    assert shares["sustained contact"] == pytest.approx(1.0 / 8.0, rel=1e-9)
    assert shares["sticking"] == pytest.approx(1.0 / 8.0, rel=1e-9)
    assert counts.sum() == line.mode.size - 1
    assert counts[FREE, IMPACT] == 4
    assert counts[SUSTAINED, STICKING] == counts[STICKING, SUSTAINED] == 1
    assert np.trace(counts) == 0
    assert_allclose(line.visits("impact"), 0.01, rtol=1e-9)
    # The first and the last flight go on beyond what is known.
    assert_allclose(line.visits("free flight"), [0.99, 0.99, 1.0, 0.99], rtol=1e-9)


def test_parts_of_the_cycle():
    """The first of four bins of a cycle of 4 s holds 0 to 1 s and 4 to 5 s."""
    parts = made().over_phase(4.0, 4)
    assert_allclose(parts.sum(axis=0), 1.0, rtol=1e-12)
    expected = {FREE: 0.5, STICKING: 0.25, SUSTAINED: 0.25}
    for mode, part in expected.items():
        assert parts[mode, 0] == pytest.approx(part, rel=1e-9)
    assert parts[IMPACT, 1] == pytest.approx(0.005, rel=1e-9)


def test_a_hertzian_impact_lasts_longer_when_it_is_slower():
    """Durations go with the closing speed to the power of -1/5: all of them are impacts."""
    closing = np.geomspace(1e-3, 1.0, 50)
    duration = 1e-4 * closing**-0.2
    assert np.all(duration <= impact_limits(duration, closing))
    assert not np.any(3.0 * duration <= impact_limits(duration, closing))
    assert impact_limits(np.zeros(0), np.zeros(0)).size == 0


def test_contacts_beyond_the_span_are_cut():
    line = timeline((1.005, 4.0), CONTACTS, CLOSING, (TIME, SLIDING), 0.0)
    assert line.edges[0] == 1.005
    assert line.edges[-1] == 4.0
    assert [MODES[mode] for mode in line.mode[[0, -1]]] == [
        "impact",
        "sustained contact",
    ]


@pytest.fixture(scope="module")
def result():
    scene = pw.scenes.slider_crank(
        cycles=6, replicates=1, recorded_cycles=6, sections=1
    )
    return pw.run(scene, engine="dae", jobs=1)


def test_shares_are_those_of_the_penetration(result):
    """Time with penetration above 0, by the rows, is the time that is no free flight."""
    scene = result.scene
    stage = result.stages[0]
    own = timeline_of(scene, stage, "B")
    begin, end = sampled_span(scene, stage)
    assert own.edges[[0, -1]] == pytest.approx([begin, end], rel=1e-3)
    time = np.linspace(begin, end, 400_001)
    inside = np.interp(time, stage.time, stage.joints["B"].penetration) > 0.0
    assert 1.0 - own.shares["free flight"] == pytest.approx(inside.mean(), abs=2e-3)
    assert sum(own.shares[name] for name in MODES) == pytest.approx(1.0, rel=1e-12)
    assert own.visits("impact").size > 5


def test_sections_at_touchdown_are_those_of_the_penetration(result):
    """Where it rises through 0, and as fast as the pin then moves away from the centre."""
    scene = result.scene
    stage = result.stages[0]
    phase, speed = impacts_of(scene, stage, "B")
    begin, end = sampled_span(scene, stage)
    time, kept = np.unique(stage.time, return_index=True)
    own = stage.joints["B"]
    overlap = own.penetration[kept]
    away = np.hypot(*own.eccentricity[kept].T)
    inside = (time[:-1] > begin) & (time[1:] < end)
    (k,) = np.nonzero(inside & (overlap[:-1] < 0.0) & (overlap[1:] > 0.0))
    part = overlap[k] / (overlap[k] - overlap[k + 1])
    moment = time[k] + part * (time[k + 1] - time[k])
    found = moment / scene.mechanism.period % 1.0
    rate = np.interp(moment, time, np.gradient(away, time))
    # Light touchdowns may lie between two rows.
    hard = speed > 0.2 * speed.max()
    assert hard.sum() > 5
    apart = abs(found[:, None] - phase)
    assert_array_less(apart.min(axis=0)[hard], 1e-4)
    assert_allclose(speed[hard], rate[apart.argmin(axis=0)][hard], rtol=0.05)
    # A contact that goes on at the end is not among those kept.
    hard = rate[:-1] > 0.2 * speed.max()
    assert_array_less(apart.min(axis=1)[:-1][hard], 1e-4)
