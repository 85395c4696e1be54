"""Cosine and sine against a higher precision."""

import numpy as np

from presswear.physics.rotation import cos_sin
from presswear.tools.arrays import Array
from presswear.tools.compile import compiled


@compiled
def rotate(angle: Array, cosine: Array, sine: Array) -> None:
    for i in range(angle.shape[0]):
        cosine[i], sine[i] = cos_sin(angle[i])


def test_cosine_and_sine_are_exact_to_round_off():
    """Against 80 bits, over a million turns; on other processors long double has 64 bits."""
    generator = np.random.default_rng(5)
    for reach in (1.0, 1e3, 6e6):
        angle = generator.uniform(-reach, reach, 100_000)
        found = np.zeros((2, angle.size))
        rotate(angle, *found)
        exact = angle.astype(np.longdouble)
        assert np.abs(found[0] - np.cos(exact)).max() < 2.3e-16
        assert np.abs(found[1] - np.sin(exact)).max() < 2.3e-16
