"""Pin joint with clearance."""

import math
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Literal

from presswear.linkage.friction_law import FrictionLaw
from presswear.linkage.joints import Revolute
from presswear.linkage.normal_law import NormalLaw
from presswear.linkage.oil import OILED_WEAR, Oil
from presswear.linkage.points import Attachment
from presswear.linkage.surface import Surface
from presswear.linkage.wear_law import WearLaw
from presswear.tools.serialize import Checked

MapFrame = Literal["fixed", "body"]
SurfaceContact = Literal["radial", "foundation"]

# Greatest depth of a worn surface on a foundation. Pin and bearing are nearly equal
# circles up to this depth.
DEEPEST_CLEARANCES = 10.0  # greatest depth over the clearance
DEEPEST_PART = 0.1  # greatest depth over the radius of the bearing
DEEPEST_WORDS = (
    f"with wear of {DEEPEST_CLEARANCES:g} clearances or {DEEPEST_PART:g} bearing radii"
)


def deepest_wear(
    contact: SurfaceContact, clearance: float, bearing_radius: float
) -> float:
    """Return the depth, m, up to which the model of a worn surface holds.

    With radial contact it is the clearance: steep profiles would create energy.
    """
    if contact == "radial":
        return clearance
    deepest = min(DEEPEST_CLEARANCES * clearance, DEEPEST_PART * bearing_radius)
    return max(clearance, deepest)


@dataclass(frozen=True)
class ClearanceJoint(Checked):
    """Pin joint with clearance: a pin loose in a bearing.

    Attributes
    ----------
    map_frame : {"fixed", "body"}
        "fixed": the bins of the wear maps keep their directions in space. "body": they
        turn with their bodies.
    contact : {"radial", "foundation"}
        "radial": the surfaces meet in one point, in the direction of the eccentricity, by
        the elasticity of the normal law. "foundation": they meet over an arc through an
        elastic foundation, and the elasticity of the normal law is not used.
    """

    name: str
    bearing: Attachment  # centre of the hole
    pin: Attachment
    bearing_radius: float  # R_i, m
    clearance: float  # c = R_i - R_j, m
    width: float  # axial width b, m
    normal: NormalLaw
    friction: FrictionLaw = field(default_factory=FrictionLaw)
    wear: WearLaw | None = None  # None: no wear is computed
    map_frame: MapFrame = "body"
    contact: SurfaceContact = "radial"
    bearing_surface: Surface = field(default_factory=Surface)
    pin_surface: Surface = field(default_factory=Surface)
    oil: Oil | None = None  # None: dry

    @property
    def pin_radius(self) -> float:
        """R_j = R_i - c, m."""
        return self.bearing_radius - self.clearance

    @property
    def deepest_wear(self) -> float:
        """Depth up to which the model of worn surfaces holds, m."""
        if self.oil is not None:
            return OILED_WEAR * self.clearance
        return deepest_wear(self.contact, self.clearance, self.bearing_radius)

    @cached_property
    def round_normal(self) -> NormalLaw:
        """Normal law while both surfaces are round."""
        if self.contact == "foundation":
            return replace(self.normal, elasticity="foundation")
        return self.normal

    @property
    def map_area(self) -> float:
        """Area of the bearing surface, which is covered by the bins of a wear map, m^2."""
        return self.width * self.bearing_radius * 2.0 * math.pi

    @property
    def bins(self) -> int:
        """Number of angular bins of the wear maps.

        Without a wear law it is that of the surfaces, 1 if they are round.
        """
        if self.wear is not None:
            return self.wear.angles
        return max(self.bearing_surface.depth.size, self.pin_surface.depth.size, 1)


Bushing = ClearanceJoint | Revolute
"""Pin joint whose pin may rub in its bearing: with clearance, or rigid with friction."""
