"""Numbers that the paper prints in sections 5.3 and 5.4, with their places in the text.

Misprints are kept and described. The units are SI and rad.
"""

from dataclasses import dataclass
from math import radians

from presswear.paper.settings import FAST, FRICTION, HIGH_FRICTION, SLOW, WEAR

NAMED_TWICE_541 = "Fig. 18b shows joint C; the text names joint A a second time"
NAMED_TWICE_543 = "Fig. 24b shows joint C; the text names joint A, Fig. 24a, a second time"
SAME_START = (
    "the same 206.9 N is printed for both joints without wear, so that one of the two is "
    "probably a copy of the other"
)
FIGURE_19_FOR_20 = "the text announces this figure as Fig. 19; Fig. 19 is in section 5.4.1"
NOT_ACCELERATION = (
    'the text says "peak value of acceleration of slider" of a force in N; '
    "the text announces this figure as Fig. 20; Fig. 20 shows the slider"
)
LOST_FACTOR = (
    "below the depth at C, while the text says that A wears more: the power of ten is probably 10⁻⁵"
)


@dataclass(frozen=True)
class Place:
    """Stage of a setting, and a joint in it or the slider, to which a quantity belongs."""

    setting: str  # key of SETTINGS
    wear_updates: int  # before the stage; for wear depths, those that are added up
    joint: str = ""  # empty for the slider


@dataclass(frozen=True)
class Printed:
    """Printed number."""

    section: str
    figure: str
    place: Place
    quantity: str  # key of `evidence.QUANTITIES`
    value: float  # SI units, rad
    misprint: str = ""  # errors of the print, separated by semicolons

    @property
    def places(self) -> tuple[Place, ...]:
        """Places to compare with: section 5.4.2 does not say before or after which wear."""
        if self.section != "5.4.2":
            return (self.place,)
        return tuple(Place(self.place.setting, k, self.place.joint) for k in (0, 1))


# Section 5.3: figure, setting, wear updates, joint, deepest wear (m), its angle (degrees)
_DEPTHS = (
    ("5.3.1", "8a", WEAR, 1, "A", 1.221e-6, 100.7, LOST_FACTOR),
    ("5.3.1", "8a", WEAR, 2, "A", 1.178e-3, 132.7, ""),
    ("5.3.1", "8b", WEAR, 1, "C", 2.044e-6, 225.1, ""),
    ("5.3.1", "8b", WEAR, 2, "C", 4.548e-6, 297.4, ""),
    ("5.3.2", "11a", FRICTION, 1, "A", 4.406e-5, 84.52, ""),
    ("5.3.2", "11a", HIGH_FRICTION, 1, "A", 2.468e-5, 86.31, ""),
    ("5.3.2", "11b", FRICTION, 1, "C", 9.531e-6, 122.6, ""),
    ("5.3.2", "11b", HIGH_FRICTION, 1, "C", 7.559e-6, 115.4, ""),
    ("5.3.3", "14a", SLOW, 1, "A", 1.414e-6, 95.76, LOST_FACTOR),
    ("5.3.3", "14a", FAST, 1, "A", 5.502e-5, 65.52, ""),
    ("5.3.3", "14b", SLOW, 1, "C", 2.835e-6, 310.3, ""),
    ("5.3.3", "14b", FAST, 1, "C", 2.117e-5, 312.8, ""),
)

# Section 5.4: peaks of a stage and of those that follow
_PEAKS = (
    ("5.4.1", "17a", WEAR, 1, "", "displacement", (0.1076, 0.1079), ""),
    ("5.4.1", "17b", WEAR, 0, "", "velocity", (0.9925, 1.005, 1.106), ""),
    ("5.4.1", "17c", WEAR, 0, "", "acceleration", (1221.0, 1523.0, 3629.0), ""),
    ("5.4.1", "18a", WEAR, 0, "A", "force", (206.9,), SAME_START),
    ("5.4.1", "18a", WEAR, 1, "A", "force", (406.7, 2847.0), ""),
    ("5.4.1", "18b", WEAR, 0, "C", "force", (206.9,), f"{NAMED_TWICE_541}; {SAME_START}"),
    ("5.4.1", "18b", WEAR, 1, "C", "force", (310.3, 1176.0), NAMED_TWICE_541),
    ("5.4.2", "20c", FRICTION, 0, "", "acceleration", (4671.0,), FIGURE_19_FOR_20),
    ("5.4.2", "20c", HIGH_FRICTION, 0, "", "acceleration", (1244.0,), FIGURE_19_FOR_20),
    ("5.4.2", "21a", FRICTION, 0, "A", "force", (2363.0,), NOT_ACCELERATION),
    ("5.4.2", "21a", HIGH_FRICTION, 0, "A", "force", (448.5,), NOT_ACCELERATION),
    ("5.4.2", "21b", FRICTION, 0, "C", "force", (650.3,), NOT_ACCELERATION),
    ("5.4.2", "21b", HIGH_FRICTION, 0, "C", "force", (258.8,), NOT_ACCELERATION),
    ("5.4.3", "23c", SLOW, 0, "", "acceleration", (1789.0, 2378.0), ""),
    ("5.4.3", "23c", FAST, 0, "", "acceleration", (2877.0, 5391.0), ""),
    ("5.4.3", "24a", SLOW, 0, "A", "force", (366.8, 420.6), ""),
    ("5.4.3", "24a", FAST, 0, "A", "force", (574.6, 1278.0), ""),
    ("5.4.3", "24b", SLOW, 0, "C", "force", (321.2, 466.2), NAMED_TWICE_543),
    ("5.4.3", "24b", FAST, 0, "C", "force", (424.0, 1957.0), NAMED_TWICE_543),
)

PRINTED: tuple[Printed, ...] = (
    *(
        Printed(section, figure, Place(setting, wear_updates, joint), *number)
        for section, figure, setting, wear_updates, joint, depth, angle, misprint in _DEPTHS
        for number in (("depth", depth, misprint), ("angle", radians(angle)))
    ),
    *(
        Printed(section, figure, Place(setting, wear_updates, joint), quantity, value, misprint)
        for section, figure, setting, first, joint, quantity, values, misprint in _PEAKS
        for wear_updates, value in enumerate(values, first)
    ),
)

# places whose printed depth has probably lost a power of ten
DOUBTFUL = frozenset(number.place for number in PRINTED if number.misprint == LOST_FACTOR)


# Section 5.3.2, both friction coefficients: figure, joint, arcs in which it is mainly worn (rad)
RANGES = (
    ("11a", "A", ((radians(71.0), radians(90.0)),)),
    ("11b", "C", ((radians(102.0), radians(187.0)), (radians(246.7), radians(360.0)))),
)


def printed_at(place: Place, quantity: str) -> Printed | None:
    """Return the printed number of a quantity at a place; None if none is printed."""
    numbers = (one for one in PRINTED if (one.place, one.quantity) == (place, quantity))
    return next(numbers, None)


def shown_in(figure: int) -> list[Printed]:
    """Return the printed numbers that a figure shows."""
    return [one for one in PRINTED if one.figure[:-1] == str(figure)]
