"""Engines at equal work: the same motion, its error, and the time it took.

The yardstick is the implicit model with joints at steps of 1e-6 s throughout, which is
what resolving a contact takes where steps cannot follow it.
"""

import math
from dataclasses import dataclass
from itertools import islice

from presswear.campaign.starts import start_of
from presswear.engines.base import Plan, Run
from presswear.engines.settings import Engine, ExudynJoints, InHouse
from presswear.linkage.elements import Linkage
from presswear.scene.scene import Scene
from presswear.tools.errors import RunFailed
from presswear.trials.costs.timing import Case, Progress, Timing, time_cases
from presswear.trials.crosscheck.traces import Touch, touch_differences, touches_of

FIXED_STEP = 1e-6
"""s."""
REFERENCE = InHouse(integration_tolerance=1e-12)
FIRST_TOUCHES = 10
TREE_TOLERANCES = (1e-6, 1e-7, 1e-10)
"""Of the open tree, beside the default."""
WANTED = 30.0
"""Times that the open tree is to be faster than fixed steps, at no larger error."""


@dataclass(frozen=True)
class EngineRow:
    """One engine at one accuracy.

    Attributes
    ----------
    timing : Timing
    slider_error : float
        At the end, m.
    touch_error : float
        Greatest of the first touches' times, s; infinite where a touch is missing.
    fixed : Timing
        Of the run with fixed steps.
    """

    timing: Timing
    slider_error: float
    touch_error: float
    fixed: Timing

    @property
    def faster(self) -> float:
        """Times faster than the run with fixed steps."""
        return self.fixed.per_second / self.timing.per_second


@dataclass(frozen=True)
class EqualWork:
    """All engines over the same time.

    Attributes
    ----------
    duration : float
        s.
    touches : int
        Touches whose times are compared.
    fixed, tree : EngineRow
        The joints model at fixed steps, and the open tree as scenes take it.
    others : tuple of EngineRow
    """

    duration: float
    touches: int
    fixed: EngineRow
    tree: EngineRow
    others: tuple[EngineRow, ...]

    @property
    def rows(self) -> tuple[EngineRow, ...]:
        """All rows, slowest first."""
        return tuple(sorted((self.fixed, self.tree, *self.others), key=lambda row: row.faster))

    @property
    def no_larger_error(self) -> bool:
        """Whether the open tree is at least as good as fixed steps in both errors."""
        return (
            self.tree.slider_error <= self.fixed.slider_error
            and self.tree.touch_error <= self.fixed.touch_error
        )

    @property
    def passed(self) -> bool:
        """Whether the open tree is as much faster as wanted, at no larger error."""
        return self.tree.faster >= WANTED and self.no_larger_error


def fixed_steps() -> ExudynJoints:
    """Steps of ``FIXED_STEP`` throughout: the longest allowed is shorter than any wanted."""
    return ExudynJoints(steps_per_contact=1, steps_sustained=1, free_step=FIXED_STEP)


def check_fixed(timing: Timing) -> None:
    """RunFailed unless every step was ``FIXED_STEP``.

    None can be longer; so many that fill the time exactly leave none that is shorter.
    """
    if timing.sent_back or timing.steps != round(timing.simulated / FIXED_STEP):
        raise RunFailed(
            f"{timing.name}: {timing.steps} steps in {timing.simulated:g} s, "
            f"{timing.sent_back} sent back, are not all of {FIXED_STEP:g} s"
        )


def slider_of(linkage: Linkage, run: Run) -> float:
    """The watched coordinate at the end of a run, m."""
    i, angle = 3 * linkage.index(linkage.probe.body), linkage.probe.direction
    x, y = run.end.position[i : i + 2]
    return float(x * math.cos(angle) + y * math.sin(angle))


def equal_work(scene: Scene, duration: float, repeats: int, progress: Progress) -> EqualWork:
    """Run every engine on the unworn linkage of a scene over a time, s."""
    linkage, start, period = scene.linkage(), start_of(scene), scene.mechanism.period
    tree, joints, dae = (
        scene.numerics.tree.over(period),
        scene.numerics.joints.over(period),
        scene.numerics.dae,
    )
    accuracies: dict[str, Engine] = {
        f"joints, all steps {FIXED_STEP:.0e} s": fixed_steps(),
        f"tree, tolerance {tree.tree_tolerance:.0e} (default)": tree,
        f"joints, {joints.steps_per_contact} steps per contact (default)": joints,
        f"dae, tolerance {dae.integration_tolerance:.0e} (default)": dae,
    }
    for tolerance in TREE_TOLERANCES:
        accuracies[f"tree, tolerance {tolerance:.0e}"] = type(tree)(tolerance, tree.free_step)
    plan = Plan(duration, 1, 1, torques=False)
    cases = [Case(name, linkage, start, each, plan) for name, each in accuracies.items()]
    progress("reference", 0.0)
    reference = Case("reference", linkage, start, REFERENCE, plan).run()
    first: tuple[Touch, ...] = tuple(islice(touches_of(reference), FIRST_TOUCHES))
    end = slider_of(linkage, reference)
    errors = []
    # These runs warm up for those that are timed.
    for i, case in enumerate(cases):
        progress(f"errors: {case.name}", i / len(cases) / (repeats + 1))
        run = case.run()
        apart = touch_differences(first, touches_of(run))[:, 0].max(initial=0.0)
        errors.append((abs(slider_of(linkage, run) - end), float(apart)))
    timings = time_cases(
        cases, repeats, lambda name, part: progress(name, (1 + repeats * part) / (repeats + 1))
    )
    check_fixed(timings[0])
    rows = [
        EngineRow(timing, *error, timings[0]) for timing, error in zip(timings, errors, strict=True)
    ]
    return EqualWork(duration, len(first), rows[0], rows[1], tuple(rows[2:]))
