"""Servos of the press: motions of crank 7 while crank 2 turns at a constant speed.

Crank 7 swings between two of its dead points. The slider can be at any height between
the heights at these points, at any angle of crank 2.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

from presswear.linkage.drives import Drive, Follow
from presswear.linkage.motion_pieces import RISES, TURN, Rise
from presswear.linkage.motor import Motor, servo_damping, servo_stiffness
from presswear.tools.errors import InputError
from presswear.tools.fields import choice, quantity
from presswear.tools.quantities import written
from presswear.tools.serialize import Checked

# smallest part of the cycle in which the slider comes down to the constant speed
_MIN_APPROACH = 0.125
_BOTTOM = "angle of crank 2 from the start to bottom dead centre"
_START = "initial angle of crank 7, which determines the height of the slider"


def _servo_angle(degrees: float, text: str, low: float = -TURN) -> Any:
    return quantity(math.radians(degrees), "rad", low, TURN, "chosen", text)


@dataclass(frozen=True, kw_only=True)
class _Servo(Checked):
    """Servo motor of crank 7, which is exact without a stiffness."""

    stiffness: float | None = servo_stiffness(
        "stiffness of the servo, which then follows the angle of crank 2; default: exact"
    )
    damping: float = servo_damping("damping of a servo with a stiffness")
    torque_limit: float | None = quantity(
        None,
        unit="N m",
        low=1e-6,
        high=1e12,
        origin="chosen",
        text="torque at which a servo with a stiffness saturates; default: torque_limit",
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
        unit="",
        low=0.0,
        high=0.5,
        origin="chosen",
        text="fraction of the cycle in the dwell",
        open_low=True,
    )
    bottom: float = _servo_angle(120.0, _BOTTOM, 0.0)
    angle: float = _servo_angle(-20.0, _START)
    law: str = choice("modified-sine", tuple(RISES), "law of the rise and the return")

    def drive(self, body: str, frequency: float, slider: str) -> Drive:
        """Return the drive of a body that makes the slider, a point, dwell; frequency in rad/s."""
        half = math.pi * self.part
        low = self.bottom + half
        top = self.bottom + math.pi
        up = Rise(low, top, self.stroke, self.law)
        down = Rise(top, self.bottom + TURN - half, -self.stroke, self.law)
        follow = Follow(slider, rises=[up, down])
        return Drive(body, angle=self.angle, frequency=frequency, follow=follow)


@dataclass(frozen=True)
class Forming(_Servo):
    """Slider that comes down fast, works at a constant speed, stops smoothly, and goes back.

    Between these phases it moves by polynomials of degree 5 without acceleration at
    their ends.
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
        """Return the drive of a body that moves the slider, a point; frequency in rad/s.

        Raises InputError if the time for the way down is too short, or so long that the
        slider would first go up.
        """
        # Over the way ``end`` it stops with a mean of half the speed.
        way = self.height + self.end
        low = way * frequency / (math.pi - TURN * _MIN_APPROACH)
        # If the mean speed of the approach is below 0.4 of the speed, the polynomial goes
        # up before it comes down.
        high = (2.5 * (self.stroke - self.height) + way) * frequency / math.pi
        if not low <= self.speed <= high:
            limits = " to ".join(written(value, "m/s") for value in (low, high))
            allowed = f"with these heights, stroke and cycle allowed is {limits}"
            raise InputError(f"servo.speed = {written(self.speed, 'm/s')}: {allowed}")
        slope = self.speed / frequency
        slow = self.bottom - 2.0 * self.end / slope
        fast = slow - (self.height - self.end) / slope
        table = [
            (fast % TURN, self.height, -slope, 0.0),
            (slow % TURN, self.end, -slope, 0.0),
            (self.bottom % TURN, 0.0, 0.0, 0.0),
            ((self.bottom + math.pi) % TURN, self.stroke, 0.0, 0.0),
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
