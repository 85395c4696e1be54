"""Loads in the kernels, compared with the interpolation of numpy and with definitions of laws."""

import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from presswear.linkage.bodies import Body
from presswear.linkage.linkage import Linkage, assemble
from presswear.linkage.load_laws import Law, OverPosition, OverTime, Sense
from presswear.linkage.loads import Force, Moment
from presswear.physics.load_transitions import place_loads, settle_loads
from presswear.physics.loads import RAMP_SPEED, Loads, load_motion, load_size
from presswear.physics.packed import pack

BODY = Body("body", 1.0, 1.0, {"tip": (0.2, -0.1)})
SPACES = st.lists(st.floats(0.05, 2.0), min_size=2, max_size=6)
SIZES = st.lists(st.floats(-9.0, 9.0), min_size=7, max_size=7)


def linkage_of(law: Law, turning: bool = False) -> Linkage:
    load = Moment("body", law) if turning else Force("body.tip", 0.4, law)
    return assemble([BODY], loads=[load], cycle=2.0)


def packed_of(law: Law, turning: bool = False) -> Loads:
    return pack(linkage_of(law, turning)).loads


def settle(packed: Loads, t: float, s: float, v: float, a: float = 0.0) -> None:
    """Update the modes at an angle of the body, its speed and its acceleration."""
    position = np.array([0.0, 0.0, s])
    velocity = np.array([0.0, 0.0, v])
    acceleration = np.array([0.0, 0.0, a])
    settle_loads(packed, t, position, velocity, acceleration)


def size(packed: Loads, t: float, s: float, v: float) -> float:
    """Return the size at a position in the table and a speed, with the signs of the user."""
    record = packed.records[0]
    sign = float(record["cosine"]) if record["turns"] else 1.0
    mode = packed.modes[0]
    return sign * load_size(record, packed.nodes, mode, t, sign * s, sign * v)


def table_of(spaces: list[float], sizes: list[float]) -> NDArray[np.float64]:
    """Places and sizes of a table, shape (2, n)."""
    return np.array([np.cumsum(spaces) - 1.0, sizes[: len(spaces)]])


@pytest.mark.parametrize(("sense", "sign"), [("along", 1.0), ("against", -1.0)])
def test_in_one_sense_a_load_grows_with_speed_and_never_drives(sense: Sense, sign):
    law = OverPosition([(0.0, -sign * 4.0)], sense=sense, outside="hold")
    packed = packed_of(law, turning=True)
    place_loads(packed, np.zeros(3), np.zeros(3))
    for speed in (-3e-3, -5e-4, 0.0, 2e-4, 1e-3, 5.0, 5e-4, -5e-4, -2e-3, 5e-4):
        settle(packed, 0.0, 0.3, speed)
        ramp = min(max(sign * speed / RAMP_SPEED, 0.0), 1.0)
        result = size(packed, 0.0, 0.3, speed)
        assert result == pytest.approx(-sign * 4.0 * ramp)
        assert result * speed <= 0.0


def sign_of(sense: Sense) -> float:
    return 1.0 if sense == "along" else -1.0


def plastic(
    spaces: list[float], sizes: list[float], ratio: float, sense: Sense, release: bool
) -> OverPosition:
    """Return a law of a resistance from a table, with an elastic line.

    ``ratio`` is the slope of the elastic line over the steepest slope of the table.
    """
    places, values = table_of(spaces, [0.0, *np.abs(sizes).tolist()])
    slopes = np.diff(values) / np.diff(places)
    unloading = ratio * max(float(slopes.max()), 0.1)
    sign = sign_of(sense)
    table = sorted(np.column_stack([sign * places, -sign * values]).tolist())
    return OverPosition(table, sense, "hold", release=release, unloading=unloading)


def rows_of(law: OverPosition) -> NDArray[np.float64]:
    """Return places in the sense of a law, and its resistance there while loading, (2, n)."""
    sign = sign_of(law.sense)
    rows = []
    for place, value in law.table:
        rows.append((sign * place, -sign * value))
    return np.array(sorted(rows)).T


def resistances(law: OverPosition, walk: list[float]) -> list[float]:
    """Return the resistance along a walk that starts before the table, by its definition."""
    places, values = rows_of(law)
    deepest = -math.inf
    is_broken = False
    result = []
    for s in walk:
        if s <= places[0]:
            deepest = -math.inf
            is_broken = False
        deepest = max(deepest, s)
        is_broken = is_broken or (law.release and s >= places[-1])
        line = np.interp(deepest, places, values) - law.unloading * (deepest - s)
        result.append(0.0 if is_broken else max(float(line), 0.0))
    return result


SENSES = st.sampled_from(["along", "against"])
TURNS = st.lists(st.floats(-1.5, 12.0), min_size=1, max_size=12)


@given(SPACES, SIZES, st.floats(1.0, 20.0), SENSES, st.booleans(), TURNS)
def test_resistance_with_an_elastic_line_takes_work(
    spaces,
    sizes,
    ratio,
    sense: Sense,
    release,
    turns,
):
    """The motion turns at random places, and ends where it starts, before the table."""
    law = plastic(spaces, sizes, ratio, sense, release)
    sign = sign_of(sense)
    places, values = rows_of(law)
    outside = places[0] - 1.0
    # The resistance may have a corner at nodes, deepest places, and ends of elastic
    # lines.
    corners = [*places, places[-1] - 1e-9, *turns]
    for s in turns:
        corners.append(s - float(np.interp(s, places, values)) / law.unloading)
    packed = packed_of(law, turning=True)
    place_loads(packed, np.array([0.0, 0.0, sign * outside]), np.zeros(3))
    walk = [outside]
    result = [0.0]
    for start, end in pairwise([outside, *turns, outside]):
        speed = math.copysign(1.0, end - start)
        settle(packed, 0.0, sign * start, 0.0, sign * speed)
        between = {s for s in corners if min(start, end) < s < max(start, end)}
        for s in [*sorted(between, reverse=speed < 0.0), end]:
            settle(packed, 0.0, sign * s, sign * speed)
            walk.append(s)
            result.append(-sign * size(packed, 0.0, sign * s, sign * speed))
    assert result == pytest.approx(resistances(law, walk), abs=1e-7)
    assert np.trapezoid(result, walk) >= -1e-7


@pytest.mark.parametrize(("sense", "sign"), [("along", 1.0), ("against", -1.0)])
def test_a_start_within_a_sheet_is_at_its_deepest_place(sense: Sense, sign):
    """A motion out of the sheet unloads along the elastic line; a motion inwards does not."""
    table = sorted([(0.0, 0.0), (sign * 1.0, -sign * 6.0), (sign * 2.0, -sign * 6.0)])
    law = OverPosition(table, sense, "hold", unloading=12.0)
    start = 1.5
    # Positions and speeds in the sense of the law, and resistances
    outwards = [
        (1.4, -1.0, 4.8),
        (1.0, -1.0, 0.0),
        (0.9, 1.0, 0.0),
        (1.4, 1.0, 4.8),
        (1.6, 1.0, 6.0),
    ]
    inwards = [(start + 0.1 * k, 1.0, 6.0) for k in range(5)]
    for speed, states in ((-1.0, outwards), (1.0, inwards)):
        packed = packed_of(law, turning=True)
        position = np.array([0.0, 0.0, sign * start])
        velocity = np.array([0.0, 0.0, sign * speed])
        place_loads(packed, position, velocity)
        assert -sign * size(packed, 0.0, sign * start, 0.0) == pytest.approx(6.0)
        for s, v, expected in states:
            settle(packed, 0.0, sign * s, sign * v)
            result = -sign * size(packed, 0.0, sign * s, sign * v)
            assert result == pytest.approx(expected, abs=1e-12)


def test_speed_and_acceleration_along_a_load_are_derivatives_of_its_position():
    load = packed_of(OverTime([(0.0, 1.0)], 1.0)).records[0]
    q, v, a = np.random.default_rng(3).normal(size=(3, 3))
    h = 1e-4  # step of differences
    before, (s, speed, acceleration), after = (
        load_motion(load, q + t * v + 0.5 * t * t * a, v, a) for t in (-h, 0.0, h)
    )
    assert speed == pytest.approx((after[0] - before[0]) / (2.0 * h), rel=1e-6)
    second = (after[0] - 2.0 * s + before[0]) / h**2
    assert acceleration == pytest.approx(second, rel=1e-5)
