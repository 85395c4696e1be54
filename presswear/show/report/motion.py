"""Table of the report on what the motion is: modes of contact, repetition, spectra."""

from collections.abc import Callable
from dataclasses import dataclass
from itertools import permutations

from presswear.analysis.contact_modes import MODES, Timeline, combine
from presswear.analysis.periods import Periodicity
from presswear.analysis.spectra import Spectrum
from presswear.results.modes import (
    has_motion,
    period_of,
    resonance,
    settled_span,
    spectra_of,
    timeline_of,
)
from presswear.results.result import Result
from presswear.results.stage import StageResult
from presswear.scene.scene import Scene
from presswear.show.report.parts import MILLI, NOTHING, Rows, Table, by_joint, stage_table
from presswear.tools.numbers import readable

FILES = ("phase.png", "poincare.png", "modes.png", "spectrum.png")
"""Files of the figures that stand beside the table."""
_HARMONICS = (1, 2, 3)
"""Orders of the crank whose amplitudes are told."""
_LINES = 8
"""Lines in an order, at least, where the power at whole orders is told: with fewer of them noise
has most of its power there too."""


@dataclass(frozen=True)
class _Motion:
    """The motion of a stage in its recorded cycles behind the start-up.

    Attributes
    ----------
    cycles : float
    timelines : dict
        Modes by joint.
    together : Timeline
        Modes of all joints at once.
    period : Periodicity
    spectra : dict
        See ``spectra_of``.
    resonances : dict
        Frequencies of the contact by joint, Hz.
    """

    cycles: float
    timelines: dict[str, Timeline]
    together: Timeline
    period: Periodicity
    spectra: dict[str, Spectrum]
    resonances: dict[str, float | None]


_Text = Callable[[_Motion], str]


def _motion_of(scene: Scene, stage: StageResult) -> _Motion:
    begin, end = settled_span(scene, stage)
    lines = {joint: timeline_of(scene, stage, joint) for joint in scene.clearance_joints}
    return _Motion(
        (end - begin) / scene.mechanism.period,
        lines,
        combine(list(lines.values())),
        period_of(scene, stage),
        spectra_of(scene, stage),
        {joint: resonance(stage, joint) for joint in lines},
    )


def motion(result: Result) -> Table | None:
    """Modes of contact, repetition and harmonics by stage; None where no cycle was recorded."""
    scene = result.scene
    found = {own.index: _motion_of(scene, own) for own in result.stages if has_motion(scene, own)}
    if not found:
        return None

    def told(rows: dict[str, _Text]) -> Rows[StageResult]:
        return {label: _of_stage(found, text) for label, text in rows.items()}

    def of_joint(joint: str) -> Rows[StageResult]:
        return told({mode: _visits(lambda own: own.timelines[joint], mode) for mode in MODES})

    joints, groups = scene.clearance_joints, by_joint(result, of_joint)
    for joint in joints:
        lines = [own.timelines[joint] for own in found.values()]
        pairs = permutations(range(len(MODES)), 2)
        groups[f"Joint {joint}, changes of mode in a cycle"] = told(
            {
                f"{MODES[a]} to {MODES[b]}": _changes(joint, a, b)
                for a, b in pairs
                if any(own.transitions[a, b] for own in lines)
            }
        )
    if len(joints) > 1:
        together = [own.together for own in found.values()]
        names = [name for name in together[0].names if any(own.shares[name] for own in together)]
        rows = {name: _visits(lambda own: own.together, name) for name in names}
        groups[f"{' and '.join(joints)} at once"] = told(rows)
    groups["Repetition"] = told(
        {
            "period, in parts of the clearance": lambda own: str(own.period),
            "recorded cycles behind the start-up": lambda own: readable(own.cycles),
        }
    )
    series = {"": f"acceleration of the {scene.watched} (m/s²)"}
    series |= {joint: f"force at {joint} (N)" for joint in joints}
    orders = ", ".join(map(str, _HARMONICS))
    groups["Spectra"] = told(
        {f"{text}, orders {orders}": _harmonics(name) for name, text in series.items()}
        | {f"{text}, power at whole orders (%)": _at_whole(name) for name, text in series.items()}
        | {f"contact resonance of {joint} (Hz)": _resonance(joint) for joint in joints}
    )
    return stage_table(result, "share of the time, visits in a cycle, mean visit", groups)


def _of_stage(found: dict[int, _Motion], text: _Text) -> Callable[[StageResult], str]:
    return lambda stage: text(found[stage.index]) if stage.index in found else NOTHING


def _visits(line: Callable[[_Motion], Timeline], mode: str) -> _Text:
    """Share of the time in a mode, how often it is visited in a cycle, and the mean visit."""

    def text(own: _Motion) -> str:
        share, visits = line(own).shares[mode], line(own).visits(mode)
        told = f"{100.0 * share:.2f} %"
        if visits.size:
            mean = MILLI * float(visits.mean())
            told += f", {visits.size / own.cycles:.3g} of {mean:.3g} ms"
        return told

    return text


def _changes(joint: str, before: int, after: int) -> _Text:
    return lambda own: f"{own.timelines[joint].transitions[before, after] / own.cycles:.3g}"


def _harmonics(name: str) -> _Text:
    def text(own: _Motion) -> str:
        return ", ".join(readable(own.spectra[name].amplitude(order)) for order in _HARMONICS)

    return text


def _at_whole(name: str) -> _Text:
    def text(own: _Motion) -> str:
        found = own.spectra[name]
        return readable(100.0 * found.harmonic_share) if found.lines >= _LINES else NOTHING

    return text


def _resonance(joint: str) -> _Text:
    return lambda own: readable(own.resonances[joint])
