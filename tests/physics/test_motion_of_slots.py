"""Guides on moving bodies: closed forms of the ideal motion, its torque, and its forces."""

import math

import numpy as np
import pytest
from closed_form import needed_power
from numpy.testing import assert_allclose
from slotted import (
    HEIGHT,
    RADIUS,
    SPEED,
    YOKE_MASS,
    boom,
    boom_press,
    cylinder,
    quick_return,
    scotch_yoke,
    shaper,
    skew_quick_return,
    swinging_block,
)

from presswear.linkage.linkage import Linkage
from presswear.linkage.mechanisms import SliderCrank
from presswear.linkage.press import Press
from presswear.physics.assembly import close
from presswear.physics.constraint_rows import Rows
from presswear.physics.constraints import constraints_of
from presswear.physics.ideal import ideal_motion
from presswear.physics.inverse_dynamics import constraint_forces, needed_torques

TIME = np.linspace(0.0, 2.0 * math.pi / SPEED, 97)


def direction_to(x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, ...]:
    """Return the angle of a vector with two derivatives, each of shape (n,).

    ``x`` and ``y`` are the components with their derivatives, each (3, n).
    """
    square = x[0] ** 2 + y[0] ** 2
    omega = (x[0] * y[1] - y[0] * x[1]) / square
    along = (x[0] * x[1] + y[0] * y[1]) / square
    alpha = (x[0] * y[2] - y[0] * x[2]) / square - 2.0 * along * omega
    return np.unwrap(np.arctan2(y[0], x[0])), omega, alpha


def crank_pin() -> tuple[np.ndarray, np.ndarray]:
    """Return x and y of the crank pin about its pivot with two derivatives, each (3, n)."""
    cosine, sine = RADIUS * np.cos(SPEED * TIME), RADIUS * np.sin(SPEED * TIME)
    x = np.array([cosine, -SPEED * sine, -(SPEED**2) * cosine])
    return x, np.array([sine, SPEED * cosine, -(SPEED**2) * sine])


def rocker_of_a_quick_return() -> tuple[np.ndarray, ...]:
    """Return phi = atan2(d + r sin a, r cos a) with its derivatives."""
    x, y = crank_pin()
    y[0] += HEIGHT
    return direction_to(x, y)


def rod_in_a_swinging_block() -> tuple[np.ndarray, ...]:
    """Return phi = atan2(-r sin a, 0.4 - r cos a): the rod points to the pivot of the block."""
    x, y = crank_pin()
    return direction_to(np.array([0.4 - x[0], -x[1], -x[2]]), -y)


@pytest.mark.parametrize(
    ("linkage", "coordinate", "expected"),
    [
        (quick_return(), 8, rocker_of_a_quick_return()),
        (quick_return(), 5, rocker_of_a_quick_return()),
        (scotch_yoke(), 6, crank_pin()[0]),
        (swinging_block(), 8, rod_in_a_swinging_block()),
    ],
    ids=["rocker", "block", "yoke", "rod"],
)
def test_ideal_motion_has_a_closed_form(linkage: Linkage, coordinate, expected):
    motion = ideal_motion(linkage, linkage.period).at(TIME)
    levels = motion.position, motion.velocity, motion.acceleration
    for level, exact in zip(levels, expected, strict=True):
        atol = 1e-13 * np.abs(exact).max()
        assert_allclose(level[:, coordinate], exact, atol=atol)


def test_forces_of_a_scotch_yoke():
    """The slot bears m w^2 r cos w t and no moment; the torque is m w^2 r^2 sin cos."""
    linkage = scotch_yoke()
    ideal = ideal_motion(linkage, linkage.period)
    forces = constraint_forces(linkage, ideal, TIME)
    first = ideal.rows.names.index("slot")
    peak = YOKE_MASS * SPEED**2 * RADIUS
    expected = -peak * np.cos(SPEED * TIME)
    assert_allclose(forces[:, first], expected, atol=1e-12 * peak)
    assert_allclose(forces[:, first + 1], 0.0, atol=1e-12 * peak)
    torque = needed_torques(linkage, ideal, TIME)[:, 0]
    exact = -expected * RADIUS * np.sin(SPEED * TIME)
    assert_allclose(torque, exact, atol=1e-12 * peak)


@pytest.mark.parametrize(
    "linkage",
    [
        skew_quick_return(),
        shaper(),
        cylinder(),
        *(
            make(is_reversed=is_reversed)
            for make in (boom, boom_press)
            for is_reversed in (False, True)
        ),
    ],
    ids=lambda linkage: linkage.name,
)
def test_drive_has_the_power_of_the_motion(linkage: Linkage):
    """Torque or force times speed is the rate of the kinetic energy, less that of the weights."""
    ideal = ideal_motion(linkage, linkage.period)
    power = needed_power(linkage, ideal.at(TIME))
    torque = needed_torques(linkage, ideal, TIME)[:, 0]
    speed = linkage.drives[0].motion(TIME)[1]
    assert_allclose(speed * torque, power, atol=1e-9 * np.abs(power).max())


def test_an_imprecise_guess_of_the_rocker_turns_its_block():
    """The block has the angle of the rocker, in the same turn."""
    linkage = quick_return()
    for degrees in (20.0, 95.0, 430.0):
        guess = {"rocker": math.radians(degrees)}
        start = ideal_motion(linkage.changed(guess=guess), linkage.period).position[0]
        assert start[1, 2] == pytest.approx(start[2, 2], abs=1e-14)
        turns = round((degrees - 71.565) / 360.0)
        angle = math.atan2(HEIGHT, RADIUS) + 2.0 * math.pi * turns
        assert start[2, 2] == pytest.approx(angle, abs=1e-13)


@pytest.mark.parametrize(
    "linkage", [skew_quick_return(), Press().linkage(), SliderCrank().linkage()]
)
def test_derivatives_off_the_constraints(linkage: Linkage):
    """Phi' and Phi'' beside finite differences of Phi along a motion that violates it."""
    linkage = linkage.changed(drives=())
    rows = Rows(linkage)
    generator = np.random.default_rng(3)
    q, v, a = generator.normal(size=(3, 1, len(linkage.bodies), 3))
    step = 1e-4
    shifts = np.array([-2.0, -1.0, 0.0, 1.0, 2.0]) * step
    places = np.concatenate([q + h * v + 0.5 * h * h * a for h in shifts])
    (phi,) = rows.errors(np.zeros(5), places)
    _, first, second = (level[0] for level in rows.errors(np.zeros(1), q, v, a))
    slope = np.array([1.0, -8.0, 0.0, 8.0, -1.0]) @ phi / (12.0 * step)
    curvature = np.array([-1.0, 16.0, -30.0, 16.0, -1.0]) @ phi / (12.0 * step**2)
    assert_allclose(first, slope, atol=1e-9)
    assert_allclose(second, curvature, atol=1e-5)
    kernels = constraints_of(linkage).evaluate(0.0, q.ravel(), v.ravel())
    assert_allclose(kernels[0], phi[2], atol=1e-14)
    assert_allclose(kernels[1], slope, atol=1e-9)
    acceleration = kernels[3] @ a.ravel() - kernels[2]
    assert_allclose(acceleration, curvature, atol=1e-5)


def test_close_returns_to_the_slot():
    linkage = skew_quick_return()
    rows = Rows(linkage)
    q = ideal_motion(linkage, linkage.period).position[:1]
    levels = close(rows, np.zeros(1), q + 1e-3)
    assert np.abs(rows.errors(np.zeros(1), levels.q)[0]).max() < 1e-14
