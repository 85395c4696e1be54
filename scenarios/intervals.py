"""Count how many 95 % intervals of independent campaigns contain the mean of long campaigns.

The long campaigns have one replicate each and 200 cycles per stage, as in the paper.

Run:  python scenarios/intervals.py [FOLDER]     (hours; results: docs/validation/intervals.md)
"""

import sys
from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

import numpy as np
from scipy.stats import t as student

import presswear as pw

CAMPAIGNS, TRUTHS = 60, 40  # long campaigns take the seeds after those of the others
MIN_HELD = 0.88  # of sixty intervals of 95 %, fewer hold by chance in one case of fifty
MAX_BIAS = 1.0 / 3.0  # distance of the mean estimate from the truth, in mean half widths
STAGES = ("no wear", "first wear", "second wear")

Intervals = dict[str, tuple[float, float, float]]  # value and ends by quantity


class Coverage(NamedTuple):
    """Estimates of one quantity against its truth."""

    stage: str
    quantity: str
    truth: tuple[float, float, float]
    means: Any
    half_widths: Any
    held: Any

    @property
    def bias(self) -> float:
        """Distance of the mean estimate from the truth, in mean half widths."""
        return float((self.means.mean() - self.truth[0]) / self.half_widths.mean())

    @property
    def passes(self) -> bool:
        """True if enough intervals hold and the estimates are not biased."""
        return bool(self.held.mean() >= MIN_HELD and abs(self.bias) <= MAX_BIAS)

    def __str__(self) -> str:
        truth = "{:.3g} ({:.3g} to {:.3g})".format(*self.truth)
        numbers = f"{self.means.mean():.3g} | {self.half_widths.mean():.3g} | {self.bias:+.2f}"
        verdict = "passed" if self.passes else "failed"
        count = f"{self.held.sum()} of {self.held.size}"
        return f"{self.stage} | {self.quantity} | {truth} | {numbers} | {count} | {verdict}"


def make_scenes(conventions: str, **settings: Any) -> dict[str, pw.Scene]:
    """Return campaigns of the paper's main scene, and long ones with the name ``truth``."""
    common = {"engine": "dae", "purpose": "wear", "conventions": conventions} | settings
    long = common | {"replicates": 1, "cycles": 200}
    names = {f"campaign-{k}": common | {"seed": k} for k in range(1, CAMPAIGNS + 1)}
    names |= {f"truth-{k}": long | {"seed": CAMPAIGNS + k} for k in range(1, TRUTHS + 1)}
    return {name: pw.scenes.wear_times(**one) for name, one in names.items()}


def intervals_of(stage: pw.StageResult) -> Intervals:
    """Return value and ends of each quantity of a stage, in SI units; nan: no interval."""
    estimates = {"slider, mean peak acceleration (m/s²)": stage.output.acceleration_max_per_cycle}
    intervals = {}
    for name, joint in stage.statistics.joints.items():
        estimates[f"{name}, mean peak force (N)"] = joint.peak_force_per_cycle
        volume, step = joint.wear_volume, joint.wear_volume_step_error or 0.0
        half = None if volume.half_width is None else float(np.hypot(volume.half_width, step))
        intervals[f"{name}, worn volume (m³)"] = around(volume.mean, half)
        for side, peak in joint.wear_peaks.items():
            estimates[f"{name}, deepest of {side} (m)"] = peak.depth
    for quantity, one in estimates.items():
        low, high = (np.nan if end is None else end for end in (one.low, one.high))
        intervals[quantity] = (one.mean, low, high)
    return intervals


def around(mean: float, half_width: float | None) -> tuple[float, float, float]:
    half = np.nan if half_width is None else half_width
    return mean, mean - half, mean + half


def coverages(
    truths: Sequence[Sequence[Intervals]], campaigns: Sequence[Sequence[Intervals]]
) -> Iterator[Coverage]:
    """Compare every quantity of every stage of the campaigns with the mean of the long ones."""
    for stage, name in enumerate(STAGES):
        long = [stages[stage] for stages in truths if len(stages) > stage]
        short = [stages[stage] for stages in campaigns if len(stages) > stage]
        for quantity in short[0] if long and short else ():
            values = np.array([one[quantity][0] for one in long])
            half = student.ppf(0.975, values.size - 1) * values.std(ddof=1) / values.size**0.5
            truth = around(values.mean(), half)
            ends = np.array([one[quantity] for one in short])
            means, low, high = ends[~np.isnan(ends[:, 1])].T
            if means.size:
                held = (low <= truth[0]) & (truth[0] <= high)
                yield Coverage(name, quantity, truth, means, 0.5 * (high - low), held)


def main(folder: str = "results/coverage", jobs: int | None = None, **settings: Any) -> None:
    for conventions in ("paper", "standard", "refined"):
        scenes = make_scenes(conventions, **settings)
        results = pw.run_scenes(scenes, f"{folder}/{conventions}", jobs=jobs)
        stages = {
            name: [intervals_of(stage) for stage in result.stages]
            for name, result in results.items()
            if result.status != "failed"
        }
        truths = [one for name, one in stages.items() if name.startswith("truth")]
        campaigns = [one for name, one in stages.items() if name.startswith("campaign")]
        print(f"{conventions}: stage | quantity | truth | mean estimate | mean half width | "
              "mean minus truth (half widths) | intervals that contain it | verdict")  # fmt: skip
        for coverage in coverages(truths, campaigns):
            print(coverage)


if __name__ == "__main__":
    main(sys.argv[1] if sys.argv[1:] else "results/coverage")
