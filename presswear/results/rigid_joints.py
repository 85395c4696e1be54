"""Drives and joint forces of the linkage with rigid joints, with or without friction."""

from collections.abc import Sequence
from dataclasses import replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from presswear.linkage.clearance_joint import Bushing
from presswear.physics.inverse_dynamics import (
    constraint_forces,
    forces_in_motion,
    friction_corners,
    load_corners,
)
from presswear.physics.packed_loads import load_forces, pack_loads
from presswear.results.drive_duty import (
    DriveCurve,
    DriveDuty,
    drive_curves,
    duties_of,
    farthest_from_zero,
)
from presswear.scene.scene import Scene
from presswear.tools.arrays import Array
from presswear.tools.errors import RunFailed

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(3)
_PIECES = 720  # equal pieces of a cycle, over which torques are integrated
# Pieces of the previous cycle, through which the laws of loads follow the motion
_PIECES_BEFORE = 90


def rubbing_joints(scene: Scene) -> tuple[Bushing, ...]:
    """Return the pin joints with friction, whose laws act in rigid joints too.

    Empty if a friction law is source code that is stored in a result.
    """
    joints = scene.linkage().bushings
    laws = [joint.friction.user_law for joint in joints]
    if any(law is not None and not law.is_trusted for law in laws):
        return ()
    return joints


def rubbing_drives(scene: Scene) -> dict[str, DriveDuty]:
    """Return the duties of the drives of rigid joints with the friction of their bearings.

    Empty if no joint has friction, or if friction blocks the motion of rigid joints.
    """
    if not rubbing_joints(scene):
        return {}
    try:
        return ideal_drives(scene, rubs=True)
    except RunFailed:
        return {}


def ideal_drives(scene: Scene, rubs: bool = False) -> dict[str, DriveDuty]:
    """Return the duties of the drives of the linkage with rigid joints by their bodies.

    With ``rubs`` the joints have the friction of their bearings; RunFailed if it blocks
    the motion.
    """
    curves, weights = ideal_curves(scene, rubs)
    numbers = {}
    for body, curve in curves.items():
        numbers[body] = {
            "torque_integral": float(weights @ curve.torque),
            "torque_square_integral": float(weights @ curve.torque**2),
            "power_square_integral": float(weights @ curve.power**2),
            "work_given": float(weights @ np.maximum(curve.power, 0.0)),
            "work_returned": float(weights @ np.maximum(-curve.power, 0.0)),
            "torque_peak": farthest_from_zero(curve.torque),
            "power_peak": farthest_from_zero(curve.power),
        }
    return duties_of(numbers, float(weights.sum()))


@lru_cache(maxsize=16)  # a report uses the forces several times
def ideal_forces(scene: Scene) -> tuple[Array, dict[str, Array]]:
    """Return times in a cycle of rigid joints without friction, s, and the force of each pin, N.

    The forces are x + 1j y, shape (n,), on the first body. They are those of the second
    cycle after the run-up, because the laws of loads follow the motion in the first one.
    """
    linkage = scene.loaded
    time, is_last = _two_cycles(scene)
    components = constraint_forces(linkage, scene.ideal, time)[is_last]
    forces = {}
    for k, pin in enumerate(linkage.revolutes):
        x, y = components[:, 2 * k : 2 * k + 2].T
        forces[pin.name] = x + 1j * y
    return time[is_last], forces


def static_torques(scene: Scene) -> dict[str, float]:
    """Return the greatest torque of each drive under the work alone by its body, N m.

    For a drive along a guide it is a force, N. It follows from virtual work, with rigid
    joints and without friction, weight and inertia: the force of the work times the
    displacement of the output in a small motion of this drive alone. Empty without a
    process.
    """
    if scene.process is None:
        return {}
    linkage = scene.loaded
    work = linkage.loads_with_law[-len(scene.process_laws) :]
    loads = pack_loads(replace(linkage, loads=work))
    time, is_last = _two_cycles(scene)
    motion = scene.ideal.at(time)
    levels = np.array([motion.position, motion.velocity, motion.acceleration])
    forces = load_forces(loads, time, levels)[is_last, :, np.newaxis]
    position = motion.position[is_last].reshape(len(forces), -1, 3)
    reactions = scene.ideal.rows.forces(position, -forces)[..., 0]
    torques = np.abs(reactions[:, -len(linkage.drives) :]).max(axis=0)
    bodies = [drive.body for drive in linkage.drives]
    return dict(zip(bodies, torques.tolist(), strict=True))


def _two_cycles(scene: Scene) -> tuple[Array, NDArray[np.bool_]]:
    """Return times in two cycles after the run-up, s, and whether they are in the second.

    They include the corners of loads. The laws of loads follow the motion through the
    first cycle.
    """
    period = scene.mechanism.period
    equal = scene.run_up + np.linspace(0.0, 2.0 * period, 2 * _PIECES, endpoint=False)
    # A load can be shorter than a piece. Corners next to an equal instant add nothing.
    corners = load_corners(
        scene.loaded, scene.ideal, np.append(equal, scene.run_up + 2.0 * period)
    )
    gaps = np.abs(corners[:, np.newaxis] - equal).min(axis=1)
    time = np.union1d(equal, corners[gaps > 1e-3 * period / _PIECES])
    return time, time >= equal[_PIECES]


@lru_cache(maxsize=16)
def ideal_curves(
    scene: Scene, rubs: bool = False
) -> tuple[dict[str, DriveCurve], Array]:
    """Return the drives of rigid joints over a cycle after the run-up, by their bodies.

    The array holds the weights of the instants in an integral over the cycle, s. With
    ``rubs`` the joints have the friction of their bearings.
    """
    bushings = rubbing_joints(scene) if rubs else ()
    start = scene.run_up
    period = scene.mechanism.period
    # The laws of loads follow the motion through the previous cycle.
    previous_cycle = np.linspace(0.0, period, _PIECES_BEFORE + 1)
    cycle = np.linspace(0.0, period, _PIECES + 1)
    edges = start + np.concatenate([previous_cycle, period + cycle[1:]])
    corners = load_corners(scene.loaded, scene.ideal, edges)
    if bushings:
        turns = friction_corners(scene.loaded, scene.ideal, edges, bushings)
        corners = np.union1d(corners, turns)
    edges = np.union1d(edges, corners)
    # Supplied and returned energy have a kink where the power of a drive changes its
    # sign. An error of its place counts by its square.
    for curve in _curves_at(scene, edges, bushings).values():
        time = curve.time
        power = curve.power
        k = np.flatnonzero(power[1:] * power[:-1] < 0.0)
        zeros = time[k] - power[k] * np.diff(time)[k] / np.diff(power)[k]
        edges = np.union1d(edges, zeros)
    return _integrated(scene, edges, corners, bushings)


def _integrated(
    scene: Scene, edges: Array, corners: Array, bushings: Sequence[Bushing]
) -> tuple[dict[str, DriveCurve], Array]:
    """Return drives of rigid joints and Gauss weights, s, at instants of the last cycle.

    The Gauss points lie between ``edges``, s. A peak can be at a corner of a load: these
    ``corners``, s, are instants too, with the weight 0.
    """
    middle = 0.5 * (edges[1:] + edges[:-1])
    half = 0.5 * np.diff(edges)
    inner = (middle[:, np.newaxis] + half[:, np.newaxis] * _NODES).ravel()
    time = np.concatenate([inner, corners])
    weights = np.append(np.outer(half, _WEIGHTS).ravel(), np.zeros(corners.size))
    order = np.argsort(time, kind="stable")
    time = time[order]
    weights = weights[order]
    is_last = time > edges[-1] - scene.mechanism.period
    last_cycle = {}
    for body, curve in _curves_at(scene, time, bushings).items():
        last_cycle[body] = DriveCurve(*(values[is_last] for values in curve))
    return last_cycle, weights[is_last]


def _curves_at(
    scene: Scene, time: Array, bushings: Sequence[Bushing]
) -> dict[str, DriveCurve]:
    """Return drives of rigid joints at instants, s."""
    linkage = scene.loaded
    motion = scene.ideal.at(time)
    forces = forces_in_motion(linkage, scene.ideal, motion, bushings)
    return drive_curves(linkage, motion, forces[:, -len(linkage.drives) :])
