"""Table of the report on tonnage and shock."""

from collections.abc import Callable

from presswear.recording.statistics import Estimate
from presswear.results.result import Result
from presswear.results.stage import StageResult
from presswear.results.tonnage import PHASES, SNAP_THROUGH_S, JointTonnage, Tonnage, tonnage_of
from presswear.show.report.parts import MILLI, Rows, Table, Text, stage_table
from presswear.tools.numbers import given, whole, with_interval

_WINDOW = f"{given(MILLI * SNAP_THROUGH_S)} ms"


def tonnage(result: Result) -> Table | None:
    """Forces of joints by phase of the stroke; None where there are none."""
    found = {stage.index: tonnage_of(result.scene, stage) for stage in result.stages}
    told = [own for own in found.values() if own is not None]
    if not any(own.joints for own in told):
        return None

    def of(own: Callable[[Tonnage], Estimate | None], factor: float = 1.0) -> Text:
        def text(stage: StageResult) -> str:
            tonnage = found[stage.index]
            return _estimate(None if tonnage is None else own(tonnage), factor)

        return text

    def of_joint(name: str) -> Rows[StageResult]:
        def at(own: Callable[[JointTonnage], Estimate | None], factor: float = 1.0) -> Text:
            return of(lambda tonnage: own(tonnage.joints[name]), factor)

        def in_phase(phase: str) -> Text:
            return at(lambda own: own.peak_N.get(phase))

        first = next(own.joints[name] for own in told)
        rows = {
            f"greatest force of a stroke, {phase} (N)": in_phase(phase)
            for phase in PHASES
            if phase in first.peak_N
        }
        if first.reversed_N is None:
            return rows
        return rows | {
            "greatest along the working direction (N)": at(lambda own: own.working_N),
            f"greatest against it within {_WINDOW} of the fracture (N)": at(
                lambda own: own.reversed_N
            ),
            "the same, part of that along it (%)": at(lambda own: own.reversed_part, 100.0),
            "fracture to the first force against it (ms)": at(lambda own: own.reversal_s, MILLI),
        }

    groups: dict[str, Rows[StageResult]] = {}
    if any(own.vibration for own in told):
        groups[f"Acceleration of the {result.scene.watched} less ideal, rms (m/s²)"] = {
            f"{_WINDOW} before the contact": of(
                lambda own: None if own.vibration is None else own.vibration.before_m_s2
            ),
            f"{_WINDOW} after the fracture": of(
                lambda own: None if own.vibration is None else own.vibration.after_m_s2
            ),
        }
    groups |= {f"Joint {name}": of_joint(name) for name in told[0].joints}

    def counted(stage: StageResult) -> str:
        own = found[stage.index]
        return whole(None if own is None else own.strokes)

    def worst(stage: StageResult) -> str:
        own = found[stage.index]
        return "–" if own is None or own.most_loaded is None else own.most_loaded

    groups["Strokes"] = {"settled strokes": counted, "most loaded joint": worst}
    return stage_table(result, "mean over strokes", groups)


def _estimate(told: Estimate | None, factor: float) -> str:
    if told is None:
        return "–"
    half = None if told.half_width is None else factor * told.half_width
    return with_interval(factor * told.mean, half)
