"""Loads in the kernels: sizes against plain interpolation, modes against a search."""

import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from presswear.linkage.elements import Body
from presswear.linkage.linkage import Linkage, assemble
from presswear.linkage.load_laws import Harmonics, Law, OverPosition, OverTime, Sense
from presswear.linkage.loads import Force, Moment
from presswear.physics.equations.body_forces import BodyForces
from presswear.physics.equations.layout import LOAD_WORK
from presswear.physics.load_transitions import next_break, place_loads, settle_loads
from presswear.physics.loads import Loads, load_motion, load_size
from presswear.physics.packed import pack

BODY = Body("body", 1.0, 1.0, {"tip": (0.2, -0.1)})
SPACES = st.lists(st.floats(0.05, 2.0), min_size=2, max_size=6)
SIZES = st.lists(st.floats(-9.0, 9.0), min_size=7, max_size=7)
WALK = st.lists(st.floats(-0.7, 0.7), min_size=1, max_size=30)


def linkage_of(law: Law, turning: bool = False) -> Linkage:
    load = Moment("body", law) if turning else Force("body.tip", 0.4, law)
    return assemble([BODY], loads=[load], cycle=2.0)


def packed_of(law: Law, turning: bool = False) -> Loads:
    loads = pack(linkage_of(law, turning)).loads
    assert loads is not None
    return loads


def settle(packed: Loads, t: float, s: float, v: float, a: float = 0.0) -> None:
    """Bring the modes up to a position and speed of the body's angle."""
    q, rate, faster = (np.array([0.0, 0.0, x]) for x in (s, v, a))
    settle_loads(packed, t, q, rate, faster)


def size(packed: Loads, t: float, s: float, v: float) -> float:
    """Size at a position in the table and a speed, as its user counts them."""
    turned = float(packed.records["cosine"][0]) if packed.records["turns"][0] else 1.0
    record = packed.records[0]
    mode = packed.modes[0]
    return turned * load_size(record, packed.nodes, mode, t, turned * s, turned * v)


def table_of(spaces: list[float], sizes: list[float]) -> NDArray[np.float64]:
    """Places and sizes of a table, shape (2, n)."""
    return np.array([np.cumsum(spaces) - 1.0, sizes[: len(spaces)]])


@given(SPACES, SIZES, WALK, st.booleans(), st.floats(-1.0, 1.0))
def test_a_table_over_position_is_that_of_numpy(
    spaces: list[float], sizes: list[float], walk: list[float], held: bool, zero: float
) -> None:
    """Whatever way the body goes: the piece is followed, and it is the right one."""
    places, values = table_of(spaces, sizes)
    if not held:
        values[[0, -1]] = 0.0
    table = np.transpose([places, values]).tolist()
    law = OverPosition(table, outside="hold" if held else "zero", zero=zero)
    packed = packed_of(law, turning=True)
    place_loads(packed, np.zeros(3), np.zeros(3))
    s = 0.0
    for step in walk:
        s += step
        settle(packed, 0.0, s, step)
        expected = np.interp(s - zero, places, values)
        assert size(packed, 0.0, s - zero, step) == pytest.approx(expected, abs=1e-9)


@given(
    SPACES, SIZES, st.lists(st.floats(0.0, 0.9), min_size=1, max_size=20), st.booleans()
)
def test_a_table_over_time_is_that_of_numpy(
    spaces: list[float], sizes: list[float], steps: list[float], repeats: bool
) -> None:
    """Bends are told beforehand, one by one; once passed there is none behind."""
    places, values = table_of(spaces, sizes)
    places += 1.0
    period = float(places[-1]) + 0.5 if repeats else 0.0
    packed = packed_of(
        OverTime(np.transpose([places, values]).tolist(), period), turning=True
    )
    place_loads(packed, np.zeros(3), np.zeros(3))
    t = 0.0
    for step in steps:
        bend = next_break(packed)
        t = min(t + step, bend)
        settle(packed, t, 0.0, 0.0)
        assert next_break(packed) > t
        expected = np.interp(t, places, values, period=period or None)
        assert size(packed, t, 0.0, 0.0) == pytest.approx(expected, abs=1e-9)


def test_a_table_repeats_with_the_cycle_and_harmonics_are_a_fourier_series() -> None:
    packed = packed_of(OverTime([(0.5, 1.0), (1.0, 3.0)]))
    assert packed.records["period"].tolist() == [2.0]
    # From 3 N at 1 s to 1 N at 2.5 s.
    border = pytest.approx(5.0 / 3.0)
    assert packed.nodes.tolist() == [
        [0.0, border],
        [0.5, 1.0],
        [1.0, 3.0],
        [2.0, border],
    ]
    packed = packed_of(Harmonics(0.5, 3.0, [(1.0, 2.0), (0.0, -0.5)]))
    for t in (0.0, 0.3, 7.0):
        expected = 0.5 + math.cos(3 * t) + 2.0 * math.sin(3 * t) - 0.5 * math.sin(6 * t)
        assert size(packed, t, 0.0, 0.0) == pytest.approx(expected, abs=1e-13)


@pytest.mark.parametrize(("sense", "sign"), [("along", 1.0), ("against", -1.0)])
def test_in_one_sense_a_load_grows_with_speed_and_never_drives(
    sense: Sense, sign: float
) -> None:
    law = OverPosition([(0.0, -sign * 4.0)], sense=sense, outside="hold")
    packed = packed_of(law, turning=True)
    place_loads(packed, np.zeros(3), np.zeros(3))
    for speed in (-3e-3, -5e-4, 0.0, 2e-4, 1e-3, 5.0, 5e-4, -5e-4, -2e-3, 5e-4):
        settle(packed, 0.0, 0.3, speed)
        part = min(max(sign * speed / 1e-3, 0.0), 1.0)
        result = size(packed, 0.0, 0.3, speed)
        assert result == pytest.approx(-sign * 4.0 * part)
        assert result * speed <= 0.0


def plastic(
    spaces: list[float], sizes: list[float], steeper: float, sense: Sense, release: bool
) -> OverPosition:
    """A law that resists with what a table of sizes above zero says, and unloads."""
    places, values = table_of(spaces, [0.0, *np.abs(sizes).tolist()])
    steepest = max(float((np.diff(values) / np.diff(places)).max()), 0.1)
    sign = 1.0 if sense == "along" else -1.0
    table = sorted(np.transpose([sign * places, -sign * values]).tolist())
    return OverPosition(
        table, sense, "hold", release=release, unloading=steeper * steepest
    )


def rows_of(law: OverPosition) -> NDArray[np.float64]:
    """Places in the sense of a law, and its resistance there on the way in."""
    sign = 1.0 if law.sense == "along" else -1.0
    return np.array(sorted((sign * place, -sign * size) for place, size in law.table)).T


def borne(law: OverPosition, walk: list[float]) -> list[float]:
    """Resistance along a walk in the sense of a law from before its table, by its definition."""
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
def test_what_unloads_keeps_the_deepest_place_and_never_drives(
    spaces: list[float],
    sizes: list[float],
    steeper: float,
    sense: Sense,
    release: bool,
    turns: list[float],
) -> None:
    """To and fro, and back: resistance as defined, above zero, and no work is won."""
    law = plastic(spaces, sizes, steeper, sense, release)
    sign = 1.0 if sense == "along" else -1.0
    places, values = rows_of(law)
    outside = places[0] - 1.0
    ends = [outside, *turns, outside]
    # Where the resistance may bend: at nodes, deepest places, and ends of elastic
    # lines.
    bends = [*places, places[-1] - 1e-9, *turns]
    bends += [s - float(np.interp(s, places, values)) / law.unloading for s in turns]
    packed = packed_of(law, turning=True)
    place_loads(packed, np.array([0.0, 0.0, sign * outside]), np.zeros(3))
    walk = [outside]
    result = [0.0]
    for one, other in pairwise(ends):
        way = math.copysign(1.0, other - one)
        settle(packed, 0.0, sign * one, 0.0, sign * way)
        between = {s for s in bends if min(one, other) < s < max(one, other)}
        for s in [*sorted(between, reverse=way < 0.0), other]:
            settle(packed, 0.0, sign * s, sign * way)
            walk.append(s)
            result.append(-sign * size(packed, 0.0, sign * s, sign * way))
    assert result == pytest.approx(borne(law, walk), abs=1e-7)
    work = np.diff(walk) @ (np.array(result[1:]) + np.array(result[:-1]))
    assert work >= -1e-7


@pytest.mark.parametrize(("sense", "sign"), [("along", 1.0), ("against", -1.0)])
def test_a_start_within_a_sheet_is_at_its_deepest_place(
    sense: Sense, sign: float
) -> None:
    table = sorted([(0.0, 0.0), (sign * 1.0, -sign * 6.0), (sign * 2.0, -sign * 6.0)])
    law = OverPosition(table, sense, "hold", unloading=12.0)
    for speed, after in (
        (-1.0, [4.8, 0.0, 0.0, 4.8, 6.0]),
        (1.0, [6.0, 6.0, 6.0, 6.0, 6.0]),
    ):
        packed = packed_of(law, turning=True)
        place_loads(
            packed, np.array([0.0, 0.0, 1.5 * sign]), np.array([0.0, 0.0, sign * speed])
        )
        assert -sign * size(packed, 0.0, 1.5 * sign, 0.0) == pytest.approx(6.0)
        result = []
        way = [(1.4, -1.0), (1.0, -1.0), (0.9, 1.0), (1.4, 1.0), (1.6, 1.0)]
        for s, v in way if speed < 0.0 else [(1.5 + 0.1 * k, 1.0) for k in range(5)]:
            settle(packed, 0.0, sign * s, sign * v)
            result.append(-sign * size(packed, 0.0, sign * s, sign * v))
        assert result == pytest.approx(after, abs=1e-12)


def test_forces_are_the_gradient_of_the_place_and_power_is_their_work() -> None:
    """Generalized force = size times ds/dq; the motion by differences of the place."""
    linkage = linkage_of(OverPosition([(-9.0, 2.0), (9.0, 5.0)], outside="hold"))
    whole = pack(linkage)
    packed = whole.loads
    assert packed is not None
    load = packed.records[0]
    rng = np.random.default_rng(3)
    q, v, a = rng.normal(size=(3, 3))
    place_loads(packed, q, v)
    forces = BodyForces(linkage, whole)
    force = forces(0.0, q, v)
    power = forces.energies[LOAD_WORK]
    s, speed, faster = load_motion(load, q, v, a)
    scale = size(packed, 0.0, s, speed)
    assert power == pytest.approx(scale * speed)
    assert power == pytest.approx(force @ v)
    h = 1e-4

    def place(moved: NDArray[np.float64]) -> float:
        return load_motion(load, q + moved, v, a)[0]

    ahead, behind = (place(t * v + 0.5 * t * t * a) for t in (h, -h))
    assert speed == pytest.approx((ahead - behind) / (2.0 * h), rel=1e-6)
    assert faster == pytest.approx((ahead - 2.0 * s + behind) / h**2, rel=1e-5)
    slopes = [(place(step) - place(-step)) / (2.0 * h) for step in h * np.eye(3)]
    assert force == pytest.approx(scale * np.array(slopes), rel=1e-6)


def test_loads_with_a_law_are_no_weight() -> None:
    linkage = assemble([BODY], loads=[Force("body", 0.0, 3.0)], cycle=1.0, gravity=0.0)
    assert not pack(linkage).weight.any()
    assert pack(linkage.changed(loads=[])).loads is None
