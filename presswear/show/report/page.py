"""One HTML file from a template: figures inside, opens anywhere."""

import base64
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from jinja2 import ChoiceLoader, Environment, PackageLoader, StrictUndefined

from presswear.show.figures import Figure

_ROOM = "presswear.show.report"


@dataclass(frozen=True)
class Illustration:
    """A figure inside a page: PNG as text."""

    title: str
    caption: str
    data: str

    @staticmethod
    def of(figure: Figure, folder: Path) -> "Illustration":
        """From a figure that was written into a folder."""
        data = base64.b64encode((folder / figure.file).read_bytes()).decode()
        return Illustration(figure.title, figure.caption, data)


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
