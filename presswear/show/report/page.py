"""One HTML file from a template: figures inside, opens anywhere."""

import base64
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from jinja2 import ChoiceLoader, Environment, PackageLoader, StrictUndefined

from presswear.show.figures import Drawing, save

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
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    return environment.get_template(template).render(**content)
