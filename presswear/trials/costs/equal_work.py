"""Engines at equal work: the same motion, its error, and the time it took.

The yardstick is the implicit model with joints at steps of 1e-6 s throughout, which is
what resolving a contact takes where steps cannot follow it.
"""

from dataclasses import dataclass, replace
from typing import ClassVar

from presswear.campaign.starts import start_of
from presswear.engines.base import Plan
from presswear.engines.settings import Engine, ExudynJoints, InHouse
from presswear.scene.scene import Scene
from presswear.tools.errors import RunFailed
from presswear.trials.crosscheck.traces import slider_at_end, touchdown_differences, touchdowns_of
from presswear.trials.runs import Told, part_of
from presswear.trials.timing import TimedRun, Timing, time_runs

FIXED_STEP = 1e-6  # s
FIXED = ExudynJoints(steps_per_contact=1, steps_sustained=1, free_step=FIXED_STEP)
"""The engine with this step throughout: any that is wanted is longer."""
REFERENCE = InHouse(integration_tolerance=1e-12)
FIRST_TOUCHDOWNS = 10
TREE_TOLERANCES = (1e-6, 1e-7, 1e-10)
"""Tolerances of the open tree, beside the default."""
WANTED = 30.0
"""Times that the open tree is to be faster than fixed steps, at no larger error."""


@dataclass(frozen=True)
class EngineRow:
    """One engine with one setting.

    Attributes
    ----------
    slider_error : float
        Error at the end, m.
    touchdown_error : float
        Greatest error of the first touchdowns' times, s; infinite where one is missing.
    faster : float
        Times faster than the run with fixed steps.
    """

    timing: Timing
    slider_error: float
    touchdown_error: float
    faster: float


@dataclass(frozen=True)
class EqualWork:
    """All engines over the same time.

    Attributes
    ----------
    simulated : float
        Time that all ran for, s.
    touchdowns : int
        Touchdowns whose times are compared.
    fixed, tree : EngineRow
        The joints model at fixed steps, and the open tree as scenes take it.
    """

    DERIVED: ClassVar = ("passed",)

    simulated: float
    touchdowns: int
    fixed: EngineRow
    tree: EngineRow
    others: tuple[EngineRow, ...]

    @property
    def rows(self) -> tuple[EngineRow, ...]:
        """All rows, slowest first."""
        return tuple(sorted((self.fixed, self.tree, *self.others), key=lambda row: row.faster))

    @property
    def passed(self) -> bool:
        """True where the open tree is as much faster as wanted, and neither error is larger."""
        tree, fixed = self.tree, self.fixed
        is_as_near = tree.slider_error <= fixed.slider_error
        is_as_timely = tree.touchdown_error <= fixed.touchdown_error
        return tree.faster >= WANTED and is_as_near and is_as_timely


def check_fixed(timing: Timing) -> None:
    """RunFailed unless every step was ``FIXED_STEP``.

    None can be longer; so many that fill the time exactly leave none that is shorter.
    """
    if timing.sent_back or timing.steps != round(timing.simulated / FIXED_STEP):
        raise RunFailed(
            f"{timing.name}: {timing.steps} steps in {timing.simulated:g} s, "
            f"{timing.sent_back} sent back, are not all of {FIXED_STEP:g} s"
        )


def equal_work(scene: Scene, duration: float, repeats: int, told: Told) -> EqualWork:
    """Run every engine on the unworn linkage of a scene over a time, s."""
    linkage, start = scene.linkage(), start_of(scene)
    numerics, period = scene.numerics, scene.mechanism.period
    tree, joints, dae = numerics.tree.over(period), numerics.joints.over(period), numerics.dae
    engines: dict[str, Engine] = {
        f"joints, all steps {FIXED_STEP:.0e} s": FIXED,
        f"tree, tolerance {tree.tree_tolerance:.0e} (default)": tree,
        f"joints, {joints.steps_per_contact} steps per contact (default)": joints,
        f"dae, tolerance {dae.integration_tolerance:.0e} (default)": dae,
    }
    for tolerance in TREE_TOLERANCES:
        engines[f"tree, tolerance {tolerance:.0e}"] = replace(tree, tree_tolerance=tolerance)
    plan = Plan(duration, 1, 1, torques=False)
    runs = [TimedRun(name, linkage, start, each, plan) for name, each in engines.items()]
    told("reference", 0.0)
    reference = TimedRun("reference", linkage, start, REFERENCE, plan).run()
    first = touchdowns_of(reference)[:FIRST_TOUCHDOWNS]
    end, _ = slider_at_end(linkage, reference)
    errors = []
    # These runs warm up for those that are timed.
    for i, timed in enumerate(runs):
        told(f"errors: {timed.name}", i / len(runs) / (repeats + 1))
        run = timed.run()
        apart = touchdown_differences(first, touchdowns_of(run))[:, 0].max(initial=0.0)
        errors.append((abs(slider_at_end(linkage, run)[0] - end), float(apart)))
    timings = time_runs(runs, repeats, part_of(told, 1.0, float(repeats), repeats + 1.0))
    fixed = timings[0]
    check_fixed(fixed)
    rows = [
        EngineRow(timing, *error, fixed.per_second / timing.per_second)
        for timing, error in zip(timings, errors, strict=True)
    ]
    return EqualWork(duration, len(first), rows[0], rows[1], tuple(rows[2:]))
