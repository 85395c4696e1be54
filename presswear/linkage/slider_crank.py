"""A slider-crank, as the literature on joints with clearance studies it.

The crank turns about O, the origin; the rod joins it in A and the slider in B.  The
slider moves on the x axis, to the right of O.  The values are from memory of the
literature (Flores) and were not checked against a page.
"""

import math
from dataclasses import dataclass
from functools import lru_cache, partial

from presswear.linkage.elements import Body, Guide, Revolute, bar_ends
from presswear.linkage.linkage import Linkage, gravity, run_up
from presswear.linkage.mechanism import (
    LONG,
    Mechanism,
    inertia,
    length,
    mass,
)
from presswear.linkage.motions import Drive, torque_limit
from presswear.linkage.points import GROUND, Attachment, Probe
from presswear.tools.errors import InputError
from presswear.tools.quantities import quantity

LITERATURE = "literature, from memory"

_LEAST_RATIO = 1.0001
"""Shortest rod over the crank: a rod that stands upright leaves the slider's side open."""

_length, _mass, _inertia = (partial(make, LITERATURE) for make in (length, mass, inertia))


@dataclass(frozen=True)
class SliderCrank(Mechanism):
    """A slider-crank: everything but its clearance joints.

    Mass centres are at mid-length and the rod carries the bearings (both assumed).
    """

    kind = "slider-crank"
    openable = ("A", "B")
    loose = ("B",)

    crank_length: float = _length(0.05, "crank, O to A")
    rod_length: float = _length(0.12, "rod, A to B; longer than the crank")
    crank_mass: float = _mass(0.30, "mass of the crank")
    rod_mass: float = _mass(0.21, "mass of the rod")
    slider_mass: float = _mass(0.14, "mass of the slider")
    crank_inertia: float = _inertia(1e-4, "inertia of the crank (torque only)")
    rod_inertia: float = _inertia(2.5e-4, "inertia of the rod")
    gravity: float = gravity()
    speed: float = quantity(
        5000.0 * math.pi / 30.0, "rad/s", 1.0, 5000.0, LITERATURE, "crank speed, 5000 rpm"
    )
    run_up: int = run_up()
    torque_limit: float | None = torque_limit()

    def __post_init__(self) -> None:
        """InputError where a quantity is out of range, or the crank cannot turn all around."""
        super().__post_init__()
        least = _LEAST_RATIO * self.crank_length
        if not self.rod_length >= least:
            raise InputError(
                f"rod_length = {self.rod_length:g} m: with crank_length = {self.crank_length:g} m "
                f"allowed is {least:.6g} m to {LONG:g} m; joint B does not close over the whole "
                "turn"
            )

    @property
    def origin(self) -> str:
        """Where its values come from, in a sentence."""
        return (
            "Dimensions, masses and speed are those of a slider-crank that the literature on "
            "joints with clearance has studied (Flores), from memory and not checked against a "
            "page."
        )

    def linkage(self) -> Linkage:
        """The ideal linkage, every joint closed.

        The crank points from O to A, the rod from A to B: both are at angle 0 at the start.
        """
        return _linkage(self)


@lru_cache(maxsize=64)
def _linkage(crank: SliderCrank) -> Linkage:
    """The linkage, made once: a scene asks for it several times."""
    crank_tail, crank_head = bar_ends("crank", crank.crank_length)
    rod_tail, rod_head = bar_ends("rod", crank.rod_length)
    return Linkage(
        name="slider-crank",
        bodies=(
            Body("crank", crank.crank_mass, crank.crank_inertia),
            Body("rod", crank.rod_mass, crank.rod_inertia),
            # The slider does not turn: its inertia never enters.
            Body("slider", crank.slider_mass, 1.0),
        ),
        joints=(
            Revolute("O", Attachment(GROUND, 0.0, 0.0), crank_tail),
            Revolute("A", rod_tail, crank_head),
            Revolute("B", rod_head, Attachment("slider", 0.0, 0.0)),
            Guide("guide", "slider"),
        ),
        drives=(Drive("crank", crank.speed, torque_limit=crank.torque_limit),),
        watch=Probe("slider", 0.0),
        guess={"rod": 0.0},
        gravity=crank.gravity,
        run_up=crank.run_up,
    )
