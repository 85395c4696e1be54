"""The scene with clearance, as long as a trajectory means something.

Impacts drive neighbouring motions apart: the horizon is where a start moved by 1e-9 m
has grown apart a thousand times.  Up to there every method is held against a reference;
how well that is known tells a second one that shares nothing with it but the model.
"""

import numpy as np

from presswear.campaign.replicates import disturbed, start_of
from presswear.engines.base import Plan, Run
from presswear.engines.settings import LEAST_STEPS, Engine, ExudynTree, InHouse
from presswear.linkage.linkage import Linkage
from presswear.physics.tree import Tree, tree_of
from presswear.scene.scene import Scene
from presswear.tools.errors import RunFailed
from presswear.validation.crosscheck.check import DISTURBANCE, FIRST_TOUCHDOWNS, GROWTH
from presswear.validation.crosscheck.check import PARTS as SEARCH_PARTS
from presswear.validation.crosscheck.traces import (
    parting_time,
    slider_at_end,
    touchdown_differences,
    touchdowns_of,
    trace_of,
)
from presswear.validation.precision.diagram import Diagram, Numbers, Quantity, Task, check_finite
from presswear.validation.precision.methods import Rungs, contact_methods
from presswear.validation.runs import Told, missing_energy

PARTS = 10
"""Parts of a run: the recorded series, which peaks are read from, is so much finer."""
TIGHT = InHouse(integration_tolerance=1e-13)
OTHER_TREE, OTHER_TOLERANCE = 1e-12, 1e-13
"""Tolerances of the second reference: Exudyn's open tree, or DOPRI5 where there is none."""
RESIDUAL = "energy residual / exchanged"
UNITS = {
    "slider position": "m",
    "slider velocity": "m/s",
    "touch times": "s",
    "closing speeds": "",
    "peak forces": "",
    RESIDUAL: "",
}
"""Units of the errors; closing speeds and forces are relative."""


def errors_of(linkage: Linkage, run: Run, reference: Run) -> dict[str, float]:
    """Distance of a run from a reference; RunFailed where one of the first touchdowns is missing.

    The energy residual is the run's own.
    """
    first = touchdowns_of(reference)[:FIRST_TOUCHDOWNS]
    apart = touchdown_differences(first, touchdowns_of(run))
    missing = int(np.count_nonzero(np.isinf(apart[:, 0])))
    if missing:
        raise RunFailed(f"{missing} of the first {len(first)} touches missing")
    slider = np.abs(slider_at_end(linkage, run) - slider_at_end(linkage, reference))
    numbers = [*slider, *apart.max(axis=0, initial=0.0), missing_energy(run)]
    return dict(zip(UNITS, map(float, numbers), strict=True))


def horizon_of(scene: Scene, longest: float) -> float:
    """Time up to which two starts 1e-9 m apart stay within a thousand times that, s.

    RunFailed where a run fails.

    Parameters
    ----------
    longest : float
        Time at which the search ends, s; beyond a cycle none is made.
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
    """The run that the reference is held against, in words and as an engine."""
    if isinstance(tree_of(scene.linkage()), Tree):
        return f"Exudyn's open tree, DOPRI5 at {OTHER_TREE:g}", ExudynTree(OTHER_TREE)
    words = f"the same with DOPRI5 at {OTHER_TOLERANCE:g} (there is no open tree)"
    return words, InHouse("dopri5", OTHER_TOLERANCE)


def with_clearance(scene: Scene, rungs: Rungs, longest: float, told: Told) -> tuple[Task, float]:
    """A scene's unworn linkage up to its horizon, and that, s; RunFailed if a reference fails."""
    told("horizon", 0.0)
    horizon, period = horizon_of(scene, longest), scene.mechanism.period
    linkage, start = scene.linkage(), start_of(scene)
    plan = Plan(horizon / PARTS, PARTS, PARTS, torques=False)
    words, other = second_reference(scene)
    found = []
    for engine in (TIGHT, other):
        told("references", 0.0)
        # The longest steps are those of scenes.
        found.append(check_finite(engine.over(period).simulate(linkage, start, plan)))
    reference, second = found
    # Energy is conserved exactly: its residual needs no reference.
    known = errors_of(linkage, second, reference) | {RESIDUAL: 0.0}
    touches = len(touchdowns_of(reference))

    def assess(run: Run) -> tuple[Numbers, Numbers]:
        found = {"touches": float(len(touchdowns_of(run)))}
        return errors_of(linkage, run, reference), found

    joints = " and ".join(scene.clearance_joints)
    diagram = Diagram(
        key="horizon",
        title=f"Clearance at {joints} up to the horizon",
        task=f"Scene {scene.name}, unworn, {horizon:.4g} s, {touches} touches: "
        f"the slider at the end; the worst of the first {min(touches, FIRST_TOUCHDOWNS)} touches, "
        "closing speeds and peak forces relative, peaks read between accepted steps by a "
        "polynomial; energy that is missing, part of what the drives exchanged.",
        quantities=tuple(Quantity(name, unit, known[name]) for name, unit in UNITS.items()),
        reference=f"DOP853 of dae at {TIGHT.integration_tolerance:g}; its own error is its "
        f"distance from {words}",
    )
    is_tree = isinstance(tree_of(linkage), Tree)
    methods = contact_methods(rungs, scene.numerics, period, period / LEAST_STEPS, is_tree)
    return Task(diagram, linkage, start, plan, methods, assess), horizon
