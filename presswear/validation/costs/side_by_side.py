"""Same work, side by side: the engines, what one would write by hand, and other simulators.

Task a is the first touches from the start, up to where trajectories can be compared: each method
is run over its settings, and its cost is read off at the same error.  Task b is some cycles, in
which pins rest in contact nine tenths of the time, at the settings that make that error in task
a: there is no trajectory to compare.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from importlib import import_module
from statistics import median
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import null_space
from scipy.stats import gmean

from presswear.campaign.replicates import start_of
from presswear.engines.base import Plan, Run, Start, recorder_of
from presswear.engines.settings import Engine, InHouse, Integrator
from presswear.physics.constraints import constraints_of
from presswear.scene.scene import Scene
from presswear.tools.errors import RunFailed
from presswear.validation.costs.by_hand import SIZE, march, numbers_of
from presswear.validation.costs.outcome import Found, Landings, Outcome, Touches, measured, state_of
from presswear.validation.costs.scipy_codes import METHODS, solve
from presswear.validation.costs.simulators import SIMULATORS, installed
from presswear.validation.crosscheck.traces import touchdowns_of
from presswear.validation.precision.methods import joints_over_impacts
from presswear.validation.runs import Told, part_of

Array = NDArray[np.float64]
Runs = Callable[[float, float], Outcome]
"""Runs a method at a setting up to a time, s."""

REFERENCE = 1e-12
"""Tolerance of the in-house solver that errors are held against."""
LEVELS = (1e-6, 1e-7, 1e-9)
"""Errors at which costs are compared, m."""
TOO_DEAR = 40.0
"""Cost in task a, of the open tree's as scenes take it, above which task b is left out."""
PATIENCE = 4.0
"""Processor time above which a run is not repeated, s."""
APART = 5e-3
"""How much faster the slider, m/s, and rod 3, rad/s, are from one start to the next."""
TREE, IN_HOUSE, HAND = "exudyn-tree", "dae, ", "by hand, RK4"
TOLERANCES = (1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10)
STEPS = (5e-5, 2e-5, 1e-5, 5e-6, 2e-6, 1e-6, 5e-7, 2e-7)  # s
COUNTS = (20.0, 50.0, 100.0, 200.0, 400.0, 800.0)  # steps in an impact


@dataclass(frozen=True)
class Setting:
    """A method at one setting in one task.

    Attributes
    ----------
    value : float
        Tolerance, step, s, or steps in an impact.
    steps, evaluations : float
        A simulated second of the last start; 0 evaluations where they are not counted.
    seconds : tuple of float
        Processor time a simulated second, s/s, of each start.
    error, touch_error : float or None
        Greatest error at the end of the slider's place and of the links' turned ends, m, and of
        the touches' times, s, geometric means over the starts; None in task b.
    failure : str
        Why it failed, or nothing.
    """

    DERIVED: ClassVar = ("cost",)

    value: float
    steps: float = 0.0
    evaluations: float = 0.0
    seconds: tuple[float, ...] = ()
    error: float | None = None
    touch_error: float | None = None
    failure: str = ""

    @property
    def cost(self) -> float | None:
        """Median processor time a simulated second, s/s; None where it failed."""
        return median(self.seconds) if self.seconds and not self.failure else None


@dataclass(frozen=True)
class Level:
    """A method where it makes an error: its setting and cost in task a, and its run in task b."""

    error: float
    value: float
    cost: float
    long: Setting | None = None


@dataclass(frozen=True)
class Method:
    """A method with its settings in task a, and where it makes the errors of LEVELS, if it does."""

    name: str
    settings: tuple[Setting, ...]
    levels: tuple[Level | None, ...]


@dataclass(frozen=True)
class SideBySide:
    """All methods at the same work.

    Attributes
    ----------
    short, long : float
        Simulated times of the tasks, s.
    touches : int
        Touches in task a.
    units : tuple of Setting
        The open tree as scenes take it in both tasks.
    missing : tuple of str
        Simulators that are not installed.
    """

    short: float
    long: float
    touches: int
    units: tuple[Setting, Setting]
    methods: tuple[Method, ...]
    missing: tuple[str, ...]


def starts_of(scene: Scene, count: int) -> list[Start]:
    """The start of a scene, and others beside it whose free bodies are faster.

    One start alone may be lucky: where a touch falls between two steps makes the error.
    """
    linkage, start = scene.linkage(), start_of(scene)
    free = null_space(constraints_of(linkage).evaluate(0.0, start.position, start.velocity)[3])
    places = [3 * linkage.index("slider 6") + 1, 3 * linkage.index("rod 3") + 2]
    faster = free @ free[places].sum(axis=0)
    velocities = (start.velocity + APART * k * faster for k in range(count))
    return [replace(start, velocity=velocity) for velocity in velocities]


def run_engine(scene: Scene, start: Start, engine: Engine, end: float, recorded: bool) -> Outcome:
    """Run an engine on the unworn linkage of a scene; RunFailed if it fails."""
    linkage, plan = scene.linkage(), Plan(end, 1, 1, torques=False)
    engine, recorder = (
        engine.resolved().over(scene.mechanism.period),
        recorder_of(linkage, start, plan),
    )
    prepare = import_module(f"presswear.engines.{engine.word.replace('-', '_')}.engine").prepare
    running = prepare(linkage, start, engine, plan, recorder)
    if not recorded:
        recorder.stop_recording()

    def run() -> Found:
        finding = running.advance(end)
        if finding is not None:
            raise RunFailed(finding.words)
        return np.zeros(SIZE), (), 0, 0

    outcome = measured(run)
    time, position, velocity = running.state()
    final, told = Start(position, velocity), running.diagnostics()
    running.close()
    touches = touchdowns_of(Run("completed", None, recorder, final, time))
    return replace(
        outcome,
        end=state_of(linkage, final),
        touches=[(own.joint, own.time) for own in touches],
        steps=int(told["steps"]) + int(told["steps_sent_back"]),
        evaluations=int(told.get("evaluations", 0)),
    )


def run_by_hand(press: Any, start: Array, step: float, end: float) -> Outcome:
    """Run the loop by hand with equal steps, s."""
    y, own, count = start.copy(), Landings(), round(end / step)

    def run() -> Found:
        arrays = (own.onset, own.gaps, own.touches, own.noted, np.zeros(2))
        march(press, y, end, count, *arrays)
        return y, own.told, count, 4 * count

    return measured(run)


def methods_of(
    scene: Scene, start: Start, recorded: float
) -> dict[str, tuple[tuple[float, ...], Runs]]:
    """Settings of each method, coarse to fine, and how it runs; up to a time, s, recorded."""
    press, period = numbers_of(scene), scene.mechanism.period
    own = scene.numerics.resolved("trajectory")
    at_start = state_of(scene.linkage(), start)
    longest = own.tree.longest(period)

    def engine(make: Callable[[float], Engine]) -> Runs:
        return lambda value, end: run_engine(scene, start, make(value), end, end <= recorded)

    def in_house(order: Integrator) -> Runs:
        dae = replace(own.dae, integrator=order)
        return engine(lambda value: replace(dae, integration_tolerance=value))

    def joints(value: float) -> Engine:
        found = joints_over_impacts((round(value),), own, period)
        return next(method.engine for method in found if method.value == round(value))

    def by(peer: Callable[..., Outcome], *words: str) -> Runs:
        return lambda value, end: peer(press, at_start, end, *words, value, longest)

    tree = sorted({*TOLERANCES, own.tree.tolerance}, reverse=True)
    found: dict[str, tuple[tuple[float, ...], Runs]] = {
        TREE: (tuple(tree), engine(lambda value: replace(own.tree, tree_tolerance=value)))
    }
    orders: tuple[Integrator, ...] = ("dopri5", "dop853")
    for order in orders:
        found[f"{IN_HOUSE}{order.upper()}"] = (1e-3, *TOLERANCES), in_house(order)
    found["exudyn-joints"] = COUNTS, engine(joints)
    found[HAND] = STEPS, partial(run_by_hand, press, at_start)
    for code, fine in METHODS.items():
        found[f"by hand, {code}"] = TOLERANCES[:fine], by(solve, code)
    for package, (name, simulate, equal) in SIMULATORS.items():
        if installed(package):
            found[name] = (STEPS[:-2] if equal else (1e-3, *TOLERANCES[:-2])), by(simulate)
    return found


def distance(press: Any, one: Array, other: Array) -> float:
    """Greatest of the slider's way and those of the turned links' ends between states, m."""
    p = press[0]
    lengths = np.array([np.hypot(p["b_x"], p["b_y"]), p["length_3"], 1.0, p["length_5"]])
    return float(np.abs(lengths * (one - other)[:4]).max())


def touch_distance(one: Touches, other: Touches) -> float:
    """Greatest difference of the touches' times, s, joint by joint; infinite where one lacks."""
    if sorted(k for k, _ in one) != sorted(k for k, _ in other):
        return math.inf
    pairs = zip(sorted(one), sorted(other), strict=True)
    return max((abs(t - s) for (_, t), (_, s) in pairs), default=0.0)


def at_error(settings: Sequence[Setting], error: float) -> Level | None:
    """Where a method makes an error, m: between the two settings around it, in logarithms.

    The finer one of them is the coarsest from which on none is worse; None where even the
    finest is.  A method that is never worse is taken at its coarsest.
    """
    ran = [(own.error, own.cost, own.value) for own in settings if own.cost and own.error]
    first = 1 + max((i for i, own in enumerate(ran) if not own[0] <= error), default=-1)
    if first == len(ran):
        return None
    fine, coarse = ran[first], ran[max(first - 1, 0)]
    part = math.log(error / coarse[0]) / math.log(fine[0] / coarse[0]) if first else 0.0
    cost, value = (a ** (1.0 - part) * b**part for a, b in zip(coarse[1:], fine[1:], strict=True))
    return Level(error, value, cost)


class _Tried:
    """A method at a setting, run from several starts up to a time, s."""

    def __init__(self, name: str, value: float, end: float):
        self.name, self.end, self.setting = name, end, Setting(value)
        self.outcomes: list[Outcome] = []

    def again(self, runs: Runs) -> None:
        """Run it from one more start; one that has failed, or takes long, is left alone."""
        known = self.setting.seconds
        if self.setting.failure or (known and known[0] * self.end > PATIENCE):
            return
        try:
            own = runs(self.setting.value, self.end)
        except RunFailed as failed:
            self.setting = replace(self.setting, failure=str(failed))
            return
        self.outcomes.append(own)
        steps, evaluations = own.steps / self.end, own.evaluations / self.end
        seconds = (*known, own.seconds / self.end)
        self.setting = replace(self.setting, steps=steps, evaluations=evaluations, seconds=seconds)

    def compared(self, press: Any, references: Sequence[Outcome]) -> Setting:
        """The setting with its errors."""
        if self.setting.failure:
            return self.setting
        pairs = list(zip(references, self.outcomes, strict=False))
        error = gmean([distance(press, own.end, reference.end) for reference, own in pairs])
        apart = gmean([touch_distance(reference.touches, own.touches) for reference, own in pairs])
        return replace(self.setting, error=float(error), touch_error=float(apart))


def side_by_side(scene: Scene, short: float, cycles: float, repeats: int, told: Told) -> SideBySide:
    """Run all methods on the unworn press of a scene: up to ``short``, s, and so many cycles.

    RunFailed where the open tree as scenes take it fails.
    """
    press, long = numbers_of(scene), cycles * scene.mechanism.period
    replicates, default = starts_of(scene, repeats), scene.numerics.tree.tolerance
    told("reference", 0.0)
    precise = InHouse(integration_tolerance=REFERENCE, coordinates="all")
    references = [run_engine(scene, start, precise, short, recorded=True) for start in replicates]
    by_start = [methods_of(scene, start, short) for start in replicates]
    methods = by_start[0]
    for name, (values, runs) in methods.items():
        told(f"{name}: compiled", 0.0)
        runs(values[0], 0.01 * short)

    def in_turn(tried: Sequence[_Tried], told: Told) -> None:
        for repeat, own_methods in enumerate(by_start):
            for i, own in enumerate(tried):
                part = (repeat + i / len(tried)) / repeats
                told(f"{own.name}, {own.setting.value:.1e}", part)
                own.again(own_methods[own.name][1])

    tried = [
        _Tried(name, value, short) for name, (values, _) in methods.items() for value in values
    ]
    in_turn(tried, part_of(told, 0.0, 0.4, prefix="a: "))
    settings = {
        name: [own.compared(press, references) for own in tried if own.name == name]
        for name in methods
    }
    unit = next(own for own in settings[TREE] if own.value == default)
    if unit.cost is None:
        raise RunFailed(unit.failure)
    levels = {name: [at_error(own, error) for error in LEVELS] for name, own in settings.items()}
    most = TOO_DEAR * unit.cost
    late = {
        (name, level.error): _Tried(name, level.value, long)
        for name, own in levels.items()
        for level in own
        if level and level.cost <= most
    }
    late[TREE, 0.0] = _Tried(TREE, default, long)
    in_turn(list(late.values()), part_of(told, 0.4, 0.6, prefix="b: "))

    def complete(name: str, level: Level | None) -> Level | None:
        if level is None or (name, level.error) not in late:
            return level
        return replace(level, long=late[name, level.error].setting)

    found = tuple(
        Method(name, tuple(own), tuple(complete(name, level) for level in levels[name]))
        for name, own in settings.items()
    )
    missing = tuple(name for name, *_ in SIMULATORS.values() if name not in methods)
    units = unit, late[TREE, 0.0].setting
    return SideBySide(short, long, len(references[0].touches), units, found, missing)
