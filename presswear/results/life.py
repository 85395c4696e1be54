"""Service life as results store it: strokes with their interval, limits, curves and wear rates."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from itertools import zip_longest
from typing import Final, Literal

import numpy as np

from presswear.recording.settling import Settling
from presswear.recording.statistics import Estimate, quantile
from presswear.results.motions import sentence_of
from presswear.scene.options import LIFE_QUANTITIES
from presswear.tools.arrays import Array
from presswear.tools.numbers import large, quantity_text
from presswear.tools.serialize import NOT_STORED

FILE = "life.npz"  # file of the curves
_FINE = 0.05  # half width of a logarithm below which a life has three digits
PRELIMINARY: Final = "preliminary"
QUICK: Final = "quick"
WITHOUT_CURVES = (PRELIMINARY, QUICK)
Ended = Literal["limit", "at_most", "worn", "cycles", "preliminary", "quick"]


def _error(sampling: float | None, step: float | None) -> float | None:
    if sampling is None or step is None:
        return None
    return math.hypot(sampling, step)


@dataclass(frozen=True)
class LimitResult:
    """Strokes after which a limit is exceeded."""

    key: str  # limited quantity, such as ``A.depth``
    unit: str
    value: float  # the limit
    strokes: float | None  # None: not exceeded as far as the wear was computed
    sampling: float | None  # half width of ln(strokes) by the scatter of the motion
    step: float | None  # half width of ln(strokes) by the wear step
    last: float  # value at the end, and its half width
    last_half_width: float | None

    @property
    def error(self) -> float | None:
        """Half width of the logarithm of the strokes; None: unknown."""
        return _error(self.sampling, self.step)


@dataclass(frozen=True)
class RefinementResult:
    """Refinement of a life, in finer steps than the one before."""

    change: float  # fraction of the clearance that a cycle takes off
    cycles: int  # cycles of all replicates
    strokes: float | None  # life by this refinement alone
    sampling: float | None  # half width of ln(strokes)
    # deviations of the replicates from their mean, times the weight of this refinement, in
    # ln(strokes) of the life
    deviations: tuple[float, ...] = ()


@dataclass(frozen=True)
class WearRate:
    """Wear rate of a joint on new or once worn surfaces, as a quick life uses it."""

    joint: str
    surfaces: str  # new, or worn once
    since: float  # strokes
    until: float
    rate: float  # volume that a stroke takes off, m^3, and its half width
    half_width: float


@dataclass(frozen=True)
class LifeResult:
    """Service life.

    Attributes
    ----------
    ended : {"limit", "at_most", "worn", "cycles", "preliminary", "quick"}
        A limit was exceeded; the strokes reached their maximum; a surface was worn
        deeper than the model allows or a run failed; the cycles reached their maximum;
        refinements follow; rates of the new and the once worn surfaces, without an
        error of the wear steps.
    strokes : float
        Life; if no limit was exceeded, strokes for which the wear was computed.
    curves : mapping of str to ndarray
        ``strokes``, shape (n,), and each quantity by its key, shape (n, 3): mean, and
        the ends of its interval. A quick life has none, and a folder stores none of a
        preliminary life.
    """

    ended: Ended
    # reason, unless a limit was exceeded; state of a preliminary or a quick life
    message: str
    strokes: float
    sampling: float | None  # half width of ln(strokes) by the scatter of the motion
    step: float | None  # half width of ln(strokes) by the wear step
    scatter: float  # half width of ln(strokes) by the scatter of the wear coefficients
    limits: tuple[LimitResult, ...]
    refinements: tuple[RefinementResult, ...]
    wear_rates: tuple[WearRate, ...] = ()  # wear rates that a quick life uses
    services: tuple[str, ...] = ()  # maintenance of bushings, with strokes
    curves: Mapping[str, Array] = field(default_factory=dict, metadata=NOT_STORED)
    # motions on the surfaces at the start; None: a quick life
    settling: Settling | None = None
    # histories that repeat at the end of each load block
    settled: tuple[int | None, ...] = ()

    @property
    def first(self) -> LimitResult | None:
        """Limit that is exceeded first, or None."""
        exceeded = [limit for limit in self.limits if limit.strokes is not None]
        return min(exceeded, key=lambda limit: limit.strokes or 0.0, default=None)

    @property
    def error(self) -> float | None:
        """Half width of the logarithm of the life for its wear coefficients; None: unknown."""
        return _error(self.sampling, self.step)

    @property
    def total_error(self) -> float | None:
        """Half width of the logarithm with the scatter of the wear coefficients; None: unknown."""
        return None if self.error is None else math.hypot(self.error, self.scatter)

    @property
    def interval(self) -> Estimate:
        """Life with its interval for its wear coefficients, strokes."""
        if self.error is None:
            return Estimate(self.strokes)
        factor = math.exp(self.error)
        return Estimate(self.strokes, self.strokes / factor, self.strokes * factor)

    @property
    def words(self) -> str:
        """Strokes with both ends of their interval, if it is known."""
        span = span_of(self.strokes, self.error)
        strokes = large(self.strokes, digits=digits_of(self.error))
        return f"{strokes} strokes ({span})" if span else f"{strokes} strokes"

    @property
    def motion(self) -> str:
        """Sentence on the motion on the surfaces at the start, without a full stop, or nothing."""
        if self.settling is None:
            return ""
        text = sentence_of(self.settling)
        if self.settling.verdict == "settled":
            return f"{text}. The histories begin in this motion"
        return text

    def __str__(self) -> str:
        """Return one line: strokes and the limit that is exceeded, or the values reached."""
        first = self.first
        if first is None:
            reached = (
                f"{words_of(limit.key)} {quantity_text(limit.last, limit.unit)}"
                for limit in self.limits
            )
            return f"no life is known: {self.message}; reached: {', '.join(reached)}"
        total = span_of(self.strokes, self.total_error)
        scatter = f"; {total} with the scatter of the wear coefficient" if total else ""
        value = quantity_text(first.value, first.unit)
        limit = f"{value}{in_diameter(first.key, first.value)}"
        line = (
            f"life: {self.words} until {words_of(first.key)} is over {limit}{scatter}"
        )
        if self.ended in WITHOUT_CURVES:
            return f"{self.ended} {line}; {self.message}"
        return line


def life_ratio(life: LifeResult, reference: LifeResult) -> tuple[str, str]:
    """Return how many times a life is as long as another, and the probability that it is longer.

    The ratio has its 95 % interval, from the differences of the replicates, which start
    alike in both lives. The probability is that of a normal error of its logarithm.
    Both are empty if a life has no interval or ended without a limit. The scatter of
    the wear coefficients is left out, because it changes both lives alike.
    """
    ended = {life.ended, reference.ended}
    if ended != {"limit"} or life.error is None or reference.error is None:
        return "", ""
    ratio = life.strokes / reference.strokes
    sampling = _half_width_of_ratio(life, reference)
    half = math.hypot(sampling, life.step or 0.0, reference.step or 0.0)
    factor = math.exp(half)
    text = Estimate(ratio, ratio / factor, ratio * factor).with_ends
    if half == 0.0:
        return text, f"{float(ratio > 1.0):g}"
    deviation = half / quantile(math.inf)
    longer = 0.5 * math.erfc(-math.log(ratio) / (math.sqrt(2.0) * deviation))
    if 0.01 <= longer <= 0.99:
        return text, f"{longer:.2g}"
    return text, "over 0.99" if longer > 0.5 else "below 0.01"


def _half_width_of_ratio(life: LifeResult, reference: LifeResult) -> float:
    """Return the half width of the logarithm of the ratio, by the scatter of the motion.

    In each refinement replicates with the same number are a pair. The variances of all
    refinements add up, with the degrees of freedom of Welch and Satterthwaite. Lives
    without stored deviations are independent.
    """
    pairs = zip_longest(
        (refinement.deviations for refinement in life.refinements),
        (refinement.deviations for refinement in reference.refinements),
        fillvalue=(),
    )
    groups = []
    for first, second in pairs:
        if len(first) == len(second):
            groups.append(np.subtract(first, second))
        else:
            groups += [np.array(first), np.array(second)]
    groups = [group for group in groups if group.size > 1]
    if not groups:
        return math.hypot(life.sampling or 0.0, reference.sampling or 0.0)
    variances = np.array([group.var(ddof=1) / group.size for group in groups])
    freedoms = np.array([group.size - 1.0 for group in groups])
    variance = float(variances.sum())
    if variance == 0.0:
        return 0.0
    freedom = variance**2 / float((variances**2 / freedoms).sum())
    return quantile(freedom) * math.sqrt(variance)


def digits_of(error: float | None) -> int:
    """Return the digits of a life from the half width of its logarithm."""
    is_fine = error is None or error < _FINE
    return 3 if is_fine else 2


def span_of(strokes: float, error: float | None) -> str:
    """Return both ends of an interval from the half width of the logarithm, or nothing."""
    if error is None:
        return ""
    factor = math.exp(error)
    return large(strokes / factor, strokes * factor, digits=digits_of(error))


def in_diameter(key: str, value: float) -> str:
    """Return the diametral clearance for a limit on a radial one, or nothing."""
    if key.rpartition(".")[2] != "radial_clearance":
        return ""
    return f" ({quantity_text(2.0 * value, 'm')} in diameter)"


def words_of(key: str) -> str:
    """Return the words for a key, such as ``depth of A``."""
    joint, _, name = key.rpartition(".")
    words = LIFE_QUANTITIES[name].words
    return f"{words} of {joint}" if joint else words
