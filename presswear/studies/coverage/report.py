"""The report of the study ``coverage``: of each quantity, how many intervals hold the truth."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from presswear.recording.sampling import Interval, half_width
from presswear.scene.bearing import CONVENTIONS
from presswear.scene.scene import stage_name
from presswear.show.report.page import render_page
from presswear.show.report.parts import Table
from presswear.studies.coverage.variants import TRUTH
from presswear.studies.plan import Study, results_of
from presswear.tools.files import write_bytes
from presswear.tools.numbers import readable

Statistics = Mapping[str, Any]
Stages = Sequence[Statistics]

WANTED = 0.88
"""Part of the intervals that have to hold: of sixty of 95 %, fewer are chance in one of fifty."""
BIAS = 1.0 / 3.0
"""Most that the mean of the estimates may lie beside the truth, part of the mean half width."""

UNITS = {"m3": (1e9, "mm³"), "m": (1e6, "µm"), "N": (1.0, "N"), "s2": (1.0, "m/s²")}
"""Factor and unit that a person reads, by the end of a statistic's name."""


@dataclass(frozen=True)
class Coverage:
    """How the estimates of one quantity stand to its truth.

    Attributes
    ----------
    quantity : str
        Its name and joint.
    truth : Interval
    means : ndarray, shape (campaigns,)
    halves : ndarray, shape (campaigns,)
        Half widths of the intervals.
    held : ndarray of bool, shape (campaigns,)
    """

    conventions: str
    stage: int
    quantity: str
    truth: Interval
    means: np.ndarray[Any, np.dtype[np.float64]]
    halves: np.ndarray[Any, np.dtype[np.float64]]
    held: np.ndarray[Any, np.dtype[np.bool_]]

    @property
    def bias(self) -> float:
        """Distance of the mean of the estimates from the truth, part of the mean half width."""
        return float((self.means.mean() - self.truth.value) / self.halves.mean())

    @property
    def passes(self) -> bool:
        """True where enough intervals hold and the estimates do not lie beside the truth."""
        return bool(self.held.mean() >= WANTED and abs(self.bias) <= BIAS)

    def row(self) -> tuple[str, ...]:
        """Its row in the report."""
        factor, unit = next(
            own for end, own in UNITS.items() if self.quantity.split(",")[0].endswith(f"_{end}")
        )
        ends = self.truth.low, self.truth.high
        known = (
            ""
            if None in ends
            else " ({} to {})".format(*(readable(factor * e) for e in ends if e is not None))
        )
        return (
            f"{self.quantity} ({unit})",
            f"{readable(factor * self.truth.value)}{known}",
            readable(factor * float(self.means.mean())),
            readable(factor * float(self.halves.mean())),
            f"{self.bias:+.2f}",
            f"{int(self.held.sum())} of {self.held.size}",
            "holds" if self.passes else "does not hold",
        )


def estimates(statistics: Statistics) -> dict[str, Interval]:
    """Everything of a stage that is stored with an interval, by quantity and joint."""
    mean = statistics["slider"]["acceleration_max_per_cycle_m_s2"]
    found = {"acceleration_max_per_cycle_m_s2": _around(mean["mean"], mean["half_width"])}
    for joint, own in statistics["joints"].items():
        force = own["force_max_per_cycle_N"]
        found[f"force_max_per_cycle_N, {joint}"] = _around(force["mean"], force["half_width"])
        half = own["wear_volume_half_width_m3"]
        if half is not None:
            half = float(np.hypot(half, own.get("wear_volume_step_m3", 0.0)))
        found[f"wear_volume_m3, {joint}"] = _around(own["wear_volume_m3"], half)
        for side in ("bearing", "pin", "both"):
            name = f"wear_depth_max_{side}_m"
            if name in own:
                ends = own.get(f"wear_depth_max_{side}_interval_m") or (None, None)
                found[f"{name}, {joint}"] = Interval(own[name], *ends)
    return found


def _around(value: float, half: float | None) -> Interval:
    return Interval(value, *((None, None) if half is None else (value - half, value + half)))


def coverages(
    conventions: str, truths: Sequence[Stages], campaigns: Sequence[Stages]
) -> Iterator[Coverage]:
    """Hold every quantity of every stage of some campaigns against the mean of the long ones.

    Parameters
    ----------
    truths, campaigns : sequence of sequence of mapping
        Statistics of each stage of each campaign.
    """
    for k in range(max(map(len, truths), default=0)):
        longer, drawn = (
            [estimates(stages[k]) for stages in some if len(stages) > k]
            for some in (truths, campaigns)
        )
        for quantity in drawn[0] if drawn else ():
            values = np.array([one[quantity].value for one in longer if quantity in one])
            own = [one[quantity] for one in drawn if quantity in one]
            own = [one for one in own if one.low is not None]
            if not (values.size and own):
                continue
            right = _around(float(values.mean()), half_width(values))
            low, high = (np.array([getattr(one, end) for one in own]) for end in ("low", "high"))
            held = (low <= right.value) & (right.value <= high)
            means = np.array([one.value for one in own])
            yield Coverage(conventions, k, quantity, right, means, 0.5 * (high - low), held)


def answer(found: Sequence[Coverage]) -> str:
    """The study's answer in a sentence or two."""
    if not found:
        return "The long campaigns or all others have not run: nothing can be said."
    held = sum(one.held.mean() >= WANTED for one in found)
    true = sum(abs(one.bias) <= BIAS for one in found)
    worst = min(found, key=lambda one: float(one.held.mean()))
    return (
        f"Of {len(found)} quantities {held} are held by at least {100.0 * WANTED:.0f} % of the "
        f"95 % intervals, and of {true} the mean of the estimates lies within a third of the mean "
        f"half width. Held least: {worst.quantity}, {worst.conventions} conventions, "
        f"{stage_name(worst.stage)}, {int(worst.held.sum())} of {worst.held.size}."
    )


def write_report(study: Study, folder: Path) -> tuple[str, Path]:
    """Write ``report.html`` into the study's folder; returns answer and path."""
    stages = {
        variant.key: [stage.statistics for stage in result.stages]
        for variant, result in results_of(study, folder)
        if result is not None and result.status != "failed"
    }
    found: list[Coverage] = []
    for name in CONVENTIONS:
        own = {key: some for key, some in stages.items() if key.startswith(f"{name}-")}
        truths = [own.pop(key) for key in list(own) if key.startswith(f"{name}-{TRUTH}-")]
        found += coverages(name, truths, list(own.values()))
    head = ("quantity", "truth", "mean estimate", "mean half width", "off, half widths", "held", "")
    groups = {
        f"{one.conventions}, {stage_name(one.stage)}": tuple(
            other.row()
            for other in found
            if (other.conventions, other.stage) == (one.conventions, one.stage)
        )
        for one in found
    }
    sentence = answer(found)
    text = render_page(
        "study.html",
        package="presswear.studies",
        study=study,
        answer=sentence,
        tables={"Variants": Table(head, tuple(groups.items()))},
        figures=[],
        notes=["The interval behind a truth is that of the mean of the long campaigns."],
    )
    path = folder / "report.html"
    write_bytes(path, text.encode())
    return sentence, path
