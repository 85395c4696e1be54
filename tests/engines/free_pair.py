"""Two free bodies, one with a bearing, the other with a pin in it."""

from presswear.linkage.elements import Attachment, Body, ClearanceJoint, OutputPoint
from presswear.linkage.laws import FrictionLaw, NormalLaw, lankarani_nikravesh_damping
from presswear.linkage.linkage import Linkage, assemble

CLEARANCE = 0.8e-3
FRICTIONLESS = FrictionLaw(0.0)
STIFFNESS = 1.25e10


def free_pair(
    restitution: float = 0.9,
    friction: FrictionLaw = FRICTIONLESS,
    bearing: tuple[float, float] = (0.0, 0.0),
    pin: tuple[float, float] = (0.0, 0.0),
    exponent: float = 1.5,
) -> Linkage:
    """Two free bodies, one with a bearing, the other with a pin in it."""
    joint = ClearanceJoint(
        "J",
        Attachment("ring", *bearing),
        Attachment("shaft", *pin),
        bearing_radius=0.015,
        clearance=CLEARANCE,
        width=0.02,
        normal=NormalLaw(STIFFNESS, exponent, lankarani_nikravesh_damping(restitution)),
        friction=friction,
    )
    return assemble(
        (Body("ring", 0.3, 4e-4), Body("shaft", 0.1, 1e-4)),
        output=OutputPoint("shaft"),
        gravity=0.0,
        clearances=(joint,),
    )
