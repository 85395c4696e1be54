"""A quantity of a scene and the values that it takes, as they are typed: ``KEY=VALUES``."""

from dataclasses import dataclass

from presswear.scene.ranges import values_of
from presswear.scene.scene import Scene
from presswear.scene.settings import changed, setting_of
from presswear.tools.errors import InputError
from presswear.tools.quantities import Meaning


@dataclass(frozen=True)
class Over:
    """A quantity of a scene that is varied.

    Attributes
    ----------
    key : str
        As in ``--set``, such as ``speed`` or ``B.clearance``.
    values : tuple of float
        Rising, SI.
    unit, text : str
        Its SI unit, and what it is.
    """

    key: str
    values: tuple[float, ...]
    unit: str
    text: str

    @staticmethod
    def parsed(text: str, scene: Scene) -> "Over":
        """Read ``speed=2pi:12pi:200 rad/s``; see ``presswear.scene.ranges``.

        InputError names what is missing, unknown or out of range.
        """
        key, equals, given = (part.strip() for part in text.partition("="))
        if not (equals and given):
            raise InputError(f"--over {text}: KEY=FIRST:LAST:COUNT is expected, with a unit behind")
        meaning = setting_of(scene, key).meaning
        if not isinstance(meaning, Meaning) or meaning.whole:
            raise InputError(f"--over {text}: a quantity is expected, not a count or a choice")
        values = sorted(set(values_of(key, given, meaning)))
        if len(values) < 2:
            raise InputError(f"--over {text}: two values that differ are expected")
        # Values between two that are allowed may still need another scene, such as other joints.
        for end in (values[0], values[-1]):
            changed(scene, {key: end})
        return Over(key, tuple(values), meaning.unit, meaning.text)

    def scene(self, base: Scene, value: float) -> Scene:
        """A scene with another value of the quantity."""
        return changed(base, {self.key: value})
