"""Motors: laws of the torque that turns a driven body, in place of a prescribed motion."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar

from presswear.linkage.load_laws import LOAD_PARAMETERS
from presswear.tools.errors import InputError
from presswear.tools.fields import quantity
from presswear.tools.serialize import Checked
from presswear.tools.user_function import UserFunction

MIN_TORQUE = 1e-3  # rated torque of a motor, N m
MAX_STIFFNESS = 1e12  # largest stiffness of a servo, N m/rad
MAX_MOTOR_SPEED = 1e6  # rad/s


class _TorqueLaw:
    """Converter of a setting to a user law of a torque."""

    def convert(self, name: str, value: Any) -> UserFunction:
        return UserFunction.read(name, value, LOAD_PARAMETERS)


def servo_stiffness(text: str) -> Any:
    """Return the field of the stiffness of a servo."""
    return quantity(
        None,
        unit="N m/rad",
        low=0.0,
        high=MAX_STIFFNESS,
        origin="assumed",
        text=text,
    )


def servo_damping(text: str) -> Any:
    """Return the field of the damping of a servo."""
    return quantity(
        0.0,
        unit="N m s/rad",
        low=0.0,
        high=MAX_STIFFNESS,
        origin="assumed",
        text=text,
    )


@dataclass(frozen=True)
class Motor(Checked):
    """Motor of a drive: a motor with slip, a servo, or a user law of the torque.

    The motor turns ``ratio`` times as fast as the body. Its slip is
    s = 1 - ratio omega / W_0. By Kloss's equation the torque on the body is
    ratio M_n k 2 s s_k / (s^2 + s_k^2), where k is the ``breakdown`` ratio. Without
    ``breakdown`` the torque is linear in the slip, ratio M_n s / s_n. A rated torque of
    0 is a free crank.

    A servo turns the body to the angle that its drive prescribes at the phase of the
    leader (``Linkage.leader``). It saturates at the ``torque_limit`` of its drive.

    Attributes
    ----------
    law : callable, str or None
        User law of the torque on the body, N m, positive counterclockwise. It is a
        function of time, s, angle of the body, rad, and angular velocity, rad/s, or its
        place as ``FILE.py:NAME``.
    """

    # fields that are not settings of the motor of a named mechanism
    unset: ClassVar[tuple[str, ...]] = ("stiffness", "damping")

    torque: float | None = quantity(
        None,
        unit="N m",
        low=0.0,
        high=1e7,
        origin="chosen",
        text="rated torque M_n of the motor, from its rating plate; 0: a free crank",
    )
    slip: float = quantity(
        0.08,
        unit="",
        low=1e-3,
        high=0.5,
        origin="chosen",
        text="slip s_n at the rated torque; NEMA design D: 0.05 to 0.13, design B: 0.005 to 0.05",
    )
    breakdown: float | None = quantity(
        2.75,
        unit="",
        low=1.01,
        high=10.0,
        origin="chosen",
        text="breakdown torque over rated torque; NEMA design D: 2.75; none: a line",
    )
    ratio: float = quantity(
        1.0,
        unit="",
        low=1e-3,
        high=1e4,
        origin="chosen",
        text="speed of the motor over that of the body",
    )
    inertia: float = quantity(
        0.0,
        unit="kg m^2",
        low=0.0,
        high=1e6,
        origin="chosen",
        text="inertia of rotor and flywheel on the shaft of the motor",
    )
    no_load_speed: float | None = quantity(
        None,
        unit="rad/s",
        low=1e-6,
        high=MAX_MOTOR_SPEED,
        origin="chosen",
        text="speed W_0 of the motor without load; default: ratio times the speed of the drive",
    )
    stiffness: float | None = servo_stiffness("stiffness of a servo")
    damping: float = servo_damping("damping of a servo")
    law: Annotated[UserFunction | Callable[..., float] | str | None, _TorqueLaw()] = (
        None
    )

    def __post_init__(self) -> None:
        super().__post_init__()
        names = ("torque", "stiffness", "law")
        laws = [name for name in names if getattr(self, name) is not None]
        if len(laws) != 1:
            fault = f"{' and '.join(laws)} are given" if laws else "no law is given"
            raise InputError(
                f"motor: {fault}; one is expected: torque of a motor, 0 for a free crank, "
                "stiffness of a servo, or a user law"
            )
        if self.torque is not None and 0.0 < self.torque < MIN_TORQUE:
            raise InputError(
                f"torque = {self.torque:g} N m: allowed is {MIN_TORQUE:g} to 1e+07 N m, or 0 for "
                "a free crank"
            )
        if self.damping and not self.is_servo:
            raise InputError(
                f"damping = {self.damping:g} N m s/rad: only a servo has it; specify its stiffness"
            )

    @property
    def is_servo(self) -> bool:
        """True for a servo, which follows the leader."""
        return self.stiffness is not None

    @property
    def is_free(self) -> bool:
        """True for a free crank: the torque is zero."""
        return self.torque == 0.0

    @property
    def has_slip(self) -> bool:
        """True if the torque depends on the slip."""
        return bool(self.torque)

    @property
    def breakdown_slip(self) -> float | None:
        """Slip s_k at the breakdown torque; None for a line."""
        if self.breakdown is None:
            return None
        return self.slip * (self.breakdown + math.sqrt(self.breakdown**2 - 1.0))

    @property
    def reflected_inertia(self) -> float:
        """Inertia of the motor about the axis of the body, ratio^2 J, kg m^2."""
        return self.ratio**2 * self.inertia
