"""Every number that the paper prints in sections 5.3 and 5.4, with its place in the text.

Misprints stay as they are and are named.  The units are SI and rad.
"""

import math
from dataclasses import dataclass

from presswear.studies.paper.evidence import Place

WEAR, FRICTION, HIGH_FRICTION = "wear-times", "friction-0.05", "friction-0.1"
SLOW, FAST = "speed-4pi", "speed-8pi"

NAMED_TWICE_541 = "Fig. 18b shows joint C; the text names joint A a second time"
NAMED_TWICE_543 = "Fig. 24b shows joint C; the text names joint A, Fig. 24a, a second time"
SAME_START = (
    "the same 206.9 N is printed for both joints without wear, so that one of the two is "
    "probably a copy of the other"
)
NOT_ACCELERATION = 'the text says "peak value of acceleration of slider" of a force in N'
FIGURE_19_FOR_20 = "the text announces this figure as Fig. 19; Fig. 19 is in section 5.4.1"
FIGURE_20_FOR_21 = "the text announces this figure as Fig. 20; Fig. 20 shows the slider"
LOST_FACTOR = (
    "below the depth at C, while the text says that A wears more: the power of ten is probably 10⁻⁵"
)


@dataclass(frozen=True)
class Printed:
    """A printed number.

    Attributes
    ----------
    section, figure : str
        Where it stands, and the number of the figure that shows it.
    place : Place
    quantity : str
        As ``Evidence`` names it: ``depth`` is of both surfaces, after all wears so far.
    value : float
        SI units, rad.
    misprint : str
        What is wrong with it in print, if anything.
    stage_not_said : bool
        Whether the paper leaves open before or after which wear it was read.
    """

    section: str
    figure: str
    place: Place
    quantity: str
    value: float
    misprint: str = ""
    stage_not_said: bool = False


def _depths() -> list[Printed]:
    """Section 5.3: deepest wear and where it is."""
    rows = [
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
    ]
    found = []
    for section, figure, setting, wears, joint, depth, angle, misprint in rows:
        place = Place(setting, wears, joint)
        found.append(Printed(section, figure, place, "depth", depth, misprint))
        found.append(Printed(section, figure, place, "angle", math.radians(angle)))
    return found


def _responses() -> list[Printed]:
    """Section 5.4: peaks of the slider's motion and of the contact forces."""
    found = []
    for wears, value in ((1, 0.1076), (2, 0.1079)):
        found.append(Printed("5.4.1", "17a", Place(WEAR, wears), "displacement", value))
    for wears, value in enumerate((0.9925, 1.005, 1.106)):
        found.append(Printed("5.4.1", "17b", Place(WEAR, wears), "velocity", value))
    for wears, value in enumerate((1221.0, 1523.0, 3629.0)):
        found.append(Printed("5.4.1", "17c", Place(WEAR, wears), "acceleration", value))
    for wears, value in enumerate((206.9, 406.7, 2847.0)):
        found.append(
            Printed(
                "5.4.1",
                "18a",
                Place(WEAR, wears, "A"),
                "force",
                value,
                "" if wears else SAME_START,
            )
        )
    for wears, value in enumerate((206.9, 310.3, 1176.0)):
        misprint = NAMED_TWICE_541 if wears else f"{NAMED_TWICE_541}; {SAME_START}"
        found.append(Printed("5.4.1", "18b", Place(WEAR, wears, "C"), "force", value, misprint))
    for setting, value in ((FRICTION, 4671.0), (HIGH_FRICTION, 1244.0)):
        found.append(
            Printed(
                "5.4.2",
                "20c",
                Place(setting, 0),
                "acceleration",
                value,
                FIGURE_19_FOR_20,
                stage_not_said=True,
            )
        )
    for figure, joint, values in (("21a", "A", (2363.0, 448.5)), ("21b", "C", (650.3, 258.8))):
        for setting, value in zip((FRICTION, HIGH_FRICTION), values, strict=True):
            found.append(
                Printed(
                    "5.4.2",
                    figure,
                    Place(setting, 0, joint),
                    "force",
                    value,
                    f"{NOT_ACCELERATION}; {FIGURE_20_FOR_21}",
                    stage_not_said=True,
                )
            )
    for setting, accelerations in ((SLOW, (1789.0, 2378.0)), (FAST, (2877.0, 5391.0))):
        for wears, value in enumerate(accelerations):
            found.append(Printed("5.4.3", "23c", Place(setting, wears), "acceleration", value))
    forces = {
        (SLOW, "A"): (366.8, 420.6),
        (FAST, "A"): (574.6, 1278.0),
        (SLOW, "C"): (321.2, 466.2),
        (FAST, "C"): (424.0, 1957.0),
    }
    for (setting, joint), values in forces.items():
        for wears, value in enumerate(values):
            figure, misprint = ("24a", "") if joint == "A" else ("24b", NAMED_TWICE_543)
            found.append(
                Printed("5.4.3", figure, Place(setting, wears, joint), "force", value, misprint)
            )
    return found


PRINTED: tuple[Printed, ...] = (*_depths(), *_responses())
"""Every single printed value; angular ranges are in RANGES."""


@dataclass(frozen=True)
class PrintedRange:
    """Where the paper says that a joint is mainly worn, rad: arcs from, to."""

    section: str
    figure: str
    joint: str
    arcs: tuple[tuple[float, float], ...]


RANGES: tuple[PrintedRange, ...] = (
    PrintedRange("5.3.2", "11a", "A", ((math.radians(71.0), math.radians(90.0)),)),
    PrintedRange(
        "5.3.2",
        "11b",
        "C",
        (
            (math.radians(102.0), math.radians(187.0)),
            (math.radians(246.7), math.radians(360.0)),
        ),
    ),
)
"""Of both friction coefficients at once; how much wear lies inside is not said."""


def printed_at(place: Place, quantity: str) -> Printed | None:
    """The printed number of a quantity at a place; None where there is none."""
    for number in PRINTED:
        if number.place == place and number.quantity == quantity:
            return number
    return None
