"""Wear by a user law: the coefficient depends on the history of a place or the pressure.

    dh = K(h, D) dD   or   dh = K(h, p) p ds,   D = integral of p ds since new

The engines compute the depth of Archard's law with K_d in the first case, and in the
second that of K(0, p): each step adds K(0, p) p ds to each bin, with the mean pressure
in the bin. How K depends on h and D is a factor on this depth, and the equation is
integrated over all cycles of a wear update: it does not matter in how many steps the
wear is applied. D follows from the depth, because a place wears from new.
"""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from presswear.linkage.wear_law import WEAR_PARAMETERS, WearLaw
from presswear.physics.contact import CONTACT
from presswear.physics.dormand_prince import DOP853, Tableau
from presswear.physics.packed import JOINT, wear_address
from presswear.physics.wear import bins_in, deposit_over_arc
from presswear.physics.worn_map import SURFACES, bin_of
from presswear.tools.arrays import Array
from presswear.tools.compile import Records, call, compiled, lazily_compiled

STEP_TOL = 1e-12  # allowed error of a step over the depth
# Shortest step over the interval; shorter ones would not pass a jump of the law
LEAST_STEP = 1e-12
GROWTH = 5.0  # largest ratio of two successive steps
# Indices of the numbers of a law in an array
ADDRESS, COEFFICIENT, PRESSURE, SCALE, PER_DEPTH = range(5)


@compiled
def excess_rate(law: Array, depth: float, archard: float, is_inverse: bool) -> float:
    """Return f(h, H) - 1, or of the inverse 1 / f - 1, of a law with these numbers.

    ``depth`` is the worn depth h and ``archard`` the depth H of Archard's law, m.
    """
    load_distance = archard * law[PER_DEPTH]
    state = (depth, load_distance, law[PRESSURE], law[COEFFICIENT])
    factor = call(int(law[ADDRESS]), state) / law[SCALE]
    return (1.0 - factor) / factor if is_inverse else factor - 1.0


@compiled
def slope_at(
    law: Array, start: Array, x: float, excess: float, is_inverse: bool
) -> float:
    """Return the rate of the excess at a place ``x`` of the interval, see ``excess_over``."""
    if is_inverse:
        return excess_rate(law, x, x + excess, True)
    # The depth may be negative in a stage of a step that is too long.
    depth = max(start[0] + x + excess, 0.0)
    return excess_rate(law, depth, start[1] + x, False)


@compiled
def excess_over(
    law: Array,
    start: Array,
    length: float,
    is_inverse: bool,
    tableau: Tableau,
    slopes: Array,
) -> float:
    """Return the wear depth less the ``length`` of an interval of Archard's depth, m.

    ``start`` are the depths h and H, m. With ``is_inverse`` the interval is one of wear
    depth from new, and the result is Archard's depth less its length. The method is that
    of Dormand and Prince of order 8 with step control; ``slopes`` is working space.

    ``scipy.integrate.solve_ivp`` over all places at once takes 60 times as long for a law
    that jumps, because each place jumps at another instant.
    """
    x = 0.0
    excess = 0.0
    h = length
    stages = tableau.b.shape[0]
    while x < length:
        h = min(h, length - x)
        slopes[0] = slope_at(law, start, x, excess, is_inverse)
        for i in range(1, stages):
            change = 0.0
            for j in range(i):
                change += tableau.a[i, j] * slopes[j]
            place = x + tableau.c[i] * h
            slopes[i] = slope_at(law, start, place, excess + h * change, is_inverse)
        change = 0.0
        error = 0.0
        second = 0.0
        for i in range(stages):
            change += tableau.b[i] * slopes[i]
            error += tableau.error[i] * slopes[i]
            second += tableau.second_error[i] * slopes[i]
        blended = math.sqrt(error * error + 0.01 * second * second)
        missed = h * error * error / blended if blended > 0.0 else 0.0
        allowed = STEP_TOL * abs(x + h + excess + h * change)
        if missed <= allowed or h <= LEAST_STEP * length:
            # The last step ends at ``length`` without round-off.
            x = x + h if h < length - x else length
            excess += h * change
        # The error of a step that is too long may be NaN.
        ratio = 1.0 / GROWTH if math.isnan(missed) else GROWTH
        if missed > 0.0:
            ratio = 0.9 * (allowed / missed) ** 0.125
        h *= min(max(ratio, 1.0 / GROWTH), GROWTH)
    return excess


@compiled
def fill_excess(
    law: Array,
    starts: Array,
    lengths: Array,
    is_inverse: bool,
    tableau: Tableau,
    slopes: Array,
    excess: Array,
) -> None:
    """Fill the excess over intervals, shape (n,), from ``starts``, shape (n, 2)."""
    for i in range(lengths.shape[0]):
        if lengths[i] > 0.0:
            excess[i] = excess_over(
                law, starts[i], lengths[i], is_inverse, tableau, slopes
            )


@dataclass(frozen=True)
class UserWear:
    """User law of a joint as a factor f(h, H) on the depth H of Archard's law.

    f = K(h, D) / K_d, or K(h, p) / K(0, p), which depends on no p.
    """

    wear: WearLaw

    @cached_property
    def numbers(self) -> tuple[Array, Array]:
        """Numbers of the law for the kernels, of the bearing and of the pin."""
        wear = self.wear
        address = wear_address(wear)
        pressure = wear.pressure_reference
        scale = wear.coefficient
        if wear.depends_on_pressure:
            new = np.array([address, scale, pressure, scale, 0.0])
            scale *= excess_rate(new, 0.0, 0.0, False) + 1.0
        sides = []
        for share in (wear.bearing_share, 1.0 - wear.bearing_share):
            per_depth = 1.0 / (share * wear.coefficient) if share > 0.0 else 0.0
            sides.append(
                np.array([address, wear.coefficient, pressure, scale, per_depth])
            )
        return sides[0], sides[1]

    @property
    def _uses_load_distance(self) -> bool:
        law = self.wear.user_law
        assert law is not None
        return "load_distance" in law.parameters("wear_law", WEAR_PARAMETERS)

    @property
    def ratio(self) -> float:
        """Wear of a new surface over that of Archard's law with K_d, or with K(0, p)."""
        return 1.0 + excess_rate(self.numbers[0], 0.0, 0.0, False)

    def worn(self, depth: Array, archard: Array) -> Array:
        """Return the depth that wears off, m, where Archard's law takes off ``archard``, m.

        Shape (..., 2, bins). Bumps that stand out of the round surface, h < 0, wear as
        a new one.
        """
        before = np.maximum(depth, 0.0)
        archard_before = np.zeros_like(before)
        if self._uses_load_distance:
            archard_before = self.archard_depth(before)
        starts = np.stack([before, archard_before], axis=-1)
        return archard + self._excess(starts, archard, is_inverse=False)

    def archard_depth(self, depth: Array) -> Array:
        """Return the depth that Archard's law takes off a new surface for a worn depth, m."""
        starts = np.zeros((*depth.shape, 2))
        return depth + self._excess(starts, depth, is_inverse=True)

    def _excess(self, starts: Array, lengths: Array, is_inverse: bool) -> Array:
        """Return the excess over intervals of shape (..., 2, bins), each side by its numbers."""
        excess = np.zeros(lengths.shape)
        slopes = np.empty(len(DOP853.b))
        for side, numbers in enumerate(self.numbers):
            places = np.ascontiguousarray(starts[..., side, :, :]).reshape(-1, 2)
            intervals = lengths[..., side, :].flatten()
            values = np.zeros_like(intervals)
            fill_excess(numbers, places, intervals, is_inverse, DOP853, slopes, values)
            excess[..., side, :] = values.reshape(excess[..., side, :].shape)
        return excess


@lazily_compiled(None, 2, JOINT, SURFACES, CONTACT, 0, 0, 2, 2)
def deposit_by_law(
    depth: Array,
    joint: Records,
    surfaces: Array,
    contact: Records,
    load_distance: float,
    slip: float,
    shares: Array,
    archard: Array,
) -> None:
    """Add the wear K(0, p) p ds of a step to the bins in which the surfaces overlap.

    ``depth`` are the wear maps of bearing and pin, m, shape (2, n). The normal force of
    the step is the load distance, N m, over the ``slip``, m. ``shares`` and ``archard``
    are working space of the same shape; both are zero before and after the call.
    """
    start, end = deposit_over_arc(
        archard, joint, surfaces, contact, load_distance, shares
    )
    turn = joint.map_turns * (contact.bearing_angle - contact.pin_angle)
    bins = depth.shape[1]
    coefficient = joint.wear_coefficient
    force = load_distance / slip if slip > 0.0 else contact.normal
    for side in range(2):
        share = joint.bearing_share if side == 0 else 1.0 - joint.bearing_share
        k = bin_of(start + side * turn, bins)
        for _ in range(bins_in(end - start, bins)):
            by_archard = archard[side, k]
            if by_archard != 0.0:
                pressure = force * by_archard / (share * coefficient * load_distance)
                law = call(joint.wear_address, (0.0, 0.0, pressure, coefficient))
                depth[side, k] += by_archard * (law / coefficient)
                archard[side, k] = 0.0
            k = k + 1 if k + 1 < bins else 0
