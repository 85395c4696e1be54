"""Springs and loads: where a force or a moment acts, and the law of its size.

A law is continuous in position and speed, so that no load can switch itself on and off
without end; the one jump, a release, is made good only by the whole way back.  Where a law
bends or jumps is located by every engine: no step crosses it.  Where a function of one's own
bends is its owner's business: no engine knows.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal, get_args

from presswear.tools.errors import InputError, nearest
from presswear.tools.own import OwnFunction

if TYPE_CHECKING:
    from presswear.linkage.elements import Attachment

Sense = Literal["both", "along", "against"]
Outside = Literal["hold", "zero"]
Table = Sequence[tuple[float, float]]

LEAST_GAP = 1e-6
"""Between two neighbours in a table, part of its length: closer ones are a jump."""


@dataclass(frozen=True)
class Spring:
    """A linear spring and damper between two points.

    Attributes
    ----------
    stiffness, damping : float
        N/m, N s/m.
    length : float
        Length without force, m.
    """

    name: str
    first: "Attachment"
    second: "Attachment"
    stiffness: float
    length: float
    damping: float = 0.0

    def __post_init__(self) -> None:
        """InputError where a number is below zero."""
        for name, unit in (("stiffness", "N/m"), ("length", "m"), ("damping", "N s/m")):
            _at_least(f"{name} of spring {self.name}", getattr(self, name), 0.0, unit)


@dataclass(frozen=True)
class Load:
    """A constant force, N, at the mass centre of a body and moment, N m, on it."""

    body: str
    x: float = 0.0
    y: float = 0.0
    moment: float = 0.0


@dataclass(frozen=True)
class Harmonics:
    """A Fourier series over time: mean + sum over k from 1 of a_k cos k w t + b_k sin k w t.

    Attributes
    ----------
    mean : float
        N or N m.
    frequency : float
        w, rad/s.
    harmonics : tuple of (float, float)
        a_k and b_k, N or N m.
    """

    mean: float = 0.0
    frequency: float = 0.0
    harmonics: Table = ()

    def __post_init__(self) -> None:
        """InputError where a number is none, or harmonics have no frequency."""
        object.__setattr__(self, "harmonics", _pairs("harmonics", self.harmonics))
        _finite("mean", self.mean)
        _finite("frequency", self.frequency)
        if self.harmonics and not self.frequency > 0.0:
            raise InputError(
                f"frequency = {self.frequency:g} rad/s: with harmonics it must be above 0"
            )


@dataclass(frozen=True)
class OverTime:
    """A table over time, linear between its nodes.

    Attributes
    ----------
    table : tuple of (float, float)
        Time, s, and force, N, or moment, N m.
    period : float or None
        Time after which it repeats, s; None: the cycle of the mechanism; 0: it does not repeat,
        and its ends are held.
    """

    table: Table
    period: float | None = None

    def __post_init__(self) -> None:
        """InputError where the table is none, or longer than its period."""
        object.__setattr__(self, "table", _rising("over_time", self.table))
        if self.period is not None:
            self.check("period", self.period)

    def check(self, name: str, period: float) -> None:
        """InputError unless the table fits into a period, s, of a name."""
        _at_least(name, period, 0.0, "s")
        last = self.table[-1][0]
        if period > 0.0 and not (self.table[0][0] >= 0.0 and last <= period):
            raise InputError(
                f"over_time: from {self.table[0][0]:g} to {last:g} s; with a {name} of "
                f"{period:g} s allowed is 0 to {period:g} s"
            )


@dataclass(frozen=True)
class OverPosition:
    """A table over the position of the point along the force, or the angle of the body.

    In one sense of motion alone, a load resists: it is 0 at rest and behind, grows with the
    speed up to ``rise`` and is whole from there, as friction in a joint is.  A body it could
    hold creeps, and nothing switches to and fro.

    Attributes
    ----------
    table : tuple of (float, float)
        Position, m, and force, N; or angle, rad, and moment, N m.  Linear between.
    sense : {"both", "along", "against"}
        Motion in which it acts: both senses, along the force's direction alone (counterclockwise)
        or against it.  Forces and moments are counted along the direction, so that one that
        resists motion against it is positive.
    outside : {"zero", "hold"}
        Beyond the ends of the table: nothing, or the value at the end.
    zero : float
        Position at which the table has its zero, m or rad.
    rise : float
        Speed from which a load in one sense is whole, m/s or rad/s.
    release : bool
        Once the motion has passed the end of the table there is no load until it is back
        where the table begins, as in blanking.
    repeats : float
        Position after which the table repeats, m or rad; 0: it does not.
    """

    table: Table
    sense: Sense = "both"
    outside: Outside = "zero"
    zero: float = 0.0
    rise: float = 1e-3
    release: bool = False
    repeats: float = 0.0

    def __post_init__(self) -> None:
        """InputError where the table is none, or the law would jump or drive the motion."""
        table = _rising("over_position", self.table)
        object.__setattr__(self, "table", table)
        _word("sense", self.sense, get_args(Sense))
        _word("outside", self.outside, get_args(Outside))
        _finite("zero", self.zero)
        _at_least("repeats", self.repeats, 0.0, "m or rad")
        if not (_is_number(self.rise) and 0.0 < self.rise < math.inf):
            raise InputError(f"rise = {self.rise!r}: allowed is above 0 m/s or rad/s")
        self._check_ends(table)
        if self.release and (self.sense == "both" or self.repeats or len(table) < 2):
            raise InputError(
                "release: it needs a table of two nodes that acts in one sense and does not repeat"
            )
        wrong = {"along": 1.0, "against": -1.0, "both": 0.0}[self.sense]
        for place, size in table:
            if wrong * size > 0.0:
                raise InputError(
                    f"over_position: {size:g} N or N m at {place:g} m or rad would drive the "
                    f"motion {self.sense} its direction; in one sense a load must resist it"
                )

    def _check_ends(self, table: Table) -> None:
        """InputError where there would be a jump at an end of the table."""
        if self.repeats:
            if table[0][0] < 0.0 or table[-1][0] > self.repeats:
                raise InputError(
                    f"over_position: from {table[0][0]:g} to {table[-1][0]:g} m or rad; with "
                    f"repeats = {self.repeats:g} allowed is 0 to {self.repeats:g}"
                )
            if table[-1][0] - table[0][0] == self.repeats and table[0][1] != table[-1][1]:
                raise InputError(
                    f"over_position: it repeats with a jump from {table[-1][1]:g} to "
                    f"{table[0][1]:g} N or N m; allowed are equal values at both ends"
                )
        elif self.outside == "zero":
            ends = {"along": table[:1], "against": table[-1:], "both": (table[0], table[-1])}
            for place, size in ends[self.sense] if self.release else (table[0], table[-1]):
                if size != 0.0:
                    raise InputError(
                        f"over_position: {size:g} N or N m at the end, {place:g} m or rad, would "
                        "be a jump to 0; allowed are 0 there, or outside = hold"
                    )


Law = float | Harmonics | OverTime | OverPosition | OwnFunction | Callable[..., float]
"""Law of the size of a load: a constant, N or N m, one of these, or a function of one's own of
LOAD_PARAMETERS."""
LOAD_PARAMETERS = ("time", "position", "speed")
"""What a law of one's own may ask for: s; m or rad; m/s or rad/s."""


@dataclass(frozen=True)
class Force:
    """A force at a point of a body, along a direction that stays fixed on the frame.

    Attributes
    ----------
    point : Attachment or str
        As ``body.point``, or a body, at whose mass centre it acts.
    direction : float
        rad.
    law : Law
        Its size along the direction, N.  The position of a table is that of the point along
        the direction, measured from the origin of the frame.
    """

    point: "Attachment | str"
    direction: float
    law: Law

    def __post_init__(self) -> None:
        """InputError where a number is none."""
        _finite("direction", self.direction)
        object.__setattr__(self, "law", _law(self.law))

    @property
    def body(self) -> str:
        """Name of the body that it acts on."""
        return self.point.partition(".")[0] if isinstance(self.point, str) else self.point.body


@dataclass(frozen=True)
class Moment:
    """A moment on a body, counterclockwise.

    Attributes
    ----------
    law : Law
        Its size, N m.  The position of a table is the angle of the body, which goes on counting
        turn after turn.
    """

    body: str
    law: Law

    def __post_init__(self) -> None:
        """InputError where a number is none."""
        object.__setattr__(self, "law", _law(self.law))
        if isinstance(self.law, float):
            raise InputError(f"law = {self.law:g} N m: a constant moment is one of Load")


AnyLoad = Load | Force | Moment


def _law(law: Any) -> Law:
    """A law, a function made one of one's own; InputError where it is none."""
    if isinstance(law, Harmonics | OverTime | OverPosition):
        return law
    if isinstance(law, OwnFunction | dict | str) or callable(law):
        own = OwnFunction.of("law", law)
        own.parameters("law", LOAD_PARAMETERS)
        return own
    _finite("law", law)
    return float(law)


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _finite(name: str, value: Any) -> None:
    """InputError unless a value is a finite number."""
    if not (_is_number(value) and math.isfinite(value)):
        raise InputError(f"{name} = {value!r}: a finite number is expected")


def _at_least(name: str, value: Any, least: float, unit: str) -> None:
    if not (_is_number(value) and least <= value < math.inf):
        raise InputError(f"{name} = {value!r}: allowed is at least {least:g} {unit}")


def _word(name: str, value: Any, words: tuple[str, ...]) -> None:
    if value not in words:
        raise InputError(
            f"{name} = {value!r}: allowed is one of {', '.join(words)}{nearest(str(value), words)}"
        )


def _pairs(name: str, table: Any) -> Table:
    """Pairs of finite numbers as a tuple; InputError names the one that is none."""
    try:
        rows = tuple((float(one), float(other)) for one, other in table)
    except (TypeError, ValueError):
        raise InputError(f"{name} = {table!r}: pairs of numbers are expected") from None
    for k, row in enumerate(rows):
        if not all(map(math.isfinite, row)):
            raise InputError(f"{name}[{k}] = {row}: finite numbers are expected")
    return rows


def _rising(name: str, table: Any) -> Table:
    """A table whose first column rises; InputError names the row that does not."""
    rows = _pairs(name, table)
    if not rows:
        raise InputError(f"{name}: a table of one row or more is expected")
    least = LEAST_GAP * (max(row[0] for row in rows) - min(row[0] for row in rows))
    for k in range(1, len(rows)):
        one, other = rows[k - 1][0], rows[k][0]
        if not other - one > least:
            raise InputError(
                f"{name}[{k}]: {other:g} does not lie above {one:g}, the row before it, by a "
                f"millionth of the table's length"
            )
    return rows
