"""Public names of ``presswear.linkage``."""

from presswear.linkage.clearance_joint import ClearanceJoint as ClearanceJoint
from presswear.linkage.friction_law import FrictionLaw as FrictionLaw
from presswear.linkage.joints import Revolute as Revolute
from presswear.linkage.linkage import Linkage as Linkage
from presswear.linkage.materials import Materials as Materials
from presswear.linkage.normal_law import NormalLaw as NormalLaw
from presswear.linkage.points import Attachment as Attachment
from presswear.linkage.points import OutputPoint as OutputPoint
from presswear.linkage.servos import Dwell as Dwell
from presswear.linkage.servos import Forming as Forming
from presswear.linkage.servos import Pendulum as Pendulum
from presswear.linkage.surface import Surface as Surface
from presswear.linkage.wear_law import WearLaw as WearLaw

__all__: list[str]
