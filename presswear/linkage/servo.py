"""What a servo does with a crank of a press while the other crank turns evenly, as data.

Crank 7 swings between two of its dead points, in which it does not move the slider: wherever crank
2 is, the slider may be at any height between those of the two.  A crank that turns all around
passes its dead points in each turn and has no choice of the height there.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

from presswear.linkage.motions import Drive, Follow
from presswear.linkage.pieces import RISES, Rise
from presswear.tools.errors import InputError
from presswear.tools.quantities import choice, quantity
from presswear.tools.serialize import check_fields

_TURN = 2.0 * math.pi
APPROACH = 0.125
"""Least part of the cycle in which the slider comes down to where it is to be slow."""


def _angle(degrees: float, text: str, low: float = -_TURN) -> Any:
    return quantity(math.radians(degrees), "rad", low, _TURN, "chosen", text)


def _stroke() -> Any:
    return quantity(0.09, "m", 1e-3, 10.0, "chosen", "stroke of the slider")


def _bottom(degrees: float) -> Any:
    return _angle(degrees, "turn of crank 2 from its start to bottom dead centre", 0.0)


def _start(degrees: float) -> Any:
    return _angle(degrees, "angle of crank 7 at the start, by which the slider's height is set")


@dataclass(frozen=True)
class Dwell:
    """The slider stands still around bottom dead centre; half a cycle later it is at the top.

    Attributes
    ----------
    part : float
        Part of the cycle in which it stands still.
    """

    kind: ClassVar[str] = "dwell"

    part: float = quantity(
        1.0 / 9.0, "", 0.0, 0.5, "chosen", "part of the cycle of the dwell", open_low=True
    )
    stroke: float = _stroke()
    bottom: float = _bottom(120.0)
    angle: float = _start(-20.0)
    law: str = choice("modified-sine", tuple(RISES), "law of the rise and the return")

    def __post_init__(self) -> None:
        """InputError where a number is out of range."""
        check_fields(self)

    def drive(self, body: str, frequency: float, slider: str) -> Drive:
        """The drive of a body that makes the slider, a point, do so; frequency in rad/s."""
        half = math.pi * self.part
        low, top = self.bottom + half, self.bottom + math.pi
        rises = [
            Rise(low, top, self.stroke, self.law),
            Rise(top, self.bottom + _TURN - half, -self.stroke, self.law),
        ]
        follow = Follow(slider, rises=rises)
        return Drive(body, angle=self.angle, frequency=frequency, follow=follow)


@dataclass(frozen=True)
class Forming:
    """The slider comes down fast, works at a constant speed, stops smoothly, and goes back.

    Between its places of rest, constant speed and rest it moves by polynomials of degree 5,
    without acceleration at their ends.

    Attributes
    ----------
    speed : float
        m/s.
    height, end : float
        Height over bottom dead centre where the constant speed begins, and where it ends, m.
    """

    kind: ClassVar[str] = "forming"

    speed: float = quantity(0.05, "m/s", 1e-4, 10.0, "chosen", "constant speed in the work")
    height: float = quantity(
        6e-3, "m", 1e-5, 10.0, "chosen", "height at which the constant speed begins"
    )
    end: float = quantity(1e-3, "m", 1e-6, 10.0, "chosen", "height at which it ends")
    stroke: float = _stroke()
    bottom: float = _bottom(150.0)
    angle: float = _start(0.0)

    def __post_init__(self) -> None:
        """InputError where a number is out of range, or heights are in the wrong order."""
        check_fields(self)
        if not self.end < self.height < self.stroke:
            raise InputError(
                f"height = {self.height:g} m: with end = {self.end:g} m and stroke = "
                f"{self.stroke:g} m allowed is what lies between them"
            )

    def drive(self, body: str, frequency: float, slider: str) -> Drive:
        """The drive of a body that makes the slider, a point, do so; frequency in rad/s.

        InputError for a speed with which there is no time for the way down, or too much.
        """
        # It stops over the way ``end`` at half the speed, as a mean.
        way = self.height + self.end
        low = way * frequency / (math.pi - _TURN * APPROACH)
        # Slower at first than 0.4 of the speed, as a mean, it would go up before it comes down.
        high = (2.5 * (self.stroke - self.height) + way) * frequency / math.pi
        if not low <= self.speed <= high:
            raise InputError(
                f"servo.speed = {self.speed:g} m/s: with these heights, stroke and cycle allowed "
                f"is {low:.6g} to {high:.6g} m/s"
            )
        slope = self.speed / frequency
        slow = self.bottom - 2.0 * self.end / slope
        rows = [
            (slow - (self.height - self.end) / slope, self.height, -slope, 0.0),
            (slow, self.end, -slope, 0.0),
            (self.bottom, 0.0, 0.0, 0.0),
            (self.bottom + math.pi, self.stroke, 0.0, 0.0),
        ]
        table = sorted((phase % _TURN, *rest) for phase, *rest in rows)
        follow = Follow(slider, table=table)
        return Drive(body, angle=self.angle, frequency=frequency, follow=follow)


@dataclass(frozen=True)
class Pendulum:
    """The crank swings to and fro as a sine: middle + amplitude sin(turn of crank 2 - phase)."""

    kind: ClassVar[str] = "pendulum"

    amplitude: float = _angle(10.0, "amplitude of crank 7, by which the stroke is set", 0.0)
    middle: float = _angle(-20.0, "angle of crank 7 in the middle of its swing")
    phase: float = _angle(180.0, "turn of crank 2 at which crank 7 rises through its middle")

    def __post_init__(self) -> None:
        """InputError where a number is out of range."""
        check_fields(self)

    def drive(self, body: str, frequency: float, slider: str) -> Drive:
        """The drive of a body that swings, whatever the slider does; frequency in rad/s."""
        cosine, sine = (
            -self.amplitude * math.sin(self.phase),
            self.amplitude * math.cos(self.phase),
        )
        return Drive(
            body, angle=self.middle + cosine, frequency=frequency, harmonics=[(cosine, sine)]
        )


Servo = Dwell | Forming | Pendulum
SERVOS: Mapping[str, type[Servo]] = {own.kind: own for own in (Dwell, Forming, Pendulum)}
"""What a servo may do, by its kind."""
