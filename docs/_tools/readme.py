"""Write the table of results in README.md:  python docs/_tools/readme.py

``docs/_tools/outputs.py`` calls this.
"""

import re
from pathlib import Path

import presswear as pw
from presswear.tools.numbers import readable

README = Path(__file__).parents[2] / "README.md"


def result_table(cycles: int = 20) -> str:
    """Compute the table: the command above it in README, in memory."""
    result = pw.run(pw.scenes.press_blanking(cycles=cycles))
    new, worn = (stage.statistics for stage in result.stages)
    rows: list[tuple[str, pw.statistics.Estimate]] = []
    for name in ("A", "C"):
        rows.append(
            (
                f"peak force of a stroke at {name}, new (N)",
                new.joints[name].peak_force_per_cycle,
            )
        )
        peaks = worn.joints[name].peak_force_per_cycle
        rows.append((f"peak force of a stroke at {name}, worn (N)", peaks))
        wear = new.joints[name].wear_peaks["bearing"].depth
        rows.append((f"wear depth of the bearing at {name} (µm)", wear.scaled(1e6)))
    if new.bdc:
        rows.append(
            ("error of bottom dead centre, new (mm)", new.bdc.error.scaled(1e3))
        )
    texts = [(label, *map(readable, (x.mean, x.low, x.high))) for label, x in rows]
    lines = [
        f"| {label} | {mean} | {low} to {high} |" for label, mean, low, high in texts
    ]
    return "\n".join(["| | mean | 95 % interval |", "|---|---:|---:|", *lines])


def fill() -> None:
    """Write the table between its marks."""
    text = README.read_text()
    marks = r"(?s)(<!-- result -->\n).*?(<!-- end -->)"
    filled = re.sub(
        marks, lambda match: f"{match[1]}\n{result_table()}\n\n{match[2]}", text
    )
    if filled != text:
        README.write_text(filled)


if __name__ == "__main__":
    fill()
