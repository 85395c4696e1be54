"""The press by hand against the in-house equations; peers against the reference; equal errors."""

import math
from dataclasses import replace
from functools import cache
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.optimize import fsolve

from presswear.campaign.replicates import start_of
from presswear.engines.base import Plan, recorder_of
from presswear.engines.dae.dynamics import rates, state_size, system_of
from presswear.engines.settings import InHouse
from presswear.linkage.press import CRANK_2_START, CRANK_7_START, Press
from presswear.physics.constraints import constraints_of
from presswear.scene.catalog import scene_named
from presswear.tools.errors import RunFailed
from presswear.validation.costs import scipy_codes
from presswear.validation.costs.by_hand import OPEN, evaluate, numbers_of
from presswear.validation.costs.outcome import Outcome, state_of
from presswear.validation.costs.scipy_codes import METHODS, solve
from presswear.validation.costs.side_by_side import (
    Setting,
    at_error,
    distance,
    run_by_hand,
    run_engine,
    touch_distance,
)
from presswear.validation.costs.simulators import SIMULATORS, installed

Array = NDArray[np.float64]
SCENE = scene_named("wear-times")
LINKAGE = SCENE.linkage()
NUMBERS = numbers_of(SCENE)
START = start_of(SCENE)
HAND = state_of(LINKAGE, START)
NAMES = [body.name for body in LINKAGE.bodies]
SHORT = 0.02  # s, with three touches
LONGEST = 1e-3  # s


def turned(angle: Array, x: float, y: float = 0.0) -> Array:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([c * x - s * y, s * x + c * y])


def placed(t: Array, x: Array) -> tuple[Array, Array]:
    """Coordinates of all bodies, (18,), and both eccentricities, (4,), by plain trigonometry."""
    press = SCENE.mechanism
    assert isinstance(press, Press)
    corner = press.plate_corners()
    two, seven = CRANK_2_START - press.speed * t, CRANK_7_START + press.speed * t
    plate, rod_3, slider, rod_5 = x
    o2 = np.array([press.geometry.hx, press.geometry.hy])
    centre = turned(seven, press.length_7) - turned(plate, corner["D"].x, corner["D"].y)
    b = centre + turned(plate, corner["B"].x, corner["B"].y)
    e = np.array([press.geometry.hx, slider])
    places = {
        "crank 2": (o2 - turned(two, 0.5 * press.length_2), two),
        "crank 7": (turned(seven, 0.5 * press.length_7), seven),
        "plate 4": (centre, plate),
        "rod 3": (b + turned(rod_3, 0.5 * press.length_3), rod_3),
        "slider 6": (e, 0.5 * math.pi),
        "rod 5": (e + turned(rod_5, 0.5 * press.length_5), rod_5),
    }
    at_a = o2 - turned(two, press.length_2) - b - turned(rod_3, press.length_3)
    at_c = centre + turned(plate, corner["C"].x, corner["C"].y) - e - turned(rod_5, press.length_5)
    bodies = np.concatenate([[*places[name][0], places[name][1]] for name in NAMES])
    return bodies, np.concatenate([at_a, at_c])


TINY = 1e-30  # of a complex step, whose derivative has no error


def moving(t: float, y: Array) -> tuple[Array, Array]:
    """What ``placed`` gives and its rate, each (22,)."""
    step = TINY * 1j
    found = np.concatenate(placed(np.array(t + step), y[:4] + step * y[4:]))
    return found.real, found.imag / TINY


def contacts(t: float, y: Array) -> Array:
    """Rate and sliding of both pins, m/s, (4,)."""
    e, e_t = (own[-4:] for own in moving(t, y))
    press, found = SCENE.mechanism, []
    assert isinstance(press, Press)
    spins = ((-press.speed, y[5]), (y[4], y[7]))
    for joint, k, (pin, bearing) in zip(LINKAGE.clearances, (0, 2), spins, strict=True):
        size = math.hypot(*e[k : k + 2])
        n, v = e[k : k + 2] / size, e_t[k : k + 2]
        half = 0.5 * (size - joint.clearance)
        arms = pin * (joint.pin_radius - half) - bearing * (joint.bearing_radius + half)
        found += [v @ n, v[1] * n[0] - v[0] * n[1] + arms]
    return np.array(found)


def in_house(t: float, y: Array, onset: Array) -> Array:
    """Accelerations of the four coordinates by multipliers in Cartesian ones."""
    q, v = (own[:-4] for own in moving(t, y))
    book = recorder_of(LINKAGE, START, Plan(1.0, 1, 1)).book
    system = system_of(book.packed, constraints_of(LINKAGE), 20.0, 20.0)
    n = q.size
    state = np.zeros(state_size(system))
    state[:n], state[n : 2 * n] = q, v
    out = np.zeros_like(state)
    rates(system, np.where(onset < 0.0, 0.0, onset), t, state, out)
    bodies, parts = ("plate 4", "rod 3", "slider 6", "rod 5"), (2, 2, 1, 2)
    places = [3 * NAMES.index(name) + part for name, part in zip(bodies, parts, strict=True)]
    return np.asarray(out[n : 2 * n][places])


closing = st.one_of(st.just(OPEN), st.floats(1e-3, 0.5))
# On the ramp of friction, below it, above it.
sliding = st.one_of(st.floats(-1.2e-3, 1.2e-3), st.floats(-1.0, 1.0))
# Neither near zero, where the round-off of places is large beside them.
rate = st.one_of(st.floats(1e-3, 0.3), st.floats(-0.3, -1e-3))
depth = st.one_of(st.floats(-1e-4, -1e-8), st.floats(1e-5, 4e-5))
pin = st.tuples(st.floats(0.0, 6.3), depth, rate, sliding)


@settings(max_examples=80, deadline=None)
@given(t=st.floats(0.0, 0.57), one=pin, two=pin, onset=st.tuples(closing, closing))
def test_equations_by_hand_are_those_in_house(
    t: float,
    one: tuple[float, float, float, float],
    two: tuple[float, float, float, float],
    onset: tuple[float, float],
) -> None:
    ideal = SCENE.ideal.at(np.array([t]))
    near = state_of(LINKAGE, replace(START, position=ideal.position[0]))[:4]
    clearance = LINKAGE.clearances[0].clearance
    aim = np.concatenate([turned(np.array(own[0]), clearance + own[1]) for own in (one, two)])
    x = fsolve(lambda x: placed(np.array(t), x)[1] - aim, near, xtol=1e-13)
    base = contacts(t, np.array([*x, *np.zeros(4)]))
    columns = [contacts(t, np.array([*x, *row])) - base for row in np.eye(4)]
    u = np.linalg.solve(np.transpose(columns), np.array([*one[2:], *two[2:]]) - base)
    y, latched = np.array([*x, *u]), np.array(onset)
    out, gaps = np.zeros(12), np.zeros((2, 2))
    evaluate(NUMBERS, t, y, latched, out, gaps)
    assert gaps == pytest.approx(np.array([one[1:3], two[1:3]]), abs=1e-9)
    expected = in_house(t, y, latched)
    assert out[:4] == pytest.approx(u)
    assert np.abs(out[4:8] - expected).max() < 1e-10 * np.abs(expected).max()


@cache
def reference() -> Outcome:
    return run_engine(SCENE, START, InHouse(integration_tolerance=1e-12), SHORT, recorded=True)


def errors(own: Outcome) -> tuple[float, float]:
    apart = touch_distance(reference().touches, own.touches)
    return distance(NUMBERS, own.end, reference().end), apart


def test_the_loop_by_hand_converges_to_the_engines() -> None:
    coarse, fine = (errors(run_by_hand(NUMBERS, HAND, h, SHORT)) for h in (1e-5, 1e-6))
    assert len(reference().touches) == 3
    assert fine[0] < 1e-8 < coarse[0] < 1e-5
    assert fine[1] < 1e-7


@pytest.mark.parametrize(
    ("code", "tolerance"), [("LSODA", 1e-9), ("DOP853", 1e-9), ("Radau", 1e-6)]
)
def test_codes_of_scipy_come_to_the_same_end(code: str, tolerance: float) -> None:
    assert code in METHODS
    error, apart = errors(solve(NUMBERS, HAND, SHORT, code, tolerance, LONGEST))
    assert error < 30.0 * tolerance
    assert apart < 1e-5


def test_a_code_that_stands_at_a_touch_fails(monkeypatch: pytest.MonkeyPatch) -> None:
    """As Radau does at some coarse tolerances: a pin parts in the moment in which it touches."""

    def stands(
        slopes: object, span: tuple[float, float], y: Array, *_: object, **__: object
    ) -> SimpleNamespace:
        event = [np.array([span[0]]), np.zeros(0)]
        times, states = np.full(2, span[0]), np.column_stack([y, y])
        return SimpleNamespace(status=1, t=times, y=states, t_events=event, nfev=1)

    monkeypatch.setattr(scipy_codes, "solve_ivp", stands)
    with pytest.raises(RunFailed, match=r"Radau at 3e-05: touches at 0 s without end"):
        solve(NUMBERS, HAND, SHORT, "Radau", 3e-5, LONGEST)


@pytest.mark.parametrize(("package", "value"), [("mujoco", 2e-6), ("pydrake", 1e-6)])
def test_simulators_come_to_the_same_end(package: str, value: float) -> None:
    if not installed(package):
        pytest.skip(f"{package} is not installed")
    own = SIMULATORS[package][1](NUMBERS, HAND, SHORT, value, LONGEST)
    error, apart = errors(own)
    assert error < 1e-7
    assert apart < 1e-6
    if package == "mujoco":
        # The same method, steps and law: only the equations of motion are its own.
        by_hand = run_by_hand(NUMBERS, HAND, value, SHORT)
        assert distance(NUMBERS, own.end, by_hand.end) < 1e-10


def test_costs_are_read_off_at_an_error() -> None:
    tried = [Setting(10.0**-k, seconds=(2.0**k,), error=10.0 ** (-2 * k)) for k in range(1, 6)]
    found = at_error(tried, 1e-5)
    assert found is not None
    # Halfway between 1e-4 and 1e-6, in logarithms.
    assert found.value == pytest.approx(10.0**-2.5)
    assert found.cost == pytest.approx(2.0**2.5)
    assert at_error(tried, 1e-11) is None
    easy = at_error(tried, 1.0)
    assert easy is not None
    assert easy.value == pytest.approx(0.1)
    assert easy.cost == pytest.approx(2.0)
    # A lucky setting before a worse one does not count, nor does one that failed.
    lucky = [Setting(1.0, seconds=(1.0,), error=1e-9), *tried, Setting(1e-9, failure="stuck")]
    assert at_error(lucky, 1e-5) == found


def test_distances_are_those_of_what_is_turned() -> None:
    moved = HAND.copy()
    moved[1] += 1e-6
    assert distance(NUMBERS, moved, HAND) == pytest.approx(0.34e-6)
    moved[2] -= 1e-6
    assert distance(NUMBERS, moved, HAND) == pytest.approx(1e-6)
    # Two touches at nearly the same time may come in either order.
    assert touch_distance([(1, 0.2), (0, 0.1)], [(0, 0.1), (1, 0.25)]) == pytest.approx(0.05)
    assert touch_distance([(0, 0.1)], [(1, 0.1)]) == math.inf
