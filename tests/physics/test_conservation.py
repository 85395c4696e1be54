"""The worn pair of ``presswear verify --hard``, which keeps its energy and its momentum there."""

import numpy as np
import pytest

from presswear.validation.hard_impacts import (
    PAIR_CLEARANCE,
    angular_momentum,
    conservation_errors,
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


def test_the_residual_is_no_accident_of_the_start() -> None:
    """The bound of 1e-8 fails at the tolerance that a scene has by default."""
    assert abs(conservation_errors(1e-9, 0.3)[1]) > 1e-8
