"""Motors: laws of the torque that turns a driven body, in place of a prescribed motion."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar

from presswear.linkage.loads import LOAD_PARAMETERS
from presswear.tools.errors import InputError
from presswear.tools.quantities import quantity
from presswear.tools.serialize import Checked
from presswear.tools.user_function import UserFunction

MIN_TORQUE = 1e-3  # rated torque of a motor, N m
MAX_STIFFNESS = 1e12  # of a servo, N m/rad
MAX_MOTOR_SPEED = 1e6  # rad/s


class _TorqueLaw:
    """Reader of a user law of a torque."""

    def convert(self, name: str, value: Any) -> UserFunction:
        return UserFunction.read(name, value, LOAD_PARAMETERS)


@dataclass(frozen=True)
class Motor(Checked):
    """Motor of a drive: a rated torque, a servo, or a user law; torque 0: a free crank.

    The motor turns ``ratio`` times as fast as the body. With the slip
    s = 1 - ratio omega / W_0 the torque on the body is that of Kloss's equation,
    ratio M_n k 2 s s_k / (s^2 + s_k^2), or without ``breakdown`` that of a line, ratio
    M_n s / s_n. A servo turns the body to the angle that its drive prescribes at the
    phase of the leader, see ``Linkage.leader``, and saturates at the ``torque_limit``
    of its drive.

    Attributes
    ----------
    law : callable, str or None
        User law of the torque on the body, N m, counterclockwise: a function of time, s,
        position, the angle of the body, rad, and speed, rad/s, also as ``FILE.py:NAME``.
    """

    # fields that the motor of a crank of a mechanism does not have as settings
    unset: ClassVar[tuple[str, ...]] = ("stiffness", "damping")

    torque: float | None = quantity(
        *(None, "N m", 0.0, 1e7, "chosen"),
        "rated torque M_n of the motor, from its rating plate; 0: a free crank",
    )
    slip: float = quantity(
        *(0.08, "", 1e-3, 0.5, "chosen"),
        "slip s_n at the rated torque; NEMA design D: 0.05 to 0.13, design B: 0.005 to 0.05",
    )
    breakdown: float | None = quantity(
        *(2.75, "", 1.01, 10.0, "chosen"),
        "breakdown torque over rated torque; NEMA design D: 2.75; none: a line",
    )
    ratio: float = quantity(
        *(1.0, "", 1e-3, 1e4, "chosen"), "speed of the motor over that of the body"
    )
    inertia: float = quantity(
        *(0.0, "kg m^2", 0.0, 1e6, "chosen"),
        "inertia of rotor and flywheel on the shaft of the motor",
    )
    no_load_speed: float | None = quantity(
        *(None, "rad/s", 1e-6, MAX_MOTOR_SPEED, "chosen"),
        "speed W_0 of the motor without load; default: ratio times the speed of the drive",
    )
    stiffness: float | None = quantity(
        *(None, "N m/rad", 0.0, MAX_STIFFNESS, "assumed"), "stiffness of a servo"
    )
    damping: float = quantity(
        *(0.0, "N m s/rad", 0.0, MAX_STIFFNESS, "assumed"), "damping of a servo"
    )
    law: Annotated[UserFunction | Callable[..., float] | str | None, _TorqueLaw()] = (
        None
    )

    def __post_init__(self) -> None:
        super().__post_init__()
        laws = [
            name
            for name in ("torque", "stiffness", "law")
            if getattr(self, name) is not None
        ]
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
        """True for a free crank."""
        return self.torque == 0.0

    @property
    def has_slip(self) -> bool:
        """True for a motor whose torque depends on its slip."""
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
