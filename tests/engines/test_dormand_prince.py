"""The coefficients of Dormand and Prince's methods, against SciPy's, to the last bit."""

import numpy as np
from scipy.integrate import DOP853 as SCIPY_8
from scipy.integrate import RK45 as SCIPY_5

from presswear.engines.dormand_prince import DOP853, DOPRI5


def test_order_8() -> None:
    assert np.array_equal(DOP853.a, SCIPY_8.A[:12, :12])
    assert np.array_equal(DOP853.b, SCIPY_8.B)
    assert np.array_equal(DOP853.c, SCIPY_8.C[:12])
    assert np.array_equal(DOP853.error, SCIPY_8.E5)
    assert np.array_equal(DOP853.second_error, SCIPY_8.E3)


def test_order_5() -> None:
    assert np.array_equal(DOPRI5.a[:, :5], SCIPY_5.A)
    assert np.array_equal(DOPRI5.b, SCIPY_5.B)
    assert np.array_equal(DOPRI5.c, SCIPY_5.C)
    assert np.array_equal(DOPRI5.error, SCIPY_5.E)
