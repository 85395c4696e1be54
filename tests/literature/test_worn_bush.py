"""A pin that turns in a bush wears what the geometry of two circles says, in every engine.

A round pin worn into a bush as far as to the eccentricity e leaves the lens of its own
circle outside the bush's: to first order in the ratio of clearance c to radius R its
depth at an angle is e cos - c, over the arc where that is above zero, whatever the
depth, far beyond indentation.  Under a load of fixed direction the pin loses evenly,
and under one that turns with it the bush does.

The arc of the model is of the bush's radius.  Circles of radii R and r have a lens
whose area is smaller as sqrt(r / R): by c / 2 R.
"""

import math
from typing import Any

import numpy as np
import pytest
from bush import CLEARANCE, COEFFICIENT, CYCLE, FRICTION, WIDTH, Worn, bush, worn
from scipy.optimize import brentq

import presswear as pw
from presswear.scene.options import Life
from presswear.tools.arrays import Array

# Direction in which the pin presses on a bush that is pressed down, rad: friction tilts
# it.
TILT = 0.5 * math.pi - math.atan(FRICTION)


def integral(eccentricity: float, clearance: float) -> float:
    half = math.acos(clearance / eccentricity)
    return 2.0 * (eccentricity * math.sin(half) - clearance * half)


def volume(radius: float, depth: float, clearance: float = CLEARANCE) -> float:
    return WIDTH * radius * integral(clearance + depth, clearance)


def depth(radius: float, worn_volume: float, clearance: float = CLEARANCE) -> float:
    reach = 5.0 * clearance
    return float(
        brentq(
            lambda d: volume(radius, d, clearance) - worn_volume,
            1e-12,
            reach,
            xtol=1e-15,
        )
    )


def profile(
    count: int, direction: float, eccentricity: float, clearance: float
) -> Array:
    """Means over bins of what e cos - c leaves above zero, m."""
    half = math.acos(clearance / eccentricity)
    ends = (np.arange(count + 1) * 2.0 * math.pi / count - direction + math.pi) % (
        2.0 * math.pi
    )
    ends -= math.pi
    left = ends[:-1]
    right = left + 2.0 * math.pi / count
    low = np.clip(left, -half, half)
    high = np.clip(right, -half, half)
    sums = eccentricity * (np.sin(high) - np.sin(low)) - clearance * (high - low)
    return np.asarray(sums * count / (2.0 * math.pi))


def lens(bearing: float, pin: float, eccentricity: float) -> float:
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
    deepest: float,
    whole: float,
) -> float:
    """Check largest depth and profile (rms) relative to the lens of equal volume."""
    angles = (np.arange(worn_depth.size) + 0.5) * 2.0 * math.pi / worn_depth.size
    direction = float(np.angle(worn_depth @ np.exp(1j * angles)))
    reached = depth(radius, float(worn_depth.sum()) * area, clearance)
    exact = profile(worn_depth.size, direction, clearance + reached, clearance)
    assert np.sqrt(np.mean((worn_depth - exact) ** 2) / np.mean(exact**2)) < whole
    error = float(worn_depth.max() / exact.max() - 1.0)
    assert abs(error) < deepest
    return error


def worn_to(part: float, radius: float, cycles: int, **settings: Any) -> Worn:
    goal = volume(radius, part * CLEARANCE)
    return worn(bush(radius, **settings), goal, cycles, 1.5)


@pytest.fixture(scope="module")
def alone() -> Worn:
    return worn_to(0.5, 0.02, 100)


def uneven(found: Array) -> float:
    return float(found.std() / found.mean())


def test_a_bush_alone_is_worn_as_two_circles_say(alone: Worn) -> None:
    """Depth over volume from a tenth of the clearance on, and all of the profile at last."""
    for cycle in (20, 40, 60, 80, 99):
        check_lens(alone.bush[cycle], alone.area, 0.02, CLEARANCE, 1.1e-3, 3.5e-3)
    check_lens(alone.bush[99], alone.area, 0.02, CLEARANCE, 1e-3, 1e-3)
    assert not alone.pin.any()


def test_the_deepest_place_lies_where_friction_turns_the_load(alone: Worn) -> None:
    """Off the load by the angle of friction."""
    angles = (
        (np.arange(alone.bush.shape[1]) + 0.5) * 2.0 * math.pi / alone.bush.shape[1]
    )
    direction = float(np.angle(alone.bush[-1] @ np.exp(1j * angles)))
    assert direction == pytest.approx(TILT, abs=1e-3)


def test_volume_grows_as_archard_says(alone: Worn) -> None:
    """V = K_d F s: by the dose of each cycle to round-off, and that is force times way."""
    gained = np.diff(alone.bush.sum(axis=1), prepend=0.0) * alone.area
    assert gained == pytest.approx(
        COEFFICIENT * alone.load_distance * alone.strokes, rel=1e-11, abs=0.0
    )
    new = worn(bush(), volume(0.02, 1e-6 * CLEARANCE), 10, recorded=12)
    recorder = new.run.recorder
    force = recorder.series("normal", 0)[-1]
    way = abs(recorder.series("sliding", 0)[-1]) * CYCLE
    assert new.load_distance[-1] == pytest.approx(force * way, rel=1e-6)
    assert force == pytest.approx(100.0 / math.hypot(1.0, FRICTION), rel=1e-4)
    # Its own turning, at the radius of a pin indented by half the overlap.
    overlap = (force / 1e9) ** (2.0 / 3.0)
    assert way == pytest.approx(2.0 * math.pi * (0.019 - 0.5 * overlap), rel=1e-3)


def test_contact_begins_indented_and_widens(alone: Worn) -> None:
    """Half the arc is that of the elastic overlap when new, and that of two circles when worn."""
    fine = worn(bush(angles=1440), volume(0.02, 1e-5 * CLEARANCE), 8)
    force = fine.load_distance[-1] / (2.0 * math.pi * 0.019)
    overlap = (force / 1e9) ** (2.0 / 3.0)
    elastic = math.acos(CLEARANCE / (CLEARANCE + overlap))
    bin_width = 2.0 * math.pi / 1440
    reach = 0.5 * bin_width * np.count_nonzero(fine.bush[-1] - fine.bush[-2])
    assert reach == pytest.approx(elastic, abs=bin_width)
    arcs = np.count_nonzero(alone.bush, axis=1) * math.pi / 120
    assert np.all(np.diff(arcs) >= 0.0)
    reached = depth(0.02, float(alone.bush[-1].sum()) * alone.area)
    assert arcs[-1] == pytest.approx(
        math.acos(CLEARANCE / (CLEARANCE + reached)), abs=2.0 * math.pi / 120
    )
    assert arcs[-1] > 3.0 * elastic


def test_a_pin_alone_is_worn_evenly() -> None:
    """It turns under a load that does not: V / 2 pi R b everywhere."""
    own = worn(bush(share=0.0), volume(0.02, 0.1 * CLEARANCE), 60)
    assert uneven(own.pin[-1]) < 1e-3
    even = (
        COEFFICIENT
        * float(own.load_distance @ own.strokes)
        / (2.0 * math.pi * 0.02 * WIDTH)
    )
    assert own.pin[-1].mean() == pytest.approx(even, rel=1e-9, abs=0.0)
    assert not own.bush.any()


@pytest.mark.parametrize("turns", ["bush", "load"])
def test_a_bush_is_worn_evenly(turns: Any) -> None:
    """It turns under a load that does not, or the load turns."""
    settings: dict[str, Any] = (
        {"load": 1e3, "stiffness": 1e10} if turns == "load" else {}
    )
    own = worn(bush(turns=turns, **settings), volume(0.02, 0.05 * CLEARANCE), 60)
    assert uneven(own.bush[-1]) < 1e-3
    assert not own.pin.any()


def test_a_pin_at_rest_is_worn_as_two_circles_say() -> None:
    """The bush turns about it."""
    own = worn(bush(share=0.0, turns="bush"), volume(0.02, 0.5 * CLEARANCE), 100, 1.5)
    check_lens(own.pin[-1], own.area, 0.02, CLEARANCE, 1e-3, 3e-3)


def test_both_are_worn_by_their_shares() -> None:
    """The pin evenly, and the bush as by a pin that is so much smaller."""
    own = worn(bush(share=0.4), volume(0.02, 0.3 * CLEARANCE) / 0.4, 100, 1.5)
    lost = own.bush[-1].sum() + own.pin[-1].sum()
    assert own.bush[-1].sum() == pytest.approx(0.4 * lost, rel=1e-12, abs=0.0)
    assert uneven(own.pin[-1]) < 1e-2
    check_lens(own.bush[-1], own.area, 0.02, CLEARANCE + own.pin[-1].mean(), 1e-3, 3e-3)


@pytest.mark.parametrize("radius", [1.0, 0.0025], ids=["1 to 1000", "2 to 5"])
def test_any_ratio_of_radii(radius: float) -> None:
    """Depth over volume to first order in the clearance; of circles, the less by sqrt(r / R)."""
    own = worn_to(0.5, radius, 100)
    deepest = check_lens(own.bush[-1], own.area, radius, CLEARANCE, 1e-3, 1e-3)
    lost = float(own.bush[-1].sum()) * own.area
    eccentricity = CLEARANCE + depth(radius, lost) * (1.0 + deepest)
    pin = radius - CLEARANCE
    exact = WIDTH * lens(radius, pin, eccentricity)
    ratio = CLEARANCE / radius
    assert lost / exact == pytest.approx(
        math.sqrt(radius / pin), rel=1e-3 + 0.2 * ratio**2
    )


@pytest.mark.slow
@pytest.mark.parametrize("engine", ["dae", "exudyn-tree"])
def test_a_life_ends_where_two_circles_say(engine: str) -> None:
    """Archard's strokes to a depth, within what the life says of its own error and 1e-3."""
    part = 0.3
    count = 120
    goal = part * CLEARANCE
    life = Life(until=f"B.depth > {goal!r} m", at_most=1e12)
    scene = bush(
        life=life, engine=engine, replicates=2, wear_updates=1, cycles=8, tolerance=0.1
    )
    result = pw.run(scene)
    found = result.life
    assert found is not None
    assert found.ended == "limit"
    assert found.error is not None

    def deepest(reached: float) -> float:
        return float(profile(count, TILT, CLEARANCE + reached, CLEARANCE).max()) - goal

    reached = brentq(deepest, goal, 1.1 * goal)
    load_distance = result.stages[0].joints["B"].each_cycle("load_distance")[-1]
    wanted = volume(0.02, float(reached)) / (COEFFICIENT * load_distance)
    assert found.strokes == pytest.approx(wanted, rel=1e-3 + found.error)
    assert found.error < 5e-3


@pytest.mark.parametrize("engine", ["exudyn-tree", "exudyn-joints"])
def test_engines_of_exudyn(engine: str) -> None:
    """Worn to a third of the clearance: the same lens, and the account to round-off."""
    own = worn_to(0.3, 0.02, 60, engine=engine, angles=90)
    check_lens(own.bush[-1], own.area, 0.02, CLEARANCE, 1e-3, 3e-3)
    lost = float(own.bush[-1].sum()) * own.area
    assert lost == pytest.approx(
        COEFFICIENT * float(own.load_distance @ own.strokes), rel=1e-11, abs=0.0
    )
