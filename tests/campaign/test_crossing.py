"""Curves of followed numbers from blocks."""

import numpy as np

from presswear.campaign.service_life import LoadBlock, curve


def test_samples_keep_their_value_until_a_stroke_runs_on_what_is_new() -> None:
    """Behind a service no stroke has run: the fit of its interval has nothing to go through."""
    place = np.array([1e-5, 3e-5])
    levels, taken = {"A.depth": np.zeros(2)}, np.zeros((1, 2, 1))
    ran = [
        LoadBlock(4.0 + 100.0 * k, 4, 0, levels, {"bdc_error": place}, 0.0, taken) for k in range(3)
    ]
    served = LoadBlock(204.0, 0, 1, levels, {}, 0.0, taken)
    np.testing.assert_allclose(curve([*ran, served], "bdc_error"), np.full(4, 2e-5))
    after = LoadBlock(208.0, 4, 1, levels, {"bdc_error": 2.0 * place}, 0.0, taken)
    np.testing.assert_allclose(
        curve([*ran, served, after], "bdc_error"), [2e-5, 2e-5, 2e-5, 4e-5, 4e-5]
    )
