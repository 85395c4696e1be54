"""Lines that the paper's figures compare, and the runs that show them."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from presswear.paper.evidence import Evidence, Measured, each_cycle
from presswear.paper.printed import JOINTS, Place
from presswear.paper.variants import BASE, FAST, FRICTION, HIGH_FRICTION, SLOW, WEAR
from presswear.results.result import Result
from presswear.results.stage import StageResult
from presswear.scene.scene import stage_name
from presswear.show.figures.style import LINES, Pen, Sheet, between

MILLIMETRES = 1e3


@dataclass(frozen=True)
class PaperLine:
    """A setting after some wears, with the colour and line it has in all figures.

    Attributes
    ----------
    setting : str
        Key of the study's settings.
    order : int
        Its place among the lines.
    own : str
        Words that set it apart from the other settings in a figure, if there are others.
    """

    setting: str
    wear_updates: int
    order: int
    own: str = ""

    @property
    def name(self) -> str:
        """Setting and stage in words."""
        stage = stage_name(self.wear_updates)
        return f"{self.own}, {stage}" if self.own else stage

    @property
    def wear_name(self) -> str:
        """Its name among lines that are all worn: several settings are all worn once."""
        return self.own or stage_name(self.wear_updates)

    @property
    def colour(self) -> str:
        """Colour of the line."""
        return LINES[self.order][0]

    def at(self, joint: str = "") -> Place:
        """The place of its quantities."""
        return Place(self.setting, self.wear_updates, joint)

    def pen(self, name: str) -> Pen:
        """The line as it is drawn, under a name in the legend."""
        return Pen(name, *LINES[self.order])


WEARS = tuple(PaperLine(WEAR, wear_updates, wear_updates) for wear_updates in range(3))
FRICTIONS = (
    PaperLine(FRICTION, 0, 0, "friction 0.05"),
    PaperLine(HIGH_FRICTION, 0, 1, "friction 0.1"),
    PaperLine(FRICTION, 1, 2, "friction 0.05"),
    PaperLine(HIGH_FRICTION, 1, 3, "friction 0.1"),
)
SPEEDS = (
    PaperLine(SLOW, 0, 0, "4π rad/s"),
    PaperLine(SLOW, 1, 1, "4π rad/s"),
    PaperLine(FAST, 0, 2, "8π rad/s"),
    PaperLine(FAST, 1, 3, "8π rad/s"),
)


Lines = tuple[PaperLine, ...]
Drawn = tuple[str, Sheet] | None
"""Caption and sheet of a figure; None where nothing ran that it shows."""


@dataclass(frozen=True)
class ShownLine:
    """A line with the run that shows it, and its stage, whose series end with the first cycle."""

    line: PaperLine
    result: Result
    stage: StageResult

    @property
    def period(self) -> float:
        """Time of a cycle, s."""
        return self.result.scene.mechanism.period

    def peak(self, quantity: str, joint: str = "") -> float:
        """Largest of the cycle, SI units: of every step, while the series leaves steps out."""
        rows = each_cycle(self.result.stages[self.line.wear_updates], joint, f"{quantity}_max")
        return float(rows[0]) if rows.size else math.nan


def shown_cycles(evidence: Evidence, lines: Iterable[PaperLine]) -> list[ShownLine]:
    """The first cycle of the first start of each line; a line without any is left out."""
    found = []
    for line in lines:
        result = evidence.at_stage(BASE, line.setting, line.wear_updates)
        if result is None or result.stages[line.wear_updates].time.size < 2:
            continue
        # The last row of a cycle may lie a rounding behind its end.
        end = result.scene.mechanism.period * (1.0 + 1e-9)
        found.append(ShownLine(line, result, between(result.stages[line.wear_updates], 0.0, end)))
    return found


def shown_joints(shown: Sequence[ShownLine]) -> list[str]:
    """The joints of the paper that have clearance in every run."""
    return [j for j in JOINTS if all(j in one.result.scene.clearance_joints for one in shown)]


def joint_title(joint: str) -> str:
    """A joint with the letter of its panel, as in the paper."""
    return f"{'ab'[JOINTS.index(joint)]}  joint {joint}"


def counted(known: Sequence[Measured]) -> str:
    """How many cycles and starts some quantities are from."""
    cycles = _range([one.samples for one in known], "cycle")
    return f"{cycles} from {_range([one.replicates for one in known], 'start')}"


def _range(counts: Sequence[int], word: str) -> str:
    low, high = min(counts), max(counts)
    return f"{low if low == high else f'{low} to {high}'} {word}{'' if high == 1 else 's'}"


ONE_CYCLE = (
    "the first cycle of the first start. The motion is chaotic, so that a single cycle is one draw "
    "of many"
)
