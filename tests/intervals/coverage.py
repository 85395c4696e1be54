"""Coverage of intervals: tries with seeds of their own against long runs."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

import presswear as pw
from presswear.recording.statistics import half_width
from presswear.tools.arrays import Array

TRIES, LONG_RUNS = 80, 4  # long runs take the seeds after those of the tries
CYCLES = 300  # of a replicate in a long run
LEAST = 0.875  # of 80 intervals of 95 %, fewer hold by chance in one case of 150

Ends = tuple[float, float, float]  # value and ends of an interval; nan: no interval
Intervals = Mapping[str, Ends]  # by quantity
Flags = NDArray[np.bool_]


@dataclass(frozen=True)
class Subject:
    """Scene whose intervals are tried."""

    scene: pw.Scene
    cycles: int = CYCLES  # of a replicate in a long run


def _slider_crank(rpm: float, **settings: Any) -> pw.Scene:
    crank = pw.SliderCrank(speed=math.tau * rpm / 60.0, **settings)
    return pw.Scene(crank, bearings=pw.Bearing(clearance=0.5e-3), **_NEW)


_NEW: dict[str, Any] = {"engine": "dae", "replicates": 4, "wear_updates": 0}  # new surfaces
_FOUR_BAR = pw.Scene(pw.FourBar(), bearings=pw.Bearing(clearance=0.8e-3), cycles=20, **_NEW)
SUBJECTS = {
    "press": Subject(pw.scenes.wear_times(conventions="refined", **_NEW)),
    "blanking": Subject(pw.scenes.press_blanking(**_NEW), 150),
    "four-bar": Subject(_FOUR_BAR, 400),
    "slider-crank-5000": Subject(_slider_crank(5000.0), 400),
    "slider-crank-1000": Subject(_slider_crank(1000.0, slide_angle=0.0), 400),
    "six-bar": Subject(pw.Scene(pw.SixBar(), **_NEW), 30),
    "four-bar-worn": Subject(replace(_FOUR_BAR, wear_updates=1), 200),
}


def scenes_of(subject: Subject, tries: int = TRIES) -> dict[str, pw.Scene]:
    """Return the tries of a subject and its long runs, by name."""
    scenes = {f"try-{k}": pw.changed(subject.scene, {"seed": f"{k}"}) for k in range(1, tries + 1)}
    for k in range(TRIES + 1, TRIES + 1 + LONG_RUNS):
        changes = {"seed": f"{k}", "cycles": f"{subject.cycles}"}
        scenes[f"long-{k}"] = pw.changed(subject.scene, changes)
    return scenes


def intervals_of(stage: pw.StageResult) -> dict[str, Ends]:
    """Return all intervals that a stage states, in SI units."""
    stored, per_cycle = stage.statistics, 1.0 / stage.cycles_per_update
    found: dict[str, pw.Estimate | None] = {}
    found["largest acceleration"] = stage.output.acceleration_max_per_cycle
    found["work of the drives"] = stored.drive_work_per_cycle
    if stored.bdc is not None:
        found["bottom dead centre"] = stored.bdc.height
        found["repeatability"] = stored.bdc.standard_deviation
        found["range of strokes"] = stored.bdc.range
        found["delay"] = stored.bdc.delay
    for name, joint in stored.joints.items():
        found[f"peak force {name}"] = joint.peak_force_per_cycle
        found[f"contacts {name}"] = joint.contacts_per_cycle
        found[f"load distance {name}"] = joint.load_distance_per_cycle
        # A run chooses the cycles of its wear update by its first cycles.
        found[f"worn volume {name}, of a cycle"] = joint.wear_volume.scaled(per_cycle)
        for side, peak in joint.wear_peaks.items():
            found[f"deepest wear {name}, {side}, of a cycle"] = peak.depth.scaled(per_cycle)
    return {name: _ends(estimate) for name, estimate in found.items() if estimate is not None}


def _ends(estimate: pw.Estimate) -> Ends:
    low, high = (np.nan if end is None else end for end in (estimate.low, estimate.high))
    return estimate.mean, low, high


def is_mixture(stage: pw.StageResult) -> bool:
    """Return whether the stage says that its replicates show different motions."""
    settling = stage.statistics.settling
    return settling is not None and settling.is_mixture


@dataclass(frozen=True)
class Coverage:
    """Intervals of one quantity against its true value."""

    quantity: str
    truth: Ends
    means: Array  # of the tries, shape (tries,)
    half_widths: Array  # nan: no interval
    holds: Flags  # the interval contains the true value, shape (tries,)
    says_mixed: Flags  # the try says that its motion has not settled, shape (tries,)

    @property
    def stated(self) -> Flags:
        """True where an interval is stated, or said to be none."""
        return np.asarray(~np.isnan(self.half_widths) | self.says_mixed)

    @property
    def share(self) -> float:
        """Share of the stated intervals that hold; a warning counts as one that holds."""
        right = self.holds | self.says_mixed
        return float(right[self.stated].mean()) if self.stated.any() else np.nan

    @property
    def passes(self) -> bool:
        """True if enough intervals hold, or none is stated."""
        return not self.share < LEAST

    @property
    def bias(self) -> float:
        """Distance of the mean of the tries from the true value, in mean half widths."""
        width = float(np.nanmean(self.half_widths)) if (~np.isnan(self.half_widths)).any() else 0.0
        return float(self.means.mean() - self.truth[0]) / width if width > 0.0 else 0.0

    def __str__(self) -> str:
        mean, low, high = self.truth
        widths = self.half_widths[~np.isnan(self.half_widths)]
        relative = np.median(widths) / abs(mean) if widths.size and mean else np.nan
        right = int((self.holds | self.says_mixed)[self.stated].sum())
        cells = [
            self.quantity,
            f"{mean:.4g} ({low:.4g} to {high:.4g})",
            f"{100.0 * relative:.2g} %",
            f"{self.bias:+.2f}",
            f"{right} of {int(self.stated.sum())}",
            f"{int(self.says_mixed.sum())}",
        ]
        return " | ".join(cells)


def coverages(
    long: Sequence[Intervals], tries: Sequence[Intervals], says_mixed: Sequence[bool]
) -> Iterator[Coverage]:
    """Compare the intervals of every quantity with the mean of the long runs."""
    mixed = np.array(says_mixed, bool)
    for quantity in long[0] if long else ():
        values = np.array([one[quantity][0] for one in long if quantity in one])
        half = half_width(values) or 0.0
        truth = float(values.mean())
        absent = (np.nan, np.nan, np.nan)
        means, low, high = np.array([one.get(quantity, absent) for one in tries]).T
        holds = (low <= truth) & (truth <= high)
        yield Coverage(
            quantity,
            (truth, truth - half, truth + half),
            means[~np.isnan(means)],
            0.5 * (high - low),
            holds,
            mixed,
        )


HEADER = (
    "| quantity | true value, SI | half width (median) | bias (half widths) | intervals that hold "
    "| of these, not settled |\n|---|---|---:|---:|---:|---:|"
)


def table(results: Mapping[str, pw.Result], stage: int) -> list[Coverage]:
    """Return the coverages of a stage from the finished runs of a subject."""
    finished = {
        name: result.stages[stage]
        for name, result in results.items()
        if result.status != "failed" and len(result.stages) > stage
    }
    tries = [one for name, one in finished.items() if name.startswith("try")]
    long = [intervals_of(one) for name, one in finished.items() if name.startswith("long")]
    mixed = [is_mixture(one) for one in tries]
    return list(coverages(long, [intervals_of(one) for one in tries], mixed))
