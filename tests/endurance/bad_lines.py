"""Command lines that must be refused, drawn at random; each is bad by construction.

A line is misspelt, beyond a range of the scene, or without its unit.
"""

import math
import re
from collections.abc import Callable
from random import Random
from typing import Any

from presswear.scene.catalog import SCENES, slider_crank, wear_times
from presswear.scene.setting_list import settings_of
from presswear.tools.choices import Choice
from presswear.tools.quantities import Quantity

Family = Callable[[Random], list[str]]  # draws a command line of a kind

FILE, FOLDER = "../a-file", "../a-folder"  # the folder is not empty
_PRESS = wear_times()
_CRANK = slider_crank()
_KEYS = {
    scene.name: {setting.key for setting in settings_of(scene)}
    for scene in (_PRESS, _CRANK)
}
# Units that do not belong to a dimension.
NOT_UNITS_OF = {
    "m": "kg, Pa, s, rad/s, m/s, %, M, MM, inch",
    "rad/s": "m, kg, s, rad, m/s, 1/s",
    "rad": "m, rad/s, °, grad, s",
    "kg": "m, Pa, lb, kg m^2, N",
    "kg m^2": "kg, m, kg m, kg m^3, g m^2",
    "Pa": "m, kg, mPa, 1/Pa, N",
    "1/Pa": "Pa, m, /GPa, 1/m, /",
    "Pa s": "Pa, s, N s/m, kg, 1/s",
    "W/m^2": "m, kg, s, rad, 1/Pa",
    "1/m": "m, 1/Pa, 1/s, /",
    "s/m": "s, m, m/s, N s/m",
    "N s/m": "N, N/m, s/m, N m, kg",
    "N/m": "N, m, N m, N s/m, Pa",
    "N/m^n": "N, N m, Pa, N/m^2, kg",
    "N": "kg, Pa, N m, N/m, g",
    "N m": "N, m, kg, N/m, Pa",
    "m/s": "m, s, rad/s, m/s^2, km/h",
    "m/s^2": "m/s, m, g, N",
    "s": "m, Hz, 1/s, h",
    "": "m, mm, rad, kg, x, pi",
}
_NO_NUMBER_TEXTS = (
    "nan NaN -nan inf -inf Infinity none None null True e5 . - --5 +-5 1e 0x10 1,5 1_000 1+1 2*3 "
    "2**8 1/3 (1) __import__('os').getcwd() ${HOME} `ls` %s {0} 1e400 -1e400 1e99999999 ١٢٣ １２ "
    "² ½ −5 \x1b[31m5 \udcff \u202e5"
)
_NO_NUMBERS = (*_NO_NUMBER_TEXTS.split(), "", " ", "5\x00", "5\n6", "9" * 5000)
_NO_COUNTS = ("0", "-1", "1.5", "many", "", "1e400", "nan", "٣", "9" * 5000)
# Folders that cannot be written into.
_PLACES = (
    FOLDER,
    FILE,
    f"{FILE}/below",
    "",
    " ",
    "a\0b",
    "n" * 300,
    "x/" + "y" * 256,
    "a\nb",
    "\udcff",
    "\x1b[2J",
    "/proc/none/x",
    "/dev/null",
    "/dev/null/x",
)
_ALPHABETS = (range(32, 127), range(32), range(0x80, 0xD800), range(0xE000, 0x110000))
_LINES = (
    """
run {scene} --cycles={count}|run {scene} --wear_updates={text}|run {scene} --wear_updates=-1
run {scene} --wear_updates={many}|run {scene} --tolerance={count}|run {scene} --engine={text}
run {scene} --conventions={text}|run {scene} --out={place}|run {scene} --on=no/{text}
run friction --jobs={count}|run ideal --set={word}|run ideal --engine|run ideal ideal|run|run --set
crosscheck --duration={text}|crosscheck --duration=1e300|crosscheck --until={no_count}
crosscheck --set=clearance=1|crosscheck ideal --against={text}.csv|crosscheck --out=x --until=1
crosscheck {folder} --against {file}|benchmark --repeats={count}|benchmark --out={place}
export {folder} a.csv --stage={count}|export no/{text} a.csv|export x|report no/{text}|report
verify x|verify --hard|list ideal friction
no{text}|{command} no{text}|{command} --x{word}|{command} --x{word}={text}
""".strip()
    .replace("\n", "|")
    .split("|")
)


def _text(draw: Random) -> str:
    alphabets = (_ALPHABETS[0], *_ALPHABETS)
    return "".join(
        chr(draw.choice(draw.choice(alphabets))) for _ in range(draw.randrange(40))
    )


def _wild(draw: Random) -> str:
    """Return any text that does not begin like a number."""
    text = _text(draw)
    while re.match(r"\s*[+-]?\.?[0-9]", text):
        text = _text(draw)
    return text


def _filled(draw: Random) -> list[str]:
    text = _wild(draw)
    no_count = draw.choice(_NO_COUNTS)
    fills = {
        "text": text,
        "word": text.replace("=", ""),
        "no_count": no_count,
        "count": draw.choice((no_count, text)),
        "many": draw.randint(21, 10**30),
        "scene": draw.choice([*SCENES]),
        "command": draw.choice(("run", "list", "benchmark", "crosscheck")),
        "place": draw.choice(_PLACES),
        "folder": FOLDER,
        "file": FILE,
    }
    return [word.format(**fills) for word in draw.choice(_LINES).split()]


def _of_setting(
    kind: type, text: Callable[[Random, Any], str], is_whole: bool = False
) -> Family:
    """Return a family of lines with a bad text for a quantity or choice of a scene."""
    settings = [
        (scene, setting)
        for scene in (_PRESS, _CRANK)
        for setting in settings_of(scene)
        if isinstance(setting.meaning, kind)
        and getattr(setting.meaning, "whole", False) >= is_whole
    ]

    def line(draw: Random) -> list[str]:
        scene, setting = draw.choice(settings)
        return ["run", scene.name, f"--set={setting.key}={text(draw, setting.meaning)}"]

    return line


def _no_number(draw: Random, meaning: Quantity) -> str:
    text = draw.choice((draw.choice(_NO_NUMBERS), _wild(draw)))
    return draw.choice((text, f"{text} {meaning.unit}".rstrip(" ")))


def _wrong_unit(draw: Random, meaning: Quantity) -> str:
    """Return a number with the unit of another dimension, or without the unit it needs."""
    units = NOT_UNITS_OF[meaning.unit].split(", ") + ([""] if meaning.unit else [])
    value = draw.choice((0.0, 100.0, *(draw.uniform(0.0, 100.0) for _ in range(8))))
    return f"{value!r} {draw.choice(units)}".strip()


def _beyond(draw: Random, meaning: Quantity) -> str:
    """Return a value outside its range, on either side, just outside or far."""
    far = draw.choice((0.0, 5e-324, 1e-12, 1.0, 1e10, 1e300, draw.uniform(0.0, 1e300)))
    is_above = draw.random() < 0.5
    if meaning.whole:
        value = meaning.high + 1 + int(far) if is_above else meaning.low - 1 - int(far)
        return f"{value:.0f}"
    if is_above:
        value = max(math.nextafter(meaning.high, math.inf), meaning.high + far)
    elif meaning.open_low and far < 1.0:
        value = meaning.low
    else:
        value = min(math.nextafter(meaning.low, -math.inf), meaning.low - far)
    return f"{value!r} {'/Pa' if meaning.unit == '1/Pa' else meaning.unit}".strip()


def _no_choice(draw: Random, choice: Choice) -> str:
    text = draw.choice(
        ("", "Paper", "PAPER", "paper ,", "all", "0", "on;off", _wild(draw))
    )
    return text if text.strip() not in choice.words else f"no {text}"


def _unknown_key(draw: Random) -> list[str]:
    """Return a line with a key that is misspelt or belongs to another mechanism."""
    scene = draw.choice((_PRESS, _CRANK))
    here = _KEYS[scene.name]
    all_keys = sorted(_KEYS[_PRESS.name] | _KEYS[_CRANK.name])
    strange = ("__class__", "name", "title", "origins", "mechanism", "bearings.width")
    while True:
        name = draw.choice(all_keys)
        place = draw.randrange(len(name))
        misspelt = (
            name[:place] + chr(draw.choice(draw.choice(_ALPHABETS))) + name[place + 1 :]
        )
        key = draw.choice(
            (_text(draw), misspelt, name, name.upper(), draw.choice(strange))
        )
        if key.partition("=")[0].strip() not in here:
            return ["run", scene.name, f"--set={key}=1"]


FAMILIES: tuple[Family, ...] = (
    _unknown_key,
    _of_setting(Quantity, _no_number),
    _of_setting(Quantity, _wrong_unit),
    _of_setting(Quantity, _beyond),
    _of_setting(Choice, _no_choice),
    _of_setting(Quantity, lambda draw, _: f"{draw.randrange(90)}.5", True),
    _filled,
)


def bad_line(place: int, seed: int) -> list[str]:
    """Return the bad line with a number; families take turns."""
    return FAMILIES[place % len(FAMILIES)](Random(f"{seed} {place}"))
