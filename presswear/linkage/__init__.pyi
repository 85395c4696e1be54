"""Public names of ``presswear.linkage``."""

from presswear.linkage.elements import Attachment as Attachment
from presswear.linkage.elements import ClearanceJoint as ClearanceJoint
from presswear.linkage.elements import OutputPoint as OutputPoint
from presswear.linkage.elements import Revolute as Revolute
from presswear.linkage.elements import WearLaw as WearLaw
from presswear.linkage.laws import FrictionLaw as FrictionLaw
from presswear.linkage.laws import Materials as Materials
from presswear.linkage.laws import NormalLaw as NormalLaw
from presswear.linkage.linkage import Linkage as Linkage
from presswear.linkage.servos import Dwell as Dwell
from presswear.linkage.servos import Forming as Forming
from presswear.linkage.servos import Pendulum as Pendulum
from presswear.linkage.surface import Surface as Surface

__all__: list[str]
