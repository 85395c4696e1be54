"""Families of methods, engine and integrator, each with its steps or tolerances."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

from presswear.engines.settings import ExudynJoints, InHouse, Integrator
from presswear.scene.scene import Numerics
from presswear.trials.precision.ladder import dae_method, tree_method
from presswear.trials.precision.points import Method

TRAPEZOIDAL = "trapezoidal rule"
FIXED = "trapezoidal rule, equal steps"
STEP, IMPACT, TOLERANCE = "step (s)", "steps in an impact", "tolerance"
"""What is varied."""
SMOOTH_NEWTON = 1e-12
"""Of Exudyn on smooth motion: 1e-9, the default, hides the order of the integrator."""
_EXACT = 1.0 - 1e-9
"""A step one part in 1e9 shorter keeps round-off from making them one fewer."""


@dataclass(frozen=True)
class Rungs:
    """Steps and tolerances of the families, coarse to fine.

    What a scene takes by itself is added to its family where it is missing.

    Attributes
    ----------
    free_steps : tuple of int
        Of the trapezoidal rule on smooth motion: steps in the run.
    smooth_steps : tuple of int
        The same of RK4.
    impact_steps : tuple of int
        Of the trapezoidal rule with contacts: steps in an impact.
    fixed_steps, contact_steps : tuple of float
        Equal steps of the trapezoidal rule and of RK4 with contacts, s.
    tolerances : tuple of float
        Of DOP853 and DOPRI5 in the in-house solver.
    tree_tolerances : tuple of float
        Of the open tree.
    """

    free_steps: tuple[int, ...]
    smooth_steps: tuple[int, ...]
    impact_steps: tuple[int, ...]
    fixed_steps: tuple[float, ...]
    contact_steps: tuple[float, ...]
    tolerances: tuple[float, ...]
    tree_tolerances: tuple[float, ...]


FEW = Rungs(
    free_steps=(300, 1000, 3000),
    smooth_steps=(300, 1000, 3000, 10_000),
    impact_steps=(20, 50, 100, 200),
    fixed_steps=(1e-5, 5e-6, 2e-6),
    contact_steps=(5e-5, 2e-5, 1e-5, 5e-6, 2e-6, 1e-6),
    tolerances=(1e-4, 1e-6, 1e-8, 1e-9, 1e-10, 1e-12),
    tree_tolerances=(1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10),
)
"""For a quick look."""
ALL = Rungs(
    free_steps=(300, 1000, 3000, 10_000, 30_000, 100_000),
    smooth_steps=(150, 300, 1000, 3000, 10_000, 30_000, 100_000),
    impact_steps=(20, 35, 50, 100, 200, 400, 800),
    fixed_steps=(1e-5, 5e-6, 2e-6, 1e-6, 5e-7),
    contact_steps=(5e-5, 2e-5, 1e-5, 5e-6, 2e-6, 1e-6, 5e-7, 2e-7, 1e-7),
    tolerances=(1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12),
    tree_tolerances=(1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11),
)


def _with_default(values: Sequence[float], default: float, rising: bool) -> list[float]:
    """Values and the default, coarse to fine."""
    return sorted({*values, default}, reverse=not rising)


def joints_over_steps(
    counts: Sequence[int], duration: float, numerics: Numerics | None, period: float
) -> Iterable[Method]:
    """The trapezoidal rule without contacts, over so many equal steps in a duration, s.

    Parameters
    ----------
    numerics : Numerics or None
        Whose own step, over a period, s, is added; None: there is none.
    """
    found = []
    for count in counts:
        step = duration / count
        accuracy = ExudynJoints(50, 10, free_step=step * _EXACT, newton=SMOOTH_NEWTON)
        found.append(Method("exudyn-joints", TRAPEZOIDAL, STEP, step, accuracy))
    if numerics is not None:
        own = numerics.joints.over(period)
        found.append(
            Method("exudyn-joints", TRAPEZOIDAL, STEP, own.longest(period), own, is_default=True)
        )
    return sorted(found, key=lambda method: -method.value)


def joints_over_impacts(
    counts: Sequence[int], numerics: Numerics, period: float
) -> Iterable[Method]:
    """The trapezoidal rule with steps chosen by contact; all its steps shrink together."""
    own = numerics.joints.over(period)
    for count in _with_default(counts, own.steps_per_contact, rising=True):
        finer = count / own.steps_per_contact
        accuracy = replace(
            own,
            steps_per_contact=int(count),
            steps_sustained=max(5, round(own.steps_sustained * finer)),
            free_step=own.longest(period) / finer,
            # Newton's errors shrink with those of the steps.
            newton=own.newton / max(finer, 1.0) ** 2,
        )
        is_default = accuracy == own
        yield Method("exudyn-joints", TRAPEZOIDAL, IMPACT, count, accuracy, is_default=is_default)


def joints_over_fixed(steps: Sequence[float]) -> Iterable[Method]:
    """The trapezoidal rule at equal steps throughout, s, contact or not.

    The longest allowed is shorter than any wanted.
    """
    for step in sorted(steps, reverse=True):
        yield Method("exudyn-joints", FIXED, STEP, step, ExudynJoints(1, 1, free_step=step))


def tree_over_tolerances(
    tolerances: Sequence[float], numerics: Numerics, period: float
) -> Iterable[Method]:
    """Exudyn's DOPRI5 on the open tree."""
    own = numerics.tree.over(period)
    for tolerance in _with_default(tolerances, own.tree_tolerance, rising=False):
        accuracy = replace(own, tree_tolerance=tolerance)
        yield replace(tree_method(accuracy), is_default=accuracy == own)


def dae_over_tolerances(
    tolerances: Sequence[float], numerics: Numerics, longest: float
) -> Iterable[Method]:
    """DOP853 and DOPRI5 of the in-house solver, with steps of at most a length, s."""
    own = replace(numerics.dae, free_step=longest)
    names: tuple[Integrator, ...] = ("dop853", "dopri5")
    for integrator in names:
        is_own = own.integrator == integrator
        values = (
            _with_default(tolerances, own.integration_tolerance, False) if is_own else tolerances
        )
        for tolerance in sorted(values, reverse=True):
            accuracy = replace(own, integrator=integrator, integration_tolerance=tolerance)
            yield replace(dae_method(accuracy), is_default=accuracy == own)


def dae_over_steps(steps: Sequence[float], numerics: Numerics) -> Iterable[Method]:
    """RK4 of the in-house solver at equal steps, s, and the paper's own setting."""
    own = numerics.dae
    values = _with_default(steps, own.step, False) if own.integrator == "rk4" else steps
    found = [dae_method(replace(own, integrator="rk4", equal_step=step)) for step in values]
    found = [replace(each, is_default=each.accuracy == own) for each in found]
    # The paper solves without projection.
    papers = dae_method(InHouse("rk4-paper"))
    own_paper = own.integrator == "rk4-paper"
    found = [each for each in found if not math.isclose(each.value, papers.value)]
    found.append(replace(papers, is_default=own_paper))
    return sorted(found, key=lambda method: -method.value)


def smooth_ladder(
    rungs: Rungs, duration: float, numerics: Numerics, period: float | None
) -> tuple[Method, ...]:
    """All methods for smooth motion of constrained bodies over a duration, s.

    Parameters
    ----------
    period : float or None
        Of a cycle of the scene that is run, s; None where it is no scene's.
    """
    own = None if period is None else numerics
    return (
        *joints_over_steps(rungs.free_steps, duration, own, period or duration),
        *dae_over_tolerances(rungs.tolerances, numerics, duration),
        *dae_over_steps([duration / count for count in rungs.smooth_steps], numerics),
    )


def contact_ladder(
    rungs: Rungs, numerics: Numerics, period: float, longest: float, tree: bool
) -> tuple[Method, ...]:
    """All methods for motion with contacts.

    Parameters
    ----------
    period : float
        Of a cycle, s.
    longest : float
        Step of DOP853 and DOPRI5, s.
    tree : bool
        Whether there is an open tree.
    """
    return (
        *joints_over_impacts(rungs.impact_steps, numerics, period),
        *joints_over_fixed(rungs.fixed_steps),
        *(tree_over_tolerances(rungs.tree_tolerances, numerics, period) if tree else ()),
        *dae_over_tolerances(rungs.tolerances, numerics, longest),
        *dae_over_steps(rungs.contact_steps, numerics),
    )
