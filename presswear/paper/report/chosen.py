"""Tables of what was chosen: its fit, how much hangs on it, and when runs stopped."""

import math
from collections.abc import Mapping

from presswear.paper.evidence import Evidence, Measured
from presswear.paper.printed import DOUBTFUL, JOINTS, PRINTED, SLIDER, Place, printed_at
from presswear.paper.variants import (
    BASE,
    GEOMETRIES,
    JUDGED,
    LONG,
    LONG_SETTINGS,
    SENSITIVITIES,
    WEAR,
)
from presswear.paper.verdicts import ratio
from presswear.paper.words import (
    as_printed,
    joint_text,
    place_text,
    ratio_text,
    stage_text,
    value_text,
)
from presswear.show.page import Line, Table
from presswear.tools.numbers import readable

_SMOOTH = tuple(
    (quantity, Place(WEAR, wear_updates))
    for quantity, stages in (("displacement", (1, 2)), ("stroke", (0,)), ("velocity", (0, 1, 2)))
    for wear_updates in stages
)
"""Quantities of the slider that geometries are told apart by."""

WATCHED = (
    *(("depth", "deepest wear", Place(WEAR, 1, joint)) for joint in JOINTS),
    *(
        ("force", "force", Place(WEAR, wear_updates, joint))
        for wear_updates in (0, 1)
        for joint in JOINTS
    ),
    ("displacement", "displacement,", Place(WEAR, 0)),
)
"""Quantities that sensitivities are shown of, with short names."""

_STOPPED = tuple(
    (quantity, Place(setting, wear_updates, joint))
    for setting in LONG_SETTINGS
    for quantity, wear_updates, joints in (
        ("depth", 1, JOINTS),
        ("added_mean", 1, JOINTS),
        ("range", 1, JOINTS),
        ("added_mean", 2, JOINTS),
        ("force", 0, JOINTS),
        ("force", 1, JOINTS),
        ("velocity", 0, SLIDER),
        ("acceleration", 0, SLIDER),
        ("acceleration", 1, SLIDER),
    )
    for joint in joints
)
"""Quantities compared between the runs and those of 200 cycles of each start."""


def factors_of(evidence: Evidence, case: str) -> dict[Place, float]:
    """Printed depths after a first wear over ours; one K_d / b would have one factor for all."""
    found = {}
    for number in PRINTED:
        if (number.quantity, number.place.wear_updates) == ("depth", 1):
            ours = evidence.measured(case, number.place, "depth")
            if ours is not None and ours.value > 0.0:
                found[number.place] = number.value / ours.value
    return found


def fit_of(factors: Mapping[Place, float]) -> tuple[float, float]:
    """The factor on K_d / b that fits best, and the one by which single depths miss it.

    The geometric mean, and the root mean square of logarithms, of all but the doubtful prints;
    nan where there are no others.
    """
    logs = [math.log(factor) for place, factor in factors.items() if place not in DOUBTFUL]
    if not logs:
        return math.nan, math.nan
    mean = sum(logs) / len(logs)
    return math.exp(mean), math.exp(math.sqrt(sum((log - mean) ** 2 for log in logs) / len(logs)))


def geometry_table(evidence: Evidence) -> Table:
    """How each geometry meets the printed peaks of smooth motion."""
    rows = []
    for quantity, place in _SMOOTH:
        printed = printed_at(place, quantity)
        value = as_printed(printed.value if printed else None, quantity)
        ours = [evidence.measured(name, place, quantity) for name in GEOMETRIES]
        texts = (value_text(found, quantity) for found in ours)
        rows.append((place_text(place, quantity), value, *texts))
    return Table(("", "paper", *GEOMETRIES), (("", tuple(rows)),))


def fit_table(evidence: Evidence) -> Table:
    """Printed first-wear depth over ours: one number for all would be a perfect fit."""
    factors = [factors_of(evidence, name) for name in JUDGED]
    rows: list[Line] = []
    for place in dict.fromkeys(place for own in factors for place in own):
        label = joint_text(place)
        if place in DOUBTFUL:
            label += " (doubtful print, left out)"
        rows.append((label, *(readable(own.get(place)) for own in factors)))
    best, spread = zip(*map(fit_of, factors), strict=True)
    summary = (
        ("best factor on K_d / b", *map(readable, best)),
        ("single depths miss it by a factor of", *map(readable, spread)),
    )
    head = ("paper / ours, deepest after the first wear", *JUDGED)
    return Table(head, (("", tuple(rows)), ("One number for all", summary)))


def across(
    evidence: Evidence, place: Place, quantity: str, case: str, other: str = BASE
) -> Measured | None:
    """A quantity under a case over itself under another; None where one is missing."""
    pair = [evidence.measured(name, place, quantity) for name in (case, other)]
    known = [found for found in pair if found is not None and found.value > 0.0]
    return ratio(known[:1], known[1:]) if len(known) == 2 else None


def moves(ours: Measured | None) -> bool:
    """Tell whether a ratio is certainly not one."""
    return ours is not None and ours.ends is not None and not ours.ends[0] <= 1.0 <= ours.ends[1]


def sensitivity_table(evidence: Evidence, failures: Mapping[str, str]) -> Table:
    """Each changed choice: what it makes of some results.

    Parameters
    ----------
    failures : mapping
        Message by case, for those that ended in failure.
    """
    rows = []
    for case, (label, _) in SENSITIVITIES.items():
        found = [across(evidence, place, quantity, case) for quantity, _, place in WATCHED]
        cells = [f"{ratio_text(own)}{' *' if moves(own) else ''}" for own in found]
        rows.append((f"{label}: {failures[case]}" if case in failures else label, *cells))
    head = [
        f"{short} {f'{place.joint}, ' if place.joint else ''}{stage_text(place, quantity)}"
        for quantity, short, place in WATCHED
    ]
    return Table(("changed alone", *head), (("", tuple(rows)),))


def stopped_table(evidence: Evidence) -> Table:
    """The runs beside those of 200 cycles of each start, where both ran."""
    rows = []
    for quantity, place in _STOPPED:
        early, full = (evidence.measured(case, place, quantity) for case in (BASE, LONG))
        found = across(evidence, place, quantity, BASE, LONG)
        if early is None or full is None or found is None:
            continue
        told = value_text(early, quantity), f"{early.samples} from {early.replicates}"
        whole = value_text(full, quantity), str(full.samples)
        same = "no" if moves(found) else "yes"
        rows.append((place_text(place, quantity), *told, *whole, ratio_text(found), same))
    heads = "run", "cycles, starts", "200 of each", "cycles", "ratio", "may be the same"
    return Table(("", *heads), (("", tuple(rows)),), numeric=False)


def distances_table(evidence: Evidence) -> Table:
    """Wear maps of early runs beside those of 200 cycles: errors that both state, and distance."""
    rows = []
    for place in (Place(setting, 1, joint) for setting in LONG_SETTINGS for joint in JOINTS):
        early, full = (evidence.wear_map(case, place) for case in (BASE, LONG))
        error, full_error = (evidence.map_error(case, place) for case in (BASE, LONG))
        if early is None or full is None or error is None or full_error is None:
            continue
        apart = float(((early.mean - full.mean) ** 2).sum() / (full.mean**2).sum())
        parts = (error, full_error, math.hypot(error, full_error), math.sqrt(apart))
        rows.append((joint_text(place), *(f"{readable(100.0 * part, 2)} %" for part in parts)))
    head = (
        "wear map, root mean square",
        "error stated by the early runs",
        "error stated after 200 cycles",
        "distance to expect",
        "distance found",
    )
    return Table(head, (("", tuple(rows)),))
