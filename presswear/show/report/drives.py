"""Rows of the report on the drives."""

from collections.abc import Callable

from presswear.results.drives import Duty, drives_of
from presswear.results.result import Result
from presswear.results.stage import StageResult
from presswear.show.report.parts import Rows
from presswear.tools.numbers import readable


def of_drives(result: Result) -> dict[str, Rows[StageResult]]:
    """Torque and power of each drive under its heading, where a stage has stored torques."""
    found = {stage.index: drives_of(result.scene, stage) for stage in result.stages}
    bodies = dict.fromkeys(body for own in found.values() for body in own)

    def told(body: str, which: str, name: str) -> Callable[[StageResult], str]:
        def text(stage: StageResult) -> str:
            own = found[stage.index].get(body)
            duty: Duty | None = None if own is None else getattr(own, f"{which}_duty")
            return readable(None if duty is None else getattr(duty, name))

        return text

    return {
        f"Drive of {body}": {
            f"{which}, {words} ({unit})": told(body, which, name)
            for which, unit in (("torque", "N m"), ("power", "W"))
            for name, words in (("mean", "mean"), ("rms", "rms"), ("peak", "largest"))
        }
        for body in bodies
    }
