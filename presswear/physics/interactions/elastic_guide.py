"""Guides with a spring and a damper along their line, such as an elastic frame."""

import math
from dataclasses import dataclass
from typing import ClassVar, Self

from presswear.linkage.joints import Guide, ends_of
from presswear.linkage.linkage import Linkage
from presswear.linkage.points import GROUND
from presswear.linkage.topology import bodies_of
from presswear.physics.equations.text import Vector, difference, negative, product
from presswear.physics.interactions.page import Kernels, Page
from presswear.physics.packed import Packed
from presswear.tools.arrays import Array


@dataclass(frozen=True)
class ElasticGuide:
    """Spring and damper along a guide, which write themselves into the equations.

    The force is F = -k z - D z', where z is the distance from the point of the guide.
    """

    guide: Guide
    damping: float  # D, N s/m

    kernels: ClassVar[Kernels] = ()

    @classmethod
    def all_of(cls, linkage: Linkage, packed: Packed) -> list[Self]:
        """Return all guides with a spring of a linkage."""
        return [
            cls(guide, damping_of(linkage, guide)) for guide in linkage.elastic_guides
        ]

    @property
    def bodies(self) -> tuple[str, ...]:
        """The frame and the sliding body."""
        return GROUND, self.guide.body

    @classmethod
    def stored_energy(cls, linkage: Linkage, position: Array) -> float:
        """Return the elastic energy of all guides with a spring, J."""
        energy = 0.0
        for guide in linkage.elastic_guides:
            assert guide.stiffness is not None
            stretch = stretch_of(linkage, guide, position)
            energy += 0.5 * guide.stiffness * stretch * stretch
        return energy

    def write(self, page: Page) -> None:
        """Write the force on the body, at its mass centre, and the power of the damper."""
        text = page.text
        guide = self.guide
        prefix = text.prefix(f"spring of {guide.name}")
        body = page.chain.of(guide.body)
        text.comment(f"{guide.name}: spring along the guide of {guide.body}")
        direction = Vector(
            text.direction(f"{prefix}_direction_x", math.cos(guide.direction)),
            text.direction(f"{prefix}_direction_y", math.sin(guide.direction)),
        )
        point = Vector(
            text.parameter(f"{prefix}_x", guide.x),
            text.parameter(f"{prefix}_y", guide.y),
        )
        stretch = direction.dot(body.position.minus(point))
        stretch = text.let(f"{prefix}_stretch", stretch)
        rate = text.let(f"{prefix}_rate", direction.dot(body.velocity))
        stiffness = text.parameter(f"{prefix}_stiffness", guide.stiffness or 0.0)
        damping = text.parameter(f"{prefix}_damping", self.damping)
        elastic = negative(product(stiffness, stretch))
        size = difference(elastic, product(damping, rate))
        size = text.let(f"{prefix}_size", size)
        force = text.let_vector(f"{prefix}_force", direction.times(size))
        body.add_force(Vector(), force)
        if self.damping != 0.0:
            page.add_power("load_work", negative(product(damping, rate, rate)))


def stretch_of(linkage: Linkage, guide: Guide, position: Array) -> float:
    """Return the distance of a mass centre from the point of its guide, along the guide, m."""
    point, _ = ends_of(guide)
    i = 3 * linkage.index(guide.body)
    dx = position[i] - point.x
    dy = position[i + 1] - point.y
    return float(math.cos(guide.direction) * dx + math.sin(guide.direction) * dy)


def damping_of(linkage: Linkage, guide: Guide) -> float:
    """Return D = 2 zeta sqrt(k m) of a guide with a spring, N s/m; m is the carried mass."""
    assert guide.stiffness is not None
    mass = carried_mass(linkage, guide.body)
    return 2.0 * guide.damping * math.sqrt(guide.stiffness * mass)


def period_on(linkage: Linkage, guide: Guide) -> float:
    """Return the period of the carried mass on the spring of a guide, s: 2 pi sqrt(m / k)."""
    assert guide.stiffness is not None
    mass = carried_mass(linkage, guide.body)
    return 2.0 * math.pi * math.sqrt(mass / guide.stiffness)


def carried_mass(linkage: Linkage, body: str) -> float:
    """Return the mass of a body with all bodies that joints connect with it, kg."""
    pairs = [bodies_of(joint) for joint in (*linkage.joints, *linkage.elastic_pins)]
    for joint in linkage.clearances:
        pairs.append({joint.bearing.body, joint.pin.body} - {GROUND})
    carried = {body}
    count = 0
    while count < len(carried):
        count = len(carried)
        for pair in pairs:
            if pair & carried:
                carried |= pair
    return sum(link.mass for link in linkage.bodies if link.name in carried)
