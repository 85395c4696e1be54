"""Motions of drives: mean speeds, harmonics, tables, rises, followed curves, and a press's servo.

A motion is a mean speed and, beside it, what repeats with the cycle of the drive: a
Fourier series, and a table or rises with dwells between them, which become pieces.
Pieces are functions of the phase w t, which grows by 2 pi in a cycle. A new law of
rises is a few numbers in ``RISES``.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Annotated, Any, ClassVar, NamedTuple, cast

import numpy as np

from presswear.linkage.elements import (
    ANGLE,
    LENGTH,
    MAX_ANGLE,
    Attachment,
    OutputPoint,
    angle,
)
from presswear.linkage.motor import MAX_STIFFNESS, Motor
from presswear.tools.arrays import Array
from presswear.tools.errors import InputError
from presswear.tools.quantities import Quantity, choice, quantity, written
from presswear.tools.serialize import Checked

MAX_SPEED = 1e5  # of a drive, rad/s; the fastest spindles have 2e4
MAX_HARMONICS = 16
MAX_PIECES = 512  # of a motion
MIN_ROWS = 3  # of a table: fewer are no motion
MIN_PIECE = 1e-6  # length of a piece, rad of phase
DEGREE = 5  # of the polynomial of a piece

_TURN = 2.0 * math.pi
_PHASE_TOL = 1e-9  # rad: degrees that were typed are not exact

Piece = tuple[float, Sequence[float], tuple[float, float, float]]
"""Piece of a rise by 1 over a length of 1: start; coefficients of its polynomial in the distance
from there; amplitude, frequency and initial phase of its sine."""

_SINE = 1.0 / (4.0 + math.pi)  # unit of the modified sine
_PI_SINE = math.pi * _SINE
# Each begins and ends without velocity and acceleration. Source: R. L. Norton, Cam
# Design and Manufacturing Handbook; greatest velocities and accelerations are 2 and 2
# pi, 1.7596 and 5.5280, 1.875 and 5.7735.
RISES: Mapping[str, Sequence[Piece]] = {
    "cycloidal": ((0.0, (0.0, 1.0), (-1.0 / _TURN, _TURN, 0.0)),),
    "modified-sine": (
        (0.0, (0.0, _PI_SINE), (-0.25 * _SINE, 2.0 * _TURN, 0.0)),
        (
            0.125,
            ((2.0 + 0.125 * math.pi) * _SINE, _PI_SINE),
            (-2.25 * _SINE, 2.0 * _TURN / 3.0, 0.5 * math.pi),
        ),
        (
            0.875,
            ((4.0 + 0.875 * math.pi) * _SINE, _PI_SINE),
            (-0.25 * _SINE, 2.0 * _TURN, 1.5 * math.pi),
        ),
    ),
    "3-4-5": ((0.0, (0.0, 0.0, 0.0, 10.0, -15.0, 6.0), (0.0, 0.0, 0.0)),),
}

_WAY = Quantity("rad or m", -MAX_ANGLE, MAX_ANGLE, "", "way, rad or, of a point, m")
_A = Annotated[float, ANGLE]
_L = Annotated[float, LENGTH]


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

    # (n,), phases, rad; the last piece goes on to the first of the next cycle
    start: Array
    # (n, DEGREE + 1), in the phase since the piece began, the constant first
    polynomial: Array
    # (n, 3), amplitude, frequency and initial phase, rad, of a sine that is added
    wave: Array
    net: float  # way in a cycle, which the pieces leave out

    def at(self, phase: Array) -> tuple[Array, Array, Array]:
        """Return the value and its first and second derivative by the phase at phases, rad."""
        within = phase - _TURN * np.floor(phase / _TURN)
        place = np.searchsorted(self.start, within, side="right") - 1
        x = np.where(place < 0, within + _TURN, within) - self.start[place]
        value, slope, curvature = np.zeros((3, *x.shape))
        for power in range(DEGREE, -1, -1):
            curvature = curvature * x + 2.0 * slope
            slope = slope * x + value
            value = value * x + self.polynomial[place, power]
        amplitude, w, first = self.wave[place].T
        sine, cosine = np.sin(w * x + first), np.cos(w * x + first)
        value, slope = value + amplitude * sine, slope + amplitude * w * cosine
        return value, slope, curvature - amplitude * w * w * sine


NO_PIECES = Pieces(np.zeros(0), np.zeros((0, DEGREE + 1)), np.zeros((0, 3)), 0.0)


@lru_cache(maxsize=64)
def pieces_of(table: tuple[tuple[float, ...], ...], rises: tuple[Rise, ...]) -> Pieces:
    """Return the pieces of a table or of rises; either is empty."""
    if table:
        return _pieces_of_table(np.array(table))
    return _pieces_of_rises(rises) if rises else NO_PIECES


def _periodic(start: Array, polynomial: Array, wave: Array, net: float) -> Pieces:
    """Return pieces of a motion without its net way, in the order of their phases, zero at 0."""
    order = np.argsort(start % _TURN)
    pieces = Pieces((start % _TURN)[order], polynomial[order], wave[order], net)
    pieces.polynomial[:, 0] -= pieces.at(np.zeros(1))[0][0]
    return pieces


def _pieces_of_table(rows: Array) -> Pieces:
    """Return the periodic spline through rows, twice continuously differentiable."""
    net = 0.0
    if rows[-1, 0] - rows[0, 0] > _TURN - _PHASE_TOL:
        net = float(rows[-1, 1] - rows[0, 1])
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
        polynomial[:] = _quintics(phase, value, rows[:, 2] - net / _TURN, rows[:, 3])
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
    level, ways = 0.0, []
    for rise, then in zip(rises, _next_starts(rises), strict=True):
        length = rise.end - rise.start
        scale = rise.by / length ** np.arange(DEGREE + 1)
        for start, factors, (amplitude, w, first) in RISES[rise.law]:
            polynomial = np.zeros(DEGREE + 1)
            polynomial[: len(factors)] = factors
            polynomial *= scale
            polynomial[0] += level
            sine = rise.by * amplitude, w / length, first
            rows.append((rise.start + start * length, polynomial, sine))
        ways.append(rise.by)
        level = math.fsum(ways)
        # Ways there and back that were typed as decimals may leave a round-off.
        if abs(level) < 1e-12 * math.fsum(map(abs, ways)):
            level = 0.0
        if then - rise.end > _PHASE_TOL:
            rows.append(
                (rise.end, np.array([level, *np.zeros(DEGREE)]), (0.0, 0.0, 0.0))
            )
    starts, polynomials, waves = (
        np.array(column) for column in zip(*rows, strict=True)
    )
    polynomials[:, 0] -= level / _TURN * starts
    polynomials[:, 1] -= level / _TURN
    return _periodic(starts, polynomials, waves, level)


def _next_starts(rises: tuple[Rise, ...]) -> list[float]:
    return [
        *(rise.start for rise in rises[1:]),
        *(rise.start + _TURN for rise in rises[:1]),
    ]


def _check_table(table: Sequence[Sequence[float]], owner: str) -> None:
    """Raise InputError where rows are no table of a motion."""
    label = f"table of {owner}:"
    if len({len(row) for row in table}) > 1:
        raise InputError(f"{label} rows of one length are expected")
    phases = [row[0] for row in table]
    length = phases[-1] - phases[0]
    closes = length > _TURN - _PHASE_TOL
    rows = len(table) - closes
    if not MIN_ROWS <= rows <= MAX_PIECES:
        raise InputError(f"{label} {rows} rows; allowed are {MIN_ROWS} to {MAX_PIECES}")
    gaps = [*np.diff(phases), *([] if closes else [_TURN - length])]
    if phases[0] < 0.0 or min(gaps) < MIN_PIECE or length > _TURN + _PHASE_TOL:
        allowed = f"from 0 or above, by {MIN_PIECE:g} rad or more, in a cycle of 2 pi"
        span = f"phases from {phases[0]:g} to {phases[-1]:g} rad"
        raise InputError(f"{label} {span}; they must rise, {allowed}")


class _Motion(Checked):
    """Fourier series, and a table or rises, which repeat with a cycle."""

    harmonics: Sequence[tuple[float, float]]
    table: Sequence[tuple[float, ...]]
    rises: Sequence[Rise]

    @property
    def pieces(self) -> Pieces:
        """Piecewise part."""
        return pieces_of(*cast(Any, (self.table, self.rises)))

    def _check(self, owner: str) -> None:
        """Raise InputError where lists of numbers are no motion."""
        count = len(self.harmonics)
        if count > MAX_HARMONICS:
            allowed = f"allowed are 0 to {MAX_HARMONICS}"
            raise InputError(f"harmonics of {owner}: {count}; {allowed}")
        if self.table and self.rises:
            raise InputError(f"{owner}: a table and rises; one of them is expected")
        if self.table:
            _check_table(self.table, owner)
        rises = tuple(self.rises)
        for rise, then in zip(rises, _next_starts(rises), strict=True):
            room = then - rise.end
            if room < -_PHASE_TOL or _PHASE_TOL < room < MIN_PIECE:
                raise InputError(
                    f"rises of {owner}: the one that ends at {rise.end:g} rad must end "
                    f"{MIN_PIECE:g} rad or more before the next begins, at {then:g} rad, or there"
                )
        count = len(self.pieces.start)
        if count > MAX_PIECES:
            raise InputError(
                f"rises of {owner}: {count} pieces; allowed are {MAX_PIECES} at most"
            )


def series(motion: _Motion, base: float, time: Array) -> tuple[Array, Array, Array]:
    """Return the repeating part and two time derivatives at times, s; ``base`` in rad/s."""
    place, speed, acceleration = np.zeros((3, *time.shape))
    for k, (a, b) in enumerate(motion.harmonics, start=1):
        w = k * base
        cosine, sine = np.cos(w * time), np.sin(w * time)
        place = place + (a * (cosine - 1.0) + b * sine)
        speed = speed + w * (b * cosine - a * sine)
        acceleration = acceleration - w * w * (a * cosine + b * sine)
    if motion.pieces.start.size:
        value, slope, curvature = motion.pieces.at(base * time)
        place, speed, acceleration = (
            place + value,
            speed + base * slope,
            acceleration + base**2 * curvature,
        )
    return place, speed, acceleration


@dataclass(frozen=True)
class Follow(_Motion):
    """Curve that a drive makes a point follow: coordinate along a direction, from its start, m."""

    point: Attachment | OutputPoint | str
    direction: float | None = angle("direction of the curve that a point follows", None)
    harmonics: Sequence[tuple[_L, _L]] = ()
    table: Sequence[tuple[_A, _L] | tuple[_A, _L, _L, _L]] = ()
    rises: Sequence[Rise] = ()

    def __post_init__(self) -> None:
        super().__post_init__()
        self._check("follow")
        if net := self.pieces.net:
            fault = f"the curve ends {net:g} m from where it begins"
            raise InputError(f"follow: {fault}; it must come back")


def torque_limit() -> Any:
    """Return a data class field for the greatest torque of a drive, N m; None: any."""
    text = "torque limit of a drive without a motor, checked with the ideal motion; default: none"
    return quantity(None, "N m", 1e-6, 1e12, "chosen", text)


@dataclass(frozen=True)
class Drive(_Motion):
    """Drive of a body: a mean speed and a periodic motion.

    theta = angle + speed t + sum over k from 1 of a_k (cos k w t - 1) + b_k sin k w t +
    f(w t), with a_k, b_k of ``harmonics``, rad, and f from a table or from rises, less
    its start.

    Attributes
    ----------
    table : tuple of (float, float)
        Phase, rad, and f there, rad, nodes of a periodic cubic spline. If the last row
        lies one period after the first, it gives the net rotation of the body in a
        cycle; otherwise the body returns to its initial angle. Rows of four have the
        first and second derivative by the phase as well; then pieces are of degree 5.
    follow : Follow or None
        Motion of a point in place of that of the body; ``angle`` is the body's at the
        start, ``speed`` its mean speed.
    motor : Motor or None
        Law of the torque. The motion above is then that of the ideal linkage, the
        nominal one; in the dynamics the motor turns the body.
    """

    body: str
    speed: float = quantity(
        0.0, "rad/s", -MAX_SPEED, MAX_SPEED, "", "mean speed, counterclockwise"
    )
    angle: float = angle("angle of the body at the start")
    frequency: float = quantity(
        0.0, "rad/s", 0.0, MAX_SPEED, "", "frequency of the cycle; 0: the mean speed"
    )
    harmonics: Sequence[tuple[_A, _A]] = ()
    table: Sequence[tuple[_A, _A] | tuple[_A, _A, _A, _A]] = ()
    rises: Sequence[Rise] = ()
    follow: Follow | None = None
    torque_limit: float | None = torque_limit()
    motor: Motor | None = None

    def __post_init__(self) -> None:
        super().__post_init__()
        self._check(self.body)
        kinds = "harmonics", "table", "rises", "follow"
        names = [name for name in kinds if getattr(self, name)]
        if self.follow is not None and len(names) > 1:
            raise InputError(
                f"drive of {self.body}: {names[0]} and follow cannot be combined"
            )
        if names and not self.base > 0.0:
            fault = f"with {names[0]} and a mean speed of 0 it must be above 0"
            raise InputError(
                f"frequency of {self.body} = {self.frequency:g} rad/s: {fault}"
            )
        if self.motor is not None:
            self._check_motor(self.motor, names)

    def _check_motor(self, motor: Motor, motions: Sequence[str]) -> None:
        """Raise InputError where the drive has no motion that its motor can have."""
        if motions and not motor.is_servo:
            raise InputError(
                f"motor of {self.body}: with {motions[0]} a servo is expected, "
                "motor = {stiffness, damping}; other motors turn at their own speed"
            )
        if motor.has_slip and self.speed == 0.0:
            raise InputError(
                f"speed of {self.body} = 0 rad/s: a motor needs the nominal speed of its drive"
            )
        if self.torque_limit is not None and not motor.is_servo:
            raise InputError(
                f"torque_limit of {self.body} = {self.torque_limit:g} N m: only a servo saturates; "
                "the greatest torque of a motor is breakdown x torque"
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
    def mean_speed(self) -> float:
        """Mean speed, including the net angle of the pieces, rad/s."""
        return self.speed + self.base * (self.pieces.net / (2.0 * math.pi))

    @property
    def repeats(self) -> bool:
        """True if the drive has a periodic motion."""
        return bool(self.harmonics or self.table or self.rises or self.follow)

    @property
    def is_at_rest(self) -> bool:
        """True if the drive holds its body at rest."""
        return self.speed == 0.0 and not self.repeats

    @property
    def no_load_speed(self) -> float:
        """Speed of the body at which its motor gives no torque, rad/s, with its sense."""
        if self.motor is None or self.motor.no_load_speed is None:
            return self.speed
        speed = self.motor.no_load_speed / self.motor.ratio
        return math.copysign(speed, self.speed)

    @property
    def frequencies(self) -> tuple[float, ...]:
        """Frequencies that a cycle of the linkage must fit, rad/s."""
        mean = [abs(self.mean_speed)] if self.mean_speed != 0.0 else []
        return (*mean, self.base) if self.repeats else tuple(mean)

    def motion(self, time: Array) -> tuple[Array, Array, Array]:
        """Return angle, rad, speed and acceleration at times, s; not of a drive that follows."""
        assert self.follow is None
        mean = self.mean_speed
        deviation, deviation_rate, acceleration = series(self, self.base, time)
        return self.angle + mean * time + deviation, mean + deviation_rate, acceleration


# A servo moves crank 7 of the press while crank 2 turns evenly. The crank swings
# between two of its dead points, so that the slider may be at any height between
# theirs, wherever crank 2 is.
# part of the cycle in which the slider comes down to its slow part
_MIN_APPROACH = 0.125


def _servo_angle(degrees: float, text: str, low: float = -_TURN) -> Any:
    return quantity(math.radians(degrees), "rad", low, _TURN, "chosen", text)


_BOTTOM = "angle of crank 2 from the start to bottom dead centre"
_START = "initial angle of crank 7, which determines the height of the slider"


@dataclass(frozen=True, kw_only=True)
class _Servo(Checked):
    """Servo motor of crank 7, which is exact without a stiffness."""

    stiffness: float | None = quantity(
        *(None, "N m/rad", 0.0, MAX_STIFFNESS, "assumed"),
        "stiffness of the servo, which then follows the angle of crank 2; default: exact",
    )
    damping: float = quantity(
        *(0.0, "N m s/rad", 0.0, MAX_STIFFNESS, "assumed"),
        "damping of a servo with a stiffness",
    )
    torque_limit: float | None = quantity(
        *(None, "N m", 1e-6, 1e12, "chosen"),
        "torque at which a servo with a stiffness saturates; default: torque_limit",
    )

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.damping and self.stiffness is None:
            raise InputError(
                f"damping = {self.damping:g} N m s/rad: it needs a stiffness of the servo, such as "
                "1e5 N m/rad"
            )

    @property
    def motor(self) -> Motor | None:
        """Law of the torque of crank 7; None: the servo is exact."""
        if self.stiffness is None:
            return None
        return Motor(stiffness=self.stiffness, damping=self.damping)


@dataclass(frozen=True)
class Dwell(_Servo):
    """Slider at rest around bottom dead centre; half a cycle later it is at the top."""

    kind: ClassVar[str] = "dwell"

    stroke: float = quantity(0.09, "m", 1e-3, 10.0, "chosen", "stroke of the slider")
    part: float = quantity(
        1.0 / 9.0,
        "",
        0.0,
        0.5,
        "chosen",
        "fraction of the cycle in the dwell",
        open_low=True,
    )
    bottom: float = _servo_angle(120.0, _BOTTOM, 0.0)
    angle: float = _servo_angle(-20.0, _START)
    law: str = choice("modified-sine", tuple(RISES), "law of the rise and the return")

    def drive(self, body: str, frequency: float, slider: str) -> Drive:
        """Return the drive of a body that makes the slider, a point, dwell; frequency in rad/s."""
        half = math.pi * self.part
        low, top = self.bottom + half, self.bottom + math.pi
        up = Rise(low, top, self.stroke, self.law)
        down = Rise(top, self.bottom + _TURN - half, -self.stroke, self.law)
        follow = Follow(slider, rises=[up, down])
        return Drive(body, angle=self.angle, frequency=frequency, follow=follow)


@dataclass(frozen=True)
class Forming(_Servo):
    """Slider that comes down fast, works at a constant speed, stops smoothly, and goes back.

    In between it moves by polynomials of degree 5 without acceleration at their ends.
    """

    kind: ClassVar[str] = "forming"

    speed: float = quantity(
        0.05, "m/s", 1e-4, 10.0, "chosen", "constant speed in the work"
    )
    height: float = quantity(
        6e-3, "m", 1e-5, 10.0, "chosen", "height at which the constant speed begins"
    )
    end: float = quantity(
        1e-3, "m", 1e-6, 10.0, "chosen", "height at the end of forming"
    )
    stroke: float = quantity(0.09, "m", 1e-3, 10.0, "chosen", "stroke of the slider")
    bottom: float = _servo_angle(150.0, _BOTTOM, 0.0)
    angle: float = _servo_angle(0.0, _START)

    def __post_init__(self) -> None:
        super().__post_init__()
        if not self.end < self.height < self.stroke:
            limits = f"end = {written(self.end, 'm')} and stroke = {written(self.stroke, 'm')}"
            raise InputError(
                f"height = {written(self.height, 'm')}: must lie between {limits}"
            )

    def drive(self, body: str, frequency: float, slider: str) -> Drive:
        """Return the drive of a body that moves the slider, a point, so; frequency in rad/s.

        InputError for a speed with which there is no time for the way down, or too
        much.
        """
        # It stops over the way ``end`` at half the speed, as a mean.
        way = self.height + self.end
        low = way * frequency / (math.pi - _TURN * _MIN_APPROACH)
        # Slower at first than 0.4 of the speed, as a mean, it would go up before it
        # comes down.
        high = (2.5 * (self.stroke - self.height) + way) * frequency / math.pi
        if not low <= self.speed <= high:
            limits = " to ".join(written(value, "m/s") for value in (low, high))
            allowed = f"with these heights, stroke and cycle allowed is {limits}"
            raise InputError(f"servo.speed = {written(self.speed, 'm/s')}: {allowed}")
        slope = self.speed / frequency
        slow = self.bottom - 2.0 * self.end / slope
        fast = slow - (self.height - self.end) / slope
        table = [
            (fast % _TURN, self.height, -slope, 0.0),
            (slow % _TURN, self.end, -slope, 0.0),
            (self.bottom % _TURN, 0.0, 0.0, 0.0),
            ((self.bottom + math.pi) % _TURN, self.stroke, 0.0, 0.0),
        ]
        follow = Follow(slider, table=sorted(table))
        return Drive(body, angle=self.angle, frequency=frequency, follow=follow)


@dataclass(frozen=True)
class Pendulum(_Servo):
    """Crank that swings as a sine: middle + amplitude sin(turn of crank 2 - phase)."""

    kind: ClassVar[str] = "pendulum"

    amplitude: float = _servo_angle(
        10.0, "amplitude of crank 7, which determines the stroke", 0.0
    )
    middle: float = _servo_angle(-20.0, "angle of crank 7 in the middle of its swing")
    phase: float = _servo_angle(
        180.0, "angle of crank 2 at which crank 7 rises through its middle"
    )

    def drive(self, body: str, frequency: float, slider: str) -> Drive:
        """Return the drive of a body that swings; frequency in rad/s, slider not used."""
        cosine = -self.amplitude * math.sin(self.phase)
        series = [(cosine, self.amplitude * math.cos(self.phase))]
        return Drive(
            body, angle=self.middle + cosine, frequency=frequency, harmonics=series
        )


@dataclass(frozen=True)
class ConstantSpeed(_Servo):
    """Crank that turns as fast as crank 2, in the opposite sense."""

    kind: ClassVar[str] = "constant-speed"

    angle: float = _servo_angle(-51.18, _START)

    def drive(self, body: str, frequency: float, slider: str) -> Drive:
        """Return the drive of a body at a speed, rad/s; slider not used."""
        return Drive(body, frequency, self.angle)


Servo = Dwell | Forming | Pendulum | ConstantSpeed
SERVOS: Mapping[str, type[Servo]] = {
    servo.kind: servo for servo in (Dwell, Forming, Pendulum, ConstantSpeed)
}
