"""Names of quantities and places, and numbers, as people read them."""

import math
from dataclasses import dataclass

from presswear.paper.claims import Comparison
from presswear.paper.evidence import CYCLES, Ends, Measured
from presswear.paper.printed import Place
from presswear.paper.variants import SETTINGS
from presswear.scene.scene import stage_name
from presswear.tools.numbers import readable


@dataclass(frozen=True)
class Quantity:
    """Label, unit, factor from SI units and rad to it, and significant digits of a quantity."""

    label: str
    unit: str
    factor: float = 1.0
    digits: int = 3


_DEGREES = 180.0 / math.pi
QUANTITIES: dict[str, Quantity] = {
    "displacement": Quantity("peak displacement", "m", 1.0, 4),
    "velocity": Quantity("peak velocity", "m/s", 1.0, 4),
    "acceleration": Quantity("peak acceleration", "m/s²"),
    "force": Quantity("peak contact force", "N"),
    "contact_rate": Quantity("contacts in a second", "1/s"),
    "load_distance": Quantity("force times slip in a cycle", "N m"),
    "displacement_off": Quantity("distance from the ideal displacement (rms)", "mm", 1e3),
    "velocity_off": Quantity("distance from the ideal velocity (rms)", "m/s"),
    "stroke": Quantity("stroke", "m", 1.0, 4),
    "lag": Quantity("lag behind the ideal motion", "µs", 1e6),
    "flight": Quantity("part of the time out of contact", "%", 100.0),
    "depth": Quantity("deepest wear", "µm", 1e6),
    "angle": Quantity("angle of deepest wear", "°", _DEGREES),
    "range": Quantity("worn range", "°", _DEGREES),
    "unevenness": Quantity("unevenness of the wear (standard deviation)", "µm", 1e6),
    "mean_depth": Quantity("mean depth", "µm", 1e6),
    "added_depth": Quantity("deepest place of this wear alone", "µm", 1e6),
    "added_mean": Quantity("mean depth of this wear alone", "µm", 1e6),
    "contact_range": Quantity("range of directions worn in the stage", "°", _DEGREES),
}
"""Every quantity of ``Evidence``."""


def as_printed(value: float | None, quantity: str) -> str:
    """A printed value with all its digits, in the unit of our own, without the unit."""
    return readable(None if value is None else QUANTITIES[quantity].factor * value, 4)


def between(ends: Ends | None, quantity: str) -> str:
    """An interval of a quantity; a dash where there is none."""
    shown = QUANTITIES[quantity]
    return "–" if ends is None else _span(ends, shown.factor, shown.digits)


def _span(ends: Ends, factor: float, digits: int) -> str:
    """Two numbers as from, to; no upper end is said so, and one number twice is told once."""
    low, high = (readable(factor * end, digits) for end in ends)
    if low == high:
        return low
    return f"from {low}" if math.isinf(ends[1]) else f"{low} to {high}"


def _with_ends(ours: Measured | None, factor: float, digits: int) -> str:
    """A value with its interval in brackets; a dash where there is none."""
    if ours is None:
        return "–"
    ends = "too few cycles" if ours.ends is None else _span(ours.ends, factor, digits)
    return f"{readable(factor * ours.value, digits)} ({ends})"


def value_text(ours: Measured | None, quantity: str) -> str:
    """A quantity in its unit, without the unit, with its interval."""
    shown = QUANTITIES[quantity]
    return _with_ends(ours, shown.factor, shown.digits)


def ratio_text(ours: Measured | None, factor: float = 1.0) -> str:
    """A ratio or difference with its interval."""
    return _with_ends(ours, factor, 3)


def stage_text(place: Place, quantity: str) -> str:
    """Name the wear that a place belongs to."""
    stage = stage_name(place.wear_updates)
    return stage if quantity in CYCLES else f"after the {stage}"


def place_text(place: Place, quantity: str) -> str:
    """A quantity at a place in words, with its unit and without its setting."""
    shown = QUANTITIES[quantity]
    joint = f"joint {place.joint}, " if place.joint else ""
    return f"{shown.label}, {joint}{stage_text(place, quantity)} ({shown.unit})"


def joint_text(place: Place) -> str:
    """A joint in a setting, in words."""
    return f"joint {place.joint}, {SETTINGS[place.setting].label}"


def compared_text(part: Comparison) -> str:
    """Name both sides of a comparison."""
    first, second = part.under[0], part.over[0]
    stage = stage_text(second, part.quantity)
    settings = [SETTINGS[place.setting].short for place in (first, second)]
    if first.setting != second.setting:
        change = f"{' → '.join(settings)}, {stage}"
    else:
        change = f"{settings[1]}, {stage_text(first, part.quantity)} → {stage}"
    if len(part.over) > 1:
        return f"{change}, growth at A over growth at C"
    if first.joint != second.joint:
        return f"{first.joint} → {second.joint}, {SETTINGS[second.setting].label}, {stage}"
    return f"joint {second.joint}, {change}" if second.joint else change
