"""A measured motor-driven slider-crank: the stored fit reaches the scatter of the curves."""

import numpy as np
import pytest
from boulder import Rig, measured, residuals, speeds


def test_the_fit_reaches_the_measured_speeds() -> None:
    curves = measured()
    error = residuals(Rig(), tuple(curves))
    assert float(np.sqrt(np.mean(error**2))) < 0.017
    assert abs(error.reshape(3, -1).mean(axis=1)).max() < 2e-3


def test_the_last_turn_has_settled(monkeypatch: pytest.MonkeyPatch) -> None:
    last = speeds(Rig(), 5.5)
    monkeypatch.setattr("boulder.CYCLES", 6)
    assert speeds(Rig(), 5.5) == pytest.approx(last, rel=1e-3)
