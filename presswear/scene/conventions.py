"""Conventions of the contact and wear model, and their named sets."""

from dataclasses import dataclass

from presswear.linkage.clearance_joint import MapFrame, SurfaceContact
from presswear.linkage.normal_law import StiffnessReading
from presswear.linkage.wear_law import Slip, WearDistribution, WearMaps
from presswear.tools.fields import choice
from presswear.tools.serialize import Checked


@dataclass(frozen=True)
class Conventions(Checked):
    """Choices of the contact and wear model; each can be set separately."""

    stiffness: StiffnessReading = choice(
        "refined",
        StiffnessReading,
        "K with R_i + R_j as printed, with R_i - R_j, or of conforming pins from the width",
    )
    slip: Slip = choice(
        "sliding",
        Slip,
        "angle: (R_j + delta) abs(d phi), eq. 24; sliding: abs(v_t) dt",
    )
    map_frame: MapFrame = choice(
        "body",
        MapFrame,
        "wear maps fixed in direction, or turning with their bodies",
    )
    wear_distribution: WearDistribution = choice(
        "arc",
        WearDistribution,
        "wear into the bin of the contact, or over its arc",
    )
    contact: SurfaceContact = choice(
        "foundation",
        SurfaceContact,
        "surfaces, new and worn, touch at a point by elasticity, or over an arc by a foundation",
    )
    wear_maps: WearMaps = choice(
        "smoothed",
        WearMaps,
        "wear maps smoothed by their sampling error, or with noise",
    )


CONVENTIONS: dict[str, Conventions] = {
    "refined": Conventions(),
    "paper": Conventions(
        stiffness="paper",
        slip="angle",
        map_frame="fixed",
        wear_distribution="bin",
        contact="radial",
        wear_maps="raw",
    ),
}
