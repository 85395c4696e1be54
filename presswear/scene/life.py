"""Service life as a person asks for it: limits of followed numbers, and what is done meanwhile."""

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

from presswear.tools.errors import InputError, unknown
from presswear.tools.quantities import Quantity, count, free_text, parse_quantity, quantity
from presswear.tools.serialize import check_fields


@dataclass(frozen=True)
class Followed:
    """A number that is followed over strokes.

    Attributes
    ----------
    unit : str
    of_joint : bool
        True where each joint with clearance has its own.
    text : str
        What it is.
    """

    unit: str
    of_joint: bool
    text: str


FOLLOWED: dict[str, Followed] = {
    "depth": Followed("m", True, "deepest place that bearing or pin has lost"),
    "wear_volume": Followed("m^3", True, "volume that bearing and pin have lost"),
    "force_max": Followed("N", True, "peak normal force of a stroke, mean of strokes"),
    "total_clearance": Followed("m", False, "way of the slider between a pull up and a pull down"),
    "bdc_error": Followed("m", False, "bottom dead centre from its ideal height, mean of strokes"),
    "bdc_drift": Followed("m", False, "bottom dead centre from its mean height when new"),
    "repeatability": Followed("m", False, "standard deviation of bottom dead centre"),
}
"""What a limit may be put on, by name."""


@dataclass(frozen=True)
class Limit:
    """A bound of a followed number; a part is good up to it.

    Attributes
    ----------
    name : str
        Of ``FOLLOWED``.
    joint : str
        Whose number it is; nothing where it is of the whole press.
    value : float
        SI.
    """

    name: str
    joint: str
    value: float

    @property
    def key(self) -> str:
        """The number as it is typed, such as ``A.depth``."""
        return f"{self.joint}.{self.name}" if self.joint else self.name

    @property
    def unit(self) -> str:
        """Unit of the value."""
        return FOLLOWED[self.name].unit


@dataclass(frozen=True)
class Service:
    """A bush that is made new, or turned by half a turn, after so many strokes."""

    joint: str
    strokes: float
    is_turned: bool

    @property
    def words(self) -> str:
        """What is done, in words."""
        return f"bush of {self.joint} {'turned by half' if self.is_turned else 'replaced'}"


_LIMIT = re.compile(r"\s*(?:([^\s.>]+)\.)?([^\s.>]+)\s*>\s*(\S.*?)\s*$")
_SERVICE = re.compile(r"\s*([^\s@]+)\s*@\s*(\S+)\s*$")
_STROKES = Quantity("", 1.0, 1e15, "", "")
NEW, TURNED = "replaced", "turned"


@dataclass(frozen=True)
class Life:
    """How long the joints of a scene are worn: until the first of some limits is passed."""

    kind: ClassVar[str] = "limits"

    until: str = free_text(
        "depth > 0.05 mm",
        "'bdc_drift > 0.05 mm, A.depth > 80 um'",
        "limits, of which the first counts: of every joint, or JOINT.NAME; names are "
        + ", ".join(FOLLOWED),
    )
    at_most: float = quantity(
        5e7, "", 1.0, 1e15, "chosen", "strokes after which the wear is followed no further"
    )
    replaced: str = free_text(
        "", "'A@2e6, C@4e6'", "bushes that are made new after so many strokes"
    )
    turned: str = free_text("", "'A@2e6'", "bushes that are turned by half after so many strokes")
    max_cycles: int = count(
        10_000, 16, 10_000_000, "chosen", "cycles of all starts at most in one pass over the life"
    )

    def __post_init__(self) -> None:
        """InputError where a value is out of range."""
        check_fields(self)

    def limits(self, joints: Sequence[str]) -> tuple[Limit, ...]:
        """The limits, of all joints where none is named.

        Parameters
        ----------
        joints : sequence of str
            With clearance.

        Raises
        ------
        InputError
            For an unknown number or joint, and for a value that is none or has no unit.
        """
        found = []
        for text in self.until.split(","):
            match = _LIMIT.match(text)
            if match is None:
                raise InputError(
                    f"until = {text.strip()!r}: NAME > VALUE is expected, such as "
                    f"'depth > 0.05 mm'; names are {', '.join(FOLLOWED)}"
                )
            joint, name, size = match.groups()
            if name not in FOLLOWED:
                raise unknown("number in until", name, FOLLOWED)
            followed = FOLLOWED[name]
            if joint is not None:
                if not followed.of_joint:
                    raise InputError(f"until = {text.strip()!r}: {name} is of the whole mechanism")
                _check_joint(joint, joints, "until")
            meaning = Quantity(followed.unit, 0.0, math.inf, "", followed.text, open_low=True)
            value = parse_quantity(f"until: {name}", size, meaning)
            of = ((joint,) if joint else joints) if followed.of_joint else ("",)
            found += [Limit(name, own, value) for own in of]
        return tuple(found)

    def services(self, joints: Sequence[str]) -> tuple[Service, ...]:
        """What is done to bushes, in the order of strokes; InputError where it cannot be read."""
        found = []
        for key, text in ((NEW, self.replaced), (TURNED, self.turned)):
            for own in filter(str.strip, text.split(",")):
                match = _SERVICE.match(own)
                if match is None:
                    raise InputError(
                        f"{key} = {own.strip()!r}: JOINT@STROKES is expected, such as 'A@2e6'"
                    )
                _check_joint(match[1], joints, key)
                strokes = float(parse_quantity(f"{key}: {match[1]}", match[2], _STROKES))
                if strokes >= self.at_most:
                    raise InputError(
                        f"{key} = {own.strip()!r}: allowed is below at_most = {self.at_most:g}"
                    )
                found.append(Service(match[1], strokes, key == TURNED))
        return tuple(sorted(found, key=lambda service: service.strokes))


def _check_joint(joint: str, joints: Sequence[str], where: str) -> None:
    if joint not in joints:
        raise unknown(f"joint with clearance in {where}", joint, joints)


LIVES = {Life.kind: Life}
"""Kinds of life that a scene may have."""
