"""Process forces of a press as data: what the work does to the point that is watched.

The work lies towards an extreme of the watched coordinate in the ideal motion, its bottom dead
centre: for the slider of a press the lowest place.  Where that is the highest, a scene watches the
opposite direction, so that up is away from the work in every scene.  Height is counted from bottom
dead centre, depth from where the work is touched.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, ClassVar, Literal, get_args

from presswear.linkage.loads import OverPosition
from presswear.tools.errors import InputError
from presswear.tools.quantities import choice, quantity
from presswear.tools.serialize import check_fields

Extreme = Literal["lowest", "highest"]

STRONGEST = 1e9
"""Of a process force, N: that of the strongest press."""
DEEP = 10.0
"""Of a height or depth, m: the longest link of a machine."""
THIN = 1e-6
"""Of a depth, m."""
CURVED = 4
"""Straight pieces of half a cosine."""


def _force(text: str, default: float, low: float = 1e-3) -> Any:
    return quantity(default, "N", low, STRONGEST, "chosen", text)


def _height(default: float) -> Any:
    text = "height over bottom dead centre, of the ideal motion, at which the work is touched"
    return quantity(default, "m", THIN, DEEP, "chosen", text)


def _depth(default: float, text: str) -> Any:
    return quantity(default, "m", THIN, DEEP, "chosen", text)


def _cushion() -> Any:
    return _force("constant force beside it, which pushes on the way back as well", 0.0, 0.0)


def _extreme() -> Any:
    text = "place of what is watched that is bottom dead centre"
    return choice("lowest", get_args(Extreme), text)


@dataclass(frozen=True)
class Blanking:
    """A sheet that is cut: the force rises, stays, and snaps through to zero.

    It is elastic-plastic: where the motion turns back, the force falls as steeply as it rose; see
    ``laws_of``.  The cushion beside it pushes both ways.

    Attributes
    ----------
    stiffness : float or None
        N/m; None: the force is whole after ``rise``.
    plateau : float
        Part of the thickness over which the force stays; there the sheet breaks.
    snap : float
        Depth, m, over which the force then falls to zero.
    """

    kind: ClassVar[str] = "blanking"

    force: float = _force("force of the plateau", 500.0)
    height: float = _height(5e-3)
    thickness: float = _depth(1e-3, "thickness of the sheet")
    stiffness: float | None = quantity(
        None, "N/m", 1.0, 1e12, "chosen", "of the elastic rise; none given: force over rise"
    )
    rise: float = _depth(1e-4, "depth of the elastic rise where no stiffness is given")
    plateau: float = quantity(
        0.4, "", 0.0, 1.0, "chosen", "part of the thickness after which it breaks", open_low=True
    )
    snap: float = _depth(5e-5, "depth over which the force falls to zero when it has broken")
    cushion: float = _cushion()
    bottom: Extreme = _extreme()

    def __post_init__(self) -> None:
        """InputError where a number is out of range."""
        check_fields(self)
        if self.stiffness is not None and not THIN <= self.force / self.stiffness <= DEEP:
            raise InputError(
                f"stiffness = {self.stiffness:g} N/m: with force = {self.force:g} N allowed is "
                f"{self.force / DEEP:g} to {self.force / THIN:g} N/m"
            )

    @property
    def curve(self) -> tuple[tuple[float, float], ...]:
        """Depth, m, and force on the way in, N, linear between; without the cushion."""
        rise = self.rise if self.stiffness is None else self.force / self.stiffness
        broken = rise + self.plateau * self.thickness
        return (0.0, 0.0), (rise, self.force), (broken, self.force), (broken + self.snap, 0.0)

    @property
    def fracture(self) -> float:
        """Depth at which the sheet breaks, m."""
        return self.curve[2][0]

    @property
    def work(self) -> float:
        """Work that it takes in a stroke, J; the cushion gives back what it takes."""
        _, (rise, _), (broken, _), (end, _) = self.curve
        return self.force * (0.5 * rise + (broken - rise) + 0.5 * (end - broken))


@dataclass(frozen=True)
class Drawing:
    """A cup that is drawn: the force rises and falls over the punch travel, as half cosines.

    Each of them is made of straight pieces.  It is elastic-plastic: where the motion turns back,
    the force falls as steeply as the curve rises at most; see ``laws_of``.  The cushion beside it
    pushes both ways.

    Attributes
    ----------
    depth : float
        Punch travel from where the blank is touched to where it is drawn through, m.
    peak : float
        Part of the depth at which the force is greatest.
    """

    kind: ClassVar[str] = "drawing"

    force: float = _force("greatest force", 300.0)
    height: float = _height(10e-3)
    depth: float = _depth(8e-3, "punch travel over which the force rises and falls")
    peak: float = quantity(0.35, "", 0.05, 0.95, "chosen", "part of the depth at its greatest")
    cushion: float = _cushion()
    bottom: Extreme = _extreme()

    fracture: ClassVar[None] = None

    def __post_init__(self) -> None:
        """InputError where a number is out of range."""
        check_fields(self)

    @property
    def curve(self) -> tuple[tuple[float, float], ...]:
        """Depth, m, and force on the way in, N, linear between; without the cushion."""
        peak = self.peak * self.depth
        parts = [k / CURVED for k in range(CURVED + 1)]
        sizes = [0.5 * self.force * (1.0 - math.cos(math.pi * part)) for part in parts]
        rising = [(part * peak, size) for part, size in zip(parts, sizes, strict=True)]
        falling = [
            (peak + part * (self.depth - peak), size)
            for part, size in zip(parts[1:], sizes[-2::-1], strict=True)
        ]
        return *rising, *falling

    @property
    def work(self) -> float:
        """Work that it takes in a stroke, J; the cushion gives back what it takes."""
        return 0.5 * self.force * self.depth


@dataclass(frozen=True)
class Coining:
    """A stiff stop of die and work, elastic: it pushes on the way back as on the way in."""

    kind: ClassVar[str] = "coining"

    stiffness: float = quantity(1e6, "N/m", 1.0, 1e12, "chosen", "of die and work")
    height: float = _height(3e-4)
    bottom: Extreme = _extreme()

    fracture: ClassVar[None] = None
    cushion: ClassVar[float] = 0.0
    curve: ClassVar[tuple[tuple[float, float], ...]] = ((0.0, 0.0),)
    work: ClassVar[float] = 0.0
    """It gives back what it takes, J."""

    def __post_init__(self) -> None:
        """InputError where a number is out of range."""
        check_fields(self)


Process = Blanking | Drawing | Coining
PROCESSES: Mapping[str, type[Process]] = {own.kind: own for own in (Blanking, Drawing, Coining)}
"""What a press may press on, by its kind."""


def check_reach(process: Process, stroke: float, watched: str) -> None:
    """InputError where the work is not reached in a stroke, m, or not worked through.

    Parameters
    ----------
    watched : str
        Word for what presses on it.
    """
    depth = process.curve[-1][0]
    if not depth <= process.height < stroke:
        raise InputError(
            f"process.height = {process.height:g} m: over the {process.bottom} place of the "
            f"{watched} allowed is {depth:g} m, to work it through, to below "
            f"{stroke:.6g} m, its stroke"
        )


def laws_of(process: Process, contact: float, lift: float) -> dict[str, OverPosition]:
    """Laws of a process and its cushion, of forces away from the work, by their names.

    What breaks or flows is loaded along its curve, and unloaded and loaded again along a straight
    line as steep as the curve's steepest rise, up to the deepest place of the stroke.  Once it is
    worked through nothing acts until the stroke is over.

    Parameters
    ----------
    contact : float
        Place at which the work is touched, along the direction away from it, m.
    lift : float
        Height over the contact at which a stroke is over and a new blank lies there, m.
    """

    def table(curve: tuple[tuple[float, float], ...]) -> list[tuple[float, float]]:
        return sorted((0.0 - depth, force) for depth, force in curve)

    if isinstance(process, Coining):
        stop = ((0.0, 0.0), (DEEP, process.stiffness * DEEP))
        return {process.kind: OverPosition(table(stop), outside="hold", zero=contact)}
    steepest = max((b[1] - a[1]) / (b[0] - a[0]) for a, b in pairwise(process.curve))
    stroke = table(((-lift, 0.0), *process.curve))
    law = OverPosition(stroke, "against", zero=contact, release=True, unloading=steepest)
    laws = {process.kind: law}
    if process.cushion > 0.0:
        held = ((0.0, 0.0), (process.curve[1][0], process.cushion))
        laws["cushion"] = OverPosition(table(held), outside="hold", zero=contact)
    return laws
