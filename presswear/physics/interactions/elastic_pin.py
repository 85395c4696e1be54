"""Pins that stretch: a linear spring and damper between the centres of bearing and pin."""

import math
from dataclasses import dataclass
from typing import ClassVar, Self

from presswear.linkage.elements import Revolute
from presswear.linkage.linkage import Linkage, place_of
from presswear.physics.equations.text import ONE, negative, product
from presswear.physics.interactions.page import Kernels, Page
from presswear.physics.packed import Packed, effective_mass
from presswear.tools.arrays import Array


@dataclass(frozen=True)
class ElasticPin:
    """An elastic pin, as text: F = -k e - D e' on the pin, with e from bearing to pin."""

    pin: Revolute
    damping: float  # D, N s/m

    kernels: ClassVar[Kernels] = ()

    @classmethod
    def all_of(cls, linkage: Linkage, packed: Packed) -> list[Self]:
        """Return all elastic pins of a linkage."""
        return [cls(pin, damping_of(linkage, pin)) for pin in linkage.elastic_pins]

    @property
    def bodies(self) -> tuple[str, ...]:
        """Bodies of bearing and pin."""
        return self.pin.first.body, self.pin.second.body

    @classmethod
    def stored_energy(cls, linkage: Linkage, position: Array) -> float:
        """Return the elastic energy of all elastic pins, J."""
        energy = 0.0
        for pin in linkage.elastic_pins:
            assert pin.stiffness is not None
            bearing, centre = (
                place_of(linkage, end, position.tolist()) for end in pin.ends
            )
            stretch = math.dist(bearing, centre)
            energy += 0.5 * pin.stiffness * stretch * stretch
        return energy

    def write(self, page: Page) -> None:
        """Write the forces on both bodies, at the middle of e, and the power of the damper."""
        text, pin = page.text, self.pin
        prefix = text.prefix(pin.name)
        bearing, body = (page.chain.of(end.body) for end in pin.ends)
        text.comment(
            f"{pin.name}: elastic pin of {pin.second.body} in {pin.first.body}"
        )
        stretch, rate = page.chain.way(text, pin.ends, prefix)
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
            page.add_power("load_work", negative(product(damping, rate.dot(rate))))


def damping_of(linkage: Linkage, pin: Revolute) -> float:
    """Return D = 2 zeta sqrt(k m) of an elastic pin, N s/m, with the mass that meets in it."""
    assert pin.stiffness is not None
    mass = effective_mass(linkage, pin.ends)
    if math.isinf(mass):
        return 0.0
    return 2.0 * pin.damping_ratio * math.sqrt(pin.stiffness * mass)
