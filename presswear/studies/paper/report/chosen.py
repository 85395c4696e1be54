"""Tables of what was chosen: its fit, how much hangs on it, and when runs stopped."""

from presswear.results.result import Result
from presswear.show.report.parts import Row, Table
from presswear.studies.paper.choices import (
    WATCHED,
    early_stop,
    fit_of,
    map_distances,
    moves,
    sensitivities,
)
from presswear.studies.paper.evidence import Evidence, Place
from presswear.studies.paper.printed import WEAR, printed_at
from presswear.studies.paper.variants import GEOMETRIES, REFINED
from presswear.studies.paper.words import (
    QUANTITIES,
    as_printed,
    place_text,
    ratio_text,
    setting_text,
    stage_text,
    value_with_interval,
)
from presswear.tools.numbers import readable


def geometry_table(evidence: Evidence) -> Table:
    """How each geometry meets the printed peaks of smooth motion."""
    places = [
        ("displacement", Place(WEAR, 1)),
        ("displacement", Place(WEAR, 2)),
        ("stroke", Place(WEAR, 0)),
        ("velocity", Place(WEAR, 0)),
        ("velocity", Place(WEAR, 1)),
        ("velocity", Place(WEAR, 2)),
    ]
    rows = []
    for quantity, place in places:
        printed = printed_at(place, quantity)
        shown = QUANTITIES[quantity]
        rows.append(
            (
                f"{shown.label}, {place_text(place, quantity)} ({shown.unit})",
                "–" if printed is None else as_printed(printed.value, quantity),
                *(
                    value_with_interval(evidence.measured(name, place, quantity), quantity)
                    for name in GEOMETRIES
                ),
            )
        )
    return Table(("", "paper", *GEOMETRIES), (("", tuple(rows)),))


def fit_table(evidence: Evidence) -> Table:
    """Printed first-wear depth over ours: one number for all would be a perfect fit."""
    names = (*GEOMETRIES, REFINED)
    fits = [fit_of(evidence, name) for name in names]
    places = list(dict.fromkeys(place for fit in fits for place in fit.factors))
    rows: list[Row] = []
    for place in places:
        doubtful = any(place in fit.left_out for fit in fits)
        label = f"joint {place.joint}, {setting_text(place.setting)}"
        rows.append(
            (
                f"{label} (doubtful print, left out)" if doubtful else label,
                *(readable(fit.factors.get(place)) for fit in fits),
            )
        )
    summary = (
        ("best factor on K_d / b", *(readable(fit.best) for fit in fits)),
        ("single depths miss it by a factor of", *(readable(fit.spread) for fit in fits)),
    )
    head = ("paper / ours, deepest after the first wear", *names)
    return Table(head, (("", tuple(rows)), ("One number for all", summary)))


_SHORT = {"depth": "deepest wear", "force": "force", "displacement": "displacement, "}


def sensitivity_table(evidence: Evidence, failures: dict[str, str]) -> Table:
    """Each changed choice: what it makes of some results.

    Parameters
    ----------
    failures : dict
        Message by case, of those that ended in failure.
    """
    rows = []
    for found in sensitivities(evidence):
        label = found.label
        if found.key in failures:
            label += f": {failures[found.key]}"
        cells = [
            f"{ratio_text(interval)}{' *' if moves(interval) else ''}" for interval in found.ratios
        ]
        rows.append((label, *cells))
    head = tuple(
        f"{_SHORT[quantity]} {place.joint}{', ' if place.joint else ''}"
        f"{stage_text(place, quantity)}"
        for quantity, place in WATCHED
    )
    return Table(("changed alone", *head), (("", tuple(rows)),))


def stopped_table(evidence: Evidence) -> Table:
    """Runs that stopped early beside 200 cycles."""
    rows = [
        (
            f"{QUANTITIES[found.quantity].label}, {place_text(found.place, found.quantity)} "
            f"({QUANTITIES[found.quantity].unit})",
            value_with_interval(found.early, found.quantity),
            f"{found.early.samples} from {found.early.starts}",
            value_with_interval(found.full, found.quantity),
            str(found.full.samples),
            ratio_text(found.ratio),
            "yes" if found.agrees else "no",
        )
        for found in early_stop(evidence)
    ]
    head = (
        "",
        "stopped early",
        "cycles, starts",
        "200 cycles",
        "cycles",
        "ratio",
        "may be the same",
    )
    return Table(head, (("", tuple(rows)),), numeric=False)


def distances_table(evidence: Evidence) -> Table:
    """Wear maps of early runs beside those of 200 cycles."""
    rows = [
        (
            f"joint {found.joint}, {setting_text(found.setting)}",
            *(
                f"{readable(100.0 * part, 2)} %"
                for part in (found.error, found.full_error, found.expected, found.distance)
            ),
        )
        for found in map_distances(evidence)
    ]
    head = (
        "wear map, root mean square",
        "error stated by the early runs",
        "error stated after 200 cycles",
        "distance to expect",
        "distance found",
    )
    return Table(head, (("", tuple(rows)),))


def failures_of(results: dict[str, Result]) -> dict[str, str]:
    """Messages of runs that failed, by case."""
    return {
        key.partition("--")[0]: str(result.message)
        for key, result in results.items()
        if result.status == "failed"
    }
