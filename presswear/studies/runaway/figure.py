"""The figure of the study ``runaway``: depths of both wears under each reading."""

import math
from collections.abc import Sequence

import numpy as np

from presswear.show.figures.style import REFERENCE, WIDTH, Drawing, Sheet
from presswear.studies.runaway.variants import PRINTED, Outcome

_COLOURS = {"first": "#0072B2", "second": "#D55E00"}
_MARKS = {"first": "o", "second": "s"}


def two_wears(outcomes: Sequence[Outcome], clearance: float) -> Drawing:
    """Deepest depth that each wear adds at each joint, one row a variant."""
    joints = list(outcomes[0].first)
    sheet = Sheet(figsize=(WIDTH, 0.9 + 0.24 * (len(outcomes) + 1)), layout="constrained")
    panels = sheet.subplots(1, len(joints), sharey=True, squeeze=False)[0]
    rows = np.arange(len(outcomes) + 1)
    labels = [o.variant.label for o in outcomes]
    for axes, joint in zip(panels, joints, strict=True):
        for wear in ("first", "second"):
            depths = [1e6 * getattr(o, wear)[joint] for o in outcomes]
            axes.plot(
                depths,
                rows[:-1],
                linestyle="none",
                marker=_MARKS[wear],
                markersize=5,
                color=_COLOURS[wear],
                label=f"{wear} wear",
            )
        if joint == "A":
            axes.plot([1e6 * PRINTED[0]], [rows[-1]], _MARKS["first"], color=_COLOURS["first"])
            axes.plot([1e6 * PRINTED[1]], [rows[-1]], _MARKS["second"], color=_COLOURS["second"])
        for row, outcome in zip(rows[:-1], outcomes, strict=True):
            if math.isnan(outcome.first[joint]):
                axes.annotate(
                    "stopped", (0.02, row), xycoords=("axes fraction", "data"), va="center"
                )
        axes.axvline(1e6 * clearance, color=REFERENCE, linewidth=0.8, linestyle=(0.0, (3.0, 1.5)))
        axes.set_xscale("log")
        axes.set_xlabel(f"deepest depth added at {joint} (µm)")
    panels[0].set_yticks(rows, [*labels, "paper, printed"])
    panels[0].invert_yaxis()
    handles, names = panels[0].get_legend_handles_labels()
    sheet.legend(handles, names, loc="outside upper right", ncols=2)
    caption = (
        "Deepest depth that the first and the second wear add to one surface, bearing or pin, "
        "under each reading; dashed: the clearance. The last row is what the paper prints for A."
    )
    return Drawing("two-wears.png", "Both wears under each reading", caption, sheet)
