"""Report page of the paper's study: verdicts, printed numbers, figures, assumptions and runs."""

from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path

import presswear as pw
from presswear.paper import settings, verdicts
from presswear.paper.errors import error_table
from presswear.paper.evidence import Evidence
from presswear.paper.figures import drawings
from presswear.paper.printed import COMPARISONS, DOUBTFUL, HIGHLIGHTS, TEXTS
from presswear.paper.settings import BASE
from presswear.paper.tables import (
    SENSITIVE_RATIOS,
    claim_table,
    count_table,
    depth_factors,
    fit,
    fit_table,
    geometry_table,
    long_table,
    number_table,
    range_table,
    ratio_table,
    run_table,
    sensitivity_table,
)
from presswear.paper.verdicts import Judged, compared
from presswear.show import page
from presswear.show.figures.style import TEMPLATES
from presswear.show.page import Section, Table, text_of
from presswear.show.report import made_by, provenance_table
from presswear.show.scene_tables import setting_tables
from presswear.tools.files import inside, write_bytes
from presswear.tools.numbers import readable

TITLE = "Chen, Tang and Gao's worn press, computed again"
RUNAWAY = 10.0  # a second wear that adds so many times the depth of the first runs away


def write_report(results: Mapping[str, pw.Result], folder: Path) -> tuple[str, Path]:
    """Write ``report.html`` and its figures into a folder; return the answer and the path."""
    evidence = Evidence(results)
    path = folder / "report.html"
    claims = verdicts.judge(evidence)
    answer = headline(evidence, claims)
    sections = page_sections(evidence, claims)
    figures = page.illustrated(drawings(evidence), inside(folder, "figures"))
    sections.insert(3, Section("Figures 8 to 25", figures=figures, is_open=True))
    origin = next(map(_made_by, results.values()), "")
    screen = page.FirstScreen(made_by=origin)
    text = page.render_page(TITLE, screen, sections, [answer])
    write_bytes(path, text.encode())
    return answer, path


def _made_by(result: pw.Result) -> str:
    """Return the module that ran the study, the version of presswear and the date."""
    origin = {**result.provenance, "command": "python -m presswear.paper"}
    return made_by(origin)


def failures_of(evidence: Evidence) -> dict[str, str]:
    """Return the messages of the runs that failed, by case."""
    return {
        name.partition("--")[0]: result.message
        for name, result in evidence.results.items()
        if result.status == "failed"
    }


def page_sections(evidence: Evidence, claims: Sequence[Judged]) -> list[Section]:
    """Return the sections of the page without the figures of the paper."""
    failures = failures_of(evidence)
    runs: dict[str, Table | None] = {"": run_table(evidence)}
    first = next(iter(evidence.results.values()), None)
    if first is not None:
        runs["Parameters of the first setting"] = setting_tables(first)["parameters"]
        runs["Provenance"] = provenance_table(first)
    numbers = {
        "": number_table(evidence),
        "Ratios of depths": ratio_table(evidence),
        "Ranges of wear": range_table(evidence),
    }
    assumptions = {
        "Geometries": geometry_table(evidence),
        "Wear coefficient": fit_table(evidence),
        "One assumption changed": sensitivity_table(evidence, failures),
    }
    claim_text = TEXTS["claims"].format(
        comparisons=COMPARISONS, least=100 * verdicts.NO_EFFECT
    )
    assumption_text = TEXTS["assumptions"].format(ratios=SENSITIVE_RATIOS)
    verdict_counts = {"Verdicts": count_table(claims)}
    contents: list[tuple[str, Sequence[str], Mapping[str, Table | None]]] = [
        ("In short", findings(evidence, failures), verdict_counts),
        ("Claims on trends", [claim_text], {"": claim_table(evidence, claims)}),
        ("Every printed number of sections 5.3 and 5.4", [TEXTS["numbers"]], numbers),
        ("Assumptions, their fit and their effect", [assumption_text], assumptions),
        ("Errors of the paper", [TEXTS["errors"]], {"": error_table(evidence)}),
        (
            "Accuracy of the statistics",
            [TEXTS["statistics"]],
            {"": long_table(evidence)},
        ),
        ("Runs", (), runs),
    ]
    sections: list[Section] = []
    for heading, texts, tables in contents:
        filled = [(name, table) for name, table in tables.items() if table]
        sections.append(Section(heading, texts, filled, is_open=not sections))
    return sections


def headline(evidence: Evidence, claims: Sequence[Judged]) -> str:
    """Return the answer of the study in a few sentences."""
    peaks = Counter[str]()
    for number, position in verdicts.positions(evidence):
        if number.quantity not in ("depth", "angle"):
            peaks[position] += 1
    text = TEMPLATES.from_string(TEXTS["headline"]).render(
        claims=len(claims),
        count=Counter(claim.verdict() for claim in claims),
        same=sum(claim.geometry.startswith("same") for claim in claims),
        peaks=peaks,
    )
    return text.strip()


def findings(evidence: Evidence, failures: Mapping[str, str]) -> list[str]:
    """Return the most important results, each with its numbers, as far as they were computed."""
    # positions of printed peaks, if the stage is known
    new = Counter[str]()
    worn = Counter[str]()
    for number, position in verdicts.positions(evidence):
        if len(number.places) == 1 and position in ("inside", "above", "below"):
            counts = worn if number.place.wear_updates else new
            counts[position] += 1
    ours = {}
    effects = {}
    printed = {}
    for name, comparison in HIGHLIGHTS.items():
        ours[name] = compared(evidence, BASE, comparison)
        wide = compared(evidence, BASE, comparison, COMPARISONS)
        effects[name] = TEXTS["effects"][verdicts.verdict(wide, comparison)]
        printed[name] = f"printed: {readable(comparison.printed)}"
    second = ours["second wear"]
    text = TEMPLATES.from_string(TEXTS["findings"]).render(
        ours=ours,
        text={name: text_of(estimate) for name, estimate in ours.items()},
        printed=printed,
        # The ratio of total depths includes the first wear, so that 1 is subtracted.
        runs_away=second is not None and second.mean - 1.0 > RUNAWAY,
        new=new,
        worn=worn,
        effect=effects,
        fit=fit(depth_factors(evidence, BASE)),
        doubtful=len(DOUBTFUL),
        failure=failures.get(settings.PAPER_STEP, ""),
    )
    return [line for line in text.splitlines() if line.strip()]
