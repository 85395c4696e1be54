"""Report on two results side by side: numbers with ratios, limits, settings, figures."""

from pathlib import Path
from typing import Any, NamedTuple

from presswear.recording.statistics import Estimate, ratio
from presswear.results.result import Result
from presswear.scene.catalog import title_of
from presswear.scene.differences import differences
from presswear.scene.scene import Scene
from presswear.scene.setting_keys import settings_by_key
from presswear.scene.setting_list import Setting, settings_of
from presswear.show import page
from presswear.show.figures import FIRST, FIRST_COUNT, drawn_if_stored
from presswear.show.key_numbers import key_numbers, stages_with_numbers
from presswear.show.limits import limit_lines
from presswear.show.page import NOTHING, Illustration, KeyNumber, LimitLine
from presswear.show.report import made_by
from presswear.tools.choices import NONE
from presswear.tools.errors import InputError
from presswear.tools.files import write_bytes
from presswear.tools.numbers import readable
from presswear.tools.quantities import Quantity

# Heads of the columns; A and B are names of joints.
FIRST_RUN = "run 1"
SECOND_RUN = "run 2"


class Ratio(NamedTuple):
    """Ratio of the second number to the first, and whether it differs from 1, as texts."""

    text: str
    verdict: str = ""


class NumberPair(NamedTuple):
    """Key number of both results; None for a result without it."""

    name: str
    first: KeyNumber | None
    second: KeyNumber | None
    ratio: Ratio


class LimitPair(NamedTuple):
    """Line of a limit of both results; None for a result without it."""

    name: str
    first: LimitLine | None
    second: LimitLine | None


class SettingPair(NamedTuple):
    """Setting that differs, with both values and its meaning, as texts."""

    key: str
    first: str
    second: str
    meaning: str


def write_comparison(first: Result, second: Result, file: Path) -> Path:
    """Write a page on two results side by side; InputError if one has no number."""
    write_bytes(file, render_comparison(first, second).encode())
    return file


def render_comparison(first: Result, second: Result) -> str:
    """Return a page on two results side by side as HTML."""
    results = {FIRST_RUN: first, SECOND_RUN: second}
    for result in results.values():
        if not stages_with_numbers(result):
            raise InputError(
                f"{result.path or result.scene.name} has no stage with numbers to compare"
            )
    return page.render_page(
        f"{_name_of(first)} compared with {_name_of(second)}",
        page.FirstScreen(),
        template="comparison.html",
        answer=[f"{name}: {_origin(result)}" for name, result in results.items()],
        pairs=number_pairs(first, second),
        limit_pairs=limit_pairs(first, second),
        settings=setting_pairs(first.scene, second.scene),
        figures=_figure_pairs(first, second),
    )


def _name_of(result: Result) -> str:
    return result.path.resolve().name if result.path else result.scene.name


def _origin(result: Result) -> str:
    """Return folder, title, status and origin of a result."""
    where = f"{result.path}, " if result.path else ""
    title = title_of(result.scene)
    return f"{where}{title}; {result.status}; made by {made_by(result.provenance)}"


def number_pairs(first: Result, second: Result) -> list[NumberPair]:
    """Return the key numbers of two results by name, with their ratios."""
    first_numbers = {number.name: number for number in key_numbers(first)}
    second_numbers = {number.name: number for number in key_numbers(second)}
    pairs = []
    for name in dict.fromkeys([*first_numbers, *second_numbers]):
        before = first_numbers.get(name)
        after = second_numbers.get(name)
        pairs.append(NumberPair(name, before, after, _ratio_of(before, after)))
    return pairs


def _ratio_of(first: KeyNumber | None, second: KeyNumber | None) -> Ratio:
    """Return the ratio of two numbers, which come from independent runs."""
    before = first and first.estimate
    after = second and second.estimate
    if before is None or after is None or before.mean == 0.0:
        return Ratio(NOTHING)
    quotient = ratio(after, before)
    return Ratio(quotient.with_ends, _verdict_on(quotient))


def _verdict_on(quotient: Estimate) -> str:
    """Return whether a ratio lies above or below 1 with its whole interval."""
    if quotient.low is None or quotient.high is None:
        return "interval unknown"
    if readable(quotient.low) == readable(quotient.high) == readable(1.0):
        return "equal"
    if quotient.low > 1.0:
        return f"{SECOND_RUN} is larger"
    if quotient.high < 1.0:
        return f"{SECOND_RUN} is smaller"
    return "no certain difference"


def limit_pairs(first: Result, second: Result) -> list[LimitPair]:
    """Return the limits of the last sound stages of two results by their names."""
    first_limits = _last_limits(first)
    second_limits = _last_limits(second)
    names = dict.fromkeys([*first_limits, *second_limits])
    return [
        LimitPair(name, first_limits.get(name), second_limits.get(name))
        for name in names
    ]


def _last_limits(result: Result) -> dict[str, LimitLine]:
    """Return the limits of the last sound stage of a result by their names."""
    stage = stages_with_numbers(result)[-1]
    return {line.number.name: line for line in limit_lines(result.scene, stage)}


def setting_pairs(first: Scene, second: Scene) -> list[SettingPair]:
    """Return the settings in which two scenes differ, those of a joint after the common ones.

    A mechanism of bodies is compared as a whole.
    """
    first_settings = settings_by_key(first)
    second_settings = settings_by_key(second)
    listed = [setting.key for setting in [*settings_of(first), *settings_of(second)]]
    pairs = []
    for key in dict.fromkeys(listed):
        settings = first_settings.get(key), second_settings.get(key)
        meaning = next(setting.meaning for setting in settings if setting)
        before, after = map(_value_of, settings)
        if before != after:
            texts = _written(before, meaning), _written(after, meaning)
            pairs.append(SettingPair(key, *texts, meaning.text))
    keys = {*first_settings, *second_settings}
    return [*pairs, *_other_differences(first, second, keys)]


def _value_of(setting: Setting | None) -> Any:
    return NOTHING if setting is None else setting.value


def _written(value: Any, meaning: Any) -> str:
    """Return a value in the unit in which engineers write it."""
    if value is None:
        return NONE
    if not isinstance(meaning, Quantity) or isinstance(value, str):
        return f"{value}"
    return meaning.typeset(value)


def _other_differences(
    first: Scene, second: Scene, keys: set[str]
) -> list[SettingPair]:
    """Return the differences of mechanisms and surfaces that no setting states."""
    before_data = first.as_dict()
    after_data = second.as_dict()
    pairs = []
    changes = differences(before_data["mechanism"], after_data["mechanism"])
    names = [name for name, *_ in changes]
    if unlisted := [name for name in dict.fromkeys(names) if name not in keys]:
        before = first.mechanism.linkage().name
        after = second.mechanism.linkage().name
        text = f"in {', '.join(unlisted)}"
        pairs.append(SettingPair("mechanism", before, after, text))
    if before_data["surfaces"] != after_data["surfaces"]:
        before = _surfaces_text(first)
        after = _surfaces_text(second)
        pairs.append(SettingPair("surfaces", before, after, "initial surfaces"))
    return pairs


def _surfaces_text(scene: Scene) -> str:
    """Return the origin of the initial surfaces of a scene."""
    return scene.origins.get("surfaces", "measured") if scene.surfaces else "round"


def _figure_pairs(
    first: Result, second: Result
) -> list[tuple[Illustration, Illustration]]:
    """Return the first figures that both results have, the figures of one name in order."""
    pairs: list[tuple[Illustration, Illustration]] = []
    figures = 0
    for name in FIRST:
        first_drawings = drawn_if_stored(name, first, first.stages)
        second_drawings = drawn_if_stored(name, second, second.stages)
        if not first_drawings or not second_drawings:
            continue
        if figures == FIRST_COUNT:
            break
        figures += 1
        first_pictures = page.drawn_inline(first_drawings)
        second_pictures = page.drawn_inline(second_drawings)
        pairs += zip(first_pictures, second_pictures, strict=False)
    return pairs
