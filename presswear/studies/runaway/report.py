"""The report of the study ``runaway``: answer, one row a variant, figure, in one HTML file."""

import math
from pathlib import Path

import matplotlib

from presswear.campaign.study import Study, results_of
from presswear.show.figures import save
from presswear.show.figures.style import SETTINGS
from presswear.show.report.page import Illustration, render_page
from presswear.show.report.parts import Table
from presswear.studies.runaway.figure import two_wears
from presswear.studies.runaway.variants import CYCLES, RUNAWAY, Outcome, answer, outcome_of
from presswear.tools.files import write_bytes

_HEAD = (
    "reading",
    "first wear, A, C (µm)",
    "second wear, A, C (µm)",
    "second / first, at most",
    "peak force at A, mean a cycle (N)",
    "energy residual",
    "",
)


def _number(value: float, form: str = ".3g") -> str:
    return "-" if math.isnan(value) else format(value, form)


def _depths(depths: dict[str, float]) -> str:
    return ", ".join(_number(1e6 * depth) for depth in depths.values())


def _row(outcome: Outcome) -> tuple[str, ...]:
    verdicts = {True: "runs away", False: "does not run away", None: "cannot be told"}
    return (
        outcome.variant.label,
        _depths(outcome.first),
        _depths(outcome.second),
        _number(outcome.growth, ".2g"),
        ", ".join(f"{force:.0f}" for force in outcome.force) or "-",
        _number(outcome.residual, ".0e"),
        outcome.failure or verdicts[outcome.runs_away],
    )


def write_report(study: Study, folder: Path) -> tuple[str, Path]:
    """Write ``report.html`` and the figure into the study's folder; returns answer and path."""
    outcomes = [outcome_of(variant, result) for variant, result in results_of(study, folder)]
    clearance = study.variants[0].scene.bearings.clearance
    sentence = answer(outcomes, clearance)
    with matplotlib.rc_context(SETTINGS):
        drawing = two_wears(outcomes, clearance)
    figure = save(drawing, folder)
    text = render_page(
        "study.html",
        package="presswear.studies",
        study=study,
        answer=sentence,
        outcomes=Table(_HEAD, (("", tuple(map(_row, outcomes))),)),
        figures=[Illustration.of(figure, folder)],
        notes=[
            f"A wear runs away here when the second adds more than {RUNAWAY:g} times the depth of "
            f"the first. Each run has {CYCLES} cycles unless the row or the command says "
            "otherwise; a wear stands for 4 million. Depths scatter by some tens of per cent "
            "between runs: the motion is chaotic, and the deepest bin of a map is its noisiest. "
            "Forces are means over cycles of the peak in each stage, unworn first.",
            "Each row's own result folder is beside this file; presswear report FOLDER/ROW draws "
            "its figures.",
        ],
    )
    path = folder / "report.html"
    write_bytes(path, text.encode())
    return sentence, path
