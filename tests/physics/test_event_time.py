"""Root of the cubic through two states."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from presswear.physics.event_time import crossing


@given(
    st.floats(0.01, 0.9),
    st.floats(0.02, 0.09),
    st.floats(-1.0, 3.0),
    st.floats(1e-7, 1.0),
)
def test_crossing_is_the_first_root(
    root: float, length: float, lean: float, h: float
) -> None:
    """A contact that starts and ends within the step."""
    # Zero where s is root, root + length or -6 / lean, which lies outside.
    cubic = -np.poly1d([root, root + length], r=True) * np.poly1d([0.25 * lean, 1.5])
    slope = cubic.deriv()
    ends = (cubic(0.0), slope(0.0) / h, cubic(1.0), slope(1.0) / h)
    assert max(cubic(0.0), cubic(1.0)) < 0.0
    assert crossing(*ends, h) == pytest.approx(root, abs=1e-12)
