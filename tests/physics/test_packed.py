"""Linkages packed for the kernels: every value in its place."""

import math
from dataclasses import replace

import numpy as np
import pytest
from two_bodies import JOINT, placed, waves, worn_joint

from presswear.linkage.elements import ClearanceJoint, WearLaw
from presswear.linkage.surface import Surface, bin_centres
from presswear.physics.foundation import CUBE, PIN, ROWS, SLOPE, SQUARE
from presswear.physics.packed import Packed


def packed(joint: ClearanceJoint) -> Packed:
    """Two bodies with a joint, packed."""
    return placed(joint, 0.0, 0.0).packed


def test_joint_holds_every_value() -> None:
    joint = worn_joint("body")
    record = packed(joint).joints[0]
    assert (record["bearing_body"], record["pin_body"]) == (0, 3)
    assert (record["bearing_x"], record["bearing_y"]) == (0.17, -0.03)
    assert (record["pin_x"], record["pin_y"]) == (-0.11, 0.05)
    assert record["pin_radius"] == record["bearing_radius"] - record["clearance"]
    depths = joint.bearing_surface.depth, joint.pin_surface.depth
    assert record["least_depth"] == depths[0].min() + depths[1].min()
    assert record["relief"] == np.ptp(depths[0]) + np.ptp(depths[1])
    assert (record["map_turns"], record["foundation"]) == (1.0, 0.0)
    record = packed(replace(JOINT, map_frame="fixed", contact="foundation")).joints[0]
    assert (record["map_turns"], record["least_depth"], record["relief"]) == (0.0, 0.0, 0.0)
    assert record["foundation"] > 0.0


@pytest.mark.parametrize(
    ("law", "expected"),
    [
        (WearLaw(3e-15, "angle", "bin", 0.2), (3e-15, 0.2, True, False)),
        (WearLaw(3e-15, "sliding", "arc", 0.2), (3e-15, 0.2, False, True)),
        (None, (0.0, 0.0, False, False)),
    ],
)
def test_joint_holds_its_law_of_wear(law: WearLaw | None, expected: tuple[float, ...]) -> None:
    record = packed(replace(JOINT, wear=law)).joints[0]
    names = "wear_coefficient", "bearing_share", "slip_by_angle", "over_arc"
    assert tuple(record[name] for name in names) == expected


def test_unworn_surfaces_pack_to_nothing() -> None:
    assert packed(JOINT).surfaces.shape == (1, ROWS, 0)
    flat = replace(JOINT, bearing_surface=Surface(np.zeros(16)))
    assert packed(flat).surfaces.shape == (1, ROWS, 0)


def test_one_worn_surface_packs_beside_an_unworn_one() -> None:
    surface = waves(20, 1e-5, 3)
    surfaces = packed(replace(JOINT, pin_surface=surface)).surfaces
    assert surfaces.shape == (1, ROWS, 20)
    assert not surfaces[0, :PIN].any()
    np.testing.assert_array_equal(surfaces[0, PIN], surface.depth)
    np.testing.assert_array_equal(surfaces[0, PIN + SLOPE], surface.slope)
    # The cubic behind each centre, read a third of a bin on.
    x = 2.0 * math.pi / 20 / 3.0
    rows = surfaces[0, PIN:]
    cubic = rows[0] + x * (rows[SLOPE] + x * (rows[SQUARE] + x * rows[CUBE]))
    assert cubic == pytest.approx(surface(bin_centres(20) + x), rel=1e-13)
