"""Statistics beyond the horizon against their cost: step error and sampling error."""

import math

from matplotlib.lines import Line2D
from matplotlib.ticker import FuncFormatter

from presswear.show.figures.style import REFERENCE, WIDTH, Axes, Drawing, Sheet
from presswear.trials.precision.chaos import Chaos, StatisticPoint
from presswear.trials.precision.figures.diagrams import log_labels, strip
from presswear.trials.precision.figures.families import (
    RING,
    family_handles,
    legend_above,
    look_of,
    mark_handles,
)

_PERCENT = 100.0
_LEAST = 0.1
"""Per cent; what is smaller is drawn there."""
_BAND = "#F0E442"


def statistics_against_cost(chaos: Chaos) -> Drawing:
    """Step error of each statistic over wall time, and the sampling error that it hides in."""
    names = chaos.names
    columns = 2
    rows = math.ceil(len(names) / columns)
    sheet = Sheet(figsize=(WIDTH, 1.1 + 2.3 * rows), layout="constrained")
    panels = sheet.subplots(rows, columns, sharex=True, squeeze=False).ravel()
    # Statistic by statistic, joint beside joint.
    for axes, name in zip(panels, names, strict=False):
        _panel(axes, chaos, name)
    for axes in panels[len(names) :]:
        axes.set_axis_off()
    for axes in panels[max(len(names) - columns, 0) : len(names)]:
        axes.set_xlabel("wall time for a simulated second (s)")
    marks = [
        Line2D([], [], color=_BAND, linewidth=5.0, label="below the sampling error of a stage"),
        Line2D([], [], color="0.3", linewidth=0.8, label="bound of the step error, 95 %"),
    ]
    best = chaos.cheapest()
    if best is not None:
        marks.append(
            Line2D([], [], color=REFERENCE, linestyle=(0.0, (4.0, 2.0)), label="cheapest honest")
        )
    methods = [point.method for point in chaos.points]
    handles = family_handles(chaos.families()) + mark_handles(methods, False) + marks
    legend_above(sheet, handles, 2)
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
    sampling = _PERCENT * reference.sampling_error(chaos.stage_cycles) / abs(reference.mean)
    if math.isfinite(sampling):
        axes.axhspan(_LEAST / 3.0, sampling, color=_BAND, alpha=0.35, linewidth=0.0, zorder=0.4)
        axes.axhline(sampling, color="0.4", linewidth=0.8, zorder=0.5)
    for family, points in chaos.families().items():
        ran = [p for p in points if not p.failure]
        look = look_of(family)
        costs = [point.cost for point in ran]
        sizes = [_percent(point.step_errors[name].value, reference.mean) for point in ran]
        axes.plot(costs, sizes, **look.line(marker="none", linewidth=0.8, alpha=0.7))
        for point, cost, size in zip(ran, costs, sizes, strict=True):
            bound = _percent(point.step_errors[name].bound, reference.mean)
            if math.isfinite(bound):
                axes.plot((cost, cost), (size, bound), color=look.colour, linewidth=0.8)
                axes.plot(cost, bound, color=look.colour, marker="_", markersize=5.0)
            fill = look.colour if _is_honest(chaos, point, name) else "white"
            mark = look.line(linestyle="none", markerfacecolor=fill)
            axes.plot(cost, size, gid="honest" if fill != "white" else "open", **mark)
            if point.method.is_default:
                axes.plot(cost, size, gid="default", **RING)
    strip(axes, [point.method for point in chaos.points if point.failure])
    best = chaos.cheapest()
    if best is not None:
        axes.axvline(best.cost, color=REFERENCE, linewidth=0.9, linestyle=(0.0, (4.0, 2.0)))
    axes.set_ylabel(f"{name} (%)")
    axes.set_ylim(_LEAST / 1.5, None)
    axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    log_labels(axes.xaxis)


def _percent(value: float, mean: float) -> float:
    return max(_PERCENT * abs(value / mean), _LEAST)


def _is_honest(chaos: Chaos, point: StatisticPoint, name: str) -> bool:
    return (
        not point.step_errors[name].is_seen
        and chaos.honest_cycles(point, name) >= chaos.stage_cycles
    )
