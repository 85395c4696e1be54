"""What the paper's figures compare, and the runs that show it."""

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

from presswear.record.observe import CYCLE_FIXED, CYCLE_JOINT
from presswear.results.result import Result
from presswear.results.stage import StageResult
from presswear.scene.scene import stage_name
from presswear.show.figures.style import LINES, Axes, LineStyle, Pen, until
from presswear.studies.paper.evidence import Evidence, Measured, Place
from presswear.studies.paper.printed import (
    FAST,
    FRICTION,
    HIGH_FRICTION,
    PRINTED,
    SLOW,
    WEAR,
    Printed,
)
from presswear.studies.paper.variants import BASE

JOINTS = ("A", "C")
MILLIMETRES = 1e3


@dataclass(frozen=True)
class Line:
    """A setting after some wears, with the colour and line it has in all figures.

    Attributes
    ----------
    setting : str
        Key of the study's settings.
    wears : int
    own : str
        What sets it apart from the other settings in a figure, if there are others.
    place : int
        Its place among the lines.
    """

    setting: str
    wears: int
    own: str
    place: int

    @property
    def name(self) -> str:
        """Setting and stage in words."""
        stage = stage_name(self.wears)
        return f"{self.own}, {stage}" if self.own else stage

    @property
    def wear_name(self) -> str:
        """What sets it apart among lines that are all worn: of several settings, all once."""
        return self.own or stage_name(self.wears)

    @property
    def colour(self) -> str:
        """Of the line."""
        return LINES[self.place][0]

    @property
    def dashes(self) -> LineStyle:
        """Of the line."""
        return LINES[self.place][1]

    def at(self, joint: str = "") -> Place:
        """Where its quantities are."""
        return Place(self.setting, self.wears, joint)

    def pen(self, name: str) -> Pen:
        """The line, under a name in the legend."""
        return Pen(name, self.colour, self.dashes)


WEARS = tuple(Line(WEAR, wears, "", wears) for wears in range(3))
FRICTIONS = (
    Line(FRICTION, 0, "friction 0.05", 0),
    Line(HIGH_FRICTION, 0, "friction 0.1", 1),
    Line(FRICTION, 1, "friction 0.05", 2),
    Line(HIGH_FRICTION, 1, "friction 0.1", 3),
)
SPEEDS = (
    Line(SLOW, 0, "4π rad/s", 0),
    Line(SLOW, 1, "4π rad/s", 1),
    Line(FAST, 0, "8π rad/s", 2),
    Line(FAST, 1, "8π rad/s", 3),
)


@dataclass(frozen=True)
class Shown:
    """A line with the run that shows it.

    Attributes
    ----------
    stage : StageResult
        Its series end with the first cycle.
    """

    line: Line
    result: Result
    stage: StageResult

    @property
    def period(self) -> float:
        """Of a cycle, s."""
        return self.result.scene.mechanism.period

    def peak(self, quantity: str, joint: str = "") -> float:
        """Largest of the cycle, SI units: of every step, while the series leaves steps out."""
        rows = self.stage.arrays["cycles"]
        if joint:
            own = len(CYCLE_JOINT) * self.result.scene.clearance_joints.index(joint)
            column = len(CYCLE_FIXED) + own + CYCLE_JOINT.index(f"{quantity}_max")
        else:
            column = CYCLE_FIXED.index(f"{quantity}_max")
        return float(rows[0, column]) if len(rows) else math.nan


def shown_cycles(evidence: Evidence, lines: Iterable[Line]) -> list[Shown]:
    """The first cycle of the first start of each line; a line without any is left out."""
    found = []
    for line in lines:
        result = evidence.at_stage(BASE, line.setting, line.wears)
        if result is not None and result.stages[line.wears].time.size > 1:
            # The last row of a cycle may lie a rounding behind its end.
            end = result.scene.mechanism.period * (1.0 + 1e-9)
            found.append(Shown(line, result, until(result.stages[line.wears], end)))
    return found


def shown_joints(shown: Sequence[Shown]) -> list[str]:
    """The joints of the paper that have clearance in every run."""
    open_in_all = [set(one.result.scene.clearance_joints) for one in shown]
    return [joint for joint in JOINTS if all(joint in found for found in open_in_all)]


def differing(known: Iterable[Measured]) -> str:
    """What the intervals are where starts differ, as a sentence; may be empty."""
    if not any(one.differ for one in known):
        return ""
    return (
        " Where starts differ by more than their cycles explain, each start is one sample, and "
        "the interval is wide."
    )


def printed_in(number: int) -> Iterator[Printed]:
    """What the paper prints of its figure."""
    return (one for one in PRINTED if one.figure.rstrip("abc") == str(number))


def misprints(number: int) -> str:
    """What is wrong with the printed numbers of a figure, as a sentence; may be empty."""
    parts = (part for one in printed_in(number) for part in one.misprint.split("; "))
    found = list(dict.fromkeys(part for part in parts if part))
    return f" In print: {'; '.join(found)}." if found else ""


def counted(known: Iterable[Measured | None]) -> str:
    """How many cycles and starts some quantities are from."""
    found = [one for one in known if one is not None]
    cycles = _range([one.samples for one in found], "cycle")
    return f"{cycles} from {_range([one.starts for one in found], 'start')}"


def _range(counts: Sequence[int], word: str) -> str:
    low, high = min(counts), max(counts)
    return f"{low if low == high else f'{low} to {high}'} {word}{'' if high == 1 else 's'}"


def letter(axes: Axes, text: str) -> None:
    """The letter of a panel, as in the paper, in its upper left corner."""
    axes.text(
        0.008,
        0.95,
        text,
        transform=axes.transAxes,
        ha="left",
        va="top",
        fontweight="bold",
        bbox={"facecolor": "white", "alpha": 0.8, "edgecolor": "none", "pad": 1.0},
    )


ONE_CYCLE = (
    "the first cycle of the first start. The motion is chaotic, so that a single cycle is one draw "
    "of many"
)
