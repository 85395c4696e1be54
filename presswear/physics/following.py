"""Inverse kinematics: the motion of a drive that makes a point follow a curve."""

import math
from dataclasses import replace
from functools import lru_cache
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from presswear.linkage.drives import MAX_PIECES, MIN_PIECE
from presswear.linkage.linkage import Linkage
from presswear.linkage.mechanisms import Mechanism
from presswear.physics.assembly import ROUND_OFF, closed
from presswear.physics.ideal import IdealMotion, ideal_motion
from presswear.physics.rows import Rows
from presswear.tools.errors import AssemblyError

Array = NDArray[np.float64]

FOLLOWED = 1e-9
"""How near a point keeps to the curve that it follows, part of its stroke."""
_PIECES = 32, 64, 128
"""Of the motion of a drive whose point follows a curve; at last as many as there may be."""


def motion_of(mechanism: Mechanism | Linkage) -> IdealMotion:
    """The ideal motion of a mechanism; AssemblyError where it has none."""
    return ideal_motion(followed(mechanism.linkage()), mechanism.period)


@lru_cache(maxsize=64)
def followed(linkage: Linkage) -> Linkage:
    """A linkage in which the motion is found of each drive whose point follows a curve.

    The linkage is followed around its cycle with the points on their curves; the angles of
    the drives become tables of degree 5, fine enough for ``FOLLOWED``.

    Raises
    ------
    AssemblyError
        Where a point cannot follow, or not by a drive with the mean speed that is given.
    """
    following = [k for k, drive in enumerate(linkage.drives) if drive.follow is not None]
    if not following:
        return linkage
    period = linkage.period
    inverse = ideal_motion(replace(linkage, run_up=0), period)
    base = 2.0 * math.pi / period
    columns = [linkage.index(linkage.drives[k].body) for k in following]
    turned = (inverse.position[-1] - inverse.position[0])[columns, 2]
    for k, turn in zip(following, turned, strict=True):
        drive, speed = linkage.drives[k], base * round(turn / (2.0 * math.pi))
        if abs(speed - drive.speed) > 1e-9 * max(base, abs(speed)):
            raise AssemblyError(
                f"speed of {drive.body} = {drive.speed:g} rad/s: to follow its curve it turns at "
                f"a mean speed of {speed:g} rad/s"
            )
    breaks = _breaks(linkage, period)
    curves = inverse.rows.coordinates(inverse.position)
    size = inverse.rows.size
    allowed = max(FOLLOWED * (np.ptp(curves, axis=0).max() or size), ROUND_OFF * size)
    off = math.inf
    for parts in (*_PIECES, MAX_PIECES - len(breaks)):
        counts = np.ceil(np.diff(breaks) / period * parts - 1e-9).astype(int)
        if np.maximum(counts, 1).sum() > MAX_PIECES:
            continue
        ends = [
            np.linspace(*pair, max(n, 1) + 1)
            for pair, n in zip(pairwise(breaks), counts, strict=True)
        ]
        nodes = np.concatenate([own[:-1] for own in ends])
        found = _through(linkage, inverse, nodes)
        length = np.diff(nodes, append=period)
        between = np.concatenate([nodes + part * length for part in (0.25, 0.5, 0.75)])
        near = inverse.at(between).position.reshape(between.size, -1, 3)
        reached = closed(Rows(found), between, near).q
        off = float(np.abs(inverse.rows.off_curves(between, reached)).max())
        if off <= allowed:
            return found
    name = linkage.drives[following[0]].name
    if math.isinf(off):
        raise AssemblyError(
            f"{name}: the curve has {len(breaks) - 1} pieces in the cycle of the linkage; allowed "
            f"are {MAX_PIECES}"
        )
    raise AssemblyError(
        f"{name}: with {MAX_PIECES} pieces its point is {off:.3g} m off the curve; allowed is "
        f"{allowed:.3g} m, {FOLLOWED:g} of its stroke"
    )


def _through(linkage: Linkage, inverse: IdealMotion, nodes: Array) -> Linkage:
    """The linkage with tables, in place of curves, through its motion at some instants, s."""
    motion, base = inverse.at(nodes), 2.0 * math.pi / inverse.period
    drives = list(linkage.drives)
    for k, drive in enumerate(linkage.drives):
        if drive.follow is not None:
            place = 3 * linkage.index(drive.body) + 2
            table = np.column_stack(
                [
                    base * nodes,
                    motion.position[:, place] - drive.speed * nodes,
                    (motion.velocity[:, place] - drive.speed) / base,
                    motion.acceleration[:, place] / base**2,
                ]
            )
            drives[k] = replace(drive, frequency=base, table=table.tolist(), follow=None)
    return linkage.changed(drives=drives)


def _breaks(linkage: Linkage, period: float) -> Array:
    """Times of a cycle at which a motion is not smooth, s, and the first of the next cycle."""
    found = [0.0]
    for drive in linkage.drives:
        law = drive.follow or drive
        starts = law.pieces.start
        for turn in range(round(period * drive.base / (2.0 * math.pi)) if starts.size else 0):
            found += ((starts + 2.0 * math.pi * turn) / drive.base).tolist()
    least = MIN_PIECE * period
    apart = [time for before, time in pairwise([-period, *sorted(found)]) if time - before > least]
    return np.array([*(time for time in apart if period - time > least), period])
