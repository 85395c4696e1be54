"""Conventions of the contact and wear model, and their named sets."""

from dataclasses import dataclass

from presswear.linkage import elements, laws
from presswear.tools.fields import choice
from presswear.tools.serialize import Checked


@dataclass(frozen=True)
class Conventions(Checked):
    """Choices of the contact and wear model; each can be set separately."""

    stiffness: laws.StiffnessReading = choice(
        "refined", laws.StiffnessReading, "K with R_i + R_j as printed, or R_i - R_j"
    )
    slip: elements.Slip = choice(
        "sliding",
        elements.Slip,
        "angle: (R_j + delta) abs(d phi), eq. 24; sliding: abs(v_t) dt",
    )
    map_frame: elements.MapFrame = choice(
        "body",
        elements.MapFrame,
        "wear maps fixed in direction, or turning with their bodies",
    )
    wear_distribution: elements.WearDistribution = choice(
        "arc",
        elements.WearDistribution,
        "wear into the bin of the contact, or over its arc",
    )
    contact: elements.SurfaceContact = choice(
        "foundation",
        elements.SurfaceContact,
        "surfaces, new and worn, touch at a point by elasticity, or over an arc by a foundation",
    )
    wear_maps: elements.WearMaps = choice(
        "smoothed",
        elements.WearMaps,
        "wear maps smoothed by their sampling error, or with noise",
    )


CONVENTIONS: dict[str, Conventions] = {
    "refined": Conventions(),
    "paper": Conventions("paper", "angle", "fixed", "bin", "radial", "raw"),
}
