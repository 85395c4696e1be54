"""Coverage of intervals: tries with seeds of their own against long runs."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

import presswear as pw
from presswear.recording.statistics import half_width, widened
from presswear.results.motor_load import leader_speed, motor_loads
from presswear.tools.arrays import Array

TRIES = 80
LONG_RUNS = 4
LONG_SEEDS = range(TRIES + 1, TRIES + 1 + LONG_RUNS)  # no try has them
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
    tries: int = TRIES


def _slider_crank(rpm: float, **settings: Any) -> pw.Scene:
    crank = pw.SliderCrank(speed=math.tau * rpm / 60.0, **settings)
    return pw.Scene(crank, bearings=pw.Bearing(clearance=0.5e-3), **_NEW)


# New surfaces
_NEW: dict[str, Any] = {"engine": "dae", "replicates": 4, "wear_updates": 0}
_FOUR_BAR = pw.Scene(
    pw.FourBar(), bearings=pw.Bearing(clearance=0.8e-3), cycles=20, **_NEW
)
# Its speed varies from 0.94 to 1.07 of the nominal one.
_MOTOR = pw.Motor(1.0, slip=0.08, inertia=0.005)
SUBJECTS = {
    "press": Subject(pw.scenes.wear_times(conventions="refined", **_NEW)),
    "blanking": Subject(pw.scenes.press_blanking(**_NEW), 150),
    "four-bar": Subject(_FOUR_BAR, 400),
    "slider-crank-5000": Subject(_slider_crank(5000.0), 400),
    "slider-crank-1000": Subject(_slider_crank(1000.0, slide_angle=0.0), 400),
    "six-bar": Subject(pw.Scene(pw.SixBar(), **_NEW), 30),
    "four-bar-motor": Subject(
        replace(_FOUR_BAR, mechanism=pw.FourBar(motor=_MOTOR)), 400
    ),
    "four-bar-worn": Subject(replace(_FOUR_BAR, wear_updates=1), 800, 2 * TRIES),
}


def scenes_of(subject: Subject, tries: int | None = None) -> dict[str, pw.Scene]:
    """Return the tries of a subject, all by default, and its long runs, by name."""
    seeds = [k for k in range(1, subject.tries + LONG_RUNS + 1) if k not in LONG_SEEDS]
    scenes = {
        f"try-{k}": pw.changed(subject.scene, {"seed": f"{k}"}) for k in seeds[:tries]
    }
    for k in LONG_SEEDS:
        changes = {"seed": f"{k}", "cycles": f"{subject.cycles}"}
        scenes[f"long-{k}"] = pw.changed(subject.scene, changes)
    return scenes


def intervals_of(scene: pw.Scene, stage: pw.results.StageResult) -> dict[str, Ends]:
    """Return all intervals that a stage states, in SI units."""
    stored = stage.statistics
    per_cycle = 1.0 / stage.cycles_per_update
    found: dict[str, pw.statistics.Estimate | None] = {}
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
        # The error of the wear step is stated beside this interval, and is not in it.
        volume = widened(joint.wear_volume, joint.wear_volume_step_error or 0.0)
        found[f"worn volume {name}, of a cycle"] = volume.scaled(per_cycle)
        for side, peak in joint.wear_peaks.items():
            found[f"deepest wear {name}, {side}, of a cycle"] = peak.depth.scaled(
                per_cycle
            )
    found |= _of_motors(scene, stage)
    return {
        name: _ends(estimate)
        for name, estimate in found.items()
        if estimate is not None
    }


def _of_motors(
    scene: pw.Scene, stage: pw.results.StageResult
) -> dict[str, pw.statistics.Estimate | None]:
    """Return the estimates of the speed of the first motor and of the loads of all motors."""
    found: dict[str, pw.statistics.Estimate | None] = {}
    speed = leader_speed(scene, stage)
    if speed is not None:
        found["strokes in a second"] = speed.stroke_rate
    for name, load in motor_loads(scene, stage).items():
        found[f"motor work {name}"] = load.work
        found[f"slip loss {name}"] = load.slip_loss
        found[f"rms torque {name}"] = load.rms_fraction
        found[f"peak torque {name}"] = load.peak_fraction
    return found


def _ends(estimate: pw.statistics.Estimate) -> Ends:
    low, high = (
        math.nan if end is None else end for end in (estimate.low, estimate.high)
    )
    return estimate.mean, low, high


def is_mixture(stage: pw.results.StageResult) -> bool:
    """Return whether the stage says that its replicates show different motions."""
    settling = stage.statistics.settling
    return settling is not None and settling.is_mixture


@dataclass(frozen=True)
class Coverage:
    """Intervals of one quantity against its true value."""

    quantity: str
    truth: float  # mean of the long runs
    error: float  # half width of the interval of this mean
    ends: Array  # mean and ends of each try, shape (tries, 3); nan: no interval
    says_mixed: Flags  # the try says that its motion has not settled, shape (tries,)

    @property
    def half_widths(self) -> Array:
        """Half widths of the intervals that the tries state."""
        low, high = self.ends[~np.isnan(self.ends[:, 1]), 1:].T
        return np.asarray(0.5 * (high - low))

    @property
    def stated(self) -> Flags:
        """True where an interval is stated, or said to be none."""
        return np.asarray(~np.isnan(self.ends[:, 1]) | self.says_mixed)

    @property
    def right(self) -> Flags:
        """True where an interval contains the true value, or the try says that there is none.

        The error of the true value is added to each interval as an independent one.
        """
        mean, low, high = self.ends.T
        side = np.where(self.truth > mean, high - mean, mean - low)
        reach = np.hypot(side, self.error)
        return np.asarray((abs(self.truth - mean) <= reach) | self.says_mixed)

    @property
    def share(self) -> float:
        """Share of the stated intervals that are right; nan: none is stated."""
        return float(self.right[self.stated].mean()) if self.stated.any() else math.nan

    @property
    def passes(self) -> bool:
        """True if enough intervals hold, or none is stated."""
        return not self.share < LEAST

    @property
    def bias(self) -> float:
        """Distance of the mean of the settled tries from the true value, in mean half widths."""
        means = self.ends[~self.says_mixed, 0]
        width = self.half_widths.mean() if self.half_widths.size else 0.0
        off = float(np.nanmean(means)) - self.truth if means.size else 0.0
        return off / float(width) if width > 0.0 else 0.0

    def __str__(self) -> str:
        width = np.median(self.half_widths) if self.half_widths.size else math.nan
        relative = 100.0 * width / abs(self.truth) if self.truth else math.nan
        cells = [
            self.quantity,
            f"{self.truth:.4g} ± {self.error:.2g}",
            f"{relative:.2g} %",
            f"{self.bias:+.2f}",
            f"{int(self.right[self.stated].sum())} of {int(self.stated.sum())}",
            f"{int(self.says_mixed.sum())}",
        ]
        return " | ".join(cells)


def coverages(
    long: Sequence[Intervals], tries: Sequence[Intervals], says_mixed: Sequence[bool]
) -> Iterator[Coverage]:
    """Compare the intervals of every quantity with the mean of the long runs."""
    absent = (math.nan, math.nan, math.nan)
    for quantity in long[0] if long else ():
        values = np.array([one[quantity][0] for one in long if quantity in one])
        error = half_width(values) or 0.0
        ends = np.array([one.get(quantity, absent) for one in tries]).reshape(-1, 3)
        yield Coverage(
            quantity, float(values.mean()), error, ends, np.array(says_mixed, bool)
        )


HEADER = (
    "| quantity | true value, SI | half width (median) | bias (half widths) | intervals that hold "
    "| of these, not settled |\n|---|---|---:|---:|---:|---:|"
)


def table(results: Mapping[str, pw.Result], stage: int) -> list[Coverage]:
    """Return the coverages of a stage from the finished runs of a subject."""
    finished = {
        name: (result.scene, result.stages[stage])
        for name, result in results.items()
        if result.status != "failed" and len(result.stages) > stage
    }
    tries = [one for name, one in finished.items() if name.startswith("try")]
    long = [
        intervals_of(*one) for name, one in finished.items() if name.startswith("long")
    ]
    mixed = [is_mixture(one) for _, one in tries]
    return list(coverages(long, [intervals_of(*one) for one in tries], mixed))
