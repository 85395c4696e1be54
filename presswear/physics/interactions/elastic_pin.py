"""Pins that stretch: a linear spring and damper between the centres of bearing and pin.

Friction of the bearing is a moment r F_t(r omega, F) of the pin force F, with the radius
r of the bearing, as in rigid joints.
"""

import math
from dataclasses import dataclass
from typing import ClassVar, Self

from presswear.linkage.joints import Revolute
from presswear.linkage.linkage import Linkage
from presswear.linkage.point_position import point_position
from presswear.physics.equations.text import (
    ONE,
    Vector,
    difference,
    negative,
    product,
    total,
)
from presswear.physics.friction_and_normal import friction_record
from presswear.physics.interactions.friction import FrictionWithoutState
from presswear.physics.interactions.page import Kernels, Page
from presswear.physics.packed import Packed, effective_mass
from presswear.tools.arrays import Array


@dataclass(frozen=True)
class ElasticPin:
    """An elastic pin, as text: F = -k e - D e' on the pin, with e from bearing to pin."""

    pin: Revolute
    damping: float  # D, N s/m

    kernels: ClassVar[Kernels] = FrictionWithoutState.kernels

    @classmethod
    def all_of(cls, linkage: Linkage, packed: Packed) -> list[Self]:
        """Return all elastic pins of a linkage."""
        return [cls(pin, damping_of(linkage, pin)) for pin in _plain_pins(linkage)]

    @property
    def bodies(self) -> tuple[str, ...]:
        """Bodies of bearing and pin."""
        return self.pin.first.body, self.pin.second.body

    @classmethod
    def stored_energy(cls, linkage: Linkage, position: Array) -> float:
        """Return the elastic energy of all elastic pins, J."""
        energy = 0.0
        for pin in _plain_pins(linkage):
            assert pin.stiffness is not None
            bearing, centre = (
                point_position(linkage, end, position.tolist()) for end in pin.ends
            )
            stretch = math.dist(bearing, centre)
            energy += 0.5 * pin.stiffness * stretch * stretch
        return energy

    def write(self, page: Page) -> None:
        """Write the forces on both bodies, at the middle of e, and the power of the damper."""
        text = page.text
        pin = self.pin
        prefix = text.prefix(pin.name)
        bearing, body = (page.chain.of(end.body) for end in pin.ends)
        text.comment(
            f"{pin.name}: elastic pin of {pin.second.body} in {pin.first.body}"
        )
        stretch, rate = page.chain.relative_motion(text, pin.ends, prefix)
        stiffness = text.parameter(f"{prefix}_stiffness", pin.stiffness or 0.0)
        damping = text.parameter(f"{prefix}_damping", self.damping)
        force = stretch.times(f"-{stiffness}").plus(
            rate.times(damping).times(f"-{ONE}")
        )
        force = text.let_vector(f"{prefix}_force", force)
        half = text.let_vector(f"{prefix}_half", stretch.times("0.5"))
        body.add_force(body.arm(text, pin.second, prefix).minus(half), force)
        bearing.add_force(
            bearing.arm(text, pin.first, prefix).plus(half), force.times(f"-{ONE}")
        )
        if self.damping != 0.0:
            # Both forces act at the middle of e, where the bodies' relative velocity is
            # e' less its part by their mean rotation.
            spin = text.let(
                f"{prefix}_mean_spin", product("0.5", total(bearing.omega, body.omega))
            )
            velocity = rate.minus(stretch.rotated_at(spin))
            velocity = text.let_vector(f"{prefix}_velocity_at_middle", velocity)
            page.add_power("load_work", negative(product(damping, rate.dot(velocity))))
        if pin.friction.coefficient > 0.0:
            self._write_friction(page, prefix, force)

    def _write_friction(self, page: Page, prefix: str, force: Vector) -> None:
        """Write the friction moments on both bodies, and the power that they lose."""
        text = page.text
        pin = self.pin
        bearing, body = (page.chain.of(end.body) for end in pin.ends)
        radius = text.parameter(f"{prefix}_bearing_radius", pin.bearing_radius)
        size = text.let(f"{prefix}_force_size", f"math.sqrt({force.dot(force)})")
        spin = difference(body.omega, bearing.omega)
        sliding = text.let(f"{prefix}_sliding", product(radius, spin))
        record = friction_record(pin.friction)
        law = FrictionWithoutState(page, prefix, pin.friction, record)
        law.write_state(sliding, ONE)
        friction = text.let(f"{prefix}_friction_force", law.force(size))
        moment = text.let(f"{prefix}_friction_moment", product(radius, friction))
        body.moments.append(moment)
        bearing.moments.append(negative(moment))
        page.add_power("friction_loss", negative(product(friction, sliding)))


# Kinds of pins that stretch, see ``linkage.joints.AnyPin``
ELASTIC_PIN_KINDS = (ElasticPin,)


def _plain_pins(linkage: Linkage) -> list[Revolute]:
    """Return the elastic pins of no further kind."""
    return [pin for pin in linkage.elastic_pins if type(pin) is Revolute]


def damping_of(linkage: Linkage, pin: Revolute) -> float:
    """Return D = 2 zeta sqrt(k m) of an elastic pin, N s/m, with the mass that meets in it."""
    assert pin.stiffness is not None
    mass = effective_mass(linkage, pin.ends)
    if math.isinf(mass):
        return 0.0
    return 2.0 * pin.damping_ratio * math.sqrt(pin.stiffness * mass)
