"""Wear against angles, cycles and contact model."""

from collections.abc import Mapping
from itertools import cycle, product

from matplotlib.lines import Line2D
from matplotlib.ticker import NullFormatter

from presswear.recording.sampling import Interval
from presswear.show.figures.style import REFERENCE, WIDTH, Axes, Drawing, Sheet
from presswear.validation.precision.figures.panels import (
    LOOKS,
    RING,
    Look,
    log_labels,
    plain_labels,
)
from presswear.validation.precision.wear import (
    QUANTITIES,
    Group,
    WearPoint,
    WearStudy,
    change,
)

_SHIFT = 0.06
"""Between curves of one panel, part of the distance of two values."""
_NUMBERED: tuple[Group, ...] = ("angles", "cycles")
_Series = tuple[str, str]
"""Conventions and joint."""


def wear_convergence(wear: WearStudy) -> Drawing | None:
    """Draw the first wear over what it is computed with, in parts of the finest's."""
    series = _looks(wear)
    groups = [group for group in _NUMBERED if any(wear.of(group, name) for name, _ in series)]
    if not series or not groups:
        return None
    usual = ", ".join(f"{count} ({name})" for name, count in wear.usual.items())
    sheet = Sheet(figsize=(WIDTH, 0.9 + 2.5 * len(QUANTITIES)), layout="constrained")
    panels = sheet.subplots(len(QUANTITIES), len(groups), squeeze=False)
    for row, name in zip(panels, QUANTITIES, strict=True):
        for axes, group in zip(row, groups, strict=True):
            _panel(axes, wear, group, series, name)
        row[0].set_ylabel(f"{name} / that of the finest")
    for axes, group in zip(panels[-1], groups, strict=True):
        axes.set_xlabel(group)
    ring = Line2D([], [], label="taken by default", **RING)
    sheet.legend(handles=[*_handles(series), ring], loc="outside upper left", ncols=3)
    return Drawing(
        "precision-wear.png",
        "First wear against angles and cycles",
        f"Deepest wear of either surface and worn volume after the first wear, in parts of what "
        f"the finest value (to the right) gives, with 95 % intervals of both. Where cycles are not "
        f"what is varied: {usual}. All runs: {wear.method}."
        f"{failed_words(wear)}",
        sheet,
    )


def _looks(wear: WearStudy) -> dict[_Series, Look]:
    return dict(zip(product(wear.conventions, wear.joints), cycle(LOOKS), strict=False))


def _handles(series: Mapping[_Series, Look]) -> list[Line2D]:
    return [
        Line2D([], [], label=f"{joint}, {name}", **look.line())
        for (name, joint), look in series.items()
    ]


def _panel(
    axes: Axes, wear: WearStudy, group: Group, series: Mapping[_Series, Look], quantity: str
) -> None:
    labels = labels_of(wear, group)
    axes.axhline(1.0, color=REFERENCE, linewidth=0.7)
    for place, ((name, joint), look) in enumerate(series.items()):
        points = wear.of(group, name)
        if not points:
            continue
        finest = points[-1].first.get(joint)
        shift = _SHIFT * (place - 0.5 * (len(series) - 1))
        drawn: list[tuple[float, float, float]] = []
        for point in points:
            x = labels.index(point.varied.label) + shift
            found = point.first.get(joint)
            if found is None or finest is None:
                if point.failure:
                    top = axes.get_xaxis_transform()
                    axes.plot(x, 0.97, "x", color=look.colour, transform=top)
                continue
            value, half = _relative(point, points[-1], found[quantity], finest[quantity])
            drawn.append((x, value, half))
            if point.varied.is_default:
                axes.plot(x, value, **RING)
        if drawn:
            x_all, values, halves = zip(*drawn, strict=True)
            axes.errorbar(x_all, values, yerr=halves, elinewidth=0.9, **look.line())
    axes.set_yscale("log")
    axes.set_xticks(range(len(labels)), labels)
    if len(labels) > 4:
        axes.tick_params(axis="x", rotation=45.0)
    _plain_scale(axes)


def labels_of(wear: WearStudy, group: Group) -> list[str]:
    """Labels of a group's values, coarse to fine, of all conventions together."""
    told = [point.varied for name in wear.conventions for point in wear.of(group, name)]
    values = {varied.label: varied.value or 0.0 for varied in told}
    return sorted(values, key=values.__getitem__)


def _relative(
    point: WearPoint, finest: WearPoint, here: Interval, there: Interval
) -> tuple[float, float]:
    """Value over the finest's, and half its interval; of the finest its own."""
    if point is finest:
        if here.low is None or here.high is None or here.value == 0.0:
            return 1.0, 0.0
        return 1.0, 0.5 * (here.high - here.low) / here.value
    moved = change(here, there)
    half = 0.0 if moved.low is None else moved.value - moved.low
    # On a logarithmic scale no bar may reach zero.
    return 1.0 + moved.value, min(half, 0.9 * (1.0 + moved.value))


def _plain_scale(axes: Axes) -> None:
    """Plain numbers, as many as fit, on a logarithmic scale around 1."""
    low, high = axes.get_ylim()
    if high / low > 2.5:
        ticks = [0.1, 0.2, 0.3, 0.5, 0.7, 1.0, 1.5, 2.0, 3.0, 5.0, 10.0]
    else:
        step = 0.1 if high / low > 1.2 else 0.02
        ticks = [1.0 + step * k for k in range(-9, 20)]
    axes.set_yticks([tick for tick in ticks if low <= tick <= high])
    plain_labels(axes.yaxis)
    axes.yaxis.set_minor_formatter(NullFormatter())
    axes.set_ylim(low, high)


_NAMED: tuple[Group, ...] = ("jump", "contact", "method")


def contact_models(wear: WearStudy) -> Drawing:
    """Draw wear under each contact model and method: the first, and a second one in one jump."""
    series = _looks(wear)
    points = [p for group in _NAMED for name in wear.conventions for p in wear.of(group, name)]
    rows = [(p, which) for p in points for which in ("first", "second")]
    sheet = Sheet(figsize=(WIDTH, 1.1 + 0.26 * len(rows)), layout="constrained")
    panels = sheet.subplots(1, len(QUANTITIES), sharey=True, squeeze=False)[0]
    for axes, (name, unit) in zip(panels, QUANTITIES.items(), strict=True):
        factor, shown = {"m": (1e6, "µm"), "m^3": (1e9, "mm³")}[unit]
        axes.set_xscale("log")
        for row, (point, which) in enumerate(rows):
            found = point.first if which == "first" else point.second
            if not found:
                axes.annotate("failed", (0.02, row), xycoords=("axes fraction", "data"))
            for joint, own in found.items():
                if name not in own:
                    continue
                look = series[point.varied.conventions, joint]
                value, low, high = factor * own[name].value, own[name].low, own[name].high
                if low is not None and high is not None:
                    ends = max(factor * low, 0.02 * value), factor * high
                    axes.plot(ends, (row, row), color=look.colour)
                axes.plot(value, row, **look.line(linestyle="none"))
        axes.set_xlabel(f"{name} ({shown})")
        log_labels(axes.xaxis)
        plain_labels(axes.xaxis)
    labels = [f"{p.varied.conventions}, {p.varied.label}, {which} wear" for p, which in rows]
    panels[0].set_yticks(range(len(rows)), labels)
    panels[0].set_ylim(len(rows) - 0.5, -0.5)
    sheet.legend(handles=_handles(series), loc="outside upper left", ncols=4)
    return Drawing(
        "precision-contact.png",
        "Wear under each contact model, and by method",
        "How worn surfaces meet, and how the motion is integrated, each changed alone: what the "
        "first wear takes off, and what a second one would in one jump, with 95 % intervals. On "
        "round surfaces both contact models are the same law: a first wear in one jump (paper) "
        f"is the same under both.{failed_words(wear)}",
        sheet,
    )


def failed_words(wear: WearStudy) -> str:
    """The failures, in a sentence; may be empty."""
    failed = "; ".join(f"{what}: {why}" for what, why in wear.failed.items())
    return f" Failed (a cross, or no mark): {failed}." if failed else ""
