"""Report of a sweep: parameters, responses, sensitivity, distribution, rows and figures."""

import math
from collections import Counter
from collections.abc import Iterator, Mapping
from pathlib import Path

import matplotlib
import numpy as np

from presswear.scene.catalog import title_of
from presswear.show import page
from presswear.show.figures import remove_others, style
from presswear.show.page import NOTHING, Section
from presswear.sweeps.analysis import Analysis, analyze, failed_text, percent_text
from presswear.sweeps.figures import drawings
from presswear.sweeps.parameters import Column, Display
from presswear.sweeps.plan import Plan, Table
from presswear.sweeps.response_limits import ResponseLimit
from presswear.tools.files import inside, write_bytes
from presswear.tools.numbers import readable, whole

REPORT = "report.html"
ROWS_FILE = "table.csv"
FIRST_ROWS = 20
OPEN_SECTIONS = 2  # responses whose sections are open at first
MAX_NUMBERS = 10  # responses on the first screen
MAX_ERRORS = 12
# combinations of varied values at which a sample is analysed separately
MAX_SAMPLES = 12
PERCENTILES = (5, 50, 95)


def write_report(
    table: Table, plan: Plan, folder: Path, limits: Mapping[str, ResponseLimit]
) -> Path:
    """Write ``report.html``, its figures and ``table.csv`` into a folder; return the page."""
    sections: list[Section] = []
    answers = []
    numbers = []
    for number, (name, part) in enumerate(_parts(table, plan).items()):
        into = inside(folder, "figures", *([f"{number}"] if name else []))
        files = []
        for column in table.responses:
            if not np.isfinite(part.values[:, part.index(column.key)]).any():
                continue
            analysis = analyze(part, column.key, plan, limits.get(column.key))
            label = f"{column.key} at {name}" if name else column.key
            answers += [
                f"At {name}: {line}" if name else line for line in findings(analysis)
            ]
            if analysis.points.means[analysis.points.has_value].any():
                numbers.append(_key_number(analysis, label))
            with matplotlib.rc_context(style.SETTINGS):
                drawn = page.illustrated(drawings(analysis), into)
            files += [figure.file for figure in drawn]
            sections.append(
                Section(
                    label,
                    (f"{column.text}.",),
                    result_tables(analysis),
                    drawn,
                    analysis.notes,
                    is_open=len(sections) < OPEN_SECTIONS,
                )
            )
        remove_others(into, files)
    figures = [figure for section in sections for figure in section.figures]
    write_bytes(folder / ROWS_FILE, table.csv().encode())
    count = whole(len(table.errors))
    failed = sum(map(bool, table.errors))
    status = f"{count} runs at {whole(len(plan.points))} points"
    status += f", {plan.remark}" if plan.remark else ""
    html = page.render_page(
        f"Sweep: {title_of(plan.scene)}",
        page.FirstScreen(
            status=status + (f", {whole(failed)} without values." if failed else "."),
            style="unfinished" if failed else "completed",
            key_numbers=numbers[:MAX_NUMBERS],
            picture=figures[0] if figures else None,
        ),
        [*sections, *_table_sections(table, plan)],
        answers,
    )
    write_bytes(folder / REPORT, html.encode())
    return folder / REPORT


def _table_sections(table: Table, plan: Plan) -> Iterator[Section]:
    """Yield the sections on ranges, failed runs and the first rows."""
    responses = _ranges(table.responses, table.values, plan, table)
    yield Section("Ranges of responses", tables=[(failed_text(table), responses)])
    parameters = _ranges(table.parameters, table.points, plan)
    yield Section("Ranges of parameters", tables=[("", parameters)])
    if any(table.errors):
        failed = []
        for error, count in Counter(filter(None, table.errors)).most_common(MAX_ERRORS):
            first = _point(table.parameters, table.points[table.errors.index(error)])
            failed.append((error, whole(count), first))
        errors = page.plain_table(("error", "runs", "first run"), failed, numeric=False)
        yield Section("Failed runs", tables=[("", errors)])
    head, *lines = table.texts(FIRST_ROWS)
    rows = ((f"{number}", *line) for number, line in enumerate(lines, start=1))
    note = f"All {whole(len(table.errors))} runs are in {ROWS_FILE}."
    first_rows = page.plain_table(("run", *head), rows)
    yield Section("First runs", tables=[("", first_rows)], notes=[note])


def _key_number(analysis: Analysis, name: str) -> page.KeyNumber:
    """Return the range of a response over the points, and what it depends on most."""
    points = analysis.points
    result = analysis.sensitivity
    shown = Display(points.response, points.means)
    low, high = (shown.number(pick(points.means)) for pick in (np.nanmin, np.nanmax))
    meaning = f"{points.response.text[:1].upper()}{points.response.text[1:]}: "
    meaning += (
        f"smallest and largest mean of {whole(int(points.has_value.sum()))} points."
    )
    meaning += f" {analysis.failed}." if analysis.failed else ""
    if result is not None and not points.is_constant:
        meaning += f" It depends most on {points.parameters[result.order[0]].key}."
    return page.KeyNumber(name, f"{low} to {high} {shown.unit}".strip(), "", meaning)


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


def findings(analysis: Analysis) -> list[str]:
    """Return sentences on the most important parameter and on the limit."""
    points = analysis.points
    limit = analysis.limit
    spread = analysis.spread
    lines = []
    key = points.response.key
    end = f" ({analysis.failed})." if analysis.failed else "."
    if analysis.sensitivity is not None:
        strongest = points.parameters[analysis.sensitivity.order[0]].key
        lines.append(f"{key} depends most on {strongest}{end}")
    if limit is None:
        return lines
    value = Display(points.response, points.means).text(limit.value)
    name = f"the {'lower' if limit.is_lower else 'upper'} limit {value} of {key}"
    if spread is not None and spread.violation is not None:
        share = percent_text(spread.violation)
        text = (
            f"The probability that {name} is violated is {share}, {spread.source}{end}"
        )
    else:
        rows = points.has_value
        fewest, most = limit.count(points.means[rows], points.censored[rows])
        count = whole(fewest) if fewest == most else f"{whole(fewest)} to {whole(most)}"
        text = f"{count} of {whole(int(rows.sum()))} points violate {name}{end}"
    return [*lines, text]


def result_tables(analysis: Analysis) -> list[tuple[str, page.Table]]:
    """Return the tables of a response with their headings."""
    points = analysis.points
    tables = list[tuple[str, page.Table]]()
    end = f"; {analysis.failed}" if analysis.failed else ""
    shown = Display(points.response, points.means)
    if 1 < len(points.means) <= FIRST_ROWS:
        columns = list(map(Display, points.parameters, points.points.T))
        rows = zip(
            points.points, points.means, points.half_widths, points.counts, strict=True
        )
        lines = []
        for place, mean, half, count in rows:
            texts = (
                column.number(value, 4)
                for column, value in zip(columns, place, strict=True)
            )
            lines.append((*texts, shown.with_half_width(mean, half), whole(count)))
        head = (*(column.label for column in columns), shown.label, "runs")
        tables.append(
            (f"Means with 95 % intervals{end}", page.plain_table(head, lines))
        )
    if (result := analysis.sensitivity) is not None:
        factor, unit = (100.0, "%") if result.is_share else (shown.factor, shown.unit)
        lines = []
        for k in result.order:
            cells = [points.parameters[k].key]
            for value, half in zip(
                result.values[:, k], result.half_widths[:, k], strict=True
            ):
                interval = (
                    "" if math.isnan(half) else f" ± {readable(factor * half, 2)}"
                )
                cells.append(f"{readable(factor * value)}{interval}")
            lines.append(tuple(cells))
        head = (
            "parameter",
            *(f"{name} ({unit})" if unit else name for name in result.names),
        )
        tables.append(
            (f"{result.title} ({result.method}){end}", page.plain_table(head, lines))
        )
    if (spread := analysis.spread) is not None:
        cells = [f"single runs ({shown.unit or '1'})"]
        for k in (percent - 1 for percent in PERCENTILES):
            value, low, high = map(
                shown.number, (spread.values[k], spread.low[k], spread.high[k])
            )
            cells.append(f"{value} ({low} to {high})")
        head = ("", *(f"{percent} % quantile" for percent in PERCENTILES))
        tables.append(
            (
                f"Distribution, {spread.source}{end}",
                page.plain_table(head, [tuple(cells)]),
            )
        )
    return tables


def _ranges(
    columns: tuple[Column, ...],
    values: np.ndarray,
    plan: Plan,
    table: Table | None = None,
) -> page.Table:
    """Return the ranges of parameters, or of the responses of a table."""
    lines = []
    for k, column in enumerate(columns):
        finite = values[np.isfinite(values[:, k]), k]
        shown = Display(column, finite)
        scatter = plan.distributions.get(column.key)
        remark = scatter.text if scatter else ", ".join(column.choices) or NOTHING
        if table is not None and table.censored[:, k].any():
            remark = f"{int(table.censored[:, k].sum())} lower bounds"
        count = len(np.unique(finite)) if table is None else len(finite)
        ends = np.quantile(finite, (0.0, 0.5, 1.0)) if finite.size else [math.nan] * 3
        texts = ("" if column.choices else shown.text(value) for value in ends)
        lines.append((column.key, column.text, whole(count), *texts, remark))
    head = ("name", "meaning", "values", "lowest", "median", "highest", "remark")
    return page.plain_table(head, lines, numeric=False)
