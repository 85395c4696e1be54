"""Largest Lyapunov exponent from pairs of trajectories that are rescaled periodically.

Benettin, Galgani and Strelcyn, Phys. Rev. A 14 (1976) 2338; Wolf, Swift, Swinney and
Vastano, Physica D 16 (1985) 285. Only the map of a state over a time interval is
needed, so that impacts need no derivatives.
"""

import math
from collections.abc import Callable, Mapping
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from presswear.engines.base import Plan, Start, recorder_of
from presswear.engines.dae.engine import prepare
from presswear.engines.settings import InHouse
from presswear.linkage.linkage import Linkage
from presswear.physics.equations.writer import Equations, write_equations
from presswear.physics.friction_and_normal import (
    ONSET_SPEED_FLOOR,
    elastic_of,
    normal_force,
)
from presswear.recording.statistics import Estimate, half_width_of_runs
from presswear.tools.arrays import Array
from presswear.tools.errors import InputError, RunFailed

Context = TypeVar("Context")
Arrays = Mapping[str, NDArray[Any]]

# Share of the intervals that is discarded at the start, while the distance of a pair
# rotates into the direction of fastest growth
DISCARDED = 0.1
# With a tolerance of 1e-11 the exponent differs by 1e-3 from that with 1e-13; with 1e-10
# it differs by 0.1.
ENGINE = InHouse("dop853", 1e-11)
DISTANCE = 1e-5  # initial distance of a pair over the smallest clearance
# Rate at which contacts change a motion, over the angular velocity of the crank. It
# converts the distance of positions to a distance of velocities.
SPEED_RATIO = 30.0
INTERVALS = 20  # rescalings in a cycle: a pair stays close enough for linear growth


def growth_logarithms(
    step: Callable[[Array, Context], tuple[Array, Context]],
    state: Array,
    context: Context,
    intervals: int,
    distance: Array,
) -> Array:
    """Return the logarithm of the growth of a small distance in each interval, shape (intervals,).

    After each interval the neighbour is moved back along its direction to the initial
    distance.

    Parameters
    ----------
    step : callable
        Returns the state and its context after one interval; must not change its
        arguments.
    state : ndarray, shape (d,)
        A component is NaN while the motion does not depend on it. Components that are
        NaN in either trajectory do not contribute to the distance.
    context
        Quantities that belong to a state but are not perturbed, such as time and active
        contacts. The neighbour takes those of the reference after each interval.
    distance : ndarray, shape (d,)
        Initial distance in each component, in its unit; also the scale of distances.

    Raises
    ------
    InputError
        If a pair coincides or its distance is not finite after an interval.
    """

    def scaled(neighbour: Array) -> Array:
        difference = (neighbour - state) / distance
        return np.nan_to_num(difference, nan=0.0, posinf=math.inf, neginf=-math.inf)

    direction = np.full(state.size, 1.0 / math.sqrt(state.size))
    logarithms = np.empty(intervals)
    for k in range(intervals):
        neighbour = state + distance * direction
        before = float(np.linalg.norm(scaled(neighbour)))  # differs from 1 by round-off
        moved, _ = step(neighbour, context)
        state, context = step(state, context)
        direction = scaled(moved)
        after = float(np.linalg.norm(direction))
        if not 0.0 < after < math.inf:
            fault = f"the distance of the pair is {after:g} times the initial distance"
            remedy = "use a larger initial distance or a shorter interval"
            raise InputError(f"interval {k}: {fault}; {remedy}")
        logarithms[k] = math.log(after / before)
        direction /= after
    return logarithms


def exponent_from_growth(
    logarithms: Array, duration: float, per_cycle: int = 1
) -> Estimate:
    """Return the exponent from ``growth_logarithms``, with a confidence interval.

    An interval lasts ``duration``, s, and a cycle has ``per_cycle`` intervals. The
    confidence interval uses means over whole cycles, because growth varies within a
    cycle. The number of samples is the number of averaged intervals.
    """
    rates = logarithms[math.ceil(DISCARDED * len(logarithms)) :] / duration
    if not rates.size:
        return Estimate(math.nan)
    per_cycle = min(per_cycle, rates.size)
    rates = rates[rates.size % per_cycle :]
    half = half_width_of_runs([rates.reshape(-1, per_cycle).mean(axis=1)])
    return Estimate.symmetric(float(rates.mean()), half, rates.size)


class Flow:
    """Motion of a linkage as a map of its state over an interval, ``period / per_cycle``.

    The components of a state are coordinates, rates, states of interactions, and the
    closing speed at touchdown of each joint. The closing speed is NaN while the force
    does not depend on it: in an open joint, under a law without damping, and below
    ``ONSET_SPEED_FLOOR``. ``distance`` is the initial distance of a pair in each
    component.

    Raises
    ------
    InputError
        If the linkage has closed loops, whose coordinates cannot be perturbed
        independently.
    """

    def __init__(
        self, linkage: Linkage, start: Start, period: float, per_cycle: int
    ) -> None:
        plan = Plan(period, 1, 1, torques=False)
        recorder = recorder_of(linkage, start, plan)
        recorder.stop_recording()
        self.records = recorder.records
        equations = write_equations(linkage, self.records.packed)
        if isinstance(equations, str):  # the reason why there are none
            raise InputError(
                f"an exponent needs a linkage without free loops, but {equations}"
            )
        self.simulation = prepare(linkage, start, ENGINE, plan, recorder)
        self.interval = period / per_cycle
        self.distance = _initial_distance(linkage, equations, period)
        # Coordinates, rates and states come first in the integrated vector.
        self.indices = np.arange(equations.layout.first_energy)
        self.keeps_onset = np.array(
            [_depends_on_onset(joint) for joint in self.records.packed.joints]
        )
        self._arrays = self._context_arrays()

    def _context_arrays(self) -> Arrays:
        """Return the arrays that determine how the motion continues from a state."""
        records = self.records
        arrays = dict(self.simulation.arrays)
        arrays["contacts"] = records.contacts
        arrays["onset"] = records.onset
        arrays["memory"] = records.memory
        arrays["modes"] = records.packed.loads.modes
        return arrays

    def state(self) -> tuple[Array, Arrays]:
        """Return copies of the present state and its context."""
        is_active = self.keeps_onset & (self.records.onset > ONSET_SPEED_FLOOR)
        onset = np.where(is_active, self.records.onset, math.nan)
        context = {name: array.copy() for name, array in self._arrays.items()}
        integrated = self.simulation.arrays["y"][self.indices]
        return np.concatenate([integrated, onset]), context

    def step(self, state: Array, context: Arrays) -> tuple[Array, Arrays]:
        """Return the state one interval later; raises RunFailed if the motion ends."""
        for name, array in self._arrays.items():
            array[...] = context[name]
        control = self.simulation.arrays["control"]
        self.simulation.arrays["y"][self.indices] = state[: self.indices.size]
        onset = state[self.indices.size :]
        is_active = ~np.isnan(onset)
        self.records.onset[is_active] = np.maximum(onset[is_active], ONSET_SPEED_FLOOR)
        control["has_slope"] = False
        finding = self.simulation.advance(float(control["time"][0]) + self.interval)
        if finding is not None:
            raise RunFailed(finding.words)
        return self.state()


def _initial_distance(linkage: Linkage, equations: Equations, period: float) -> Array:
    """Return the initial distance of a pair in each component, in the unit of the component."""
    length = DISTANCE * min(joint.clearance for joint in linkage.clearances)
    speed = length * SPEED_RATIO * 2.0 * math.pi / period
    coordinates = np.repeat([length, speed], equations.layout.coordinates)
    scales = np.array([state.scale for state in equations.states])
    onsets = np.full(len(linkage.clearances), speed)
    return np.concatenate([coordinates, DISTANCE * scales, onsets])


def _depends_on_onset(joint: Any) -> bool:
    """Return whether the normal force of a joint depends on its closing speed at touchdown."""
    if joint["always_closed"]:
        return False
    law = joint["normal"]
    depth = 1e-3 * law["clearance"]
    elastic, _ = elastic_of(law, depth)
    rate = 1.0  # m/s
    # The last argument is the closing speed at touchdown, m/s.
    slow = normal_force(law, elastic, depth, rate, 1.0)
    fast = normal_force(law, elastic, depth, rate, 2.0)
    return bool(slow != fast)


def largest_exponent(
    linkage: Linkage, start: Start, period: float, cycles: int
) -> Estimate:
    """Return the largest Lyapunov exponent of a linkage, 1/s, computed by the in-house engine.

    A cycle lasts ``period``, s. RunFailed if the motion ends early.
    """
    if not linkage.clearances:
        raise InputError("an exponent needs a joint with clearance: no motion is free")
    flow = Flow(linkage, start, period, INTERVALS)
    logarithms = growth_logarithms(
        flow.step, *flow.state(), cycles * INTERVALS, flow.distance
    )
    return exponent_from_growth(logarithms, flow.interval, INTERVALS)
