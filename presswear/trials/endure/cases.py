"""Command lines that must be refused, drawn at random; each is bad by the way it is made.

Nothing here asks the code that is tried whether a line is bad: it is misspelt, beyond a range
that the scene states, without its unit, or together with what it contradicts.
"""

import math
import re
from typing import Any

from presswear.scene.catalog import SCENES, slider_crank, wear_times
from presswear.scene.scene import ENGINES, Scene
from presswear.scene.settings import Setting, settings_of
from presswear.tools.quantities import Choice, Meaning

Lines = Any
"""A strategy of hypothesis whose examples are command lines, lists of words."""

_SCENES: tuple[Scene, ...] = (wear_times(), slider_crank())
_NO_UNIT_OF = {
    "m": ("kg", "Pa", "s", "rad/s", "m/s", "%", "M", "MM", "inch"),
    "rad/s": ("m", "kg", "s", "rad", "Hz", "m/s", "1/s"),
    "kg": ("m", "Pa", "lb", "kg m^2", "t", "N"),
    "kg m^2": ("kg", "m", "kg m", "kg m^3", "g m^2"),
    "Pa": ("m", "kg", "mPa", "bar", "1/Pa", "N"),
    "1/Pa": ("Pa", "m", "/GPa", "1/m", "/"),
    "m/s": ("m", "s", "rad/s", "m/s^2", "km/h"),
    "m/s^2": ("m/s", "m", "g", "N"),
    "s": ("m", "min", "Hz", "1/s", "h"),
    "": ("m", "mm", "%", "rad", "kg", "x", "pi"),
}
"""Units that are none of a dimension."""
_NO_NUMBERS = (
    "",
    " ",
    "nan",
    "NaN",
    "-nan",
    "inf",
    "-inf",
    "Infinity",
    "none",
    "None",
    "null",
    "True",
    "e5",
    ".",
    "-",
    "--5",
    "+-5",
    "1e",
    "0x10",
    "1,5",
    "1_000",
    "1+1",
    "2*3",
    "2**8",
    "1/3",
    "(1)",
    "__import__('os').getcwd()",
    "${HOME}",
    "`ls`",
    "%s",
    "{0}",
    "١٢٣",
    "１２",
    "²",
    "½",
    "−5",
    "5\x00",
    "5\n6",
    "\x1b[31m5",
    "\udcff",
    "\u202e5",
    "9" * 5000,
    "1e400",
    "-1e400",
    "1e99999999",
)
"""What is no number that a computer can hold, with or without a unit behind it."""


def _strategies() -> Any:
    from hypothesis import strategies

    return strategies


def _settings(of: type[Meaning] | type[Choice]) -> list[tuple[Scene, Setting]]:
    return [(s, x) for s in _SCENES for x in settings_of(s) if isinstance(x.meaning, of)]


def _line(scene: Scene, *words: str) -> list[str]:
    return ["run", scene.name, *words]


def _set(key: str, value: str) -> str:
    return f"--set={key}={value}"


def _typed(value: float, unit: str) -> str:
    return f"{value!r} {'/Pa' if unit == '1/Pa' else unit}".strip()


def _wild_text() -> Any:
    """Any text that does not begin like a number."""
    st = _strategies()
    return st.text(max_size=40).filter(lambda text: not re.match(r"\s*[+-]?\.?[0-9]", text))


def unknown_keys() -> Lines:
    """Keys that no scene has, that are misspelt, or that belong to another mechanism."""
    st = _strategies()
    keys = [{setting.key for setting in settings_of(scene)} for scene in _SCENES]

    def line(drawn: tuple[int, str]) -> list[str]:
        return _line(_SCENES[drawn[0]], _set(drawn[1], "1"))

    def misspelt(key: str, place: int, letter: str) -> str:
        place %= len(key)
        return key[:place] + letter + key[place + 1 :]

    known = st.sampled_from(sorted(keys[0] | keys[1]))
    text = st.one_of(
        st.text(max_size=30),
        st.builds(misspelt, known, st.integers(0, 40), st.characters(exclude_categories=["Cs"])),
        st.sampled_from([key.upper() for key in sorted(keys[0])]),
        st.sampled_from(sorted(keys[0] ^ keys[1])),
        st.sampled_from(["__class__", "name", "title", "statuses", "mechanism", "bearings.width"]),
    )
    return (
        st.tuples(st.integers(0, 1), text)
        .filter(lambda drawn: drawn[1].partition("=")[0].strip() not in keys[drawn[0]])
        .map(line)
    )


def no_numbers() -> Lines:
    """Quantities whose value is no number."""
    st = _strategies()
    text = st.sampled_from(_NO_NUMBERS) | _wild_text()

    def line(owner: tuple[Scene, Setting], value: str, has_unit: bool) -> list[str]:
        scene, setting = owner
        unit = setting.meaning.unit if has_unit and isinstance(setting.meaning, Meaning) else ""
        return _line(scene, _set(setting.key, f"{value} {unit}".rstrip(" ")))

    return st.builds(line, st.sampled_from(_settings(Meaning)), text, st.booleans())


def wrong_units() -> Lines:
    """Numbers without their unit, or with that of something else."""
    st = _strategies()

    def line(owner: tuple[Scene, Setting], number: float, place: int) -> list[str]:
        scene, setting = owner
        assert isinstance(setting.meaning, Meaning)
        units = _NO_UNIT_OF[setting.meaning.unit]
        # Only a pure number has no unit to forget.
        wrong = (*units, *([""] if setting.meaning.unit else []))
        return _line(scene, _set(setting.key, f"{number!r} {wrong[place % len(wrong)]}".strip()))

    numbers = st.floats(0.0, 100.0)
    return st.builds(line, st.sampled_from(_settings(Meaning)), numbers, st.integers(0, 100))


def beyond_ranges() -> Lines:
    """Values outside their ranges, on each side, by a hair or by far."""
    st = _strategies()

    def line(owner: tuple[Scene, Setting], side: int, far: float) -> list[str]:
        scene, setting = owner
        meaning = setting.meaning
        assert isinstance(meaning, Meaning)
        if meaning.whole:
            step = 1 + int(far)
            value: float = meaning.high + step if side else meaning.low - step
            return _line(scene, _set(setting.key, f"{value:.0f}"))
        if side:
            value = max(math.nextafter(meaning.high, math.inf), meaning.high + far)
        elif meaning.open_low and far < 1.0:
            value = meaning.low
        else:
            value = min(math.nextafter(meaning.low, -math.inf), meaning.low - far)
        return _line(scene, _set(setting.key, _typed(value, meaning.unit)))

    far = st.sampled_from([0.0, 5e-324, 1e-12, 1.0, 1e10, 1e300]) | st.floats(0.0, 1e300)
    return st.builds(line, st.sampled_from(_settings(Meaning)), st.integers(0, 1), far)


def no_choices() -> Lines:
    """Choices that are none, and counts that are no whole numbers."""
    st = _strategies()
    words = st.sampled_from(["", "Paper", "PAPER", "paper ,", "all", "0", "on;off"]) | _wild_text()

    def word(owner: tuple[Scene, Setting], text: str) -> list[str]:
        return _line(owner[0], _set(owner[1].key, text))

    def part(owner: tuple[Scene, Setting], number: float) -> list[str]:
        return _line(owner[0], _set(owner[1].key, f"{number + 0.5!r}"))

    chosen = st.builds(word, st.sampled_from(_settings(Choice)), words).filter(
        lambda line: (
            not any(
                line[-1].partition("=")[2].partition("=")[2].strip() in setting.meaning.words
                for _, setting in _settings(Choice)
                if isinstance(setting.meaning, Choice)
            )
        )
    )
    counts = [
        own
        for own in _settings(Meaning)
        if isinstance(own[1].meaning, Meaning) and own[1].meaning.whole
    ]
    return st.one_of(
        chosen, st.builds(part, st.sampled_from(counts), st.integers(0, 90).map(float))
    )


def contradictions() -> Lines:
    """Values that are allowed alone but not together."""
    st = _strategies()
    sized = st.floats(1e-4, 1.0)
    part = st.floats(0.0, 1.0)
    press, crank = _SCENES

    def wide(radius: float, more: float) -> list[str]:
        clearance = min(radius * (1.0 + more), 1.0)
        values = _set("bearing_radius", f"{radius!r}m"), _set("clearance", f"{clearance!r}m")
        return _line(press, *values)

    def slow(upper: float, more: float) -> list[str]:
        lower = min(upper * (1.0 + more), 1.0)
        values = _set("upper_speed", f"{upper!r}m/s"), _set("lower_speed", f"{lower!r}m/s")
        return _line(press, *values)

    def exponent(value: float) -> list[str]:
        return _line(press, "--conventions=refined", _set("exponent", f"{value!r}"))

    def short(length: float, below: float) -> list[str]:
        rod = max(length * below, 1e-3)
        return _line(crank, _set("crank_length", f"{length!r}m"), _set("rod_length", f"{rod!r}m"))

    def unassembled(key: str, length: float) -> list[str]:
        return _line(press, _set(key, f"{length!r}m"))

    def flat(bc: float, cd: float, more: float) -> list[str]:
        values = {"side_bc": bc, "side_cd": cd, "side_bd": (bc + cd) * (1.0 + more)}
        return _line(press, *(_set(key, f"{value!r}m") for key, value in values.items()))

    fixed = [
        ["run", "wear-times", "--set=joints=A", "--engine=exudyn-tree"],
        ["run", "clearance-c", "--engine=exudyn-tree"],
        ["run", "ideal", "--engine=exudyn-tree"],
        ["run", "slider-crank", "--set=joints=AB", "--engine=exudyn-tree"],
        ["run", "slider-crank", "--set=joints=AC"],
        ["run", "ideal", "--set=starts=2"],
        ["run", "wear-times", "--set=joints=none", "--set=starts=3"],
        ["run", "wear-times", "--set=contact=foundation", "--set=exponent=1.2"],
        ["run", "runaway", "--set=exponent=1.2"],
        ["run", "wear-times", "--wears=1", "--set=wears=21"],
        ["run", "wear-times", "--set=friction=0.1", "--set=friction=0.2"],
        ["run", "wear-times", "--jobs=2"],
        ["run", "wear-times", "--resume"],
        ["run", "paper", "--resume"],
        ["precision", "ideal", "--quick"],
        ["precision", "--quick", "--set=joints=none"],
        ["precision", "--quick", "--set=wear_coefficient=0/Pa"],
        ["precision", "--quick", "--set=exponent=2"],
    ]
    return st.one_of(
        st.sampled_from(fixed),
        st.builds(wide, sized, part),
        st.builds(slow, st.floats(1e-9, 1.0), part),
        st.builds(exponent, st.floats(1.0, 2.5).filter(lambda value: value != 1.5)),
        st.builds(short, st.floats(1e-3, 10.0), part),
        st.builds(unassembled, st.just("length_3"), st.floats(1e-3, 0.1)),
        st.builds(unassembled, st.sampled_from(["length_2", "length_7"]), st.floats(0.5, 10.0)),
        st.builds(flat, st.floats(1e-3, 4.0), st.floats(1e-3, 4.0), st.floats(1e-3, 0.1)),
    )


def bad_options(folder: str, file: str) -> Lines:
    """Options that are unknown, lack their value or have one that is none.

    Parameters
    ----------
    folder, file : str
        Names of a folder that holds something, and of a file.
    """
    st = _strategies()
    text = _wild_text()
    count = st.sampled_from(["0", "-1", "1.5", "many", "", "1e400", "nan", "٣", "9" * 5000])
    named = st.sampled_from([*SCENES, "paper"])
    engines = text.filter(lambda word: word.strip() not in ENGINES)
    places = [
        *(folder, file, f"{file}/below", "", " ", "a\0b", "n" * 300, "x/" + "y" * 256),
        *("a\nb", "\udcff", "\x1b[2J", "/proc/none/x", "/dev/null", "/dev/null/x"),
    ]
    conventions = text.filter(lambda word: word not in ("paper", "refined"))
    return st.one_of(
        st.builds(lambda n, x: ["run", n, f"--cycles={x}"], named, count | text),
        st.builds(lambda n, x: ["run", n, f"--wears={x}"], named, text | st.just("-1")),
        st.builds(lambda n, x: ["run", n, f"--wears={x}"], named, st.integers(21, 10**30)),
        st.builds(lambda n, x: ["run", n, f"--tolerance={x}"], named, count | text),
        st.builds(lambda x: ["run", "paper", f"--jobs={x}"], count | text),
        st.builds(lambda n, x: ["run", n, f"--engine={x}"], named, engines),
        st.builds(lambda n, x: ["run", n, f"--conventions={x}"], named, conventions),
        st.builds(lambda n, x: ["run", n, f"--out={x}"], named, st.sampled_from(places)),
        st.builds(
            lambda x: ["run", "ideal", f"--set={x}"], text.filter(lambda word: "=" not in word)
        ),
        st.builds(lambda x: ["crosscheck", f"--duration={x}"], st.just("1e300") | text),
        st.builds(lambda x: ["crosscheck", f"--until={x}"], count),
        st.builds(lambda x: ["crosscheck", "ideal", f"--against={x}.csv"], text),
        st.builds(lambda x: ["costs", f"--repeats={x}"], count | text),
        st.builds(lambda x: ["precision", f"--repeats={x}"], count | text),
        st.builds(lambda x: ["precision", f"--out={x}"], st.sampled_from(places)),
        st.builds(lambda x: ["export", folder, "a.csv", f"--stage={x}"], count | text),
        st.builds(lambda x: ["export", x, "a.csv"], text.map(lambda word: f"no/{word}")),
        st.builds(lambda x: ["report", x], text.map(lambda word: f"no/{word}")),
        st.sampled_from(
            [
                *([], ["run"], ["run", "--set"], ["report"], ["export", "x"], ["verify", "--long"]),
                *(["run", "ideal", "--engine"], ["run", "ideal", "ideal"], ["verify", "x"]),
                *(["crosscheck", "--set=clearance=1"], ["crosscheck", "--out=x", "--until=1"]),
                *(["list", "ideal", "friction"], ["crosscheck", folder, "--against", file]),
            ]
        ),
    )


def bad_names() -> Lines:
    """Commands, scenes and options that are none."""
    st = _strategies()
    commands = ["run", "list", "precision", "crosscheck"]
    option = st.from_regex(r"--x[a-z\-]{1,12}(=[^\x00]{0,9})?", fullmatch=True)
    no_option = _wild_text().filter(lambda word: not word.startswith("-"))
    return st.one_of(
        no_option.filter(bool).map(lambda word: [f"no{word}"]),
        st.builds(
            lambda command, word: [command, f"no{word}"], st.sampled_from(commands), no_option
        ),
        st.builds(lambda command, word: [command, word], st.sampled_from(commands), option),
    )


def families(folder: str, file: str) -> dict[str, Lines]:
    """All kinds of bad command lines by name; see ``bad_options``."""
    return {
        "unknown keys": unknown_keys(),
        "no numbers": no_numbers(),
        "wrong units": wrong_units(),
        "beyond ranges": beyond_ranges(),
        "no choices": no_choices(),
        "contradictions": contradictions(),
        "bad options": bad_options(folder, file),
        "bad names": bad_names(),
    }
