"""Springs, loads with their laws, and the process forces of a press.

A law is continuous in position and speed, or in position and the greatest depth so far,
so that no load can switch on and off without end; the one jump, a release, is undone
only by the whole way back. Every engine locates the corners and jumps of a law, and no
step crosses them; it does not know the corners of a user function.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Annotated, Any, ClassVar, Literal, cast

from presswear.linkage.elements import ANGLE, MAX_ANGLE, MAX_LENGTH, Attachment, End
from presswear.tools.errors import InputError, unknown
from presswear.tools.quantities import Quantity, choice, quantity, written
from presswear.tools.serialize import Checked, make
from presswear.tools.user_function import UserFunction

Sense = Literal["both", "along", "against"]
Outside = Literal["zero", "hold"]

MAX_LOAD = 1e12  # N or N m; the strongest press has 1e9
# of an elastic line, N/m or N m/rad: the greatest process force over MIN_DEPTH
MAX_SLOPE = 1e16
MAX_FREQUENCY = 1e6  # rad/s
# between two nodes of a table, part of its length: closer ones are a jump
MIN_GAP = 1e-6
SLOPE_TOL = 1e-6  # relative, of a slope that is computed from the nodes of a table

_TIME = Annotated[float, Quantity("s", -1e15, 1e15)]
_POSITION = Annotated[float, Quantity("m or rad", -1e15, 1e15)]
_LOAD = Annotated[float, Quantity("N or N m", -1e15, 1e15)]
Table = Sequence[tuple[float, float]]


@dataclass(frozen=True)
class Spring(Checked):
    """Linear spring and damper between two points, along the line between them.

    With length 0 the spring is -k e, without force where the points meet.
    """

    name: str
    first: End
    second: End
    stiffness: Annotated[float, Quantity("N/m", 0.0, 1e12, "", "stiffness")]
    length: Annotated[float, Quantity("m", 0.0, MAX_LENGTH, "", "length without force")]
    damping: float = quantity(0.0, "N s/m", 0.0, 1e12, "", "damping")

    @property
    def ends(self) -> tuple[Attachment, Attachment]:
        """Both ends, in an assembled linkage."""
        return cast(tuple[Attachment, Attachment], (self.first, self.second))


@dataclass(frozen=True)
class Load(Checked):
    """Constant force, N, at the mass centre of a body and moment, N m, on it."""

    body: str
    x: float = quantity(
        0.0, "N", -MAX_LOAD, MAX_LOAD, "", "force to the right, at the mass centre"
    )
    y: float = quantity(0.0, "N", -MAX_LOAD, MAX_LOAD, "", "force upwards")
    moment: float = quantity(
        0.0, "N m", -MAX_LOAD, MAX_LOAD, "", "moment, counterclockwise"
    )


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
        first, last = self.table[0][0], self.table[-1][0]
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
        """Raise InputError where the law would jump or drive the motion, or give back more."""
        super().__post_init__()
        table, sense = self.table, self.sense
        _check_rising(table)
        ends = {
            "along": table[:1],
            "against": table[-1:],
            "both": (table[0], table[-1]),
        }[sense]
        jumps = (
            (ends if self.release else (table[0], table[-1]))
            if self.outside == "zero"
            else ()
        )
        for place, size in jumps:
            if size != 0.0:
                end = f"{size:g} N or N m at the end, {place:g} m or rad,"
                allowed = "allowed are 0 there, or outside = hold"
                raise InputError(f"table: {end} would be a jump to 0; {allowed}")
        if self.release and (sense == "both" or len(table) < 2):
            raise InputError(
                "release: it needs a table of two nodes that acts in one sense"
            )
        wrong = {"along": 1.0, "against": -1.0, "both": 0.0}[sense]
        for place, size in table:
            if wrong * size > 0.0:
                raise InputError(
                    f"table: {size:g} N or N m at {place:g} m or rad would drive the motion "
                    f"{sense} its direction; in one sense a load must resist it"
                )
        if not self.unloading:
            return
        if sense == "both":
            raise InputError("unloading: it needs a table that acts in one sense")
        place, size = ends[0]
        if size != 0.0:
            fault = f"{size:g} N or N m at {place:g} m or rad, where it begins"
            raise InputError(f"table: {fault}; with unloading allowed is 0")
        # Resistance against the way, whose signs cancel in either sense.
        steepest = max(
            ((a[1] - b[1]) / (b[0] - a[0]) for a, b in pairwise(table)), default=0.0
        )
        if self.unloading < (1.0 - SLOPE_TOL) * steepest:
            raise InputError(
                f"unloading = {self.unloading:g} N/m or N m/rad: allowed is {steepest:g}, the "
                f"steepest rise of the table, to {MAX_SLOPE:g} N/m or N m/rad"
            )


def _check_rising(table: Table) -> None:
    """Raise InputError unless the first column of a table rises."""
    if not table:
        raise InputError("table: one row or more is expected")
    least = MIN_GAP * (max(row[0] for row in table) - min(row[0] for row in table))
    for k, (before, row) in enumerate(pairwise(table), start=1):
        if not row[0] - before[0] > least:
            fault = f"{row[0]:g} does not lie above {before[0]:g}, the row before it"
            raise InputError(
                f"table[{k}]: {fault}, by a millionth of the table's length"
            )


LAWS: Mapping[str, Any] = {law.kind: law for law in (Harmonics, OverTime, OverPosition)}
LOAD_PARAMETERS = (
    "time",
    "position",
    "speed",
)  # of a user law: s; m or rad; m/s or rad/s


def check_load(key: str, law: UserFunction) -> None:
    """Raise InputError where a user law of a load jumps with the speed.

    Two forces that push towards a speed from both sides hold it by endless switching.
    """
    for time in (0.0, 0.1, 1.0):
        for size in (0.0, 1e-3, 0.01, 0.1, 1.0):
            for position in (size, -size):
                if jump := law.jump("speed", {"time": time, "position": position}):
                    place, below, above = jump
                    raise InputError(
                        f"{key}: {law.name} jumps from {below:g} to {above:g} N or N m at a speed "
                        f"of {place:g} m/s or rad/s: it must be continuous, as with tanh(speed / "
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
class _LawOf:
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


@dataclass(frozen=True)
class Force(Checked):
    """Force at a point of a body, along a direction that stays fixed on the frame, rad.

    Reports show its name.

    Attributes
    ----------
    point : Attachment or str
        As ``body.point``, or as ``body`` for its mass centre.
    law : float, Harmonics, OverTime, OverPosition, callable or str
        Size along the direction, N; a constant, a law, or a user function of
        LOAD_PARAMETERS, also as ``FILE.py:NAME``. The position of a table is that of
        the point along the direction, measured from the origin of the frame.
    """

    point: Attachment | str
    direction: Annotated[float, ANGLE]
    law: Annotated[Law, _LawOf("N")]
    name: str = ""

    @property
    def attachment(self) -> Attachment:
        """Point of the force, in an assembled linkage."""
        return cast(Attachment, self.point)

    @property
    def body(self) -> str:
        """Name of the body that it acts on."""
        return (
            self.point.partition(".")[0]
            if isinstance(self.point, str)
            else self.point.body
        )


@dataclass(frozen=True)
class Moment(Checked):
    """Moment on a body, counterclockwise, with a law of its size, N m, as a Force has.

    The position of a table is the angle of the body, continuous over several turns.
    """

    body: str
    law: Annotated[Law, _LawOf("N m")]

    def __post_init__(self) -> None:
        super().__post_init__()
        if isinstance(self.law, float):
            raise InputError(f"law = {self.law:g} N m: use Load for a constant moment")


AnyLoad = Load | Force | Moment


# Process forces: the work lies towards an extreme of the output coordinate in the ideal
# motion, its bottom dead centre: for the slider of a press the lowest place. Where that
# is the highest, a scene observes the opposite direction, so that up is away from the
# work in every scene. Height is counted from bottom dead centre, depth from where the
# work is touched.
Extreme = Literal["lowest", "highest"]

MAX_FORCE = 1e9  # of a process, N: that of the strongest press
MAX_DEPTH = 10.0  # of a height or depth, m: the longest link of a machine
MIN_DEPTH = 1e-6  # m
_CURVE_PIECES = 4  # straight pieces of half a cosine
Curve = tuple[tuple[float, float], ...]


def _force(text: str, default: float, low: float = 1e-3) -> Any:
    return quantity(default, "N", low, MAX_FORCE, "chosen", text)


def _depth(default: float, text: str) -> Any:
    return quantity(default, "m", MIN_DEPTH, MAX_DEPTH, "chosen", text)


def _offset() -> Any:
    return quantity(0.0, "m", -MAX_DEPTH, MAX_DEPTH, "chosen", _OFFSET)


_HEIGHT = "height above the ideal bottom dead centre at which the work is touched"
_CUSHION = "additional constant force, in both directions of motion"
_BOTTOM = "output coordinate at bottom dead centre, where the work is"
_OFFSET = (
    "distance of the force from the output point, to the right with the work below; its "
    "guide needs clearance"
)


class _Work(Checked):
    """Curve of a process and what follows from it; a cushion gives back what it takes.

    It is elastic-plastic: where the motion turns back, the force falls as steeply as
    the curve rises at most; see ``laws_of``.
    """

    @property
    def curve(self) -> Curve:
        """Depth, m, and force on the way in, N, linear between; without the cushion."""
        return ((0.0, 0.0),)

    @property
    def fracture(self) -> float | None:
        """Depth at which the work breaks, m."""
        return None

    @property
    def work(self) -> float:
        """Work of a stroke, J."""
        return sum(0.5 * (b[0] - a[0]) * (a[1] + b[1]) for a, b in pairwise(self.curve))


@dataclass(frozen=True)
class Blanking(_Work):
    """Blanking: the force rises, stays constant, and falls to zero after the fracture."""

    kind: ClassVar[str] = "blanking"

    force: float = _force("force of the plateau", 500.0)
    height: float = _depth(5e-3, _HEIGHT)
    thickness: float = _depth(1e-3, "thickness of the sheet")
    stiffness: float | None = quantity(
        None,
        "N/m",
        1.0,
        1e12,
        "chosen",
        "of the elastic rise; default: force over rise",
    )
    rise: float = _depth(
        1e-4, "depth over which the force rises; contains the stretch of a rigid frame"
    )
    plateau: float = quantity(
        0.4,
        "",
        0.0,
        1.0,
        "chosen",
        "fraction of the thickness at fracture",
        open_low=True,
    )
    snap: float = _depth(
        5e-5, "depth over which the force falls to zero after the fracture"
    )
    cushion: float = _force(_CUSHION, 0.0, 0.0)
    bottom: Extreme = choice("lowest", Extreme, _BOTTOM)
    offset: float = _offset()

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.stiffness is not None:
            low, high = self.force / MAX_DEPTH, self.force / MIN_DEPTH
            if not low <= self.stiffness <= high:
                limits = " to ".join(written(value, "N/m") for value in (low, high))
                allowed = f"with force = {written(self.force, 'N')} allowed is {limits}"
                raise InputError(
                    f"stiffness = {written(self.stiffness, 'N/m')}: {allowed}"
                )

    @property
    def curve(self) -> Curve:  # noqa: D102
        rise = self.rise if self.stiffness is None else self.force / self.stiffness
        broken = rise + self.plateau * self.thickness
        return (
            (0.0, 0.0),
            (rise, self.force),
            (broken, self.force),
            (broken + self.snap, 0.0),
        )

    @property
    def fracture(self) -> float:  # noqa: D102
        return self.curve[2][0]


@dataclass(frozen=True)
class Drawing(_Work):
    """Deep drawing: the force rises and falls as half cosines of straight pieces."""

    kind: ClassVar[str] = "drawing"

    force: float = _force("largest force", 300.0)
    height: float = _depth(10e-3, _HEIGHT)
    depth: float = _depth(8e-3, "punch travel over which the force rises and falls")
    peak: float = quantity(
        0.35, "", 0.05, 0.95, "chosen", "fraction of the depth at the peak"
    )
    cushion: float = _force(_CUSHION, 0.0, 0.0)
    bottom: Extreme = choice("lowest", Extreme, _BOTTOM)
    offset: float = _offset()

    @property
    def curve(self) -> Curve:  # noqa: D102
        peak = self.peak * self.depth
        parts = [k / _CURVE_PIECES for k in range(_CURVE_PIECES + 1)]
        sizes = [0.5 * self.force * (1.0 - math.cos(math.pi * part)) for part in parts]
        falling = (peak + part * (self.depth - peak) for part in parts[1:])
        depths = (*(part * peak for part in parts), *falling)
        return tuple(zip(depths, (*sizes, *sizes[-2::-1]), strict=True))


@dataclass(frozen=True)
class Coining(_Work):
    """Coining: an elastic stop, whose force is the same on the way down and up."""

    kind: ClassVar[str] = "coining"

    stiffness: float = quantity(1e6, "N/m", 1.0, 1e12, "chosen", "of die and work")
    height: float = _depth(3e-4, _HEIGHT)
    bottom: Extreme = choice("lowest", Extreme, _BOTTOM)
    offset: float = _offset()

    cushion: ClassVar[float] = 0.0


Process = Blanking | Drawing | Coining
PROCESSES: Mapping[str, type[Process]] = {
    one.kind: one for one in (Blanking, Drawing, Coining)
}


def check_reach(process: Process, stroke: float, body: str) -> None:
    """Raise InputError if the stroke of a body does not reach the work, or ends inside it, m."""
    depth = process.curve[-1][0]
    if not depth <= process.height < stroke:
        raise InputError(
            f"process.height = {written(process.height, 'm')} above bottom dead centre of "
            f"{body}: must be at least {written(depth, 'm')}, the depth of the work, and below "
            f"{written(stroke, 'm')}, the stroke"
        )


def laws_of(process: Process, contact: float, lift: float) -> dict[str, OverPosition]:
    """Return the laws of a process and its cushion, of forces away from the work, by name.

    Work that breaks or flows is loaded along its curve, and unloaded and loaded again
    along a straight line as steep as the steepest rise of the curve, up to the greatest
    depth of the stroke. Once it is worked through nothing acts until the stroke is
    over.

    The work is touched at the position ``contact``, along the direction away from it,
    m. A new blank lies there after a stroke, which is over at the height ``lift``
    above, m.
    """

    def table(curve: Curve) -> list[tuple[float, float]]:
        return sorted((0.0 - depth, force) for depth, force in curve)

    if isinstance(process, Coining):
        stop = ((0.0, 0.0), (MAX_DEPTH, process.stiffness * MAX_DEPTH))
        return {process.kind: OverPosition(table(stop), outside="hold", zero=contact)}
    steepest = max((b[1] - a[1]) / (b[0] - a[0]) for a, b in pairwise(process.curve))
    stroke = table(((-lift, 0.0), *process.curve))
    law = OverPosition(
        stroke, "against", zero=contact, release=True, unloading=steepest
    )
    laws = {process.kind: law}
    if process.cushion > 0.0:
        constant = ((0.0, 0.0), (process.curve[1][0], process.cushion))
        laws["cushion"] = OverPosition(table(constant), outside="hold", zero=contact)
    return laws
