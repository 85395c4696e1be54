"""Torques of motors on the bodies that they turn."""

import math
from dataclasses import dataclass
from typing import ClassVar, Self

from presswear.linkage.drives import Drive
from presswear.linkage.linkage import Linkage
from presswear.linkage.load_laws import LOAD_PARAMETERS
from presswear.linkage.motor import Motor
from presswear.physics.equations.text import (
    ONE,
    Text,
    difference,
    product,
    quotient,
    total,
)
from presswear.physics.interactions.page import Kernels, Page
from presswear.physics.packed import Packed
from presswear.tools.arrays import Array
from presswear.tools.compile import address_of, inlined
from presswear.tools.compiled_law import compile_function


@inlined
def induction_torque(
    slip: float, rated: float, breakdown: float, breakdown_slip: float
) -> float:
    """Return the torque of an induction motor by Kloss's equation, N m.

    ``rated`` is the rated torque, N m, ``breakdown`` the breakdown torque over it.
    """
    squares = slip * slip + breakdown_slip * breakdown_slip
    return rated * breakdown * 2.0 * slip * breakdown_slip / squares


@inlined
def line_torque(slip: float, rated: float, rated_slip: float) -> float:
    """Return the torque of a motor that grows linearly with its slip, N m."""
    return rated * slip / rated_slip


@inlined
def servo_torque(
    lag: float, speed_lag: float, stiffness: float, damping: float, limit: float
) -> float:
    """Return the torque of a servo, N m, which saturates at a limit.

    ``lag`` and ``speed_lag`` are the angle and the speed of its reference less those of
    the body, rad and rad/s.
    """
    torque = stiffness * lag + damping * speed_lag
    return min(max(torque, -limit), limit)


@dataclass(frozen=True)
class MotorTorque:
    """The torque of a motor on the body of its drive, as text."""

    drive: Drive
    motor: Motor
    number: int  # among the drives
    leader: Drive | None  # drive whose phase a servo follows; None: the time

    kernels: ClassVar[Kernels] = (induction_torque, line_torque, servo_torque)

    @classmethod
    def all_of(cls, linkage: Linkage, packed: Packed) -> list[Self]:
        """Return all motors of a linkage that give a torque."""
        return [
            cls(drive, drive.motor, number, linkage.leader)
            for number, drive in enumerate(linkage.drives)
            if drive.motor is not None
            and not drive.motor.is_free
            and not linkage.prescribes(drive)
        ]

    @property
    def bodies(self) -> tuple[str, ...]:
        """The body that it turns."""
        return (self.drive.body,)

    @classmethod
    def stored_energy(cls, linkage: Linkage, position: Array) -> float:
        """Return nothing: what motors do is work of the drives."""
        return 0.0

    def write(self, page: Page) -> None:
        """Write the torque on the body, its power and its integrals."""
        text = page.text
        body = page.chain.of(self.drive.body)
        prefix = text.prefix(f"motor of {self.drive.body}")
        text.comment(f"motor of {self.drive.body}")
        if self.motor.law is not None:
            torque = self._user_law(text, prefix, body.angle, body.omega)
        elif self.motor.is_servo:
            torque = self._servo(page, prefix)
        else:
            torque = self._by_slip(text, prefix, body.omega)
        torque = text.let(f"{prefix}_torque", torque)
        body.moments.append(torque)
        power = text.let(f"{prefix}_power", product(torque, body.omega))
        page.set_torque(self.number, torque, power)

    def _by_slip(self, text: Text, prefix: str, omega: str) -> str:
        """Return the torque of a motor with a rated slip."""
        motor = self.motor
        assert motor.torque is not None
        sense = math.copysign(1.0, self.drive.speed)
        rated = text.parameter(f"{prefix}_rated", sense * motor.ratio * motor.torque)
        no_load = text.parameter(f"{prefix}_no_load_speed", self.drive.no_load_speed)
        slip = text.let(f"{prefix}_slip", difference(ONE, quotient(omega, no_load)))
        if motor.breakdown is None or motor.breakdown_slip is None:
            rated_slip = text.parameter(f"{prefix}_rated_slip", motor.slip)
            return f"line_torque({slip}, {rated}, {rated_slip})"
        breakdown = text.parameter(f"{prefix}_breakdown", motor.breakdown)
        breakdown_slip = text.parameter(
            f"{prefix}_breakdown_slip", motor.breakdown_slip
        )
        return f"induction_torque({slip}, {rated}, {breakdown}, {breakdown_slip})"

    def _servo(self, page: Page, prefix: str) -> str:
        """Return the torque of a servo that follows the leader."""
        text = page.text
        drive = self.drive
        body = page.chain.of(self.drive.body)
        phase, phase_rate = self._phase(page, prefix)
        start = text.parameter(f"{prefix}_start_angle", drive.angle)
        if drive.repeats:
            rotation = f"{prefix}_rotation"
            speed = f"{prefix}_speed"
            motion = f"uneven_motion(data.motions[{self.number}], {phase})"
            text.write(f"{rotation}, {speed}, _ = {motion}")
        else:
            speed = text.parameter(f"{prefix}_speed", drive.speed)
            rotation = product(speed, phase)
        lag = difference(total(start, rotation), body.angle)
        lag = text.let(f"{prefix}_lag", lag)
        speed_lag = difference(product(speed, phase_rate), body.omega)
        speed_lag = text.let(f"{prefix}_speed_lag", speed_lag)
        limit = math.inf if drive.torque_limit is None else drive.torque_limit
        numbers = {
            "stiffness": self.motor.stiffness or 0.0,
            "damping": self.motor.damping,
            "limit": limit,
        }
        names = (text.parameter(f"{prefix}_{key}", x) for key, x in numbers.items())
        return f"servo_torque({lag}, {speed_lag}, {', '.join(names)})"

    def _phase(self, page: Page, prefix: str) -> tuple[str, str]:
        """Write tau, s, the phase that a servo follows, and its rate."""
        if self.leader is None:
            return "t", ONE
        text = page.text
        body = page.chain.of(self.leader.body)
        start = text.parameter(f"{prefix}_leader_start", self.leader.angle)
        nominal = text.parameter(f"{prefix}_leader_speed", self.leader.speed)
        phase = quotient(f"({difference(body.angle, start)})", nominal)
        rate = quotient(body.omega, nominal)
        return text.let(f"{prefix}_tau", phase), text.let(f"{prefix}_tau_rate", rate)

    def _user_law(self, text: Text, prefix: str, angle: str, omega: str) -> str:
        """Return the torque of a user law, by the address of its machine code."""
        law = self.motor.law
        function = compile_function(law, LOAD_PARAMETERS)
        address = text.parameter(
            f"{prefix}_law", address_of(function, len(LOAD_PARAMETERS))
        )
        return f"call(int({address}), (t, {angle}, {omega}))"
