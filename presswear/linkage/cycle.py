"""Cycle of a linkage: the time after which its motion repeats."""

import math
from collections.abc import Sequence
from fractions import Fraction

from presswear.linkage.drives import Drive
from presswear.tools.errors import InputError
from presswear.tools.quantities import Quantity, written

# Shortest and longest cycle, s. A pin at rest in its bearing takes some 1e4 steps in a
# second of the motion, so that a longer cycle takes too long to compute.
MIN_CYCLE = 1e-5
MAX_CYCLE = 1e3
MAX_TURNS = 1000  # largest number of turns of a drive in a cycle
# Largest number of turns of a drive in a cycle that is searched for
MAX_COMMON_TURNS = 64
RATIO_TOL = 1e-9  # tolerance of a speed ratio to the nearest ratio of whole numbers


def check_cycle(period: float, drives: Sequence[Drive], name: str) -> None:
    """Raise InputError for a cycle of the linkage of this name that is too short or too long."""
    label = f"cycle of {name}, in which all drives make whole turns,"
    Quantity("s", MIN_CYCLE, MAX_CYCLE).check(label, period)
    for drive in drives:
        for speed in drive.frequencies:
            turns = speed * period / (2.0 * math.pi)
            if turns > MAX_TURNS:
                raise InputError(
                    f"{label} = {period:g} s: {drive.name} turns {turns:.6g} times in it, with "
                    f"{written(speed, 'rad/s')}; allowed are {MAX_TURNS} times at most"
                )


def common_period(drives: Sequence[Drive], name: str) -> float:
    """Return the shortest time in which every drive of a linkage makes whole turns, s."""
    speeds = list[float]()
    for drive in drives:
        speeds += drive.frequencies
    if not speeds:
        raise InputError(
            f"cycle of {name}: no drive turns; add one, or specify cycle, s"
        )
    turns = 1
    for speed in speeds:
        ratio = Fraction(speed / speeds[0]).limit_denominator(MAX_COMMON_TURNS)
        if abs(float(ratio) * speeds[0] / speed - 1.0) > RATIO_TOL:
            raise InputError(
                f"cycle of {name}: speeds of {written(speeds[0], 'rad/s')} and "
                f"{written(speed, 'rad/s')} have no common cycle of {MAX_COMMON_TURNS} turns "
                "or less; specify cycle, s"
            )
        turns = math.lcm(turns, ratio.denominator)
    return 2.0 * math.pi * turns / speeds[0]
