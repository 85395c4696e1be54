"""Command lines that must be refused, drawn at random; each is bad by construction.

A line is misspelt, beyond a range of the scene, or without its unit.
"""

import math
import re
from collections.abc import Callable, Sequence
from random import Random
from typing import Any

from presswear.scene.catalog import SCENES, slider_crank, wear_times
from presswear.scene.scene import Scene
from presswear.scene.settings import settings_of
from presswear.tools.quantities import Choice, Quantity

Family = Callable[[Random], list[str]]  # draws a command line of a kind

FILE, FOLDER = "../a-file", "../a-folder"  # the folder is not empty
_PRESS, _CRANK = wear_times(), slider_crank()
_KEYS = {scene.name: {setting.key for setting in settings_of(scene)} for scene in (_PRESS, _CRANK)}
# Units that do not belong to a dimension.
NOT_UNITS_OF = {
    "m": "kg, Pa, s, rad/s, m/s, %, M, MM, inch",
    "rad/s": "m, kg, s, rad, m/s, 1/s",
    "rad": "m, rad/s, °, grad, s",
    "kg": "m, Pa, lb, kg m^2, N",
    "kg m^2": "kg, m, kg m, kg m^3, g m^2",
    "Pa": "m, kg, mPa, 1/Pa, N",
    "1/Pa": "Pa, m, /GPa, 1/m, /",
    "1/m": "m, 1/Pa, 1/s, /",
    "s/m": "s, m, m/s, N s/m",
    "N s/m": "N, N/m, s/m, N m, kg",
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
    *(FOLDER, FILE, f"{FILE}/below", "", " ", "a\0b", "n" * 300, "x/" + "y" * 256),
    *("a\nb", "\udcff", "\x1b[2J", "/proc/none/x", "/dev/null", "/dev/null/x"),
)
_ALPHABETS = (range(32, 127), range(32), range(0x80, 0xD800), range(0xE000, 0x110000))

# Values that no option has, by the words before the option.
_OPTIONS = {
    "run {scene}": "cycles={count} wear_updates={text} wear_updates=-1 wear_updates={many} "
    "tolerance={count} engine={text} conventions={text} out={place} on=no/{text}",
    "run friction": "jobs={count}",
    "run ideal": "set={word}",
    "crosscheck": "duration={text} duration=1e300 until={no_count} set=clearance=1",
    "crosscheck ideal": "against={text}.csv",
    "benchmark": "repeats={count} out={place}",
    "export {folder} a.csv": "stage={count}",
}
_LINES = (
    *("export no/{text} a.csv", "report no/{text}", "report", "run", "run --set", "export x"),
    *("run ideal --engine", "run ideal ideal", "verify x", "verify --long", "list ideal friction"),
    *("crosscheck --out=x --until=1", "crosscheck {folder} --against {file}"),
    *(f"{line} --{option}" for line, options in _OPTIONS.items() for option in options.split()),
)
_NAMES = ("no{text}", "{command} no{text}", "{command} --x{word}", "{command} --x{word}={text}")


def _text(draw: Random) -> str:
    """Return any text, half of it of characters that people type."""
    alphabets = (_ALPHABETS[0], *_ALPHABETS)
    return "".join(chr(draw.choice(draw.choice(alphabets))) for _ in range(draw.randrange(40)))


def _wild(draw: Random) -> str:
    """Return any text that does not begin like a number."""
    text = _text(draw)
    while re.match(r"\s*[+-]?\.?[0-9]", text):
        text = _text(draw)
    return text


def _within(draw: Random, low: float, high: float) -> float:
    """Return a number of a range, at times one of its ends."""
    return draw.choice((low, high, *(draw.uniform(low, high) for _ in range(8))))


def _filled(lines: Sequence[str]) -> Family:
    """Return a family of lines whose placeholders are filled at random."""

    def line(draw: Random) -> list[str]:
        text, no_count = _wild(draw), draw.choice(_NO_COUNTS)
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
        return [word.format(**fills) for word in draw.choice(lines).split()]

    return line


def _set(scene: Scene, **values: str) -> list[str]:
    return ["run", scene.name, *(f"--set={key}={value}" for key, value in values.items())]


def _of_setting(kind: type, text: Callable[[Random, Any], str], is_whole: bool = False) -> Family:
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
        return _set(scene, **{setting.key: text(draw, setting.meaning)})

    return line


def _no_number(draw: Random, meaning: Quantity) -> str:
    text = draw.choice((draw.choice(_NO_NUMBERS), _wild(draw)))
    return draw.choice((text, f"{text} {meaning.unit}".rstrip(" ")))


def _wrong_unit(draw: Random, meaning: Quantity) -> str:
    """Return a number with the unit of another dimension, or without the unit it needs."""
    units = NOT_UNITS_OF[meaning.unit].split(", ") + ([""] if meaning.unit else [])
    return f"{_within(draw, 0.0, 100.0)!r} {draw.choice(units)}".strip()


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
    text = draw.choice(("", "Paper", "PAPER", "paper ,", "all", "0", "on;off", _wild(draw)))
    return text if text.strip() not in choice.words else f"no {text}"


def _unknown_key(draw: Random) -> list[str]:
    """Return a line with a key that is misspelt or belongs to another mechanism."""
    scene = draw.choice((_PRESS, _CRANK))
    here, all_keys = _KEYS[scene.name], sorted(_KEYS[_PRESS.name] | _KEYS[_CRANK.name])
    strange = ("__class__", "name", "title", "origins", "mechanism", "bearings.width")
    while True:
        name = draw.choice(all_keys)
        place = draw.randrange(len(name))
        misspelt = name[:place] + chr(draw.choice(draw.choice(_ALPHABETS))) + name[place + 1 :]
        key = draw.choice((_text(draw), misspelt, name, name.upper(), draw.choice(strange)))
        if key.partition("=")[0].strip() not in here:
            return _set(scene, **{key: "1"})


FAMILIES: dict[str, Family] = {
    "unknown keys": _unknown_key,
    "no numbers": _of_setting(Quantity, _no_number),
    "wrong units": _of_setting(Quantity, _wrong_unit),
    "beyond ranges": _of_setting(Quantity, _beyond),
    "no choices": _of_setting(Choice, _no_choice),
    "no whole numbers": _of_setting(Quantity, lambda draw, _: f"{draw.randrange(90)}.5", True),
    "bad options": _filled(_LINES),
    "bad names": _filled(_NAMES),
}


def bad_line(place: int, seed: int) -> list[str]:
    """Return the bad line with a number; families take turns."""
    family = list(FAMILIES.values())[place % len(FAMILIES)]
    return family(Random(f"{seed} {place}"))
