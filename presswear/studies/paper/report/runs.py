"""The table of what ran."""

from collections.abc import Mapping

from presswear.campaign.study import Study
from presswear.results.result import Result
from presswear.show.report.parts import Table
from presswear.tools.numbers import readable, whole


def runs_table(study: Study, results: Mapping[str, Result]) -> Table:
    """Each run: cycles of its stages, how it ended, its energy residual and wall time."""
    rows = []
    for variant in study.variants:
        result = results.get(variant.key)
        if result is None:
            rows.append((variant.label, "–", "not finished", "–", "–"))
            continue
        stages = result.stages
        residuals = [
            abs(stage.statistics["energy_residual_J"]) / stage.statistics["energy_exchanged_J"]
            for stage in stages
            if stage.statistics.get("energy_exchanged_J")
        ]
        status = result.status
        rows.append(
            (
                variant.label,
                ", ".join(whole(stage.statistics.get("cycles", 0)) for stage in stages),
                f"failed: {result.message}" if status == "failed" else status,
                readable(max(residuals), 1) if residuals else "–",
                readable(result.wall_s, 2),
            )
        )
    head = ("run", "cycles of each stage", "status", "energy residual", "wall time (s)")
    return Table(head, (("", tuple(rows)),), numeric=False)
