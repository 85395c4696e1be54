"""Directions of bodies: cosine and sine of an angle, and vectors that turn with a body."""

import math

from presswear.tools.arrays import Array
from presswear.tools.compile import inlined

# A number below 2^51 plus this one, less it again, is the nearest whole number.
_WHOLE = 1.5 * 2.0**52
# Halves of pi / 2 whose products with whole numbers below a million are exact, and
# coefficients of minimax polynomials: fdlibm (Sun Microsystems, 1993), k_sin.c, k_cos.c
# and e_rem_pio2.c
_HALF_PI = (
    1.57079632673412561417e00,
    6.07710050630396597660e-11,
    2.02226624879595063154e-21,
)
S1, S2, S3 = (
    -1.66666666666666324348e-01,
    8.33333333332248946124e-03,
    -1.98412698298579493134e-04,
)
S4, S5, S6 = (
    2.75573137070700676789e-06,
    -2.50507602534068634195e-08,
    1.58969099521155010221e-10,
)
C1, C2, C3 = (
    4.16666666666666019037e-02,
    -1.38888888888741095749e-03,
    2.48015872894767294178e-05,
)
C4, C5, C6 = (
    -2.75573143513906633035e-07,
    2.08757232129817482790e-09,
    -1.13596475577881948265e-11,
)


@inlined
def cos_sin(x: float) -> tuple[float, float]:
    """Return cosine and sine to 2.3e-16, of up to a million turns."""
    turns = (x * (2.0 / math.pi) + _WHOLE) - _WHOLE
    r = ((x - turns * _HALF_PI[0]) - turns * _HALF_PI[1]) - turns * _HALF_PI[2]
    z = r * r
    sine = r + z * r * (S1 + z * (S2 + z * (S3 + z * (S4 + z * (S5 + z * S6)))))
    half = 0.5 * z
    cosine = 1.0 - half
    rest = z * (z * (C1 + z * (C2 + z * (C3 + z * (C4 + z * (C5 + z * C6))))))
    cosine += (1.0 - cosine) - half + rest
    # Quarters of a turn, of which every second one swaps both.
    half_turns = (0.5 * turns + _WHOLE) - _WHOLE
    is_odd = turns - 2.0 * half_turns
    sign = 1.0 - 2.0 * abs(half_turns - 2.0 * ((0.5 * half_turns + _WHOLE) - _WHOLE))
    # Behind half_turns half turns, is_odd quarters are left, one or minus one.
    c = cosine if is_odd == 0.0 else -is_odd * sine
    s = sine if is_odd == 0.0 else is_odd * cosine
    return sign * c, sign * s


@inlined
def arm(x: float, y: float, axes: Array, body: int) -> tuple[float, float]:
    """Return a vector of the frame of the body whose x is ``q[body]``, in global directions.

    ``axes`` are cosine and sine of each body's angle, in the places of its x and y.
    """
    cosine = axes[body]
    sine = axes[body + 1]
    return cosine * x - sine * y, sine * x + cosine * y
