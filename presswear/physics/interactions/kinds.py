"""All kinds of interactions, for the writer of the equations."""

from presswear.linkage.linkage import Linkage
from presswear.physics.interactions.clearance import ClearanceContact
from presswear.physics.interactions.corner import CornerContact
from presswear.physics.interactions.elastic_guide import ElasticGuide
from presswear.physics.interactions.elastic_pin import ELASTIC_PIN_KINDS
from presswear.physics.interactions.load import LoadWithLaw
from presswear.physics.interactions.motor import MotorTorque
from presswear.physics.interactions.oil import OiledContact
from presswear.physics.interactions.page import Interaction
from presswear.physics.interactions.spring import SPRING_KINDS
from presswear.physics.packed import Packed

KINDS: tuple[type[Interaction], ...] = (
    *SPRING_KINDS,
    *ELASTIC_PIN_KINDS,
    ElasticGuide,
    LoadWithLaw,
    MotorTorque,
    ClearanceContact,
    CornerContact,
    OiledContact,
)


def interactions_of(linkage: Linkage, packed: Packed) -> list[Interaction]:
    """Return all interactions of a linkage, in the order in which they are written."""
    interactions = list[Interaction]()
    for kind in KINDS:
        interactions += kind.all_of(linkage, packed)
    return interactions
