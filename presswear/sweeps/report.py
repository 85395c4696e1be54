"""The report of a sweep: what was varied and measured, what follows, and how sure that is."""

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import matplotlib
import numpy as np

from presswear.show.figures.style import SETTINGS, Drawing
from presswear.show.page import NOTHING, Illustration, Line, illustrate, render_page
from presswear.show.page import Table as Shown
from presswear.sweeps.analysis import Analysis, analysed, has_varied
from presswear.sweeps.distributions import Distribution
from presswear.sweeps.export import write_csv
from presswear.sweeps.figures import (
    curves,
    distribution,
    effects,
    heat_map,
    parallel,
    sections,
    shares,
    tornado,
)
from presswear.sweeps.figures.scales import Scale
from presswear.sweeps.spread import Required
from presswear.sweeps.table import Table
from presswear.sweeps.words import answer, lines, tables
from presswear.tools.files import inside, write_bytes
from presswear.tools.numbers import readable, whole

FILE = "report.html"
REST = "table.csv"
"""All rows, beside the report."""
FIRST_ROWS = 20
MOST_REASONS = 12
MOST_SAMPLES = 12
"""Samples that are told of one by one, where one is crossed with other values."""


@dataclass(frozen=True)
class Part:
    """What the page says of one measure."""

    heading: str
    lines: tuple[str, ...]
    tables: tuple[tuple[str, Shown], ...]
    figures: tuple[Illustration, ...]


def write_report(
    table: Table,
    folder: Path,
    title: str,
    *,
    sample: str = "",
    crossed: int = 0,
    distributions: Mapping[str, Distribution] | None = None,
    required: Mapping[str, Required] | None = None,
) -> Path:
    """Write ``report.html``, its figures and all rows into a folder; gives the page.

    Parameters
    ----------
    sample : str
        Kind of the design; nothing for a grid.
    crossed : int
        Number of the last factors, at each of whose values the whole design was run.
    distributions : mapping or None
        Of the factors that have one, by key.
    required : mapping or None
        What measures are not to miss, by key.
    """
    known, wanted = distributions or {}, required or {}
    parts: list[Part] = []
    answers: list[str] = []
    samples = {"": table, **_samples(table, crossed)}
    for place, measure in enumerate(table.measures):
        for number, (where, own) in enumerate(samples.items()):
            if not np.isfinite(own.values[:, place]).any():
                continue
            found = analysed(own, measure.key, sample, known, wanted.get(measure.key))
            into = inside(folder, "figures", *([f"{number}"] if where else []))
            with matplotlib.rc_context(SETTINGS):
                figures = tuple(illustrate(drawing, into) for drawing in drawings(found))
            at = f"At {where}: " if where else ""
            answers += (f"{at}{line}" for line in answer(found))
            heading = f"{measure.key} at {where}" if where else measure.key
            parts.append(Part(heading, tuple(lines(found)), tuple(tables(found)), figures))
    failed = sum(bool(reason) for reason in table.reasons)
    count = len(table.reasons)
    points = len(np.unique(table.points, axis=0))
    status = f"{whole(count)} runs at {whole(points)} points" + (
        f", of which {whole(failed)} have no values" if failed else ""
    )
    write_csv(folder / REST, table)
    left = count - min(count, FIRST_ROWS)
    text = render_page(
        title,
        template="sweep.html",
        package="presswear.sweeps",
        status=f"{status}.",
        style="unfinished" if failed else "completed",
        answer=answers,
        varied=_varied(table, known),
        measured=_measured(table),
        failures=_failures(table) if failed else None,
        parts=parts,
        rows=_first_rows(table),
        rest=f"{f'{whole(left)} other rows' if left else 'The same rows'} are in {REST}.",
    )
    path = folder / FILE
    write_bytes(path, text.encode())
    return path


def _samples(table: Table, crossed: int) -> dict[str, Table]:
    """The sample at each combination of the values that it is crossed with, by these in words."""
    if not crossed:
        return {}
    _, first = np.unique(table.points[:, -crossed:], axis=0, return_index=True)
    if len(first) > MOST_SAMPLES:
        return {}
    return {
        ", ".join(_told(table, row)[-crossed:]): table.at(table.points[row, -crossed:])
        for row in np.sort(first)
    }


def drawings(found: Analysis) -> list[Drawing]:
    """The pictures of a measure."""
    own = found.own
    drawn: list[Drawing] = []
    if found.is_constant:
        return drawn
    if found.swings is not None and any(found.swings):
        drawn.append(tornado(own, found.swings))
    if found.indices is not None:
        drawn.append(shares(own, found.indices))
    if found.screening is not None:
        drawn.append(effects(own, found.screening))
    told = found.spread or found.rows
    if told is not None and np.isfinite(told.values).sum() > 1:
        beside = found.rows if found.spread is not None else None
        drawn.append(distribution(own, told, found.required, beside))
    line = curves(own)
    if line is not None:
        drawn.append(line)
    numbers = [k for k in found.strongest if not own.factors[k].words]
    numbers = [k for k in numbers if np.ptp(own.points[:, k]) > 0.0]
    if len(numbers) > 1 and found.screening is None and found.swings is None:
        drawn.append(heat_map(own, (numbers[0], numbers[1]), found.surface))
    if found.surface is not None and numbers:
        drawn.append(sections(found.surface))
    if has_varied(own) > 1:
        drawn.append(parallel(own))
    return drawn


def _varied(table: Table, known: Mapping[str, Distribution]) -> Shown:
    rows = []
    for place, factor in enumerate(table.factors):
        values = table.points[:, place]
        scale, count = Scale.of(factor, values), len(np.unique(values))
        if factor.words:
            held = ", ".join(factor.words[int(k)] for k in np.unique(values))
        else:
            held = f"{scale.told(float(values.min()))} to {scale.told(float(values.max()))}"
        scatter = known[factor.key].described if factor.key in known else NOTHING
        rows.append((factor.key, factor.text, held, whole(count), scatter))
    head = ("", "what it is", "values", "different ones", "distribution")
    return Shown(head, (("", tuple(rows)),), numeric=False)


def _measured(table: Table) -> Shown:
    rows: list[Line] = []
    for place, own in enumerate(table.measures):
        values = table.values[:, place]
        values = values[np.isfinite(values)]
        bounds = whole(int(table.is_beyond[:, place].sum()))
        if not values.size:
            rows.append((own.key, own.text, "0", bounds, *[NOTHING] * 4))
            continue
        scale = Scale.of(own, values)
        rows.append(
            (
                own.key,
                own.text,
                whole(len(values)),
                bounds,
                *(
                    readable(scale.factor * float(number))
                    for number in (values.min(), np.median(values), values.max())
                ),
                scale.unit,
            )
        )
    head = ("", "what it is", "values", "lower bounds", "least", "median", "largest", "unit")
    return Shown(head, (("", tuple(rows)),), numeric=False)


def _failures(table: Table) -> Shown:
    """Reasons with their numbers of rows, the most frequent first."""
    counted = Counter(reason for reason in table.reasons if reason)
    rows = []
    for reason, count in counted.most_common(MOST_REASONS):
        first = table.reasons.index(reason)
        rows.append((reason, whole(count), ", ".join(_told(table, first))))
    left = len(counted) - len(rows)
    if left > 0:
        rest = sum(counted.values()) - sum(count for _, count in counted.most_common(MOST_REASONS))
        rows.append((f"{whole(left)} other reasons", whole(rest), f"see {REST}"))
    return Shown(("reason", "runs", "the first of them"), (("", tuple(rows)),), numeric=False)


def _told(table: Table, row: int) -> list[str]:
    """The values of the factors in a row, in words."""
    return [
        f"{factor.key} = {Scale.of(factor, table.points[:, k]).told(float(table.points[row, k]))}"
        for k, factor in enumerate(table.factors)
    ]


def _first_rows(table: Table) -> Shown:
    both = zip((*table.factors, *table.measures), (*table.points.T, *table.values.T), strict=True)
    bounds = (*np.zeros(table.points.T.shape, np.bool_), *table.is_beyond.T)
    columns = [
        (Scale.of(own, values), values, is_bound)
        for (own, values), is_bound in zip(both, bounds, strict=True)
        if np.isfinite(values).any()
    ]
    rows = []
    for row in range(min(len(table.reasons), FIRST_ROWS)):
        cells = (
            f"{'>' * bool(is_bound[row])}{scale.number(float(values[row]), 4)}"
            for scale, values, is_bound in columns
        )
        rows.append((f"{row + 1}", *cells))
    return Shown(("run", *(scale.label for scale, *_ in columns)), (("", tuple(rows)),))
