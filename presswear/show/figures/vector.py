"""Figures as SVG within a page: plain texts, short numbers, no names of its elements."""

import io
import re
from pathlib import Path

import matplotlib
from matplotlib.backends.backend_svg import FigureCanvasSVG

from presswear.show.figures.style import SETTINGS, Drawing
from presswear.tools.files import write_bytes

# Vertices of a curve that are nearer to a straight line than 0.2 points are left out.
_SETTINGS = {
    **SETTINGS,
    "svg.fonttype": "none",
    "path.simplify_threshold": 0.2,
    "font.sans-serif": ["DejaVu Sans"],
}
# Start of a file, by which this program recognizes its files
FILE_HEAD = (
    '<svg class="presswear" xmlns="http://www.w3.org/2000/svg" '
    'xmlns:xlink="http://www.w3.org/1999/xlink" '
    'style="stroke-linejoin: round; stroke-linecap: butt" '
)
_NUMBERS = re.compile(r'\b(?:d|transform|x|y|x1|y1|x2|y2|width|height)="[^"]*"')
_DECIMALS = re.compile(r"-?\d+\.\d+")
# Path of straight lines
_POLYLINES = re.compile(r'\bd="(M(?: -?[\d.]+ -?[\d.]+ ?[MLz]?)+)"')
_COMMANDS = re.compile(r"([MLz])([^MLz]*)")
_NAMED = re.compile(r' id="(?![mp][0-9a-f]{10}")[^"]*"')  # except markers and clips
_HEAD = re.compile(
    r"<svg .*?viewBox=\"([^\"]*)\"[^>]*>.*?(?=<defs>\s*<style|<g )", re.DOTALL
)


def svg_of(drawing: Drawing) -> str:
    """Return a drawing as an ``svg`` element that any page can hold."""
    file = io.StringIO()
    # The digest of markers and clips contains the file, so that figures share no name.
    with matplotlib.rc_context({**_SETTINGS, "svg.hashsalt": drawing.file}):
        FigureCanvasSVG(drawing.sheet).print_svg(file, metadata={"Date": None})
    text = file.getvalue()
    text = text[text.index("<svg ") :]
    text = re.sub(r"<metadata>.*?</metadata>|<!--.*?-->", "", text, flags=re.DOTALL)
    text = _HEAD.sub(r'<svg viewBox="\1">', text, count=1)
    text = re.sub(
        r"<defs>\s*<style.*?</style>\s*</defs>", "", text, count=1, flags=re.DOTALL
    )
    text = _NAMED.sub("", text)
    text = text.replace("'DejaVu Sans', sans-serif", "sans-serif")
    text = _NUMBERS.sub(lambda match: _short(match[0]), text)
    text = _POLYLINES.sub(lambda match: f'd="{_relative(match[1])}"', text)
    return re.sub(r"\s*\n\s*", "\n", text)


def write_svg(svg: str, path: Path) -> Path:
    """Write an ``svg`` element as a file ``.svg`` of the same name; return its path."""
    file = path.with_suffix(".svg")
    file.parent.mkdir(parents=True, exist_ok=True)
    write_bytes(file, svg.replace("<svg ", FILE_HEAD, 1).encode())
    return file


def _short(text: str) -> str:
    """Return an attribute with numbers to a hundredth of a point."""
    text = _DECIMALS.sub(lambda match: _two_decimals(float(match[0])), text)
    return re.sub(r" ?\n", "", text)


def _two_decimals(number: float) -> str:
    """Return a number to a hundredth, without zeros at its end."""
    return f"{number:.2f}".rstrip("0").rstrip(".")


def _relative(path: str) -> str:
    """Return a path whose lines are steps from point to point, which takes half the text."""
    parts = []
    x = y = 0
    start = (0, 0)
    command = ""
    for letter, numbers in _COMMANDS.findall(path):
        if letter == "z":
            parts.append("z")
            x, y = start
            command = "z"
            continue
        to_x, to_y = (round(100.0 * float(number)) for number in numbers.split())
        if letter == "M":
            parts.append(f"M{_hundredths(to_x)}{_hundredths(to_y)}")
            start = (to_x, to_y)
        else:
            head = "" if command == "L" else "l"
            parts.append(f"{head}{_hundredths(to_x - x)}{_hundredths(to_y - y)}")
        x, y = to_x, to_y
        command = letter
    return "".join(parts).replace("l ", "l").replace("M ", "M")


def _hundredths(count: int) -> str:
    """Return a number of hundredths as a decimal, after the separator from the previous number."""
    text = _two_decimals(abs(count) / 100.0).removeprefix("0") or "0"
    return f"-{text}" if count < 0 else f" {text}"
