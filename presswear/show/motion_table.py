"""Table of contact modes, periodicity and spectra of each stage."""

import numpy as np

from presswear.analysis.contact_modes import (
    MODES,
    Timeline,
    timeline_of,
)
from presswear.analysis.periods import period_of
from presswear.analysis.spectra import Spectrum, spectra_of
from presswear.results.result import Result
from presswear.results.sampled_cycles import has_motion, sampled_span
from presswear.results.stage import StageResult
from presswear.scene.scene import Scene
from presswear.show.figures.style import stage_names
from presswear.show.page import Table
from presswear.show.tables import HARMONICS, Record, result_table
from presswear.tools import numbers

# Least number of spectral lines in an order of the crank. With fewer lines even noise has
# most of its power at whole orders.
_MIN_LINES = 8


def motion_table(result: Result) -> Table | None:
    """Return contact modes, periodicity and spectra by stage; None if no cycle was recorded."""
    names = stage_names(result, result.stages)
    records = [
        {"name": name, **_motion_record(result.scene, stage)}
        for name, stage in zip(names, result.stages, strict=True)
        if has_motion(result.scene, stage)
    ]
    if not records:
        return None
    return result_table("motion", result, records, series=list(records[0]["harmonics"]))


def _motion_record(scene: Scene, stage: StageResult) -> Record:
    """Return the numbers of a stage that the rows of the table show."""
    start, end = sampled_span(scene, stage)
    cycles = (end - start) / scene.mechanism.period
    modes = {}
    changes = {}
    for joint in scene.dry_pins:
        timeline = timeline_of(scene, stage, joint)
        modes[joint] = _visits(timeline, cycles)
        changes[joint] = _changes(timeline, cycles)
    labels = {"": f"acceleration of {scene.output} (m/s²)"}
    labels |= {joint: f"force at {joint} (N)" for joint in scene.loose_pins}
    spectra = spectra_of(scene, stage)
    harmonics = {}
    shares = {}
    for name, label in labels.items():
        harmonics[label] = _amplitudes(spectra[name])
        shares[label] = _harmonic_share(spectra[name])
    return {
        "cycles": round(cycles) if abs(cycles - round(cycles)) < 1e-6 else cycles,
        "modes": modes,
        "changes": changes,
        "period": str(period_of(scene, stage)),
        "harmonics": harmonics,
        "whole": shares,
    }


def _visits(timeline: Timeline, cycles: float) -> dict[str, str]:
    """Return the share of the time in each mode, its visits per cycle and their mean duration."""
    texts = {}
    for mode, share in timeline.shares.items():
        texts[mode] = f"{100.0 * share:.2f} %"
        durations = timeline.visits(mode)  # s
        if durations.size:
            milliseconds = 1e3 * float(durations.mean())
            visits_per_cycle = durations.size / cycles
            texts[mode] += f", {visits_per_cycle:.3g} of {milliseconds:.3g} ms"
    return texts


def _changes(timeline: Timeline, cycles: float) -> dict[str, float]:
    """Return the number of transitions in a cycle by the modes before and after."""
    counts = timeline.transitions
    changes = {}
    for before, after in np.argwhere(counts):
        words = f"{MODES[before]} to {MODES[after]}"
        changes[words] = float(counts[before, after]) / cycles
    return changes


def _amplitudes(spectrum: Spectrum) -> str:
    """Return the amplitudes of the first harmonics as a text."""
    amplitudes = (spectrum.amplitude(order) for order in HARMONICS)
    return ", ".join(map(numbers.readable, amplitudes))


def _harmonic_share(spectrum: Spectrum) -> float | None:
    """Return the share of the power at whole orders; None if too few lines resolve it."""
    return spectrum.harmonic_share if spectrum.lines >= _MIN_LINES else None
