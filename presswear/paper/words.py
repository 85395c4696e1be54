"""Places, quantities and comparisons of the paper in words."""

from presswear.paper import settings, verdicts
from presswear.paper.evidence import OF_MAPS, QUANTITIES, Evidence
from presswear.paper.printed import COMPARISONS, Comparison, Place, Printed
from presswear.paper.settings import BASE, SETTINGS
from presswear.paper.verdicts import compared
from presswear.show.page import NOTHING, text_of
from presswear.tools.numbers import readable, unit_factor


def range_text(ends: tuple[float, float] | None, unit: str, digits: int = 3) -> str:
    """Return a range in a display unit, without the unit."""
    if ends is None:
        return NOTHING
    low, high = (readable(unit_factor(unit) * end, digits) for end in ends)
    return low if low == high else f"{low} to {high}"


def value_text(evidence: Evidence, case: str, place: Place, quantity: str) -> str:
    """Return our value of a quantity with its interval."""
    row = QUANTITIES[quantity]
    return text_of(evidence.estimate(case, place, quantity), row.unit, row.digits)


def printed_text(number: Printed | None) -> str:
    """Return a printed value with all its digits, in our unit."""
    if number is None:
        return readable(None)
    return readable(unit_factor(QUANTITIES[number.quantity].unit) * number.value, 4)


def stage_text(place: Place, quantity: str) -> str:
    """Return the stage, or the wear, that a quantity belongs to."""
    stage = settings.STAGES[place.wear_updates]
    return f"after the {stage}" if quantity in OF_MAPS else stage


def place_text(place: Place, quantity: str) -> str:
    """Return a quantity at a place in words, with its unit and without its setting."""
    row = QUANTITIES[quantity]
    joint = f"joint {place.joint}, " if place.joint else ""
    return f"{row.label}, {joint}{stage_text(place, quantity)} ({row.unit})"


def joint_text(place: Place) -> str:
    """Return a joint in a setting, in words."""
    return f"joint {place.joint}, {SETTINGS[place.setting].label}"


def comparison_text(comparison: Comparison) -> str:
    """Return both sides of a comparison, in words."""
    first = comparison.under[0]
    second = comparison.over[0]
    stage = stage_text(second, comparison.quantity)
    names = [SETTINGS[place.setting].short for place in (first, second)]
    if first.setting != second.setting:
        change = f"{' → '.join(names)}, {stage}"
    else:
        change = f"{names[1]}, {stage_text(first, comparison.quantity)} → {stage}"
    if len(comparison.over) > 1:
        return f"{change}, growth at A over growth at C"
    if first.joint != second.joint:
        return (
            f"{first.joint} → {second.joint}, {SETTINGS[second.setting].label}, {stage}"
        )
    return f"joint {second.joint}, {change}" if second.joint else change


def detail(evidence: Evidence, comparison: Comparison) -> str:
    """Return our value of a comparison on the standard geometry, the printed one, the verdict."""
    ours = compared(evidence, BASE, comparison)
    row = QUANTITIES[comparison.quantity]
    if comparison.is_difference:
        ours_text = f"{text_of(ours, row.unit)} {row.unit}"
    else:
        ours_text = f"×{text_of(ours)}"
    text = f"{row.label}, {comparison_text(comparison)}: {ours_text}"
    if comparison.printed is not None and comparison.is_difference:
        printed = readable(unit_factor(row.unit) * comparison.printed)
        text += f"; printed {printed} {row.unit}"
    elif comparison.printed is not None:
        text += f"; printed ×{readable(comparison.printed)}"
    # The verdict is by an interval that holds for all comparisons together.
    of_all = compared(evidence, BASE, comparison, COMPARISONS)
    return f"{text}; {verdicts.verdict(of_all, comparison)}"
