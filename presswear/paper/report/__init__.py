"""The report of the study ``paper``: one HTML file with every number, claim and figure."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from presswear.paper.evidence import Evidence
from presswear.paper.figures import drawers
from presswear.paper.report.chosen import (
    distances_table,
    fit_table,
    geometry_table,
    sensitivity_table,
    stopped_table,
)
from presswear.paper.report.numbers import numbers_table, ranges_table, ratios_table
from presswear.paper.report.summary import STYLES, counts_table, detail, findings, headline
from presswear.paper.variants import BASE, JUDGED, SETTINGS, STARTS, label_of, variant_key
from presswear.paper.verdicts import judged
from presswear.results.result import Result
from presswear.scene.scene import Scene
from presswear.show.page import Illustration, Table, illustrated, render_page
from presswear.show.report_tables import (
    convention_set,
    convention_table,
    parameter_table,
    provenance_table,
)
from presswear.tools.files import inside, write_bytes
from presswear.tools.numbers import readable, whole

TITLE = "Chen, Tang and Gao's worn press, computed again"
QUESTION = (
    "Which numbers and claims of the paper hold when every contact is resolved and every "
    "peak is known for the draw that it is?"
)


def write_report(
    scenes: Mapping[str, Scene], results: Mapping[str, Result], folder: Path
) -> tuple[str, Path]:
    """Write ``report.html`` and its figures into a folder; return the answer and the path."""
    evidence = Evidence(results)
    figures = illustrated(drawers(evidence), inside(folder, "figures"))
    path = folder / "report.html"
    write_bytes(path, render(words_of(tuple(scenes), evidence), figures).encode())
    return headline(evidence, judged(evidence)), path


def render(words: dict[str, Any], figures: Sequence[Illustration]) -> str:
    """The page as text."""
    return render_page(TITLE, (), figures, "paper.html", "presswear.paper", **words)


def words_of(names: Sequence[str], evidence: Evidence) -> dict[str, Any]:
    """What the page says."""
    claims, results = judged(evidence), evidence.results
    failures = {
        key.partition("--")[0]: result.message
        for key, result in results.items()
        if result.status == "failed"
    }
    standard = (results.get(variant_key(BASE, setting)) for setting in SETTINGS)
    first = next(filter(None, standard), None)
    numbers, remarks = numbers_table(evidence)
    return {
        "question": QUESTION,
        "wanted": len(names),
        "missing": len(names) - len(results),
        "replicates": STARTS,
        "headline": headline(evidence, claims),
        "findings": findings(evidence, failures),
        "counts": counts_table(claims),
        "cases": JUDGED,
        "claims": [(own, [detail(evidence, part) for part in own.claim.parts]) for own in claims],
        "styles": STYLES,
        "numbers": numbers,
        "remarks": remarks,
        "ratios": ratios_table(evidence),
        "ranges": ranges_table(evidence),
        "geometries": geometry_table(evidence),
        "fit": fit_table(evidence),
        "sensitivities": sensitivity_table(evidence, failures),
        "stopped": stopped_table(evidence),
        "distances": distances_table(evidence),
        "runs": _runs_table(names, results),
        "convention_set": "" if first is None else convention_set(first.scene.conventions),
        "conventions": None if first is None else convention_table(first),
        "parameters": None if first is None else parameter_table(first),
        "provenance": None if first is None else provenance_table(first),
    }


def _runs_table(names: Sequence[str], results: Mapping[str, Result]) -> Table:
    """Each run: cycles of its stages, how it ended, its energy residual and wall time."""
    rows = []
    for name in names:
        result = results.get(name)
        if result is None:
            rows.append((label_of(name), "–", "not finished", "–", "–"))
            continue
        told = [stage.statistics for stage in result.stages]
        residuals = [
            abs(own.energy_residual) / own.energy_exchanged for own in told if own.energy_exchanged
        ]
        failed = result.status == "failed"
        rows.append(
            (
                label_of(name),
                ", ".join(whole(own.cycles) for own in told),
                f"failed: {result.message}" if failed else result.status,
                readable(max(residuals, default=None), 1),
                readable(result.wall_s, 2),
            )
        )
    head = ("run", "cycles of each stage", "status", "energy residual", "wall time (s)")
    return Table(head, (("", tuple(rows)),), numeric=False)
