"""Two free bodies that meet in one clearance joint, placed at will."""

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

import presswear as pw
from presswear.linkage.elements import GROUND, MapFrame
from presswear.physics.contact import CONTACT, note_contacts, penetration_acceleration
from presswear.physics.forces import JointLoad, load_of
from presswear.physics.packed import Packed, pack
from presswear.tools.compile import Records

Array = NDArray[np.float64]

JOINT = pw.ClearanceJoint(
    "J",
    bearing=pw.Attachment("bearing", 0.17, -0.03),
    pin=pw.Attachment("pin", -0.11, 0.05),
    bearing_radius=0.015,
    clearance=0.8e-3,
    width=0.02,
    normal=pw.NormalLaw(1.25e10, 1.5, 0.1425),
    friction=pw.FrictionLaw(0.1, 1e-4, 1e-3),
)


def waves(count: int, deepest: float, seed: int) -> pw.Surface:
    """A surface of random depths from zero up."""
    return pw.Surface(np.random.default_rng(seed).uniform(0.0, deepest, count))


def worn_joint(frame: MapFrame, count: int = 24, deepest: float = 1e-4) -> pw.ClearanceJoint:
    """The joint with different wear on bearing and pin."""
    return replace(
        JOINT,
        map_frame=frame,
        bearing_surface=waves(count, deepest, 1),
        pin_surface=waves(count, deepest, 2),
    )


def joint_contact(packed: Packed, q: Array, v: Array) -> Records:
    """Contact of the one joint in a state of the linkage."""
    contacts = np.zeros(1, CONTACT)
    note_contacts(packed, contacts, q, v)
    return contacts.view(np.recarray)[0]


def joint_load(packed: Packed, onset: float, q: Array, v: Array) -> JointLoad:
    """Forces of the one joint in a state of the linkage, for a closing speed at touchdown."""
    return load_of(packed.joints[0], onset, joint_contact(packed, q, v))


@dataclass(frozen=True)
class Pair:
    """A state of the two bodies: coordinates and rates, each (6,), bearing body first."""

    joint: pw.ClearanceJoint
    q: Array
    v: Array

    @property
    def linkage(self) -> pw.Linkage:
        """The two bodies, or the pin's alone when the frame holds the bearing."""
        names = ("pin",) if self.joint.bearing.body == GROUND else ("bearing", "pin")
        bodies = tuple(pw.Body(name, 0.1, 1e-3) for name in names)
        return pw.assemble(
            bodies, output=pw.OutputPoint("pin"), gravity=0.0, clearances=(self.joint,)
        )

    @property
    def packed(self) -> Packed:
        """The linkage as the kernels see it."""
        return pack(self.linkage)

    @property
    def surfaces(self) -> Array:
        """Rows of both surfaces, a column for each bin."""
        return self.packed.surfaces[0, :, : self.packed.joints[0]["surface_bins"]]

    def contact(self) -> Records:
        """Contact without its forces."""
        return joint_contact(self.packed, self.q, self.v)

    def penetration_acceleration(self, a: Array) -> float:
        """Second time derivative of the penetration, m/s^2, at given accelerations."""
        packed = self.packed
        return penetration_acceleration(packed.joints[0], self.surfaces, self.contact(), a)

    def load(self, onset: float) -> JointLoad:
        """Forces, for a closing speed at first touch."""
        return joint_load(self.packed, onset, self.q, self.v)

    def moment_of(self, load: JointLoad) -> float:
        """Sum of all moments about the origin, N m, that forces put on the two bodies."""
        q = self.q
        of_forces = (q[3] - q[0]) * load.y - (q[4] - q[1]) * load.x
        return float(of_forces + load.pin_moment + load.bearing_moment)

    def after(self, time: float, acceleration: Array | None = None) -> "Pair":
        """The state a time later at constant acceleration."""
        a = np.zeros(6) if acceleration is None else acceleration
        return replace(
            self, q=self.q + time * self.v + 0.5 * time**2 * a, v=self.v + time * np.asarray(a)
        )


def turned(angle: float, x: float, y: float) -> Array:
    """A vector turned by an angle."""
    c, s = math.cos(angle), math.sin(angle)
    return np.array([c * x - s * y, s * x + c * y])


def gap_of(
    joint: pw.ClearanceJoint, direction: float, bearing_angle: float, pin_angle: float
) -> float:
    """Clearance plus both depths in a direction, m."""
    turns = float(joint.map_frame == "body")
    own = np.array([direction - turns * bearing_angle])
    other = np.array([direction - turns * pin_angle])
    return float(joint.clearance + joint.bearing_surface(own)[0] + joint.pin_surface(other)[0])


def placed(
    joint: pw.ClearanceJoint,
    penetration: float,
    direction: float,
    *,
    angles: tuple[float, float] = (0.4, -2.1),
    place: tuple[float, float] = (0.3, -0.2),
    rates: Array | None = None,
) -> Pair:
    """Bodies at given angles with the pin at a given penetration in a given direction."""
    reach = gap_of(joint, direction, *angles) + penetration
    centre = np.array(place) + turned(angles[0], joint.bearing.x, joint.bearing.y)
    centre = centre + reach * np.array([math.cos(direction), math.sin(direction)])
    pin = centre - turned(angles[1], joint.pin.x, joint.pin.y)
    q = np.array([*place, angles[0], *pin, angles[1]])
    return Pair(joint, q, np.zeros(6) if rates is None else rates)
