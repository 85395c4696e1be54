"""A quantity of a scene and the values that it takes, as they are typed: ``KEY=LOW:HIGH:COUNT``."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from presswear.scene.scene import Scene
from presswear.scene.settings import changed, settings_of
from presswear.tools.errors import InputError, unknown
from presswear.tools.quantities import Meaning, parse_quantity

Array = NDArray[np.float64]

MOST_VALUES = 10_000


@dataclass(frozen=True)
class Over:
    """A quantity of a scene that is varied.

    Attributes
    ----------
    key : str
        As in ``--set``, such as ``speed`` or ``B.clearance``.
    low, high : float
        First and last value, SI.
    count : int
        Evenly spaced values, both ends included.
    unit, text : str
        Its SI unit, and what it is.
    """

    key: str
    low: float
    high: float
    count: int
    unit: str
    text: str

    @staticmethod
    def parsed(text: str, scene: Scene) -> "Over":
        """Read ``speed=2pi:12pi:200 rad/s``; without a unit values are SI.

        InputError names what is missing, unknown or out of range.
        """
        key, equals, rest = (part.strip() for part in text.partition("="))
        words = rest.split(":")
        if not equals or len(words) != 3:
            raise InputError(f"--over {text}: KEY=LOW:HIGH:COUNT is expected, with a unit behind")
        meaning = _meaning(key, scene)
        low, high = words[0].strip(), words[1].strip()
        number, _, unit = words[2].strip().partition(" ")
        ends = [
            parse_quantity(key, f"{end} {unit or meaning.unit}", meaning) for end in (low, high)
        ]
        if not (number.isascii() and number.isdigit() and 2 <= int(number[:9]) <= MOST_VALUES):
            raise InputError(
                f"--over {text}: {number!r} values; a whole number from 2 to {MOST_VALUES} is "
                "expected"
            )
        if not ends[0] < ends[1]:
            raise InputError(f"--over {text}: the first value must lie below the last one")
        own = Over(key, float(ends[0]), float(ends[1]), int(number), meaning.unit, meaning.text)
        # Values between two that are allowed may still need another scene, such as other joints.
        for end in ends:
            changed(scene, {key: end})
        return own

    @property
    def values(self) -> Array:
        """Rising values, SI."""
        return np.linspace(self.low, self.high, self.count)

    def scene(self, base: Scene, value: float) -> Scene:
        """A scene with another value of the quantity."""
        return changed(base, {self.key: float(value)})


def _meaning(key: str, scene: Scene) -> Meaning:
    """The meaning of a quantity that may be varied."""
    found = dict(_numbers(scene))
    joint, dot, own = key.rpartition(".")
    if dot and joint in scene.clearance_joints and own in found:
        return found[own]
    if key not in found:
        raise unknown("quantity of --over", key, sorted(found))
    return found[key]


def _numbers(scene: Scene) -> Iterator[tuple[str, Meaning]]:
    """Quantities of a scene that are no counts."""
    for setting in settings_of(scene):
        if isinstance(setting.meaning, Meaning) and not setting.meaning.whole:
            yield setting.key, setting.meaning
