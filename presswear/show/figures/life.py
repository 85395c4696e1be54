"""Figure of a service life: every monitored quantity over the strokes."""

import numpy as np
from matplotlib.ticker import MaxNLocator

from presswear.results.life import LifeResult, LimitResult, in_diameter, words_of
from presswear.results.result import Result
from presswear.scene.options import LIFE_QUANTITIES, Service
from presswear.show.figures import style
from presswear.show.figures.style import Axes, Drawing, Pen, Stages
from presswear.tools.arrays import Array
from presswear.tools.numbers import count_scale, short_number, unit_scale

_FAR = 4.0  # a limit this many times above the largest value is noted, not drawn
# height of a panel over its largest value
_HEADROOM = 1.15
_HEADROOM_WITH_NOTE = 1.4
_ROUND_OFF = 1e-9
_MEAN = Pen("mean of the replicates, 95 % band", style.LINES[0][0])
_LIMIT = Pen("limit", style.LINES[1][0], (0.0, (5.0, 2.0)))
_LIFE = Pen("life with its interval", style.LINES[2][0])
_SERVICE = Pen("bushing serviced", style.REFERENCE, "dotted", 0.9)


def service_life(result: Result, stages: Stages) -> list[Drawing]:
    """Draw each monitored quantity over strokes with its band, its limits and the life."""
    life = result.life
    services = services_done(result)
    if life is None or not life.curves or len(stages) < len(result.stages):
        return []
    keys = []
    for joint in result.scene.wearing_joints:
        keys += [key for key in life.curves if key.startswith(f"{joint}.")]
    keys += [key for key in life.curves if key != "strokes" and "." not in key]
    high = life.interval.high if life.ended == "limit" else None
    end = max(float(life.curves["strokes"][-1]), high or 0.0)
    factor, unit = count_scale(end)
    if not unit and end >= 1e4:  # ticks of thousands are too long for narrow panels
        factor = 1e-3
        unit = "thousand"
    sheet, panels, lowest = style.panel_list(len(keys), 1.6, sharex=True)
    for axes, key in zip(panels, keys, strict=True):
        _draw_quantity(axes, key, life, end)
        _draw_marks(axes, key, life, services)
        axes.set_xlim(0.0, end)
        axes.xaxis.set_major_locator(MaxNLocator(4))
        axes.xaxis.set_major_formatter(lambda value, _: f"{factor * value:g}")
    for axes in lowest:
        axes.set_xlabel(f"({unit} strokes)" if unit else "(strokes)")
    pens = [_MEAN, _LIMIT]
    if life.ended == "limit":
        pens.append(_LIFE)
    if services:
        pens.append(_SERVICE)
    first = ""
    if life.ended == "limit" and life.first is not None:
        limit = limit_text(life.first)
        first = f"{words_of(life.first.key)} exceeds its limit, {limit}"
    return style.finished(
        "life",
        sheet,
        pens,
        life=life,
        blocks=life.curves["strokes"].size,
        is_level=any(_is_level(life.curves[key][:, 0]) for key in keys),
        first=first,
        services=services,
    )


def _is_level(values: Array) -> bool:
    """Return whether values differ only by round-off, relative to the largest value."""
    return bool(np.ptp(values) <= _ROUND_OFF * np.abs(values).max())


def _draw_quantity(axes: Axes, key: str, life: LifeResult, end: float) -> None:
    """Draw a quantity with its band and its limits."""
    mean, low, high = life.curves[key].T
    strokes = life.curves["strokes"]
    limits = [limit for limit in life.limits if limit.key == key]
    top = float(high.max())
    near = [limit for limit in limits if limit.value <= _FAR * top or top == 0.0]
    largest = max([top, *(limit.value for limit in near)])
    # None of these quantities is negative.
    axes.fill_between(
        strokes,
        np.maximum(low, 0.0),
        high,
        color=_MEAN.colour,
        alpha=0.25,
        linewidth=0.0,
    )
    _MEAN.draw(axes, strokes, mean)
    for limit in limits:
        if limit in near:
            _LIMIT.draw(axes, (0.0, end), (limit.value, limit.value))
        else:
            style.note(axes, f"limit {limit_text(limit)}")
    has_note = len(near) < len(limits)
    headroom = _HEADROOM_WITH_NOTE if has_note else _HEADROOM
    axes.set_ylim(0.0, headroom * largest if largest > 0.0 else 1.0)
    style.label_values(axes, "", LIFE_QUANTITIES[key.rpartition(".")[2]].unit, largest)
    is_first = life.first is not None and life.first.key == key
    title = words_of(key) + (": first" if is_first else "")
    axes.set_title(title, fontweight="bold" if is_first else "normal")


def _draw_marks(
    axes: Axes, key: str, life: LifeResult, services: list[Service]
) -> None:
    """Mark the life and the services; beside a worn volume, name those of the joint."""
    joint, _, _ = key.rpartition(".")
    if life.ended == "limit":
        axes.axvline(life.strokes, color=_LIFE.colour, linewidth=_LIFE.width)
        if life.interval.low is not None and life.interval.high is not None:
            axes.axvspan(
                life.interval.low,
                life.interval.high,
                color=_LIFE.colour,
                alpha=0.15,
                linewidth=0.0,
            )
    box = {"facecolor": "white", "alpha": 0.8, "edgecolor": "none", "pad": 0.5}
    for service in services:
        axes.axvline(service.strokes, **_SERVICE.line_style)
        if service.joint == joint:
            axes.text(
                service.strokes,
                0.03,
                "rotated" if service.is_rotated else "replaced",
                transform=axes.get_xaxis_transform(),
                fontsize=7.0,
                rotation=90.0,
                ha="right",
                va="bottom",
                bbox=box,
            )


def services_done(result: Result) -> list[Service]:
    """Return the services during the simulated life."""
    settings = result.scene.life
    life = result.life
    if settings is None or life is None or not life.curves:
        return []
    last = float(life.curves["strokes"][-1])
    scene = result.scene
    guides = [guide.name for guide in scene.worn_guides]
    services = settings.services(scene.loose_pins, guides)
    return [service for service in services if service.strokes <= last]


def limit_text(limit: LimitResult) -> str:
    """Return the value of a limit in a unit that reads well."""
    factor, unit = unit_scale(limit.unit, limit.value)
    text = f"{short_number(factor * limit.value)} {unit}"
    return text + in_diameter(limit.key, limit.value)
