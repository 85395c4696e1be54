"""How quantities, places and settings are called where people read them."""

import math
from dataclasses import dataclass

from presswear.record.sampling import Interval
from presswear.scene.scene import stage_name
from presswear.studies.paper.evidence import Measured, Place
from presswear.studies.paper.variants import SETTINGS
from presswear.tools.numbers import readable


@dataclass(frozen=True)
class Shown:
    """How a quantity is shown.

    Attributes
    ----------
    label : str
    unit : str
    factor : float
        From SI units and rad.
    digits : int
        Significant digits.
    """

    label: str
    unit: str
    factor: float = 1.0
    digits: int = 3


QUANTITIES: dict[str, Shown] = {
    "displacement": Shown("peak displacement", "m", 1.0, 4),
    "velocity": Shown("peak velocity", "m/s", 1.0, 4),
    "acceleration": Shown("peak acceleration", "m/s²"),
    "force": Shown("peak contact force", "N"),
    "contact_rate": Shown("contacts in a second", "1/s"),
    "dose": Shown("force times slip in a cycle", "N m"),
    "displacement_off": Shown("distance from the ideal displacement (rms)", "mm", 1e3),
    "velocity_off": Shown("distance from the ideal velocity (rms)", "m/s"),
    "stroke": Shown("stroke", "m", 1.0, 4),
    "lag": Shown("lag behind the ideal motion", "µs", 1e6),
    "flight": Shown("part of the time out of contact", "%", 100.0),
    "depth": Shown("deepest wear", "µm", 1e6),
    "angle": Shown("angle of deepest wear", "°", 180.0 / math.pi),
    "range": Shown("worn range", "°", 180.0 / math.pi),
    "unevenness": Shown("unevenness of the wear (standard deviation)", "µm", 1e6),
    "mean_depth": Shown("mean depth", "µm", 1e6),
    "added_depth": Shown("deepest place of this wear alone", "µm", 1e6),
    "added_mean": Shown("mean depth of this wear alone", "µm", 1e6),
    "contact_range": Shown("range of directions worn in the stage", "°", 180.0 / math.pi),
}
"""Every quantity of ``Evidence``."""

OF_MAPS = frozenset(
    ("depth", "angle", "range", "unevenness", "mean_depth", "added_depth", "added_mean")
)
"""Quantities of what wears have left; the others are of a stage's motion."""


def number(value: float, quantity: str) -> str:
    """A value of a quantity in its unit, without the unit."""
    shown = QUANTITIES[quantity]
    return readable(shown.factor * value, shown.digits)


def as_printed(value: float, quantity: str) -> str:
    """A printed value with all its digits, in the unit of our own, without the unit."""
    return readable(QUANTITIES[quantity].factor * value, 4)


def between(low: float | None, high: float | None, quantity: str) -> str:
    """An interval of a quantity; a dash where there is none."""
    if low is None or high is None:
        return "–"
    shown = QUANTITIES[quantity]
    return span(shown.factor * low, shown.factor * high, shown.digits)


def span(low: float, high: float, digits: int = 3) -> str:
    """Two numbers as from, to; no upper end is said so, and one number twice is told once."""
    if readable(low, digits) == readable(high, digits):
        return readable(low, digits)
    if math.isinf(high):
        return f"from {readable(low, digits)}"
    return f"{readable(low, digits)} to {readable(high, digits)}"


def value_with_interval(ours: Measured | None, quantity: str) -> str:
    """A value with its interval in brackets."""
    if ours is None:
        return "–"
    if ours.low is None or ours.high is None:
        return f"{number(ours.value, quantity)} (too few cycles)"
    return f"{number(ours.value, quantity)} ({between(ours.low, ours.high, quantity)})"


def ratio_text(interval: Interval | None, factor: float = 1.0) -> str:
    """A ratio or difference with its interval in brackets."""
    if interval is None:
        return "–"
    value = readable(factor * interval.value)
    if interval.low is None or interval.high is None:
        return f"{value} (too few cycles)"
    return f"{value} ({span(factor * interval.low, factor * interval.high)})"


def stage_text(place: Place, quantity: str) -> str:
    """Which wear a place belongs to."""
    if quantity in OF_MAPS or quantity == "contact_range":
        return f"after the {stage_name(place.wears)}"
    return stage_name(place.wears)


def place_text(place: Place, quantity: str) -> str:
    """A place in words, without its setting."""
    joint = f"joint {place.joint}, " if place.joint else ""
    return f"{joint}{stage_text(place, quantity)}"


def setting_text(setting: str) -> str:
    """A setting in words."""
    return SETTINGS[setting][0]
