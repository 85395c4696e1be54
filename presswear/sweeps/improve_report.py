"""Report of an improvement: answers, bars that start at 1, and the factors in tables."""

import shlex
from pathlib import Path

from presswear.scene.catalog import title_of
from presswear.scene.scene import Scene
from presswear.show import page
from presswear.show.page import NOTHING, Section, plain_table
from presswear.sweeps.improve import PLAIN, Effect, Improvement
from presswear.tools.files import inside, name_for, write_bytes
from presswear.tools.numbers import readable

REPORT = "report.html"
_HEAD = ("change", "factor", "95 % interval", "verdict")


def write_report(improvement: Improvement, scene: Scene, folder: Path) -> Path:
    """Write ``report.html`` and its figure into the folder of an improvement; return the page."""
    figures = page.illustrated([improvement.draw()], inside(folder, "figures"))
    sections = [Section("Factors on each quantity", figures=figures, is_open=True)]
    for quantity, effects in improvement.effects.items():
        sections.append(_section(improvement.heading(quantity), effects, folder))
    if improvement.failures:
        rows = improvement.failures.items()
        table = plain_table(("change", "reason"), rows, numeric=False)
        sections.append(Section("Runs that failed", tables=[("", table)]))
    text = page.render_page(
        f"{title_of(scene)}: changes of one joint at a time",
        page.FirstScreen(),
        sections,
        answer=[f"{_capitalized(text)}." for text in improvement.sentences],
    )
    file = folder / REPORT
    write_bytes(file, text.encode())
    return file


def _capitalized(text: str) -> str:
    return text[:1].upper() + text[1:]


def _section(heading: str, effects: list[Effect], folder: Path) -> Section:
    """Return the section of a quantity, with the command that compares the first change."""
    rows = []
    for effect in effects:
        interval = NOTHING
        if effect.interval:
            interval = " to ".join(map(readable, effect.interval))
        factor = readable(effect.factor.mean)
        rows.append((effect.change, factor, interval, effect.verdict))
    table = plain_table(_HEAD, rows, numeric=False)
    notes = []
    if effects:
        plain = shlex.quote(f"{folder / name_for(PLAIN)}")
        changed = shlex.quote(f"{folder / name_for(effects[0].change)}")
        command = f"presswear report {plain} {changed}"
        notes.append(f"Side by side with the first change: {command}")
    return Section(_capitalized(heading), tables=[("", table)], notes=notes)
