"""Tables of what was chosen: its fit, how much hangs on it, and when runs stopped."""

import math
from collections.abc import Mapping
from dataclasses import dataclass

from presswear.show.report.parts import Row, Table
from presswear.studies.paper.evidence import Evidence, Measured
from presswear.studies.paper.printed import JOINTS, LOST_FACTOR, PRINTED, Place, printed_at
from presswear.studies.paper.variants import (
    BASE,
    GEOMETRIES,
    JUDGED,
    LONG,
    LONG_SETTINGS,
    SENSITIVITIES,
    WEAR,
)
from presswear.studies.paper.verdicts import ratio
from presswear.studies.paper.words import (
    as_printed,
    joint_text,
    place_text,
    ratio_text,
    stage_text,
    value_text,
)
from presswear.tools.numbers import readable

_SMOOTH = (
    ("displacement", 1),
    ("displacement", 2),
    ("stroke", 0),
    ("velocity", 0),
    ("velocity", 1),
    ("velocity", 2),
)
"""Quantities of the slider, after so many wears, that geometries are told apart by."""

WATCHED = (
    ("depth", "deepest wear", Place(WEAR, 1, "A")),
    ("depth", "deepest wear", Place(WEAR, 1, "C")),
    ("force", "force", Place(WEAR, 0, "A")),
    ("force", "force", Place(WEAR, 0, "C")),
    ("force", "force", Place(WEAR, 1, "A")),
    ("force", "force", Place(WEAR, 1, "C")),
    ("displacement", "displacement,", Place(WEAR, 0)),
)
"""Quantities that sensitivities are shown of, with short names."""

_STOPPED = (
    ("depth", 1, JOINTS),
    ("added_mean", 1, JOINTS),
    ("range", 1, JOINTS),
    ("added_mean", 2, JOINTS),
    ("force", 0, JOINTS),
    ("force", 1, JOINTS),
    ("velocity", 0, ("",)),
    ("acceleration", 0, ("",)),
    ("acceleration", 1, ("",)),
)
"""Quantities compared between runs that stopped early and 200 cycles: wears, joints."""


@dataclass(frozen=True)
class Fit:
    """How well one K_d / b fits the printed depths of one wear.

    Attributes
    ----------
    factors : mapping of Place to float
        Printed depth over ours; a fit would have one factor for all.
    left_out : tuple of Place
        Depths whose print is doubtful.
    """

    factors: Mapping[Place, float]
    left_out: tuple[Place, ...]

    @property
    def logs(self) -> list[float]:
        """Logarithms of the factors that count."""
        return [math.log(f) for place, f in self.factors.items() if place not in self.left_out]

    @property
    def best(self) -> float:
        """Factor on K_d / b that fits best: the geometric mean."""
        return math.exp(sum(self.logs) / len(self.logs)) if self.logs else math.nan

    @property
    def spread(self) -> float:
        """Factor by which single depths miss the best fit, root mean square of logarithms."""
        if not self.logs:
            return math.nan
        off = [(log - math.log(self.best)) ** 2 for log in self.logs]
        return math.exp(math.sqrt(sum(off) / len(off)))


def fit_of(evidence: Evidence, case: str) -> Fit:
    """The fit of K_d / b under a case, from the printed depths after a first wear."""
    factors, left_out = {}, []
    for number in PRINTED:
        if (number.quantity, number.place.wears) != ("depth", 1):
            continue
        ours = evidence.measured(case, number.place, "depth")
        if ours is not None and ours.value > 0.0:
            factors[number.place] = number.value / ours.value
            if number.misprint == LOST_FACTOR:
                left_out.append(number.place)
    return Fit(factors, tuple(left_out))


def geometry_table(evidence: Evidence) -> Table:
    """How each geometry meets the printed peaks of smooth motion."""
    rows = []
    for quantity, wears in _SMOOTH:
        place = Place(WEAR, wears)
        printed = printed_at(place, quantity)
        ours = [evidence.measured(name, place, quantity) for name in GEOMETRIES]
        rows.append(
            (
                place_text(place, quantity),
                as_printed(printed.value if printed else None, quantity),
                *(value_text(found, quantity) for found in ours),
            )
        )
    return Table(("", "paper", *GEOMETRIES), (("", tuple(rows)),))


def fit_table(evidence: Evidence) -> Table:
    """Printed first-wear depth over ours: one number for all would be a perfect fit."""
    fits = [fit_of(evidence, name) for name in JUDGED]
    places = dict.fromkeys(place for fit in fits for place in fit.factors)
    rows: list[Row] = []
    for place in places:
        doubtful = any(place in fit.left_out for fit in fits)
        label = joint_text(place) + (" (doubtful print, left out)" if doubtful else "")
        rows.append((label, *(readable(fit.factors.get(place)) for fit in fits)))
    summary = (
        ("best factor on K_d / b", *(readable(fit.best) for fit in fits)),
        ("single depths miss it by a factor of", *(readable(fit.spread) for fit in fits)),
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
    """Runs that stopped early beside 200 cycles, where both ran."""
    rows = []
    for setting in LONG_SETTINGS:
        for quantity, wears, joints in _STOPPED:
            for joint in joints:
                place = Place(setting, wears, joint)
                early = evidence.measured(BASE, place, quantity)
                full = evidence.measured(LONG, place, quantity)
                found = across(evidence, place, quantity, BASE, LONG)
                if early is None or full is None or found is None:
                    continue
                rows.append(
                    (
                        place_text(place, quantity),
                        value_text(early, quantity),
                        f"{early.samples} from {early.starts}",
                        value_text(full, quantity),
                        str(full.samples),
                        ratio_text(found),
                        "no" if moves(found) else "yes",
                    )
                )
    head = (
        "",
        "stopped early",
        "cycles, starts",
        "200 cycles",
        "cycles",
        "ratio",
        "may be the same",
    )
    return Table(head, (("", tuple(rows)),), numeric=False)


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
