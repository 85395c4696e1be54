"""Two free, spinning bodies, worn deep and unlike, keep their energy and their momentum."""

import numpy as np
import pytest

from presswear.trials.hard.bodies import (
    PAIR_CLEARANCE,
    angular_momentum,
    kept,
    kinetic_energy,
    worn_pair,
)


def test_the_pair_is_what_it_says() -> None:
    linkage, start = worn_pair()
    joint = linkage.clearances[0]
    assert joint.normal.damping == joint.friction.coefficient == 0.0
    assert joint.map_frame == "body"
    assert joint.contact == "foundation"
    for surface in (joint.bearing_surface, joint.pin_surface):
        assert surface.depth.max() > 0.25 * PAIR_CLEARANCE
        assert not np.allclose(surface.depth, surface.depth[::-1], atol=1e-5)
    assert joint.bearing_surface != joint.pin_surface
    assert abs(start.velocity[2]) > 1.0
    assert abs(start.velocity[5]) > 1.0
    assert kinetic_energy(linkage, start) > 0.0
    masses = np.array([body.mass for body in linkage.bodies])
    assert masses @ start.velocity.reshape(2, 3)[:, :2] == pytest.approx(0.0, abs=1e-16)


def test_angular_momentum_counts_path_and_spin() -> None:
    linkage, start = worn_pair()
    m, i = (np.array([[b.mass, b.inertia] for b in linkage.bodies])).T
    q, v = start.position.reshape(2, 3), start.velocity.reshape(2, 3)
    path = float(m @ (q[:, 0] * v[:, 1] - q[:, 1] * v[:, 0]))
    spin = float(i @ v[:, 2])
    assert angular_momentum(linkage, start) == pytest.approx(path + spin, rel=1e-14)
    assert abs(path) > 0.01 * abs(spin)


@pytest.mark.parametrize(
    ("duration", "least"), [(0.3, 80), pytest.param(3.8, 1000, marks=pytest.mark.slow)]
)
def test_energy_and_momentum_are_kept(duration: float, least: int) -> None:
    found = kept(1e-14, duration)
    assert found.contacts >= least
    assert abs(found.energy) < 1e-8
    assert abs(found.momentum) < 1e-12


def test_the_residual_shrinks_with_the_tolerance() -> None:
    """Not at the order of the method: slopes of the maps bend at every stored angle."""
    residuals = [abs(kept(tolerance, 0.3).energy) for tolerance in (1e-9, 1e-12, 1e-14)]
    assert residuals[1] < 0.1 * residuals[0]
    assert residuals[2] < 0.3 * residuals[1]


def test_the_residual_is_no_accident_of_the_start() -> None:
    """The bound of 1e-8 fails at the tolerance that a scene has by default."""
    assert abs(kept(1e-9, 0.3).energy) > 1e-8
