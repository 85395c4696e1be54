"""How far pins conform to their bearings: laws of a small contact have a range, and it is told.

The surfaces overlap by e cos(x) - c at an angle x from the line of centres: over an arc of which
c / (c + penetration) is the cosine of the half.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from presswear.linkage.laws import Elasticity
from presswear.physics.laws import elastic_force, foundation_force, liu_force
from presswear.results.stage import StageResult
from presswear.scene.scene import Scene
from presswear.tools.numbers import readable
from presswear.tools.user_function import UserFunction

SMALL = 0.1
"""Penetration, part of the clearance, up to which a contact is small: there K delta^1.5 is 6 %
above the foundation's force, and the arc 49 degrees."""
_MICRONS = 1e6


@dataclass(frozen=True)
class Conformity:
    """A pin as deep in its bearing as it was in the recorded cycles.

    Attributes
    ----------
    joint : str
    penetration, clearance : float
        m.
    elasticity : {"power", "liu", "foundation"} or None
        Elastic force in use; None: one of its own, or of another exponent than 1.5.
    """

    joint: str
    penetration: float
    clearance: float
    elasticity: Elasticity | None

    @property
    def part(self) -> float:
        """Penetration over the clearance."""
        return self.penetration / self.clearance

    @property
    def arc(self) -> float:
        """Angle over which the surfaces overlap, rad."""
        return 2.0 * math.acos(1.0 / (1.0 + max(self.part, 0.0)))

    @property
    def is_small(self) -> bool:
        """True where all elastic forces are nearly one."""
        return self.part <= SMALL

    @property
    def forces(self) -> tuple[float, float]:
        """Forces of K delta^1.5 and of Liu's law over the foundation's."""
        own = (max(self.part, 0.0), 1.0, 1.5)
        whole = foundation_force(*own, 0.0, 1.0)
        return elastic_force(*own) / whole, liu_force(*own, 0.0, 1.0) / whole

    @property
    def words(self) -> str:
        """What it means for the forces, in a sentence."""
        told = (
            f"joint {self.joint}: the pin sank {readable(_MICRONS * self.penetration)} µm into its "
            f"bearing, {readable(self.part)} of the clearance, so that the surfaces overlap over "
            f"{math.degrees(self.arc):.0f} degrees: no small contact"
        )
        if self.elasticity is None:
            return told
        power, liu = self.forces
        told += (
            f"; there K delta^1.5 pushes with {power:.2f} and Liu's law with {liu:.2f} of the "
            "foundation's force"
        )
        holds = "elasticity = liu or foundation are made for it"
        return f"{told}; {holds}" if self.elasticity == "power" else told


def conformities(scene: Scene, stage: StageResult) -> Iterator[Conformity]:
    """Pins of a stage at their deepest in the recorded cycles, by joints."""
    for name, joint in stage.joints.items():
        bearing = scene.bearing(name)
        law: Elasticity | None = bearing.elasticity
        if isinstance(bearing.normal_law, UserFunction) or bearing.exponent != 1.5:
            law = None
        elif scene.conventions.contact == "foundation" and stage.is_worn:
            law = "foundation"
        deepest = float(np.max(joint.arrays.get("penetration", 0.0), initial=0.0))
        yield Conformity(name, deepest, bearing.clearance, law)


def deep_contacts(scene: Scene, stages: tuple[StageResult, ...]) -> list[str]:
    """Sentences on joints whose pins sink in too deep for a law of a small contact.

    Of each joint the stage in which it is deepest is told.
    """
    deepest: dict[str, Conformity] = {}
    for stage in stages:
        for own in conformities(scene, stage):
            known = deepest.get(own.joint)
            if not own.is_small and (known is None or own.part > known.part):
                deepest[own.joint] = own
    return [own.words for own in deepest.values()]
