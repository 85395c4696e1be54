"""Table of the report on what the motion is: modes of contact, repetition, spectra."""

from collections.abc import Callable
from dataclasses import dataclass
from itertools import permutations

from presswear.dynamics.modes import MODES, Timeline, jointly
from presswear.dynamics.period import Periodicity
from presswear.dynamics.spectra import Spectrum
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
        jointly(list(lines.values())),
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
        lines = [own.timelines[joint] for own in found.values()]
        rows = {mode: _visits(lambda own: own.timelines[joint], mode) for mode in MODES}
        pairs = permutations(range(len(MODES)), 2)
        for a, b in [pair for pair in pairs if any(own.transitions[pair] for own in lines)]:
            rows[f"{MODES[a]} to {MODES[b]}, times a cycle"] = _transitions(joint, a, b)
        rows["contact resonance (Hz)"] = lambda own: readable(own.resonances[joint])
        return told(rows)

    groups = by_joint(result, of_joint)
    if len(scene.clearance_joints) > 1:
        together = [own.together for own in found.values()]
        names = [name for name in together[0].names if any(own.shares[name] for own in together)]
        heading = f"{' and '.join(scene.clearance_joints)} at once"
        groups[heading] = told({name: _visits(lambda own: own.together, name) for name in names})
    groups["Repetition"] = told(
        {
            "period (of the clearances)": lambda own: own.period.words,
            "recorded cycles behind the start-up": lambda own: readable(own.cycles),
        }
    )
    series = {"": f"acceleration of the {scene.watched} (m/s²)"}
    series |= {joint: f"force at {joint} (N)" for joint in scene.clearance_joints}
    orders = ", ".join(map(str, _HARMONICS))
    groups["Spectra"] = told(
        {f"{text}, orders {orders}": _harmonics(name) for name, text in series.items()}
        | {f"{text}, power at whole orders (%)": _at_whole(name) for name, text in series.items()}
    )
    return stage_table(result, "share of the time, visits and their mean", groups)


def _of_stage(found: dict[int, _Motion], text: _Text) -> Callable[[StageResult], str]:
    return lambda stage: text(found[stage.index]) if stage.index in found else NOTHING


def _visits(line: Callable[[_Motion], Timeline], mode: str) -> _Text:
    """Share of the time in a mode, how often it is visited in a cycle, and the mean visit."""

    def text(own: _Motion) -> str:
        share, visits = line(own).shares[mode], line(own).sojourns(mode)
        told = f"{readable(100.0 * share)} %"
        if visits.size:
            mean = readable(MILLI * float(visits.mean()))
            told += f", {readable(visits.size / own.cycles)} a cycle of {mean} ms"
        return told

    return text


def _transitions(joint: str, before: int, after: int) -> _Text:
    return lambda own: readable(own.timelines[joint].transitions[before, after] / own.cycles)


def _harmonics(name: str) -> _Text:
    def text(own: _Motion) -> str:
        return ", ".join(readable(own.spectra[name].amplitude(order)) for order in _HARMONICS)

    return text


def _at_whole(name: str) -> _Text:
    return lambda own: readable(100.0 * own.spectra[name].harmonic_share)
