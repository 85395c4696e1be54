"""Forces of elastic pins in the sampled strokes of a stage."""

from collections.abc import Mapping

import numpy as np

from presswear.recording.statistics import Estimate
from presswear.results.stage import StageResult
from presswear.results.strokes import (
    PHASES,
    SampledStroke,
    means_by_name,
    sampled_strokes,
)
from presswear.scene.scene import Scene
from presswear.tools.arrays import Array


def elastic_pin_forces(
    scene: Scene, stage: StageResult
) -> dict[str, Mapping[str, Estimate]]:
    """Return the greatest force of each elastic pin in each phase of a stroke, N, by pin.

    Means over the sampled strokes. The force is that of the spring, stiffness times the
    distance of the centres. Empty without an elastic pin or a sampled stroke.
    """
    if "pin_stretch" not in stage.arrays or stage.failed:
        return {}
    strokes = sampled_strokes(scene, stage)
    forces: dict[str, Mapping[str, Estimate]] = {}
    columns = zip(
        scene.linkage().elastic_pins, stage.arrays["pin_stretch"].T, strict=True
    )
    for pin, stretch in columns:
        force = (pin.stiffness or 0.0) * stretch
        peaks = _peaks_by_phase(stage.clock, force, strokes)
        means = means_by_name(peaks)
        if means:
            forces[pin.name] = means
    return forces


def _peaks_by_phase(
    time: Array, force: Array, strokes: list[SampledStroke]
) -> dict[str, list[float]]:
    """Return the greatest forces in each phase of the strokes, N."""
    peaks: dict[str, list[float]] = {phase: [] for phase in PHASES}
    for stroke in strokes:
        for phase, (start, end) in stroke.phases.items():
            within = force[(time >= start) & (time <= end)]
            if within.size:
                peaks[phase].append(float(np.max(within)))
    return peaks
