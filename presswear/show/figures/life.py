"""Figure of a service life: every monitored quantity over the strokes."""

from typing import Any, NamedTuple

import numpy as np
from matplotlib.ticker import MaxNLocator

from presswear.results.life import LifeResult, LimitResult, words_of
from presswear.results.result import Result
from presswear.scene.options import FOLLOWED, Service
from presswear.show.figures import style
from presswear.show.figures.style import Axes, Drawing, Pen, Stages
from presswear.tools.numbers import count_scale, short_number, unit_scale

_FAR = 4.0  # a limit this many times above the largest value is noted, not drawn
_HEADROOM = 1.15, 1.4  # height of a panel over its largest value, without and with a note
_NARROW = 0.2  # fraction of the strokes below which the name of a phase is upright
_MEAN = Pen("mean of the replicates, 95 % band", style.LINES[0][0])
_LIMIT = Pen("limit", style.LINES[1][0], (0.0, (5.0, 2.0)))
_LIFE = Pen("life with its interval", style.LINES[2][0])
_SERVICE = Pen("bushing serviced", style.REFERENCE, "dotted", 0.9)


class _Scale(NamedTuple):
    """Life with the services that were done, end of the axis in strokes, and unit of the axis."""

    life: LifeResult
    services: list[Service]
    end: float
    factor: float
    unit: str


def service_life(result: Result, stages: Stages) -> list[Drawing]:
    """Draw each monitored quantity over strokes with its band, its limits and the life."""
    life = result.life
    if life is None or len(stages) < len(result.stages):
        return []
    joints = result.scene.clearance_joints
    keys = [key for name in joints for key in life.curves if key.startswith(f"{name}.")]
    keys += [key for key in life.curves if key != "strokes" and "." not in key]
    high = life.interval.high if life.ended == "limit" else None
    end = max(float(life.curves["strokes"][-1]), high or 0.0)
    factor, unit = count_scale(end)
    if not unit and end >= 1e4:  # ticks of thousands are too long for narrow panels
        factor, unit = 1e-3, "thousand"
    scale = _Scale(life, services_done(result), end, factor, f"{unit} strokes".strip())
    sheet, panels, lowest = style.panel_list(len(keys), 1.6, sharex=True)
    for axes, key in zip(panels, keys, strict=True):
        _draw_quantity(axes, key, scale)
    for axes in lowest:
        axes.set_xlabel(f"({scale.unit})")
    pens = [_MEAN, _LIMIT, *[_LIFE] * (life.ended == "limit"), *[_SERVICE] * bool(scale.services)]
    curves = [values[:, 0] for key, values in life.curves.items() if key != "strokes"]
    first = life.first if life.ended == "limit" else None
    return style.finished(
        "life",
        sheet,
        pens,
        life=life,
        blocks=life.curves["strokes"].size,
        is_level=any(np.ptp(mean) <= 1e-9 * np.abs(mean).max() for mean in curves),
        first=first and f"{words_of(first.key)} exceeds its limit, {limit_text(first)}",
        services=scale.services,
    )


def _draw_quantity(axes: Axes, key: str, scale: _Scale) -> None:
    """Draw a quantity with its band, its limits and the life."""
    life, (joint, _, name) = scale.life, key.rpartition(".")
    values, limits = life.curves[key], [limit for limit in life.limits if limit.key == key]
    top = float(values[:, 2].max())
    near = [limit for limit in limits if limit.value <= _FAR * top or top == 0.0]
    largest = max([top, *(limit.value for limit in near)])
    factor, unit = unit_scale(FOLLOWED[name].unit, largest)
    x = scale.factor * life.curves["strokes"]
    mean, low, high = factor * values.T
    # None of these quantities is negative.
    band: dict[str, Any] = {"color": _MEAN.colour, "alpha": 0.25, "linewidth": 0.0}
    axes.fill_between(x, np.maximum(low, 0.0), high, **band)
    _MEAN.draw(axes, x, mean)
    for limit in limits:
        if limit in near:
            _LIMIT.draw(axes, (0.0, scale.factor * scale.end), (factor * limit.value,) * 2)
        else:
            style.note(axes, f"limit {limit_text(limit)}")
    headroom = _HEADROOM[len(near) < len(limits)]
    axes.set_xlim(0.0, scale.factor * scale.end)
    axes.set_ylim(0.0, headroom * factor * largest if largest > 0.0 else 1.0)
    axes.xaxis.set_major_locator(MaxNLocator(4))
    axes.set_ylabel(f"({unit})")
    is_first = life.first is not None and life.first.key == key
    title = words_of(key) + (": first" if is_first else "")
    axes.set_title(title, loc="left", fontweight="bold" if is_first else "normal")
    _draw_marks(axes, joint, scale, joint != "" and name == "wear_volume")


def _draw_marks(axes: Axes, joint: str, scale: _Scale, has_phases: bool) -> None:
    """Mark the life, the services and the phases; services and phases of the joint are named."""
    life, factor = scale.life, scale.factor
    if life.ended == "limit":
        axes.axvline(factor * life.strokes, color=_LIFE.colour, linewidth=_LIFE.width)
        interval = life.interval.scaled(factor)
        if interval.low is not None and interval.high is not None:
            axes.axvspan(interval.low, interval.high, color=_LIFE.colour, alpha=0.15, linewidth=0.0)
    small: dict[str, Any] = {"transform": axes.get_xaxis_transform(), "fontsize": 7.0}
    for service in scale.services:
        axes.axvline(factor * service.strokes, **_SERVICE.look)
        if service.joint == joint:
            word = "turned" if service.is_turned else "replaced"
            box = {"facecolor": "white", "alpha": 0.8, "edgecolor": "none", "pad": 0.5}
            look = small | {"rotation": 90.0, "ha": "right", "va": "bottom", "bbox": box}
            axes.text(factor * service.strokes, 0.03, word, **look)
    for k, phase in enumerate(one for one in life.phases if has_phases and one.joint == joint):
        ends = factor * phase.since, factor * phase.until
        if k % 2:
            axes.axvspan(*ends, color=style.MUTED, alpha=0.12, linewidth=0.0)
        is_narrow = phase.until - phase.since < _NARROW * scale.end
        look = small | {"rotation": 90.0 if is_narrow else 0.0, "ha": "center", "va": "top"}
        axes.text(0.5 * sum(ends), 0.96, phase.name, **look)


def services_done(result: Result) -> list[Service]:
    """Return the services of bushings during the simulated life."""
    settings, life = result.scene.life, result.life
    if settings is None or life is None:
        return []
    last = float(life.curves["strokes"][-1])
    services = settings.services(result.scene.clearance_joints)
    return [service for service in services if service.strokes <= last]


def limit_text(limit: LimitResult) -> str:
    """Return the value of a limit in a unit that reads well."""
    factor, unit = unit_scale(limit.unit, limit.value)
    return f"{short_number(factor * limit.value)} {unit}"
