"""Wear of a bushing by a turning pin, compared with the geometry of two circles.

A round pin that has worn into a bushing has the eccentricity e. The removed material is
the lens between both circles. To first order in the ratio of clearance c to radius R
its depth at the angle phi from the load is e cos(phi) - c, over the arc where this is
positive. This holds for any depth, also far beyond the elastic indentation. Under a load
of fixed direction the turning pin wears evenly. Under a load that turns with the pin the
bushing wears evenly.

The model uses an arc with the radius of the bushing. The lens of circles with the radii
R and r is smaller by the factor sqrt(r / R), which is about 1 - c / (2 R).
"""

import math
from typing import Any

import numpy as np
import pytest
from bush import CLEARANCE, COEFFICIENT, CYCLE, FRICTION, WIDTH, Worn, bush, worn
from marks import slow
from scipy.optimize import brentq

import presswear as pw
from presswear.scene.options import Life
from presswear.tools.arrays import Array

# Direction of the force of the pin on a bushing that is pressed down, turned by the
# angle of friction, rad
TILT = 0.5 * math.pi - math.atan(FRICTION)


def area_over_radius(eccentricity: float, clearance: float) -> float:
    """Return the integral of e cos(phi) - c over the arc where it is positive, m."""
    half = math.acos(clearance / eccentricity)
    return 2.0 * (eccentricity * math.sin(half) - clearance * half)


def volume(radius: float, depth: float, clearance: float = CLEARANCE) -> float:
    """Return the worn volume at a largest depth, m^3."""
    return WIDTH * radius * area_over_radius(clearance + depth, clearance)


def depth(radius: float, worn_volume: float, clearance: float = CLEARANCE) -> float:
    """Return the largest depth at a worn volume, m."""

    def excess(depth: float) -> float:
        return volume(radius, depth, clearance) - worn_volume

    return float(brentq(excess, 1e-12, 5.0 * clearance, xtol=1e-15))


def profile(
    count: int, direction: float, eccentricity: float, clearance: float
) -> Array:
    """Return the mean of max(e cos(phi) - c, 0) in each bin, m."""
    half = math.acos(clearance / eccentricity)
    turn = 2.0 * math.pi
    angles = np.arange(count + 1) * turn / count - direction
    left = (angles[:-1] + math.pi) % turn - math.pi
    right = left + turn / count
    low = np.clip(left, -half, half)
    high = np.clip(right, -half, half)
    sums = eccentricity * (np.sin(high) - np.sin(low)) - clearance * (high - low)
    return np.asarray(sums * count / turn)


def lens(bearing: float, pin: float, eccentricity: float) -> float:
    """Return the area of the circle of the pin outside that of the bearing, m^2."""
    e = eccentricity
    r = pin
    s = bearing
    from_pin = math.acos((e * e + r * r - s * s) / (2.0 * e * r))
    from_bearing = math.acos((e * e + s * s - r * r) / (2.0 * e * s))
    kite = 0.5 * math.sqrt((-e + r + s) * (e + r - s) * (e - r + s) * (e + r + s))
    return math.pi * r * r - (r * r * from_pin + s * s * from_bearing - kite)


def check_lens(
    worn_depth: Array,
    area: float,
    radius: float,
    clearance: float,
    depth_bound: float,
    profile_bound: float,
) -> float:
    """Check largest depth and profile relative to the lens of equal volume.

    Return the relative error of the largest depth. ``area`` is that of a bin, m^2. The
    error of the profile is the root of the mean square.
    """
    angles = (np.arange(worn_depth.size) + 0.5) * 2.0 * math.pi / worn_depth.size
    direction = float(np.angle(worn_depth @ np.exp(1j * angles)))
    reached = depth(radius, float(worn_depth.sum()) * area, clearance)
    exact = profile(worn_depth.size, direction, clearance + reached, clearance)
    mean_square_error = np.mean((worn_depth - exact) ** 2)
    assert np.sqrt(mean_square_error / np.mean(exact**2)) < profile_bound
    error = float(worn_depth.max() / exact.max() - 1.0)
    assert abs(error) < depth_bound
    return error


def worn_to(part: float, radius: float, cycles: int, **settings: Any) -> Worn:
    """Run until the depth is about a part of the clearance."""
    goal = volume(radius, part * CLEARANCE)
    return worn(bush(radius, **settings), goal, cycles, 1.5)


@pytest.fixture(scope="module")
def worn_bush() -> Worn:
    """Bushing worn to half of the clearance, with a pin that does not wear."""
    return worn_to(0.5, 0.02, 100)


def relative_deviation(depth: Array) -> float:
    return float(depth.std() / depth.mean())


def test_a_bush_on_an_unworn_pin_has_the_lens_of_two_circles(worn_bush: Worn):
    """The largest depth holds from a tenth of the clearance on, the profile at the end."""
    area = worn_bush.area
    for cycle in (20, 40, 60, 80, 99):
        check_lens(worn_bush.bush[cycle], area, 0.02, CLEARANCE, 1.1e-3, 3.5e-3)
    check_lens(worn_bush.bush[99], area, 0.02, CLEARANCE, 1e-3, 1e-3)
    assert not worn_bush.pin.any()


def test_friction_turns_the_deepest_place_away_from_the_load(worn_bush: Worn):
    """The deepest place lies beside the load by the angle of friction."""
    bins = worn_bush.bush.shape[1]
    angles = (np.arange(bins) + 0.5) * 2.0 * math.pi / bins
    direction = float(np.angle(worn_bush.bush[-1] @ np.exp(1j * angles)))
    assert direction == pytest.approx(TILT, abs=1e-3)


def test_volume_follows_the_law_of_archard(worn_bush: Worn):
    """The law is V = K_d F s with the normal force F and the sliding distance s.

    The volume follows the recorded product F s of each cycle to round-off. The product
    is that of the recorded series.
    """
    gained = np.diff(worn_bush.bush.sum(axis=1), prepend=0.0) * worn_bush.area
    expected = COEFFICIENT * worn_bush.load_distance * worn_bush.strokes
    assert gained == pytest.approx(expected, rel=1e-11, abs=0.0)
    new = worn(bush(), volume(0.02, 1e-6 * CLEARANCE), 10, recorded=12)
    recorder = new.run.recorder
    force = recorder.series("normal", 0)[-1]
    distance = abs(recorder.series("sliding", 0)[-1]) * CYCLE
    assert new.load_distance[-1] == pytest.approx(force * distance, rel=1e-6)
    assert force == pytest.approx(100.0 / math.hypot(1.0, FRICTION), rel=1e-4)
    # The pin slides by its circumference, at a radius less half of the overlap.
    overlap = (force / 1e9) ** (2.0 / 3.0)
    radius = 0.019 - 0.5 * overlap
    assert distance == pytest.approx(2.0 * math.pi * radius, rel=1e-3)


def test_elastic_contact_widens_to_the_arc_of_two_circles(worn_bush: Worn):
    """The first arc follows from the elastic overlap, and the last from two circles."""
    fine = worn(bush(angles=1440), volume(0.02, 1e-5 * CLEARANCE), 8)
    force = fine.load_distance[-1] / (2.0 * math.pi * 0.019)
    overlap = (force / 1e9) ** (2.0 / 3.0)
    elastic = math.acos(CLEARANCE / (CLEARANCE + overlap))
    bin_width = 2.0 * math.pi / 1440
    reach = 0.5 * bin_width * np.count_nonzero(fine.bush[-1] - fine.bush[-2])
    assert reach == pytest.approx(elastic, abs=bin_width)
    arcs = np.count_nonzero(worn_bush.bush, axis=1) * math.pi / 120
    assert np.all(np.diff(arcs) >= 0.0)
    reached = depth(0.02, float(worn_bush.bush[-1].sum()) * worn_bush.area)
    expected = math.acos(CLEARANCE / (CLEARANCE + reached))
    assert arcs[-1] == pytest.approx(expected, abs=2.0 * math.pi / 120)
    assert arcs[-1] > 3.0 * elastic


def test_a_turning_pin_wears_evenly():
    """The load does not turn. The depth is V / (2 pi R b) at every angle."""
    result = worn(bush(share=0.0), volume(0.02, 0.1 * CLEARANCE), 60)
    assert relative_deviation(result.pin[-1]) < 1e-3
    lost = COEFFICIENT * float(result.load_distance @ result.strokes)
    expected = lost / (2.0 * math.pi * 0.02 * WIDTH)
    assert result.pin[-1].mean() == pytest.approx(expected, rel=1e-9, abs=0.0)
    assert not result.bush.any()


@pytest.mark.parametrize("turns", ["bush", "load"])
def test_a_bush_under_a_relatively_turning_load_wears_evenly(turns):
    settings: dict[str, Any] = {}
    if turns == "load":
        settings = {"load": 1e3, "stiffness": 1e10}
    result = worn(bush(turns=turns, **settings), volume(0.02, 0.05 * CLEARANCE), 60)
    assert relative_deviation(result.bush[-1]) < 1e-3
    assert not result.pin.any()


def test_a_pin_at_rest_in_a_turning_bush_has_the_lens_of_two_circles():
    scene = bush(share=0.0, turns="bush")
    result = worn(scene, volume(0.02, 0.5 * CLEARANCE), 100, 1.5)
    check_lens(result.pin[-1], result.area, 0.02, CLEARANCE, 1e-3, 3e-3)


def test_both_surfaces_wear_by_their_shares():
    """The pin wears evenly. The bushing has the lens of a pin of the smaller radius."""
    result = worn(bush(share=0.4), volume(0.02, 0.3 * CLEARANCE) / 0.4, 100, 1.5)
    bearing = result.bush[-1]
    pin = result.pin[-1]
    lost = bearing.sum() + pin.sum()
    assert bearing.sum() == pytest.approx(0.4 * lost, rel=1e-12, abs=0.0)
    assert relative_deviation(pin) < 1e-2
    clearance = CLEARANCE + pin.mean()
    check_lens(bearing, result.area, 0.02, clearance, 1e-3, 3e-3)


@pytest.mark.parametrize("radius", [1.0, 0.0025], ids=["1 to 1000", "2 to 5"])
def test_any_ratio_of_radii(radius):
    """The worn volume is larger than that of two circles by the factor sqrt(R / r)."""
    result = worn_to(0.5, radius, 100)
    bearing = result.bush[-1]
    error = check_lens(bearing, result.area, radius, CLEARANCE, 1e-3, 1e-3)
    lost = float(bearing.sum()) * result.area
    eccentricity = CLEARANCE + depth(radius, lost) * (1.0 + error)
    pin = radius - CLEARANCE
    exact = WIDTH * lens(radius, pin, eccentricity)
    allowed = 1e-3 + 0.2 * (CLEARANCE / radius) ** 2
    assert lost / exact == pytest.approx(math.sqrt(radius / pin), rel=allowed)


@pytest.mark.slow
@pytest.mark.parametrize("engine", ["dae", "exudyn-tree"])
def test_a_life_ends_at_the_strokes_of_archard(engine):
    """The strokes agree within 1e-3 and the error that the life states."""
    part = 0.3
    count = 120
    goal = part * CLEARANCE
    limits = Life(until=f"B.depth > {goal!r} m", at_most=1e12)
    scene = bush(
        life=limits,
        engine=engine,
        replicates=2,
        wear_updates=1,
        cycles=8,
        tolerance=0.1,
    )
    result = pw.run(scene)
    life = result.life
    assert life is not None
    assert life.ended == "limit"
    assert life.error is not None

    def excess(depth: float) -> float:
        bins = profile(count, TILT, CLEARANCE + depth, CLEARANCE)
        return float(bins.max()) - goal

    # The depth of two circles at which the deepest bin reaches the limit
    limit = float(brentq(excess, goal, 1.1 * goal))
    load_distance = result.stages[0].joints["B"].each_cycle("load_distance")[-1]
    expected = volume(0.02, limit) / (COEFFICIENT * load_distance)
    assert life.strokes == pytest.approx(expected, rel=1e-3 + life.error)
    assert life.error < 5e-3


@pytest.mark.parametrize("engine", ["exudyn-tree", slow("exudyn-joints")])
def test_engines_of_exudyn(engine):
    """The lens is that of two circles, and the volume follows Archard's law to round-off."""
    result = worn_to(0.3, 0.02, 60, engine=engine, angles=90)
    check_lens(result.bush[-1], result.area, 0.02, CLEARANCE, 1e-3, 3e-3)
    lost = float(result.bush[-1].sum()) * result.area
    expected = COEFFICIENT * float(result.load_distance @ result.strokes)
    assert lost == pytest.approx(expected, rel=1e-11, abs=0.0)
