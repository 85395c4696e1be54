"""Smallest kick of a pin after which a settled motion rattles again.

A kick is a sudden change of the velocity of one pin relative to its bearing at the end
of a cycle. Attractors.jl calls the smallest kick that leads to another final motion the
minimal fatal shock (Halekotte and Feudel, Scientific Reports 10 (2020) 11783). It calls
the smallest kick after which a motion returns only by a long transient the excitability
threshold.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import product

import numpy as np

from presswear.analysis.bifurcation import ENGINE, continued
from presswear.analysis.pins import kick_pins
from presswear.engines.base import Plan, Start
from presswear.linkage.linkage import Linkage
from presswear.linkage.points import GROUND
from presswear.recording.settling import CHANGE, REPEATED, signatures_of
from presswear.recording.statistics import STARTUP_CYCLES
from presswear.tools.arrays import Array

# Directions of kicks, degrees from the x axis of the body with the bearing
DIRECTIONS = (0, 45, 90, 135, 180, 225, 270, 315)
STATES = 8  # number of states of a settled motion from which kicks are tried
WATCHED = 2 * REPEATED  # cycles of the run after a kick
# Factors by which the speed of kicks is reduced, one after the other
FACTORS = (2.0, 2.0**0.5, 2.0**0.25, 2.0**0.125)
WEAKEST = 1e-4  # smallest speed that is tried, over the largest


@dataclass(frozen=True)
class Kick:
    """Smallest kick of a pin that leads to rattling; speeds in m/s."""

    joint: str
    # smallest speed after which the motion rattles; None: it returns after all kicks
    rattles: float | None
    returns: float  # speed after which it returns from all states, in all directions
    direction: int = 0  # direction of the kick that leads to rattling, degrees
    state: int = 0  # number of the state of the settled motion before this kick


def least_kicks(
    linkage: Linkage,
    states: Sequence[Start],
    orbit: Array,
    speeds: Array,
    report: Callable[[float], object] = lambda share: None,
) -> list[Kick]:
    """Return the smallest kick of each pin; empty if the motion is not stable without kicks.

    Parameters
    ----------
    states : sequence of Start
        States of the settled motion after whole cycles, see ``states_of``.
    orbit : ndarray, shape (n, 3 joints)
        Signatures of the cycles of the settled motion.
    speeds : ndarray, shape (joints,)
        Largest speed of a kick of each pin, m/s.
    report : callable
        Called with the completed part of the work, from 0 to 1, before each run.
    """
    if any(leaves(linkage, state, orbit) for state in states):
        return []
    cases = list(product(range(len(states)), DIRECTIONS))

    def rattles(joint: int, case: int, speed: float) -> bool:
        report(joint / len(linkage.clearances))
        number, degrees = cases[case]
        state = states[number]
        angle = body_angle(linkage, state, joint) + math.radians(degrees)
        change = np.zeros((len(linkage.clearances), 2))
        change[joint] = speed * np.array([math.cos(angle), math.sin(angle)])
        return leaves(linkage, kick_pins(linkage, state, change), orbit)

    kicks = []
    for k, joint in enumerate(linkage.clearances):
        returns, limit, case = least_speed(
            partial(rattles, k), len(cases), float(speeds[k])
        )
        number, degrees = cases[case]
        kicks.append(Kick(joint.name, limit, returns, degrees, number))
    return kicks


def least_speed(
    rattles: Callable[[int, float], bool], cases: int, largest: float
) -> tuple[float, float | None, int]:
    """Return the limits of the smallest speed after which a case rattles.

    The results are a speed after which all cases return, a higher speed after which one
    case rattles, and the number of this case. The higher speed is None if all cases
    return after ``largest``. As in Attractors.jl, the speed is reduced by each of
    ``FACTORS`` in turn until all cases return. The boundary of a basin can be fractal,
    so that a smaller speed may also lead to rattling: the higher speed is an upper
    limit.
    """

    def rattling_case(speed: float, likely: int) -> int | None:
        """Return the first case that rattles; ``likely`` is tried first."""
        order = sorted(range(cases), key=lambda case: case != likely)
        return next((case for case in order if rattles(case, speed)), None)

    case = rattling_case(largest, likely=0)
    if case is None:
        return largest, None, 0
    limit = largest
    smallest = WEAKEST * largest
    for factor in FACTORS:
        while limit > smallest:
            next_case = rattling_case(limit / factor, likely=case)
            if next_case is None:
                break
            limit = limit / factor
            case = next_case
    returns = limit / FACTORS[-1] if limit > smallest else 0.0
    return returns, limit, case


def states_of(linkage: Linkage, ends: Sequence[Start], ideal: Start) -> list[Start]:
    """Return states of a settled motion after whole cycles.

    They are the ends of runs. If there are too few, the last run is continued cycle by
    cycle. Several states are needed, because a motion that repeats may drift slowly,
    and only some of its states may be sensitive to kicks.
    """
    states = [continued(linkage, linkage, end, ideal) for end in ends[:STATES]]
    one_cycle = Plan(linkage.period, 1, 1, torques=False)
    while len(states) < STATES:
        run = ENGINE.simulate(linkage, states[-1], one_cycle)
        states.append(continued(linkage, linkage, run.end, ideal))
    return states


def body_angle(linkage: Linkage, start: Start, k: int) -> float:
    """Return the angle of the body that carries the bearing of a joint, rad; 0 for the frame."""
    body = linkage.clearances[k].bearing.body
    return 0.0 if body == GROUND else float(start.position[3 * linkage.index(body) + 2])


def leaves(linkage: Linkage, start: Start, orbit: Array) -> bool:
    """Return whether a motion leaves an orbit or fails; the start-up cycles do not count."""
    plan = Plan(linkage.period, WATCHED, 1, torques=False)
    run = ENGINE.simulate(linkage, start, plan)
    if run.status == "failed":
        return True
    cycles = signatures_of(linkage.clearances, run.recorder.cycles)[STARTUP_CYCLES:]
    distance = np.abs(cycles[:, np.newaxis] - orbit).max(axis=2)
    return bool((distance.min(axis=1) > CHANGE).any())
