"""What each feature of a model costs: the same run with the feature and without.

The motion differs between the two, and with it the number of steps.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from presswear.campaign.campaign import run_stage
from presswear.engines.settings import ExudynTree
from presswear.scene.scene import Scene
from presswear.tools.errors import RunFailed
from presswear.trials.costs.timing import Case, Progress, Timing, Worn, case_of, time_cases

JOINTS = "exudyn-joints"

CLEARANCES = (("none", "none"), ("A", "A"), ("C", "C"), ("A and C", "AC"))
"""What a row is called, and the scene's word for it."""


@dataclass(frozen=True)
class FeatureRow:
    """A run with a feature on or off.

    Attributes
    ----------
    feature, state : str
    timing : Timing
    without : Timing
        The run with the feature off.
    """

    feature: str
    state: str
    timing: Timing
    without: Timing

    @property
    def step_ratio(self) -> float:
        """Wall time per attempted step, part of that without the feature."""
        return self.timing.per_step / self.without.per_step

    @property
    def wall_ratio(self) -> float:
        """Wall time per simulated second, part of that without the feature."""
        return self.timing.per_second / self.without.per_second


@dataclass(frozen=True)
class FeatureTable:
    """Rows that were timed in turn."""

    title: str
    rows: tuple[FeatureRow, ...]


def wear_once(scene: Scene, cycles: int) -> Worn:
    """Surfaces after one wear of a scene, from the wear of so many cycles."""
    stage, ran = run_stage(replace(scene, cycles=cycles), 0, {})
    if stage.failed:
        raise RunFailed(stage.message)
    return {
        joint.name: (
            joint.bearing_surface.worn_by(stage.joints[joint.name].wear("bearing")),
            joint.pin_surface.worn_by(stage.joints[joint.name].wear("pin")),
        )
        for joint in ran.linkage.clearances
    }


def deepest(worn: Worn) -> dict[str, float]:
    """Deepest wear of each joint, bearing and pin together, m."""
    return {
        name: float(np.max(bearing.depth) + np.max(pin.depth))
        for name, (bearing, pin) in worn.items()
    }


def clearance_rows(
    scene: Scene, cycles: float, repeats: int, progress: Progress
) -> tuple[FeatureRow, ...]:
    """The scene with neither, one and both of its joints open, in the engine it names."""
    cases = [
        case_of(f"clearance {state}", replace(scene, joints=joints), cycles)
        for state, joints in CLEARANCES
    ]
    timings = _timed(cases, repeats, progress)
    states = [state for state, _ in CLEARANCES]
    return tuple(
        FeatureRow("clearance", state, timing, timings[0])
        for state, timing in zip(states, timings, strict=True)
    )


def switched_rows(
    scene: Scene, worn: Worn, cycles: float, repeats: int, progress: Progress
) -> tuple[FeatureRow, ...]:
    """Friction, worn surfaces, wear account and stored torques, each on and off."""
    bearings = scene.bearings
    cases = [
        case_of("the scene", scene, cycles),
        case_of("no friction", replace(scene, bearings=replace(bearings, friction=0.0)), cycles),
        case_of("worn surfaces", scene, cycles, worn),
        case_of(
            "no wear account",
            replace(scene, bearings=replace(bearings, wear_coefficient=0.0)),
            cycles,
        ),
        case_of("torques stored", replace(scene, drive_torque="on"), cycles),
    ]
    own, frictionless, rough, unaccounted, torques = _timed(cases, repeats, progress)
    return tuple(
        row
        for feature, off, on in (
            ("friction", frictionless, own),
            ("worn surfaces", own, rough),
            ("wear account", unaccounted, own),
            ("torques stored", own, torques),
        )
        for row in (FeatureRow(feature, "off", off, off), FeatureRow(feature, "on", on, off))
    )


def _timed(cases: Sequence[Case], repeats: int, progress: Progress) -> tuple[Timing, ...]:
    for case in cases:
        progress(case.name, 0.0)
        case.warm_up()
    return time_cases(cases, repeats, progress)


def feature_table(
    scene: Scene,
    model: Literal["chosen", "tree", "joints"],
    worn: Worn,
    cycles: float,
    repeats: int,
    progress: Progress,
) -> FeatureTable:
    """Costs of the features of a scene.

    Parameters
    ----------
    model : {"chosen", "tree", "joints"}
        Clearance in the model that the scene chooses for each; all other features in the
        open tree; all features in the model with bodies and joints.
    worn : dict
        The worn surfaces.
    cycles : float
        Simulated time, cycles.
    """
    if model == "chosen":
        rows = clearance_rows(scene, cycles, repeats, progress)
        return FeatureTable("Clearance, in the model that Exudyn gets for each", rows)
    if model == "tree":
        rows = switched_rows(
            replace(scene, engine=ExudynTree.word), worn, cycles, repeats, progress
        )
        return FeatureTable("Features, clearance at A and C, open tree", rows)
    whole = replace(scene, engine=JOINTS)
    rows = clearance_rows(whole, cycles, repeats, lambda name, part: progress(name, 0.5 * part))
    rows += switched_rows(
        whole, worn, cycles, repeats, lambda name, part: progress(name, 0.5 + 0.5 * part)
    )
    return FeatureTable("Features, bodies and joints", rows)
