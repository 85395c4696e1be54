"""Assembly of any linkage, by Newton's method on its constraint rows."""

import math
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from presswear.linkage.elements import GROUND, Attachment
from presswear.linkage.linkage import Linkage
from presswear.physics.rows import Rows
from presswear.tools.errors import AssemblyError

Array = NDArray[np.float64]

ROUND_OFF = 4e-15
"""Error of a row that is round-off, part of the size of the linkage."""
_STEPS = 40
"""Most Newton steps from a guess."""


class Levels(NamedTuple):
    """Position, velocity and acceleration of all bodies, each (n, bodies, 3)."""

    q: Array
    v: Array
    a: Array


def check_freedoms(linkage: Linkage) -> None:
    """Raise AssemblyError unless joints, guides and drives hold each body just once."""
    rows = 2 * len(linkage.revolutes) + 2 * len(linkage.guides) + len(linkage.drives)
    free = 3 * len(linkage.bodies) - rows
    told = (
        f"{len(linkage.bodies)} bodies have {3 * len(linkage.bodies)} coordinates; joints, guides "
        f"and drives hold {rows}"
    )
    if free > 0:
        raise AssemblyError(f"the linkage is free to move: {told}; {free} drives are missing")
    if free < 0:
        raise AssemblyError(f"the linkage is overconstrained: {told}, {-free} too many")


def guessed(linkage: Linkage) -> Array:
    """Coordinates to start Newton's method from, shape (bodies, 3).

    Angles are those of the drives, of the guides, as guessed, or 0; each body hangs by the first
    joint that reaches it.
    """
    q = np.zeros((len(linkage.bodies), 3))
    angles = dict(linkage.guess)
    angles |= {guide.body: guide.angle for guide in linkage.guides}
    angles |= {drive.body: drive.angle for drive in linkage.drives}
    for place, body in enumerate(linkage.bodies):
        q[place, 2] = angles.get(body.name, 0.0)
    reached = {GROUND}

    def where(end: Attachment) -> Array:
        local = np.array([end.x, end.y])
        if end.body == GROUND:
            return local
        x, y, angle = q[linkage.index(end.body)]
        cosine, sine = math.cos(angle), math.sin(angle)
        turned = cosine * end.x - sine * end.y, sine * end.x + cosine * end.y
        return np.array([x + turned[0], y + turned[1]])

    waiting = [*linkage.revolutes]
    while waiting:
        hung = False
        for joint in tuple(waiting):
            known, loose = joint.first, joint.second
            if known.body not in reached:
                known, loose = loose, known
            if known.body in reached and loose.body not in reached:
                place = linkage.index(loose.body)
                q[place, :2] += where(known) - where(loose)
                reached.add(loose.body)
                hung = True
            if {known.body, loose.body} <= reached:
                waiting.remove(joint)
        if not hung:
            break
    for guide in linkage.guides:
        place = linkage.index(guide.body)
        along = np.array([math.cos(guide.direction), math.sin(guide.direction)])
        point = np.array([guide.x, guide.y])
        q[place, :2] = point + along * ((q[place, :2] - point) @ along)
    return q


def assembled(linkage: Linkage) -> Array:
    """Put a linkage together at its start, shape (bodies, 3).

    Raises
    ------
    AssemblyError
        Where it does not close, or closes more than a right angle from what was guessed.
    """
    # What follows a curve stands where its drive has it.
    linkage = linkage.changed(drives=[replace(drive, follow=None) for drive in linkage.drives])
    check_freedoms(linkage)
    rows = Rows(linkage)
    start = np.zeros(1)
    q, guess = guessed(linkage)[np.newaxis], dict(linkage.guess)

    def error_of(q: Array) -> float:
        return float(np.linalg.norm(rows.errors(start, q)[0]))

    for _ in range(_STEPS):
        error = error_of(q)
        if error < 1e-9 * rows.size:
            break
        step = -_solved(rows, start, q, rows.errors(start, q)[0]).reshape(q.shape)
        # No body turns by more than half a radian at once: the guess says on which side it is.
        part = min(1.0, 0.5 / max(float(np.abs(step[..., 2]).max()), 1e-300))
        while part > 1e-3 and error_of(q + part * step) > error:
            part *= 0.5
        q = q + part * step
    q = closed(rows, start, q)[0]
    given = {drive.body for drive in linkage.drives} | {guide.body for guide in linkage.guides}
    for place, body in enumerate(linkage.bodies):
        if body.name not in given:
            turns = (q[0, place, 2] - guess.get(body.name, 0.0)) / (2.0 * math.pi)
            q[0, place, 2] -= 2.0 * math.pi * np.round(turns)
    for name, angle in guess.items():
        found = float(q[0, linkage.index(name), 2])
        if abs(found - angle) > 0.5 * math.pi and name not in given:
            raise AssemblyError(
                f"guess of {name} = {angle:.4g} rad: the linkage closes with it at {found:.4g} "
                "rad; a guess within a right angle of the place that is meant is needed"
            )
    return np.asarray(q[0])


def closed(rows: Rows, time: Array, q: Array) -> Levels:
    """Close a linkage at some instants from positions close by; position, velocity, acceleration.

    Raises
    ------
    AssemblyError
        Where it does not close; names the joint and the crank angle.
    """
    shape, zero = q.shape, np.zeros_like(q)
    least = math.inf
    for _ in range(_STEPS):
        (phi,) = rows.errors(time, q)
        error = float(np.abs(phi).max(initial=0.0))
        if not error < 1e3 * rows.size:
            break
        # Round-off does not shrink any more.
        if error <= ROUND_OFF * rows.size or (error < 1e-12 * rows.size and error >= 0.5 * least):
            break
        least = min(least, error)
        q = q - _solved(rows, time, q, phi).reshape(shape)
    else:
        error = math.inf
    if not error < 1e-9 * rows.size:
        raise _open(rows, time, q)
    v = -_solved(rows, time, q, rows.errors(time, q, zero)[1]).reshape(shape)
    a = -_solved(rows, time, q, rows.errors(time, q, v, zero)[2]).reshape(shape)
    return Levels(q, v, a)


def _solved(rows: Rows, time: Array, q: Array, right: Array) -> Array:
    """Solve J x = right at each instant."""
    try:
        return np.asarray(np.linalg.solve(rows.jacobian(q), right[..., None])[..., 0])
    except np.linalg.LinAlgError:
        raise stuck(rows, time, q) from None


def _open(rows: Rows, time: Array, q: Array) -> AssemblyError:
    """The error of a linkage that does not close: the joint that stays open, and where."""
    phi = np.abs(rows.errors(time, q)[0])
    phi = np.where(np.isfinite(phi), phi, math.inf)
    instant = int(phi.max(axis=1).argmax())
    return _refusal(rows, float(time[instant]), rows.names[int(phi[instant].argmax())])


def stuck(rows: Rows, time: Array, q: Array) -> AssemblyError:
    """The error of a linkage that is held twice in some direction and not at all in another."""
    # Metres and radians are made comparable by the size of each body.
    scale = np.ones((rows.bodies, 3))
    scale[:, 2] = 1.0 / rows.sizes
    _, values, right = np.linalg.svd(rows.jacobian(q) * scale.ravel())
    worst = int(values[:, -1].argmin())
    # The motion that nothing holds: the joint whose bodies turn most against each other.
    free = np.append((right[worst, -1].reshape(-1, 3) * scale)[:, 2], 0.0)
    turning = {
        joint.name: abs(free[one] - free[other])
        for joint, (one, other) in zip(rows.linkage.revolutes, rows.pairs, strict=True)
    }
    # Of several that turn alike the last: it is farther from the drives.
    names = list(turning)[::-1] or [*rows.names]
    return _refusal(rows, float(time[worst]), max(names, key=lambda name: turning.get(name, 0.0)))


def _refusal(rows: Rows, time: float, joint: str) -> AssemblyError:
    where = ""
    for drive in [own for own in rows.linkage.drives if own.follow is None][:1]:
        turned = float(drive.motion(np.array([time]))[0][0]) - drive.angle
        where = f"at crank angle {math.degrees(abs(turned)):.1f} deg "
    for drive in [own for own in rows.linkage.drives if own.follow is not None]:
        return AssemblyError(
            f"{drive.name} cannot make its point follow the curve: {where}({time:.6g} s after the "
            "start) the point is out of reach, or the drive at a dead point"
        )
    return AssemblyError(
        f"the linkage cannot be assembled over the cycle: {where}joint {joint} does not close or "
        "is at a dead point"
    )
