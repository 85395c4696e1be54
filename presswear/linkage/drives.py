"""Drives that turn a body, move it along its guide or follow another one through gears.

A motion is a mean speed and a part that repeats with the cycle of the drive: a Fourier
series, and the pieces of a table or of rises.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Annotated, Any, cast

import numpy as np

from presswear.linkage.motion_pieces import (
    MAX_PIECES,
    MIN_PIECE,
    PHASE_TOL,
    Pieces,
    Rise,
    check_table,
    next_starts,
    pieces_of,
)
from presswear.linkage.motor import Motor
from presswear.linkage.points import (
    ANGLE,
    LENGTH,
    Attachment,
    OutputPoint,
    angle,
    place,
)
from presswear.tools.arrays import Array
from presswear.tools.errors import InputError
from presswear.tools.fields import quantity
from presswear.tools.quantities import Quantity
from presswear.tools.serialize import Checked

MAX_SPEED = 1e5  # largest speed of a drive, rad/s; the fastest spindles have 2e4
MAX_HARMONICS = 16
MAX_RATIO = 1e3  # largest ratio of gears
_RATIO = Quantity(
    "",
    -MAX_RATIO,
    MAX_RATIO,
    "chosen",
    "speed of the body over that of the leader; negative: the opposite sense",
)
_A = Annotated[float, ANGLE]  # rad
_L = Annotated[float, LENGTH]  # m


class _Motion(Checked):
    """Periodic motion: a Fourier series, and a table or rises."""

    harmonics: Sequence[tuple[float, float]]
    table: Sequence[tuple[float, ...]]
    rises: Sequence[Rise]

    @property
    def pieces(self) -> Pieces:
        """Piecewise part."""
        return pieces_of(*cast(Any, (self.table, self.rises)))

    def _check(self, owner: str) -> None:
        """Raise InputError if the lists of numbers are not a motion."""
        count = len(self.harmonics)
        if count > MAX_HARMONICS:
            allowed = f"allowed are 0 to {MAX_HARMONICS}"
            raise InputError(f"harmonics of {owner}: {count}; {allowed}")
        if self.table and self.rises:
            raise InputError(f"{owner}: a table and rises; one of them is expected")
        if self.table:
            check_table(self.table, owner)
        rises = tuple(self.rises)
        for rise, next_start in zip(rises, next_starts(rises), strict=True):
            dwell = next_start - rise.end
            if dwell < -PHASE_TOL or PHASE_TOL < dwell < MIN_PIECE:
                raise InputError(
                    f"rises of {owner}: the rise that ends at {rise.end:g} rad must end at the "
                    f"start of the next, {next_start:g} rad, or {MIN_PIECE:g} rad or more before"
                )
        count = len(self.pieces.start)
        if count > MAX_PIECES:
            raise InputError(
                f"rises of {owner}: {count} pieces; allowed are {MAX_PIECES} at most"
            )


def series(motion: _Motion, base: float, time: Array) -> tuple[Array, Array, Array]:
    """Return the periodic part of a motion and its two time derivatives at times, s.

    ``base`` is the frequency of the cycle, rad/s. The shapes are those of ``time``.
    """
    place, speed, acceleration = np.zeros((3, *time.shape))
    for k, (a, b) in enumerate(motion.harmonics, start=1):
        w = k * base
        cosine = np.cos(w * time)
        sine = np.sin(w * time)
        place = place + (a * (cosine - 1.0) + b * sine)
        speed = speed + w * (b * cosine - a * sine)
        acceleration = acceleration - w * w * (a * cosine + b * sine)
    if motion.pieces.start.size:
        value, slope, curvature = motion.pieces.at(base * time)
        place = place + value
        speed = speed + base * slope
        acceleration = acceleration + base**2 * curvature
    return place, speed, acceleration


@dataclass(frozen=True)
class Follow(_Motion):
    """Displacement of a point of a driven body along a direction over the cycle, m."""

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
        Motion of a point in place of the motion of the body; ``angle`` and ``speed``
        are then the initial angle and the mean speed of the body.
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
        # Their cycle has the frequency, or the mean speed if this is not 0.
        if names and not self.base > 0.0:
            fault = f"with {names[0]} and a mean speed of 0 it must be above 0"
            raise InputError(
                f"frequency of {self.body} = {self.frequency:g} rad/s: {fault}"
            )
        if self.motor is not None:
            self._check_motor(self.motor, names)

    def _check_motor(self, motor: Motor, motions: Sequence[str]) -> None:
        """Raise InputError if the motor does not fit the motion of the drive."""
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
    def start(self) -> float:
        """Angle of the body at the start, rad."""
        return self.angle

    @property
    def coupled_bodies(self) -> set[str]:
        """Bodies whose coordinates are in its constraint equation."""
        return {self.body}

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
        frequencies = []
        if self.mean_speed != 0.0:
            frequencies.append(abs(self.mean_speed))
        if self.repeats:
            frequencies.append(self.base)
        return tuple(frequencies)

    def motion(self, time: Array) -> tuple[Array, Array, Array]:
        """Return angle, rad, speed and acceleration at times, s; not of a drive that follows."""
        assert self.follow is None
        mean = self.mean_speed
        deviation, deviation_rate, acceleration = series(self, self.base, time)
        return self.start + mean * time + deviation, mean + deviation_rate, acceleration


@dataclass(frozen=True)
class LinearDrive(Drive):
    """Drive along a guide, as a cylinder or a ball screw: a periodic motion.

    The guide is on the frame, or on a body, as the bore of a cylinder between two bodies.
    The distance of the driven body from the point of its guide is s = position + sum over k from
    1 of a_k (cos k w t - 1) + b_k sin k w t + f(w t), m, with a_k, b_k of ``harmonics``
    and f from a table or from rises, less its start. The drive gives a force along the
    guide, N, wherever other drives give a torque; the body that carries the guide bears
    the reaction.

    Attributes
    ----------
    along : str
        Name of the guide of the body.
    table : tuple of (float, float)
        Phase, rad, and f there, m; see ``Drive``.
    """

    along: str = field(kw_only=True)
    position: float = place("distance from the point of the guide at the start")
    harmonics: Sequence[tuple[_L, _L]] = ()
    table: Sequence[tuple[_A, _L] | tuple[_A, _L, _L, _L]] = ()
    rises: Sequence[Rise] = ()

    def __post_init__(self) -> None:
        super().__post_init__()
        for name in ("speed", "angle", "follow", "torque_limit", "motor"):
            if getattr(self, name):
                raise InputError(
                    f"{name} of {self.body}: a drive along a guide has none; its motion is "
                    "position, and harmonics, table or rises with a frequency"
                )
        if net := self.pieces.net:
            raise InputError(
                f"drive of {self.body} along {self.along}: it ends {net:g} m from where it "
                "begins; it must come back"
            )

    @property
    def start(self) -> float:
        """Distance from the point of the guide at the start, m."""
        return self.position


def leader_of(drives: Sequence[Drive]) -> Drive | None:
    """Return the first drive with a motor that is no servo, if there is one."""
    for drive in drives:
        if drive.motor is not None and not drive.motor.is_servo:
            return drive
    return None


@dataclass(frozen=True)
class GearedDrive(Drive):
    """Gears without play between two cranks: one turns at a ratio times the other.

    phi = angle + ratio (phi_leader - angle_leader). The torque on the body is that of the
    gears; -ratio times this torque acts on the body of the leader, whose drive or motor
    gives their power.

    Attributes
    ----------
    leader : str
        Body of the drive that moves the gears.
    """

    leader: str = field(kw_only=True)
    ratio: Annotated[float, _RATIO] = field(kw_only=True)
    # True once the motion is that of the leader times the ratio
    is_placed: bool = field(default=False, kw_only=True, repr=False)

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.leader == self.body:
            raise InputError(
                f"leader of {self.body} = {self.leader}: must be another body"
            )
        if self.ratio == 0.0:
            raise InputError(f"ratio of {self.body} = 0: must not be 0")
        unset = ["follow", "torque_limit", "motor"]
        if not self.is_placed:
            unset += ["speed", "frequency", "harmonics", "table", "rises"]
        for name in unset:
            if getattr(self, name):
                raise InputError(
                    f"{name} of {self.body}: a drive with a leader has none; its motion is that "
                    "of the leader times the ratio"
                )

    @property
    def coupled_bodies(self) -> set[str]:
        """Bodies whose coordinates are in its constraint equation."""
        return {self.body, self.leader}

    def placed(self, leader: Drive) -> "GearedDrive":
        """Return the drive with the motion of its leader times the ratio."""
        n = self.ratio
        table: list[Any] = []
        for phase, *values in leader.table:
            table.append((phase, *(n * value for value in values)))
        return replace(
            self,
            speed=n * leader.speed,
            frequency=leader.base if leader.repeats else leader.frequency,
            harmonics=[(n * a, n * b) for a, b in leader.harmonics],
            table=table,
            rises=[replace(rise, by=n * rise.by) for rise in leader.rises],
            is_placed=True,
        )


def linear_bodies(drives: Sequence[Drive]) -> tuple[str, ...]:
    """Return the bodies that drives move along their guides."""
    return tuple(drive.body for drive in drives if isinstance(drive, LinearDrive))
