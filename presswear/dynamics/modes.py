"""Modes of contact of pins in their bearings: free flight, impact, sustained contact, sticking.

Free flight: no force.  Impact: a contact from touchdown to separation that lasts no longer than
``FEW`` impacts of its closing speed do; see ``longest_impacts``.  Sustained contact: every other
contact.  Sticking: the part of a sustained contact in which the pin slides more slowly than its
friction law takes as sliding.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Whole = NDArray[np.int64]

MODES = ("free flight", "impact", "sustained contact", "sticking")
FREE, IMPACT, SUSTAINED, STICKING = range(4)
FEW = 2.0
"""Durations of an impact that the longest one may last."""


@dataclass(frozen=True)
class Timeline:
    """Modes one after the other.

    Attributes
    ----------
    edges : ndarray, shape (n + 1,)
        Times at which they begin, and the end of the last, s.
    mode : ndarray of int, shape (n,)
        Place in ``names``; two that follow each other differ.
    names : tuple of str
    """

    edges: Array
    mode: Whole
    names: tuple[str, ...] = MODES

    @property
    def durations(self) -> Array:
        """How long each lasts, s, shape (n,)."""
        return np.diff(self.edges)

    @property
    def shares(self) -> dict[str, float]:
        """Part of the time in each mode, by name; they sum to 1."""
        found = np.bincount(self.mode, self.durations, len(self.names))
        return dict(zip(self.names, (found / found.sum()).tolist(), strict=True))

    @property
    def transitions(self) -> Whole:
        """How often a mode, by rows, is followed by another, by columns."""
        found = np.zeros((len(self.names), len(self.names)), np.int64)
        np.add.at(found, (self.mode[:-1], self.mode[1:]), 1)
        return found

    def sojourns(self, name: str) -> Array:
        """Durations of the visits to a mode that begin and end within, s."""
        inner = slice(1, -1)
        return self.durations[inner][self.mode[inner] == self.names.index(name)]

    def at(self, times: Array) -> Whole:
        """Modes at some times, s; before the first and behind the last they are those."""
        place = np.searchsorted(self.edges[1:-1], times, side="right")
        return self.mode[place]

    def over_phase(self, period: float, bins: int) -> Array:
        """Part of the time in each mode over the phase of the cycle, shape (modes, bins).

        Exact: each mode gives its own part of every bin that it touches.
        """
        grid = (
            period
            / bins
            * np.arange(
                np.floor(self.edges[0] * bins / period), np.ceil(self.edges[-1] * bins / period) + 1
            )
        )
        inside = grid[(grid > self.edges[0]) & (grid < self.edges[-1])]
        edges = np.union1d(self.edges, inside)
        middle = 0.5 * (edges[1:] + edges[:-1])
        place = np.floor(middle / period * bins).astype(np.int64) % bins
        found = np.zeros((len(self.names), bins))
        np.add.at(found, (self.at(middle), place), np.diff(edges))
        sums = found.sum(axis=0)
        return np.asarray(found / np.where(sums > 0.0, sums, 1.0))


def longest_impacts(duration: Array, closing: Array) -> Array:
    """How long each contact may last to be an impact, s, shape (n,).

    The fourth of the contacts that close fastest shows how long an impact lasts: their median.
    By Hertz's law a slower one lasts longer by the fifth root of the speeds (Johnson, Contact
    Mechanics, section 11.4.1).

    Parameters
    ----------
    duration : ndarray, shape (n,)
        s.
    closing : ndarray, shape (n,)
        Closing speeds, m/s.
    """
    if not duration.size:
        return np.zeros(0)
    fastest = np.argsort(closing)[-max(duration.size // 4, 1) :]
    speed = float(np.median(closing[fastest]))
    slower = np.maximum(speed, 1e-300) / np.clip(closing, 1e-12 * max(speed, 1e-288), None)
    return np.asarray(FEW * np.median(duration[fastest]) * np.maximum(slower, 1.0) ** 0.2)


def resonance_of(duration: Array, closing: Array) -> float | None:
    """Frequency at which a joint's contacts ring, Hz: one over twice the median impact.

    None where no contact is an impact; the parameters are those of ``longest_impacts``.
    """
    impacts = duration[(duration > 0.0) & (duration <= longest_impacts(duration, closing))]
    return float(0.5 / np.median(impacts)) if impacts.size else None


def timeline(
    span: tuple[float, float],
    contacts: Array,
    closing: Array,
    rows: tuple[Array, Array],
    slow: float,
) -> Timeline:
    """Modes of one joint.

    Parameters
    ----------
    span : (float, float)
        Beginning and end, s.
    contacts : ndarray, shape (n, 2)
        Touchdown and separation of each, one after the other, s.
    closing : ndarray, shape (n,)
        Their closing speeds, m/s.
    rows : (ndarray, ndarray), shape (m,) each
        Times, s, and speeds of sliding, m/s, linear in between.
    slow : float
        Speed of sliding below which a pin sticks, m/s.
    """
    begin, end = span
    time, sliding = rows
    lasting = contacts[:, 1] - contacts[:, 0]
    is_impact = lasting <= longest_impacts(lasting, closing)
    edges: list[float] = [begin]
    modes: list[int] = []

    def until(moment: float, mode: int) -> None:
        moment = min(moment, end)
        if moment <= edges[-1]:
            return
        if modes and modes[-1] == mode:
            edges[-1] = moment
            return
        edges.append(moment)
        modes.append(mode)

    for (touchdown, separation), short in zip(contacts, is_impact, strict=True):
        until(touchdown, FREE)
        if not short:
            for moment in turns(time, np.abs(sliding) - slow, max(touchdown, begin), separation):
                middle = 0.5 * (edges[-1] + moment)
                sticks = abs(float(np.interp(middle, time, sliding))) < slow
                until(moment, STICKING if sticks else SUSTAINED)
        else:
            until(separation, IMPACT)
    until(end, FREE)
    return Timeline(np.array(edges), np.array(modes, np.int64))


def turns(time: Array, values: Array, begin: float, end: float) -> list[float]:
    """Times between two others at which a series changes its sign, and the later of the two, s."""
    first, last = np.searchsorted(time, [begin, end])
    first, last = max(int(first) - 1, 0), min(int(last) + 1, time.size)
    own, at = values[first:last], time[first:last]
    rows = np.flatnonzero((own[:-1] < 0.0) != (own[1:] < 0.0))
    moments = at[rows] - own[rows] * (at[rows + 1] - at[rows]) / (own[rows + 1] - own[rows])
    return [*moments[(moments > begin) & (moments < end)].tolist(), end]


def jointly(timelines: Sequence[Timeline]) -> Timeline:
    """Modes of several joints at once, named ``first + second``; all span the same time."""
    edges = np.unique(np.concatenate([own.edges for own in timelines]))
    middle = 0.5 * (edges[1:] + edges[:-1])
    codes = np.zeros(middle.size, np.int64)
    names: tuple[str, ...] = ("",)
    for own in timelines:
        codes = codes * len(own.names) + own.at(middle)
        names = tuple(f"{a} + {b}" if a else b for a in names for b in own.names)
    changed = np.append(True, np.diff(codes) != 0)
    return Timeline(np.append(edges[:-1][changed], edges[-1]), codes[changed], names)
