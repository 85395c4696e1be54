"""Wear by a power of the pressure: depths from the pressure at each angle, in every engine."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from bush import COEFFICIENT, WIDTH, bush, worn
from two_bodies import JOINT, Pair, placed, worn_joint
from worn_depths import fine_overlaps

import presswear as pw
from presswear.linkage.clearance_joint import ClearanceJoint
from presswear.linkage.materials import Materials
from presswear.linkage.wear_law import WearLaw
from presswear.physics.pressure_wear import LEAST_OVERLAP, deposit_by_pressure
from presswear.physics.wear import worn_volume
from presswear.tools.arrays import Array
from presswear.tools.errors import InputError

TURN = 2.0 * math.pi
SLIDING = np.array([0.1, -0.2, 3.0, 0.2, 0.1, -7.0])
REFERENCE = 4e6  # Pa
FOUNDATION = replace(worn_joint("body"), contact="foundation")


def _law(power: float, distribution: Any = "arc") -> WearLaw:
    return WearLaw(
        COEFFICIENT,
        "sliding",
        distribution,
        0.4,
        pressure_exponent=power,
        pressure_reference=REFERENCE,
    )


def _deposited(pair: Pair, count: int, integral: float) -> Array:
    """Return the depths that an integral of the wear gives, shape (2, count), m."""
    depth, shares = np.zeros((2, 2, count))
    record = pair.packed.joints[0]
    surfaces = pair.packed.surfaces[0]
    deposit_by_pressure(depth, record, surfaces, pair.contact(), integral, shares)
    assert not shares.any()
    return depth


def _expected(pair: Pair, count: int, power: float) -> Array:
    """Return K_d p (p / p_ref)^(m - 1) times the sliding speed, summed on a fine grid."""
    area = pair.joint.width * pair.joint.bearing_radius * TURN / (400 * count)
    result = []
    for share, overlap in zip((0.4, 0.6), fine_overlaps(pair, count), strict=True):
        pressure = pair.load(1e9).normal * overlap / overlap.sum() / area
        rate = COEFFICIENT * REFERENCE * (pressure / REFERENCE) ** power
        result.append(share * abs(pair.contact().sliding) * rate.mean(axis=1))
    return np.array(result)


@pytest.mark.parametrize("power", [0.3, 0.65, 2.0, 3.0])
@pytest.mark.parametrize(
    "joint",
    [JOINT, worn_joint("fixed", 360, 2e-6), FOUNDATION],
    ids=["round", "worn", "foundation"],
)
def test_each_angle_wears_by_its_pressure(joint: ClearanceJoint, power):
    joint = replace(joint, wear=_law(power))
    pair = placed(joint, 3e-6, 1.1, rates=SLIDING)
    expected = _expected(pair, 360, power)
    depth = _deposited(pair, 360, pair.wear_rates()[1])  # in a second
    # Gauss's rule is not exact where the pressure begins, as a power of the angle.
    np.testing.assert_allclose(depth, expected, rtol=0.0, atol=0.01 * expected.max())
    assert worn_volume(joint, depth) == pytest.approx(
        worn_volume(joint, expected), rel=5e-3
    )


@pytest.mark.parametrize("power", [0.3, 3.0])
def test_arcs_narrower_than_a_bin_wear_as_narrow_ones(power):
    """The wear of a step that ends open, or next to it, has no jump."""
    joint = replace(JOINT, wear=_law(power))
    totals = []
    for penetration in (1.05 * LEAST_OVERLAP, 0.95 * LEAST_OVERLAP, -1e-9):
        pair = placed(joint, penetration, 1.1)
        totals.append(_deposited(pair, 16, 2.0).sum())
    assert totals[0] == pytest.approx(totals[1], rel=0.06)
    assert totals[2] == totals[1] > 0.0


@pytest.mark.parametrize("power", [0.5, 2.5])
def test_one_bin_wears_by_the_mean_pressure(power):
    pair = placed(replace(JOINT, wear=_law(power, "bin")), 1e-5, 0.8, rates=SLIDING)
    archard = placed(replace(JOINT, wear=_law(1.0, "bin")), 1e-5, 0.8, rates=SLIDING)
    work, pressure_distance = archard.wear_rates()
    sliding = abs(archard.contact().sliding)
    pressure = pressure_distance / sliding
    expected = pressure_distance * (pressure / REFERENCE) ** (power - 1.0)
    assert pair.wear_rates() == pytest.approx((work, expected), rel=1e-12)


@pytest.mark.parametrize("engine", ["dae", "exudyn-tree", "exudyn-joints"])
def test_a_bush_wears_by_the_square_of_the_pressure(engine):
    """Steady rotation under a load: K_d / p_ref times the integral of p^2, in every engine.

    Over the arc of round surfaces the overlap is e cos - c, and the pressure is that
    times F / (b R integral). The contact slides by the circumference of the pin in a
    cycle, half of the penetration inside its radius of 19 mm.
    """
    scene = bush(engine=engine)
    pair = Materials(
        wear_coefficient=COEFFICIENT,
        bearing_share=1.0,
        pressure_exponent=2.0,
        pressure_reference=REFERENCE,
    )
    bearing = replace(scene.bearing("B"), materials=pair)
    run = worn(replace(scene, bearings={"B": bearing}), 1e-15, 2)
    distance = run.run.recorder.each_cycle("sliding_distance", 0)[-1]
    depth = (100.0 / 1e9) ** (2.0 / 3.0)
    assert distance == pytest.approx(TURN * (0.019 - 0.5 * depth), rel=1e-5)
    force = run.load_distance[-1] / distance
    assert force == pytest.approx(100.0, rel=0.01)
    clearance = bearing.clearance
    eccentricity = clearance + (force / 1e9) ** (2.0 / 3.0)
    half = math.acos(clearance / eccentricity)
    angle = np.linspace(-half, half, 20001)
    overlap = eccentricity * np.cos(angle) - clearance
    pressure = force * overlap / (WIDTH * 0.02 * np.trapezoid(overlap, angle))
    mean = np.trapezoid(pressure**2, angle) * WIDTH * 0.02 / (REFERENCE * force)
    gained = run.bush[-1].sum() * run.area
    expected = COEFFICIENT * mean * float(run.load_distance @ run.strokes)
    assert gained == pytest.approx(expected, rel=5e-3)


def test_settings_of_the_exponent():
    scene = pw.scenes.slider_crank(pressure_exponent=0.65)
    (joint,) = scene.linkage().clearances
    assert joint.wear is not None
    assert joint.wear.pressure_exponent == 0.65
    assert joint.wear.pressure_reference == 10e6
    assert "pressure_reference" not in scene.bearing("B").unread
    assert "pressure_reference" in pw.scenes.slider_crank().bearing("B").unread
    with pytest.raises(InputError, match=r"pressure_exponent = 4: allowed is 0.3 to 3"):
        pw.scenes.slider_crank(pressure_exponent=4.0)
