"""Laws of loads: harmonics, tables over time and over position, user functions.

A law is continuous in position and speed, or in position and the greatest depth so far.
Otherwise a load could switch on and off endlessly. A release is a jump to zero, after
which the load acts again only when the motion is back at the start of the table. Every
engine locates the corners and jumps of a law, and no step crosses them. The engines do not
know the corners of a user function.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise, product
from typing import Annotated, Any, ClassVar, Literal

from presswear.linkage.points import MAX_ANGLE
from presswear.tools.errors import InputError, unknown
from presswear.tools.fields import quantity
from presswear.tools.quantities import Quantity
from presswear.tools.serialize import Checked, make
from presswear.tools.user_function import UserFunction

Sense = Literal["both", "along", "against"]
Outside = Literal["zero", "hold"]
# Largest slope of an elastic line, N/m or N m/rad: MAX_FORCE / MIN_DEPTH of a process
MAX_SLOPE = 1e16
MAX_FREQUENCY = 1e6  # rad/s
# Smallest distance of two nodes of a table, part of its length: closer nodes are a jump
MIN_GAP = 1e-6
SLOPE_TOL = 1e-6  # relative error of a slope that is computed from the nodes of a table
_TIME = Annotated[float, Quantity("s", -1e15, 1e15)]
_POSITION = Annotated[float, Quantity("m or rad", -1e15, 1e15)]
_LOAD = Annotated[float, Quantity("N or N m", -1e15, 1e15)]
Table = Sequence[tuple[float, float]]


@dataclass(frozen=True)
class Harmonics(Checked):
    """Fourier series, N or N m: mean + sum over k from 1 of a_k cos k w t + b_k sin k w t."""

    kind: ClassVar[str] = "harmonics"

    mean: _LOAD = 0.0
    frequency: float = quantity(
        0.0, "rad/s", 0.0, MAX_FREQUENCY, "", "of the first harmonic"
    )
    harmonics: Sequence[tuple[_LOAD, _LOAD]] = ()

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.harmonics and not self.frequency > 0.0:
            raise InputError(
                f"frequency = {self.frequency:g} rad/s: with harmonics it must be above 0"
            )


@dataclass(frozen=True)
class OverTime(Checked):
    """Table over time, linear between its nodes: time, s, and force, N, or moment, N m."""

    kind: ClassVar[str] = "over-time"

    table: Sequence[tuple[_TIME, _LOAD]]
    period: float | None = quantity(
        None,
        "s",
        0.0,
        1e6,
        "",
        "period of the table; 0: it does not repeat; default: a cycle",
    )

    def __post_init__(self) -> None:
        super().__post_init__()
        _check_rising(self.table)
        if self.period is not None:
            self.check_period("period", self.period)

    def check_period(self, name: str, period: float) -> None:
        """Raise InputError unless the table fits into a period, s."""
        first, _ = self.table[0]
        last, _ = self.table[-1]
        if period > 0.0 and not (first >= 0.0 and last <= period):
            allowed = f"with a {name} of {period:g} s allowed is 0 to {period:g} s"
            raise InputError(f"table: from {first:g} to {last:g} s; {allowed}")


@dataclass(frozen=True)
class OverPosition(Checked):
    """Table over the position of the point along the force, or the angle of the body.

    A load with one ``sense`` resists the motion. It is 0 at rest and in the other
    sense, and grows with the speed to its full size, like friction in a joint. With
    ``unloading`` the load is elastic-plastic and independent of the speed. If the
    motion reverses, it falls along a straight line to zero. On the way in it rises
    along this line up to the largest depth, and then follows the table. A run that
    begins within the table begins at the largest depth.

    Attributes
    ----------
    table : tuple of (float, float)
        Position, m, and force, N; or angle, rad, and moment, N m. Linear between.
    sense : {"both", "along", "against"}
        Motion in which the load acts: both senses, only along the direction of the
        force (counterclockwise), or only against it. Forces and moments are positive
        along the direction, so that a load that resists motion against it is positive.
    outside : {"zero", "hold"}
        Load beyond the ends of the table: zero, or the value at the end.
    release : bool
        After the end of the table the load is zero until the motion is back at the
        start of the table, as in blanking.
    """

    kind: ClassVar[str] = "over-position"

    table: Sequence[tuple[_POSITION, _LOAD]]
    sense: Sense = "both"
    outside: Outside = "zero"
    zero: float = quantity(
        0.0, "m or rad", -MAX_ANGLE, MAX_ANGLE, "", "zero of the table"
    )
    release: bool = False
    unloading: float = quantity(
        0.0,
        "N/m or N m/rad",
        0.0,
        MAX_SLOPE,
        "",
        "slope of the elastic line back; 0: none",
    )

    def __post_init__(self) -> None:
        """Raise InputError where the law would jump, drive the motion or create energy."""
        super().__post_init__()
        _check_rising(self.table)
        self._check_jumps()
        if self.release and (self.sense == "both" or len(self.table) < 2):
            raise InputError(
                "release: it needs a table of two nodes that acts in one sense"
            )
        self._check_resistance()
        if self.unloading:
            self._check_unloading()

    @property
    def _first_nodes(self) -> Table:
        """Nodes at which the load begins, one for each sense in which it acts."""
        lowest = self.table[0]
        highest = self.table[-1]
        if self.sense == "along":
            return (lowest,)
        if self.sense == "against":
            return (highest,)
        return lowest, highest

    def _check_jumps(self) -> None:
        """Raise InputError where a load that is zero outside its table would jump."""
        if self.outside != "zero":
            return
        ends = self._first_nodes if self.release else (self.table[0], self.table[-1])
        for place, size in ends:
            if size != 0.0:
                end = f"{size:g} N or N m at the end, {place:g} m or rad,"
                allowed = "allowed are 0 there, or outside = hold"
                raise InputError(f"table: {end} would be a jump to 0; {allowed}")

    def _check_resistance(self) -> None:
        """Raise InputError where a load in one sense would drive the motion."""
        driving_sign = {"along": 1.0, "against": -1.0, "both": 0.0}[self.sense]
        for place, size in self.table:
            if driving_sign * size > 0.0:
                raise InputError(
                    f"table: {size:g} N or N m at {place:g} m or rad would drive the motion "
                    f"{self.sense} its direction; in one sense a load must resist it"
                )

    def _check_unloading(self) -> None:
        """Raise InputError if unloading would return more energy than loading has taken."""
        if self.sense == "both":
            raise InputError("unloading: it needs a table that acts in one sense")
        place, size = self._first_nodes[0]
        if size != 0.0:
            fault = f"{size:g} N or N m at {place:g} m or rad, where it begins"
            raise InputError(f"table: {fault}; with unloading allowed is 0")
        # Rises of the resistance with the depth. With sense = along the force is negative;
        # with sense = against the depth grows against the position.
        slopes = []
        for (place, size), (next_place, next_size) in pairwise(self.table):
            slopes.append((size - next_size) / (next_place - place))
        steepest = max(slopes, default=0.0)
        if self.unloading < (1.0 - SLOPE_TOL) * steepest:
            raise InputError(
                f"unloading = {self.unloading:g} N/m or N m/rad: allowed is {steepest:g}, the "
                f"steepest rise of the table, to {MAX_SLOPE:g} N/m or N m/rad"
            )


def _check_rising(table: Table) -> None:
    """Raise InputError unless the first column of a table rises."""
    if not table:
        raise InputError("table: one row or more is expected")
    places = [place for place, _ in table]
    least = MIN_GAP * (max(places) - min(places))
    for k, (previous, place) in enumerate(pairwise(places), start=1):
        if not place - previous > least:
            fault = f"{place:g} does not lie above {previous:g}, the row before it"
            raise InputError(
                f"table[{k}]: {fault}, by a millionth of the table's length"
            )


LAWS: Mapping[str, Any] = {law.kind: law for law in (Harmonics, OverTime, OverPosition)}
LOAD_PARAMETERS = ("time", "position", "speed")
"""Parameters of a user law: s; m or rad; m/s or rad/s."""


def check_load(key: str, law: UserFunction) -> None:
    """Raise InputError where a user law of a load jumps with the speed.

    At a jump that reverses the motion the load would switch endlessly.
    """
    sizes = (0.0, 1e-3, 0.01, 0.1, 1.0)
    for time, size, sign in product((0.0, 0.1, 1.0), sizes, (1.0, -1.0)):
        if jump := law.jump("speed", {"time": time, "position": sign * size}):
            speed, below, above = jump
            raise InputError(
                f"{key}: {law.name} jumps from {below:g} to {above:g} N or N m at a speed "
                f"of {speed:g} m/s or rad/s: it must be continuous, as with tanh(speed / "
                "0.001), which changes over 1 mm/s or 1 mrad/s"
            )


Law = (
    float
    | Harmonics
    | OverTime
    | OverPosition
    | UserFunction
    | Callable[..., float]
    | str
)


@dataclass(frozen=True)
class LawOf:
    """Reader of the law of a force or of a moment."""

    unit: str

    def convert(self, name: str, value: Any) -> Any:
        """Return a law from an instance, a constant, a function, ``FILE.py:NAME`` or plain data."""
        if isinstance(value, tuple(LAWS.values())):
            return value
        if isinstance(value, Mapping) and "kind" in value:
            kind = value["kind"]
            if kind not in LAWS:
                raise unknown(f"kind of {name}", kind, LAWS)
            return make(name, LAWS[kind], value)
        is_file = isinstance(value, str) and ".py:" in value
        if callable(value) or isinstance(value, UserFunction | Mapping) or is_file:
            return UserFunction.read(name, value, LOAD_PARAMETERS)
        return Quantity(self.unit, -1e15, 1e15).convert(name, value)
