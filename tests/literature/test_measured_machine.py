"""A measured motor-driven slider-crank: the stored fit reaches the scatter of the curves."""

from dataclasses import replace

import numpy as np
import pytest
from boulder import PREDICTED, Rig, fitted, measured, numbers, residuals, speeds


def test_the_fit_reaches_the_measured_speeds():
    curves = measured()
    error = residuals(Rig(), tuple(curves))
    assert float(np.sqrt(np.mean(error**2))) < 0.0155
    assert abs(error.reshape(3, -1).mean(axis=1)).max() < 2e-3


def test_the_last_turn_has_settled(monkeypatch):
    last = speeds(Rig(), 5.5)
    monkeypatch.setattr("boulder.CYCLES", 6)
    assert speeds(Rig(), 5.5) == pytest.approx(last, rel=1e-3)


def test_differences_of_a_fit_are_smooth_over_the_bins():
    rig = Rig()
    moved = replace(rig, torque_per_volt=1.001 * rig.torque_per_volt)
    change = speeds(moved, 5.5) - speeds(rig, 5.5)
    assert abs(np.diff(change, append=change[0])).max() < 0.02


@pytest.mark.slow
def test_the_fit_completes_and_predicts_the_documented_speeds():
    fit = fitted(tuple(measured()))
    assert "satisfied" in fit.message
    model = [numbers(speeds(fit.rig, voltage)) for voltage in PREDICTED]
    documented = [(9.61, 8.24), (12.06, 7.80), (16.95, 7.80)]
    assert np.array(model) == pytest.approx(np.array(documented), abs=0.01)
