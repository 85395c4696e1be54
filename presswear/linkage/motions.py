"""Motions of drives as data: what a driven angle, or a followed coordinate, does over time.

A motion is a mean speed and, beside it, what repeats with the drive's own cycle: a Fourier
series, and a table or rises with dwells between them, which come down to pieces.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, cast

import numpy as np

from presswear.linkage.pieces import (
    MOST_PIECES,
    Numbers,
    Pieces,
    Rise,
    check_rises,
    check_table,
    pieces_of,
)
from presswear.linkage.points import Attachment, Probe, angle
from presswear.tools.arrays import Array
from presswear.tools.errors import InputError, shown
from presswear.tools.quantities import quantity
from presswear.tools.serialize import check_fields

FAST = 1e5
"""Greatest speed and frequency of a drive, rad/s; the fastest spindles have 2e4."""
MOST_HARMONICS = 16
"""Of a motion."""


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
        check_table(law.table, owner)
    if law.rises:
        check_rises(tuple(law.rises), owner)
    count = len(law.pieces.start)
    if count > MOST_PIECES:
        raise InputError(
            f"rises of {owner}: they make {count} pieces; allowed are {MOST_PIECES} at most"
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
        return self.speed + self.base * (self.pieces.net / (2.0 * math.pi))

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
