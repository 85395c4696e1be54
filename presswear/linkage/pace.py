"""What would run for ever: steps that a cycle takes at least, before anything runs."""

import math
from collections.abc import Iterator

import numpy as np

from presswear.linkage.linkage import MOST_TURNS, Linkage
from presswear.linkage.loads import Harmonics, Load, OverTime
from presswear.linkage.motions import Drive
from presswear.linkage.points import GROUND
from presswear.tools.errors import InputError

MOST_STEPS = 1e7
"""Of a cycle; some minutes."""
STEPS = 20.0
"""In one oscillation."""

SAMPLES = 16
"""Instants of a piece of a motion, or of its harmonics, at which the speed is looked at."""

HEAVIER = 1e6
"""Mass of the heaviest body over that of the lightest, at most.

Beyond it the accelerations of the light body are round-off of the forces on the heavy one:
runs crawl at the shortest step, or end there.
"""


def check_pace(linkage: Linkage) -> None:
    """InputError naming a value with which a cycle would take more steps than anybody waits for."""
    light, heavy = (least(linkage.bodies, key=lambda own: own.mass) for least in (min, max))
    if heavy.mass > HEAVIER * light.mass:
        raise InputError(
            f"mass of {heavy.name} = {heavy.mass:g} kg beside mass of {light.name} = "
            f"{light.mass:g} kg: allowed is {HEAVIER:g} times as much"
        )
    allowed = MOST_TURNS * 2.0 * math.pi / linkage.period
    for drive in linkage.drives:
        fastest = _greatest_speed(drive)
        if fastest > allowed:
            raise InputError(
                f"greatest speed of the {drive.name} = {fastest:.4g} rad/s: allowed is "
                f"{allowed:.4g} rad/s, {MOST_TURNS} turns in a cycle of {linkage.period:g} s; the "
                "spline through a table overshoots beside a steep step, rises do not"
            )
    for what, rate in _rates(linkage):
        steps = rate * linkage.period
        if steps > MOST_STEPS:
            raise InputError(
                f"{what}: in a cycle of {linkage.period:g} s it takes {steps:.2g} steps; allowed "
                f"are {MOST_STEPS:g}"
            )


def _greatest_speed(drive: Drive) -> float:
    """Return the greatest speed of a drive, rad/s; 0 where its motion has to be found."""
    if drive.follow is not None:
        return 0.0
    starts = drive.pieces.start
    lengths = np.diff(starts, append=starts[:1] + 2.0 * math.pi)
    inside = starts + np.linspace(0.0, 1.0, SAMPLES)[:, np.newaxis] * lengths
    waves = np.linspace(0.0, 2.0 * math.pi, 1 + SAMPLES * len(drive.harmonics))
    phase = np.concatenate([inside.ravel(), waves])
    return float(np.abs(drive.motion(phase / (drive.base or 1.0))[1]).max())


def _rates(linkage: Linkage) -> Iterator[tuple[str, float]]:
    """Steps in a second that parts of a linkage take, with the values that they follow from."""
    for k, load in enumerate(linkage.loads):
        law = None if isinstance(load, Load) else load.law
        if isinstance(law, OverTime) and law.period:
            yield f"period of loads[{k}] = {law.period:g} s", len(law.table) / law.period
        if isinstance(law, Harmonics):
            fastest = len(law.harmonics) * law.frequency
            told = f"frequency of loads[{k}] = {law.frequency:g} rad/s"
            yield told, STEPS * fastest / (2.0 * math.pi)
    for spring in linkage.springs:
        ends = {end.body for end in spring.ends} - {GROUND}
        lightness = sum(1.0 / linkage.bodies[linkage.index(body)].mass for body in ends)
        told = f"stiffness of spring {spring.name} = {spring.stiffness:g} N/m"
        yield told, STEPS * math.sqrt(spring.stiffness * lightness) / (2.0 * math.pi)
        yield (
            f"damping of spring {spring.name} = {spring.damping:g} N s/m",
            (spring.damping * lightness),
        )
