"""Command lines that must be refused, drawn at random; each is bad by the way it is made.

Nothing here asks the code that is tried whether a line is bad: it is misspelt, beyond a range
that the scene states, without its unit, or together with what it contradicts.
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

Family = Callable[[Random], list[str]]  # Draws a command line of a kind

# A file and a folder that holds something, as seen from where the lines are given.
FILE, FOLDER = "../a-file", "../a-folder"
_PRESS, _CRANK = wear_times(), slider_crank()
_KEYS = {scene.name: {setting.key for setting in settings_of(scene)} for scene in (_PRESS, _CRANK)}
# Units that are none of a dimension.
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
# What is no number that a computer can hold, with or without a unit behind it.
_NO_NUMBERS = (*_NO_NUMBER_TEXTS.split(), "", " ", "5\x00", "5\n6", "9" * 5000)
_NO_COUNTS = ("0", "-1", "1.5", "many", "", "1e400", "nan", "٣", "9" * 5000)
# Folders that cannot be written into, as they are somebody's or no folders.
_PLACES = (
    *(FOLDER, FILE, f"{FILE}/below", "", " ", "a\0b", "n" * 300, "x/" + "y" * 256),
    *("a\nb", "\udcff", "\x1b[2J", "/proc/none/x", "/dev/null", "/dev/null/x"),
)
_ALPHABETS = (range(32, 127), range(32), range(0x80, 0xD800), range(0xE000, 0x110000))

_AT_ODDS = """
run wear-times --set=joints=A --engine=exudyn-tree
run clearance-a --engine=exudyn-tree
run ideal --engine=exudyn-tree
run slider-crank --set=joints=none --engine=exudyn-tree
run slider-crank --set=joints=AC
run ideal --set=replicates=2
run wear-times --set=joints=none --set=replicates=3
run wear-times --set=contact=foundation --set=exponent=1.2
run wear-times --wear-updates=1 --set=wear_updates=21
run wear-times --set=friction=0.1 --set=friction=0.2
run wear-times --jobs=0
run wear-times --resume
run friction --resume
benchmark ideal --quick
benchmark --quick --set=joints=none
benchmark --features --set=joints=A
"""
# Values of options that none of them has, by what stands before them.
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


def _text(draw: Random, most: int = 40) -> str:
    length = draw.randrange(most)
    return "".join(
        chr(draw.choice(draw.choice((_ALPHABETS[0], *_ALPHABETS)))) for _ in range(length)
    )


def _wild(draw: Random) -> str:
    text = _text(draw)
    while re.match(r"\s*[+-]?\.?[0-9]", text):
        text = _text(draw)
    return text


def _within(draw: Random, low: float, high: float) -> float:
    return draw.choice((low, high, *(draw.uniform(low, high) for _ in range(8))))


def _filled(lines: Sequence[str]) -> Family:
    """Lines like given ones, a word for each of theirs."""

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


def _of_setting(
    kind: type,
    text: Callable[[Random, Any], str],
    fits: Callable[[Any], bool] = lambda meaning: True,
) -> Family:
    """Lines that give a quantity or choice of a scene a text that is none for it."""
    owners = [
        (scene, setting)
        for scene in (_PRESS, _CRANK)
        for setting in settings_of(scene)
        if isinstance(setting.meaning, kind) and fits(setting.meaning)
    ]

    def line(draw: Random) -> list[str]:
        scene, setting = draw.choice(owners)
        return _set(scene, **{setting.key: text(draw, setting.meaning)})

    return line


def _no_number(draw: Random, meaning: Quantity) -> str:
    text = draw.choice((draw.choice(_NO_NUMBERS), _wild(draw)))
    return draw.choice((text, f"{text} {meaning.unit}".rstrip(" ")))


def _wrong_unit(draw: Random, meaning: Quantity) -> str:
    units = NOT_UNITS_OF[meaning.unit].split(", ") + ([""] if meaning.unit else [])
    return f"{_within(draw, 0.0, 100.0)!r} {draw.choice(units)}".strip()


def _beyond(draw: Random, meaning: Quantity) -> str:
    """A value outside its range, on either side, by a hair or by far."""
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
    """Keys that no scene has, that are misspelt, or that belong to another mechanism."""
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


def _at_odds(draw: Random) -> list[str]:
    """Values that are allowed alone but not together."""
    size, part = _within(draw, 1e-4, 1.0), _within(draw, 0.0, 1.0)
    speed, length = _within(draw, 1e-9, 1.0), _within(draw, 1e-3, 10.0)
    short, long = _within(draw, 1e-3, 0.1), _within(draw, 0.5, 10.0)
    bc, cd = _within(draw, 1e-3, 4.0), _within(draw, 1e-3, 4.0)
    exponent = draw.choice((1.0, 2.5, draw.uniform(1.0, 1.49), draw.uniform(1.51, 2.5)))

    def lengths(scene: Scene, **values: float) -> list[str]:
        return _set(scene, **{key: f"{value!r}m" for key, value in values.items()})

    ramp = {"upper_speed": f"{speed!r}m/s", "lower_speed": f"{min(speed * (1.0 + part), 1.0)!r}m/s"}
    return draw.choice(
        (
            lengths(_PRESS, bearing_radius=size, clearance=min(size * (1.0 + part), 1.0)),
            lengths(_PRESS, length_3=short),
            lengths(_PRESS, **{draw.choice(("length_2", "length_7")): long}),
            lengths(_PRESS, side_bc=bc, side_cd=cd, side_bd=(bc + cd) * (1.0 + short)),
            lengths(_CRANK, crank_length=length, rod_length=max(length * part, 1e-3)),
            _set(_PRESS, **ramp),
            [*_set(_PRESS, exponent=f"{exponent!r}"), "--conventions=refined"],
            _filled(_AT_ODDS.strip().splitlines())(draw),
        )
    )


# All kinds of bad command lines.
FAMILIES: dict[str, Family] = {
    "unknown keys": _unknown_key,
    "no numbers": _of_setting(Quantity, _no_number),
    "wrong units": _of_setting(Quantity, _wrong_unit),
    "beyond ranges": _of_setting(Quantity, _beyond),
    "no choices": _of_setting(Choice, _no_choice),
    "no whole numbers": _of_setting(
        Quantity, lambda draw, meaning: f"{draw.randrange(90)}.5", lambda meaning: meaning.whole
    ),
    "contradictions": _at_odds,
    "bad options": _filled(_LINES),
    "bad names": _filled(_NAMES),
}


def bad_line(place: int, seed: int) -> list[str]:
    family = list(FAMILIES.values())[place % len(FAMILIES)]
    return family(Random(f"{seed} {place}"))
