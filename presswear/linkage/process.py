"""Processes of a press: the force of the work over its depth.

The work lies towards an extreme of the output coordinate in the ideal motion, its bottom
dead centre: for the slider of a press the lowest place. If the extreme is the highest
place, a scene observes the opposite direction, so that up is away from the work in every
scene. Height is counted from bottom dead centre, depth from where the work is touched.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, ClassVar, Literal

from presswear.linkage.load_laws import OverPosition
from presswear.tools.errors import InputError
from presswear.tools.fields import choice, quantity
from presswear.tools.quantities import written
from presswear.tools.serialize import Checked

Extreme = Literal["lowest", "highest"]
MAX_FORCE = 1e9  # N; no press is stronger
MAX_DEPTH = 10.0  # largest height or depth, m; no link of a machine is longer
MIN_DEPTH = 1e-6  # smallest height or depth, m
_CURVE_PIECES = 4  # straight pieces of half a cosine
Curve = tuple[tuple[float, float], ...]


def _force(text: str, default: float, low: float = 1e-3) -> Any:
    return quantity(default, "N", low, MAX_FORCE, "chosen", text)


def _depth(default: float, text: str) -> Any:
    return quantity(default, "m", MIN_DEPTH, MAX_DEPTH, "chosen", text)


def _offset() -> Any:
    return quantity(0.0, "m", -MAX_DEPTH, MAX_DEPTH, "chosen", _OFFSET)


# Texts of settings that several processes have
_HEIGHT = "height above the ideal bottom dead centre at which the work is touched"
_CUSHION = "additional constant force, in both directions of motion"
_BOTTOM = "output coordinate at bottom dead centre, where the work is"
_OFFSET = (
    "distance of the force from the output point, to the right with the work below; its "
    "guide needs clearance"
)


class _Work(Checked):
    """Force of the work over the depth, and the energy of a stroke.

    The work is elastic-plastic: where the motion turns back, the force falls with the
    steepest slope of the curve; see ``laws_of``. A cushion is elastic.
    """

    @property
    def curve(self) -> Curve:
        """Points of increasing depth, m, and force, N, without that of the cushion.

        The force is linear between the points.
        """
        return ((0.0, 0.0),)

    @property
    def fracture(self) -> float | None:
        """Depth at which the work breaks, m."""
        return None

    @property
    def work(self) -> float:
        """Energy that a stroke takes, J: the area below the curve."""
        area = 0.0
        for (depth, force), (next_depth, next_force) in pairwise(self.curve):
            area += 0.5 * (next_depth - depth) * (force + next_force)
        return area


@dataclass(frozen=True)
class Blanking(_Work):
    """Blanking: the force rises, stays constant, and falls to zero after the fracture."""

    kind: ClassVar[str] = "blanking"

    force: float = _force("force of the plateau", 500.0)
    height: float = _depth(5e-3, _HEIGHT)
    thickness: float = _depth(1e-3, "thickness of the sheet")
    stiffness: float | None = quantity(
        None,
        unit="N/m",
        low=1.0,
        high=1e12,
        origin="chosen",
        text="of the elastic rise; default: force over rise",
    )
    rise: float = _depth(
        1e-4, "depth over which the force rises; contains the stretch of a rigid frame"
    )
    plateau: float = quantity(
        0.4,
        unit="",
        low=0.0,
        high=1.0,
        origin="chosen",
        text="depth of the plateau over the thickness; the sheet breaks at its end",
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
            low = self.force / MAX_DEPTH
            high = self.force / MIN_DEPTH
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
        fractions = [k / _CURVE_PIECES for k in range(_CURVE_PIECES + 1)]
        rising = [fraction * peak for fraction in fractions]
        falling = [peak + fraction * (self.depth - peak) for fraction in fractions[1:]]
        sizes = [
            0.5 * self.force * (1.0 - math.cos(math.pi * fraction))
            for fraction in fractions
        ]
        depths = (*rising, *falling)
        forces = (*sizes, *reversed(sizes[:-1]))
        return tuple(zip(depths, forces, strict=True))


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
    process.kind: process for process in (Blanking, Drawing, Coining)
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
    """Return the load laws of a process and of its cushion by name.

    The forces are positive away from the work. Work that breaks or flows is loaded along
    its curve. It is unloaded, and loaded again up to the greatest depth of the stroke,
    along a straight line with the steepest slope of the curve. At the end of the curve
    the force vanishes until the stroke is over.

    Parameters
    ----------
    process : Process
        Process of a press.
    contact : float
        Position of the output point at which the work is touched, positive away from the
        work, m.
    lift : float
        Height above ``contact`` at which the stroke is over and a new blank lies in
        place, m.
    """

    def table(curve: Curve) -> list[tuple[float, float]]:
        """Return points of the curve by height above the contact, which is minus the depth."""
        return sorted((0.0 - depth, force) for depth, force in curve)  # no -0.0

    if isinstance(process, Coining):
        stop = ((0.0, 0.0), (MAX_DEPTH, process.stiffness * MAX_DEPTH))
        return {process.kind: OverPosition(table(stop), outside="hold", zero=contact)}
    slopes = []  # N/m
    for (depth, force), (next_depth, next_force) in pairwise(process.curve):
        slopes.append((next_force - force) / (next_depth - depth))
    law = OverPosition(
        table(((-lift, 0.0), *process.curve)),
        "against",
        zero=contact,
        release=True,
        unloading=max(slopes),
    )
    laws = {process.kind: law}
    if process.cushion > 0.0:
        constant = ((0.0, 0.0), (process.curve[1][0], process.cushion))
        laws["cushion"] = OverPosition(table(constant), outside="hold", zero=contact)
    return laws
