"""The scene with clearance, as long as a trajectory means something.

Impacts drive neighbouring motions apart: the horizon is where a start moved by 1e-9 m
has grown apart a thousand times.  Up to there every method is held against a reference;
how well that is known tells a second one that shares nothing with it but the model.
"""

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from presswear.campaign.starts import disturbed, start_of
from presswear.engines.base import Plan, Run
from presswear.engines.settings import LEAST_STEPS, Engine, ExudynTree, InHouse
from presswear.linkage.elements import Linkage
from presswear.physics.tree import Tree, tree_of
from presswear.scene.scene import Scene
from presswear.tools.errors import InputError, RunFailed
from presswear.trials.costs.timing import Progress
from presswear.trials.crosscheck.check import DISTURBANCE, GROWTH
from presswear.trials.crosscheck.check import PARTS as SEARCH_PARTS
from presswear.trials.crosscheck.traces import (
    Touch,
    parting_time,
    touch_differences,
    touches_of,
    trace_of,
)
from presswear.trials.precision.extent import Extent
from presswear.trials.precision.measure import Errors, Task, Values, check_finite
from presswear.trials.precision.methods import contact_ladder

Array = NDArray[np.float64]

FIRST_TOUCHES = 10
PARTS = 10
"""Parts of a run: the recorded series, which peaks are read from, is so much finer."""
TIGHT = InHouse(integration_tolerance=1e-13)
OTHER_TREE, OTHER_TOLERANCE = 1e-12, 1e-13
"""Tolerances of the second reference: Exudyn's open tree, or DOPRI5 where there is none."""
RESIDUAL = "energy residual / exchanged"
QUANTITIES = {
    "slider position": "m",
    "slider velocity": "m/s",
    "touch times": "s",
    "closing speeds": "",
    "peak forces": "",
    RESIDUAL: "",
}
"""Errors and their units; closing speeds and forces are relative."""


@dataclass(frozen=True)
class Outcome:
    """What is compared of a run.

    Attributes
    ----------
    slider : ndarray, shape (2,)
        Position along the watched direction, m, and velocity, m/s, at the end.
    touches : tuple of Touch
    residual : float
        Energy that is missing, part of what the drives exchanged.
    """

    slider: Array
    touches: tuple[Touch, ...]
    residual: float

    @staticmethod
    def of(linkage: Linkage, run: Run) -> "Outcome":
        """Of a run that ended well."""
        i = 3 * linkage.index(linkage.probe.body)
        along = np.array([math.cos(linkage.probe.direction), math.sin(linkage.probe.direction)])
        slider = np.array(
            [run.end.position[i : i + 2] @ along, run.end.velocity[i : i + 2] @ along]
        )
        residual, exchanged = (
            float(run.diagnostics[name]) for name in ("energy_residual_J", "drive_exchange_J")
        )
        return Outcome(slider, touches_of(run), abs(residual) / exchanged)

    def errors(self, reference: "Outcome") -> dict[str, float]:
        """Distance from a reference; RunFailed where one of its first touches is missing."""
        first = reference.touches[:FIRST_TOUCHES]
        apart = touch_differences(first, self.touches)
        missing = int(np.count_nonzero(np.isinf(apart[:, 0])))
        if missing:
            raise RunFailed(f"{missing} of the first {len(first)} touches missing")
        slider = np.abs(self.slider - reference.slider)
        numbers = [*slider, *apart.max(axis=0, initial=0.0), self.residual]
        return dict(zip(QUANTITIES, map(float, numbers), strict=True))


def plan_of(horizon: float) -> Plan:
    """A run up to a horizon, s."""
    return Plan(horizon / PARTS, PARTS, PARTS, torques=False)


def longest_step(scene: Scene) -> float:
    """Longest step of scenes, s."""
    return scene.mechanism.period / LEAST_STEPS


def check_clearance(scene: Scene) -> None:
    """InputError where a scene has no clearance."""
    if not scene.clearance_joints:
        raise InputError(f"scene {scene.name} has no clearance, so no impacts; name one that has")


def horizon_of(scene: Scene, longest: float) -> float:
    """Up to when two starts 1e-9 m apart stay within a thousand times that, s.

    Parameters
    ----------
    longest : float
        Time at which the search ends, s; beyond a cycle none is made.

    Raises
    ------
    RunFailed
        Where a run fails.
    """
    linkage, start = scene.linkage(), start_of(scene)
    end = min(scene.mechanism.period, longest)
    moved = disturbed(linkage, start, DISTURBANCE)
    if moved is None:
        return end
    # In small parts: between the rows of a series paths are taken as straight.
    plan = Plan(end / SEARCH_PARTS, SEARCH_PARTS, SEARCH_PARTS, torques=False)
    calm, other = (trace_of(TIGHT.simulate(linkage, each, plan)) for each in (start, moved))
    return parting_time(calm, other, GROWTH * DISTURBANCE) or end


def second_reference(scene: Scene) -> tuple[str, Engine]:
    """What the reference is held against, in words and as an accuracy."""
    if isinstance(tree_of(scene.linkage()), Tree):
        accuracy = ExudynTree(OTHER_TREE, longest_step(scene))
        return f"Exudyn's open tree, DOPRI5 at {OTHER_TREE:g}", accuracy
    other = InHouse("dopri5", OTHER_TOLERANCE, free_step=longest_step(scene))
    return f"the same with DOPRI5 at {OTHER_TOLERANCE:g} (there is no open tree)", other


def with_clearance(scene: Scene, extent: Extent, progress: Progress) -> tuple[Task, float]:
    """The unworn linkage of a scene up to its horizon, and the horizon, s.

    Raises
    ------
    InputError
        Where the scene has no clearance.
    RunFailed
        Where a reference fails.
    """
    check_clearance(scene)
    progress("horizon", 0.0)
    horizon = horizon_of(scene, extent.longest)
    linkage, start, numerics = scene.linkage(), start_of(scene), scene.numerics
    plan = plan_of(horizon)
    outcomes = []
    words, other = second_reference(scene)
    for accuracy in (replace(TIGHT, free_step=longest_step(scene)), other):
        progress("references", 0.0)
        run = accuracy.simulate(linkage, start, plan)
        check_finite(run)
        outcomes.append(Outcome.of(linkage, run))
    reference, second = outcomes
    # Energy is conserved exactly: its residual needs no reference.
    known = second.errors(reference) | {RESIDUAL: 0.0}
    count = min(len(reference.touches), FIRST_TOUCHES)

    def assess(run: Run) -> tuple[Errors, Values]:
        outcome = Outcome.of(linkage, run)
        return outcome.errors(reference), {"touches": float(len(outcome.touches))}

    joints = " and ".join(scene.clearance_joints)
    task = Task(
        key="horizon",
        title=f"Clearance at {joints} up to the horizon",
        words=f"Scene {scene.name}, unworn, {horizon:.4g} s, {len(reference.touches)} touches: the "
        f"slider at the end; the worst of the first {count} touches, closing speeds and peak "
        "forces relative, peaks read between accepted steps by a polynomial; energy that is "
        "missing, part of what the drives exchanged.",
        linkage=linkage,
        start=start,
        plan=plan,
        methods=contact_ladder(
            extent.rungs,
            numerics,
            scene.mechanism.period,
            longest_step(scene),
            tree=isinstance(tree_of(linkage), Tree),
        ),
        quantities=QUANTITIES,
        reference=f"DOP853 of dae at {TIGHT.integration_tolerance:g}; its own error is its "
        "distance from "
        f"{words}",
        reference_errors=known,
        assess=assess,
    )
    return task, horizon
