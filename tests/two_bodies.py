"""Two free bodies that meet in one clearance joint, in any position."""

import math
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

import presswear as pw
from presswear.linkage.clearance_joint import MapFrame
from presswear.linkage.points import GROUND
from presswear.physics.contact import penetration_acceleration
from presswear.physics.equations.body_forces import BodyForces
from presswear.physics.friction_and_normal import (
    elastic_of,
    normal_force,
    normal_record,
)
from presswear.physics.packed import Packed, pack
from presswear.tools.arrays import Array
from presswear.tools.compile import Records

JOINT = pw.linkage.ClearanceJoint(
    "J",
    bearing=pw.linkage.Attachment("bearing", 0.17, -0.03),
    pin=pw.linkage.Attachment("pin", -0.11, 0.05),
    bearing_radius=0.015,
    clearance=0.8e-3,
    width=0.02,
    normal=pw.linkage.NormalLaw(1.25e10, 1.5, 0.1425),
    friction=pw.linkage.FrictionLaw(0.1, 1e-4, 1e-3),
)


def normal_law(stiffness: float, exponent: float, damping: float) -> Records:
    """Return K delta^n with a damping factor, as a record of NORMAL."""
    return normal_record(pw.linkage.NormalLaw(stiffness, exponent, damping), 1e-3)


def force_of(
    law: Records, penetration: float, rate: float, onset_speed: float
) -> float:
    """Return the normal force, N, as the kernels put it together."""
    elastic, _ = elastic_of(law, penetration)
    return float(normal_force(law, elastic, penetration, rate, onset_speed))


def worn_joint(
    frame: MapFrame, count: int = 24, deepest: float = 1e-4
) -> pw.linkage.ClearanceJoint:
    """Return the joint with random depths from zero up, other ones on bearing and pin."""
    bearing, pin = (
        pw.linkage.Surface(np.random.default_rng(seed).uniform(0.0, deepest, count))
        for seed in (1, 2)
    )
    return replace(JOINT, map_frame=frame, bearing_surface=bearing, pin_surface=pin)


class JointLoad(NamedTuple):
    """Magnitudes, N, force on the pin, N, and moments about the mass centres, N m."""

    normal: float
    tangential: float
    x: float
    y: float
    pin_moment: float
    bearing_moment: float


def contacts_in(
    linkage: pw.linkage.Linkage, packed: Packed, q: Array, v: Array
) -> Records:
    """Return the contacts of all joints in a state."""
    forces = BodyForces(linkage, packed)
    forces(0.0, q, v)
    return forces.contacts.view(np.recarray)


@dataclass(frozen=True)
class Pair:
    """A state of the two bodies: coordinates and rates, each (6,), bearing body first."""

    joint: pw.linkage.ClearanceJoint
    q: Array
    v: Array

    @property
    def linkage(self) -> pw.linkage.Linkage:
        """Both bodies, or the body of the pin alone if the frame holds the bearing."""
        names = ("pin",) if self.joint.bearing.body == GROUND else ("bearing", "pin")
        bodies = tuple(pw.Body(name, 0.1, 1e-3) for name in names)
        output = pw.linkage.OutputPoint("pin")
        return pw.assemble(bodies, output=output, gravity=0.0, clearances=(self.joint,))

    @property
    def packed(self) -> Packed:
        return pack(self.linkage)

    @property
    def surfaces(self) -> Array:
        """Rows of both surfaces."""
        return self.packed.surfaces[0]

    def contact(self) -> Records:
        return contacts_in(self.linkage, self.packed, self.q, self.v)[0]

    def penetration_acceleration(self, a: Array) -> float:
        """Return the second time derivative of the penetration, m/s^2."""
        return penetration_acceleration(
            self.packed.joints[0], self.surfaces, self.contact(), a
        )

    def load(self, onset: float) -> JointLoad:
        """Return the forces of the joint, for a closing speed at touchdown."""
        forces = BodyForces(self.linkage, self.packed, np.array([onset]))
        force = np.concatenate([np.zeros(3), forces(0.0, self.q, self.v)])[-6:]
        contact = forces.contacts[0]
        x, y, pin_moment = force[3:]
        return JointLoad(
            contact["normal"], contact["tangential"], x, y, pin_moment, force[2]
        )

    def wear_rates(self) -> tuple[float, float]:
        """Return the rates of both wear integrals, F_n ds/dt, W, and p ds/dt, W/m^2.

        The closing speed at touchdown is so high that damping adds nothing.
        """
        forces = BodyForces(self.linkage, self.packed, np.array([1e9]))
        forces(0.0, self.q, self.v)
        work, pressure = forces.wear_rates[0]
        return float(work), float(pressure)

    def after(self, time: float, acceleration: Array | None = None) -> "Pair":
        """Return the state a time later at constant acceleration."""
        a = np.zeros(6) if acceleration is None else acceleration
        return replace(
            self, q=self.q + time * self.v + 0.5 * time**2 * a, v=self.v + time * a
        )


def turned(angle: float, x: float, y: float) -> Array:
    c = math.cos(angle)
    s = math.sin(angle)
    return np.array([c * x - s * y, s * x + c * y])


def gap_of(
    joint: pw.linkage.ClearanceJoint,
    direction: float,
    bearing_angle: float,
    pin_angle: float,
) -> float:
    """Return the clearance plus both depths in a direction, m."""
    turns = float(joint.map_frame == "body")
    bearing, pin = direction - turns * np.array([[bearing_angle], [pin_angle]])
    return float(
        joint.clearance + joint.bearing_surface(bearing)[0] + joint.pin_surface(pin)[0]
    )


def placed(
    joint: pw.linkage.ClearanceJoint,
    penetration: float,
    direction: float,
    *,
    angles: tuple[float, float] = (0.4, -2.1),
    place: tuple[float, float] = (0.3, -0.2),
    rates: Array | None = None,
) -> Pair:
    """Return the bodies with the pin at a penetration, m, in a direction."""
    reach = gap_of(joint, direction, *angles) + penetration
    centre = np.array(place) + turned(angles[0], joint.bearing.x, joint.bearing.y)
    centre = centre + reach * np.array([math.cos(direction), math.sin(direction)])
    pin = centre - turned(angles[1], joint.pin.x, joint.pin.y)
    q = np.array([*place, angles[0], *pin, angles[1]])
    return Pair(joint, q, np.zeros(6) if rates is None else rates)
