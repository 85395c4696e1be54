"""The whole study of speed against error."""

import time as clock
from dataclasses import dataclass

from presswear.results.provenance import Provenance, provenance
from presswear.scene.scene import Scene
from presswear.tools.errors import InputError
from presswear.validation.precision import chaos, horizon, impact, smooth, wear
from presswear.validation.precision.chaos import Chaos
from presswear.validation.precision.diagram import Diagram, measure
from presswear.validation.precision.methods import ALL, FEW, Rungs
from presswear.validation.precision.wear import WearStudy
from presswear.validation.runs import Told, parts_of
from presswear.validation.stored import processor_name

_SECTIONS = ("ideal", "andrews", "impact", "horizon", "statistics", "wear")
_QUICK_SECONDS, _SECONDS = (8, 4, 1, 15, 40, 40), (50, 60, 2, 320, 600, 600)
"""Seconds of each part of the study, roughly: what progress goes by."""


@dataclass(frozen=True)
class PrecisionExtent:
    """Extent of a study of speed against error.

    Attributes
    ----------
    quick : bool
        True where statistics and wear are studied in short as well.
    repeats : int
        How often each method is timed.
    rungs : Rungs
        Steps and tolerances.
    longest : float
        Longest horizon up to which trajectories are compared, s.
    """

    quick: bool
    repeats: int
    rungs: Rungs
    longest: float


QUICK = PrecisionExtent(quick=True, repeats=5, rungs=FEW, longest=0.05)
"""A few steps and tolerances of each family."""
FULL = PrecisionExtent(quick=False, repeats=5, rungs=ALL, longest=1.0)


@dataclass(frozen=True)
class Precision:
    """A study of speed against error.

    Attributes
    ----------
    processor : str
        Name that the operating system gives it.
    wall : float
        Time that the study took, s.
    horizon : float
        Up to which trajectories are compared, s.
    diagrams : tuple of Diagram
        ``ideal``, ``andrews``, ``impact`` and ``horizon``.
    chaos : Chaos
        Statistics beyond the horizon.
    wear : WearStudy
        How wear depends on the means it is computed with.
    """

    scene: Scene
    extent: PrecisionExtent
    provenance: Provenance
    processor: str
    wall: float
    horizon: float
    diagrams: tuple[Diagram, ...]
    chaos: Chaos
    wear: WearStudy


def study(scene: Scene, extent: PrecisionExtent, told: Told) -> Precision:
    """Measure speed and error of every engine and integrator.

    A method that fails stays in as a failure.

    Raises
    ------
    InputError
        Where the scene has no clearance, or nothing that wears.
    RunFailed
        Where a reference fails.
    """
    if not scene.clearance_joints:
        raise InputError(f"scene {scene.name} has no clearance, so no impacts; name one that has")
    quick, repeats, rungs = extent.quick, extent.repeats, extent.rungs
    means, length = (wear.QUICK, chaos.QUICK) if quick else (wear.FULL, chaos.FULL)
    # Asked before anything is measured, which takes half an hour.
    wear.cases(scene, means)
    seconds = dict(zip(_SECTIONS, _QUICK_SECONDS if quick else _SECONDS, strict=True))
    began, source, parts = clock.perf_counter(), provenance(), parts_of(told, seconds)
    diagrams = [
        measure(smooth.ideal_mechanism(scene, rungs), repeats, parts["ideal"]),
        measure(smooth.andrews(rungs), repeats, parts["andrews"]),
        measure(impact.single(scene, rungs), repeats, parts["impact"]),
    ]
    task, until = horizon.with_clearance(scene, rungs, extent.longest, parts["horizon"])
    diagrams.append(measure(task, repeats, parts["horizon"]))
    statistics = chaos.follow(scene, length, parts["statistics"])
    worn = wear.vary(scene, means, parts["wear"])
    told("done", 1.0)
    return Precision(
        scene,
        extent,
        source,
        processor_name(),
        clock.perf_counter() - began,
        until,
        tuple(diagrams),
        statistics,
        worn,
    )
