"""The in-house motion of a linkage as a map of its state over a time, and its exponent."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswear.campaign.replicates import start_of
from presswear.dynamics.lyapunov import Exponent, exponent_of, growths
from presswear.engines.base import Plan, Start, recorder_of
from presswear.engines.dae.dynamics import bristle_place
from presswear.engines.dae.engine import prepare
from presswear.engines.driver import Simulation
from presswear.engines.settings import InHouse
from presswear.linkage.linkage import Linkage
from presswear.physics.laws import ONSET_SPEED_FLOOR, elastic_of, normal_force
from presswear.physics.tree import Tree, tree_of
from presswear.recording.observe import Book
from presswear.scene.scene import Scene
from presswear.tools.errors import InputError, RunFailed

Array = NDArray[np.float64]
Carried = Mapping[str, NDArray[Any]]
"""What belongs to a state beside its numbers: time, step, contacts that have begun."""

ENGINE = InHouse("dop853", 1e-11)
"""Logarithms of the growths of a slider-crank differ by 1e-3 at most from those at 1e-13; at 1e-10
by a tenth."""
APART = 1e-5
"""Distance of twins at a restart, part of the smallest clearance."""
FASTER = 30.0
"""Rates at which contacts change a motion, in those of the crank: the scale of velocities."""
RESTARTS = 20
"""Restarts in a cycle."""


@dataclass(frozen=True)
class Flow:
    """Motion of a linkage as a map of its state over a part of its cycle.

    The numbers of a state are coordinates, rates, deflections of bristles, and the closing speed
    at touchdown of each contact whose force depends on it.  That speed is NaN while the joint is
    open, and where it is so low that the force takes ``ONSET_SPEED_FLOOR`` in its place.

    Attributes
    ----------
    running : Simulation
        Integrator of all states.
    book : Book
        Of its recorder.
    places : ndarray, shape (n,)
        Indices of coordinates, rates and bristles in the vector that is integrated.
    latching : ndarray of bool, shape (joints,)
        True for a joint whose force depends on the closing speed at touchdown.
    apart : ndarray, shape (n + joints,)
        Distance of twins at a restart in each number of a state.
    interval : float
        Duration of a step, s.
    """

    running: Simulation
    book: Book
    places: NDArray[np.int64]
    latching: NDArray[np.bool_]
    apart: Array
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
        joints = recorder.book.packed.joints
        friction = joints["friction"]
        bristles = np.flatnonzero(friction["bristle_stiffness"] > 0.0)
        deflections = [bristle_place(2 * tree.size, int(k)) for k in bristles]
        slip = friction["static"][bristles] / friction["bristle_stiffness"][bristles]
        length = APART * min(joint.clearance for joint in linkage.clearances)
        speed = length * FASTER * 2.0 * math.pi / period
        return Flow(
            running,
            recorder.book,
            np.array([*range(2 * tree.size), *deflections]),
            np.array([_depends_on_onset(joint["normal"]) for joint in joints]),
            np.concatenate(
                [
                    np.repeat([length, speed], tree.size),
                    APART * slip,  # slip: deflection at which bristles slide
                    np.full(len(joints), speed),
                ]
            ),
            period / parts,
        )

    @property
    def _arrays(self) -> Carried:
        """Live arrays that the motion goes on from."""
        book, loads = self.book, self.book.packed.loads
        contact = {"contacts": book.contacts, "onset": book.onset, "memory": book.memory}
        modes = {} if loads is None else {"modes": loads.modes}
        return {**self.running.arrays, **contact, **modes}

    def state(self) -> tuple[Array, Carried]:
        """Numbers of the present state, and what belongs to them; copies."""
        latched = self.latching & (self.book.onset > ONSET_SPEED_FLOOR)
        onset = np.where(latched, self.book.onset, math.nan)
        carried = {name: array.copy() for name, array in self._arrays.items()}
        return np.concatenate([self.running.arrays["y"][self.places], onset]), carried

    def step(self, state: Array, carried: Carried) -> tuple[Array, Carried]:
        """The state an interval later; RunFailed where the motion ends."""
        for name, array in self._arrays.items():
            array[...] = carried[name]
        control = self.running.arrays["control"]
        self.running.arrays["y"][self.places] = state[: self.places.size]
        onset = state[self.places.size :]
        latched = ~np.isnan(onset)
        self.book.onset[latched] = np.maximum(onset[latched], ONSET_SPEED_FLOOR)
        control["known"] = False
        finding = self.running.advance(float(control["time"][0]) + self.interval)
        if finding is not None:
            raise RunFailed(finding.words)
        return self.state()


def _depends_on_onset(law: Any) -> bool:
    """Return whether a normal force depends on the closing speed at touchdown."""
    depth = 1e-3 * law["clearance"]
    elastic, _ = elastic_of(law, depth)
    slow, fast = (normal_force(law, elastic, depth, 1.0, onset) for onset in (1.0, 2.0))
    return bool(slow != fast)


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
    found = growths(flow.step, *flow.state(), cycles * parts, flow.apart)
    return exponent_of(found, flow.interval, parts)


def scene_exponent(scene: Scene, cycles: int) -> Exponent:
    """The exponent of the first stage of a scene, from its first start, 1/s; see ``exponent``."""
    return exponent(scene.linkage(), start_of(scene), scene.mechanism.period, cycles)
