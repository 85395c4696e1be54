"""Oil and asperities of a lubricated pin joint, and limits of the oil film."""

from dataclasses import dataclass

# Width of a bearing over its diameter for which the formulas of the oil film hold
MIN_FILM_WIDTH = 0.125
MAX_FILM_WIDTH = 1.0
OILED_CLEARANCE = 5e-3  # greatest clearance over radius of an oiled joint
# Wear over the clearance up to which the film has the shape of new surfaces
OILED_WEAR = 0.2
# Source of the damping of contact under a film
OILED_DAMPING = "Antypov and Elliott (2011)"


@dataclass(frozen=True)
class Oil:
    """Oil and asperities of a joint whose film acts in the run."""

    viscosity: float  # Pa s
    roughness: float  # sigma of both surfaces together, m
    asperity_pressure: float  # Pa
    films: int = 1  # equal ones side by side, which divide the width
    damping_ratio: float = 0.0  # zeta of the elastic contact
