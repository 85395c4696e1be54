"""One HTML file from a template: figures inside, opens anywhere."""

import base64
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from jinja2 import ChoiceLoader, Environment, PackageLoader, StrictUndefined

from presswear.show.figures import Drawing, save
from presswear.tools.workers import Report, cores, outcomes, workers_for

_ROOM = "presswear.show.report"


@dataclass(frozen=True)
class Illustration:
    """A figure inside a page: its file's name, and the PNG as text."""

    file: str
    title: str
    caption: str
    data: str


def illustrate(drawing: Drawing, folder: Path) -> Illustration:
    """Write a drawing into a folder, and give it for a page."""
    data = base64.b64encode(save(drawing, folder).read_bytes()).decode()
    return Illustration(drawing.file, drawing.title, drawing.caption, data)


Words = dict[str, Any]
"""What a page says, by the names in its template."""
Drawer = Callable[[], list[Drawing]]
"""Draws some figures; can be pickled."""
_SHARES = 3
"""Of the figures for each process, so that all end at about the same time."""


def illustrated(
    words: Callable[[], Words], drawers: Sequence[Drawer], folder: Path, at_once: int | None = None
) -> tuple[Words, list[Illustration]]:
    """What a page says and its figures, found in processes of their own.

    Parameters
    ----------
    words : callable
        Gives what the page says; can be pickled.
    drawers : sequence of callable
    folder : path
        Where figures are written.
    at_once : int or None
        Processes, at most; one: this one.  None: as many as there are cores.

    Returns
    -------
    words : dict
    figures : list of Illustration
        In the order of what draws them.
    """
    count = min(at_once or cores(), len(drawers))
    # What drawers have in common goes to a process once a share.
    parts = min(_SHARES * count, len(drawers))
    shares = [partial(_share, drawers[k::parts], folder) for k in range(parts)]
    with workers_for(count, (__name__,)) as workers:
        said, *found = outcomes(workers, [partial(_said, words), *shares])
    drawn = (found[k % parts][k // parts] for k in range(len(drawers)))
    return said, [illustration for own in drawn for illustration in own]


def _said(words: Callable[[], Words], report: Report) -> Words:
    """What a page says."""
    report(0.0)
    return words()


def _share(drawers: Sequence[Drawer], folder: Path, report: Report) -> list[list[Illustration]]:
    """Draw some of them, one after the other."""
    found = []
    for k, draw in enumerate(drawers):
        report(float(k))
        found.append([illustrate(drawing, folder) for drawing in draw()])
    return found


_INTERVAL = re.compile(r" \(\S+ to \S+?( %)?\)")
"""The ends of an interval; it begins with a blank, of which there are none in a figure's data."""


def _on_one_line(value: Any) -> Any:
    """What a page shows, where intervals must not be broken; what is markup already stays."""
    if type(value) is not str:
        return value
    return _INTERVAL.sub(lambda found: found[0].replace(" ", "\N{NO-BREAK SPACE}"), value)


def render_page(template: str, package: str = _ROOM, **content: Any) -> str:
    """The text of a page; everything in it is escaped.

    Parameters
    ----------
    template : str
        File in the ``templates`` of a package; it may build on those of the report.
    package : str
        Name of that package.
    content
        Names that the template knows.
    """
    environment = Environment(
        loader=ChoiceLoader([PackageLoader(package), PackageLoader(_ROOM)]),
        autoescape=True,
        finalize=_on_one_line,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    return environment.get_template(template).render(**content)
