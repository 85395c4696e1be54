"""Report of a sweep: parameters, responses, sensitivity, distribution and rows."""

import math
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import matplotlib
import numpy as np

from presswear.scene.catalog import title_of
from presswear.show.figures.style import SETTINGS, Drawing
from presswear.show.page import NOTHING, Row, Section, illustrate, render_page, row_table
from presswear.show.page import Table as Texts
from presswear.sweeps import figures
from presswear.sweeps.figures import Display
from presswear.sweeps.parameters import Column
from presswear.sweeps.plan import Plan, Table
from presswear.sweeps.responses import Limit
from presswear.sweeps.sensitivity import (
    Points,
    Sensitivity,
    Spread,
    chaotic_share,
    points_of,
    sensitivity,
    spread_of_rows,
)
from presswear.sweeps.surrogate import Surrogate, fit
from presswear.tools.errors import InputError
from presswear.tools.files import inside, write_bytes
from presswear.tools.numbers import readable, whole

REPORT, ROWS_FILE = "report.html", "table.csv"
FIRST_ROWS = 20
MAX_ERRORS = 12
MAX_SAMPLES = 12  # combinations of varied values at which a sample is analysed separately
PERCENTILES = (5, 50, 95)
COLUMN_ROWS = (
    Row("name", "column.key"),
    Row("meaning", "column.text"),
    Row("values", "count"),
    Row("lowest", "low"),
    Row("median", "median"),
    Row("highest", "high"),
    Row("remark", "remark"),
)
ERROR_ROWS = (Row("error", "error"), Row("runs", "count"), Row("first run", "first"))


@dataclass(frozen=True)
class Analysis:
    """Everything that the points of a sweep tell about one response; None where they do not."""

    points: Points
    chaos: tuple[float, float, float] | None
    sensitivity: Sensitivity | None
    surrogate: Surrogate | None
    spread: Spread | None
    limit: Limit | None
    notes: tuple[str, ...]


def analyze(table: Table, key: str, plan: Plan, limit: Limit | None = None) -> Analysis:
    """Analyse a response of the rows of a plan, or of those with equal varied values."""
    points, kind, notes = points_of(table, key), plan.sample.partition(":")[0], []
    result = surrogate = spread = None
    try:
        result = sensitivity(points, kind)
    except InputError as error:
        notes.append(f"{error}.")
    try:
        surrogate = fit(points)
    except InputError as error:
        notes.append(f"{error}.")
    scatter = [plan.distributions.get(column.key) for column in points.parameters]
    complete = [item for item in scatter if item is not None]
    if len(complete) == len(scatter):
        reason = "" if surrogate is None else surrogate.outside(complete)
        if reason:
            notes.append(f"The surrogate gives no distribution: {reason}.")
        elif surrogate is not None:
            spread = surrogate.spread(complete, limit)
        if spread is None and kind in ("sobol", "latin"):
            spread = spread_of_rows(table, key, limit)
    if points.censored.any():
        count = whole(int(points.censored.sum()))
        notes.append(f"The values of {count} points are lower bounds; indices use the bounds.")
    return Analysis(points, chaotic_share(points), result, surrogate, spread, limit, tuple(notes))


def write_report(table: Table, plan: Plan, folder: Path, limits: Mapping[str, Limit]) -> Path:
    """Write ``report.html``, its figures and ``table.csv`` into a folder; return the page."""
    sections = [
        Section("Parameters", tables=[("", _columns(table.parameters, table.points, plan))]),
        Section("Responses", tables=[("", _columns(table.responses, table.values, plan, table))]),
    ]
    failed = sum(bool(error) for error in table.errors)
    if failed:
        sections.append(Section("Failed runs", tables=[("", _errors(table))]))
    answers = []
    for number, (name, part) in enumerate(_parts(table, plan).items()):
        into = inside(folder, "figures", *([f"{number}"] if name else []))
        for column in table.responses:
            if not np.isfinite(part.values[:, part.index(column.key)]).any():
                continue
            analysis = analyze(part, column.key, plan, limits.get(column.key))
            answers += [f"At {name}: {line}" if name else line for line in findings(analysis)]
            with matplotlib.rc_context(SETTINGS):
                drawn = [illustrate(item, into) for item in drawings(analysis)]
            heading = f"{column.key} at {name}" if name else column.key
            tables = result_tables(analysis)
            sections.append(Section(heading, (f"{column.text}.",), tables, drawn, analysis.notes))
    count = whole(len(table.errors))
    head, *lines = text_table(table, FIRST_ROWS)
    rows = tuple((f"{number}", *line) for number, line in enumerate(lines, start=1))
    note = f"All {count} runs are in {ROWS_FILE}."
    first_rows = Texts(("run", *head), (("", rows),))
    sections.append(Section("First runs", tables=[("", first_rows)], notes=[note]))
    write_bytes(folder / ROWS_FILE, table.csv().encode())
    status = f"{count} runs at {whole(len(plan.points))} points"
    status += f", {whole(failed)} without values." if failed else "."
    style = "unfinished" if failed else "completed"
    title = f"Sweep: {title_of(plan.scene)}"
    page = render_page(title, sections, status=status, style=style, answer=answers)
    write_bytes(folder / REPORT, page.encode())
    return folder / REPORT


def _parts(table: Table, plan: Plan) -> dict[str, Table]:
    """Return the sample at each combination of the values that it is combined with, by name."""
    crossed = len(plan.columns) - len(plan.distributions)
    if not plan.sample or not crossed:
        return {"": table}
    combinations = np.unique(table.points[:, -crossed:], axis=0)
    if len(combinations) > MAX_SAMPLES:
        return {"": table}
    columns = table.parameters[-crossed:]
    return {_point(columns, values): table.at(values) for values in combinations}


def _point(columns: tuple[Column, ...], values: np.ndarray) -> str:
    pairs = zip(columns, values, strict=True)
    return ", ".join(f"{c.key} = {Display(c, np.array([v])).text(v)}" for c, v in pairs)


def drawings(analysis: Analysis) -> list[Drawing]:
    """Return the figures of a response."""
    points, result, spread = analysis.points, analysis.sensitivity, analysis.spread
    if points.is_constant:
        return []
    drawn = [] if result is None else figures.bars(points, result)
    if spread is not None and np.isfinite(spread.values).sum() > 1:
        drawn += figures.distribution(points, spread, analysis.limit)
    drawn += figures.curves(points)
    order = range(len(points.parameters)) if result is None else result.order
    numbers = [k for k in order if not points.parameters[k].choices]
    first, *rest = [k for k in numbers if np.ptp(points.points[:, k]) > 0.0] or [0]
    return drawn + (figures.heat_map(points, (first, rest[0]), analysis.surrogate) if rest else [])


def _percent(share: tuple[float, float, float]) -> str:
    value, low, high = (readable(100.0 * part) for part in share)
    return f"{value} % ({low} to {high} %)"


def findings(analysis: Analysis) -> list[str]:
    """Return sentences on the most important parameter, on chaos and on the limit."""
    points, limit, spread, lines = analysis.points, analysis.limit, analysis.spread, []
    key = points.response.key
    if analysis.sensitivity is not None:
        strongest = points.parameters[analysis.sensitivity.order[0]].key
        lines.append(f"{key} depends most on {strongest}.")
    if analysis.chaos is not None:
        share = _percent(analysis.chaos)
        lines.append(f"Chaos is {share} of the variance of single runs of {key}.")
    if limit is None:
        return lines
    value = Display(points.response, points.means).text(limit.value)
    name = f"the {'lower' if limit.is_lower else 'upper'} limit {value} of {key}"
    if spread is not None and spread.violation is not None:
        share = _percent(spread.violation)
        text = f"The probability that {name} is violated is {share}, {spread.source}."
    else:
        rows = points.has_value
        fewest, most = limit.count(points.means[rows], points.censored[rows])
        count = whole(fewest) if fewest == most else f"{whole(fewest)} to {whole(most)}"
        text = f"{count} of {whole(int(rows.sum()))} points violate {name}."
    return [*lines, text]


def result_tables(analysis: Analysis) -> list[tuple[str, Texts]]:
    """Return the tables of a response with their headings."""
    points, tables = analysis.points, []
    shown = Display(points.response, points.means)
    if (result := analysis.sensitivity) is not None:
        factor, unit = (100.0, "%") if result.is_share else (shown.factor, shown.unit)
        lines = []
        for k in result.order:
            cells = [points.parameters[k].key]
            for value, half in zip(result.values[:, k], result.half_widths[:, k], strict=True):
                interval = "" if math.isnan(half) else f" ± {readable(factor * half, 2)}"
                cells.append(f"{readable(factor * value)}{interval}")
            lines.append(tuple(cells))
        head = ("parameter", *(f"{name} ({unit})" if unit else name for name in result.names))
        tables.append((f"{result.title} ({result.method})", Texts(head, (("", tuple(lines)),))))
    if (spread := analysis.spread) is not None:
        cells = [f"single runs ({shown.unit or '1'})"]
        for k in (percent - 1 for percent in PERCENTILES):
            value, low, high = map(shown.number, (spread.values[k], spread.low[k], spread.high[k]))
            cells.append(f"{value} ({low} to {high})")
        head = ("", *(f"{percent} % quantile" for percent in PERCENTILES))
        tables.append((f"Distribution, {spread.source}", Texts(head, (("", (tuple(cells),)),))))
    return tables


def _columns(
    columns: tuple[Column, ...], values: np.ndarray, plan: Plan, table: Table | None = None
) -> Texts:
    """Return the ranges of parameters, or of the responses of a table."""
    records = []
    for k, column in enumerate(columns):
        finite = values[np.isfinite(values[:, k]), k]
        shown, scatter = Display(column, finite), plan.distributions.get(column.key)
        remark = scatter.text if scatter else ", ".join(column.choices) or NOTHING
        if table is not None and table.censored[:, k].any():
            remark = f"{int(table.censored[:, k].sum())} lower bounds"
        count = len(np.unique(finite)) if table is None else len(finite)
        ends = np.quantile(finite, (0.0, 0.5, 1.0)) if finite.size else [math.nan] * 3
        texts = ("" if column.choices else shown.text(value) for value in ends)
        record = dict(zip(("low", "median", "high"), texts, strict=True))
        records.append({"column": column, "count": count, "remark": remark, **record})
    return row_table(COLUMN_ROWS, records, numeric=False)


def _errors(table: Table) -> Texts:
    """Return the errors with their numbers of runs, the most frequent first."""
    counts = Counter(error for error in table.errors if error)
    records = []
    for error, count in counts.most_common(MAX_ERRORS):
        first = _point(table.parameters, table.points[table.errors.index(error)])
        records.append({"error": error, "count": count, "first": first})
    return row_table(ERROR_ROWS, records, numeric=False)


def text_table(table: Table, count: int) -> list[list[str]]:
    """Return the titles of the columns of a table and its first rows as texts.

    A lower bound has the sign ``>``, a missing value is a dash.
    """
    columns = []
    for column, values in zip(table.parameters, table.points.T, strict=True):
        shown = Display(column, values)
        columns.append([shown.label, *(shown.number(value, 4) for value in values[:count])])
    for k, column in enumerate(table.responses):
        shown, texts = Display(column, table.values[:, k]), []
        for row in range(min(count, len(table.errors))):
            half = table.half_widths[row, k]
            interval = "" if math.isnan(half) else f" ± {shown.number(half, 2)}"
            sign = ">" if table.censored[row, k] else ""
            texts.append(f"{sign}{shown.number(table.values[row, k], 4)}{interval}")
        columns.append([shown.label, *texts])
    return [list(line) for line in zip(*columns, strict=True)]
