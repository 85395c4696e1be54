"""Reference problems and methods of the benchmark of error against CPU time.

The problems are the ideal mechanism of a scene, Andrews' squeezer, one free impact, and
the scene with clearance. Its trajectories are compared up to the time at which two
starts 1e-9 m apart have separated a thousandfold.
"""

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from presswear.campaign.replicates import start_of
from presswear.engines.base import Plan, Run, Start
from presswear.engines.settings import (
    LEAST_STEPS,
    Engine,
    ExudynJoints,
    ExudynTree,
    InHouse,
    Integrator,
)
from presswear.linkage.joints import Guide
from presswear.linkage.linkage import Linkage
from presswear.linkage.normal_law import delivered_restitution
from presswear.linkage.topology import branches_of
from presswear.physics.constraints import constraints_of
from presswear.physics.curve_following import followed
from presswear.physics.ideal import Motion
from presswear.scene.options import Numerics
from presswear.scene.scene import Scene
from presswear.tools.arrays import Array
from presswear.tools.errors import RunFailed
from presswear.validation import andrews as squeezer
from presswear.validation import cases, crosscheck
from presswear.validation import reference_problems as references

STEP = "step (s)"
IMPACT = "steps in an impact"
TOLERANCE = "tolerance"
TRAPEZOIDAL = "trapezoidal rule"
EQUAL = "trapezoidal rule, equal steps"
TIGHT = InHouse(integration_tolerance=1e-13)  # reference solution
PAPER = InHouse("rk4-paper").resolved()
SMOOTH_NEWTON = 1e-12  # Newton's tolerance on smooth motion; 1e-9 hides the order
SHORTER = 1.0 - 1e-9  # keeps round-off from removing a step
# Cycles of the ideal mechanism; over whole cycles errors of periodic motion cancel
CYCLES = 1.25
GAP = 1e-5  # m, free flight before the impact
PARTS = 10  # sections of a run with clearance, each with a full recorded series
# Names of the errors of a run with clearance
_CLEARANCE_ERRORS = (
    "output (m)",
    "touchdowns (s)",
    "output velocity (m/s)",
    "closing speeds, relative",
    "peak forces, relative",
    "energy residual / exchanged",
)


@dataclass(frozen=True)
class Extent:
    """Settings at which the methods run, from coarse to fine, and repeats."""

    repeats: int
    longest: float  # s, time up to which trajectories with clearance are compared
    joints_steps: Sequence[int]  # in a run of smooth motion, trapezoidal rule
    rk4_steps: Sequence[int]  # in a run of smooth motion
    impact_steps: Sequence[int]  # in an impact, trapezoidal rule
    equal_steps: Sequence[float]  # s, with contacts, trapezoidal rule
    rk4_impact_steps: Sequence[float]  # s, with contacts
    tolerances: Sequence[float]  # tolerances of DOP853 and DOPRI5 in dae
    tree_tolerances: Sequence[float]


DATA = cases.read("benchmark_problems.toml")
FULL, QUICK = (Extent(**values) for values in DATA["extents"].values())


@dataclass(frozen=True)
class Method:
    """Engine and integrator at one step or tolerance."""

    engine: Engine
    integrator: str
    parameter: str  # STEP, IMPACT or TOLERANCE
    value: float
    is_default: bool = False  # settings that a scene uses for trajectories

    @property
    def is_paper(self) -> bool:
        """True for RK4 at 1e-4 s."""
        return self.engine == PAPER

    @property
    def family(self) -> str:
        """Engine and integrator: the name of a curve."""
        return f"{self.engine.word}, {self.integrator}"

    @property
    def label(self) -> str:
        """Family and setting."""
        return f"{self.family}, {self.parameter.partition(' (')[0]} {self.value:g}"


@dataclass(frozen=True)
class Problem:
    """Reference problem that every method solves."""

    name: str
    # names of the errors, uncertainty of the reference; 0 if exact
    quantities: Mapping[str, float]
    linkage: Linkage
    start: Start
    plan: Plan
    methods: tuple[Method, ...]
    # Errors of a completed run in the order of ``quantities``; RunFailed if it lacks
    # some.
    errors: Callable[[Run], Iterable[float]]


def dae_methods(
    tolerances: Sequence[float], steps: Sequence[float], default: InHouse
) -> list[Method]:
    """Return DOP853, DOPRI5 and RK4 with equal steps, s, in ``dae``, and the paper's setting."""
    methods = []
    controlled: tuple[Integrator, ...] = ("dop853", "dopri5")
    for name in controlled:
        values = set(tolerances)
        if default.integrator == name:
            values.add(default.tolerance)
        for value in sorted(values, reverse=True):
            engine = replace(default, integrator=name, integration_tolerance=value)
            is_default = engine == default
            method = Method(engine, name.upper(), TOLERANCE, value, is_default)
            methods.append(method)
    values = set(steps)
    if default.integrator == "rk4":
        values.add(default.step)
    engines = [PAPER]
    for value in values:
        engine = replace(default, integrator="rk4", equal_step=value)
        if not math.isclose(engine.step, PAPER.step):
            engines.append(engine)
    for engine in sorted(engines, key=lambda settings: -settings.step):
        is_rk4 = default.integrator == engine.integrator
        is_default = is_rk4 and engine.step == default.step
        methods.append(Method(engine, "RK4", STEP, engine.step, is_default))
    return methods


def smooth_methods(
    extent: Extent, duration: float, numerics: Numerics, period: float | None
) -> tuple[Method, ...]:
    """Return all methods for smooth motion over a duration, s; the period is that of a scene, s."""
    numerics = numerics.resolved("trajectory")
    joints = []
    for count in extent.joints_steps:
        step = duration / count
        engine = ExudynJoints(50, 10, free_step=step * SHORTER, newton=SMOOTH_NEWTON)
        joints.append(Method(engine, TRAPEZOIDAL, STEP, step))
    if period is not None:
        engine = numerics.joints.for_cycle(period)
        step = engine.longest(period)
        joints.append(Method(engine, TRAPEZOIDAL, STEP, step, is_default=True))
    steps = [duration / count for count in extent.rk4_steps]
    default = replace(numerics.dae, free_step=duration)
    dae = dae_methods(extent.tolerances, steps, default)
    return (*sorted(joints, key=lambda method: -method.value), *dae)


def joints_over_impacts(
    counts: Sequence[int], numerics: Numerics, period: float
) -> list[Method]:
    """Return the trapezoidal rule at several steps in an impact; all its steps shrink together."""
    default = numerics.joints.for_cycle(period)
    methods = []
    for count in sorted({*counts, default.steps_per_contact}):
        factor = count / default.steps_per_contact
        engine = crosscheck.finer_joints(default, factor, period)
        methods.append(Method(engine, TRAPEZOIDAL, IMPACT, count, engine == default))
    return methods


def contact_methods(
    extent: Extent, numerics: Numerics, period: float, longest: float, linkage: Linkage
) -> tuple[Method, ...]:
    """Return all methods for motion with contacts; that of the tree if the linkage is an open tree.

    ``numerics`` are resolved; ``longest`` is the longest step of DOP853 and DOPRI5 in
    ``dae``, s.
    """
    methods = joints_over_impacts(extent.impact_steps, numerics, period)
    for step in extent.equal_steps:
        # The longest step allowed is shorter than any step of a contact, so that steps
        # are equal.
        methods.append(Method(ExudynJoints(1, 1, free_step=step), EQUAL, STEP, step))
    tree = numerics.tree.for_cycle(period)
    tolerances = {*extent.tree_tolerances, tree.tolerance}
    if isinstance(branches_of(linkage), str):  # no open tree
        tolerances = set()
    for value in sorted(tolerances, reverse=True):
        engine = replace(tree, tree_tolerance=value)
        methods.append(Method(engine, "DOPRI5", TOLERANCE, value, engine == tree))
    dae = replace(numerics.dae, free_step=longest)
    return (*methods, *dae_methods(extent.tolerances, extent.rk4_impact_steps, dae))


def constraint_error(linkage: Linkage, run: Run) -> float:
    """Return the largest violation of a position constraint at the end of a run, m or rad."""
    constraints = constraints_of(linkage)
    phi, *_ = constraints.evaluate(run.time, run.end.position, run.end.velocity)
    return float(np.abs(phi).max())


def ideal_mechanism(scene: Scene, extent: Extent, report: cases.Progress) -> Problem:
    """Return the mechanism of a scene with every joint ideal, whose reference is a closed form."""
    linkage = followed(scene.mechanism.linkage())
    period = scene.mechanism.period
    motion = scene.ideal.at(np.zeros(1))
    duration = CYCLES * period

    def errors(run: Run) -> Sequence[float]:
        series = run.recorder.series
        exact = scene.ideal_slider(series("time"))[:, :2]
        output = np.column_stack([series("displacement"), series("velocity")])
        return [*np.abs(output - exact).max(axis=0), constraint_error(linkage, run)]

    # Round-off after 1e5 steps
    quantities = {
        "output (m)": 5e-14,
        "output velocity (m/s)": 1e-12,
        "constraints (m, rad)": 1e-12,
    }
    start = Start(motion.position[0], motion.velocity[0])
    plan = Plan(duration, 1, 1, torques=False)
    methods = smooth_methods(extent, duration, scene.numerics, period)
    name = "ideal mechanism"
    return Problem(name, quantities, linkage, start, plan, methods, errors)


def andrews(scene: Scene, extent: Extent, report: cases.Progress) -> Problem:
    """Return Andrews' squeezer; the reference is the solution of the IVP test set
    (Mazzia and Magherini).

    The uncertainty of the printed values is their distance from a solution at tolerance
    1e-13.
    """
    linkage = squeezer.andrews()
    start = squeezer.andrews_start()
    duration = squeezer.ANDREWS_DURATION
    plan = Plan(duration, 1, 1, torques=False)

    def errors(run: Run) -> Sequence[float]:
        angles = squeezer.andrews_angles(run.end.position) - squeezer.ANDREWS_ANGLES
        rates = squeezer.andrews_angles(run.end.velocity) - squeezer.ANDREWS_RATES
        largest = [float(np.abs(values).max()) for values in (angles, rates)]
        return [*largest, constraint_error(linkage, run)]

    exact = cases.finished(TIGHT.simulate(linkage, start, plan))
    angle_error, rate_error, _ = errors(exact)
    quantities = {
        "angles (rad)": angle_error,
        "rates (rad/s)": rate_error,
        "constraints (m)": 1e-12,
    }
    methods = smooth_methods(extent, duration, Numerics(), None)
    name = "Andrews' squeezer"
    return Problem(name, quantities, linkage, start, plan, methods, errors)


def single_impact(scene: Scene, extent: Extent, report: cases.Progress) -> Problem:
    """Return one free impact of a shaft in a ring, with the numerics of a scene.

    The reference is the closed form of the restitution and a quadrature of the contact
    time. Guides along the line of impact change nothing and make the linkage an open
    tree.
    """
    impact = references.Impact(0.9)
    start = impact.start
    bodies = impact.linkage.bodies
    guides = tuple(Guide(f"guide of {b.name}", b.name, 0.0, 0.0, 0.0) for b in bodies)
    linkage = replace(impact.linkage, joints=guides)
    start.position[references.SHAFT_X] = impact.clearance - GAP
    restitution = delivered_restitution(impact.damping)
    contact_time, uncertainty = impact.duration()
    kinetic = 0.5 * bodies[1].mass * impact.speed**2
    duration = GAP / impact.speed + 2.2 * impact.elastic_duration
    numerics = scene.numerics.resolved("trajectory")

    def errors(run: Run) -> Sequence[float]:
        computed_restitution, computed_time = _restitution_and_time(impact, run)
        return [
            abs(computed_restitution - restitution),
            abs(computed_time - contact_time),
            abs(float(run.diagnostics["energy_residual_J"])) / kinetic,
        ]

    quantities = {
        "restitution": 1e-14,
        "contact time (s)": max(uncertainty, 1e-14 * contact_time),
        "energy residual / kinetic": 0.0,
    }
    plan = Plan(duration, 1, 1, torques=False)
    period = scene.mechanism.period
    methods = contact_methods(extent, numerics, period, duration, linkage)
    return Problem("one impact", quantities, linkage, start, plan, methods, errors)


def _restitution_and_time(impact: references.Impact, run: Run) -> tuple[float, float]:
    """Return restitution and contact time, s; RunFailed unless there is one complete contact."""
    contacts = cases.contacts_of(run)
    count = contacts["touchdown"].size
    if count != 1:
        raise RunFailed(f"expected one contact, found {count}")
    # No force acts after the contact, so that its end follows from the final state.
    ring = references.RING_X
    shaft = references.SHAFT_X
    gap = run.end.position[shaft] - run.end.position[ring] - impact.clearance
    rate = run.end.velocity[shaft] - run.end.velocity[ring]
    if not (gap < 0.0 and rate < 0.0):
        raise RunFailed("the shaft is still in contact, or has passed through the ring")
    (touchdown,) = contacts["touchdown"]
    (release_speed,) = contacts["release_speed"]
    return -release_speed / impact.speed, run.time - gap / rate - touchdown


def with_clearance(scene: Scene, extent: Extent, report: cases.Progress) -> Problem:
    """Return the unworn linkage of a scene up to its horizon.

    The reference is DOP853 at tolerance 1e-13. Its uncertainty is its distance from the
    open tree in Exudyn at 1e-12, or from DOPRI5 at 1e-13 if the linkage is no open
    tree.
    """
    linkage = scene.linkage()
    start = start_of(scene)
    period = scene.mechanism.period
    end = crosscheck.horizon(scene, TIGHT, extent.longest, report)
    plan = Plan(end / PARTS, PARTS, PARTS, torques=False)
    second: Engine = InHouse("dopri5", 1e-13)
    if not isinstance(branches_of(linkage), str):
        second = ExudynTree(1e-12)
    runs = []
    for engine in (TIGHT, second):
        run = engine.for_cycle(period).simulate(linkage, start, plan)
        runs.append(cases.finished(run))
    exact, check = runs
    first = crosscheck.touchdowns_of(exact)[: crosscheck.FIRST_TOUCHDOWNS]
    end_of_exact = _output_at_end(linkage, exact)

    def errors(run: Run) -> Sequence[float]:
        touchdowns = crosscheck.touchdowns_of(run)
        differences = crosscheck.touchdown_differences(first, touchdowns)
        missing = int(np.count_nonzero(np.isinf(differences[:, 0])))
        if missing:
            raise RunFailed(f"{missing} of the first {len(first)} touchdowns missing")
        times, speeds, forces = differences.max(axis=0, initial=0.0)
        position, velocity = np.abs(_output_at_end(linkage, run) - end_of_exact)
        energy = cases.missing_energy(run)
        numbers = (position, times, velocity, speeds, forces, energy)
        return [float(number) for number in numbers]

    # Energy is conserved exactly, so that the residual needs no reference.
    quantities = dict(zip(_CLEARANCE_ERRORS, [*errors(check)[:-1], 0.0], strict=True))
    numerics = scene.numerics.resolved("trajectory")
    methods = contact_methods(extent, numerics, period, period / LEAST_STEPS, linkage)
    name = f"scene {scene.name}, {end:.3g} s"
    return Problem(name, quantities, linkage, start, plan, methods, errors)


def _output_at_end(linkage: Linkage, run: Run) -> Array:
    """Return position, m, and velocity, m/s, of the output point at the end of a run."""
    q = run.end.position[np.newaxis]
    v = run.end.velocity[np.newaxis]
    motion = Motion(np.array([run.time]), q, v, np.zeros_like(v))
    return motion.output(linkage)[0, :2]


# Each function gets a scene, an extent, and a function to report progress.
MAKERS = (ideal_mechanism, andrews, single_impact, with_clearance)
