"""The whole study of speed against error."""

import time as clock
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from presswear.results.provenance import provenance
from presswear.scene.scene import Scene
from presswear.trials.costs.study import processor_name
from presswear.trials.costs.timing import Progress
from presswear.trials.precision import chaos as beyond
from presswear.trials.precision import horizon, impact, smooth
from presswear.trials.precision import wear as worn
from presswear.trials.precision.chaos import Chaos
from presswear.trials.precision.extent import Extent
from presswear.trials.precision.horizon import check_clearance
from presswear.trials.precision.measure import measure
from presswear.trials.precision.points import Diagram
from presswear.trials.precision.wear import WearStudy


@dataclass(frozen=True)
class Precision:
    """A study of speed against error.

    Attributes
    ----------
    scene : Scene
    extent : Extent
    provenance : mapping
        Versions, revision, machine and time; see ``presswear.results.result``.
    processor : str
        What the operating system calls it.
    wall : float
        Time that the study took, s.
    horizon : float
        Up to which trajectories are compared, s.
    diagrams : tuple of Diagram
        ``ideal``, ``andrews``, ``impact`` and ``horizon``.
    chaos : Chaos or None
        Statistics beyond the horizon.
    wear : WearStudy or None
        How wear depends on the means it is computed with.
    """

    scene: Scene
    extent: Extent
    provenance: Mapping[str, Any]
    processor: str
    wall: float
    horizon: float
    diagrams: tuple[Diagram, ...]
    chaos: Chaos | None = None
    wear: WearStudy | None = None

    def diagram(self, key: str) -> Diagram:
        """A diagram by its key."""
        return next(diagram for diagram in self.diagrams if diagram.key == key)


_QUICK_PARTS = {"ideal": 8.0, "andrews": 4.0, "impact": 1.0, "horizon": 15.0}
_PARTS = {"ideal": 50.0, "andrews": 60.0, "impact": 2.0, "horizon": 320.0}
_QUICK_BEYOND = {"statistics": 40.0, "wear": 40.0}
_BEYOND = {"statistics": 600.0, "wear": 600.0}
"""Seconds of each part of the study, roughly: what progress goes by."""


def _sections(extent: Extent, progress: Progress) -> dict[str, Progress]:
    """What each part tells its progress to."""
    seconds = dict(_QUICK_PARTS if extent.quick else _PARTS)
    if extent.beyond:
        seconds |= _QUICK_BEYOND if extent.quick else _BEYOND
    total, before = sum(seconds.values()), 0.0
    told: dict[str, Progress] = {}
    for section, own in seconds.items():

        def tell(
            name: str, part: float, word: str = section, start: float = before, own: float = own
        ) -> None:
            progress(f"{word}: {name}", (start + own * part) / total)

        told[section] = tell
        before += own
    return told


def study(scene: Scene, extent: Extent, progress: Progress) -> Precision:
    """Measure speed and error of every engine and integrator.

    A method that fails stays in as a failure.

    Raises
    ------
    InputError
        Where the scene has no clearance, or nothing that wears.
    RunFailed
        Where a reference fails.
    """
    check_clearance(scene)
    if extent.beyond:
        worn.check(scene, extent)
    began = clock.perf_counter()
    source, told = provenance(), _sections(extent, progress)
    diagrams = [
        measure(smooth.ideal_mechanism(scene, extent), extent.repeats, told["ideal"]),
        measure(smooth.andrews(extent), extent.repeats, told["andrews"]),
        measure(impact.single(scene, extent), extent.repeats, told["impact"]),
    ]
    task, until = horizon.with_clearance(scene, extent, told["horizon"])
    diagrams.append(measure(task, extent.repeats, told["horizon"]))
    statistics = beyond.measure(scene, extent, told["statistics"]) if extent.beyond else None
    wear = worn.measure(scene, extent, told["wear"]) if extent.beyond else None
    progress("done", 1.0)
    return Precision(
        scene,
        extent,
        source,
        processor_name(),
        clock.perf_counter() - began,
        until,
        tuple(diagrams),
        statistics,
        wear,
    )
