"""Remaining life of a machine, from readings at inspections and a computed service life.

No run is needed: a life is inversely proportional to the wear coefficients at a known
shape. Readings of a joint give its coefficient; a joint without readings keeps the
scatter of its materials.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from presswear.recording.statistics import Estimate, quantile
from presswear.results.life import WITHOUT_CURVES, LifeResult, in_diameter, words_of
from presswear.results.readings import (
    QUANTITIES,
    Reading,
    check_readings,
    read_readings,
)
from presswear.results.result import Result
from presswear.results.steady_wear import (
    CourseExponent,
    SteadyWear,
    course_exponent,
    steady_wear,
)
from presswear.results.wear_posterior import (
    Observed,
    Posterior,
    Shape,
    posterior_of,
    prior_of,
)
from presswear.scene.options import LIFE_QUANTITIES, NEW_OVER_CLEARANCE, Limit
from presswear.scene.scene import Scene
from presswear.tools.arguments import checked_arguments
from presswear.tools.arrays import Array
from presswear.tools.errors import InputError
from presswear.tools.numbers import (
    counted,
    large,
    quantity_text,
    readable,
    unit_scale,
)

_LEVELS = np.array([0.025, 0.5, 0.975])
_STROKES = 401  # even nodes of the distribution of the life
_LEAST_ERROR = 1e-4  # smallest error of ln(strokes) that is resolved
_SMALLEST = 1e-300  # strokes, against division by zero
# Largest ratio of remaining to past strokes up to which the scatter grows
_MOST_AHEAD = 100.0
# Quantities that the wear of one joint changes
_OF_ONE_JOINT = (*QUANTITIES.values(), "tilt")
_DOUBT = 0.01  # probability of residuals below which readings and shape disagree


@dataclass(frozen=True)
class JointWear:
    """Wear coefficient and steady wear of a joint, from its readings."""

    joint: str
    readings: int
    # wear coefficient relative to that of the scene, and itself, 1/Pa
    factor: Estimate
    coefficient: Estimate
    steady: SteadyWear | None
    exponent: CourseExponent | None
    key: str  # quantity that was read, such as ``A.depth``
    warnings: tuple[str, ...]


@dataclass(frozen=True)
class RemainingLife:
    """Strokes that a machine has left, from readings at inspections.

    Attributes
    ----------
    now : float
        Strokes at the last inspection.
    remaining : Estimate
        Median and 95 % interval of the strokes from then until the first limit.
    exceeded : float
        Probability that the limit is exceeded at the last inspection.
    first : Limit
        Limit that is most probably exceeded first.
    each : mapping of str to Estimate
        Strokes since new until the first limit of each joint, by joint.
    """

    now: float
    remaining: Estimate
    exceeded: float
    first: Limit
    each: dict[str, Estimate]
    joints: tuple[JointWear, ...]
    remarks: tuple[str, ...]

    @property
    def lines(self) -> tuple[str, ...]:
        """Lines of text: the strokes left, and what the readings of each joint tell."""
        remaining = self.remaining
        strokes = f"{large(remaining.mean, digits=2)} strokes"
        if remaining.low is not None and remaining.high is not None:
            strokes += f" ({large(remaining.low, remaining.high, digits=2)})"
        value = quantity_text(self.first.value, self.first.unit)
        diameter = in_diameter(self.first.key, self.first.value)
        first = f"{words_of(self.first.key)} is over {value}{diameter}"
        lines = [
            f"remaining life: {strokes} after {large(self.now)} strokes, until {first}"
        ]
        if self.exceeded >= 0.005:
            text = f"{self.exceeded:.2g}" if self.exceeded < 0.995 else "over 0.99"
            lines.append(f"a limit is already exceeded with a probability of {text}")
        for joint in self.joints:
            lines += _lines_of(joint)
        return (*lines, *self.remarks)

    def __str__(self) -> str:
        """Return the lines as one text."""
        return "\n".join(self.lines)


@dataclass(frozen=True)
class _JointLife:
    """Strokes until the first limit of a joint, for each wear coefficient."""

    logarithms: Array  # ln of the strokes, shape (n,)
    probabilities: Array  # probabilities of the coefficients
    deviations: Array  # standard deviations of the logarithms

    def survival(self, grid: Array) -> Array:
        """Return the probability that ln of the strokes is above each place of a grid."""
        from scipy.special import ndtr  # slow to import

        distance = (self.logarithms - grid[:, np.newaxis]) / self.deviations
        return np.asarray(ndtr(distance) @ self.probabilities)

    @property
    def median(self) -> float:
        """Logarithm that half of the probability lies below."""
        order = np.argsort(self.logarithms)
        below = np.cumsum(self.probabilities[order])
        return float(self.logarithms[order][np.searchsorted(below, 0.5)])


@checked_arguments
def remaining_life(
    result: Result, readings: str | Path | Sequence[Reading]
) -> RemainingLife:
    """Return the strokes that a machine has left, from readings at inspections.

    Parameters
    ----------
    result : Result
        Finished service life of the machine, on new surfaces and without maintenance.
    readings : str, Path or sequence of Reading
        Readings of its joints, or their table; see ``read_readings``.

    Raises
    ------
    InputError
        If the file is wrong, or the life has no course of a quantity that is read.
    """
    if isinstance(readings, str | Path):
        readings = read_readings(readings)
    scene = result.scene
    check_for_life(scene, readings)
    life = result.life
    if life is None or life.ended in WITHOUT_CURVES:
        raise InputError("readings need a finished service life, with its courses")
    limits, remarks = _predicted(scene, life)
    joints: list[JointWear] = []
    lives = {}
    firsts = {}
    for name in scene.wearing_joints:
        of_joint = [reading for reading in readings if reading.joint == name]
        limits_of_joint = [limit for limit in limits if limit.joint in (name, "")]
        wear = prior_of(scene.bearing(name).materials.wear_scatter)
        if of_joint:
            joint, wear = _joint_wear(scene, life, of_joint, limits_of_joint)
            joints.append(joint)
        if limits_of_joint:
            lives[name] = _life_of_joint(life, limits_of_joint, wear, of_joint)
            firsts[name] = min(
                limits_of_joint,
                key=lambda limit: _life_of_joint(life, [limit], wear, of_joint).median,
            )
    now = max(reading.strokes for reading in readings)
    return _remaining(now, lives, firsts, tuple(joints), remarks)


def check_for_life(scene: Scene, readings: Sequence[Reading]) -> None:
    """Raise InputError unless the life of a scene has the courses that readings need."""
    check_readings(readings, scene.wearing_joints)
    limits = scene.life_limits
    if scene.life is None:
        raise InputError(f"readings: {scene.name} has no service life")
    if scene.is_quick:
        raise InputError("readings: a quick life has no courses; omit --quick")
    if scene.surfaces:
        raise InputError("readings count from new surfaces; omit those of the scene")
    if scene.life.replaced or scene.life.rotated:
        raise InputError("readings: bushings that are serviced are not allowed")
    followed = any(limit.name in NEW_OVER_CLEARANCE for limit in limits)
    for reading in readings:
        if reading.quantity not in NEW_OVER_CLEARANCE:
            continue
        if reading.joint not in scene.loose_pins:
            raise InputError(
                f"readings of {reading.joint}: {reading.quantity} is of a pin; of the walls of a "
                "guide depth and wear_volume are allowed"
            )
        if not followed:
            advice = f"add a limit on it, such as --until '{reading.joint}.clearance > 3 x new'"
            raise InputError(
                f"readings: the life does not follow {reading.key}; {advice}"
            )


def _predicted(scene: Scene, life: LifeResult) -> tuple[list[Limit], tuple[str, ...]]:
    """Return the limits that readings predict, and remarks on the others."""
    is_single = len(scene.wearing_joints) == 1
    limits = []
    remarks = []
    for limit in scene.life_limits:
        if is_single or limit.name in _OF_ONE_JOINT:
            limits.append(limit)
            continue
        words = words_of(limit.key)
        remarks.append(f"{words} is left out, because several joints change it")
    if not limits:
        raise InputError(f"readings predict none of the limits: {'; '.join(remarks)}")
    beyond = [limit for limit in limits if life.curves[limit.key][-1, 0] < limit.value]
    if beyond:
        end = large(float(life.curves["strokes"][-1]))
        names = " and ".join(words_of(limit.key) for limit in beyond)
        remarks.append(f"{names}: the course is extended beyond {end} computed strokes")
    return limits, tuple(remarks)


def _course(life: LifeResult, key: str, new: float) -> Shape:
    """Return the course of a quantity of a life."""
    return Shape.of(life.curves["strokes"], life.curves[key][:, 0], new)


def _limit_of(limits: Sequence[Limit], reading: Reading) -> float:
    """Return the limit of the quantity that was read, SI; infinite without one.

    A radial clearance may be limited where the diametral one is read, and the other way
    round.
    """
    size = NEW_OVER_CLEARANCE.get(reading.quantity)
    values = []
    for limit in limits:
        if limit.joint != reading.joint:
            continue
        if limit.name == reading.quantity:
            values.append(limit.value)
        elif size and limit.name in NEW_OVER_CLEARANCE:
            values.append(limit.value * (size / NEW_OVER_CLEARANCE[limit.name]))
    return min(values, default=math.inf)


def _joint_wear(
    scene: Scene, life: LifeResult, group: Sequence[Reading], limits: Sequence[Limit]
) -> tuple[JointWear, Posterior]:
    """Return wear and posterior of the wear coefficient of a joint, from its readings."""
    first = group[0]
    materials = scene.bearing(first.joint).materials
    strokes = np.array([reading.strokes for reading in group])
    values = np.array([reading.value for reading in group])
    errors = [reading.error for reading in group if reading.error is not None]
    has_baseline = first.quantity in NEW_OVER_CLEARANCE and bool((strokes == 0.0).any())
    deviations = np.array(errors) if errors else None
    observed = Observed(strokes, values, deviations, has_baseline)
    clearance = scene.bearing(first.joint).clearance
    new_value = NEW_OVER_CLEARANCE.get(first.quantity, 0.0) * clearance
    shape = _course(life, first.key, new_value)
    posterior = posterior_of(shape, observed, materials.wear_scatter)
    new = float(posterior.probabilities @ posterior.new)
    limit = _limit_of(limits, first)
    exponent = course_exponent(shape, observed)
    low, middle, high = map(float, posterior.quantiles(_LEVELS))
    factor = Estimate(middle, low, high, len(group))
    joint = JointWear(
        first.joint,
        len(group),
        factor,
        factor.scaled(materials.wear_coefficient),
        steady_wear(observed, new, limit),
        exponent,
        first.key,
        _warnings(first.joint, posterior, exponent, materials.wear_scatter),
    )
    return joint, posterior


def _warnings(
    joint: str, posterior: Posterior, exponent: CourseExponent | None, scatter: float
) -> tuple[str, ...]:
    warnings = []
    if not posterior.has_prior:
        size = f"the scatter of its materials, {100.0 * scatter:.2g} %"
        text = f"the wear coefficient lies outside {size}; the readings are used alone"
        warnings.append(f"warning: {joint}: {text}")
    if posterior.misfit < _DOUBT:
        size = f"{readable(posterior.widening, 2)} times their errors"
        text = f"readings and computed shape disagree: residuals are {size}"
        warnings.append(f"warning: {joint}: {text}; the interval is as much wider")
    if exponent is not None and exponent.disagrees:
        size = exponent.value.with_ends
        text = (
            f"readings and computed shape disagree: wear goes as strokes^{size} of it"
        )
        warnings.append(f"warning: {joint}: {text}; compare with the straight line")
    return tuple(warnings)


def _life_of_joint(
    life: LifeResult,
    limits: Sequence[Limit],
    wear: Posterior,
    readings: Sequence[Reading],
) -> _JointLife:
    """Return the strokes until the first limit of a joint for each wear coefficient."""
    key = readings[0].key if readings else ""
    last = max((reading.strokes for reading in readings), default=0.0)
    scaled = np.exp(wear.logarithms)
    logarithms = np.full(len(scaled), math.inf)
    deviations = np.full(len(scaled), _LEAST_ERROR)
    half = life.error or 0.0
    for limit in limits:
        shape = _course(life, limit.key, _new_of(life, limit))
        values = np.full(len(scaled), limit.value)
        if limit.key == key:
            values = values - wear.new + shape.new
        until = shape.strokes_until(values)
        # The readings fix the course at their place. Its scatter grows as the root of
        # the strokes from there on.
        ahead = until / np.maximum(scaled * last, _SMALLEST) - 1.0 if last else 1.0
        growth = np.sqrt(np.clip(ahead, 1.0, _MOST_AHEAD))
        deviation = half / quantile(math.inf) * growth
        if limit.key == key and wear.new_error > 0.0:
            rate = (shape.at(1.01 * until) - shape.at(until)) / 0.01
            deviation = np.hypot(deviation, wear.new_error / rate)
        with np.errstate(divide="ignore"):
            strokes = np.log(until) - wear.logarithms
        is_first = strokes < logarithms
        logarithms = np.where(is_first, strokes, logarithms)
        deviations = np.where(is_first, np.maximum(deviation, _LEAST_ERROR), deviations)
    return _JointLife(logarithms, wear.probabilities, deviations)


def _new_of(life: LifeResult, limit: Limit) -> float:
    """Return the value of the new machine; that of the first block if none is known."""
    if limit.name in (*_OF_ONE_JOINT, "bdc_drift"):
        return limit.new
    return float(life.curves[limit.key][0, 0])


def _estimate(grid: Array, survival: Array) -> Estimate:
    """Return median and interval of strokes from the probability to last longer."""
    low, middle, high = np.exp(np.interp(_LEVELS, 1.0 - survival, grid))
    return Estimate(float(middle), float(low), float(high))


def _remaining(
    now: float,
    lives: Mapping[str, _JointLife],
    firsts: Mapping[str, Limit],
    joints: tuple[JointWear, ...],
    remarks: tuple[str, ...],
) -> RemainingLife:
    """Return the strokes until the first limit of several independent joints."""
    grid = _grid_of(list(lives.values()))
    survivals = {name: joint.survival(grid) for name, joint in lives.items()}
    together = np.prod(list(survivals.values()), axis=0)
    each = {name: _estimate(grid, survival) for name, survival in survivals.items()}
    first = firsts[min(each, key=lambda name: each[name].mean)]
    life = _estimate(grid, together)
    ends = (life.mean, life.low or 0.0, life.high or 0.0)
    mean, low, high = (max(end - now, 0.0) for end in ends)
    survival = float(np.interp(math.log(now), grid, together, left=1.0, right=0.0))
    remaining = Estimate(mean, low, high)
    return RemainingLife(now, remaining, 1.0 - survival, first, each, joints, remarks)


def _grid_of(lives: Sequence[_JointLife]) -> Array:
    """Return the logarithms of strokes at which the distributions are computed."""
    ends = [life.logarithms[np.isfinite(life.logarithms)] for life in lives]
    values = np.concatenate(ends)
    if not values.size:
        raise InputError("readings: the wear that was computed reaches no limit")
    margin = 6.0 * max(float(life.deviations.max()) for life in lives)
    even = np.linspace(values.min() - margin, values.max() + margin, _STROKES)
    # The life of a joint whose coefficient is well known lies between two even nodes.
    return np.unique(np.concatenate([even, *ends]))


def _lines_of(joint: JointWear) -> list[str]:
    """Return the lines on the readings of a joint."""
    value = f"{joint.factor.with_ends} times that of the scene"
    size = joint.coefficient
    ends = f"{size.low:.3g} to {size.high:.3g}"  # digits as the setting is typed
    text = f"wear coefficient {value}, {size.mean:.3g} ({ends}) 1/Pa"
    lines = [f"{joint.joint}: {counted(joint.readings, 'reading')}, {text}"]
    if joint.steady is not None:
        lines.append(f"{joint.joint}: {_line_text(joint.key, joint.steady)}")
    return [*lines, *joint.warnings]


def _line_text(key: str, steady: SteadyWear) -> str:
    """Return running-in, steady rate and life by the straight line in words."""
    unit = LIFE_QUANTITIES[key.rpartition(".")[2]].unit
    rate = steady.rate.scaled(1e6)
    factor, display = unit_scale(unit, abs(rate.mean))
    words = rate.scaled(factor).with_ends
    text = f"straight line: {words} {display} in 10⁶ strokes"
    factor, display = unit_scale(unit, abs(steady.running_in.mean))
    running_in = steady.running_in.scaled(factor).with_ends
    text += f", wear of running-in {running_in} {display}"
    until = steady.until
    if until is None or until.low is None or until.high is None:
        return text
    if math.isinf(until.high):
        return f"{text}, with a rate that may be zero"
    ends = large(until.low, until.high, digits=2)
    return f"{text}, limit after {large(until.mean, digits=2)} strokes ({ends})"
