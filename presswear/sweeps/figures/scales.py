"""Axes of factors and measures: units that read well, logarithms, words."""

import math
from dataclasses import dataclass

import numpy as np
from matplotlib.axis import Axis
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from presswear.show.figures.style import Axes, wrapped
from presswear.sweeps.inputs import Inputs
from presswear.sweeps.table import Column
from presswear.tools.arrays import Array
from presswear.tools.numbers import readable, superscript, unit_scale

_LEAST, _MOST = 1e-2, 1e5
"""Numbers outside are told as powers of ten."""
_EDGE = 0.03
"""Room beside the outermost values, part of the range."""


@dataclass(frozen=True)
class Scale:
    """A quantity as a picture shows it.

    Attributes
    ----------
    column : Column
    factor : float
        From SI.
    unit : str
    low, high : float
        Range that is shown, in that unit.
    is_logarithmic : bool
    """

    column: Column
    factor: float
    unit: str
    low: float
    high: float
    is_logarithmic: bool = False

    @staticmethod
    def of(column: Column, values: Array, *, is_logarithmic: bool = False) -> "Scale":
        """The scale of some values, SI."""
        told = values[np.isfinite(values)] if np.isfinite(values).any() else np.zeros(1)
        largest = float(np.abs(told).max(initial=0.0))
        factor, unit = unit_scale(column.unit, largest) if largest > 0.0 else (1.0, column.unit)
        power = 3 * math.floor(math.log10(factor * largest) / 3.0) if largest > 0.0 else 0
        # Where no unit makes it a number that is read at once, a power of ten does.
        if largest > 0.0 and not (column.words or _LEAST <= factor * largest < _MOST):
            factor, unit = factor / 10.0**power, f"10{superscript(power)} {unit}".rstrip()
        low, high = (factor * float(end) for end in (told.min(), told.max()))
        return Scale(column, factor, unit, low, high, is_logarithmic)

    def told(self, value: float) -> str:
        """A value, SI, as a text with its unit; a word as it is."""
        if self.column.words:
            return self.column.words[int(value)]
        between = "·" if self.unit.startswith("10") else " "
        return f"{readable(self.factor * value)}{between}{self.unit}".rstrip()

    def number(self, value: float, digits: int = 3) -> str:
        """A value, SI, as a text without its unit; a word as it is, a dash for none."""
        if self.column.words and not np.isnan(value):
            return self.column.words[int(value)]
        return readable(self.factor * value, digits)

    @property
    def label(self) -> str:
        """Name and unit."""
        return f"{self.column.key} ({self.unit})" if self.unit else self.column.key

    def grid(self, count: int) -> Array:
        """Values over the range, SI."""
        space = np.geomspace if self.is_logarithmic else np.linspace
        return np.asarray(space(self.low, self.high, count) / self.factor)

    def along_x(self, axes: Axes, width: float) -> None:
        """Set up the x axis of a panel of some width, inches."""
        axes.set_xlabel(wrapped(self.label.replace("_", " "), width))
        if self.column.words:
            axes.set_xticks(range(len(self.column.words)), self.column.words)
        elif self.is_logarithmic:
            axes.set_xscale("log")
            _plain(axes.xaxis)
        axes.set_xlim(*self._room())

    def along_y(self, axes: Axes, height: float) -> None:
        """Set up the y axis of a panel of some height, inches."""
        axes.set_ylabel(wrapped(self.label.replace("_", " "), height))
        if self.column.words:
            axes.set_yticks(range(len(self.column.words)), self.column.words)
        elif self.is_logarithmic:
            axes.set_yscale("log")
            _plain(axes.yaxis)
        axes.set_ylim(*self._room())

    def _room(self) -> tuple[float, float]:
        if self.column.words:
            return -0.5, len(self.column.words) - 0.5
        if self.is_logarithmic:
            room = (self.high / self.low) ** _EDGE
            return self.low / room, self.high * room
        room = _EDGE * (self.high - self.low) or 0.5 * abs(self.high) or 1.0
        return self.low - room, self.high + room


def _plain(axis: Axis) -> None:
    """Ticks of a logarithmic axis as plain numbers, few enough to be read."""
    axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axis.set_minor_formatter(NullFormatter())


def scales_of(factors: tuple[Column, ...], points: Array) -> list[Scale]:
    """The scale of each factor over points, logarithmic where these lie more evenly so."""
    inputs = Inputs.of(factors, points)
    return [
        Scale.of(factor, values, is_logarithmic=bool(logarithmic))
        for factor, values, logarithmic in zip(
            factors, points.T, inputs.is_logarithmic, strict=True
        )
    ]


def file_part(measure: Column) -> str:
    """The key of a measure as a part of a file's name."""
    return "".join(c if c.isalnum() or c in "-_" else "-" for c in measure.key)
