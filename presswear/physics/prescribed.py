"""Bodies whose motion is known beforehand: driven cranks hinged to the frame.

They turn about a fixed point as their drives say, so that no equation has to be
solved for them; what their drives have to do follows from the forces on them.
"""

import math

import numpy as np
from numpy.typing import NDArray

from presswear.linkage.elements import GROUND, Linkage
from presswear.linkage.topology import hinge_of
from presswear.physics.motion import MOTION, drive_motion, pack_motion
from presswear.tools.compiled import Records, compiled

Array = NDArray[np.float64]

CRANK = np.dtype(
    [
        ("body", np.int64),  # index of its x in q
        ("hinge_x", np.float64),  # on the frame, m
        ("hinge_y", np.float64),
        ("local_x", np.float64),  # the same point in the body's frame, m
        ("local_y", np.float64),
        ("inertia", np.float64),  # about the hinge, kg m^2
        ("drive", MOTION),
    ]
)
"""A prescribed body as the kernels see it, in the order of ``Linkage.drives``."""


@compiled
def place_cranks(cranks: Records, t: float, q: Array, v: Array, a: Array, axes: Array) -> None:
    """Fill coordinates, rates and accelerations of the prescribed bodies at a time, s.

    Parameters
    ----------
    axes : ndarray, shape (3 bodies,)
        Cosine and sine of each body's angle, in the places of its x and y.
    """
    for i in range(cranks.shape[0]):
        crank = cranks[i]
        b = crank.body
        turned, speed, faster = drive_motion(crank.drive, t)
        theta = crank.drive.angle + turned
        cosine = math.cos(theta)
        sine = math.sin(theta)
        axes[b] = cosine
        axes[b + 1] = sine
        rx = -(cosine * crank.local_x - sine * crank.local_y)
        ry = -(sine * crank.local_x + cosine * crank.local_y)
        q[b] = crank.hinge_x + rx
        q[b + 1] = crank.hinge_y + ry
        q[b + 2] = theta
        v[b] = -speed * ry
        v[b + 1] = speed * rx
        v[b + 2] = speed
        a[b] = -speed * speed * rx - faster * ry
        a[b + 1] = -speed * speed * ry + faster * rx
        a[b + 2] = faster


@compiled
def drive_torque(crank: Records, q: Array, force: Array) -> float:
    """Torque, N m, that a drive must give against the generalized forces on its body.

    Those of its inertia are among them.
    """
    b = crank.body
    rx = q[b] - crank.hinge_x
    ry = q[b + 1] - crank.hinge_y
    moment: float = force[b + 2] + rx * force[b + 1] - ry * force[b]
    return -moment


@compiled
def forced_power(cranks: Records, v: Array, a: Array, force: Array) -> float:
    """Power, W, of the generalized forces on the prescribed bodies, less what speeds them up."""
    power = 0.0
    for i in range(cranks.shape[0]):
        b = cranks[i].body
        for c in range(b, b + 3):
            power += force[c] * v[c]
        power -= cranks[i].inertia * a[b + 2] * v[b + 2]
    return power


def pack_cranks(linkage: Linkage, bodies: frozenset[str]) -> Records:
    """The drives of the given bodies, each hinged to the frame, as records of CRANK."""
    drives = [drive for drive in linkage.drives if drive.body in bodies]
    cranks = np.zeros(len(drives), CRANK)
    for record, drive in zip(cranks, drives, strict=True):
        hinge = hinge_of(linkage, drive.body)
        if hinge is None:
            raise ValueError(f"{drive.body} has a drive but no hinge on the frame")
        on_frame, on_body = hinge.first, hinge.second
        if on_frame.body != GROUND:
            on_frame, on_body = on_body, on_frame
        record["body"] = 3 * linkage.index(drive.body)
        record["hinge_x"], record["hinge_y"] = on_frame.x, on_frame.y
        record["local_x"], record["local_y"] = on_body.x, on_body.y
        pack_motion(linkage, drive, record["drive"])
        body = linkage.bodies[linkage.index(drive.body)]
        record["inertia"] = body.inertia + body.mass * (on_body.x**2 + on_body.y**2)
    return cranks
