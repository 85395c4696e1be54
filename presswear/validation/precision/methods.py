"""Methods, engine and integrator with one step or tolerance, and their families."""

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from operator import attrgetter
from typing import Protocol, TypeVar

from presswear.engines.settings import Engine, ExudynJoints, ExudynTree, InHouse, Integrator
from presswear.physics.tree import Tree, tree_of
from presswear.scene.numerics import Numerics
from presswear.scene.scene import Scene

TRAPEZOIDAL = "trapezoidal rule"
FIXED = "trapezoidal rule, equal steps"
STEP, IMPACT, TOLERANCE = "step (s)", "steps in an impact", "tolerance"
"""Knobs: the quantities that are varied, with their units."""
SMOOTH_NEWTON = 1e-12
"""Newton's tolerance on smooth motion: 1e-9, the default, hides the order of the integrator."""
_EXACT = 1.0 - 1e-9
"""A step one part in 1e9 shorter keeps round-off from making them one fewer."""
_CONTROLLED: tuple[Integrator, ...] = ("dop853", "dopri5")
_INTEGRATORS = {"dop853": "DOP853", "dopri5": "DOPRI5", "rk4": "RK4", "rk4-paper": "RK4"}

STATISTICS_TREE = (1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8)
STATISTICS_TOLERANCES = (1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9)
"""Tolerances with which statistics are run; the last of DOP853 is their reference."""
STATISTICS_STEPS = (8e-5, 5e-5, 2e-5)  # s


@dataclass(frozen=True)
class Method:
    """An engine with one step or tolerance.

    Attributes
    ----------
    integrator : str
        As people call it: trapezoidal rule, DOPRI5, DOP853, RK4.
    knob : str
        Quantity that is varied, with its unit.
    value : float
        Value of the knob.
    is_paper : bool
        True for the paper's own setting: RK4 at 1e-4 s.
    is_default : bool
        True where scenes take it by themselves.
    """

    engine: Engine
    integrator: str
    knob: str
    value: float
    is_paper: bool = False
    is_default: bool = False

    @property
    def family(self) -> str:
        """Name of its curve in a diagram."""
        return f"{self.engine.word}, {self.integrator}"

    @property
    def setting(self) -> str:
        """Integrator, step or tolerance in a few words."""
        return f"{self.integrator}, {self.knob.partition(' (')[0]} {self.value:g}"

    @property
    def label(self) -> str:
        """The method in a few words."""
        return f"{self.engine.word}, {self.setting}"


@dataclass(frozen=True)
class Rungs:
    """Steps and tolerances of the families, coarse to fine.

    The setting that a scene takes by itself is added to its family where it is missing.

    Attributes
    ----------
    free_steps : tuple of int
        Steps in the run of the trapezoidal rule on smooth motion.
    smooth_steps : tuple of int
        Steps in the run of RK4 on smooth motion.
    impact_steps : tuple of int
        Steps in an impact of the trapezoidal rule with contacts.
    fixed_steps, contact_steps : tuple of float
        Equal steps of the trapezoidal rule and of RK4 with contacts, s.
    tolerances : tuple of float
        Those of DOP853 and DOPRI5 in the in-house solver.
    tree_tolerances : tuple of float
        Those of the open tree.
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


class _OfMethod(Protocol):
    @property
    def method(self) -> Method: ...


P = TypeVar("P", bound=_OfMethod)


def grouped(
    points: Iterable[P], key: Callable[[Method], str] = attrgetter("family")
) -> dict[str, list[P]]:
    """Points by a word on their methods, in their order: families run from coarse to fine."""
    found: dict[str, list[P]] = {}
    for point in points:
        found.setdefault(key(point.method), []).append(point)
    return found


def method_of(engine: ExudynTree | InHouse, own: Engine) -> Method:
    """An explicit engine as a method.

    Parameters
    ----------
    own : Engine
        The engine that a scene takes by itself.
    """
    engine = engine.resolved()
    is_default = engine == own.resolved()
    if isinstance(engine, ExudynTree):
        return Method(engine, "DOPRI5", TOLERANCE, engine.tolerance, is_default=is_default)
    name, is_paper = _INTEGRATORS[engine.integrator], engine.integrator == "rk4-paper"
    knob, value = TOLERANCE, engine.tolerance
    if engine.has_equal_steps:
        knob, value = STEP, engine.step
    return Method(engine, name, knob, value, is_paper, is_default)


def joints_over_impacts(
    counts: Sequence[int], numerics: Numerics, period: float
) -> Iterator[Method]:
    """The trapezoidal rule with steps chosen by contact; all its steps shrink together."""
    own = numerics.joints.over(period)
    for count in sorted({*counts, own.steps_per_contact}):
        finer = count / own.steps_per_contact
        engine = replace(
            own,
            steps_per_contact=count,
            steps_sustained=max(5, round(own.steps_sustained * finer)),
            free_step=own.longest(period) / finer,
            # Newton's errors shrink with those of the steps.
            newton=own.newton / max(finer, 1.0) ** 2,
        )
        yield Method(engine, TRAPEZOIDAL, IMPACT, count, is_default=engine == own)


def tree_over_tolerances(tolerances: Sequence[float], own: ExudynTree) -> Iterator[Method]:
    """Exudyn's DOPRI5 on the open tree."""
    for tolerance in sorted({*tolerances, own.tolerance}, reverse=True):
        yield method_of(replace(own, tree_tolerance=tolerance), own)


def dae_over_tolerances(tolerances: Sequence[float], own: InHouse) -> Iterator[Method]:
    """DOP853 and DOPRI5 of the in-house solver."""
    for name in _CONTROLLED:
        taken = {own.tolerance} if own.integrator == name else set()
        for tolerance in sorted({*tolerances, *taken}, reverse=True):
            engine = replace(own, integrator=name, integration_tolerance=tolerance)
            yield method_of(engine, own)


def dae_over_steps(steps: Sequence[float], own: InHouse) -> list[Method]:
    """RK4 of the in-house solver at equal steps, s, and the paper's own setting."""
    values = {*steps, own.step} if own.integrator == "rk4" else {*steps}
    # The paper solves without projection.
    papers = method_of(InHouse("rk4-paper"), own)
    found = [
        method_of(replace(own, integrator="rk4", equal_step=step), own)
        for step in values
        if not math.isclose(step, papers.value)
    ]
    found.append(replace(papers, is_default=own.integrator == "rk4-paper"))
    return sorted(found, key=lambda method: -method.value)


def smooth_methods(
    rungs: Rungs, duration: float, numerics: Numerics, period: float | None
) -> tuple[Method, ...]:
    """All methods for smooth motion of constrained bodies over a duration, s.

    Parameters
    ----------
    period : float or None
        Period of a cycle of the scene that is run, s, over which its own step of the trapezoidal
        rule is added; None where it is no scene's.
    """
    numerics = numerics.resolved("trajectory")
    joints = []
    for step in (duration / count for count in rungs.free_steps):
        engine = ExudynJoints(50, 10, free_step=step * _EXACT, newton=SMOOTH_NEWTON)
        joints.append(Method(engine, TRAPEZOIDAL, STEP, step))
    if period is not None:
        own = numerics.joints.over(period)
        joints.append(Method(own, TRAPEZOIDAL, STEP, own.longest(period), is_default=True))
    return (
        *sorted(joints, key=lambda method: -method.value),
        *dae_over_tolerances(rungs.tolerances, replace(numerics.dae, free_step=duration)),
        *dae_over_steps([duration / count for count in rungs.smooth_steps], numerics.dae),
    )


def contact_methods(
    rungs: Rungs, numerics: Numerics, period: float, longest: float, tree: bool
) -> tuple[Method, ...]:
    """All methods for motion with contacts.

    Parameters
    ----------
    period : float
        Period of a cycle, s.
    longest : float
        Longest step of DOP853 and DOPRI5, s.
    tree : bool
        True where there is an open tree.
    """
    # Contact or not, these steps are equal: the longest allowed is shorter than any wanted.
    numerics = numerics.resolved("trajectory")
    fixed = [(ExudynJoints(1, 1, free_step=step), step) for step in rungs.fixed_steps]
    own_tree = numerics.tree.over(period)
    return (
        *joints_over_impacts(rungs.impact_steps, numerics, period),
        *(Method(engine, FIXED, STEP, step) for engine, step in fixed),
        *(tree_over_tolerances(rungs.tree_tolerances, own_tree) if tree else ()),
        *dae_over_tolerances(rungs.tolerances, replace(numerics.dae, free_step=longest)),
        *dae_over_steps(rungs.contact_steps, numerics.dae),
    )


def statistics_methods(scene: Scene) -> tuple[Method, ...]:
    """All methods for statistics of a scene."""
    numerics = scene.numerics.resolved("wear", scene.tolerance)
    tree = numerics.tree.over(scene.mechanism.period)
    is_tree = isinstance(tree_of(scene.linkage()), Tree)
    return (
        *(tree_over_tolerances(STATISTICS_TREE, tree) if is_tree else ()),
        *dae_over_tolerances(STATISTICS_TOLERANCES, numerics.dae),
        *dae_over_steps(STATISTICS_STEPS, numerics.dae),
    )


def finest(scene: Scene) -> Method:
    """The method that the statistics of all others are compared with."""
    own = scene.numerics.dae
    tolerance = STATISTICS_TOLERANCES[-1]
    engine = replace(own, integrator="dop853", integration_tolerance=tolerance)
    return replace(method_of(engine, own), is_default=False)
