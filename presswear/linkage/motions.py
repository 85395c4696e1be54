"""Motions of drives as data: what a driven angle, or a followed coordinate, does over time.

A motion is a mean speed and, beside it, what repeats with the drive's own cycle: a Fourier
series, and a table or rises with dwells between them.  A table and rises are functions of the
phase, w t, which grows by 2 pi in a cycle.  All of them come down to pieces, each a polynomial
and a sine: a new law is a few numbers here, and nothing anywhere else.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise
from typing import Annotated, Any, NamedTuple, cast

import numpy as np

from presswear.linkage.points import ANGLE, Attachment, Probe, angle
from presswear.tools.arrays import Array
from presswear.tools.checked import checked
from presswear.tools.errors import InputError, shown, unknown
from presswear.tools.quantities import check_fields, quantity

FAST = 1e5
"""Greatest speed and frequency of a drive, rad/s; the fastest spindles have 2e4."""
MOST_HARMONICS = 16
"""Of a motion."""
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


@checked
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


def _settle(law: "Law", owner: str) -> None:
    """InputError where the lists of numbers of a motion are no motion."""
    check_fields(law)
    for what, widths in (("harmonics", (2,)), ("table", (2, 4))):
        for row in getattr(law, what):
            if len(row) not in widths:
                raise InputError(
                    f"{what} of {owner}: {shown(row)} is given; "
                    f"{' or '.join(map(str, widths))} finite numbers are expected"
                )
    if len(law.harmonics) > MOST_HARMONICS:
        raise InputError(
            f"harmonics of {owner}: {len(law.harmonics)} are given; allowed are 0 to "
            f"{MOST_HARMONICS}"
        )
    if law.table and law.rises:
        raise InputError(f"{owner}: a table and rises are given; one of them is expected")
    if law.table:
        _check_table(law.table, owner)
    if law.rises:
        _check_rises(tuple(law.rises), owner)
    count = len(law.pieces.start)
    if count > MOST_PIECES:
        raise InputError(
            f"rises of {owner}: they make {count} pieces; allowed are {MOST_PIECES} at most"
        )


def _check_table(table: Numbers, owner: str) -> None:
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


def _check_rises(rises: tuple[Rise, ...], owner: str) -> None:
    for rise, then in zip(rises, _following(rises), strict=True):
        room = then - rise.end
        if room < -_ROUND_OFF or _ROUND_OFF < room < LEAST_PIECE:
            raise InputError(
                f"rises of {owner}: the one that ends at {rise.end:g} rad must end "
                f"{LEAST_PIECE:g} rad or more before the next begins, at {then:g} rad, or there"
            )


def series(law: "Law", base: float, time: Array) -> tuple[Array, Array, Array]:
    """What a motion does beside its mean speed, and its rates, at some instants, s.

    Parameters
    ----------
    base : float
        Frequency of the first harmonic, rad/s.
    """
    place, speed, faster = np.zeros((3, *time.shape))
    for k, (a, b) in enumerate(law.harmonics, start=1):
        w = k * base
        cosine, sine = np.cos(w * time), np.sin(w * time)
        place = place + (a * (cosine - 1.0) + b * sine)
        speed = speed + w * (b * cosine - a * sine)
        faster = faster - w * w * (a * cosine + b * sine)
    if law.pieces.start.size:
        value, slope, bend = law.pieces.at(base * time)
        place, speed, faster = place + value, speed + base * slope, faster + base**2 * bend
    return place, speed, faster


@checked
@dataclass(frozen=True)
class Follow:
    """A curve that a point follows: its coordinate along a direction, from where it starts.

    The drive that it belongs to moves so that the point follows, while the other drives run on.

    Attributes
    ----------
    point : str, Attachment or Probe
        A linkage makes a Probe of it.
    direction : float or None
        Along which the coordinate is taken, rad; None: along the guide of its body, or else x.
    harmonics, table, rises
        As of a drive, in m.
    """

    point: Attachment | Probe | str
    direction: float | None = angle("direction of the curve that a point follows", None)
    harmonics: Numbers = ()
    table: Numbers = ()
    rises: Sequence[Rise] = ()

    def __post_init__(self) -> None:
        """InputError where the curve is none, or does not come back."""
        _settle(self, "follow")
        if abs(self.pieces.net) > 0.0:
            raise InputError(
                f"follow: the curve ends {self.pieces.net:g} m from where it begins; it must "
                "come back"
            )

    @property
    def pieces(self) -> Pieces:
        """The part that is given piece by piece."""
        return pieces_of(*cast(Any, (self.table, self.rises)))


def torque_limit() -> Any:
    """A dataclass field: greatest torque of a drive, N m; None: any."""
    text = "greatest torque of a drive, which the ideal motion must not need; none given: any"
    return quantity(None, "N m", 1e-6, 1e12, "chosen", text)


@checked
@dataclass(frozen=True)
class Drive:
    """A body whose angle is given: a mean speed, and what repeats with a cycle beside it.

    theta = angle + speed t + sum over k from 1 of a_k (cos k w t - 1) + b_k sin k w t + f(w t),
    f from a table or from rises, less its value at the start.

    Attributes
    ----------
    speed : float
        Mean speed, rad/s.
    angle : float
        Angle at the start, rad.
    frequency : float
        w, rad/s; 0: the mean speed, so that the motion repeats with each turn.
    harmonics : tuple of (float, float)
        a_k and b_k, rad.
    table : tuple of (float, float)
        Phase, rad, and f there, rad, through which the periodic cubic spline goes.  A last row
        one turn behind the first tells how far the body turns in a cycle; without one it comes
        back.  Rows of four hold the first and second derivative by the phase as well; then
        pieces are of degree 5.
    rises : tuple of Rise
        f rises in some parts of the cycle and dwells in the others.
    follow : Follow or None
        What a point does, in place of what the body does; ``angle`` is the body's at the start,
        ``speed`` its mean speed.
    torque_limit : float or None
        Greatest torque that it gives, N m, which the ideal motion must not need; None: any.
    """

    body: str
    speed: float = quantity(0.0, "rad/s", -FAST, FAST, "", "mean speed, counterclockwise")
    angle: float = angle("angle of the body at the start")
    frequency: float = quantity(
        0.0, "rad/s", 0.0, FAST, "", "frequency of what repeats; 0: the mean speed"
    )
    harmonics: Numbers = ()
    table: Numbers = ()
    rises: Sequence[Rise] = ()
    follow: Follow | None = None
    torque_limit: float | None = torque_limit()

    def __post_init__(self) -> None:
        """InputError where a number is out of range, or what repeats has no frequency."""
        _settle(self, self.body)
        own = [name for name in ("harmonics", "table", "rises") if getattr(self, name)]
        if self.follow is not None and own:
            raise InputError(
                f"drive of {self.body}: {own[0]} and follow are given; what follows a curve has "
                "no motion of its own"
            )
        repeating = [*own, *(["follow"] if self.follow is not None else [])]
        if repeating and not self.base > 0.0:
            raise InputError(
                f"frequency of {self.body} = {self.frequency:g} rad/s: with {repeating[0]} and a "
                "mean speed of 0 it must be above 0"
            )

    @property
    def name(self) -> str:
        """Name of the drive."""
        return f"drive of {self.body}"

    @property
    def base(self) -> float:
        """Frequency of the first harmonic, rad/s."""
        return self.frequency or abs(self.speed)

    @property
    def pieces(self) -> Pieces:
        """The part that is given piece by piece."""
        return pieces_of(*cast(Any, (self.table, self.rises)))

    @property
    def mean_speed(self) -> float:
        """Mean speed with what the pieces turn in a cycle, rad/s."""
        return self.speed + self.base * (self.pieces.net / _TURN)

    @property
    def repeats(self) -> bool:
        """True where something repeats beside the mean speed."""
        return bool(self.harmonics or self.table or self.rises or self.follow is not None)

    @property
    def frequencies(self) -> tuple[float, ...]:
        """Frequencies that a cycle of the linkage must fit, rad/s."""
        found = [abs(self.mean_speed)] if self.mean_speed != 0.0 else []
        return (*found, self.base) if self.repeats else tuple(found)

    def motion(self, time: Array) -> tuple[Array, Array, Array]:
        """Angle, rad, speed, rad/s, and acceleration, rad/s^2, at some instants, s.

        ValueError where it follows a curve: ``physics.following.followed`` finds its motion.
        """
        if self.follow is not None:
            raise ValueError(f"{self.name} follows a curve: its motion has to be found first")
        mean = self.mean_speed
        beside, faster, acceleration = series(self, self.base, time)
        return self.angle + mean * time + beside, mean + faster, acceleration


Law = Drive | Follow
"""What has harmonics, and a table or rises."""


def run_up_motion(time: Array, duration: float) -> tuple[Array, Array, Array]:
    """Time at which motions are followed, s, its rate, and its second derivative, 1/s.

    From rest its rate rises smoothly to 1 over a duration, s, in which half that time passes;
    0: it is the time itself.  The rate is 10 x^3 - 15 x^4 + 6 x^5.
    """
    if duration == 0.0:
        return time, np.ones_like(time), np.zeros_like(time)
    x = np.clip(time / duration, 0.0, 1.0)
    begun = duration * x**4 * (2.5 - x * (3.0 - x))
    rate = x**3 * (10.0 - x * (15.0 - 6.0 * x))
    return (
        np.where(time < duration, begun, time - 0.5 * duration),
        rate,
        30.0 * (x * (1.0 - x)) ** 2 / duration,
    )
