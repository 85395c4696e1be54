"""Ensemble: one linkage run from several replicates, which are samples of a chaotic motion.

The initial states of the replicates differ by up to 2 % of the smallest clearance. After
one or two cycles their runs are therefore independent; successive cycles of a run may be
correlated. After a wear update in one jump there are two sets of runs: in the set
``together`` all replicates have the surfaces from the mean of their wear maps, in the set
``alone`` each has the surfaces from its maps.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from presswear.campaign.replicates import RunSpec, RunState
from presswear.campaign.settled_motions import settling_of
from presswear.engines.base import Run, Status
from presswear.linkage.linkage import Linkage
from presswear.recording.recorder import Recorder
from presswear.recording.settling import Settling
from presswear.recording.soundness import Finding
from presswear.recording.statistics import MapBatches, smoothed_maps
from presswear.scene.scene import Scene
from presswear.tools.arrays import Array

# Diagnostics of which the largest is that of an ensemble, not the sum
_LARGEST = ("deepest_touch_m", "constraint_error_m", "constraint_velocity_error_m_s")


@dataclass(frozen=True)
class EnsembleState:
    """State of an ensemble between two cycles."""

    runs: tuple[RunState | None, ...] = ()  # None: the run has not started
    until: tuple[int, ...] = ()  # cycle at which each run ends its round
    wall: float = 0.0  # wall time, s
    # errors by name, from a finished step check
    step_errors: Mapping[str, float] = field(default_factory=dict)

    @property
    def cycles(self) -> int:
        """Finished cycles of all runs."""
        return sum(run.cycles for run in self.runs if run is not None)


@dataclass(frozen=True)
class Ensemble:
    """Finished runs of a linkage from one or several replicates."""

    linkage: Linkage  # on the surfaces that the scene starts on
    depth: Array  # surfaces at the start of each run, (runs, joints, 2, bins), m
    runs: tuple[Run, ...]  # by replicate, of one set or two; a failed one is the last
    replicates: int  # number of runs in a set
    state: EnsembleState
    # bins of the wear maps of each joint, if they are smoothed
    bins: tuple[int, ...] = ()

    @staticmethod
    def of(
        scene: Scene, spec: RunSpec, depth: Array, state: EnsembleState
    ) -> "Ensemble":
        """Return the ensemble of a state; runs after the first that failed are left out."""
        runs: list[Run] = []
        for run, surfaces in zip(state.runs, depth, strict=False):
            if run is None or (runs and runs[-1].status == "failed"):
                break
            runs.append(run.run(scene, spec, surfaces))
        if runs[-1].status == "failed":
            state = replace(state, step_errors={})
        state = replace(state, runs=state.runs[: len(runs)])
        linkage = scene.linkage()
        is_raw = scene.conventions.wear_maps == "raw"
        bins = () if is_raw else tuple(joint.bins for joint in linkage.clearances)
        return Ensemble(linkage, depth, tuple(runs), scene.replicate_count, state, bins)

    @cached_property
    def settling(self) -> Settling | None:
        """Motions on which the runs settled; None without clearance or a complete cycle."""
        return settling_of(
            self.linkage.clearances, [run.cycles for run in self.recorders]
        )

    @cached_property
    def together(self) -> "Ensemble":
        """First set, from which the statistics of a stage are."""
        return self._samples(0, self.replicates)

    @cached_property
    def alone(self) -> "Ensemble":
        """Last set, whose runs are independent: each replicate has other surfaces."""
        first = self.replicates if len(self.runs) > self.replicates else 0
        # If one of them failed there are fewer runs than surfaces.
        return self._samples(first, len(self.runs))

    def _samples(self, first: int, end: int) -> "Ensemble":
        """Return some runs with the cycles that are samples, and the start-up before them."""
        runs = [*self.runs[first:end]]
        if self.settling:
            for k, run in enumerate(runs):
                skipped = self.settling.skipped(first + k)
                if skipped > 0:
                    runs[k] = replace(run, recorder=run.recorder.since(skipped))
        return replace(self, depth=self.depth[first:end], runs=tuple(runs))

    @property
    def recorders(self) -> tuple[Recorder, ...]:
        """Recorders of the runs."""
        return tuple(run.recorder for run in self.runs)

    @property
    def maps(self) -> list[MapBatches]:
        """Wear maps of the runs."""
        return [run.recorder.maps for run in self.runs]

    @property
    def failure(self) -> str:
        """Message of the run that failed, or ""."""
        last = self.runs[-1]
        if last.status != "failed":
            return ""
        if len(self.runs) == 1:
            return last.message
        return f"run {len(self.runs)}: {last.message}"

    @property
    def finding(self) -> Finding | None:
        """Finding that ended the ensemble, if a run failed."""
        return self.runs[-1].finding

    @property
    def status(self) -> Status:
        """``failed``, ``enough`` if the maps were known early, or ``completed``."""
        statuses: set[Status] = {run.status for run in self.runs}
        order: tuple[Status, ...] = ("failed", "enough", "completed")
        return next(status for status in order if status in statuses)

    @property
    def surface_depth(self) -> Array:
        """Depth of the surfaces at the end of each run, shape (runs, joints, 2, bins), m."""
        return np.array([run.recorder.surface_depth for run in self.runs])

    @property
    def simulated_s(self) -> float:
        """Simulated time of all runs, s."""
        return sum(run.time for run in self.runs)

    def added_by_run(self) -> Array:
        """Return the mean depth that a cycle adds in each run, shape (runs, joints, 2, bins), m."""
        return smoothed_maps(self.maps, self.bins)

    def diagnostics(self) -> dict[str, float | int | str]:
        """Return diagnostics of the solver: texts of the first run, numbers of all."""
        merged = dict(self.runs[0].diagnostics)
        for key, first in self.runs[0].diagnostics.items():
            if isinstance(first, str):
                continue
            values: list[Any] = [run.diagnostics.get(key, 0) for run in self.runs]
            if key == "energy_residual_J":
                # Residuals of different signs would cancel in the sum.
                values = [abs(value) for value in values]
            merged[key] = max(values) if key in _LARGEST else sum(values)
        if len(self.runs) > 1:
            merged["replicates"] = len(self.runs)
        return merged
