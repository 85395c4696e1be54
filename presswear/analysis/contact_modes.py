"""Contact modes of a joint with clearance: free flight, impact, sustained contact, sticking.

A contact lasts from touchdown to separation. It is an impact if it lasts at most twice
as long as an impact of its closing speed (see ``impact_limits``), and sustained
otherwise. A sustained contact sticks while its sliding speed is below the lower speed
of its friction law.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from presswear.results.sampled_cycles import sampled_span
from presswear.results.stage import StageResult
from presswear.scene.scene import Scene
from presswear.tools.arrays import Array

IntArray = NDArray[np.int64]

MODES = ("free flight", "impact", "sustained contact", "sticking")
FREE, IMPACT, SUSTAINED, STICKING = range(4)
MAX_DURATION_RATIO = 2.0  # duration of the longest impact over that of a typical one


@dataclass(frozen=True)
class Timeline:
    """Sequence of modes."""

    # times at which the modes begin, and the end of the last one, s, shape (n + 1,)
    edges: Array
    mode: IntArray  # index into ``names``; two successive modes differ
    names: tuple[str, ...] = MODES

    @property
    def durations(self) -> Array:
        """Durations, s, shape (n,)."""
        return np.diff(self.edges)

    @property
    def shares(self) -> dict[str, float]:
        """Share of the time in each mode, by name; the sum is 1."""
        sums = np.bincount(self.mode, self.durations, len(self.names))
        return dict(zip(self.names, (sums / sums.sum()).tolist(), strict=True))

    @property
    def transitions(self) -> IntArray:
        """Number of transitions from a mode (row) to another mode (column)."""
        counts = np.zeros((len(self.names), len(self.names)), np.int64)
        np.add.at(counts, (self.mode[:-1], self.mode[1:]), 1)
        return counts

    def visits(self, name: str) -> Array:
        """Return the durations, s, of the visits to a mode that begin and end within the span."""
        inner = slice(1, -1)
        return self.durations[inner][self.mode[inner] == self.names.index(name)]

    def at(self, times: Array) -> IntArray:
        """Return the modes at ``times``, s; times outside the span get the first or last mode."""
        return self.mode[np.searchsorted(self.edges[1:-1], times, side="right")]

    def over_phase(self, period: float, bins: int) -> Array:
        """Return the share of the time in each mode over the phase, shape (modes, bins); exact."""
        first = np.floor(self.edges[0] * bins / period)
        last = np.ceil(self.edges[-1] * bins / period)
        grid = period / bins * np.arange(first, last + 1)
        inside = grid[(grid > self.edges[0]) & (grid < self.edges[-1])]
        edges = np.union1d(self.edges, inside)
        middle = 0.5 * (edges[1:] + edges[:-1])
        column = np.floor(middle / period * bins).astype(np.int64) % bins
        times = np.zeros((len(self.names), bins))
        np.add.at(times, (self.at(middle), column), np.diff(edges))
        sums = times.sum(axis=0)
        return np.asarray(times / np.where(sums > 0.0, sums, 1.0))


def impact_limits(duration: Array, closing_speed: Array) -> Array:
    """Return the longest duration, s, that each contact may have as an impact, shape (n,).

    A typical impact is the median of the quarter of the contacts with the largest
    closing speeds, m/s. By Hertz's law the duration scales with the speed to the power
    of -1/5 (Johnson, Contact Mechanics, section 11.4.1).
    """
    if not duration.size:
        return np.zeros(0)
    fastest = np.argsort(closing_speed)[-max(duration.size // 4, 1) :]
    speed = float(np.median(closing_speed[fastest]))
    ratio = np.maximum(speed, 1e-300) / np.clip(
        closing_speed, 1e-12 * max(speed, 1e-288), None
    )
    typical = np.median(duration[fastest])
    return np.asarray(MAX_DURATION_RATIO * typical * np.maximum(ratio, 1.0) ** 0.2)


def resonance_frequency(duration: Array, closing_speed: Array) -> float | None:
    """Return the contact resonance, Hz: one over twice the median impact duration, or None."""
    is_impact = (duration > 0.0) & (duration <= impact_limits(duration, closing_speed))
    return float(0.5 / np.median(duration[is_impact])) if is_impact.any() else None


def timeline(
    span: tuple[float, float],
    contacts: Array,
    closing_speed: Array,
    sliding: tuple[Array, Array],
    sticking_speed: float,
) -> Timeline:
    """Return the contact modes of one joint in a span from start to end, s.

    Parameters
    ----------
    contacts : ndarray, shape (n, 2)
        Touchdown and separation of successive contacts, s.
    sliding : (ndarray, ndarray), shape (m,) each
        Times, s, and sliding speeds, m/s, linear in between.
    sticking_speed : float
        Sliding speed below which a contact sticks, m/s.
    """
    time, speed = sliding
    touchdown, separation = contacts.T
    excess = np.abs(speed) - sticking_speed
    k = np.flatnonzero((excess[:-1] < 0.0) != (excess[1:] < 0.0))
    changes = time[k] - excess[k] * np.diff(time)[k] / np.diff(excess)[k]
    moments = np.unique(np.concatenate([span, touchdown, separation, changes]))
    edges = moments[(moments >= span[0]) & (moments <= span[1])]
    middle = 0.5 * (edges[1:] + edges[:-1])
    sticks = np.abs(np.interp(middle, time, speed)) < sticking_speed
    mode = np.full(middle.size, FREE)
    if len(contacts):
        contact = np.searchsorted(touchdown, middle) - 1
        is_closed = (contact >= 0) & (middle < separation[contact])
        duration = separation - touchdown
        is_impact = (duration <= impact_limits(duration, closing_speed))[contact]
        mode[is_closed] = np.where(sticks, STICKING, SUSTAINED)[is_closed]
        mode[is_closed & is_impact] = IMPACT
    return _merged(edges, mode, MODES)


def _merged(edges: Array, mode: IntArray, names: tuple[str, ...]) -> Timeline:
    """Return a timeline whose successive modes differ."""
    is_new = np.append(True, np.diff(mode) != 0)
    return Timeline(np.append(edges[:-1][is_new], edges[-1]), mode[is_new], names)


def timeline_of(scene: Scene, stage: StageResult, joint: str) -> Timeline:
    """Return the contact modes of a joint in the recorded sampled cycles, by the clock, s."""
    start, end = map(float, stage.clock_of(np.array(sampled_span(scene, stage))))
    item = stage.joints[joint]
    contacts = np.column_stack([item.contact("touchdown"), item.contact("separation")])
    closing = item.contact("closing_speed")
    last = float(contacts[-1, 1]) if len(contacts) else float(stage.clock[0])
    # A contact that continues at the end is not recorded as one.
    lasting = (stage.clock > last) & (item.penetration > 0.0)
    if lasting.any():
        more = [[stage.clock[lasting][0], end + scene.mechanism.period]]
        contacts = np.append(contacts, more, axis=0)
        closing = np.append(closing, 0.0)
    sliding = (stage.clock, item.sliding)
    lower_speed = scene.bearing(joint).lower_speed
    return timeline((start, end), contacts, closing, sliding, lower_speed)


def over_nominal_time(scene: Scene, stage: StageResult, line: Timeline) -> Timeline:
    """Return a timeline of a stage over the nominal time after the run-up, s."""
    edges = stage.nominal_of(line.edges) - scene.run_up
    return Timeline(edges, line.mode, line.names)


def resonance(stage: StageResult, joint: str) -> float | None:
    """Return the frequency of the contact, Hz, or None; see ``resonance_frequency``."""
    item = stage.joints[joint]
    duration = item.contact("separation") - item.contact("touchdown")
    return resonance_frequency(duration, item.contact("closing_speed"))


def combine(timelines: Sequence[Timeline]) -> Timeline:
    """Return the joint modes of several joints over one span, named ``first + second``.

    Only modes that occur have a name, because ten joints have a million.
    """
    edges = np.unique(np.concatenate([each.edges for each in timelines]))
    modes = np.column_stack(
        [each.at(0.5 * (edges[1:] + edges[:-1])) for each in timelines]
    )
    rows, codes = np.unique(modes, axis=0, return_inverse=True)
    words = [
        [each.names[mode] for each, mode in zip(timelines, row, strict=True)]
        for row in rows
    ]
    return _merged(edges, codes.ravel(), tuple(map(" + ".join, words)))
