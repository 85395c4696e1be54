"""Drives that make a point follow a curve, by inverse kinematics."""

import math
from dataclasses import replace
from functools import lru_cache
from itertools import pairwise

import numpy as np

from presswear.linkage.linkage import Linkage
from presswear.linkage.mechanism import Mechanism
from presswear.linkage.motion_pieces import MAX_PIECES, MIN_PIECE
from presswear.physics.assembly import close
from presswear.physics.constraint_rows import ROUND_OFF, Rows, motion_of_row
from presswear.physics.ideal import IdealMotion, ideal_motion
from presswear.tools.arrays import Array
from presswear.tools.errors import AssemblyError

# Largest distance of a point from the curve that it follows, over its stroke
FOLLOWED = 1e-9
# Numbers of pieces of the motion of a drive that are tried before MAX_PIECES
_PIECES = 32, 64, 128, 256


def motion_of(mechanism: Mechanism | Linkage) -> IdealMotion:
    """Return the ideal motion of a mechanism; AssemblyError where it has none."""
    return ideal_motion(followed(mechanism.linkage()), mechanism.period)


@lru_cache(maxsize=64)
def followed(linkage: Linkage) -> Linkage:
    """Return a linkage whose drives move so that their points follow the requested curves.

    The linkage is followed around its cycle with the points on their curves; the angles
    of the drives become tables of degree 5, fine enough for ``FOLLOWED``. AssemblyError
    where a point cannot follow, or not by a drive with the mean speed that is given.
    """
    following = [
        k for k, drive in enumerate(linkage.drives) if drive.follow is not None
    ]
    if not following:
        return linkage
    period = linkage.period
    inverse = ideal_motion(replace(linkage, run_up=0), period)
    base = 2.0 * math.pi / period
    for drive in (linkage.drives[k] for k in following):
        place = linkage.index(drive.body)
        angle = (inverse.position[-1] - inverse.position[0])[place, 2]
        speed = base * round(angle / (2.0 * math.pi))
        if abs(speed - drive.speed) > 1e-9 * max(base, abs(speed)):
            raise AssemblyError(
                f"speed of {drive.body} = {drive.speed:g} rad/s: to follow its curve it turns at "
                f"a mean speed of {speed:g} rad/s"
            )
    rows = inverse.rows
    breaks = _breaks(linkage, period)
    curves = [motion_of_row(linkage.drives[k], inverse.times)[0] for k in following]
    allowed = max(
        FOLLOWED * (np.ptp(curves, axis=1).max() or rows.size), ROUND_OFF * rows.size
    )
    off = math.inf
    for parts in (*_PIECES[:-1], _PIECES[-1] - len(breaks), MAX_PIECES - len(breaks)):
        counts = np.maximum(
            np.ceil(np.diff(breaks) / period * parts - 1e-9).astype(int), 1
        )
        if counts.sum() > MAX_PIECES:
            continue
        intervals = zip(breaks[:-1], breaks[1:], counts, strict=True)
        nodes = np.concatenate(
            [np.linspace(*item, endpoint=False) for item in intervals]
        )
        result = _through(linkage, inverse, nodes)
        length = np.diff(nodes, append=period)
        between = np.concatenate([nodes + part * length for part in (0.25, 0.5, 0.75)])
        near = inverse.at(between).position.reshape(between.size, -1, 3)
        reached = close(Rows(result), between, near).q
        off = float(np.abs(rows.errors(between, reached)[0][:, rows.following]).max())
        if off <= allowed:
            return result
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
    """Return the linkage with tables in place of curves, through its motion at instants, s."""
    motion = inverse.at(nodes)
    base = 2.0 * math.pi / inverse.period
    drives = list(linkage.drives)
    for k, drive in enumerate(linkage.drives):
        if drive.follow is not None:
            place = 3 * linkage.index(drive.body) + 2
            deviation = motion.position[:, place] - drive.speed * nodes
            rate = (motion.velocity[:, place] - drive.speed) / base
            curvature = motion.acceleration[:, place] / base**2
            table = np.column_stack([base * nodes, deviation, rate, curvature])
            drives[k] = replace(
                drive, frequency=base, table=table.tolist(), follow=None
            )
    return linkage.changed(drives=drives)


def _breaks(linkage: Linkage, period: float) -> Array:
    """Return the times of a cycle at which a motion is not smooth, s, and the end of the cycle."""
    result = [0.0]
    for drive in linkage.drives:
        law = drive.follow or drive
        starts = law.pieces.start
        for turn in range(
            round(period * drive.base / (2.0 * math.pi)) if starts.size else 0
        ):
            result += ((starts + 2.0 * math.pi * turn) / drive.base).tolist()
    least = MIN_PIECE * period
    separate = [
        time
        for before, time in pairwise([-period, *sorted(result)])
        if time - before > least
    ]
    return np.array([*(time for time in separate if period - time > least), period])
