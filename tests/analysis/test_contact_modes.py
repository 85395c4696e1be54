"""Contact modes of synthetic contacts with prescribed times."""

import numpy as np
import pytest

from presswear.analysis.contact_modes import (
    FREE,
    IMPACT,
    MODES,
    STICKING,
    SUSTAINED,
    Timeline,
    combine,
    impact_limits,
    resonance_frequency,
    timeline,
)

CONTACTS = np.array([[1.0, 1.01], [2.0, 2.01], [3.0, 5.0], [6.0, 6.01], [7.0, 7.01]])
CLOSING = np.array([1.0, 1.0, 0.1, 1.0, 1.0])
TIME = np.linspace(0.0, 8.0, 801)
SLIDING = TIME - 4.0


def made(slow: float = 0.5) -> Timeline:
    return timeline((0.0, 8.0), CONTACTS, CLOSING, (TIME, SLIDING), slow)


def test_modes_follow_each_other() -> None:
    """The long contact sticks while it slides at less than 0.5 m/s, from 3.5 to 4.5 s."""
    line = made()
    edges = [0.0, 1.0, 1.01, 2.0, 2.01, 3.0, 3.5, 4.5, 5.0, 6.0, 6.01, 7.0, 7.01, 8.0]
    np.testing.assert_allclose(line.edges, edges, rtol=0.0, atol=1e-12)
    rest = [SUSTAINED, STICKING, SUSTAINED]
    hits = [FREE, IMPACT]
    assert line.mode.tolist() == [*hits, *hits, FREE, *rest, *hits, *hits, FREE]


def test_shares_transitions_and_visits() -> None:
    line = made()
    shares, counts = line.shares, line.transitions
    assert sum(shares.values()) == pytest.approx(1.0, rel=1e-12)
    assert shares["impact"] == pytest.approx(0.04 / 8.0, rel=1e-9)
    assert shares["sustained contact"] == pytest.approx(1.0 / 8.0, rel=1e-9)
    assert shares["sticking"] == pytest.approx(1.0 / 8.0, rel=1e-9)
    assert counts.sum() == line.mode.size - 1
    assert counts[FREE, IMPACT] == 4
    assert counts[SUSTAINED, STICKING] == counts[STICKING, SUSTAINED] == 1
    assert np.trace(counts) == 0
    np.testing.assert_allclose(line.visits("impact"), 0.01, rtol=1e-9)
    # The first and the last flight go on beyond what is known.
    np.testing.assert_allclose(line.visits("free flight"), [0.99, 0.99, 1.0, 0.99], rtol=1e-9)


def test_parts_of_the_cycle() -> None:
    """The first of four bins of a cycle of 4 s holds 0 to 1 s and 4 to 5 s."""
    parts = made().over_phase(4.0, 4)
    np.testing.assert_allclose(parts.sum(axis=0), 1.0, rtol=1e-12)
    expected = {FREE: 0.5, STICKING: 0.25, SUSTAINED: 0.25}
    for mode, part in expected.items():
        assert parts[mode, 0] == pytest.approx(part, rel=1e-9)
    assert parts[IMPACT, 1] == pytest.approx(0.005, rel=1e-9)


def test_a_hertzian_impact_lasts_longer_when_it_is_slower() -> None:
    """Durations go with the closing speed to the power of -1/5: all of them are impacts."""
    closing = np.geomspace(1e-3, 1.0, 50)
    duration = 1e-4 * closing**-0.2
    assert np.all(duration <= impact_limits(duration, closing))
    assert not np.any(3.0 * duration <= impact_limits(duration, closing))
    assert impact_limits(np.zeros(0), np.zeros(0)).size == 0


def test_contacts_ring_at_one_over_twice_an_impact() -> None:
    """Sustained contacts are left out."""
    duration = np.array([1e-4, 1e-4, 1e-4, 2e-2, 1e-4])
    assert resonance_frequency(duration, np.ones(5)) == pytest.approx(5000.0, rel=1e-12)
    assert resonance_frequency(np.zeros(0), np.zeros(0)) is None


def test_contacts_beyond_the_span_are_cut() -> None:
    line = timeline((1.005, 4.0), CONTACTS, CLOSING, (TIME, SLIDING), 0.0)
    assert line.edges[0] == 1.005
    assert line.edges[-1] == 4.0
    assert [MODES[mode] for mode in line.mode[[0, -1]]] == ["impact", "sustained contact"]


def test_two_joints_together() -> None:
    first = Timeline(np.array([0.0, 1.0, 3.0]), np.array([0, 1]), ("open", "closed"))
    second = Timeline(np.array([0.0, 2.0, 3.0]), np.array([1, 0]), ("open", "closed"))
    both = combine([first, second])
    assert both.names == ("open + open", "open + closed", "closed + open", "closed + closed")
    np.testing.assert_array_equal(both.edges, [0.0, 1.0, 2.0, 3.0])
    assert both.mode.tolist() == [1, 3, 2]
    assert len(combine([made(), made()]).names) == 16
    np.testing.assert_array_equal(combine([made()]).mode, made().mode)
