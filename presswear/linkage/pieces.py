"""Tables and rises of a motion as pieces, each a polynomial and a sine.

They are functions of the phase, w t, which grows by 2 pi in a cycle.  A new law of rises is a few
numbers here, and nothing anywhere else.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise
from typing import Annotated, NamedTuple

import numpy as np

from presswear.linkage.points import ANGLE
from presswear.tools.arrays import Array
from presswear.tools.errors import InputError, unknown
from presswear.tools.serialize import check_fields

MOST_PIECES = 256
"""Of a motion."""
LEAST_ROWS = 3
"""Of a table: fewer are no motion."""
LEAST_PIECE = 1e-6
"""Shortest piece of a motion, rad of phase."""
DEGREE = 5
"""Of the polynomial of a piece."""

_TURN = 2.0 * math.pi
_ROUND_OFF = 1e-9
"""Two phases this close are one, rad: degrees that were typed are not exact."""

Piece = tuple[float, Sequence[float], tuple[float, float, float]]
"""A piece of a rise by 1 over a length of 1: where it begins; coefficients of its polynomial in
the way from there; amplitude, frequency and first phase of its sine."""

_HALF_SINE = 1.0 / (4.0 + math.pi)
"""Unit of the modified sine."""
RISES: Mapping[str, Sequence[Piece]] = {
    "cycloidal": ((0.0, (0.0, 1.0), (-1.0 / _TURN, _TURN, 0.0)),),
    "modified-sine": (
        (0.0, (0.0, math.pi * _HALF_SINE), (-0.25 * _HALF_SINE, 2.0 * _TURN, 0.0)),
        (
            0.125,
            ((2.0 + 0.125 * math.pi) * _HALF_SINE, math.pi * _HALF_SINE),
            (-2.25 * _HALF_SINE, 2.0 * _TURN / 3.0, 0.5 * math.pi),
        ),
        (
            0.875,
            ((4.0 + 0.875 * math.pi) * _HALF_SINE, math.pi * _HALF_SINE),
            (-0.25 * _HALF_SINE, 2.0 * _TURN, 1.5 * math.pi),
        ),
    ),
    "3-4-5": ((0.0, (0.0, 0.0, 0.0, 10.0, -15.0, 6.0), (0.0, 0.0, 0.0)),),
}
"""Laws by which a motion rises from one dwell to the next: from 0 to 1 over a length of 1.

Each begins and ends without velocity and acceleration.  Sources: R. L. Norton, Cam Design and
Manufacturing Handbook; greatest velocities and accelerations are 2 and 2 pi, 1.7596 and 5.5280,
1.875 and 5.7735.
"""


@dataclass(frozen=True)
class Rise:
    """A rise, or return, of a motion in a part of its cycle; between rises it dwells.

    Attributes
    ----------
    start, end : float
        Phases, rad; the cycle is 2 pi long.
    by : float
        How far it rises, rad or, of a followed point, m; below zero: a return.
    law : {"cycloidal", "modified-sine", "3-4-5"}
    """

    start: Annotated[float, ANGLE]
    end: Annotated[float, ANGLE]
    by: float
    law: str = "cycloidal"

    def __post_init__(self) -> None:
        """InputError where a number is out of range, or the law is unknown."""
        check_fields(self)
        if self.law not in RISES:
            raise unknown("law of a rise", self.law, RISES)
        if not 0.0 <= self.start < self.end - LEAST_PIECE:
            raise InputError(
                f"a rise from {self.start:g} to {self.end:g} rad: it must begin at 0 or later and "
                "end behind that"
            )


Numbers = Sequence[Sequence[float]]


class Pieces(NamedTuple):
    """The part of a motion that is given piece by piece, a function of the phase.

    Attributes
    ----------
    start : ndarray, shape (n,)
        Phases at which the pieces begin, rad; the last goes on to the first of the next cycle.
    polynomial : ndarray, shape (n, DEGREE + 1)
        Coefficients in the phase since the piece began, that of the constant first.
    wave : ndarray, shape (n, 3)
        Amplitude, frequency and first phase, rad, of the sine that is added.
    net : float
        How far the motion comes in a cycle; no part of the pieces, which repeat.
    """

    start: Array
    polynomial: Array
    wave: Array
    net: float

    def at(self, phase: Array) -> tuple[Array, Array, Array]:
        """Value and its first and second derivative by the phase, at some phases, rad."""
        within = phase - _TURN * np.floor(phase / _TURN)
        place = np.searchsorted(self.start, within, side="right") - 1
        x = np.where(place < 0, within + _TURN, within) - self.start[place]
        value, slope, bend = np.zeros((3, *x.shape))
        for power in range(DEGREE, -1, -1):
            bend = bend * x + 2.0 * slope
            slope = slope * x + value
            value = value * x + self.polynomial[place, power]
        amplitude, w, first = self.wave[place].T
        sine, cosine = np.sin(w * x + first), np.cos(w * x + first)
        return (
            value + amplitude * sine,
            slope + amplitude * w * cosine,
            bend - amplitude * w * w * sine,
        )

    def shifted(self) -> "Pieces":
        """The same without its net way, and zero at phase 0."""
        polynomial, rate = self.polynomial.copy(), self.net / _TURN
        polynomial[:, 0] -= rate * self.start
        polynomial[:, 1] -= rate
        start = self.start % _TURN
        order = np.argsort(start)
        polynomial = polynomial[order]
        still = Pieces(start[order], polynomial, self.wave[order], self.net)
        polynomial[:, 0] -= still.at(np.zeros(1))[0][0]
        return still


NO_PIECES = Pieces(np.zeros(0), np.zeros((0, DEGREE + 1)), np.zeros((0, 3)), 0.0)


@lru_cache(maxsize=64)
def pieces_of(table: tuple[tuple[float, ...], ...], rises: tuple[Rise, ...]) -> Pieces:
    """The pieces of a table or of rises; either is empty."""
    found = NO_PIECES
    if table:
        found = _from_table(np.array(table))
    elif rises:
        found = _from_rises(rises)
    return found.shifted() if found.start.size else found


def _from_table(rows: Array) -> Pieces:
    """A periodic spline through rows, twice continuously differentiable."""
    phase, value = rows[:, 0], rows[:, 1].copy()
    net = 0.0
    if phase[-1] - phase[0] > _TURN - _ROUND_OFF:
        net = float(value[-1] - value[0])
    else:
        rows = np.vstack([rows, rows[0]])
    phase, value = np.append(rows[:-1, 0], rows[0, 0] + _TURN), rows[:, 1].copy()
    value -= net * (phase - phase[0]) / _TURN
    value[-1] = value[0]
    count = len(phase) - 1
    polynomial = np.zeros((count, DEGREE + 1))
    if rows.shape[1] == 2:
        from scipy.interpolate import CubicSpline  # slow to import

        polynomial[:, :4] = CubicSpline(phase, value, bc_type="periodic").c[::-1].T
    else:
        h = np.diff(phase)
        slope, bend = rows[:, 2] - net / _TURN, rows[:, 3]
        polynomial[:, 0], polynomial[:, 1] = value[:-1], slope[:-1]
        polynomial[:, 2] = 0.5 * bend[:-1]
        far = np.diff(value) - h * (slope[:-1] + 0.5 * h * bend[:-1])
        faster = h * (np.diff(slope) - h * bend[:-1])
        bent = h * h * np.diff(bend)
        polynomial[:, 3] = (10.0 * far - 4.0 * faster + 0.5 * bent) / h**3
        polynomial[:, 4] = (-15.0 * far + 7.0 * faster - bent) / h**4
        polynomial[:, 5] = (6.0 * far - 3.0 * faster + 0.5 * bent) / h**5
    # Pieces hold the motion with its net way; ``shifted`` takes that out again.
    polynomial[:, 0] += net * (phase[:-1] - phase[0]) / _TURN
    polynomial[:, 1] += net / _TURN
    return Pieces(phase[:-1], polynomial, np.zeros((count, 3)), net)


def _from_rises(rises: tuple[Rise, ...]) -> Pieces:
    """Rises one after the other, with dwells wherever there is room between them."""
    start: list[float] = []
    polynomial: list[Array] = []
    wave: list[tuple[float, float, float]] = []

    def add(begin: float, factors: Array, sine: tuple[float, float, float]) -> None:
        start.append(begin)
        polynomial.append(factors)
        wave.append(sine)

    level, done = 0.0, []
    for rise, then in zip(rises, _following(rises), strict=True):
        length = rise.end - rise.start
        scale = rise.by / length ** np.arange(DEGREE + 1)
        for begin, factors, (amplitude, w, first) in RISES[rise.law]:
            own = np.zeros(DEGREE + 1)
            own[: len(factors)] = factors
            own *= scale
            own[0] += level
            add(rise.start + begin * length, own, (rise.by * amplitude, w / length, first))
        done.append(rise.by)
        level = math.fsum(done)
        # Ways there and back that were typed as decimals may leave a round-off.
        if abs(level) < 1e-12 * math.fsum(map(abs, done)):
            level = 0.0
        if then - rise.end > _ROUND_OFF:
            add(rise.end, np.array([level, *np.zeros(DEGREE)]), (0.0, 0.0, 0.0))
    return Pieces(np.array(start), np.array(polynomial), np.array(wave), level)


def _following(rises: tuple[Rise, ...]) -> list[float]:
    """Where the rise behind each begins, rad."""
    return [*(rise.start for rise in rises[1:]), rises[0].start + _TURN]


def check_table(table: Numbers, owner: str) -> None:
    """InputError where rows are no table of a motion."""
    if len({len(row) for row in table}) > 1:
        raise InputError(f"table of {owner}: rows of one length are expected")
    phases = [row[0] for row in table]
    closes = phases[-1] - phases[0] > _TURN - _ROUND_OFF
    rows = len(table) - closes
    if not LEAST_ROWS <= rows <= MOST_PIECES:
        raise InputError(
            f"table of {owner}: {rows} rows are given; allowed are {LEAST_ROWS} to {MOST_PIECES}"
        )
    steps = [after - before for before, after in pairwise(phases)]
    if not (phases[0] >= 0.0 and min(steps) >= LEAST_PIECE):
        raise InputError(
            f"table of {owner}: its phases must rise, from 0 rad or above, by {LEAST_PIECE:g} rad "
            "or more"
        )
    if phases[-1] - phases[0] > _TURN + _ROUND_OFF:
        raise InputError(
            f"table of {owner}: its phases go from {phases[0]:g} to {phases[-1]:g} rad; a cycle is "
            "2 pi long"
        )
    if not closes and phases[0] + _TURN - phases[-1] < LEAST_PIECE:
        raise InputError(f"table of {owner}: its last phase is too near the end of the cycle")


def check_rises(rises: tuple[Rise, ...], owner: str) -> None:
    """InputError where rises overlap."""
    for rise, then in zip(rises, _following(rises), strict=True):
        room = then - rise.end
        if room < -_ROUND_OFF or _ROUND_OFF < room < LEAST_PIECE:
            raise InputError(
                f"rises of {owner}: the one that ends at {rise.end:g} rad must end "
                f"{LEAST_PIECE:g} rad or more before the next begins, at {then:g} rad, or there"
            )
