"""Orders of a slider-crank whose clearance is small against its closed form."""

import numpy as np
import pytest

import presswear as pw
from presswear.bifurcation.branch import ENGINE
from presswear.bifurcation.orders import HIGHEST, Orders, orders_of
from presswear.campaign.replicates import start_of
from presswear.linkage.slider_crank import SliderCrank

SCENE = pw.scenes.slider_crank(clearance="10 um")


def closed_form(own: SliderCrank, count: int) -> list[float]:
    """Amplitudes of the acceleration of x = r cos a + sqrt(l^2 - r^2 sin^2 a) at low orders."""
    angle = 2.0 * np.pi * np.arange(4096) / 4096
    x = own.crank_length * np.cos(angle)
    x += np.sqrt(own.rod_length**2 - (own.crank_length * np.sin(angle)) ** 2)
    waves = 2.0 * np.abs(np.fft.rfft(x)) / 4096
    return [float(waves[k] * (2.0 * np.pi * k / own.period) ** 2) for k in range(1, count + 1)]


def test_first_orders_are_those_of_the_closed_form() -> None:
    assert isinstance(SCENE.mechanism, SliderCrank)
    linkage, period = SCENE.linkage(), SCENE.mechanism.period
    found = orders_of(linkage, start_of(SCENE), period, 6, ENGINE)
    assert found.amplitude.shape == (2, HIGHEST)
    assert list(found.amplitude[0, :2]) == pytest.approx(closed_form(SCENE.mechanism, 2), rel=0.02)
    assert 1.0 < found.resonance[0] < HIGHEST


def test_a_run_that_fails_has_no_orders() -> None:
    linkage, period = SCENE.linkage(), SCENE.mechanism.period
    coarse = pw.InHouse("rk4", equal_step=1e-2)
    found = orders_of(linkage, start_of(SCENE), period, 2, coarse)
    for name, own in vars(Orders.none(1, HIGHEST)).items():
        np.testing.assert_array_equal(getattr(found, name), own)
