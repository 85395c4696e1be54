"""The scene with clearance, as long as a trajectory means something.

Impacts drive neighbouring motions apart: the horizon is where a start moved by 1e-9 m
has grown apart a thousand times.  Up to there every method is held against a reference;
how well that is known tells a second one that shares nothing with it but the model.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from presswear.campaign.starts import disturbed, start_of
from presswear.engines.base import Plan, Run
from presswear.engines.settings import LEAST_STEPS, Engine, ExudynTree, InHouse
from presswear.linkage.elements import Linkage
from presswear.physics.tree import Tree, tree_of
from presswear.scene.scene import Scene
from presswear.tools.errors import InputError, RunFailed
from presswear.trials.crosscheck.check import DISTURBANCE, FIRST_TOUCHDOWNS, GROWTH
from presswear.trials.crosscheck.check import PARTS as SEARCH_PARTS
from presswear.trials.crosscheck.traces import (
    Touchdown,
    parting_time,
    slider_at_end,
    touchdown_differences,
    touchdowns_of,
    trace_of,
)
from presswear.trials.precision.diagram import Diagram, Numbers, Quantity, Task, check_finite
from presswear.trials.precision.extent import PrecisionExtent
from presswear.trials.precision.methods import contact_methods
from presswear.trials.runs import Told, missing_energy

Array = NDArray[np.float64]

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


@dataclass(frozen=True)
class UpToHorizon:
    """The parts of a run that are compared.

    Attributes
    ----------
    slider : ndarray, shape (2,)
        Position along the watched direction, m, and velocity, m/s, at the end.
    residual : float
        Energy that is missing, part of what the drives exchanged.
    """

    slider: Array
    touchdowns: tuple[Touchdown, ...]
    residual: float

    @staticmethod
    def of(linkage: Linkage, run: Run) -> "UpToHorizon":
        """Read a run that ended well."""
        return UpToHorizon(slider_at_end(linkage, run), touchdowns_of(run), missing_energy(run))

    def errors(self, reference: "UpToHorizon") -> dict[str, float]:
        """Distance from a reference; RunFailed where one of its first touchdowns is missing."""
        first = reference.touchdowns[:FIRST_TOUCHDOWNS]
        apart = touchdown_differences(first, self.touchdowns)
        missing = int(np.count_nonzero(np.isinf(apart[:, 0])))
        if missing:
            raise RunFailed(f"{missing} of the first {len(first)} touches missing")
        slider = np.abs(self.slider - reference.slider)
        numbers = [*slider, *apart.max(axis=0, initial=0.0), self.residual]
        return dict(zip(UNITS, map(float, numbers), strict=True))


def check_clearance(scene: Scene) -> None:
    """InputError where a scene has no clearance."""
    if not scene.clearance_joints:
        raise InputError(f"scene {scene.name} has no clearance, so no impacts; name one that has")


def horizon_of(scene: Scene, longest: float) -> float:
    """Time up to which two starts 1e-9 m apart stay within a thousand times that, s.

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
    """The run that the reference is held against, in words and as an engine."""
    if isinstance(tree_of(scene.linkage()), Tree):
        return f"Exudyn's open tree, DOPRI5 at {OTHER_TREE:g}", ExudynTree(OTHER_TREE)
    words = f"the same with DOPRI5 at {OTHER_TOLERANCE:g} (there is no open tree)"
    return words, InHouse("dopri5", OTHER_TOLERANCE)


def with_clearance(scene: Scene, extent: PrecisionExtent, told: Told) -> tuple[Task, float]:
    """The unworn linkage of a scene up to its horizon, and the horizon, s.

    Raises
    ------
    InputError
        Where the scene has no clearance.
    RunFailed
        Where a reference fails.
    """
    check_clearance(scene)
    told("horizon", 0.0)
    horizon, period = horizon_of(scene, extent.longest), scene.mechanism.period
    linkage, start = scene.linkage(), start_of(scene)
    plan = Plan(horizon / PARTS, PARTS, PARTS, torques=False)
    words, other = second_reference(scene)
    found = []
    for engine in (TIGHT, other):
        told("references", 0.0)
        # The longest steps are those of scenes.
        run = check_finite(engine.over(period).simulate(linkage, start, plan))
        found.append(UpToHorizon.of(linkage, run))
    reference, second = found
    # Energy is conserved exactly: its residual needs no reference.
    known = second.errors(reference) | {RESIDUAL: 0.0}
    count = min(len(reference.touchdowns), FIRST_TOUCHDOWNS)

    def assess(run: Run) -> tuple[Numbers, Numbers]:
        reached = UpToHorizon.of(linkage, run)
        return reached.errors(reference), {"touches": float(len(reached.touchdowns))}

    joints = " and ".join(scene.clearance_joints)
    diagram = Diagram(
        key="horizon",
        title=f"Clearance at {joints} up to the horizon",
        task=f"Scene {scene.name}, unworn, {horizon:.4g} s, {len(reference.touchdowns)} touches: "
        f"the slider at the end; the worst of the first {count} touches, closing speeds and peak "
        "forces relative, peaks read between accepted steps by a polynomial; energy that is "
        "missing, part of what the drives exchanged.",
        quantities=tuple(Quantity(name, unit, known[name]) for name, unit in UNITS.items()),
        reference=f"DOP853 of dae at {TIGHT.integration_tolerance:g}; its own error is its "
        f"distance from {words}",
    )
    is_tree = isinstance(tree_of(linkage), Tree)
    longest = period / LEAST_STEPS
    methods = contact_methods(extent.rungs, scene.numerics, period, longest, is_tree)
    return Task(diagram, linkage, start, plan, methods, assess), horizon
