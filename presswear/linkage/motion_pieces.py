"""Pieces of a periodic motion: tables, and rises with dwells between them.

Pieces are functions of the phase w t, which grows by 2 pi in a cycle. A new law of
rises is a few numbers in ``RISES``.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Annotated, NamedTuple

import numpy as np

from presswear.linkage.points import ANGLE, MAX_ANGLE
from presswear.tools.arrays import Array
from presswear.tools.errors import InputError
from presswear.tools.fields import choice
from presswear.tools.quantities import Quantity
from presswear.tools.serialize import Checked

MAX_PIECES = 512  # largest number of pieces of a motion
MIN_ROWS = 3  # smallest number of rows of a table
MIN_PIECE = 1e-6  # length of a piece, rad of phase
DEGREE = 5  # degree of the polynomial of a piece
TURN = 2.0 * math.pi
PHASE_TOL = 1e-9  # rad; round-off of phases that a user gave in degrees
Piece = tuple[float, Sequence[float], tuple[float, float, float]]
"""Piece of a rise by 1 over a length of 1: start; coefficients of its polynomial in the distance
from the start; amplitude, frequency and initial phase of its sine."""

_SINE = 1.0 / (4.0 + math.pi)  # unit of the modified sine
_PI_SINE = math.pi * _SINE
# Each rise starts and ends with zero velocity and acceleration. Source: R. L. Norton, Cam
# Design and Manufacturing Handbook; greatest velocities and accelerations are 2 and 2
# pi, 1.7596 and 5.5280, 1.875 and 5.7735.
RISES: Mapping[str, Sequence[Piece]] = {
    "cycloidal": ((0.0, (0.0, 1.0), (-1.0 / TURN, TURN, 0.0)),),
    "modified-sine": (
        (0.0, (0.0, _PI_SINE), (-0.25 * _SINE, 2.0 * TURN, 0.0)),
        (
            0.125,
            ((2.0 + 0.125 * math.pi) * _SINE, _PI_SINE),
            (-2.25 * _SINE, 2.0 * TURN / 3.0, 0.5 * math.pi),
        ),
        (
            0.875,
            ((4.0 + 0.875 * math.pi) * _SINE, _PI_SINE),
            (-0.25 * _SINE, 2.0 * TURN, 1.5 * math.pi),
        ),
    ),
    "3-4-5": ((0.0, (0.0, 0.0, 0.0, 10.0, -15.0, 6.0), (0.0, 0.0, 0.0)),),
}
_WAY = Quantity("rad or m", -MAX_ANGLE, MAX_ANGLE, "", "way, rad or, of a point, m")


@dataclass(frozen=True)
class Rise(Checked):
    """Rise between two phases of a cycle of 2 pi, rad; a negative ``by`` is a return."""

    start: Annotated[float, ANGLE]
    end: Annotated[float, ANGLE]
    by: Annotated[float, _WAY]
    law: str = choice("cycloidal", tuple(RISES), "law of the rise")

    def __post_init__(self) -> None:
        super().__post_init__()
        if not 0.0 <= self.start < self.end - MIN_PIECE:
            span = f"a rise from {self.start:g} to {self.end:g} rad"
            raise InputError(f"{span}: it must begin at 0 or later and end behind that")


class Pieces(NamedTuple):
    """Piecewise part of a motion, a function of the phase; ``n`` pieces."""

    # (n,), phases, rad; the last piece ends at the first one of the next cycle
    start: Array
    # (n, DEGREE + 1), coefficients in the phase since the start, the constant first
    polynomial: Array
    # (n, 3), amplitude, frequency and initial phase, rad, of a sine that is added
    wave: Array
    net: float  # net change in a cycle, which the pieces do not contain

    def at(self, phase: Array) -> tuple[Array, Array, Array]:
        """Return the value and its first and second derivative by the phase at phases, rad."""
        angle = phase - TURN * np.floor(phase / TURN)  # in the turn, 0 to 2 pi
        place = np.searchsorted(self.start, angle, side="right") - 1
        x = np.where(place < 0, angle + TURN, angle) - self.start[place]
        value, slope, curvature = np.zeros((3, *x.shape))
        for power in range(DEGREE, -1, -1):
            curvature = curvature * x + 2.0 * slope
            slope = slope * x + value
            value = value * x + self.polynomial[place, power]
        amplitude, w, first = self.wave[place].T
        sine = np.sin(w * x + first)
        cosine = np.cos(w * x + first)
        value = value + amplitude * sine
        slope = slope + amplitude * w * cosine
        curvature = curvature - amplitude * w * w * sine
        return value, slope, curvature


NO_PIECES = Pieces(np.zeros(0), np.zeros((0, DEGREE + 1)), np.zeros((0, 3)), 0.0)


@lru_cache(maxsize=64)
def pieces_of(table: tuple[tuple[float, ...], ...], rises: tuple[Rise, ...]) -> Pieces:
    """Return the pieces of a table or of rises; either is empty."""
    if table:
        return _pieces_of_table(np.array(table))
    return _pieces_of_rises(rises) if rises else NO_PIECES


def _periodic(start: Array, polynomial: Array, wave: Array, net: float) -> Pieces:
    """Return pieces in the order of their phases, with the value 0 at the phase 0.

    ``net`` is the net change in a cycle, which the pieces do not contain.
    """
    order = np.argsort(start % TURN)
    pieces = Pieces((start % TURN)[order], polynomial[order], wave[order], net)
    value_at_start, _, _ = pieces.at(np.zeros(1))
    pieces.polynomial[:, 0] -= value_at_start
    return pieces


def _pieces_of_table(rows: Array) -> Pieces:
    """Return the periodic spline through rows, twice continuously differentiable.

    A row has phase, rad, and value, and may have the first two derivatives by the phase.
    """
    net = 0.0
    if rows[-1, 0] - rows[0, 0] > TURN - PHASE_TOL:
        net = float(rows[-1, 1] - rows[0, 1])
    else:
        rows = np.vstack([rows, rows[0]])
    phase = np.append(rows[:-1, 0], rows[0, 0] + TURN)
    value = rows[:, 1].copy()
    value -= net * (phase - phase[0]) / TURN
    value[-1] = value[0]
    count = len(phase) - 1
    polynomial = np.zeros((count, DEGREE + 1))
    if rows.shape[1] == 2:
        from scipy.interpolate import CubicSpline  # slow to import

        polynomial[:, :4] = CubicSpline(phase, value, bc_type="periodic").c[::-1].T
    else:
        polynomial[:] = _quintics(phase, value, rows[:, 2] - net / TURN, rows[:, 3])
    return _periodic(phase[:-1], polynomial, np.zeros((count, 3)), net)


def _quintics(phase: Array, value: Array, slope: Array, curvature: Array) -> Array:
    """Return the polynomials of degree 5 between nodes with two derivatives, shape (n, 6)."""
    h = np.diff(phase)
    value_change = np.diff(value) - h * (slope[:-1] + 0.5 * h * curvature[:-1])
    slope_change = h * (np.diff(slope) - h * curvature[:-1])
    curvature_change = h * h * np.diff(curvature)
    return np.column_stack(
        [
            value[:-1],
            slope[:-1],
            0.5 * curvature[:-1],
            (10.0 * value_change - 4.0 * slope_change + 0.5 * curvature_change) / h**3,
            (-15.0 * value_change + 7.0 * slope_change - curvature_change) / h**4,
            (6.0 * value_change - 3.0 * slope_change + 0.5 * curvature_change) / h**5,
        ]
    )


def _pieces_of_rises(rises: tuple[Rise, ...]) -> Pieces:
    """Return rises one after the other, with dwells between them where there is room."""
    rows: list[tuple[float, Array, tuple[float, float, float]]] = []
    level = 0.0
    heights = []
    for rise, next_start in zip(rises, next_starts(rises), strict=True):
        length = rise.end - rise.start
        scale = rise.by / length ** np.arange(DEGREE + 1)
        for start, factors, (amplitude, w, first) in RISES[rise.law]:
            polynomial = np.zeros(DEGREE + 1)
            polynomial[: len(factors)] = factors
            polynomial *= scale
            polynomial[0] += level
            sine = rise.by * amplitude, w / length, first
            rows.append((rise.start + start * length, polynomial, sine))
        heights.append(rise.by)
        level = math.fsum(heights)
        # The sum of rises and returns in decimal numbers may be round-off.
        if abs(level) < 1e-12 * math.fsum(map(abs, heights)):
            level = 0.0
        if next_start - rise.end > PHASE_TOL:
            dwell = np.array([level, *np.zeros(DEGREE)])
            rows.append((rise.end, dwell, (0.0, 0.0, 0.0)))
    columns = zip(*rows, strict=True)
    starts, polynomials, waves = (np.array(column) for column in columns)
    polynomials[:, 0] -= level / TURN * starts
    polynomials[:, 1] -= level / TURN
    return _periodic(starts, polynomials, waves, level)


def next_starts(rises: tuple[Rise, ...]) -> list[float]:
    """Return the phase at which the rise after each one starts, rad."""
    starts = [rise.start for rise in rises]
    if rises:
        starts.append(starts[0] + TURN)  # the first rise of the next cycle
    return starts[1:]


def check_table(table: Sequence[Sequence[float]], owner: str) -> None:
    """Raise InputError if rows are not a table of a motion."""
    label = f"table of {owner}:"
    if len({len(row) for row in table}) > 1:
        raise InputError(f"{label} rows of one length are expected")
    phases = [row[0] for row in table]
    length = phases[-1] - phases[0]
    closes = length > TURN - PHASE_TOL
    rows = len(table)
    if closes:  # the last row repeats the first
        rows -= 1
    if not MIN_ROWS <= rows <= MAX_PIECES:
        raise InputError(f"{label} {rows} rows; allowed are {MIN_ROWS} to {MAX_PIECES}")
    gaps = np.diff(phases).tolist()
    if not closes:
        gaps.append(TURN - length)
    if phases[0] < 0.0 or min(gaps) < MIN_PIECE or length > TURN + PHASE_TOL:
        allowed = f"from 0 or above, by {MIN_PIECE:g} rad or more, in a cycle of 2 pi"
        span = f"phases from {phases[0]:g} to {phases[-1]:g} rad"
        raise InputError(f"{label} {span}; they must rise, {allowed}")
