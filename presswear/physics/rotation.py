"""Cosine and sine of an angle, and vectors that are fixed in a body."""

import math

from presswear.tools.arrays import Array
from presswear.tools.compile import inlined

# (x + _WHOLE) - _WHOLE is the whole number nearest to x, if abs(x) < 2^51.
_WHOLE = 1.5 * 2.0**52
# pi / 2 as a sum of three numbers. The products of the first two with whole numbers
# below a million are exact. These numbers, and the coefficients of the minimax
# polynomials, are from fdlibm (Sun Microsystems, 1993), e_rem_pio2.c, k_sin.c, k_cos.c.
_HALF_PI = (
    1.57079632673412561417e00,
    6.07710050630396597660e-11,
    2.02226624879595063154e-21,
)
S1 = -1.66666666666666324348e-01
S2 = 8.33333333332248946124e-03
S3 = -1.98412698298579493134e-04
S4 = 2.75573137070700676789e-06
S5 = -2.50507602534068634195e-08
S6 = 1.58969099521155010221e-10
C1 = 4.16666666666666019037e-02
C2 = -1.38888888888741095749e-03
C3 = 2.48015872894767294178e-05
C4 = -2.75573143513906633035e-07
C5 = 2.08757232129817482790e-09
C6 = -1.13596475577881948265e-11


@inlined
def cos_sin(x: float) -> tuple[float, float]:
    """Return cosine and sine of an angle, rad, with an error of at most 2.3e-16.

    The angle may be up to a million turns. It is reduced to at most an eighth of a turn.
    """
    quarters = (x * (2.0 / math.pi) + _WHOLE) - _WHOLE
    r = ((x - quarters * _HALF_PI[0]) - quarters * _HALF_PI[1]) - quarters * _HALF_PI[2]
    z = r * r
    sine = r + z * r * (S1 + z * (S2 + z * (S3 + z * (S4 + z * (S5 + z * S6)))))
    half = 0.5 * z
    cosine = 1.0 - half
    higher = z * (z * (C1 + z * (C2 + z * (C3 + z * (C4 + z * (C5 + z * C6))))))
    # (1 - cosine) - half is the round-off of 1 - half.
    cosine += (1.0 - cosine) - half + higher
    # quarters = 2 half_turns + quarter, where quarter is -1, 0 or 1. A quarter of a turn
    # exchanges cosine and sine.
    half_turns = (0.5 * quarters + _WHOLE) - _WHOLE
    quarter = quarters - 2.0 * half_turns
    # An odd number of half turns changes both signs.
    turns = (0.5 * half_turns + _WHOLE) - _WHOLE
    sign = 1.0 - 2.0 * abs(half_turns - 2.0 * turns)
    c = cosine if quarter == 0.0 else -quarter * sine
    s = sine if quarter == 0.0 else quarter * cosine
    return sign * c, sign * s


@inlined
def arm(x: float, y: float, axes: Array, body: int) -> tuple[float, float]:
    """Return a vector in global directions from its components along the axes of a body.

    ``body`` is the index of the x of the body in q. ``axes`` holds cosine and sine of
    the angle of each body, at the indices of its x and y.
    """
    cosine = axes[body]
    sine = axes[body + 1]
    return cosine * x - sine * y, sine * x + cosine * y
