"""Order analysis: amplitudes at the crank's harmonics, and where the contacts ring."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from presswear.dynamics.modes import resonance_of
from presswear.dynamics.spectra import spectrum_of
from presswear.engines.base import Plan, Start
from presswear.engines.settings import InHouse
from presswear.linkage.linkage import Linkage
from presswear.physics.touchdown import CONTACT_COLUMNS

Array = NDArray[np.float64]

HIGHEST = 1000
"""Highest order, turns of the crank: contacts ring at some hundreds where it is slow."""
_SETTLE = 1
"""Cycles before those that are analysed: contacts begin anew."""


@dataclass(frozen=True)
class Orders:
    """Amplitudes of a motion by the crank's orders.

    Attributes
    ----------
    amplitude : ndarray, shape (1 + joints, HIGHEST)
        Of the watched point's acceleration, m/s^2, and of each joint's normal force, N, within
        half an order of 1, 2, ...; NaN where the run failed.
    resonance : ndarray, shape (joints,)
        Order of the frequency at which the contacts of each joint ring; NaN where none is known.
    """

    amplitude: Array
    resonance: Array

    @staticmethod
    def none(joints: int, highest: int) -> "Orders":
        """Orders up to so many that are not known."""
        return Orders(np.full((1 + joints, highest), math.nan), np.full(joints, math.nan))


def orders_of(
    linkage: Linkage, start: Start, period: float, cycles: int, engine: InHouse
) -> Orders:
    """Orders of a linkage in some cycles from a start.

    Parameters
    ----------
    period : float
        Duration of a cycle, s.
    cycles : int
        That are analysed.
    """
    count = len(linkage.clearances)
    length = _SETTLE + cycles
    run = engine.simulate(linkage, start, Plan(period, length, length, torques=False))
    if run.status == "failed":
        return Orders.none(count, HIGHEST)
    recorder = run.recorder
    time = recorder.series("time")
    rows = time >= _SETTLE * period
    series = [recorder.series("acceleration")]
    series += [recorder.series("normal", k) for k in range(count)]
    spectra = [spectrum_of(time[rows], own[rows], period, (HIGHEST + 1) / period) for own in series]
    touchdown, separation, closing = map(
        CONTACT_COLUMNS.index, ("touchdown", "separation", "closing_speed")
    )
    rings = []
    for k in range(count):
        contacts = recorder.episodes(k)
        found = resonance_of(contacts[:, separation] - contacts[:, touchdown], contacts[:, closing])
        rings.append(math.nan if found is None else found * period)
    amplitude = [[own.amplitude(order) for order in range(1, HIGHEST + 1)] for own in spectra]
    return Orders(np.array(amplitude), np.array(rings))
