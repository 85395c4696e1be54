"""The report of the study ``paper``: one HTML file with every number, claim and figure."""

from pathlib import Path

from presswear.campaign.study import Study, results_of
from presswear.results.result import Result
from presswear.show.figures import save
from presswear.show.report.origin import convention_set, conventions, parameters, provenance
from presswear.show.report.page import Illustration, render_page
from presswear.studies.paper.evidence import Evidence
from presswear.studies.paper.figures import paper_drawings
from presswear.studies.paper.report.chosen import (
    distances_table,
    failures_of,
    fit_table,
    geometry_table,
    sensitivity_table,
    stopped_table,
)
from presswear.studies.paper.report.numbers import numbers_table, ranges_table, ratios_table
from presswear.studies.paper.report.runs import runs_table
from presswear.studies.paper.report.summary import counts_table, findings, headline
from presswear.studies.paper.report.trends import judged
from presswear.studies.paper.variants import BASE, STARTS
from presswear.tools.files import write_bytes


def write_report(study: Study, folder: Path) -> tuple[str, Path]:
    """Write ``report.html`` and its figures into a study's folder; returns answer and path."""
    results = {v.key: found for v, found in results_of(study, folder) if found is not None}
    evidence = Evidence.of(results)
    figures = [
        Illustration.of(save(drawing, folder / "figures"), folder / "figures")
        for drawing in paper_drawings(evidence)
    ]
    text = render(study, results, evidence, figures)
    path = folder / "report.html"
    write_bytes(path, text.encode())
    return headline(evidence, judged(evidence)), path


def render(
    study: Study,
    results: dict[str, Result],
    evidence: Evidence,
    figures: list[Illustration],
) -> str:
    """The page as text."""
    claims = judged(evidence)
    failures = failures_of(results)
    first = next((found for place, found in evidence.runs.items() if place[0] == BASE), None)
    numbers, remarks = numbers_table(evidence)
    return render_page(
        "paper.html",
        study=study,
        missing=len(study.variants) - len(results),
        starts=STARTS,
        headline=headline(evidence, claims),
        findings=findings(evidence, failures),
        counts=counts_table(claims),
        claims=claims,
        numbers=numbers,
        remarks=remarks,
        ratios=ratios_table(evidence),
        ranges=ranges_table(evidence),
        figures=figures,
        geometries=geometry_table(evidence),
        fit=fit_table(evidence),
        sensitivities=sensitivity_table(evidence, failures),
        stopped=stopped_table(evidence),
        distances=distances_table(evidence),
        runs=runs_table(study, results),
        convention_set="" if first is None else convention_set(first.scene.conventions),
        conventions=None if first is None else conventions(first),
        parameters=None if first is None else parameters(first),
        provenance=None if first is None else provenance(first),
    )
