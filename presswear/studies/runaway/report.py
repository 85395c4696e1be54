"""The report of the study ``runaway``: answer, one row a variant, figure, in one HTML file."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import matplotlib
import numpy as np

from presswear.campaign.study import Study, Variant, results_of
from presswear.results.result import Result
from presswear.results.stage import SIDES
from presswear.show.figures.style import MICRONS, REFERENCE, SETTINGS, WIDTH, Drawing, Sheet
from presswear.show.report.page import illustrate, render_page
from presswear.show.report.parts import Table
from presswear.studies.paper.printed import shown_in
from presswear.studies.runaway.variants import CYCLES, RUNAWAY
from presswear.tools.files import write_bytes

PRINTED = tuple(
    one.value for one in shown_in(8) if (one.quantity, one.place.joint) == ("depth", "A")
)
"""The paper's deepest wear at A after the first and the second wear, m; the first may have
lost a factor of ten in print."""

_HEAD = (
    "reading",
    "first wear, A, C (µm)",
    "second wear, A, C (µm)",
    "second / first, at most",
    "peak force at A, mean a cycle (N)",
    "energy residual",
    "",
)
_VERDICTS = {True: "runs away", False: "does not run away", None: "cannot be told"}
_CAPTION = (
    "Deepest depth that the first and the second wear add to one surface, bearing or pin, "
    "under each reading; dashed: the clearance. The last row is what the paper prints for A."
)
_NOTES = (
    f"A wear runs away here when the second adds more than {RUNAWAY:g} times the depth of "
    f"the first. Each run has {CYCLES} cycles unless the row or the command says "
    "otherwise; a wear stands for {million:g} million. Depths scatter by some tens of per cent "
    "between runs: the motion is chaotic, and the deepest bin of a map is its noisiest. "
    "Forces are means over cycles of the peak in each stage, unworn first.",
    "Each row's own result folder is beside this file; presswear report FOLDER/ROW draws "
    "its figures.",
)


@dataclass(frozen=True)
class TwoWears:
    """The two wears of a variant.

    Attributes
    ----------
    first, second : mapping
        Deepest depth that a wear adds to either surface by joint, m; nan where it was not
        reached.
    force : tuple of float
        Mean over cycles of the peak force at the first joint in each stage, N.
    residual : float
        Largest energy that does not add up, part of the energy exchanged.
    failure : str
        Why it did not finish, or nothing.
    """

    variant: Variant
    first: Mapping[str, float]
    second: Mapping[str, float]
    force: tuple[float, ...]
    residual: float
    failure: str

    @property
    def growth(self) -> float:
        """Second wear over first at the joint where that is greatest."""
        ratios = [self.second[j] / self.first[j] for j in self.first if self.first[j] > 0.0]
        return max(filter(math.isfinite, ratios), default=math.nan)

    @property
    def deepest(self) -> float:
        """Deepest depth that one wear added anywhere, m."""
        depths = [*self.first.values(), *self.second.values()]
        return max(filter(math.isfinite, depths), default=math.nan)

    @property
    def runs_away(self) -> bool | None:
        """True where the second wear ran away; None where it cannot be told."""
        return None if math.isnan(self.growth) else self.growth > RUNAWAY

    def row(self) -> tuple[str, ...]:
        """Its row in the report."""
        wears = [
            ", ".join(_number(MICRONS * depth) for depth in wear.values())
            for wear in (self.first, self.second)
        ]
        return (
            self.variant.label,
            *wears,
            _number(self.growth, ".2g"),
            ", ".join(f"{force:.0f}" for force in self.force) or "-",
            _number(self.residual, ".0e"),
            self.failure or _VERDICTS[self.runs_away],
        )


def _number(value: float, form: str = ".3g") -> str:
    return "-" if math.isnan(value) else format(value, form)


def read_wears(variant: Variant, result: Result | None) -> TwoWears:
    """Read a variant's two wears from its result."""
    joints = variant.scene.clearance_joints
    nothing = dict.fromkeys(joints, math.nan)
    if result is None:
        return TwoWears(variant, nothing, nothing, (), math.nan, "it stopped in the first stage")
    stages = [stage for stage in result.stages if not stage.failed]
    wears = [
        {
            name: max(float(joint.wear(side).max()) for side in SIDES)
            for name, joint in stage.joints.items()
        }
        for stage in stages[:2]
    ]
    told = [stage.statistics for stage in stages]
    residuals = [abs(own["energy_residual_J"]) / own["energy_exchanged_J"] for own in told]
    force = [own["joints"][joints[0]]["force_max_per_cycle_N"]["mean"] for own in told]
    failure = result.message if result.status == "failed" else ""
    first, second = [*wears, nothing, nothing][:2]
    residual = max(residuals, default=math.nan)
    return TwoWears(variant, first, second, tuple(map(float, force)), residual, failure)


def answer(outcomes: Sequence[TwoWears], clearance: float) -> str:
    """The study's answer in a few plain sentences."""
    calm = [o for o in outcomes if o.runs_away is False]
    away = [o for o in outcomes if o.runs_away]
    if not calm and not away:
        return "No variant reached its second wear: nothing can be said."
    parts = []
    if calm:
        growths, deepest = [o.growth for o in calm], max(o.deepest for o in calm)
        parts.append(
            f"Under {len(calm)} of {len(calm + away)} readings that can be computed the second "
            f"wear does not run away: it adds {min(growths):.2g} to {max(growths):.2g} times the "
            f"depth of the first; no wear is deeper than {MICRONS * deepest:.0f} µm, "
            f"{100.0 * deepest / clearance:.1f} % of the clearance."
        )
    if away:
        names = "; ".join(
            f"{o.variant.label} ({MICRONS * o.deepest:.0f} µm, {o.growth:.0f} times the first)"
            for o in away
        )
        parts.append(f"It does run away under: {names}.")
    stopped = "; ".join(o.variant.label for o in outcomes if o.failure)
    if stopped:
        parts.append(f"Not to be computed at all: {stopped}.")
    first, second = (MICRONS * depth for depth in PRINTED)
    return " ".join([*parts, f"The paper prints {first:.3g} µm and then {second:.0f} µm."])


def draw_wears(outcomes: Sequence[TwoWears], clearance: float) -> Drawing:
    """Deepest depth that each wear adds at each joint, one row a variant."""
    joints = list(outcomes[0].first)
    rows = np.arange(len(outcomes) + 1)
    sheet = Sheet(figsize=(WIDTH, 0.9 + 0.24 * rows.size), layout="constrained")
    panels = sheet.subplots(1, len(joints), sharey=True, squeeze=False)[0]
    marks = (("first", "o", "#0072B2"), ("second", "s", "#D55E00"))
    for axes, joint in zip(panels, joints, strict=True):
        for (wear, marker, colour), printed in zip(marks, PRINTED, strict=True):
            depths = [MICRONS * getattr(o, wear)[joint] for o in outcomes]
            style = {"linestyle": "none", "marker": marker, "color": colour}
            axes.plot(depths, rows[:-1], markersize=5, label=f"{wear} wear", **style)
            if joint == "A":
                axes.plot([MICRONS * printed], rows[-1:], **style)
        for row, outcome in zip(rows[:-1], outcomes, strict=True):
            if math.isnan(outcome.first[joint]):
                axes.annotate(
                    "stopped", (0.02, row), xycoords=("axes fraction", "data"), va="center"
                )
        axes.axvline(
            MICRONS * clearance, color=REFERENCE, linewidth=0.8, linestyle=(0.0, (3.0, 1.5))
        )
        axes.set_xscale("log")
        axes.set_xlabel(f"deepest depth added at {joint} (µm)")
    panels[0].set_yticks(rows, [*(o.variant.label for o in outcomes), "paper, printed"])
    panels[0].invert_yaxis()
    sheet.legend(*panels[0].get_legend_handles_labels(), loc="outside upper right", ncols=2)
    return Drawing("two-wears.png", "Both wears under each reading", _CAPTION, sheet)


def write_report(study: Study, folder: Path) -> tuple[str, Path]:
    """Write ``report.html`` and the figure into the study's folder; returns answer and path."""
    outcomes = [read_wears(variant, result) for variant, result in results_of(study, folder)]
    scene = study.variants[0].scene
    clearance, million = scene.bearings.clearance, 1e-6 * scene.represented_cycles
    sentence = answer(outcomes, clearance)
    with matplotlib.rc_context(SETTINGS):
        drawing = draw_wears(outcomes, clearance)
    text = render_page(
        "study.html",
        package="presswear.studies",
        study=study,
        answer=sentence,
        outcomes=Table(_HEAD, (("", tuple(outcome.row() for outcome in outcomes)),)),
        figures=[illustrate(drawing, folder)],
        notes=[note.format(million=million) for note in _NOTES],
    )
    path = folder / "report.html"
    write_bytes(path, text.encode())
    return sentence, path
