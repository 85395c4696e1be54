"""Report of a sweep: parameters, responses, sensitivity, distribution, rows and figures."""

import math
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

import matplotlib
import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.ticker import NullFormatter

from presswear.scene.catalog import title_of
from presswear.show import page
from presswear.show.figures import remove_others, style
from presswear.show.figures.style import LINES, Drawing, Pen, finished
from presswear.show.page import NOTHING, Section
from presswear.sweeps.parameters import Column, Display
from presswear.sweeps.plan import NOT_RUN, Plan, Table
from presswear.sweeps.responses import Limit
from presswear.sweeps.sensitivity import (
    PROBABILITIES,
    Points,
    Sensitivity,
    Spread,
    Surrogate,
    chaotic_share,
    fit,
    is_logarithmic,
    points_of,
    sensitivity,
    spread_of_rows,
)
from presswear.tools.arrays import Array
from presswear.tools.errors import InputError
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
COLOURS = "cividis"  # distinguishable with colour blindness and in grey print
MAX_TICKS = 6  # values of a parameter that are all written on its axis
CELLS = 60  # cells of a map along each axis
BAR = 0.36  # height of a bar, part of the row of a parameter
NAME_WIDTH = 2.2  # width of the names of parameters, inches


@dataclass(frozen=True)
class Analysis:
    """Everything that the points of a sweep tell about one response; None where they do not."""

    points: Points
    sensitivity: Sensitivity | None
    surrogate: Surrogate | None
    spread: Spread | None
    limit: Limit | None
    notes: tuple[str, ...]
    failed: str = ""  # see ``failed_text``


def failed_text(table: Table) -> str:
    """Return how many runs failed, whose values every statistic lacks; empty for none."""
    failed = sum(error not in ("", NOT_RUN) for error in table.errors)
    return (
        f"{whole(failed)} of {whole(len(table.errors))} runs failed" if failed else ""
    )


def analyze(table: Table, key: str, plan: Plan, limit: Limit | None = None) -> Analysis:
    """Analyse a response of the rows of a plan, or of those with equal varied values."""
    points = points_of(table, key)
    kind = plan.sample.partition(":")[0]
    notes = []
    result = surrogate = spread = None
    try:
        result = sensitivity(points, kind)
    except InputError as error:
        notes.append(f"{error}.")
    try:
        surrogate = fit(points)
    except InputError as error:
        if plan.sample:
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
        notes.append(
            f"The values of {count} points are lower bounds; indices use the bounds."
        )
    if (chaos := chaotic_share(points)) is not None:
        text = f"Scatter of chaotic motion is {_percent(chaos)} of the variance of single runs of"
        notes.append(f"{text} {key}; the rest comes from the parameters.")
    return Analysis(
        points, result, surrogate, spread, limit, tuple(notes), failed_text(table)
    )


def write_report(
    table: Table, plan: Plan, folder: Path, limits: Mapping[str, Limit]
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
            texts = (f"{column.text}.",), result_tables(analysis), drawn, analysis.notes
            sections.append(
                Section(label, *texts, is_open=len(sections) < OPEN_SECTIONS)
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


def drawings(analysis: Analysis) -> list[Drawing]:
    """Return the figures of a response."""
    points = analysis.points
    result = analysis.sensitivity
    spread = analysis.spread
    if points.is_constant:
        return []
    drawn = [] if result is None else bars(points, result)
    if spread is not None and np.isfinite(spread.values).sum() > 1:
        drawn += distribution(points, spread, analysis.limit)
    drawn += curves(points)
    order = range(len(points.parameters)) if result is None else result.order
    numbers = [k for k in order if not points.parameters[k].choices]
    first, *rest = [k for k in numbers if np.ptp(points.points[:, k]) > 0.0] or [0]
    return drawn + (
        heat_map(points, (first, rest[0]), analysis.surrogate) if rest else []
    )


def _percent(share: tuple[float, float, float]) -> str:
    value, low, high = (readable(100.0 * part) for part in share)
    return f"{value} % ({low} to {high} %)"


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
        share = _percent(spread.violation)
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
                one.number(value, 4) for one, value in zip(columns, place, strict=True)
            )
            lines.append((*texts, shown.with_half_width(mean, half), whole(count)))
        head = (*(one.label for one in columns), shown.label, "runs")
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


# --- Figures, with titles and captions in ``captions.toml`` -------------------------


def _axis(
    axes: style.Axes, side: str, column: Column, values: Array, width: float
) -> Display:
    """Set label, ticks and scale of the x or y axis of a parameter."""
    shown = Display(column, values)
    axis = axes.xaxis if side == "x" else axes.yaxis
    axis.set_label_text(style.wrapped(shown.label.replace("_", " "), width))
    if column.choices:
        axis.set_ticks(range(len(column.choices)), column.choices)
        return shown
    if is_logarithmic(values):
        (axes.set_xscale if side == "x" else axes.set_yscale)("log")
        axis.set_minor_formatter(NullFormatter())
    if len(levels := np.unique(values)) <= MAX_TICKS:
        axis.set_ticks(shown.factor * levels, [shown.number(value) for value in levels])
    return shown


def bars(points: Points, result: Sensitivity) -> list[Drawing]:
    """Draw the sensitivity to each parameter as bars, the most important at the top."""
    order = result.order
    rows = np.arange(len(result.order))
    shown = Display(points.response, result.values)
    factor = 1.0 if result.is_share else shown.factor
    sheet, ((axes,),) = style.panels(1, 1, 1.1 + 0.42 * len(rows))
    pens = [
        Pen(name, line[0], width=7.0)
        for name, line in zip(result.names, LINES, strict=False)
    ]
    for k, pen in enumerate(pens):
        y = rows + (k - 0.5 * (len(pens) - 1)) * BAR
        lengths = factor * np.nan_to_num(result.values[k, order])
        halves = factor * np.nan_to_num(result.half_widths[k, order])
        axes.barh(y, lengths, 0.9 * BAR, color=pen.colour)
        axes.errorbar(
            lengths, y, xerr=halves, fmt="none", ecolor=style.REFERENCE, elinewidth=0.9
        )
    names = [points.parameters[k].key.replace("_", " ") for k in order]
    axes.set_yticks(rows, [style.wrapped(name, NAME_WIDTH) for name in names])
    axes.set_ylim(len(rows) - 0.4, -0.6)
    axes.grid(visible=False, axis="y")
    axes.axvline(0.0, color=style.REFERENCE, linewidth=0.8)
    axes.set_xlabel(shown.label)
    if result.is_share:
        axes.set(
            xlim=(0.0, 1.0), xlabel=f"share of the variance of {points.response.key}"
        )
    if not math.isnan(result.noise):
        axes.axvline(factor * result.noise, color=style.MUTED, linestyle="dotted")
    return finished("sensitivity", sheet, pens, key=points.response.key, result=result)


def curves(points: Points) -> list[Drawing]:
    """Draw a response over the parameter with most values, a line for each value of another.

    Empty if the points are not a grid of one or two parameters with at most five lines.
    """
    levels = [np.unique(column) for column in points.points.T]
    varied = [k for k, values in enumerate(levels) if len(values) > 1]
    varied.sort(key=lambda k: (bool(points.parameters[k].choices), -len(levels[k])))
    size = math.prod(len(levels[k]) for k in varied)
    if len(varied) not in (1, 2) or size != len(points.means):
        return []
    along, *rest = varied
    groups = levels[rest[0]] if rest else np.zeros(1)
    if points.parameters[along].choices or len(groups) > len(LINES):
        return []
    sheet, ((axes,),) = style.panels(1, 1, 3.6)
    x_axis = _axis(
        axes, "x", points.parameters[along], points.points[:, along], style.WIDTH
    )
    y_axis = Display(points.response, points.means)
    pens = []
    half_widths = points.half_widths
    for value, line in zip(groups, LINES, strict=False):
        label = points.response.key
        rows = points.has_value
        if rest:
            group = Display(points.parameters[rest[0]], levels[rest[0]])
            label = f"{group.column.key} = {group.text(value)}"
            rows = rows & (points.points[:, rest[0]] == value)
        order = np.flatnonzero(rows)[np.argsort(points.points[rows, along])]
        x = x_axis.factor * points.points[order, along]
        y = y_axis.factor * points.means[order]
        half = y_axis.factor * half_widths[order]
        pens.append(Pen(label, *line))
        axes.fill_between(
            x, y - half, y + half, color=line[0], alpha=0.2, linewidth=0.0
        )
        pens[-1].draw(axes, x, y, marker="o", markersize=3.5)
    axes.set_ylabel(style.wrapped(f"{y_axis.label}, {points.response.text}", 3.2))
    key = points.response.key
    name = points.parameters[along].key
    return finished(
        "lines", sheet, pens if rest else (), key=key, points=points, along=name
    )


def heat_map(
    points: Points, pair: tuple[int, int], surrogate: Surrogate | None
) -> list[Drawing]:
    """Draw the points over two parameters, with the surrogate at the median of the others."""
    sheet, ((axes,),) = style.panels(1, 1, 4.2, is_measured=True)
    across, up = (points.points[:, k] for k in pair)
    x_axis = _axis(axes, "x", points.parameters[pair[0]], across, style.WIDTH)
    y_axis = _axis(axes, "y", points.parameters[pair[1]], up, 4.0)
    shown = Display(points.response, points.means)
    means = shown.factor * points.means
    norm = Normalize(float(np.nanmin(means)), float(np.nanmax(means)))
    if surrogate is not None:
        x, y = (
            (np.geomspace if is_logarithmic(one) else np.linspace)(
                one.min(), one.max(), CELLS
            )
            for one in (across, up)
        )
        grid = np.tile(np.median(points.points, axis=0), (CELLS * CELLS, 1))
        for k, values in zip(pair, np.meshgrid(x, y), strict=True):
            grid[:, k] = values.ravel()
        level = shown.factor * surrogate.predict(grid).reshape(CELLS, CELLS)
        x, y = x_axis.factor * x, y_axis.factor * y
        axes.pcolormesh(x, y, level, norm=norm, cmap=COLOURS, shading="gouraud")
    x, y = x_axis.factor * across, y_axis.factor * up
    for marker, rows in (("o", ~points.censored), ("^", points.censored)):
        rows = rows & points.has_value
        line_style = {"norm": norm, "cmap": COLOURS, "edgecolors": "white"}
        axes.scatter(x[rows], y[rows], c=means[rows], marker=marker, **line_style)
    axes.scatter(
        x[~points.has_value], y[~points.has_value], color=style.REFERENCE, marker="x"
    )
    axes.grid(visible=False)
    sheet.colorbar(ScalarMappable(norm, COLOURS), ax=axes, label=shown.label)
    names = [points.parameters[k].key for k in pair]
    return finished(
        "map", sheet, key=points.response.key, names=names, surrogate=surrogate
    )


def distribution(points: Points, spread: Spread, limit: Limit | None) -> list[Drawing]:
    """Draw the cumulative distribution of a response with its 95 % band and its limit."""
    sheet, ((axes,),) = style.panels(1, 1, 3.6)
    shown = Display(points.response, spread.values)
    percent = 100.0 * PROBABILITIES
    pens = [Pen("cumulative probability, 95 % band", *LINES[0])]
    pens[0].draw(axes, shown.factor * spread.values, percent)
    ends = zip((spread.low, spread.high), axes.get_xlim(), strict=True)
    low, high = (
        np.where(np.isnan(end), edge, shown.factor * end) for end, edge in ends
    )
    axes.fill_betweenx(
        percent, low, high, color=pens[0].colour, alpha=0.25, linewidth=0.0
    )
    if limit is not None:
        pens.append(
            Pen(f"limit {shown.text(limit.value)}", style.REFERENCE, LINES[3][1])
        )
        axes.axvline(shown.factor * limit.value, **pens[-1].line_style)
    axes.set(
        ylim=(0.0, 100.0),
        xlabel=shown.label,
        ylabel="probability of a smaller value (%)",
    )
    return finished(
        "distribution", sheet, pens, key=points.response.key, source=spread.source
    )
