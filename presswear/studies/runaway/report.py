"""The report of the study ``runaway``: answer, one row a variant, figure, in one HTML file."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import matplotlib
import numpy as np

from presswear.results.result import Result
from presswear.show.figures.style import MICRONS, REFERENCE, SETTINGS, WIDTH, Axes, Drawing, Sheet
from presswear.show.report.page import illustrate, render_page
from presswear.show.report.parts import MILLI, Table
from presswear.studies.paper.printed import shown_in
from presswear.studies.plan import Study, Variant, results_of
from presswear.studies.runaway.variants import CYCLES, LONGER, RUNAWAY, STARTS
from presswear.tools.arrays import Array
from presswear.tools.files import write_bytes
from presswear.tools.numbers import readable, with_interval

PRINTED = tuple(
    one.value for one in shown_in(8) if (one.quantity, one.place.joint) == ("depth", "A")
)
"""The paper's deepest wear at A after the first and the second wear, m; the first may have
lost a factor of ten in print."""

_HEAD = (
    "reading",
    "first wear, A, C (µm)",
    "second wear, A, C (µm)",
    "second / first: median, 5 % to 95 %",
    "starts that run away",
    "peak force at A, mean a cycle (N)",
    "energy residual",
    "",
)
_CAPTION = (
    "Deepest depth that the first and the second wear add to one surface, bearing or pin, "
    "under each reading: every start, and its median; dashed: the clearance. The last row is what "
    "the paper prints for A. Below: the same surfaces, those that the row “{longer}” leaves, run "
    "on under both contacts, with 95 % intervals."
)
_SAME_HEAD = (
    "on the surfaces, contact",
    "peak force at A, mean a cycle (N)",
    "energy made by contacts in a cycle (mJ)",
    "the same, of what they and friction take (%)",
    "energy residual",
    "",
)
_NOTES = (
    f"A wear runs away here when the second adds more than {RUNAWAY:g} times the depth of "
    f"the first, at the joint where that is most. Each of {STARTS} starts wears surfaces of its "
    f"own, in {CYCLES} cycles unless the row or the command says otherwise; a wear stands for "
    "{million:g} million. Depths are medians over the starts; behind the number that ran away "
    "stands the 95 % interval of its probability (Wilson). Forces are means over cycles of the "
    "peak in each stage, unworn first.",
    "Each row's own result folder is beside this file; presswear report FOLDER/ROW draws "
    "its figures.",
)


@dataclass(frozen=True)
class TwoWears:
    """The two wears of a variant.

    Attributes
    ----------
    first, second : mapping
        Deepest depth that a wear adds to either surface by joint, for each start, m; empty
        where it was not reached.
    force : tuple of float
        Mean over cycles of the peak force at the first joint in each stage, N.
    residual : float
        Largest energy that does not add up, part of the energy exchanged.
    failure : str
        Why it did not finish, or nothing.
    """

    variant: Variant
    first: Mapping[str, Array]
    second: Mapping[str, Array]
    force: tuple[float, ...]
    residual: float
    failure: str

    @property
    def growth(self) -> Array:
        """Second wear over first at the joint where that is greatest, for each start."""
        known = [j for j in self.first if self.first[j].size and self.second[j].size]
        if not known:
            return np.zeros(0)
        return np.asarray(np.max([self.second[j] / self.first[j] for j in known], axis=0))

    @property
    def away(self) -> int:
        """Starts whose second wear ran away."""
        return int((self.growth > RUNAWAY).sum())

    @property
    def deepest(self) -> float:
        """Deepest depth that one wear added anywhere, m."""
        depths = np.concatenate([*self.first.values(), *self.second.values()])
        return float(depths.max(initial=0.0))

    def row(self) -> tuple[str, ...]:
        """Its row in the report."""
        wear_updates = [
            ", ".join(
                readable(MICRONS * float(np.median(own))) if own.size else "-"
                for own in wear.values()
            )
            for wear in (self.first, self.second)
        ]
        growth, counted = "-", "-"
        if self.growth.size:
            low, middle, high = np.quantile(self.growth, (0.05, 0.5, 0.95))
            growth = f"{middle:.2g}, {low:.2g} to {high:.2g}"
            counted = told(self.away, self.growth.size)
        return (
            self.variant.label,
            *wear_updates,
            growth,
            counted,
            ", ".join(f"{force:.0f}" for force in self.force) or "-",
            "-" if math.isnan(self.residual) else f"{self.residual:.0e}",
            self.failure,
        )


def wilson(count: int, of: int) -> tuple[float, float]:
    """Ends of the 95 % interval of a probability (Wilson, J. Am. Stat. Assoc. 22, 1927, 209)."""
    z = 1.959964
    middle = (count + 0.5 * z * z) / (of + z * z)
    half = z / (of + z * z) * math.sqrt(count * (of - count) / of + 0.25 * z * z)
    return max(middle - half, 0.0), min(middle + half, 1.0)


def told(count: int, of: int) -> str:
    """So many of so many, with the interval of the probability."""
    low, high = wilson(count, of)
    return f"{count} of {of} ({100.0 * low:.0f} to {100.0 * high:.0f} %)"


@dataclass(frozen=True)
class SameSurfaces:
    """A run on surfaces that another one left.

    Attributes
    ----------
    force, made : tuple of float
        Mean over cycles of the peak force at the first joint, N, and of the energy that contacts
        make, J, each with the half width of its interval.
    part : float
        Energy that contacts made, part of what they and friction took.
    residual : float
        Energy that does not add up, part of the energy exchanged.
    failure : str
        Why there are no numbers, or nothing.
    """

    variant: Variant
    force: tuple[float, float]
    made: tuple[float, float]
    part: float
    residual: float
    failure: str

    def row(self) -> tuple[str, ...]:
        """Its row in the report."""
        return (
            self.variant.label,
            with_interval(*self.force),
            with_interval(*(MILLI * own for own in self.made)),
            readable(100.0 * self.part, 2),
            "-" if math.isnan(self.residual) else f"{self.residual:.0e}",
            self.failure,
        )


def read_same(variant: Variant, result: Result | None) -> SameSurfaces:
    """Read a variant that ran on another's surfaces from its result."""
    stage = result.stages[0] if result is not None and result.stages else None
    if stage is None or stage.failed:
        failure = stage.message if stage else "its surfaces were never reached, or it stopped"
        nothing = (math.nan, math.nan)
        return SameSurfaces(variant, nothing, nothing, math.nan, math.nan, failure)
    told = stage.statistics
    joint = variant.scene.clearance_joints[0]
    force, made = (
        (own["mean"], math.nan if own["half_width"] is None else own["half_width"])
        for own in (
            told["joints"][joint]["force_max_per_cycle_N"],
            told["energy_made_per_cycle_J"],
        )
    )
    residual = abs(told["energy_residual_J"]) / told["energy_exchanged_J"]
    return SameSurfaces(variant, force, made, told["energy_made_part"], residual, "")


def read_wears(variant: Variant, result: Result | None) -> TwoWears:
    """Read a variant's two wears from its result."""
    joints = variant.scene.clearance_joints
    nothing = dict.fromkeys(joints, np.zeros(0))
    if result is None:
        return TwoWears(variant, nothing, nothing, (), math.nan, "it stopped in the first stage")
    stages = [stage for stage in result.stages if not stage.failed]
    wear_updates = [
        {
            name: np.array(joint.statistics["wear_depth_max_by_start_m"])
            for name, joint in stage.joints.items()
        }
        for stage in stages[:2]
    ]
    statistics = [stage.statistics for stage in stages]
    residuals = [abs(own["energy_residual_J"]) / own["energy_exchanged_J"] for own in statistics]
    force = [own["joints"][joints[0]]["force_max_per_cycle_N"]["mean"] for own in statistics]
    failure = result.message if result.status == "failed" else ""
    first, second = [*wear_updates, nothing, nothing][:2]
    residual = max(residuals, default=math.nan)
    return TwoWears(variant, first, second, tuple(map(float, force)), residual, failure)


def answer(outcomes: Sequence[TwoWears], clearance: float) -> str:
    """The study's answer in a few plain sentences."""
    ran = [o for o in outcomes if o.growth.size]
    if not ran:
        return "No variant reached its second wear: nothing can be said."
    calm, away = [o for o in ran if not o.away], [o for o in ran if o.away]
    parts = []
    if calm:
        medians = [float(np.median(o.growth)) for o in calm]
        replicates, deepest = sum(o.growth.size for o in calm), max(o.deepest for o in calm)
        parts.append(
            f"Under {len(calm)} of {len(ran)} readings that can be computed the second wear runs "
            f"away from none of {replicates} starts: as a median it adds {min(medians):.2g} to "
            f"{max(medians):.2g} times the depth of the first; no wear is deeper than "
            f"{MICRONS * deepest:.0f} µm, {100.0 * deepest / clearance:.1f} % of the clearance."
        )
    if away:
        names = "; ".join(
            f"{o.variant.label}, {told(o.away, o.growth.size)}, up to {o.growth.max():.0f} times "
            f"the first and {MICRONS * o.deepest:.0f} µm"
            for o in away
        )
        parts.append(f"It runs away from some starts under: {names}.")
    stopped = "; ".join(o.variant.label for o in outcomes if o.failure)
    if stopped:
        parts.append(f"Not to be computed at all: {stopped}.")
    first, second = (MICRONS * depth for depth in PRINTED)
    return " ".join([*parts, f"The paper prints {first:.3g} µm and then {second:.0f} µm."])


def contacts_compared(same: Sequence[SameSurfaces]) -> str:
    """Say what each contact makes of the same surfaces, in a sentence; nothing without numbers."""
    parts = [
        f"{own.variant.label}: {with_interval(*own.force)} N at A and "
        f"{with_interval(*(MILLI * each for each in own.made))} mJ made in a cycle"
        for own in same
        if not own.failure
    ]
    return f"The same surfaces under both contacts: {'; '.join(parts)}." if parts else ""


def _draw_same(panels: Sequence[Axes], same: Sequence[SameSurfaces]) -> None:
    """Mean peak force and energy made on the same surfaces under both contacts, one row a run."""
    force = [one.force for one in same]
    made = [(MILLI * one.made[0], MILLI * one.made[1]) for one in same]
    for axes, pairs in zip(panels, (force, made), strict=True):
        for row, (one, (mean, half)) in enumerate(zip(same, pairs, strict=True)):
            if one.failure:
                _write(axes, "stopped", row)
            else:
                half = 0.0 if math.isnan(half) else half
                axes.errorbar(mean, row, xerr=half, fmt="D", color="#333333", ms=4, capsize=2)
        axes.set_ylim(len(same) - 0.5, -0.5)
        axes.update_datalim([(0.0, 0.0)])
        axes.autoscale_view(scaley=False)
    panels[0].set_yticks(range(len(same)), [one.variant.label for one in same])
    panels[0].set_xlabel("mean peak force at A (N)")
    panels[1].set_xlabel("energy made by contacts in a cycle (mJ)")


def _write(axes: Axes, word: str, row: int) -> None:
    """Write a word at the left end of a row without marks."""
    across = axes.get_yaxis_transform()
    axes.text(0.02, row, word, transform=across, ha="left", va="center", fontsize=6.5)


def draw_wears(
    outcomes: Sequence[TwoWears], same: Sequence[SameSurfaces], clearance: float
) -> Drawing:
    """Deepest depth that each wear adds at each joint, one row a variant.

    Below them what both contacts make of the same surfaces, where there are such runs.
    """
    joints = list(outcomes[0].first)
    rows = np.arange(len(outcomes) + 1)
    heights = (rows.size, len(same))
    sheet = Sheet(figsize=(WIDTH, 1.6 + 0.24 * sum(heights)), layout="constrained")
    grid = sheet.subplots(2, max(len(joints), 2), sharey="row", height_ratios=heights)
    panels, below = grid[0, : len(joints)], grid[1, :2]
    for unused in {*grid.flat} - {*panels, *below}:
        unused.remove()
    _draw_same(below, same)
    marks = (("first", "o", "#0072B2"), ("second", "s", "#D55E00"))
    for axes, joint in zip(panels, joints, strict=True):
        for (wear, marker, colour), printed in zip(marks, PRINTED, strict=True):
            style = {"linestyle": "none", "marker": marker, "color": colour}
            drawn = [(row, MICRONS * getattr(o, wear)[joint]) for row, o in enumerate(outcomes)]
            for row, depths in drawn:
                axes.plot(depths, [row] * depths.size, markersize=2, alpha=0.5, **style)
            middles = [(np.median(depths), row) for row, depths in drawn if depths.size]
            axes.plot(*zip(*middles, strict=True), markersize=5, label=f"{wear} wear", **style)
            if joint == "A":
                axes.plot([MICRONS * printed], rows[-1:], **style)
        for row, outcome in zip(rows[:-1], outcomes, strict=True):
            if outcome.second[joint].size:
                continue
            own = MICRONS * outcome.first[joint]
            if not own.size:
                _write(axes, "stopped", int(row))
                continue
            under = {"xytext": (0, -5), "textcoords": "offset points", "fontsize": 6.5}
            place = (float(np.median(own)), row)
            axes.annotate("second wear stopped", place, ha="center", va="top", **under)
        axes.axvline(
            MICRONS * clearance, color=REFERENCE, linewidth=0.8, linestyle=(0.0, (3.0, 1.5))
        )
        axes.set_xscale("log")
        axes.set_xlabel(f"deepest depth added at {joint} (µm)")
    panels[0].set_yticks(rows, [*(o.variant.label for o in outcomes), "paper, printed"])
    panels[0].invert_yaxis()
    sheet.legend(*panels[0].get_legend_handles_labels(), loc="outside upper right", ncols=2)
    longer = next((o.variant.label for o in outcomes if o.variant.key == LONGER), "")
    caption = _CAPTION.format(longer=longer)
    return Drawing("two-wears.png", "Both wears under each reading", caption, sheet)


def write_report(study: Study, folder: Path) -> tuple[str, Path]:
    """Write ``report.html`` and the figure into the study's folder; returns answer and path."""
    results = list(results_of(study, folder))
    outcomes = [read_wears(*one) for one in results if not one[0].on]
    same = [read_same(*one) for one in results if one[0].on]
    scene = study.variants[0].scene
    clearance, million = scene.bearings.clearance, 1e-6 * scene.cycles_per_update
    sentence = f"{answer(outcomes, clearance)} {contacts_compared(same)}".strip()
    with matplotlib.rc_context(SETTINGS):
        drawing = draw_wears(outcomes, same, clearance)
    text = render_page(
        "study.html",
        package="presswear.studies",
        study=study,
        answer=sentence,
        tables={
            "Variants": Table(_HEAD, (("", tuple(outcome.row() for outcome in outcomes)),)),
            "The same surfaces under both contacts": Table(
                _SAME_HEAD, (("", tuple(one.row() for one in same)),)
            ),
        },
        figures=[illustrate(drawing, folder)],
        notes=[note.format(million=million) for note in _NOTES],
    )
    path = folder / "report.html"
    write_bytes(path, text.encode())
    return sentence, path
