"""Friction torque of journal bearings in mixed lubrication, measured at 8 kN (Sander et al.).

The rig has a test bearing and two supports that bear half the load each. One number is
fitted: the height of the asperities over the measured roughness. The same closed forms
predict the torques at 4 kN in ``docs/validation/stribeck.md``.
"""

import math
import re
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest
from scipy.optimize import brentq, minimize_scalar

from presswear.physics.mixed_lubrication import (
    ASPERITY_PRESSURE,
    Asperities,
    asperity_force,
    shear_moment,
)
from presswear.physics.oil_film import film_force, film_of
from presswear.tools.arrays import Array

VISCOSITY = 6.8e-3  # Pa s
RELATIVE_CLEARANCE = 1e-3
BOUNDARY_FRICTION = 0.02
LOAD = 8e3  # N
SPEED = np.array([3000, 1000, 500, 400, 300, 250, 200, 150])  # rpm
MEASURED = np.array([1.06, 0.544, 0.43, 0.46, 0.58, 0.747, 1.076, 1.71])  # N m
HEIGHT = 2.968  # of the asperities over the measured roughness; fitted
PAGE = Path(__file__).parents[2] / "docs/validation/stribeck.md"


class Journal(NamedTuple):
    """A bearing of the rig."""

    radius: float  # m
    width: float  # m
    roughness: float  # sigma of both surfaces, m
    load_share: float

    @property
    def clearance(self) -> float:
        return RELATIVE_CLEARANCE * self.radius

    def torque(self, load: float, omega: float, height: float) -> float:
        """Return the friction torque under a load, N, at a steady speed, rad/s."""
        sizes = self.width, self.radius, self.clearance
        film = film_of(*sizes, VISCOSITY)
        asperities = Asperities(ASPERITY_PRESSURE, height * self.roughness)

        def forces(gap: float) -> tuple[float, float, float]:
            along, across = film_force(gap, 0.0, omega, film)
            area = self.width * self.radius
            rough = asperity_force(
                gap * self.clearance, self.clearance, area, asperities
            )
            return along - rough, across, rough

        def excess(logarithm: float) -> float:
            along, across, _ = forces(math.exp(logarithm))
            return math.hypot(along, across) / (self.load_share * load) - 1.0

        gap = math.exp(brentq(excess, math.log(1e-4), -1e-9))
        _, across, rough = forces(gap)
        # Half of the couple of the forces on pin and bearing is on the pin.
        couple = 0.5 * self.clearance * (1.0 - gap) * across
        rubbing = BOUNDARY_FRICTION * rough * self.radius
        return shear_moment(gap, omega, VISCOSITY, sizes) + couple + rubbing


TEST_BEARING = Journal(0.0239, 0.0172, 0.13e-6, 1.0)
SUPPORT = Journal(0.027, 0.025, 0.28e-6, 0.5)


def torques(load: float, speeds: Array, height: float) -> Array:
    """Return the torque of the three bearings, N m, at speeds in rpm."""
    omegas = speeds * math.pi / 30.0
    return np.array(
        [
            TEST_BEARING.torque(load, omega, height)
            + 2.0 * SUPPORT.torque(load, omega, height)
            for omega in omegas
        ]
    )


def test_one_height_of_asperities_fits_the_measured_torques():
    def misfit(height: float) -> float:
        ratio = torques(LOAD, SPEED, height) / MEASURED
        return float(np.sum(np.log(ratio) ** 2))

    fitted = minimize_scalar(misfit, bounds=(0.5, 10.0), method="bounded").x
    assert fitted == pytest.approx(HEIGHT, abs=0.002)
    ratio = torques(LOAD, SPEED, fitted) / MEASURED
    assert 0.82 < ratio.min() < ratio.max() < 1.12
    # Without asperities the torque at the lowest speed is an eighth of the measured.
    assert torques(LOAD, SPEED[-1:], 0.3)[0] < 0.13 * MEASURED[-1]


def test_least_torque_lies_between_mixed_and_full_film():
    speeds = np.array([150.0, 300.0, 500.0, 1000.0, 3000.0])
    curve = torques(LOAD, speeds, HEIGHT)
    assert speeds[curve.argmin()] == 500.0 == SPEED[MEASURED.argmin()]


def test_the_page_states_the_torques_at_half_the_load():
    rows = re.findall(r"^\| (\d+) \| ([\d.]+) \|", PAGE.read_text(), re.MULTILINE)
    stated = np.array(rows, float)
    assert len(stated) == 7
    computed = torques(4e3, stated[:, 0], HEIGHT)
    assert stated[:, 1] == pytest.approx(computed, rel=5e-3)
