"""Least kick of a pin after which a settled motion rattles again.

A kick is a sudden change of the velocity of one pin relative to its bearing at the end
of a cycle. Attractors.jl calls the least one that leads to another final motion the
minimal fatal shock (Halekotte and Feudel, Scientific Reports 10 (2020) 11783), and the
least one after which a motion returns to the same final motion only by a long way round
the excitability threshold.
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
from presswear.linkage.elements import GROUND
from presswear.linkage.linkage import Linkage
from presswear.recording.recorder import Recorder
from presswear.recording.settling import CHANGE, REPEATED, signatures
from presswear.recording.statistics import STARTUP_CYCLES
from presswear.tools.arrays import Array

# degrees from the x axis of the bearing's body
DIRECTIONS = (0, 45, 90, 135, 180, 225, 270, 315)
STATES = 8  # of a settled motion that are kicked
WATCHED = 2 * REPEATED  # cycles after a kick
# by which kicks are made weaker, in turn
FACTORS = (2.0, 2.0**0.5, 2.0**0.25, 2.0**0.125)
WEAKEST = 1e-4  # over the strongest kick


@dataclass(frozen=True)
class Kick:
    """Least kick of a pin, of those that were tried; speeds in m/s."""

    joint: str
    rattles: float | None  # the motion rattles after it; None: it returns after all
    returns: float  # the motion returns from every state after kicks in all directions
    direction: int = 0  # of the change of the pin's velocity that rattles, degrees
    state: int = 0  # of the settled motion that rattles


def recorded_signatures(recorder: Recorder, linkage: Linkage) -> Array:
    """Return the signatures of the finished cycles; see ``recording.settling.signatures``."""
    joints = range(len(linkage.clearances))
    clearance = np.array([joint.clearance for joint in linkage.clearances])
    names = "eccentricity_x", "eccentricity_y"
    places = np.array(
        [[recorder.each_cycle(name, k) for name in names] for k in joints]
    )
    forces = np.array([recorder.each_cycle("force_max", k) for k in joints])
    return signatures(np.moveaxis(places, -1, 0) / clearance[:, np.newaxis], forces.T)


def least_kicks(
    linkage: Linkage,
    states: Sequence[Start],
    orbit: Array,
    speeds: Array,
    report: Callable[[float], object] = lambda share: None,
) -> list[Kick]:
    """Return the least kick of each pin; empty if the motion does not return without one.

    Parameters
    ----------
    states : sequence of Start
        States of the settled motion after whole cycles, see ``states_of``.
    orbit : ndarray, shape (n, 3 joints)
        Signatures of its cycles.
    speeds : ndarray, shape (joints,)
        Strongest kick of each pin, m/s.
    report : callable
        Called with the completed share, many times.
    """
    if any(leaves(linkage, state, orbit) for state in states):
        return []
    cases = list(product(range(len(states)), DIRECTIONS))

    def rattles(k: int, case: int, speed: float) -> bool:
        report(k / len(linkage.clearances))
        state = states[cases[case][0]]
        degrees = cases[case][1]
        angle = body_angle(linkage, state, k) + math.radians(degrees)
        change = np.zeros((len(linkage.clearances), 2))
        change[k] = speed * np.array([math.cos(angle), math.sin(angle)])
        return leaves(linkage, kick_pins(linkage, state, change), orbit)

    kicks = []
    for k, joint in enumerate(linkage.clearances):
        returns, limit, case = least_speed(
            partial(rattles, k), len(cases), float(speeds[k])
        )
        state, degrees = cases[case]
        kicks.append(Kick(joint.name, limit, returns, degrees, state))
    return kicks


def least_speed(
    rattles: Callable[[int, float], bool], cases: int, most: float
) -> tuple[float, float | None, int]:
    """Return a speed after which all cases return, and a higher one after which one rattles.

    The case that rattles comes third. As in the search of Attractors.jl, the speed is
    reduced until all cases return, by ``FACTORS`` in turn. The boundary of a basin can
    be fractal, so that a weaker kick may rattle: the higher speed is an upper bound. It
    is None if all cases return after ``most``.
    """

    def first(speed: float) -> int | None:
        order = [last, *(case for case in range(cases) if case != last)]
        return next((case for case in order if rattles(case, speed)), None)

    last = 0
    case = first(most)
    if case is None:
        return most, None, 0
    limit = most
    last = case
    for factor in FACTORS:
        while limit > WEAKEST * most and (case := first(limit / factor)) is not None:
            limit = limit / factor
            last = case
    returns = limit / FACTORS[-1] if limit > WEAKEST * most else 0.0
    return returns, limit, last


def states_of(linkage: Linkage, ends: Sequence[Start], ideal: Start) -> list[Start]:
    """Return states of a settled motion: the ends of runs, and of further cycles of the last one.

    A motion that repeats may wander slowly, and only some of its states may be
    sensitive to kicks.
    """
    states = [continued(linkage, linkage, end, ideal) for end in ends[:STATES]]
    while len(states) < STATES:
        run = ENGINE.simulate(
            linkage, states[-1], Plan(linkage.period, 1, 1, torques=False)
        )
        states.append(continued(linkage, linkage, run.end, ideal))
    return states


def body_angle(linkage: Linkage, start: Start, k: int) -> float:
    """Return the angle of the body that carries the bearing of a joint, rad; 0 for the frame."""
    body = linkage.clearances[k].bearing.body
    return 0.0 if body == GROUND else float(start.position[3 * linkage.index(body) + 2])


def leaves(linkage: Linkage, start: Start, orbit: Array) -> bool:
    """Return whether a motion is away from an orbit after the start-up cycles, or fails."""
    run = ENGINE.simulate(
        linkage, start, Plan(linkage.period, WATCHED, 1, torques=False)
    )
    if run.status == "failed":
        return True
    cycles = recorded_signatures(run.recorder, linkage)[STARTUP_CYCLES:]
    distance = np.abs(cycles[:, np.newaxis] - orbit).max(axis=2)
    return bool((distance.min(axis=1) > CHANGE).any())
