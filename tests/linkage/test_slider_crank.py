"""The ideal slider-crank in closed form: textbook formulas, constraints, derivatives, engines."""

import math
from dataclasses import fields, replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from presswear.campaign.starts import start_of
from presswear.engines.base import Plan, Run
from presswear.engines.settings import InHouse
from presswear.linkage.mechanism import Mechanism, Motion
from presswear.linkage.press import Press
from presswear.linkage.slider_crank import SliderCrank
from presswear.physics.constraints import constraints_of
from presswear.scene.catalog import slider_crank
from presswear.scene.scene import Scene
from presswear.tools.errors import AssemblyError, InputError
from presswear.tools.quantities import meaning_of

Array = NDArray[np.float64]

ONE = SliderCrank()
IDEAL = replace(slider_crank(), joints="none")
CRANK, ROD, SLIDER = 0, 3, 6
"""Where each body's x is."""

mechanisms = st.builds(
    lambda crank, ratio, speed: SliderCrank(crank, ratio * crank, speed=speed),
    st.floats(0.001, 1.0),
    st.floats(1.01, 10.0),
    st.floats(1.0, 5000.0),
)


def _cycle(mechanism: SliderCrank, count: int = 3601) -> Motion:
    return mechanism.ideal_motion(np.linspace(0.0, mechanism.period, count))


def test_the_slider_moves_as_in_the_textbook() -> None:
    """x = r cos a + sqrt(l^2 - r^2 sin^2 a), written out here on its own."""
    motion = _cycle(ONE)
    r, l, turn = 0.05, 0.12, ONE.speed * motion.time  # noqa: E741
    expected = r * np.cos(turn) + np.sqrt(l**2 - (r * np.sin(turn)) ** 2)
    np.testing.assert_allclose(motion.position[:, SLIDER], expected, atol=1e-15)
    assert motion.position[0, SLIDER] == pytest.approx(0.17, abs=1e-15)
    # At the ends the acceleration is r w^2 (1 + r / l) and r w^2 (1 - r / l).
    outer, inner = motion.acceleration[[0, 1800], SLIDER] / (r * ONE.speed**2)
    assert outer == pytest.approx(-(1.0 + r / l), rel=1e-12)
    assert inner == pytest.approx(1.0 - r / l, rel=1e-9)


@given(mechanisms)
def test_the_stroke_is_two_cranks(mechanism: SliderCrank) -> None:
    stroke = np.ptp(_cycle(mechanism).position[:, SLIDER])
    assert stroke == pytest.approx(2.0 * mechanism.crank_length, rel=1e-12)


def test_crank_and_rod_start_along_the_guide() -> None:
    start = ONE.ideal_motion(np.zeros(1)).position[0]
    np.testing.assert_allclose(start, [0.025, 0, 0, 0.11, 0, 0, 0.17, 0, 0], atol=1e-16)


def _constraint_errors(mechanism: SliderCrank, motion: Motion) -> tuple[float, float, float]:
    """Greatest violation of Phi = 0, its first and its second derivative over the cycle.

    Relative to the rod's length and to the speed where they have a dimension.
    """
    constraints = constraints_of(mechanism.linkage())
    worst = np.zeros(3)
    for k, t in enumerate(motion.time):
        q, v, a = motion.position[k], motion.velocity[k], motion.acceleration[k]
        phi, phi_t, gamma, jacobian = constraints.evaluate(float(t), q, v)
        found = [np.abs(phi).max(), np.abs(phi_t).max(), np.abs(jacobian @ a - gamma).max()]
        worst = np.maximum(worst, found)
    scale = max(mechanism.rod_length, 1.0)
    position, velocity, acceleration = worst / scale / mechanism.speed ** np.arange(3)
    return float(position), float(velocity), float(acceleration)


@given(mechanisms)
def test_every_constraint_holds_at_all_three_levels(mechanism: SliderCrank) -> None:
    assert max(_constraint_errors(mechanism, _cycle(mechanism, 73))) < 1e-11


@pytest.mark.parametrize("name", ["crank_length", "rod_length", "speed"])
def test_a_changed_value_is_noticed(name: str) -> None:
    """The constraints of one slider-crank do not hold on the motion of another."""
    other = replace(ONE, **{name: 1.001 * getattr(ONE, name)})
    assert max(_constraint_errors(ONE, other.ideal_motion(_cycle(ONE, 73).time))) > 1e-5


@given(mechanisms, st.floats(0.0, 1.0))
def test_velocity_and_acceleration_are_derivatives(mechanism: SliderCrank, part: float) -> None:
    step = 1e-4 / mechanism.speed
    time = part * mechanism.period + np.linspace(-2.0 * step, 2.0 * step, 5)
    motion = mechanism.ideal_motion(time)
    stencil = np.array([1.0, -8.0, 0.0, 8.0, -1.0]) / (12.0 * step)
    scale = max(mechanism.rod_length, 1.0)
    np.testing.assert_allclose(
        motion.velocity[2], stencil @ motion.position, atol=1e-9 * scale * mechanism.speed
    )
    np.testing.assert_allclose(
        motion.acceleration[2], stencil @ motion.velocity, atol=1e-9 * scale * mechanism.speed**2
    )


def test_the_motion_repeats_and_the_rod_swings() -> None:
    position = _cycle(ONE).position
    moved = position[-1] - position[0]
    np.testing.assert_allclose(moved, [0, 0, 2.0 * math.pi, 0, 0, 0, 0, 0, 0], atol=1e-14)
    swing = math.asin(0.05 / 0.12)
    assert position[:, ROD + 2].min() == pytest.approx(-swing, rel=1e-12)
    assert position[:, ROD + 2].max() == pytest.approx(swing, rel=1e-12)


def test_the_linkage_is_the_one_of_the_literature() -> None:
    linkage = ONE.linkage()
    masses = {body.name: (body.mass, body.inertia) for body in linkage.bodies}
    assert (masses["crank"], masses["rod"]) == ((0.30, 1e-4), (0.21, 2.5e-4))
    assert masses["slider"][0] == 0.14
    assert ONE.speed == pytest.approx(5000.0 / 60.0 * 2.0 * math.pi, rel=1e-15)
    freedoms = 3 * len(linkage.bodies) - 2 * len(linkage.revolutes) - 2 * len(linkage.guides)
    assert freedoms == len(linkage.drives) == 1
    ends = {joint.name: (joint.first.body, joint.second.body) for joint in linkage.revolutes}
    # The bearing is on the first.
    assert (ends["A"], ends["B"]) == (("rod", "crank"), ("rod", "slider"))


def test_both_mechanisms_are_what_a_scene_needs() -> None:
    everything: list[Mechanism] = [Press(), SliderCrank()]
    for mechanism in everything:
        names = {joint.name for joint in mechanism.linkage().revolutes}
        assert set(mechanism.openable) <= names
        assert all(len(name) == 1 for name in mechanism.openable)
        assert mechanism.period * mechanism.speed == pytest.approx(2.0 * math.pi)


@pytest.mark.parametrize("rod", [0.01, 0.05, 0.0500001])
def test_a_rod_too_short_is_refused_by_name_and_range(rod: float) -> None:
    expected = r"rod_length = \S+ m: with crank_length = 0\.05 m allowed is 0\.050005 m to 10 m"
    with pytest.raises(AssemblyError, match=expected):
        SliderCrank(rod_length=rod).check_assembly()
    with pytest.raises(AssemblyError, match=expected):
        Scene("", "", mechanism=SliderCrank(rod_length=rod), joints="B")


def test_the_shortest_rod_passes_all_around() -> None:
    shortest = SliderCrank(rod_length=1.0001 * 0.05)
    shortest.check_assembly()
    assert max(_constraint_errors(shortest, _cycle(shortest, 721))) < 1e-8


@pytest.mark.parametrize(
    "name", [item.name for item in fields(SliderCrank) if item.name != "gravity"]
)
@pytest.mark.parametrize("value", [0.0, -1.0, math.nan, math.inf, "1"])
def test_a_value_out_of_range_is_refused_by_name(name: str, value: object) -> None:
    values: dict[str, Any] = {name: value}
    with pytest.raises(InputError, match=f"^{name} = .*allowed is"):
        SliderCrank(**values)


def test_every_value_says_where_it_comes_from() -> None:
    for item in fields(SliderCrank):
        meaning = meaning_of(item)
        assert meaning is not None, item.name
        expected = "assumed" if item.name == "gravity" else "literature, from memory"
        assert meaning.status == expected


def _errors(run: Run) -> Array:
    """Greatest error of the slider's displacement, velocity and acceleration."""
    rows = run.recorder.rows
    exact = ONE.ideal_motion(rows[:, 0])
    levels = (exact.position, exact.velocity, exact.acceleration)
    slider = np.column_stack([level[:, SLIDER] for level in levels])
    slider[:, 0] -= slider[0, 0]
    assert run.status == "completed"
    assert len(rows) > 100
    return np.asarray(np.abs(rows[:, 1:4] - slider).max(axis=0))


@pytest.fixture(scope="module")
def in_house() -> Run:
    return InHouse().simulate(IDEAL.linkage(), start_of(IDEAL), Plan(ONE.period, 2))


def test_in_house_engine_follows_the_closed_form(in_house: Run) -> None:
    assert np.all(_errors(in_house) < [1e-12, 1e-10, 1e-7])
    end = ONE.ideal_motion(np.array([in_house.time]))
    assert np.abs(in_house.end.position - end.position[0]).max() < 1e-9


def test_exudyn_follows_the_closed_form() -> None:
    run = IDEAL.numerics.joints.over(IDEAL.mechanism.period).simulate(
        IDEAL.linkage(), start_of(IDEAL), Plan(ONE.period, 2)
    )
    assert np.all(_errors(run) < [1e-8, 1e-6, 1e-2])


def test_a_slider_crank_of_another_length_is_noticed(in_house: Run) -> None:
    scene = replace(IDEAL, mechanism=replace(ONE, rod_length=0.1201))
    run = InHouse().simulate(scene.linkage(), start_of(scene), Plan(ONE.period, 2))
    assert np.all(_errors(run) > 100.0 * _errors(in_house))
