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
    sections = [
        Section("Factors on each quantity", figures=figures, is_open=True),
        *(
            _section(improvement.heading(key), items, folder)
            for key, items in improvement.effects.items()
        ),
    ]
    if improvement.failures:
        lines = improvement.failures.items()
        table = plain_table(("change", "reason"), lines, numeric=False)
        sections.append(Section("Runs that failed", tables=[("", table)]))
    text = page.render_page(
        f"{title_of(scene)}: changes of one joint at a time",
        page.FirstScreen(),
        sections,
        answer=[f"{line[:1].upper()}{line[1:]}." for line in improvement.sentences],
    )
    file = folder / REPORT
    write_bytes(file, text.encode())
    return file


def _section(heading: str, items: list[Effect], folder: Path) -> Section:
    """Return the section of a quantity, with the command that compares the first change."""
    lines = [
        (one.change, readable(one.factor.mean), _interval(one), _verdict(one))
        for one in items
    ]
    notes = []
    if items:
        runs = (folder / name_for(name) for name in (PLAIN, items[0].change))
        command = " ".join(shlex.quote(f"{run}") for run in runs)
        notes.append(f"Side by side with the first change: presswear report {command}")
    table = plain_table(_HEAD, lines, numeric=False)
    return Section(f"{heading[:1].upper()}{heading[1:]}", (), [("", table)], (), notes)


def _interval(effect: Effect) -> str:
    low, high = effect.factor.low, effect.factor.high
    if low is None or high is None:
        return NOTHING
    return f"{readable(low)} to {readable(high)}"


def _verdict(effect: Effect) -> str:
    low, high = effect.factor.low, effect.factor.high
    if low is None or high is None or low <= 1.0 <= high:
        return "not certain"
    return "certain improvement" if effect.is_better else "certainly worse"
