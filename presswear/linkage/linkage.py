"""Planar linkage as data, and its assembly from parts.

Every engine uses this description. The coordinates of body ``i`` are the position of its
mass centre and its angle, ``q[3 i : 3 i + 3] = x, y, theta``, in the order of
``Linkage.bodies``. The frame has the name ``GROUND``; its points have global coordinates.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, ClassVar

from presswear.linkage.bodies import Bar, Body
from presswear.linkage.clearance_joint import Bushing, ClearanceJoint
from presswear.linkage.cycle import check_cycle, common_period
from presswear.linkage.drives import Drive, GearedDrive, LinearDrive, leader_of
from presswear.linkage.guide_corner import GuideCorner
from presswear.linkage.joints import Guide, Joint, Revolute
from presswear.linkage.load_laws import OverTime
from presswear.linkage.loads import AnyLoad, Force, Load, Moment
from presswear.linkage.part_checks import (
    check_joint_names,
    check_names,
    check_parts,
)
from presswear.linkage.parts import (
    Parts,
    Placing,
    cycle_field,
    gravity_field,
    part_with_names,
    run_up_field,
)
from presswear.linkage.points import GROUND, OutputPoint
from presswear.linkage.spring import AnySpring
from presswear.tools.arguments import checked_arguments
from presswear.tools.errors import InputError
from presswear.tools.serialize import Checked, make, plain

# Parts of a linkage that are tables of a file
_TABLES = ("bodies", "joints", "drives", "springs", "loads")
# Fields that ``released`` sets and ``assemble`` does not take
_RELEASED = "elastic_pins", "elastic_guides", "is_turned_by_motors"


@dataclass(frozen=True)
class Linkage(Checked):
    """Planar mechanism, driven, with or without clearance joints; see ``assemble`` for its parts.

    Its joints are ideal; those with clearance are in ``clearances``. The output point
    is recorded as ``slider``.
    """

    kind: ClassVar[str] = "linkage"
    default_joints: ClassVar[tuple[str, ...]] = ()
    origin: ClassVar[str] = "Dimensions and masses are the user's."

    bodies: tuple[Body, ...]
    joints: tuple[Joint, ...]
    drives: tuple[Drive, ...]
    output: OutputPoint
    guess: tuple[tuple[str, float], ...] = ()
    cycle: float | None = cycle_field()
    run_up: int = run_up_field()
    name: str = "linkage"
    gravity: float = gravity_field()
    springs: tuple[AnySpring, ...] = ()
    loads: tuple[AnyLoad, ...] = ()
    clearances: tuple[ClearanceJoint, ...] = ()
    # pins and guides that stretch; only in a linkage that is ``released``
    elastic_pins: tuple[Revolute, ...] = ()
    elastic_guides: tuple[Guide, ...] = ()
    # motors turn their bodies, so that drives with a motor prescribe nothing
    is_turned_by_motors: bool = False

    def changed(self, **changes: Any) -> "Linkage":
        """Return the linkage assembled again with arguments of ``assemble`` changed."""
        arguments = vars(self) | changes
        released = {name: arguments.pop(name) for name in _RELEASED}
        return replace(assemble(**arguments), **released)

    @property
    def ideal(self) -> "Linkage":
        """The linkage without laws: drives prescribe its motion, its joints are ideal.

        Guides with a spring hold their body at their point. The loads stay. It is the
        reference of a scene, with the period, the start and bottom dead centre.
        """
        pins = (
            Revolute(joint.name, joint.bearing, joint.pin)
            for joint in self.with_closed_guides.clearances
        )
        elastic = {guide.name: guide for guide in self.elastic_guides}
        joints = (elastic.get(joint.name, joint) for joint in self.joints)
        return replace(
            self,
            joints=(*joints, *pins, *self.elastic_pins, *self.loose_guides),
            drives=self.without_motors.drives,
            clearances=(),
            elastic_pins=(),
            elastic_guides=(),
            is_turned_by_motors=False,
        )

    @property
    def corners(self) -> tuple[GuideCorner, ...]:
        """Corners of the slides in guides with clearance."""
        return tuple(
            joint for joint in self.clearances if isinstance(joint, GuideCorner)
        )

    @property
    def _loose_pins(self) -> tuple[ClearanceJoint, ...]:
        """Pin joints with clearance."""
        return tuple(
            joint for joint in self.clearances if not isinstance(joint, GuideCorner)
        )

    @property
    def loose_guides(self) -> tuple[Guide, ...]:
        """Guides with clearance."""
        return tuple(dict.fromkeys(corner.guide for corner in self.corners))

    @property
    def oiled_joints(self) -> tuple[ClearanceJoint, ...]:
        """The joints with clearance in which an oil film acts."""
        return tuple(joint for joint in self.clearances if joint.oil is not None)

    @property
    def without_oil(self) -> "Linkage":
        """The linkage whose joints are dry."""
        clearances = tuple(replace(joint, oil=None) for joint in self.clearances)
        return replace(self, clearances=clearances)

    @property
    def worn_guides(self) -> tuple[Guide, ...]:
        """Guides with clearance, the wear of whose walls is computed."""
        corners = (corner for corner in self.corners if corner.wall is not None)
        return tuple(dict.fromkeys(corner.guide for corner in corners))

    @property
    def with_closed_guides(self) -> "Linkage":
        """The linkage whose guides have no clearance."""
        if not self.corners:
            return self
        joints = (*self.joints, *self.loose_guides)
        return replace(self, joints=joints, clearances=self._loose_pins)

    @property
    def without_motors(self) -> "Linkage":
        """The linkage whose drives all prescribe the motion of their bodies."""
        drives = tuple(replace(drive, motor=None) for drive in self.drives)
        return replace(self, drives=drives, is_turned_by_motors=False)

    @property
    def released(self) -> "Linkage":
        """The linkage for the dynamics, in which joints with a stiffness stretch.

        Elastic pins hold nothing, and guides with a spring only their line and angle.
        Drives with a motor prescribe nothing, and the inertia of the motor turns with
        the body.
        """
        joints: list[Joint] = []
        pins = list(self.elastic_pins)
        guides = list(self.elastic_guides)
        for joint in self.joints:
            if joint.stiffness is None:
                joints.append(joint)
            elif isinstance(joint, Guide):
                guides.append(joint)
                joints.append(replace(joint, stiffness=None))
            else:
                pins.append(joint)
        return replace(
            self,
            bodies=self._bodies_with_rotors,
            joints=tuple(joints),
            elastic_pins=tuple(pins),
            elastic_guides=tuple(guides),
            is_turned_by_motors=self.has_motors,
        )

    @property
    def _bodies_with_rotors(self) -> tuple[Body, ...]:
        """Bodies with the inertia of the motors that turn them."""
        if self.is_turned_by_motors:
            return self.bodies
        bodies = list(self.bodies)
        for drive in self.drives:
            if drive.motor is not None:
                k = self.index(drive.body)
                inertia = bodies[k].inertia + drive.motor.reflected_inertia
                bodies[k] = replace(bodies[k], inertia=inertia)
        return tuple(bodies)

    @property
    def has_motors(self) -> bool:
        """True if a drive has a motor."""
        return any(drive.motor is not None for drive in self.drives)

    @property
    def leader(self) -> Drive | None:
        """First drive with a motor that is no servo; its angle is the clock of the cycles.

        tau = (angle - its start) / nominal speed is the time of the ideal motion at
        which the leader has this angle. Without a leader tau is the time.
        """
        return leader_of(self.drives)

    @property
    def motor_drives(self) -> tuple[Drive, ...]:
        """Drives whose motors turn their bodies."""
        return tuple(drive for drive in self.drives if not self.prescribes(drive))

    @property
    def prescribed_drives(self) -> tuple[Drive, ...]:
        """Drives that prescribe the motion of their bodies."""
        return tuple(drive for drive in self.drives if self.prescribes(drive))

    @property
    def gears(self) -> tuple[GearedDrive, ...]:
        """Drives with a leader."""
        return tuple(drive for drive in self.drives if isinstance(drive, GearedDrive))

    @property
    def free_gears(self) -> tuple[GearedDrive, ...]:
        """Drives whose leaders are turned by motors."""
        motors = {drive.body for drive in self.motor_drives}
        return tuple(gear for gear in self.gears if gear.leader in motors)

    def number_of_drive(self, body: str) -> int:
        """Return the position of the drive of a body in ``drives``."""
        return [drive.body for drive in self.drives].index(body)

    def guide_of(self, drive: LinearDrive) -> Guide:
        """Return the guide along which a drive moves its body."""
        return next(guide for guide in self.guides if guide.name == drive.along)

    def prescribes(self, drive: Drive) -> bool:
        """Return whether a drive prescribes the motion of its body."""
        return drive.motor is None or not self.is_turned_by_motors

    @property
    def elastic_joints(self) -> tuple[Joint, ...]:
        """Pins and guides that stretch in the dynamics."""
        return (*self.elastic_pins, *self.elastic_guides)

    @property
    def revolutes(self) -> tuple[Revolute, ...]:
        """Ideal pin joints."""
        return tuple(joint for joint in self.joints if isinstance(joint, Revolute))

    @property
    def rubbing_pins(self) -> tuple[Revolute, ...]:
        """Ideal pin joints with friction."""
        return tuple(
            joint for joint in self.revolutes if joint.friction.coefficient > 0.0
        )

    @property
    def bushings(self) -> tuple[Bushing, ...]:
        """Pin joints with friction, with and without clearance."""
        pins: tuple[Bushing, ...] = (*self._loose_pins, *self.elastic_pins)
        rubbing = (pin for pin in pins if pin.friction.coefficient > 0.0)
        return (*rubbing, *self.rubbing_pins)

    @property
    def guides(self) -> tuple[Guide, ...]:
        """Guides."""
        return tuple(joint for joint in self.joints if isinstance(joint, Guide))

    @property
    def constant_loads(self) -> tuple[Load, ...]:
        """Constant loads."""
        return tuple(load for load in self.loads if isinstance(load, Load))

    @property
    def loads_with_law(self) -> tuple[Force | Moment, ...]:
        """Loads with a law."""
        return tuple(load for load in self.loads if not isinstance(load, Load))

    @property
    def allowed_joints(self) -> tuple[str, ...]:
        """Names of the joints that may have clearance."""
        joints: tuple[Joint, ...] = (*self.revolutes, *self.guides)
        return tuple(joint.name for joint in joints if joint.stiffness is None)

    def linkage(self) -> "Linkage":
        """Return the linkage itself, as any mechanism returns its linkage."""
        return self

    @property
    def period(self) -> float:
        """Time of one cycle, s: the shortest in which every drive makes whole turns."""
        period = self.cycle
        if period is None:
            period = common_period(self.drives, self.name)
        check_cycle(period, self.drives, self.name)
        return period

    @property
    def phase(self) -> str:
        """Name of the angle that goes through a whole turn in a cycle."""
        one_turn = 2.0 * math.pi / self.period  # speed of a turn in a cycle, rad/s
        for drive in self.drives:
            turns_per_cycle = abs(drive.speed) / one_turn
            if not drive.repeats and abs(turns_per_cycle - 1.0) < 1e-9:
                return "crank angle"
        return "phase of the cycle"

    @property
    def run_up_time(self) -> float:
        """Time in which the linkage runs up from rest, s; with a motor the nominal time."""
        if not self.run_up:
            return 0.0
        duration = self.run_up * self.period
        return duration if self.leader is not None else 2.0 * duration

    def index(self, body: str) -> int:
        """Return the position of a body in ``bodies``."""
        return [element.name for element in self.bodies].index(body)

    def as_plain(self) -> dict[str, Any]:
        """Return the arguments of ``assemble`` as plain data, without clearance joints."""
        named = partial(part_with_names, self.bodies)
        parts = Parts(
            named(self.output),
            self.name,
            self.output.direction,
            dict(self.guess),
            self.cycle,
            self.run_up,
            self.gravity,
            *(tuple(map(named, getattr(self, table))) for table in _TABLES),
        )
        return {"kind": self.kind, **plain(parts)}


@checked_arguments
def assemble(  # noqa: PLR0913 - the tables of a file of a mechanism
    bodies: Sequence[Any],
    joints: Sequence[Any] = (),
    drives: Sequence[Any] = (),
    output: Any = "",
    guess: Mapping[str, Any] | Sequence[tuple[str, Any]] = (),
    cycle: float | str | None = None,
    run_up: int = 0,
    name: str = "linkage",
    gravity: float | str = 9.81,
    springs: Sequence[Any] = (),
    loads: Sequence[Any] = (),
    clearances: Sequence[ClearanceJoint] = (),
    direction: float | str | None = None,
) -> Linkage:
    """Assemble a linkage from bodies, joints and drives, and check it.

    Points are ``body.point``, ``body`` for its mass centre, or coordinates on the
    frame. Every part may be given as plain data, too.

    Parameters
    ----------
    joints : sequence of Pin, Revolute or Guide
    output : str, tuple, Attachment or OutputPoint
        Output point; default: the mass centre of the last body.
    guess : mapping of str to float
        Approximate initial angles, rad, of bodies that are neither driven nor guided.
        They select one of the two assemblies of a loop.
    cycle : float, str or None
        Time after which the motion repeats, s; None: the shortest in which every drive
        makes whole turns.
    run_up : int
        Cycles in which the mechanism runs up from rest, in twice their time; 0: no
        run-up.
    gravity : float or str
        Acceleration along -y, m/s^2.
    loads : sequence of Load, Force or Moment
    direction : float, str or None
        Direction along which the output point is observed, rad; None: along the guide
        of its body, or else x.

    Raises
    ------
    InputError
        Names the body, point, joint or value that does not fit.
    """
    typed_bodies = list(bodies)
    for k, body in enumerate(bodies):
        if isinstance(body, Mapping):
            kind = Bar if "length" in body else Body
            typed_bodies[k] = make(f"bodies[{k}]", kind, body)
    if not typed_bodies:
        raise InputError("bodies: at least one is needed")
    if output is None or (isinstance(output, str) and not output):
        output = getattr(typed_bodies[-1], "name", "")
    tables = typed_bodies, joints, drives, springs, loads
    make_parts: Any = Parts  # Any, because it also takes numbers as texts with units
    parts: Parts = make_parts(
        output, name, direction, dict(guess), cycle, run_up, gravity, *tables
    )
    placing = Placing(parts)
    for body in parts.guess:
        placing.check_body(body, "guess")
    linkage = Linkage(
        bodies=tuple(parts.bodies),
        joints=tuple(map(placing.joint, parts.joints)),
        drives=tuple(map(placing.drive, parts.drives)),
        output=placing.output(parts.output, "output", parts.direction),
        guess=tuple(parts.guess.items()),
        cycle=parts.cycle,
        run_up=parts.run_up,
        name=parts.name,
        gravity=parts.gravity,
        springs=tuple(map(placing.spring, parts.springs)),
        loads=tuple(map(placing.load, parts.loads)),
        clearances=tuple(clearances),
    )
    _check(linkage)
    return linkage


def _check(linkage: Linkage) -> None:
    """Raise InputError where parts do not fit each other."""
    joints = [joint.name for joint in (*linkage.joints, *linkage.clearances)]
    names = {
        "body": [GROUND, *(body.name for body in linkage.bodies)],
        "joint": ["none", *joints],
        "spring": [spring.name for spring in linkage.springs],
        "drive of": [drive.body for drive in linkage.drives],
    }
    check_names(names)
    check_joint_names(joints)
    for load in linkage.loads_with_law:
        if isinstance(load.law, OverTime) and load.law.period is None:
            load.law.check_period("cycle", linkage.period)
    check_parts(linkage.bodies, linkage.joints, linkage.drives, dict(linkage.guess))


def linkage_from(data: Mapping[str, Any], place: str) -> Linkage:
    """Return a linkage from plain data, as of ``as_plain``; messages begin with ``place``."""
    arguments = {key: value for key, value in data.items() if key != "kind"}
    return make(place, assemble, arguments)
