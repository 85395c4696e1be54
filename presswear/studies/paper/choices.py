"""What was chosen: how well it fits the paper, how much hangs on it, and when runs stopped."""

import math
from collections.abc import Mapping
from dataclasses import dataclass

from presswear.record.sampling import Interval
from presswear.studies.paper.evidence import Evidence, Measured, Place
from presswear.studies.paper.printed import LOST_FACTOR, PRINTED, WEAR
from presswear.studies.paper.variants import BASE, LONG, LONG_SETTINGS, SENSITIVITIES
from presswear.studies.paper.verdicts import ratio

WATCHED: tuple[tuple[str, Place], ...] = (
    ("depth", Place(WEAR, 1, "A")),
    ("depth", Place(WEAR, 1, "C")),
    ("force", Place(WEAR, 0, "A")),
    ("force", Place(WEAR, 0, "C")),
    ("force", Place(WEAR, 1, "A")),
    ("force", Place(WEAR, 1, "C")),
    ("displacement", Place(WEAR, 0)),
)
"""What sensitivities are shown of: quantity and place."""

STOPPED: tuple[tuple[str, int, str], ...] = (
    ("depth", 1, "A"),
    ("depth", 1, "C"),
    ("added_mean", 1, "A"),
    ("added_mean", 1, "C"),
    ("range", 1, "A"),
    ("range", 1, "C"),
    ("added_mean", 2, "A"),
    ("added_mean", 2, "C"),
    ("force", 0, "A"),
    ("force", 0, "C"),
    ("force", 1, "A"),
    ("force", 1, "C"),
    ("velocity", 0, ""),
    ("acceleration", 0, ""),
    ("acceleration", 1, ""),
)
"""What is compared between runs that stopped early and 200 cycles: quantity, wears, joint."""


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
    def used(self) -> list[float]:
        """The factors that count."""
        return [f for place, f in self.factors.items() if place not in self.left_out]

    @property
    def best(self) -> float:
        """Factor on K_d / b that fits best: the geometric mean."""
        return math.exp(sum(map(math.log, self.used)) / len(self.used)) if self.used else math.nan

    @property
    def spread(self) -> float:
        """Factor by which single depths miss the best fit, root mean square of logarithms."""
        if not self.used:
            return math.nan
        return math.exp(
            math.sqrt(sum(math.log(f / self.best) ** 2 for f in self.used) / len(self.used))
        )


def fit_of(evidence: Evidence, case: str) -> Fit:
    """The fit of K_d / b under a case, from the printed depths after a first wear."""
    factors, left_out = {}, []
    for number in PRINTED:
        if number.quantity != "depth" or number.place.wears != 1:
            continue
        ours = evidence.measured(case, number.place, "depth")
        if ours is None or ours.value <= 0.0:
            continue
        factors[number.place] = number.value / ours.value
        if number.misprint == LOST_FACTOR:
            left_out.append(number.place)
    return Fit(factors, tuple(left_out))


def against(evidence: Evidence, case: str, place: Place, quantity: str) -> Interval | None:
    """A quantity under a case over the same under the standard one."""
    there = evidence.measured(case, place, quantity)
    here = evidence.measured(BASE, place, quantity)
    if there is None or here is None or there.value <= 0.0 or here.value <= 0.0:
        return None
    return ratio([there], [here])


def moves(interval: Interval | None) -> bool:
    """Whether a ratio is certainly not one."""
    if interval is None or interval.low is None or interval.high is None:
        return False
    return interval.low > 1.0 or interval.high < 1.0


@dataclass(frozen=True)
class Sensitivity:
    """One changed choice.

    Attributes
    ----------
    key, label : str
    ratios : tuple
        To the standard case, in the order of WATCHED; None where nothing was computed.
    """

    key: str
    label: str
    ratios: tuple[Interval | None, ...]


def sensitivities(evidence: Evidence) -> list[Sensitivity]:
    """All changed choices."""
    return [
        Sensitivity(
            key,
            label,
            tuple(against(evidence, key, place, quantity) for quantity, place in WATCHED),
        )
        for key, (label, _) in SENSITIVITIES.items()
    ]


@dataclass(frozen=True)
class Stopped:
    """A quantity of runs that stopped early beside that of 200 cycles."""

    quantity: str
    place: Place
    early: Measured
    full: Measured
    ratio: Interval

    @property
    def agrees(self) -> bool:
        """Whether both may be the same."""
        return not moves(self.ratio)


def early_stop(evidence: Evidence) -> list[Stopped]:
    """Early stop against 200 cycles, where both ran."""
    found = []
    for setting in LONG_SETTINGS:
        for quantity, wears, joint in STOPPED:
            place = Place(setting, wears, joint)
            early = evidence.measured(BASE, place, quantity)
            full = evidence.measured(LONG, place, quantity)
            if early is None or full is None or early.value <= 0.0 or full.value <= 0.0:
                continue
            found.append(Stopped(quantity, place, early, full, ratio([early], [full])))
    return found


@dataclass(frozen=True)
class MapDistance:
    """How far the early wear map of a joint is from that of 200 cycles.

    Attributes
    ----------
    error : float
        Standard error that the early runs state, part of the map's rms.
    full_error : float
        The same of 200 cycles.
    distance : float
        Root mean square distance of both maps, part of the rms of that of 200 cycles.
    """

    setting: str
    joint: str
    error: float
    full_error: float
    distance: float

    @property
    def expected(self) -> float:
        """Distance that both errors explain."""
        return math.hypot(self.error, self.full_error)


def map_distances(evidence: Evidence) -> list[MapDistance]:
    """Distances of the maps of the first wear."""
    found = []
    for setting in LONG_SETTINGS:
        for joint in ("A", "C"):
            early = evidence.wear_map(BASE, setting, joint, 1)
            full = evidence.wear_map(LONG, setting, joint, 1)
            error = evidence.map_error(BASE, setting, joint, 0)
            full_error = evidence.map_error(LONG, setting, joint, 0)
            if early is None or full is None or error is None or full_error is None:
                continue
            apart = float(((early.mean - full.mean) ** 2).sum())
            size = float((full.mean**2).sum())
            found.append(MapDistance(setting, joint, error, full_error, math.sqrt(apart / size)))
    return found
