"""A result in a notebook: headline, key numbers and one picture."""

from markupsafe import Markup, escape

from presswear.results.result import Result
from presswear.scene.catalog import title_of
from presswear.show import page
from presswear.show.figures import FIRST, drawn_if_stored
from presswear.show.key_numbers import key_numbers


def html_of(result: Result) -> str:
    """Return the headline of a result, its key numbers and its first figure as HTML."""
    message = f": {result.message}" if result.message else ""
    folder = f", in {result.path}" if result.path else ""
    headline = f"{title_of(result.scene)}: {result.status}{message}{folder}"
    row = Markup("<tr><th style='text-align: left'>{}</th><td>{}</td><td>{}</td></tr>")
    rows = Markup("")
    for number in key_numbers(result):
        rows += row.format(number.title, number.value, number.interval)
    text = Markup("<p><b>{}</b></p><table>{}</table>{}")
    return str(text.format(headline, rows, Markup(_picture(result))))


def _picture(result: Result) -> str:
    """Return the first figure that shows something as an element, or nothing."""
    for name in FIRST:
        if drawings := drawn_if_stored(name, result, result.stages):
            (figure,) = page.drawn_inline(drawings[:1])
            caption = escape(figure.title)
            return f"<div style='max-width: 60rem'>{figure.svg}<p>{caption}</p></div>"
    return ""
