"""The in-house motion of a linkage as a map of its state over a time, and its exponent."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswear.campaign.starts import start_of
from presswear.dynamics.lyapunov import Exponent, exponent_of, growths
from presswear.engines.base import Plan, Start, recorder_of
from presswear.engines.dae.engine import prepare
from presswear.engines.driver import Simulation
from presswear.engines.settings import InHouse
from presswear.linkage.linkage import Linkage
from presswear.physics.tree import Tree, tree_of
from presswear.record.observe import Book
from presswear.scene.scene import Scene
from presswear.tools.errors import InputError, RunFailed

Array = NDArray[np.float64]
Carried = Mapping[str, NDArray[Any]]
"""What belongs to a state beside coordinates and rates: time, step, contacts that have begun."""

ENGINE = InHouse("dop853", 1e-11)
"""Logarithms of the growths of a slider-crank differ by 1e-3 at most from those at 1e-13; at 1e-10
by a tenth."""
APART = 1e-5
"""Distance of twins at a restart, part of the smallest clearance."""
FASTER = 30.0
"""Rates at which contacts change a motion, in those of the crank: the scale of velocities."""
RESTARTS = 20
"""Restarts in a cycle: of a contact that goes on in one, the twin's own closing speed is lost."""

_CONTACT = ("contacts", "onset", "memory")
"""Arrays of a book that a motion goes on from."""


@dataclass(frozen=True)
class Flow:
    """The motion of a linkage as a map over a part of its cycle.

    Attributes
    ----------
    running : Simulation
        What integrates; one for all states.
    book : Book
        Of its recorder.
    coordinates : int
    interval : float
        Time of a step, s.
    """

    running: Simulation
    book: Book
    coordinates: int
    interval: float

    @staticmethod
    def of(linkage: Linkage, start: Start, period: float, parts: int) -> "Flow":
        """The flow of a linkage over a part of its cycle; InputError where there is no open tree.

        With loops that stay closed, coordinates cannot be moved one by one.
        """
        tree = tree_of(linkage)
        if not isinstance(tree, Tree):
            raise InputError(f"an exponent needs a linkage without free loops, but {tree}")
        plan = Plan(period, 1, 1, torques=False)
        recorder = recorder_of(linkage, start, plan)
        recorder.stop_recording()
        running = prepare(linkage, start, ENGINE, plan, recorder)
        return Flow(running, recorder.book, tree.size, period / parts)

    def state(self) -> tuple[Array, Carried]:
        """Coordinates and rates as they are now, and what belongs to them; copies."""
        carried = {name: own.copy() for name, own in self.running.arrays.items()}
        carried |= {name: getattr(self.book, name).copy() for name in _CONTACT}
        return self.running.arrays["y"][: 2 * self.coordinates].copy(), carried

    def step(self, state: Array, carried: Carried) -> tuple[Array, Carried]:
        """The state an interval later; RunFailed where the motion ends."""
        for name, own in self.running.arrays.items():
            own[...] = carried[name]
        for name in _CONTACT:
            getattr(self.book, name)[...] = carried[name]
        control = self.running.arrays["control"]
        self.running.arrays["y"][: 2 * self.coordinates] = state
        control["known"] = False
        finding = self.running.advance(float(control["time"][0]) + self.interval)
        if finding is not None:
            raise RunFailed(finding.words)
        return self.state()


def exponent(
    linkage: Linkage, start: Start, period: float, cycles: int, parts: int = RESTARTS
) -> Exponent:
    """Largest Lyapunov exponent of a linkage, 1/s, after some cycles from a start.

    Twins are moved together again some times a cycle, before walls can hold them together.

    Parameters
    ----------
    period : float
        s.
    cycles : int
    parts : int
        Restarts in a cycle.

    Raises
    ------
    InputError
        For a linkage with a loop that stays closed, or none with clearance.
    RunFailed
        Where the motion ends.
    """
    if not linkage.clearances:
        raise InputError("an exponent needs a joint with clearance: without one nothing is free")
    flow = Flow.of(linkage, start, period, parts)
    smallest = min(joint.clearance for joint in linkage.clearances)
    apart = np.full(2 * flow.coordinates, APART * smallest)
    apart[flow.coordinates :] *= FASTER * 2.0 * math.pi / period
    found = growths(flow.step, *flow.state(), cycles * parts, apart)
    return exponent_of(found, flow.interval)


def scene_exponent(scene: Scene, cycles: int) -> Exponent:
    """The exponent of the first stage of a scene, from its first start, 1/s; see ``exponent``."""
    return exponent(scene.linkage(), start_of(scene), scene.mechanism.period, cycles)
