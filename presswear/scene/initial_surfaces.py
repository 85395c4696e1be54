"""Initial surfaces of a scene: depths from the user, on the bins of the wear maps."""

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswear.linkage.clearance_joint import SurfaceContact
from presswear.linkage.guide_corner import WALL_BINS, WALLS
from presswear.linkage.joints import Guide
from presswear.linkage.surface import SIDES, Surface, bin_centres
from presswear.scene.bearing import MIN_ANGLES, Bearing
from presswear.scene.guide_clearance import deepest_wall
from presswear.scene.pin_joints import deepest_joint_wear
from presswear.tools.arrays import Array
from presswear.tools.errors import InputError, unknown
from presswear.tools.quantities import written

Surfaces = Mapping[str, tuple[Any, Any]]
"""Bearing and pin by joint, left and right wall by guide; see ``Scene.surfaces``."""
_TURN = 2.0 * math.pi
_EQUAL_ANGLES = 1e-9  # largest difference of angles that count as equal, rad
_ROUND_OFF = 1e-6  # relative error of a gap between two angles


def initial_surfaces(
    surfaces: Any,
    joints: tuple[str, ...],
    guides: Sequence[Guide],
    bearing: Callable[[str], Bearing],
    contact: SurfaceContact,
) -> dict[str, tuple[Surface, Surface]]:
    """Return the initial surfaces on the bins of the wear maps, without round joints.

    ``joints`` have clearance, and ``guides`` are those of them whose walls have maps.
    """
    guides_by_name = {guide.name: guide for guide in guides}
    if not isinstance(surfaces, Mapping):
        raise InputError(
            f"surfaces = {surfaces!r}: bearing and pin by joint are expected"
        )
    result = {}
    for name, pair in surfaces.items():
        if not joints:
            raise InputError(f"surfaces of {name}: no joint of the scene has clearance")
        if name not in joints:
            raise unknown("joint in surfaces", name, joints)
        guide = guides_by_name.get(name)
        sides = SIDES if guide is None else WALLS
        if not isinstance(pair, tuple | list) or len(pair) != len(sides):
            raise InputError(
                f"surfaces of {name}: a pair, {' and '.join(sides)}, is expected"
            )
        of_sides = []
        for side, value in zip(sides, pair, strict=True):
            where = f"{side} at {name}"
            if guide is None:
                of_sides.append(_surface(where, value, bearing(name), contact))
            else:
                of_sides.append(_wall(where, value, bearing(name), guide))
        first, second = of_sides
        if first.is_worn or second.is_worn:
            result[name] = first, second
    return result


def _first_true(condition: NDArray[np.bool_]) -> int | None:
    """Return the index of the first true element; None if there is none."""
    return int(condition.argmax()) if condition.any() else None


def _surface(
    where: str, value: Any, bearing: Bearing, contact: SurfaceContact
) -> Surface:
    """Return one side on the bins of its joint; an empty surface if it is round."""
    if value is None:
        return Surface()
    angle, depth = _points_of(where, value)
    if not depth.any():
        return Surface()
    deepest = deepest_joint_wear(bearing, contact)
    k = _first_true((depth < 0.0) | (depth > deepest))
    if k is not None:
        place = f"depth {written(depth[k], 'm')} at {math.degrees(angle[k]):g} deg"
        allowed = f"allowed is 0 to {written(deepest, 'm')}"
        raise InputError(f"{where}: {place}: {allowed}")
    _check_angles(where, angle)
    bins = bin_centres(bearing.angles)
    if angle.size == bins.size and np.allclose(angle, bins, 0.0, _EQUAL_ANGLES):
        return Surface(depth)
    return Surface(_means_of_bins(angle, depth, bins.size))


def _wall(where: str, value: Any, bearing: Bearing, guide: Guide) -> Surface:
    """Return a wall of a guide on the bins of its map; an empty surface if it is flat."""
    surface = value if isinstance(value, Surface) else _surface_of(value)
    depth = surface.depth
    if depth.size not in (0, WALL_BINS):
        raise InputError(
            f"{where}: {depth.size} depths; allowed are {WALL_BINS}, of equal bins along the wall"
        )
    deepest = deepest_wall(bearing, guide)
    k = _first_true((depth < 0.0) | (depth > deepest))
    if k is not None:
        raise InputError(
            f"{where}: depth {written(depth[k], 'm')} in bin {k}: allowed is 0 to "
            f"{written(deepest, 'm')}"
        )
    return surface if surface.is_worn else Surface()


def _surface_of(value: Any) -> Surface:
    """Return the surface of depths as a user or a stored scene gives them."""
    if value is None:
        return Surface()
    depth: Any = value.get("depth") if isinstance(value, Mapping) else value
    return Surface(depth)


def _points_of(where: str, value: Any) -> tuple[Array, Array]:
    """Return angles in [0, 2 pi), in order, and depths, m, of one side."""
    if isinstance(value, Mapping):  # as stored
        value = value.get("depth")
    if isinstance(value, Surface):
        value = value.depth
    try:
        values = np.array(value)
    except ValueError:
        values = np.array(None)  # rows of several lengths
    if values.shape == (0,):
        return np.zeros(0), np.zeros(0)
    if values.ndim == 1:
        values = np.column_stack([bin_centres(values.size), values])
    is_table = values.ndim == 2 and values.shape[1] == 2
    if not (values.dtype.kind in "fiu" and is_table and np.isfinite(values).all()):
        raise InputError(
            f"{where}: finite depths, or rows of angle and depth, are expected"
        )
    order = np.argsort(values[:, 0] % _TURN, kind="stable")
    angle, depth = values[order].T
    return angle % _TURN, depth


def _means_of_bins(angle: Array, depth: Array, count: int) -> Array:
    """Return the mean depths of bins, m, of the monotone cubic through the points.

    The cubic is the curve of ``Surface``, and its means conserve the worn volume.
    """
    from scipy.interpolate import PchipInterpolator  # slow to import

    # Three neighbours beyond both ends close the curve.
    around = np.concatenate([angle[-3:] - _TURN, angle, angle[:3] + _TURN])
    depths = np.concatenate([depth[-3:], depth, depth[:3]])
    # slopes of depths that are almost zero may overflow
    with np.errstate(over="ignore"):
        curve = PchipInterpolator(around, depths)
    edges = np.linspace(0.0, _TURN, count + 1)
    means = np.diff(curve.antiderivative()(edges)) * count / _TURN
    return np.maximum(means, 0.0)


def _check_angles(where: str, angle: Array) -> None:
    """Raise InputError if two angles are equal, or the gap between neighbours is too wide.

    The angles are in [0, 2 pi), in order.
    """
    widest = _TURN / MIN_ANGLES
    gaps = np.diff(angle, append=angle[0] + _TURN)
    k = _first_true(gaps < _EQUAL_ANGLES)
    if k is not None:
        raise InputError(
            f"{where}: the angle {math.degrees(angle[k]):g} deg occurs twice"
        )
    k = _first_true(gaps > widest * (1.0 + _ROUND_OFF))
    if k is not None:
        low, high = np.degrees([angle[k], angle[k] + gaps[k]])
        gap = f"{angle.size} angles, none between {low:g} and {high:g} deg"
        raise InputError(
            f"{where}: {gap}; allowed is a gap of {math.degrees(widest):g} deg"
        )
