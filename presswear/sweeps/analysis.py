"""Analysis of a response of a sweep: sensitivity, surrogate, distribution."""

from dataclasses import dataclass

from presswear.sweeps.plan import NOT_RUN, Plan, Table
from presswear.sweeps.response_distribution import Spread, spread_of_rows
from presswear.sweeps.response_limits import ResponseLimit
from presswear.sweeps.response_points import Points, points_of
from presswear.sweeps.sensitivity import Sensitivity, chaotic_share, sensitivity
from presswear.sweeps.surrogate import Surrogate, fit
from presswear.tools.errors import InputError
from presswear.tools.numbers import readable, whole


@dataclass(frozen=True)
class Analysis:
    """Analysis of one response of a sweep; None for a part that the points do not allow."""

    points: Points
    sensitivity: Sensitivity | None
    surrogate: Surrogate | None
    spread: Spread | None
    limit: ResponseLimit | None
    notes: tuple[str, ...]
    failed: str = ""  # see ``failed_text``


def failed_text(table: Table) -> str:
    """Return how many runs failed; empty for none. Statistics do not include them."""
    failed = sum(error not in ("", NOT_RUN) for error in table.errors)
    if not failed:
        return ""
    return f"{whole(failed)} of {whole(len(table.errors))} runs failed"


def analyze(
    table: Table, key: str, plan: Plan, limit: ResponseLimit | None = None
) -> Analysis:
    """Analyse a response of the rows of a plan, or of those with equal varied values."""
    points = points_of(table, key)
    kind = plan.sample.partition(":")[0]
    notes = []
    result = None
    surrogate = None
    try:
        result = sensitivity(points, kind)
    except InputError as error:
        notes.append(f"{error}.")
    try:
        surrogate = fit(points)
    except InputError as error:
        if plan.sample:
            notes.append(f"{error}.")
    spread = None
    sampled = plan.distributions
    distributions = [
        sampled[column.key] for column in points.parameters if column.key in sampled
    ]
    if len(distributions) == len(points.parameters):
        if surrogate is not None:
            reason = surrogate.outside(distributions)
            if reason:
                notes.append(f"The surrogate gives no distribution: {reason}.")
            else:
                spread = surrogate.spread(distributions, limit)
        if spread is None and kind in ("sobol", "latin"):
            spread = spread_of_rows(table, key, limit)
    return Analysis(
        points,
        result,
        surrogate,
        spread,
        limit,
        (*notes, *_point_notes(points, key)),
        failed_text(table),
    )


def _point_notes(points: Points, key: str) -> list[str]:
    """Return notes on lower bounds and on chaotic motion among the values of a response."""
    notes = []
    if points.censored.any():
        count = whole(int(points.censored.sum()))
        notes.append(
            f"The values of {count} points are lower bounds; indices use the bounds."
        )
    chaos = chaotic_share(points)
    if chaos is not None:
        notes.append(
            f"Scatter of chaotic motion is {percent_text(chaos)} of the variance of single runs "
            f"of {key}; the rest comes from the parameters."
        )
    return notes


def percent_text(share: tuple[float, float, float]) -> str:
    """Return a share and its interval in per cent."""
    value, low, high = (readable(100.0 * number) for number in share)
    return f"{value} % ({low} to {high} %)"
