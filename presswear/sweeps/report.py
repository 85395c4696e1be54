"""Report of a sweep: parameters, responses, sensitivity, distribution, rows and figures."""

import math
from collections import Counter
from collections.abc import Iterator, Mapping
from itertools import chain
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
from presswear.sweeps.response_distribution import Spread
from presswear.sweeps.response_limits import ResponseLimit
from presswear.sweeps.response_points import Points
from presswear.sweeps.sensitivity import Sensitivity
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
    for number, (name, rows) in enumerate(_divided(table, plan).items()):
        subfolder = [f"{number}"] if name else []
        figure_folder = inside(folder, "figures", *subfolder)
        files = []
        for column in table.responses:
            if not np.isfinite(rows.values[:, rows.index(column.key)]).any():
                continue
            analysis = analyze(rows, column.key, plan, limits.get(column.key))
            label = f"{column.key} at {name}" if name else column.key
            start = f"At {name}: " if name else ""
            answers += [f"{start}{line}" for line in findings(analysis)]
            if analysis.points.means[analysis.points.has_value].any():
                numbers.append(_key_number(analysis, label))
            with matplotlib.rc_context(style.SETTINGS):
                figures = page.illustrated(drawings(analysis), figure_folder)
            files += [figure.file for figure in figures]
            section = Section(
                label,
                (f"{column.text}.",),
                result_tables(analysis),
                figures,
                analysis.notes,
                is_open=len(sections) < OPEN_SECTIONS,
            )
            sections.append(section)
        remove_others(figure_folder, files)
    write_bytes(folder / ROWS_FILE, table.csv().encode())
    html = page.render_page(
        f"Sweep: {title_of(plan.scene)}",
        _first_screen(table, plan, numbers, sections),
        [*sections, *_table_sections(table, plan)],
        answers,
    )
    write_bytes(folder / REPORT, html.encode())
    return folder / REPORT


def _first_screen(
    table: Table, plan: Plan, numbers: list[page.KeyNumber], sections: list[Section]
) -> page.FirstScreen:
    """Return the status, the first numbers and the first figure."""
    failed = sum(map(bool, table.errors))
    parts = [f"{whole(len(table.errors))} runs at {whole(len(plan.points))} points"]
    if plan.remark:
        parts.append(plan.remark)
    if failed:
        parts.append(f"{whole(failed)} without values")
    pictures = chain.from_iterable(section.figures for section in sections)
    return page.FirstScreen(
        status=f"{', '.join(parts)}.",
        style="unfinished" if failed else "completed",
        key_numbers=numbers[:MAX_NUMBERS],
        picture=next(pictures, None),
    )


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
    """Return the range of a response over the points, and its most important parameter."""
    points = analysis.points
    result = analysis.sensitivity
    shown = Display(points.response, points.means)
    low = shown.number(np.nanmin(points.means))
    high = shown.number(np.nanmax(points.means))
    text = points.response.text
    count = whole(int(points.has_value.sum()))
    meaning = (
        f"{text[:1].upper()}{text[1:]}: smallest and largest mean of {count} points."
    )
    if analysis.failed:
        meaning += f" {analysis.failed}."
    if result is not None and not points.is_constant:
        meaning += f" It depends most on {points.parameters[result.order[0]].key}."
    return page.KeyNumber(name, f"{low} to {high} {shown.unit}".strip(), "", meaning)


def _divided(table: Table, plan: Plan) -> dict[str, Table]:
    """Return the table by name, divided by the varied values that samples are combined with.

    The name is empty if the table is not divided.
    """
    # Parameters with listed values; they follow the sampled parameters.
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
        probability = f"The probability that {name} is violated is {share}"
        return [*lines, f"{probability}, {spread.source}{end}"]
    rows = points.has_value
    fewest, most = limit.count(points.means[rows], points.censored[rows])
    count = whole(fewest) if fewest == most else f"{whole(fewest)} to {whole(most)}"
    points_text = f"{count} of {whole(int(rows.sum()))} points"
    return [*lines, f"{points_text} violate {name}{end}"]


def result_tables(analysis: Analysis) -> list[tuple[str, page.Table]]:
    """Return the tables of a response with their headings."""
    points = analysis.points
    tables: list[tuple[str, page.Table]] = []
    end = f"; {analysis.failed}" if analysis.failed else ""
    shown = Display(points.response, points.means)
    if 1 < len(points.means) <= FIRST_ROWS:
        tables.append((f"Means with 95 % intervals{end}", _mean_table(points, shown)))
    result = analysis.sensitivity
    if result is not None:
        heading = f"{result.title} ({result.method}){end}"
        tables.append((heading, _sensitivity_table(result, points, shown)))
    spread = analysis.spread
    if spread is not None:
        heading = f"Distribution, {spread.source}{end}"
        tables.append((heading, _distribution_table(spread, shown)))
    return tables


def _mean_table(points: Points, shown: Display) -> page.Table:
    """Return the mean of a response at each point, with its interval."""
    columns = list(map(Display, points.parameters, points.points.T))
    lines = []
    for k, values in enumerate(points.points):
        pairs = zip(columns, values, strict=True)
        texts = [column.number(value, 4) for column, value in pairs]
        mean = shown.with_half_width(points.means[k], points.half_widths[k])
        lines.append((*texts, mean, whole(points.counts[k])))
    head = (*(column.label for column in columns), shown.label, "runs")
    return page.plain_table(head, lines)


def _sensitivity_table(
    result: Sensitivity, points: Points, shown: Display
) -> page.Table:
    """Return the sensitivity of a response, the most important parameter first."""
    factor, unit = (100.0, "%") if result.is_share else (shown.factor, shown.unit)
    end = f" ({unit})" if unit else ""
    lines = []
    for k in result.order:
        cells = [points.parameters[k].key]
        pairs = zip(result.values[:, k], result.half_widths[:, k], strict=True)
        for value, half in pairs:
            text = readable(factor * value)
            if not math.isnan(half):
                text += f" ± {readable(factor * half, 2)}"
            cells.append(text)
        lines.append(tuple(cells))
    head = ("parameter", *(f"{name}{end}" for name in result.names))
    return page.plain_table(head, lines)


def _distribution_table(spread: Spread, shown: Display) -> page.Table:
    """Return quantiles of a response with their intervals."""
    cells = [f"single runs ({shown.unit or '1'})"]
    for percent in PERCENTILES:
        k = percent - 1
        low = shown.number(spread.low[k])
        high = shown.number(spread.high[k])
        cells.append(f"{shown.number(spread.values[k])} ({low} to {high})")
    head = ("", *(f"{percent} % quantile" for percent in PERCENTILES))
    return page.plain_table(head, [tuple(cells)])


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
        remark = ", ".join(column.choices) or NOTHING
        if scatter:
            remark = scatter.text
        if table is not None and table.censored[:, k].any():
            remark = f"{int(table.censored[:, k].sum())} lower bounds"
        count = len(np.unique(finite)) if table is None else len(finite)
        ends = np.quantile(finite, (0.0, 0.5, 1.0)) if finite.size else [math.nan] * 3
        texts = [""] * len(ends) if column.choices else map(shown.text, ends)
        lines.append((column.key, column.text, whole(count), *texts, remark))
    head = ("name", "meaning", "values", "lowest", "median", "highest", "remark")
    return page.plain_table(head, lines, numeric=False)
