"""Write the results in README.md.

    python docs/_tools/readme.py         # the table, and the life that is stored
    python docs/_tools/readme.py life    # compute and store the life first, 5 to 15 minutes

``docs/_tools/outputs.py`` calls the first one.
"""

import json
import math
import re
import sys
from dataclasses import replace
from pathlib import Path

import presswear as pw
from presswear.tools.numbers import readable

README = Path(__file__).parents[2] / "README.md"
LIFE = README.parent / "docs" / "_outputs" / "readme-life.json"
LIMIT = "50 um"  # depth that ends the life


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


def store_life() -> None:
    """Compute the service life, ``presswear life press-blanking --engine dae``, and store it."""
    scene = pw.changed(
        pw.scenes.press_blanking(engine="dae"), {"conventions": "refined"}
    )
    life = pw.run(replace(scene, life=pw.Life(f"depth > {LIMIT}"))).life
    assert life is not None
    strokes = life.interval
    numbers = {"strokes": strokes.mean, "low": strokes.low, "high": strokes.high}
    LIFE.write_text(json.dumps(numbers, indent=1) + "\n")


def life_text() -> str:
    """Return the stored life as a text, without and with the scatter of wear coefficients."""
    life = json.loads(LIFE.read_text())
    strokes, low, high = (1e-6 * life[key] for key in ("strokes", "low", "high"))
    scatter = pw.linkage.Materials().wear_scatter
    deviation = 1.96 * math.sqrt(math.log1p(scatter**2))  # of ln, 95 %
    factor = math.exp(math.hypot(0.5 * math.log(high / low), deviation))
    return (
        f"{strokes:.1f} million strokes ({low:.1f} to {high:.1f} million) until a joint\n"
        f"is worn by {LIMIT.replace('u', 'µ')}, for an exact wear coefficient, and "
        f"with the scatter of wear coefficients ({100.0 * scatter:.0f} %, literature)\n"
        f"{readable(strokes / factor, 2)} to {readable(strokes * factor, 2)} million"
    )


def with_life(text: str) -> str:
    """Return the text of README with the stored life between its marks."""
    marks = r"(?s)(<!-- life -->).*?(<!-- end life -->)"
    return re.sub(marks, lambda match: f"{match[1]}{life_text()}{match[2]}", text)


def fill() -> None:
    """Write the table and the life between their marks."""
    text = README.read_text()
    marks = r"(?s)(<!-- result -->\n).*?(<!-- end -->)"
    filled = re.sub(
        marks, lambda match: f"{match[1]}\n{result_table()}\n\n{match[2]}", text
    )
    filled = with_life(filled)
    if filled != text:
        README.write_text(filled)


if __name__ == "__main__":
    if sys.argv[1:] == ["life"]:
        store_life()
    fill()
