"""Time of a touchdown as the root of the cubic through two states."""

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
def test_crossing_is_the_first_root(root, length, factor, h):
    """A contact starts and ends within the step."""
    # The roots are root, root + length and -6 / factor, which lies outside of the step.
    quadratic = -np.poly1d([root, root + length], r=True)
    cubic = quadratic * np.poly1d([0.25 * factor, 1.5])
    slope = cubic.deriv()
    ends = (cubic(0.0), slope(0.0) / h, cubic(1.0), slope(1.0) / h)
    assert max(cubic(0.0), cubic(1.0)) < 0.0
    assert crossing(*ends, h) == pytest.approx(root, abs=1e-12)
