"""Write the table of the numbers of each cycle in how-to/results.md:  python docs/_tools/columns.py

``docs/_tools/outputs.py`` calls this.
"""

import re
from pathlib import Path

from presswear.recording import columns

PAGE = Path(__file__).parents[1] / "how-to" / "results.md"
TABLES = {
    "linkage": columns.CYCLE,
    "each joint": columns.JOINT_CYCLE,
    "with a motor": columns.LEADER_CYCLE,
    "each joint with an oil film in the run": columns.FILM_CYCLE,
    "each drive": columns.DRIVE_CYCLE,
}


def column_table() -> str:
    """Return the columns of ``cycles`` with their units and meanings, in their order."""
    lines = [
        "| of | column | unit | meaning | mean in the report |",
        "|---|---|---|---|---|",
    ]
    for owner, table in TABLES.items():
        for column in table:
            cells = owner, f"`{column.name}`", column.unit, column.text
            lines.append(f"| {' | '.join(cells)} | {column.mean_label} |")
    return "\n".join(lines)


def filled(text: str) -> str:
    """Return the text of the page with the table between its marks."""
    marks = re.compile(r"(<!-- columns -->\n).*?(<!-- end -->)", re.DOTALL)
    return marks.sub(lambda match: f"{match[1]}\n{column_table()}\n\n{match[2]}", text)


def fill() -> None:
    """Write the table into the page."""
    PAGE.write_text(filled(PAGE.read_text()))


if __name__ == "__main__":
    fill()
