"""Bumps of surfaces after a wear update in one jump."""
# mypy: disable-error-code="union-attr,operator,index,arg-type"

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import presswear as pw
from presswear.campaign.bumps import median_penetration, noise_of
from presswear.results.run_warnings import high_bumps


def _recorder(time: Any, penetration: Any) -> Any:
    series = {"time": np.asarray(time), "penetration": np.asarray(penetration)}
    return SimpleNamespace(series=lambda name, joint=None: series[name])


def test_noise_of_the_mean_surface_is_that_between_the_replicates():
    """Bearing and pin with noise of 2 and 1 nm on a groove: sqrt(5 / 4) nm for four replicates."""
    bins = 3000
    groove = 1e-5 * (1.0 + np.cos(np.linspace(0.0, 2.0 * math.pi, bins)))
    noise = np.random.default_rng(5).standard_normal((4, 2, bins))
    depth = groove + np.array([2e-9, 1e-9])[:, np.newaxis] * noise
    assert noise_of(depth) == pytest.approx(1e-9 * math.sqrt(5.0 / 4.0), rel=0.03)


def test_median_penetration_is_weighted_by_time():
    """Many rows of a short impact do not count more than few rows of a long rest."""
    time = np.concatenate([np.linspace(0.0, 0.01, 101), [0.5, 0.9, 1.0]])
    penetration = np.concatenate([np.full(101, 9e-6), [1e-6, 2e-6, -1e-6]])
    assert median_penetration([_recorder(time, penetration)], 0) == 1e-6
    assert median_penetration([_recorder(time, np.full(104, -1e-6))], 0) is None


def test_high_bumps_have_no_interval_of_contacts():
    """A map of 12 cycles times 20 million, on surfaces that hardly overlap."""
    short: Any = {
        "cycles": 5,
        "replicates": 4,
        "wear_updates": 1,
        "cycles_per_update": 2e7,
    }
    scene = pw.Scene(pw.FourBar(), engine="dae", extrapolation="single", **short)
    result = pw.run(scene)
    new, worn = (stage.statistics for stage in result.stages)
    joint = worn.joints["B"]
    assert [*worn.high_bumps] == ["B"]
    assert new.joints["B"].bumps is None
    for estimate in (joint.contacts_per_cycle, joint.peak_force_per_cycle):
        assert estimate.low is None
    assert worn.output.acceleration_max_per_cycle.low is None
    assert joint.load_distance_per_cycle.low is not None
    assert new.joints["B"].contacts_per_cycle.low is not None
    (sentence,) = high_bumps(scene, result.stages)
    assert sentence.startswith(
        "First wear: bumps are higher than the penetration at joint B ("
    )
    assert sentence in str(result)
