"""Figure of a service life: every followed number over strokes."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from matplotlib.ticker import MaxNLocator

from presswear.results.life import UNITS, LifeResult, LimitResult, words_of
from presswear.results.result import Result
from presswear.scene.options import Service
from presswear.show.figures.style import (
    LINES,
    MUTED,
    REFERENCE,
    WIDTH,
    Axes,
    Drawing,
    Pen,
    Sheet,
    Stages,
    legend,
    note,
    wrapped,
)
from presswear.tools.numbers import count_scale, given, large, unit_scale

FILE = "life.png"
_COLUMNS = 3
_TALLEST = 9.0
"""Greatest height that fits an A4 page with its caption, inches."""
_FAR = 4.0
"""A limit this many times as high as all that was reached is told, not drawn."""
_ROOM = 1.4
"""Height of a panel with a remark, parts of what was reached."""
_NARROW = 0.2
"""Part of the strokes below which a phase has no room for its name."""

_MEAN = Pen("mean of the starts, 95 % band", LINES[0][0])
_LIMIT = Pen("limit", LINES[1][0], (0.0, (5.0, 2.0)))
_LIFE = Pen("life with its interval", LINES[2][0])
_SERVICE = Pen("bush seen to", REFERENCE, "dotted", 0.9)


@dataclass(frozen=True)
class _Panels:
    """What all panels share.

    Attributes
    ----------
    life : LifeResult
    services : tuple of Service
        That were done.
    end : float
        Strokes up to which they go.
    """

    life: LifeResult
    services: tuple[Service, ...]
    end: float

    @property
    def factor(self) -> float:
        """Units of the axis in a stroke."""
        return self._scale[0]

    @property
    def label(self) -> str:
        """Label of the axis of strokes."""
        return f"({self._scale[1]} strokes)".replace("( ", "(")

    @property
    def _scale(self) -> tuple[float, str]:
        factor, word = count_scale(self.end)
        # Ticks of thousands are too long for panels so narrow.
        return (1e-3, "thousand") if not word and self.end >= 1e4 else (factor, word)

    def draw(self, axes: Axes, key: str) -> None:
        """Draw a followed number with its band, its limits and the life."""
        life, joint = self.life, key.rpartition(".")[0]
        values = life.curves[key]
        limits = [own for own in life.limits if own.key == key]
        top = float(values[:, 2].max())
        seen = [own for own in limits if own.value <= _FAR * top or top == 0.0]
        largest = max([top, *(own.value for own in seen)])
        scale, unit = unit_scale(UNITS[key.rpartition(".")[2]], largest)
        x = self.factor * life.curves["strokes"]
        mean, low, high = scale * values.T
        # None of these numbers has a sign.
        low = np.maximum(low, 0.0)
        axes.fill_between(x, low, high, color=_MEAN.colour, alpha=0.25, linewidth=0.0)
        _MEAN.draw(axes, x, mean)
        for own in limits:
            if own in seen:
                _LIMIT.draw(axes, (0.0, self.factor * self.end), (scale * own.value,) * 2)
            else:
                note(axes, f"limit {limit_told(own)}")
        axes.set_xlim(0.0, self.factor * self.end)
        room = 1.15 if len(seen) == len(limits) else _ROOM
        axes.set_ylim(0.0, room * scale * largest if largest > 0.0 else 1.0)
        axes.xaxis.set_major_locator(MaxNLocator(4))
        axes.set_ylabel(f"({unit})")
        is_first = life.first is not None and life.first.key == key
        title = wrapped(words_of(key), 0.7 * WIDTH / _COLUMNS)
        if is_first:
            title += ": first"
        axes.set_title(title, loc="left", fontweight="bold" if is_first else "normal")
        self._mark(axes, joint)
        if key == f"{joint}.wear_volume":
            self._shade(axes, joint)

    def _mark(self, axes: Axes, joint: str) -> None:
        """Mark the life, and what was done to bushes: with a word where it was to this joint's."""
        life = self.life
        if life.ended == "limit":
            axes.axvline(self.factor * life.strokes, color=_LIFE.colour, linewidth=_LIFE.width)
            found = life.interval
            if found.low is not None and found.high is not None:
                ends = (self.factor * found.low, self.factor * found.high)
                axes.axvspan(*ends, color=_LIFE.colour, alpha=0.15, linewidth=0.0)
        for service in self.services:
            place = self.factor * service.strokes
            axes.axvline(place, **_SERVICE.look)
            if service.joint == joint:
                word = "turned" if service.is_turned else "replaced"
                axes.text(
                    place,
                    0.03,
                    word,
                    transform=axes.get_xaxis_transform(),
                    ha="right",
                    va="bottom",
                    fontsize=7.0,
                    rotation=90.0,
                    bbox={"facecolor": "white", "alpha": 0.8, "edgecolor": "none", "pad": 0.5},
                )

    def _shade(self, axes: Axes, joint: str) -> None:
        """Shade every second phase of a joint's wear, and name them."""
        phases = [own for own in self.life.phases if own.joint == joint]
        for k, own in enumerate(phases):
            ends = self.factor * own.since, self.factor * own.until
            if k % 2:
                axes.axvspan(*ends, color=MUTED, alpha=0.12, linewidth=0.0)
            narrow = own.until - own.since < _NARROW * self.end
            axes.text(
                0.5 * sum(ends),
                0.96,
                own.name,
                transform=axes.get_xaxis_transform(),
                ha="center",
                va="top",
                fontsize=7.0,
                rotation=90.0 if narrow else 0.0,
            )


def service_life(result: Result, stages: Stages) -> list[Drawing]:
    """Each followed number over strokes with its band, its limits and the life."""
    life = result.life
    if life is None or len(stages) < len(result.stages):
        return []
    rows = _rows(life, result.scene.clearance_joints)
    high = life.interval.high if life.ended == "limit" else None
    end = max(float(life.curves["strokes"][-1]), high or 0.0)
    panels = _Panels(life, tuple(services_done(result)), end)
    inches = min(1.5, (_TALLEST - 0.6) / len(rows))
    sheet = Sheet(figsize=(WIDTH, 0.6 + inches * len(rows)), layout="constrained")
    grid = sheet.subplots(len(rows), _COLUMNS, squeeze=False, sharex=True)
    for k, (keys, below) in enumerate(pairwise([*rows, []])):
        for axes, key in zip(grid[k], keys, strict=False):
            panels.draw(axes, key)
        for column in range(_COLUMNS):
            if column >= len(keys):
                grid[k, column].set_axis_off()
            elif column >= len(below):
                grid[k, column].tick_params(labelbottom=True)
                grid[k, column].set_xlabel(panels.label)
    pens = [_MEAN, _LIMIT, *[_LIFE] * (life.ended == "limit"), *[_SERVICE] * bool(panels.services)]
    legend(sheet, pens, "outside upper center")
    return [Drawing(FILE, "Service life", _caption(result, life), sheet)]


def _rows(life: LifeResult, joints: Sequence[str]) -> list[list[str]]:
    """Keys of the panels: a row of each joint, and of the press as many as it needs."""
    rows = [[key for key in life.curves if key.startswith(f"{name}.")] for name in joints]
    common = [key for key in life.curves if key != "strokes" and "." not in key]
    rows += [common[k : k + _COLUMNS] for k in range(0, len(common), _COLUMNS)]
    return [row for row in rows if row]


def services_done(result: Result) -> list[Service]:
    """What was done to bushes while the wear was followed."""
    asked, life = result.scene.life, result.life
    if asked is None or life is None:
        return []
    last = float(life.curves["strokes"][-1])
    services = asked.services(result.scene.clearance_joints)
    return [service for service in services if service.strokes <= last]


def limit_told(limit: LimitResult, value: float | None = None) -> str:
    """The value of a limit, or another of the same number, in a unit that reads well."""
    scale, unit = unit_scale(limit.unit, limit.value)
    return f"{given(scale * (limit.value if value is None else value))} {unit}"


def _is_level(life: LifeResult, key: str) -> bool:
    mean = life.curves[key][:, 0]
    return bool(np.ptp(mean) <= 1e-9 * np.abs(mean).max())


def _caption(result: Result, life: LifeResult) -> str:
    words = [
        "What is followed over the strokes that the wear stands for: surfaces of every start at "
        f"the ends of {life.curves['strokes'].size} blocks of cycles, and means of the strokes run "
        "on them, smoothed."
    ]
    if any(_is_level(life, key) for key in life.curves if key != "strokes"):
        words.append("A level line: no trend stands out of the scatter from stroke to stroke.")
    if life.ended == "limit" and life.first is not None:
        first = life.first
        words.append(
            f"First {words_of(first.key)} passes its limit, "
            f"{limit_told(first)}, after {large(life.strokes)} strokes."
        )
    else:
        words.append(f"No limit is passed within {large(life.strokes)} strokes.")
    if life.phases:
        words.append("Names and shades in the panels of the worn volume tell its phases.")
    words += [f"After {large(own.strokes)} strokes: {own.words}." for own in services_done(result)]
    return " ".join(words)
