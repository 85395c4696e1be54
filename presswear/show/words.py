"""Words of a report on a linkage without a slide, which has no strokes and no dead centre."""

import re
from typing import TYPE_CHECKING

from presswear.scene.scene import Scene

if TYPE_CHECKING:
    from presswear.show.page import KeyNumber

# Words for a linkage without a guide, by words for a press
_OF_CYCLES = {
    "strokes": "cycles",
    "stroke": "cycle",
    "Strokes": "Cycles",
    "Stroke": "Travel",
    "bottom dead centre": "the lowest position",
    "Bottom dead centre": "Lowest position",
    "Bottom dead centre error": "Error of the lowest position",
}
_WORDS = re.compile(
    rf"\b({'|'.join(sorted(_OF_CYCLES, key=len, reverse=True))})\b",
)


def has_guide(scene: Scene) -> bool:
    """Return whether a guide of the frame holds a body, as the slide of a press."""
    return any(not guide.is_moving for guide in scene.mechanism.linkage().guides)


def in_words_of(scene: Scene, text: str) -> str:
    """Return a sentence of the report in the words of the linkage of a scene."""
    if has_guide(scene):
        return text
    return _WORDS.sub(lambda match: _OF_CYCLES[match[0]], text)


def number_in_words_of(scene: Scene, number: "KeyNumber") -> "KeyNumber":
    """Return a key number in the words of the linkage of a scene."""
    return number._replace(
        name=in_words_of(scene, number.name),
        value=in_words_of(scene, number.value),
        interval=in_words_of(scene, number.interval),
        meaning=in_words_of(scene, number.meaning),
        note=in_words_of(scene, number.note),
        stage=in_words_of(scene, number.stage),
    )
