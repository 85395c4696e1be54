"""All kinds of interactions. The writer of equations walks them and knows no kind by name."""

from presswear.linkage.linkage import Linkage
from presswear.physics.interactions.clearance import ClearanceContact
from presswear.physics.interactions.corner import CornerContact
from presswear.physics.interactions.elastic_guide import ElasticGuide
from presswear.physics.interactions.elastic_pin import ElasticPin
from presswear.physics.interactions.load import LoadWithLaw
from presswear.physics.interactions.motor import MotorTorque
from presswear.physics.interactions.oil import OiledContact
from presswear.physics.interactions.page import Interaction
from presswear.physics.interactions.spring import SpringAndDamper
from presswear.physics.packed import Packed

KINDS: tuple[type[Interaction], ...] = (
    SpringAndDamper,
    ElasticPin,
    ElasticGuide,
    LoadWithLaw,
    MotorTorque,
    ClearanceContact,
    CornerContact,
    OiledContact,
)


def interactions_of(linkage: Linkage, packed: Packed) -> list[Interaction]:
    """Return all that acts on the bodies of a linkage, in the order in which it is written."""
    return [one for kind in KINDS for one in kind.all_of(linkage, packed)]
