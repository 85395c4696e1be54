"""Assembly of a linkage by Newton's method on its constraint rows."""

import math
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from presswear.linkage.drives import LinearDrive, linear_bodies
from presswear.linkage.joints import closing_guides, ends_of, rows_of_joints
from presswear.linkage.linkage import Linkage
from presswear.linkage.part_checks import start_angles
from presswear.linkage.points import GROUND, Attachment
from presswear.physics.constraint_rows import ROUND_OFF, Rows
from presswear.tools.arrays import Array
from presswear.tools.errors import AssemblyError

_STEPS = 40  # most Newton steps from a guess


class Levels(NamedTuple):
    """Position, velocity and acceleration of all bodies, each (n, bodies, 3)."""

    q: Array
    v: Array
    a: Array


def _guessed(linkage: Linkage) -> Array:
    """Return the coordinates to start Newton's method from, shape (bodies, 3).

    The angle of a body is that of its drive, of its guide, of the guess of the user, or
    0. Its position is that at which the first joint to a body with known position
    closes.
    """
    q = np.zeros((len(linkage.bodies) + 1, 3))  # the frame last
    indices = {body.name: i for i, body in enumerate(linkage.bodies)} | {GROUND: -1}
    angles = start_angles(linkage.guides, linkage.drives, dict(linkage.guess))
    q[:-1, 2] = [angles.get(body.name, 0.0) for body in linkage.bodies]

    def place(end: Attachment) -> Array:
        x, y, angle = q[indices[end.body]]
        cosine = math.cos(angle)
        sine = math.sin(angle)
        across = cosine * end.x - sine * end.y
        up = sine * end.x + cosine * end.y
        return np.array([x + across, y + up])

    reached = {GROUND}
    for _ in linkage.bodies:
        for joint in linkage.revolutes:
            placed = joint.first
            loose = joint.second
            if placed.body not in reached:
                placed, loose = loose, placed
            if placed.body in reached and loose.body not in reached:
                q[indices[loose.body], :2] += place(placed) - place(loose)
                reached.add(loose.body)
    positions = {
        drive.along: drive.position
        for drive in linkage.drives
        if isinstance(drive, LinearDrive)
    }
    for guide in linkage.guides:
        start, centre = ends_of(guide)
        direction = guide.direction + q[indices[guide.on], 2]
        along = np.array([math.cos(direction), math.sin(direction)])
        point = place(start)
        body = indices[centre.body]
        distance = (q[body, :2] - point) @ along
        q[body, :2] = point + along * positions.get(guide.name, distance)
    return q[:-1]


def _free_coordinates(linkage: Linkage) -> int:
    """Return the coordinates less the constraint rows; below zero where rows are repeated."""
    constrained = sum(rows_of_joints(linkage.joints))
    constrained += len(linkage.prescribed_drives)
    return 3 * len(linkage.bodies) - constrained


def _count(linkage: Linkage) -> str:
    """Return the numbers of coordinates and of constraint rows in words."""
    coordinates = 3 * len(linkage.bodies)
    constrained = coordinates - _free_coordinates(linkage)
    rows = "".join(
        ["2 each", *(f", {name} 1" for name in closing_guides(linkage.guides))]
    )
    return (
        f"{len(linkage.bodies)} bodies have {coordinates} coordinates; pins and guides ({rows}) "
        f"and drives (1 each) hold {constrained}"
    )


def _closed(rows: Rows, time: Array, q: Array) -> Levels:
    """Close a linkage at an instant from guessed positions, by damped steps at first."""

    def error_of(q: Array) -> float:
        return float(np.linalg.norm(rows.errors(time, q)[0]))

    for _ in range(_STEPS):
        error = error_of(q)
        if error < 1e-9 * rows.size:
            break
        step = -_solved(rows, time, q, rows.errors(time, q)[0])
        # No body turns by more than half a radian at once: the guess says on which side
        # it is.
        fraction = min(1.0, 0.5 / max(float(np.abs(step[..., 2]).max()), 1e-300))
        while fraction > 1e-3 and error_of(q + fraction * step) > error:
            fraction *= 0.5
        q = q + fraction * step
    return close(rows, time, q)


def _check_freedom(linkage: Linkage) -> None:
    """Raise AssemblyError if joints, guides and drives hold too few coordinates."""
    free = _free_coordinates(linkage)
    if free <= 0:
        return
    held_bodies = []
    for joint in linkage.joints:
        held_bodies += [end.body for end in ends_of(joint)]
    hint = ""
    for body in linkage.bodies:
        joints = held_bodies.count(body.name)
        if joints < 2:
            holds = "only one joint holds it" if joints else "no joint holds it"
            hint += f"; body {body.name} can move freely, {holds}"
    raise AssemblyError(
        f"the linkage is free to move: {_count(linkage)}{hint}; add joints, guides or drives "
        f"that hold {free} more"
    )


def _hint_at_guess(linkage: Linkage, prescribed: set[str]) -> str:
    """Return the bodies without an angle in the guess, and the lines of the guides."""
    guided = {guide.body for guide in linkage.guides}
    bodies = {body.name for body in linkage.bodies} - guided - prescribed
    bodies -= dict(linkage.guess).keys()
    hint = f"; guess has no angle of {', '.join(sorted(bodies))}" if bodies else ""
    for guide in linkage.guides:
        where = f"({1e3 * guide.x:.6g}, {1e3 * guide.y:.6g}) mm"
        where += f" of {guide.on}" if guide.is_moving else ""
        hint += f"; the line of {guide.name} goes through {where}"
    return hint


def assembled(linkage: Linkage) -> Array:
    """Return the coordinates of a linkage at its start, shape (bodies, 3).

    Raises
    ------
    AssemblyError
        If a body is free to move, if the linkage does not close, if repeated rows
        contradict each other, or if an angle is more than a right angle from its guess.
    """
    # A point that follows a curve begins at the place to which its drive moves it.
    linkage = linkage.changed(
        drives=[replace(drive, follow=None) for drive in linkage.drives]
    )
    _check_freedom(linkage)
    rows = Rows(linkage)
    guess = dict(linkage.guess)
    angles = start_angles(linkage.guides, linkage.drives, guess)
    prescribed = {drive.body for drive in linkage.drives}
    prescribed -= set(linear_bodies(linkage.drives))
    prescribed |= {guide.body for guide in linkage.guides if not guide.is_moving}
    try:
        q = _closed(rows, np.zeros(1), _guessed(linkage)[np.newaxis]).q[0]
    except AssemblyError as error:
        hint = _hint_at_guess(linkage, prescribed)
        raise AssemblyError(f"{error}{hint}") from None
    for place, body in enumerate(linkage.bodies):
        if body.name not in prescribed:
            turns = (q[place, 2] - angles.get(body.name, 0.0)) / (2.0 * math.pi)
            q[place, 2] -= 2.0 * math.pi * np.round(turns)
    for name, angle in guess.items():
        result = float(q[linkage.index(name), 2])
        if abs(result - angle) > 0.5 * math.pi and name not in prescribed:
            raise AssemblyError(
                f"guess of {name} = {math.degrees(angle):.4g} deg: the linkage closes with it at "
                f"{math.degrees(result):.4g} deg; a guess within a right angle of the place that "
                "is meant is needed"
            )
    return q


def close(rows: Rows, time: Array, q: Array) -> Levels:
    """Close a linkage at some instants from positions close by.

    AssemblyError where it does not close names the joint and the crank angle.
    """
    zero = np.zeros_like(q)
    least = math.inf
    for _ in range(_STEPS):
        (phi,) = rows.errors(time, q)
        error = float(np.abs(phi).max(initial=0.0))
        if not error < 1e3 * rows.size:
            break
        # Round-off does not shrink any more.
        if error <= ROUND_OFF * rows.size or (
            error < 1e-12 * rows.size and error >= 0.5 * least
        ):
            break
        least = min(least, error)
        q = q - _solved(rows, time, q, phi)
    else:
        error = math.inf
    if not error < 1e-9 * rows.size:
        phi = np.abs(rows.errors(time, q)[0])
        phi = np.where(np.isfinite(phi), phi, math.inf)
        instant = int(phi.max(axis=1).argmax())
        row = int(phi[instant].argmax())
        if rows.repeated and phi[instant, row] < rows.size:
            raise _misfit(
                rows, float(time[instant]), rows.names[row], float(phi[instant, row])
            )
        raise _refusal(rows, float(time[instant]), rows.names[row])
    v = -_solved(rows, time, q, rows.errors(time, q, zero)[1])
    a = -_solved(rows, time, q, rows.errors(time, q, v, zero)[2])
    return Levels(q, v, a)


def _solved(rows: Rows, time: Array, q: Array, right: Array) -> Array:
    try:
        return rows.solve(q, right)
    except np.linalg.LinAlgError:
        raise stuck(rows, time, q) from None


def stuck(rows: Rows, time: Array, q: Array) -> AssemblyError:
    """Return the error of a linkage at a dead point."""
    _, values, right = np.linalg.svd(rows.jacobian(q) * rows.scale)
    worst = int(values[:, -1].argmin())
    # The motion that nothing holds: the joint whose bodies turn most against each
    # other, and of several that turn alike the last, which is farther from the drives.
    free = np.append((right[worst, -1] * rows.scale)[2::3], 0.0)
    turning = np.abs(free[rows.joined[0]] - free[rows.joined[1]])
    last = turning.size - 1 - int(turning[::-1].argmax()) if turning.size else 0
    return _refusal(rows, float(time[worst]), rows.names[2 * last])


def _misfit(rows: Rows, time: float, name: str, distance: float) -> AssemblyError:
    where = _place_of_drive(rows, time)
    return AssemblyError(
        f"the linkage is overconstrained: {_count(rows.linkage)}, {rows.repeated} too many, and "
        f"they do not fit each other: {where}{name} is off by {distance:.3g} m "
        "or rad; allowed are 1e-9 of the size of the linkage, or clearance in one of the joints"
    )


def _place_of_drive(rows: Rows, time: float) -> str:
    """Return where the first drive has its body, as the beginning of a message."""
    for drive in rows.linkage.drives:
        if drive.follow is None:
            place = float(drive.motion(np.array([time]))[0][0])
            if isinstance(drive, LinearDrive):
                return f"with {drive.body} at {1e3 * place:.4g} mm along {drive.along} "
            angle = math.degrees(abs(place - drive.angle))
            return f"at crank angle {angle:.1f} deg "
    return ""


def _refusal(rows: Rows, time: float, joint: str) -> AssemblyError:
    where = _place_of_drive(rows, time)
    following = [
        drive.name for drive in rows.linkage.drives if drive.follow is not None
    ]
    if following:
        return AssemblyError(
            f"{following[0]} cannot make its point follow the curve: {where}({time:.6g} s after "
            "the start) the point is out of reach, or the drive at a dead point"
        )
    return AssemblyError(
        f"the linkage cannot be assembled over the cycle: {where}joint {joint} does not close or "
        "is at a dead point"
    )
