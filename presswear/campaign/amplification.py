"""Amplification: the depth of the cycles run becomes that of the cycles a wear stands for.

In one jump, as the paper does, or in steps that each change no profile by more than
a stated part of its clearance; after each the surfaces are rebuilt and the linkage
runs again.  Too large an extrapolation makes a profile unstable (Mukras, Kim, Sawyer,
Jackson and Bergquist, Wear 266, 2009, 822): a pit digs itself deeper for longer than
the pin would stay in it.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from presswear.linkage.elements import ClearanceJoint
from presswear.linkage.surface import Surface
from presswear.results.stage import WearStep
from presswear.scene.scene import Scene

Array = NDArray[np.float64]

Worn = Mapping[str, tuple[Surface, Surface]]
"""Bearing and pin surface by joint name."""

ROUND_OFF = 1e-9
"""Excess over the limit, part of it, that does not ask for one more step."""


@dataclass(frozen=True)
class Amplification:
    """How far one run is extrapolated.

    Attributes
    ----------
    represented_cycles : float
        Cycles that one wear stands for.
    limit : float
        Largest change of a profile in one step, part of its clearance; infinite: one jump.
    """

    represented_cycles: float
    limit: float = math.inf

    @staticmethod
    def of(scene: Scene) -> "Amplification":
        """How the depth of the cycles run becomes one wear of a scene."""
        limit = scene.depth_step if scene.wears_in_steps else math.inf
        return Amplification(scene.represented_cycles, limit)

    def factor(self, cycles: int) -> float:
        """Multiplier of the depth of ``cycles`` cycles that makes it a whole wear."""
        return self.represented_cycles / cycles

    def steps(self, rate: float, remaining: float) -> int:
        """Steps that the remaining cycles take at a rate of change.

        Parameters
        ----------
        rate : float
            Fastest change of a profile, part of its clearance in one cycle.
        remaining : float
            Represented cycles that are left.
        """
        return max(math.ceil(rate * remaining / self.limit * (1.0 - ROUND_OFF)), 1)

    def share(self, rate: float, remaining: float) -> float:
        """Represented cycles of the next step.

        The remaining cycles in equal shares: a last step of what the limit happens to
        leave over would cost a whole run for next to nothing.
        """
        return remaining / self.steps(rate, remaining)


@dataclass(frozen=True)
class Sample:
    """The outcome of one run as far as it tells about wear.

    Attributes
    ----------
    joints : tuple of ClearanceJoint
        What ran, worn surfaces included.
    cycles : int
        Cycles run, at least 1.
    depth : ndarray, shape (joints, 2, m)
        Mean depth that one of them adds to bearing and pin, m.
    force : dict
        Peak normal force by joint, N.
    wall : float
        s.
    """

    joints: tuple[ClearanceJoint, ...]
    cycles: int
    depth: Array
    force: Mapping[str, float]
    wall: float

    @property
    def rate(self) -> float:
        """Fastest change of a profile, part of its clearance in one cycle."""
        return fastest_change(self.joints, self.depth)


def fastest_change(joints: tuple[ClearanceJoint, ...], depth: Array) -> float:
    """Largest of some depths, m, each as a part of its joint's clearance.

    Parameters
    ----------
    depth : ndarray, shape (joints, 2, m)
    """
    return max(
        (float(own.max()) / joint.clearance for joint, own in zip(joints, depth, strict=True)),
        default=0.0,
    )


@dataclass(frozen=True)
class Growth:
    """One wear as far as it has been applied.

    Attributes
    ----------
    worn : mapping
        The surfaces now; empty before the first step of the first wear.
    added : ndarray, shape (joints, 2, m) or empty
        Sum of the steps, m.
    steps : tuple of WearStep
    remaining : float
        Represented cycles that are left.
    """

    worn: Worn
    added: Array
    steps: tuple[WearStep, ...]
    remaining: float

    @staticmethod
    def begin(amplification: Amplification, worn: Worn) -> "Growth":
        """A wear of which nothing has been applied yet."""
        return Growth(worn, np.zeros(0), (), amplification.represented_cycles)

    def after(self, amplification: Amplification, sample: Sample) -> "Growth":
        """One step more, from a run on the present surfaces."""
        share = amplification.share(sample.rate, self.remaining)
        added = sample.depth * share
        worn = {
            joint.name: (
                joint.bearing_surface.worn_by(added[k, 0]),
                joint.pin_surface.worn_by(added[k, 1]),
            )
            for k, joint in enumerate(sample.joints)
        }
        step = WearStep(
            share,
            sample.cycles,
            share / sample.cycles,
            fastest_change(sample.joints, added),
            {
                name: {
                    "bearing": float(bearing.depth.max(initial=0.0)),
                    "pin": float(pin.depth.max(initial=0.0)),
                }
                for name, (bearing, pin) in worn.items()
            },
            sample.force,
            sample.wall,
        )
        return replace(
            self,
            worn=worn,
            added=self.added + added if self.steps else added,
            steps=(*self.steps, step),
            # The last share is all that remained: no round-off is left to run for.
            remaining=self.remaining - share,
        )

    @property
    def is_complete(self) -> bool:
        """True when the represented cycles are used up."""
        return self.remaining <= 0.0


def worn_out(joints: tuple[ClearanceJoint, ...], worn: Worn) -> tuple[str, str] | None:
    """Which joint has lost too much, and how much; None if none.

    A bearing or pin that is worn deeper than the clearance is no pin in a round bearing any
    more: a small clearance is what the whole model rests on.
    """
    for joint in joints:
        for name, surface in zip(("bearing", "pin"), worn[joint.name], strict=True):
            deepest = float(surface.depth.max(initial=0.0))
            if deepest > joint.clearance:
                return joint.name, (
                    f"the {name} would lose {deepest:.3g} m, more than the clearance of "
                    f"{joint.clearance:.3g} m"
                )
    return None
