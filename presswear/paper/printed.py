"""Numbers that the paper prints in sections 5.3 and 5.4; they are in ``printed.toml``.

Misprints are kept and described. The units are SI and rad.
"""

import tomllib
from dataclasses import dataclass
from importlib.resources import files
from math import radians

_DATA = tomllib.loads(files("presswear.paper").joinpath("printed.toml").read_text("utf-8"))


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
    def is_peak(self) -> bool:
        """True for a peak of the motion or of a force; its counterpart is a single cycle."""
        return self.quantity not in ("depth", "angle")

    @property
    def places(self) -> tuple[Place, ...]:
        """Places to compare with: section 5.4.2 does not say before or after which wear."""
        if self.section != "5.4.2":
            return (self.place,)
        return tuple(Place(self.place.setting, k, self.place.joint) for k in (0, 1))


def _misprint(names: list[str]) -> str:
    return "; ".join(_DATA["misprints"][name] for name in names)


PRINTED: tuple[Printed, ...] = (
    *(
        Printed(section, figure, Place(setting, wear_updates, joint), *number)
        for section, figure, setting, wear_updates, joint, depth, angle, names in _DATA["depths"]
        for number in (("depth", depth, _misprint(names)), ("angle", radians(angle)))
    ),
    *(
        Printed(section, figure, Place(setting, k, joint), quantity, value, _misprint(names))
        for section, figure, setting, first, joint, quantity, values, names in _DATA["peaks"]
        for k, value in enumerate(values, first)
    ),
)

# places whose printed depth has probably lost a power of ten
LOST_FACTOR = _misprint(["lost_factor"])
DOUBTFUL = frozenset(number.place for number in PRINTED if number.misprint == LOST_FACTOR)

# figure, joint, arcs in which it is mainly worn (rad)
RANGES = tuple(
    (figure, joint, tuple((radians(low), radians(high)) for low, high in arcs))
    for figure, joint, arcs in _DATA["ranges"]
)


def printed_at(place: Place, quantity: str) -> Printed | None:
    """Return the printed number of a quantity at a place; None if none is printed."""
    numbers = (one for one in PRINTED if (one.place, one.quantity) == (place, quantity))
    return next(numbers, None)


def shown_in(figure: int) -> list[Printed]:
    """Return the printed numbers that a figure shows."""
    return [one for one in PRINTED if one.figure[:-1] == str(figure)]
