"""Springs and loads: where a force or a moment acts, and the law of its size.

A law is continuous in position and speed, or in position and the deepest place so far, so that no
load can switch itself on and off without end; the one jump, a release, is made good only by the
whole way back.  Where a law
bends or jumps is located by every engine: no step crosses it.  Where a function of one's own
bends is its owner's business: no engine knows.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Annotated, Any, Literal, cast

from presswear.linkage.points import ANGLE, LARGE, TURNED, Attachment, End
from presswear.tools.errors import InputError
from presswear.tools.quantities import Quantity, quantity
from presswear.tools.serialize import check_fields
from presswear.tools.user_function import UserFunction

Sense = Literal["both", "along", "against"]
Outside = Literal["hold", "zero"]
Table = Sequence[tuple[float, float]]

STRONG = 1e12
"""Greatest constant load, N or N m; the strongest press has 1e9."""
STEEP = 1e16
"""Steepest elastic line, N/m or N m/rad: the greatest process force over the least depth."""
FAST = 1e6
"""Greatest frequency, rad/s."""
LEAST_REPEAT = 1e-6
"""Of a table over position, m or rad; steps end at all its nodes."""
LEAST_GAP = 1e-6
"""Between two neighbours in a table, part of its length: closer ones are a jump."""
ROUND_OFF = 1e-6
"""Part by which a slope may differ from one that is computed from the nodes of a table."""


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
    first: End
    second: End
    stiffness: Annotated[float, Quantity("N/m", 0.0, 1e12, "", "stiffness")]
    length: Annotated[float, Quantity("m", 0.0, LARGE, "", "length without force")]
    damping: float = quantity(0.0, "N s/m", 0.0, 1e12, "", "damping")

    def __post_init__(self) -> None:
        """InputError where a number is out of range."""
        check_fields(self)

    @property
    def ends(self) -> tuple[Attachment, Attachment]:
        """Both its ends, which a linkage has found."""
        return cast(tuple[Attachment, Attachment], (self.first, self.second))


@dataclass(frozen=True)
class Load:
    """A constant force, N, at the mass centre of a body and moment, N m, on it."""

    body: str
    x: float = quantity(0.0, "N", -STRONG, STRONG, "", "force to the right, at the mass centre")
    y: float = quantity(0.0, "N", -STRONG, STRONG, "", "force upwards")
    moment: float = quantity(0.0, "N m", -STRONG, STRONG, "", "moment, counterclockwise")

    def __post_init__(self) -> None:
        """InputError where a number is out of range."""
        check_fields(self)


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
    frequency: float = quantity(0.0, "rad/s", 0.0, FAST, "", "frequency of the first harmonic")
    harmonics: Table = ()

    def __post_init__(self) -> None:
        """InputError where a number is out of range, or harmonics have no frequency."""
        check_fields(self)
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
    period: float | None = quantity(
        None, "s", 0.0, 1e6, "", "after which the table repeats; 0: never; else after a cycle"
    )

    def __post_init__(self) -> None:
        """InputError where the table is none, or longer than its period."""
        check_fields(self)
        _rising("over_time", self.table)
        if self.period is not None:
            self.check("period", self.period)

    def check(self, name: str, period: float) -> None:
        """InputError unless the table fits into a period, s, of a name."""
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
    hold creeps, and nothing switches to and fro.  Where it is elastic-plastic, with ``unloading``,
    no speed matters: it is the table on the way in; where the motion turns back it falls along a
    straight line to zero and stays there, and on the way in again it rises along that line up to
    the deepest place and then follows the table.  Of the energy that it takes it gives back what
    is under that line.  A run that begins within the table begins at the deepest place.

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
    unloading : float
        Slope of the elastic line, N/m or N m/rad; 0: none.  The deepest place is forgotten where
        the table begins.
    """

    table: Table
    sense: Sense = "both"
    outside: Outside = "zero"
    zero: float = quantity(0.0, "m or rad", -TURNED, TURNED, "", "where the table has its zero")
    rise: float = quantity(
        1e-3, "m/s or rad/s", 1e-9, 1e6, "", "speed from which a load in one sense is whole"
    )
    release: bool = False
    repeats: float = quantity(
        0.0, "m or rad", 0.0, TURNED, "", "position after which the table repeats; 0: it does not"
    )
    unloading: float = quantity(
        0.0, "N/m or N m/rad", 0.0, STEEP, "", "slope of the elastic line back; 0: none"
    )

    def __post_init__(self) -> None:
        """InputError where the table is none, or the law would jump or drive the motion."""
        check_fields(self)
        table = self.table
        _rising("over_position", table)
        self._check_ends(table)
        if 0.0 < self.repeats < LEAST_REPEAT:
            raise InputError(
                f"repeats = {self.repeats:g} m or rad: allowed is 0, or {LEAST_REPEAT:g} to "
                f"{TURNED:g} m or rad"
            )
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

        if self.unloading:
            self._check_unloading(table)

    def _check_unloading(self, table: Table) -> None:
        """InputError where a table has no elastic line back, or one that gives what none took."""
        if self.sense == "both" or self.repeats:
            raise InputError(
                "unloading: it needs a table that acts in one sense and does not repeat"
            )
        begin = table[0] if self.sense == "along" else table[-1]
        if begin[1] != 0.0:
            raise InputError(
                f"over_position: {begin[1]:g} N or N m at {begin[0]:g} m or rad, where it begins; "
                "with unloading allowed is 0"
            )
        # Resistance against the way, whose signs cancel in either sense.
        steepest = max(
            ((one[1] - other[1]) / (other[0] - one[0]) for one, other in pairwise(table)),
            default=0.0,
        )
        if self.unloading < (1.0 - ROUND_OFF) * steepest:
            raise InputError(
                f"unloading = {self.unloading:g} N/m or N m/rad: allowed is {steepest:g}, the "
                f"steepest rise of the table, to {STEEP:g} N/m or N m/rad"
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


Law = float | Harmonics | OverTime | OverPosition | UserFunction | Callable[..., float] | str
"""Law of the size of a load: a constant, N or N m, one of these, or a function of one's own of
LOAD_PARAMETERS, as ``FILE.py:NAME`` too."""
LOAD_PARAMETERS = ("time", "position", "speed")
"""What a law of one's own may ask for: s; m or rad; m/s or rad/s."""


@dataclass(frozen=True)
class Force:
    """A force at a point of a body, along a direction that stays fixed on the frame.

    Attributes
    ----------
    point : Attachment or str
        As ``body.point``, or as ``body`` for its mass centre.
    direction : float
        rad.
    law : Law
        Its size along the direction, N.  The position of a table is that of the point along
        the direction, measured from the origin of the frame.
    name : str
        What it stands for, by which a run tells that it was modelled.
    """

    point: Attachment | str
    direction: Annotated[float, replace(ANGLE, text="direction of the force")]
    law: Law
    name: str = ""

    def __post_init__(self) -> None:
        """InputError where a number is out of range."""
        check_fields(self)
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
    if isinstance(law, UserFunction | dict | str) or callable(law):
        return UserFunction.read("law", law, LOAD_PARAMETERS)
    return float(law)


def _rising(name: str, rows: Table) -> None:
    """InputError unless the first column of a table rises; names the row that does not."""
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
