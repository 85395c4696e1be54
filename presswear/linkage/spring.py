"""Springs with dampers between two points of two bodies: the table ``springs`` of a mechanism."""

from dataclasses import dataclass
from typing import Annotated, cast

from presswear.linkage.points import MAX_LENGTH, Attachment, End
from presswear.tools.fields import quantity
from presswear.tools.quantities import Quantity
from presswear.tools.serialize import Checked


@dataclass(frozen=True)
class Spring(Checked):
    """Linear spring and damper between two points, along the line between them.

    With length 0 the spring is -k e, without force where the points meet.
    """

    name: str
    first: End
    second: End
    stiffness: Annotated[float, Quantity("N/m", 0.0, 1e12, "", "stiffness")]
    length: Annotated[float, Quantity("m", 0.0, MAX_LENGTH, "", "length without force")]
    damping: float = quantity(0.0, "N s/m", 0.0, 1e12, "", "damping")

    @property
    def ends(self) -> tuple[Attachment, Attachment]:
        """Both ends, in an assembled linkage."""
        return cast(tuple[Attachment, Attachment], (self.first, self.second))


# Each kind has a name, the points ``first`` and ``second``, and ``ends``. A table of a
# file is of the kind whose fields it has.
AnySpring = Spring
