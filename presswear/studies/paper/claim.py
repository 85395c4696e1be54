"""A claim of the paper on a trend, and the comparisons that such claims come down to."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

from presswear.studies.paper.evidence import Place
from presswear.studies.paper.printed import FAST, FRICTION, HIGH_FRICTION, SLOW, WEAR
from presswear.studies.paper.verdicts import Comparison, Expected

JOINTS = ("A", "C")
FIRST_WEARS = ((WEAR, 1), (WEAR, 2), (FRICTION, 1), (HIGH_FRICTION, 1), (SLOW, 1), (FAST, 1))
"""Settings and wears whose depths the paper shows."""


@dataclass(frozen=True)
class Claim:
    """A sentence that claims a trend, and the comparisons that it comes down to.

    Attributes
    ----------
    section, figure : str
    quote : str
        The paper's words, shortened.
    parts : tuple of Comparison
    note : str
        How the words were read, or what is odd about them.
    """

    section: str
    figure: str
    quote: str
    parts: tuple[Comparison, ...]
    note: str = ""


def more(
    quantity: str,
    pairs: Sequence[tuple[Place, Place]],
    expected: Expected = "more",
) -> tuple[Comparison, ...]:
    """Comparisons of each second place with its first."""
    return tuple(Comparison(quantity, (second,), (first,), expected) for first, second in pairs)


def by_wear(joints: Sequence[str], *wears: int, setting: str = WEAR) -> list[tuple[Place, Place]]:
    """Each number of wears and the next one, at each joint."""
    return [
        (Place(setting, before, joint), Place(setting, after, joint))
        for joint in joints
        for before, after in pairwise(wears)
    ]


def by_friction(joints: Sequence[str], *wears: int) -> list[tuple[Place, Place]]:
    """The lower and the higher friction coefficient."""
    return [
        (Place(FRICTION, k, joint), Place(HIGH_FRICTION, k, joint))
        for joint in joints
        for k in wears
    ]


def by_speed(joints: Sequence[str], *wears: int) -> list[tuple[Place, Place]]:
    """The lower and the higher speed."""
    return [(Place(SLOW, k, joint), Place(FAST, k, joint)) for joint in joints for k in wears]


def c_and_a(places: Sequence[tuple[str, int]]) -> list[tuple[Place, Place]]:
    """Joint C and joint A."""
    return [(Place(setting, wears, "C"), Place(setting, wears, "A")) for setting, wears in places]


def a_grows_more(
    pairs: Sequence[tuple[tuple[str, int], tuple[str, int]]],
) -> tuple[Comparison, ...]:
    """The force at A changes by a larger factor than that at C, from a first to a second."""
    return tuple(
        Comparison(
            "force",
            (Place(*second, "A"), Place(*first, "C")),
            (Place(*first, "A"), Place(*second, "C")),
        )
        for first, second in pairs
    )


SLIDER = ("",)
STAGE_NOT_SAID = "The paper does not say before or after which wear; both are compared."
A_DEEPER = "Deepest wear."
C_WIDER = "Worn is where the depth is at least 5 % of the deepest."
