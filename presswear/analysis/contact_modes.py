"""Contact modes of a joint with clearance: free flight, impact, sustained contact, sticking.

A contact lasts from touchdown to separation. It is an impact if it lasts at most twice
as long as an impact of its closing speed (see ``impact_limits``), and sustained
otherwise. A sustained contact sticks while its sliding speed is below the lower speed
of its friction law.
"""

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
    mode: IntArray  # index into MODES; two successive modes differ

    @property
    def durations(self) -> Array:
        """Durations, s, shape (n,)."""
        return np.diff(self.edges)

    @property
    def shares(self) -> dict[str, float]:
        """Share of the time in each mode, by name; the sum is 1."""
        sums = np.bincount(self.mode, self.durations, len(MODES))
        return dict(zip(MODES, (sums / sums.sum()).tolist(), strict=True))

    @property
    def transitions(self) -> IntArray:
        """Number of transitions from a mode (row) to another mode (column)."""
        counts = np.zeros((len(MODES), len(MODES)), np.int64)
        np.add.at(counts, (self.mode[:-1], self.mode[1:]), 1)
        return counts

    def visits(self, name: str) -> Array:
        """Return the durations, s, of the visits to a mode that begin and end within the span."""
        inner = slice(1, -1)
        return self.durations[inner][self.mode[inner] == MODES.index(name)]

    def at(self, times: Array) -> IntArray:
        """Return the modes at ``times``, s; times outside the span get the first or last mode."""
        return self.mode[np.searchsorted(self.edges[1:-1], times, side="right")]

    def over_phase(self, period: float, bins: int) -> Array:
        """Return the share of the time in each mode over the phase, shape (modes, bins).

        A mode that lasts over several bins is divided exactly at their edges.
        """
        start = self.edges[0]
        end = self.edges[-1]
        first = np.floor(start * bins / period)
        last = np.ceil(end * bins / period)
        bin_edges = period / bins * np.arange(first, last + 1)
        is_within = (bin_edges > start) & (bin_edges < end)
        edges = np.union1d(self.edges, bin_edges[is_within])
        middle = 0.5 * (edges[1:] + edges[:-1])
        bin_index = np.floor(middle / period * bins).astype(np.int64) % bins
        times = np.zeros((len(MODES), bins))
        np.add.at(times, (self.at(middle), bin_index), np.diff(edges))
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
    typical_speed = float(np.median(closing_speed[fastest]))
    typical_duration = np.median(duration[fastest])
    # The lower limits keep the quotient finite where a speed is zero.
    lowest_speed = 1e-12 * max(typical_speed, 1e-288)
    speed_ratio = np.maximum(typical_speed, 1e-300) / np.maximum(
        closing_speed, lowest_speed
    )
    scale = np.maximum(speed_ratio, 1.0) ** 0.2
    return np.asarray(MAX_DURATION_RATIO * typical_duration * scale)


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
    # Rows behind which the sliding speed passes the sticking speed.
    row = np.flatnonzero((excess[:-1] < 0.0) != (excess[1:] < 0.0))
    changes = time[row] - excess[row] * np.diff(time)[row] / np.diff(excess)[row]
    instants = np.unique(np.concatenate([span, touchdown, separation, changes]))
    edges = instants[(instants >= span[0]) & (instants <= span[1])]
    middle = 0.5 * (edges[1:] + edges[:-1])
    is_slow = np.abs(np.interp(middle, time, speed)) < sticking_speed
    mode = np.full(middle.size, FREE)
    if len(contacts):
        contact = np.searchsorted(touchdown, middle) - 1
        is_closed = (contact >= 0) & (middle < separation[contact])
        duration = separation - touchdown
        is_impact = (duration <= impact_limits(duration, closing_speed))[contact]
        mode[is_closed] = np.where(is_slow, STICKING, SUSTAINED)[is_closed]
        mode[is_closed & is_impact] = IMPACT
    is_new = np.append(True, np.diff(mode) != 0)
    return Timeline(np.append(edges[:-1][is_new], edges[-1]), mode[is_new])


def timeline_of(scene: Scene, stage: StageResult, joint: str) -> Timeline:
    """Return the contact modes of a joint in the recorded sampled cycles, by the clock, s."""
    start, end = map(float, stage.clock_of(np.array(sampled_span(scene, stage))))
    pin = stage.joints[joint]
    contacts = pin.spans(stage.clock, end + scene.mechanism.period)
    closing_speed = np.zeros(len(contacts))  # of a contact that lasts: unknown
    recorded = pin.contact("closing_speed")
    closing_speed[: len(recorded)] = recorded
    sliding = (stage.clock, pin.sliding)
    lower_speed = scene.bearing(joint).lower_speed
    return timeline((start, end), contacts, closing_speed, sliding, lower_speed)


def over_nominal_time(scene: Scene, stage: StageResult, line: Timeline) -> Timeline:
    """Return a timeline of a stage over the nominal time after the run-up, s."""
    edges = stage.nominal_of(line.edges) - scene.run_up
    return Timeline(edges, line.mode)
