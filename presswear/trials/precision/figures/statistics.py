"""Statistics beyond the horizon against their cost: step error and sampling error."""

import math

from matplotlib.lines import Line2D

from presswear.show.figures.style import REFERENCE, Axes, Drawing
from presswear.trials.precision.chaos import Chaos
from presswear.trials.precision.figures.panels import (
    RING,
    failed_strip,
    legend_above,
    log_labels,
    look_of,
    panels,
    plain_labels,
)
from presswear.trials.precision.statistic import sampling_error

_PERCENT = 100.0
_LEAST = 0.1
"""Per cent; what is smaller is drawn there."""
_BAND = "#F0E442"
_DASHED = (0.0, (4.0, 2.0))


def statistics_against_cost(chaos: Chaos) -> Drawing:
    """Draw the step error of each statistic over wall time, and what sampling error hides."""
    sheet, found = panels(len(chaos.names), 1.1, 2.3, sharex=True)
    # Statistic by statistic, joint beside joint.
    for axes, name in zip(found, chaos.names, strict=True):
        _panel(axes, chaos, name)
    for axes in found[-2:]:
        axes.set_xlabel("wall time for a simulated second (s)")
    marks = [
        Line2D([], [], color=_BAND, linewidth=5.0, label="below the sampling error of a stage"),
        Line2D([], [], color="0.3", linewidth=0.8, label="bound of the step error, 95 %"),
    ]
    best = chaos.cheapest()
    if best is not None:
        marks.append(Line2D([], [], color=REFERENCE, linestyle=_DASHED, label="cheapest honest"))
    methods = [point.method for point in chaos.points]
    legend_above(sheet, chaos.families, methods, False, marks)
    failed = "; ".join(p.method.label for p in chaos.points if p.failure)
    reference = chaos.reference
    any_cycles = next(iter(reference.statistics.values())).cycles
    return Drawing(
        "precision-statistics.png",
        "Statistics against cost, and where step error drops below sampling error",
        f"Size of the difference of each statistic from that of the finest method "
        f"({reference.method.label}, {any_cycles} cycles), in per cent, with the bound that it "
        "does not exceed at 95 %. What is estimated below "
        f"{_LEAST:g} % is drawn there. A setting is honest where the bound is in the coloured "
        f"band: below the sampling error (95 %) of a stage of {chaos.stage_cycles} cycles, which "
        "is what the scene runs by itself. Bounds fall with more cycles: an open mark is a "
        "setting that has not been shown to be honest, for want of cycles or of accuracy. "
        f"Dashed: the cheapest setting that is honest in wear totals and wear maps."
        f"{f' Failed: {failed}.' if failed else ''}",
        sheet,
    )


def _panel(axes: Axes, chaos: Chaos, name: str) -> None:
    reference = chaos.reference.statistics[name]
    axes.set_xscale("log")
    axes.set_yscale("log")
    sampling = _PERCENT * sampling_error(reference, chaos.stage_cycles) / abs(reference.mean)
    if math.isfinite(sampling):
        axes.axhspan(_LEAST / 3.0, sampling, color=_BAND, alpha=0.35, linewidth=0.0, zorder=0.4)
        axes.axhline(sampling, color="0.4", linewidth=0.8, zorder=0.5)
    for family, points in chaos.families.items():
        ran = [p for p in points if not p.failure]
        look = look_of(family)
        costs = [point.cost for point in ran]
        errors = [point.step_errors[name] for point in ran]
        sizes = [_percent(error.value, reference.mean) for error in errors]
        axes.plot(costs, sizes, **look.line(marker="none", linewidth=0.8, alpha=0.7))
        for point, error, cost, size in zip(ran, errors, costs, sizes, strict=True):
            if error.bound is not None:
                bound = _percent(error.bound, reference.mean)
                axes.plot((cost, cost), (size, bound), color=look.colour, linewidth=0.8)
                axes.plot(cost, bound, color=look.colour, marker="_", markersize=5.0)
            is_honest = chaos.is_honest_in(point, name)
            fill = look.colour if is_honest else "white"
            mark = look.line(linestyle="none", markerfacecolor=fill)
            axes.plot(cost, size, gid="honest" if is_honest else "open", **mark)
            if point.method.is_default:
                axes.plot(cost, size, gid="default", **RING)
    failed_strip(axes, [point.method for point in chaos.points if point.failure])
    best = chaos.cheapest()
    if best is not None:
        axes.axvline(best.cost, color=REFERENCE, linewidth=0.9, linestyle=_DASHED)
    axes.set_ylabel(f"{name} (%)")
    axes.set_ylim(_LEAST / 1.5, None)
    plain_labels(axes.yaxis)
    log_labels(axes.xaxis)


def _percent(value: float | None, mean: float) -> float:
    return math.nan if value is None else max(_PERCENT * abs(value / mean), _LEAST)
