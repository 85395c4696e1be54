"""The report of the study ``lives``: each life beside the plain one."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import matplotlib

from presswear.recording.sampling import quantile
from presswear.results.life import LifeResult
from presswear.results.result import Result
from presswear.show.figures.style import REFERENCE, SETTINGS, WIDTH, Drawing, Sheet
from presswear.show.report.page import illustrate, render_page
from presswear.show.report.parts import Table
from presswear.studies.plan import Study, Variant, results_of
from presswear.tools.files import write_bytes
from presswear.tools.numbers import large, readable

MILLION = 1e-6


@dataclass(frozen=True)
class One:
    """A variant and its life; None where it did not come so far."""

    variant: Variant
    result: Result | None

    @property
    def life(self) -> LifeResult | None:
        """Its life."""
        return None if self.result is None else self.result.life

    @property
    def is_known(self) -> bool:
        """True where a limit was passed, and the life has an interval."""
        return self.life is not None and self.life.ended == "limit" and self.life.error is not None


@dataclass(frozen=True)
class Ratio:
    """A life over another, and the half width of its logarithm; both are independent.

    The scatter of the wear coefficients is in neither: it makes both longer or shorter.
    """

    value: float
    half_width: float

    @staticmethod
    def of(life: LifeResult, other: LifeResult) -> "Ratio":
        """The first over the second."""
        errors = (own.sampling or 0.0 for own in (life, other))
        steps = (own.step or 0.0 for own in (life, other))
        return Ratio(life.strokes / other.strokes, math.hypot(*errors, *steps))

    @property
    def longer(self) -> float:
        """Probability that the first is the longer one."""
        if self.half_width == 0.0:
            return 0.5 * (1.0 + math.copysign(1.0, self.value - 1.0))
        spread = self.half_width / quantile(math.inf)
        return 0.5 * math.erfc(-math.log(self.value) / (math.sqrt(2.0) * spread))

    @property
    def words(self) -> str:
        """The ratio with its interval."""
        low, high = (self.value * math.exp(s * self.half_width) for s in (-1.0, 1.0))
        return f"{readable(self.value)} ({readable(low)} to {readable(high)})"


def answer(lives: Sequence[One]) -> str:
    """The study's answer in a sentence or two."""
    plain, *others = lives
    if not plain.is_known or plain.life is None:
        return "The life of the scene as it is, is not known: nothing can be compared."
    told = [f"As it is, it lives {plain.life.words}."]
    for one in others:
        if one.is_known and one.life is not None:
            ratio = Ratio.of(one.life, plain.life)
            told.append(
                f"{one.variant.label}: {ratio.words} times as long, longer with a probability of "
                f"{ratio.longer:.2g}."
            )
        elif one.life is not None:
            told.append(f"{one.variant.label}: {one.life.message}.")
        else:
            told.append(f"{one.variant.label}: it did not run.")
    return " ".join(told)


def row(one: One, plain: One) -> tuple[str, ...]:
    """A row of the table."""
    life, result = one.life, one.result
    if life is None or result is None:
        return (one.variant.label, "not known", "", "", "", "")
    if not one.is_known:
        told = f"more than {large(life.strokes)} strokes: {life.message}"
        return (one.variant.label, told, "", "", "", "")
    first = life.first
    assert first is not None, "a life that ended at a limit has one"
    compared = ("", "")
    if one is not plain and plain.is_known and plain.life is not None:
        ratio = Ratio.of(life, plain.life)
        compared = ratio.words, f"{ratio.longer:.2g}"
    hours = readable(life.hours(result.scene))
    return (one.variant.label, life.words, hours, first.key, *compared)


def draw(lives: Sequence[One]) -> Drawing:
    """The lives with their intervals, one below the other."""
    sheet = Sheet(figsize=(WIDTH, 0.9 + 0.32 * len(lives)), layout="constrained")
    axes = sheet.subplots()
    for place, one in enumerate(lives):
        if not one.is_known or one.life is None:
            continue
        interval = one.life.interval
        ends = [MILLION * (end or interval.value) for end in (interval.low, interval.high)]
        axes.plot(ends, [place] * 2, color=REFERENCE, linewidth=2.5)
        axes.plot([MILLION * interval.value], [place], "o", color="#0072B2")
    axes.set_yticks(range(len(lives)), [one.variant.label for one in lives])
    axes.set_ylim(len(lives) - 0.5, -0.5)
    axes.set_xlim(left=0.0)
    axes.set_xlabel("life (million strokes)")
    caption = "The life of each, with its interval of 95 %."
    return Drawing("lives.png", "Lives", caption, sheet)


def write_report(study: Study, folder: Path) -> tuple[str, Path]:
    """Write ``report.html`` and the figure into the study's folder; returns answer and path."""
    lives = [One(*own) for own in results_of(study, folder)]
    head = (
        "changed",
        "life",
        "hours",
        "first limit",
        "times as long",
        "probability that it lives longer",
    )
    with matplotlib.rc_context(SETTINGS):
        drawing = draw(lives)
    sentence = answer(lives)
    text = render_page(
        "study.html",
        package="presswear.studies",
        study=study,
        answer=sentence,
        tables={"Lives": Table(head, (("", tuple(row(one, lives[0]) for one in lives)),))},
        figures=[illustrate(drawing, folder)],
        notes=["Each life has a report of its own in the folder of its name."],
    )
    path = folder / "report.html"
    write_bytes(path, text.encode())
    return sentence, path
