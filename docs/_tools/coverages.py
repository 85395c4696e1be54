"""Write the coverage of intervals into its page:  python docs/_tools/coverages.py results/coverage

The folder is that of ``pytest -m coverage``, finished or interrupted.
"""

import re
import sys
from collections.abc import Iterable, Mapping
from pathlib import Path

import presswear as pw

DOCS = Path(__file__).parents[1]
sys.path.insert(0, str(DOCS.parent / "tests"))
from intervals.coverage import SUBJECTS, Coverage, table  # noqa: E402

PAGE = DOCS / "validation" / "intervals.md"
RANGE = 0.9, 0.99  # of the intervals, which should hold
Columns = Mapping[str, list[Coverage]]  # by the heading of a column
MOTORS = ("four-bar-motor",)  # subjects in the table of motors


def coverages_of(folder: Path) -> dict[str, list[list[Coverage]]]:
    """Return the coverages of the finished tries of each subject, by stage."""
    coverages = {}
    for name, subject in SUBJECTS.items():
        paths = filter(_is_finished, sorted((folder / name).glob("*")))
        results = {path.name: pw.load(path) for path in paths}
        stages = range(1 + subject.scene.wear_updates)
        coverages[name] = [table(results, stage) for stage in stages]
    return coverages


def _is_finished(path: Path) -> bool:
    return (path / "result.json").exists() and pw.load(path).status != "running"


def row_name(coverage: Coverage, subject: str) -> str:
    """Return a quantity, without its joint where the linkage has one joint with clearance."""
    joints = SUBJECTS[subject].scene.clearance_joints
    text = coverage.quantity.removesuffix(", of a cycle")
    return text if len(joints) > 1 else re.sub(rf" {joints[0]}\b", "", text)


def counts(columns: Columns, subjects: Iterable[str]) -> list[str]:
    """Return a table of the intervals that hold, with a row for each quantity."""
    cells: dict[str, dict[str, str]] = {}
    for (heading, rows), subject in zip(columns.items(), subjects, strict=True):
        for row in rows:
            stated = int(row.stated.sum())
            text = (
                f"{int(row.right[row.stated].sum())} of {stated}"
                if stated
                else "none stated"
            )
            cells.setdefault(row_name(row, subject), {})[heading] = text
    lines = [f"| interval | {' | '.join(columns)} |", f"|---|{'---:|' * len(columns)}"]
    for name, texts in cells.items():
        lines.append(
            f"| {name} | {' | '.join(texts.get(column, '') for column in columns)} |"
        )
    return lines


def sentences(columns: Columns, where: str) -> list[str]:
    """Return sentences on all intervals of a table."""
    every = []
    for name, rows in columns.items():
        every += [(name, row) for row in rows if row.stated.any()]
    if not every:  # no run of these scenes has finished yet
        return []
    right = sum(int(row.right[row.stated].sum()) for _, row in every)
    stated = sum(int(row.stated.sum()) for _, row in every)
    within = sum(RANGE[0] <= row.share <= RANGE[1] for _, row in every)
    fewest = min(every, key=lambda item: item[1].share)
    one_motion = (item for item in every if not item[1].says_mixed.any())
    bias = max(one_motion, key=lambda item: abs(item[1].bias), default=fewest)
    lines = [
        f"- {where.capitalize()}, {right:,} of {stated:,} intervals hold, "
        f"{100.0 * right / stated:.1f} %. Of {len(every)} counts, {within} are from "
        f"{100.0 * RANGE[0]:.0f} to {100.0 * RANGE[1]:.0f} %.",
        f"- The lowest count is that of {_cell(*fewest)}, {100.0 * fewest[1].share:.0f} %. The "
        f"largest bias is that of {_cell(*bias)}, {bias[1].bias:+.2f} half widths.",
    ]
    below = [_cell(*item) for item in every if item[1].share < RANGE[0]]
    above = sum(row.share > RANGE[1] for _, row in every)
    if below:
        lines.append(f"- Below {100.0 * RANGE[0]:.0f} %: {'; '.join(below)}.")
    if above:
        lines.append(
            f"- Above {100.0 * RANGE[1]:.0f} %: {above}, where every interval holds."
        )
    for name, rows in columns.items():
        mixed = int(rows[0].says_mixed.sum()) if rows else 0
        if mixed:
            total = len(rows[0].says_mixed)
            lines.append(
                f"- {name}: {mixed} of {total} runs say that some replicates have settled and "
                "others have not. They count as right."
            )
    return lines


def _cell(heading: str, coverage: Coverage) -> str:
    return f"{coverage.quantity.removesuffix(', of a cycle')} ({heading})"


def results_of(coverages: Mapping[str, list[list[Coverage]]]) -> str:
    """Return the tables of new and of worn surfaces with their sentences."""
    new = {}
    for name, stages in coverages.items():
        if len(stages) == 1 and stages[0]:
            new[name] = stages[0]
    lines = [*counts(new, new), "", *sentences(new, "on new surfaces")]
    for name, stages in coverages.items():
        if len(stages) > 1 and stages[0]:
            headings = ["before the wear"]
            headings += [f"after wear {k}" for k in range(1, len(stages))]
            worn = dict(zip(headings, stages, strict=True))
            lines += ["", f"`{name}`, worn in steps:", ""]
            lines += [*counts(worn, [name] * len(worn)), ""]
            lines += sentences(dict([*worn.items()][:1]), "before the wear")
            lines += sentences(dict([*worn.items()][1:]), "after it")
    return "\n".join(lines)


def fill(folder: Path) -> None:
    """Write the tables between their marks; one without a finished run stays as it is."""
    coverages = coverages_of(folder)
    motors = {name: coverages.pop(name) for name in MOTORS}
    text = PAGE.read_text(encoding="utf-8")
    for mark, subjects in {"result": coverages, "motor": motors}.items():
        if any(stages[0] for stages in subjects.values()):
            marks = rf"(?s)(<!-- {mark} -->\n).*?(<!-- end -->)"
            results = results_of(subjects)
            text = re.sub(marks, rf"\g<1>\n{results}\n\n\g<2>", text)
    PAGE.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    fill(Path(sys.argv[1]))
