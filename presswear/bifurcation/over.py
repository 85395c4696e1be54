"""What is run for a diagram: a quantity, the values that it takes, and how long at each."""

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


@dataclass(frozen=True)
class Extent:
    """How long is run at each value.

    Attributes
    ----------
    cycles : int
        All of them.
    kept : int
        Of these the last ones, whose states are kept.
    exponent_cycles, order_cycles : int
        Further ones for the exponent, and for the orders; 0: none are sought.
    """

    cycles: int
    kept: int
    exponent_cycles: int
    order_cycles: int

    def __post_init__(self) -> None:
        if not 2 <= self.kept < self.cycles:
            raise InputError(
                f"kept = {self.kept}: of {self.cycles} cycles allowed is 2 to {self.cycles - 1}"
            )
