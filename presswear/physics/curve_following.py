"""Drives that make a point follow a curve, by inverse kinematics."""

import math
from collections.abc import Sequence
from dataclasses import replace
from functools import lru_cache
from itertools import pairwise

import numpy as np

from presswear.linkage.drives import Drive
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

    The motion with the points on their curves is computed over a cycle. The angles of
    the drives become tables of degree 5, with errors up to ``FOLLOWED``.

    Raises
    ------
    AssemblyError
        If a point cannot follow its curve, or not with the specified mean speed.
    """
    following = [drive for drive in linkage.drives if drive.follow is not None]
    if not following:
        return linkage
    period = linkage.period
    inverse = ideal_motion(replace(linkage, run_up=0), period)
    _check_speeds(following, inverse)
    breaks = _breaks(linkage, period)
    allowed = _allowed_error(following, inverse)
    error = math.inf
    # A break adds up to one piece.
    for pieces in (*_PIECES[:-1], _PIECES[-1] - len(breaks), MAX_PIECES - len(breaks)):
        nodes = _nodes_of(breaks, period, pieces)
        if nodes.size > MAX_PIECES:
            continue
        result = _through(linkage, inverse, nodes)
        error = _greatest_error(result, inverse, nodes)
        if error <= allowed:
            return result
    name = following[0].name
    if math.isinf(error):
        raise AssemblyError(
            f"{name}: the curve has {len(breaks) - 1} pieces in the cycle of the linkage; allowed "
            f"are {MAX_PIECES}"
        )
    raise AssemblyError(
        f"{name}: with {MAX_PIECES} pieces its point is {error:.3g} m off the curve; allowed is "
        f"{allowed:.3g} m, {FOLLOWED:g} of its stroke"
    )


def _check_speeds(following: Sequence[Drive], inverse: IdealMotion) -> None:
    """Raise AssemblyError if a drive does not have the mean speed of its curve."""
    base = 2.0 * math.pi / inverse.period
    start, end = inverse.position[[0, -1]]
    for drive in following:
        body = inverse.rows.linkage.index(drive.body)
        angle = end[body, 2] - start[body, 2]
        speed = base * round(angle / (2.0 * math.pi))
        if abs(speed - drive.speed) > 1e-9 * max(base, abs(speed)):
            raise AssemblyError(
                f"speed of {drive.body} = {drive.speed:g} rad/s: to follow its curve it turns at "
                f"a mean speed of {speed:g} rad/s"
            )


def _allowed_error(following: Sequence[Drive], inverse: IdealMotion) -> float:
    """Return the allowed distance of points from their curves, m."""
    strokes = []
    for drive in following:
        curve, *_ = motion_of_row(drive, inverse.times)
        strokes.append(float(np.ptp(curve)))
    size = inverse.rows.size
    stroke = max(strokes) or size
    return max(FOLLOWED * stroke, ROUND_OFF * size)


def _nodes_of(breaks: Array, period: float, pieces: int) -> Array:
    """Return the starts of some pieces of equal length in each interval between breaks, s.

    A cycle has at least ``pieces``, and each interval at least one.
    """
    nodes = []
    for first, last in pairwise(breaks):
        # Round-off of an interval adds no piece.
        count = max(math.ceil((last - first) / period * pieces - 1e-9), 1)
        nodes.append(np.linspace(first, last, count, endpoint=False))
    return np.concatenate(nodes)


def _greatest_error(linkage: Linkage, inverse: IdealMotion, nodes: Array) -> float:
    """Return the greatest distance of points from their curves within the pieces, m.

    ``linkage`` has tables between the nodes; ``inverse`` is the motion on the curves.
    """
    length = np.diff(nodes, append=inverse.period)
    time = np.concatenate([nodes + fraction * length for fraction in (0.25, 0.5, 0.75)])
    guess = inverse.at(time).position.reshape(time.size, -1, 3)
    position = close(Rows(linkage), time, guess).q
    errors, *_ = inverse.rows.errors(time, position)
    return float(np.abs(errors[:, inverse.rows.following]).max())


def _through(linkage: Linkage, inverse: IdealMotion, nodes: Array) -> Linkage:
    """Return the linkage with tables in place of curves, through its motion at instants, s."""
    motion = inverse.at(nodes)
    base = 2.0 * math.pi / inverse.period
    drives = list(linkage.drives)
    for k, drive in enumerate(linkage.drives):
        if drive.follow is not None:
            angle = 3 * linkage.index(drive.body) + 2  # column of the angle
            deviation = motion.position[:, angle] - drive.speed * nodes
            rate = (motion.velocity[:, angle] - drive.speed) / base
            curvature = motion.acceleration[:, angle] / base**2
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
        if not starts.size:
            continue
        for turn in range(round(period * drive.base / (2.0 * math.pi))):
            result += ((starts + 2.0 * math.pi * turn) / drive.base).tolist()
    least = MIN_PIECE * period
    breaks = []
    for before, time in pairwise([-period, *sorted(result)]):
        if time - before > least and period - time > least:
            breaks.append(time)
    return np.array([*breaks, period])
