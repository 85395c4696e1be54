"""Warnings about unfinished work, contacts too deep for the model, and rough surfaces."""

from collections.abc import Sequence

from presswear.linkage.process import Coining
from presswear.results.deep_contacts import deep_contacts
from presswear.results.stage import StageResult
from presswear.results.strokes import motion_of_work, sampled_strokes
from presswear.scene.scene import Scene
from presswear.tools.numbers import readable

# Advised height over the least height, because a larger force deflects the press more
_MARGIN = 1.02
_ENDS = {
    "blanking": "The sheet does not break",
    "drawing": "The work is not drawn to its depth",
}


def unfinished_work(scene: Scene, stages: Sequence[StageResult]) -> list[str]:
    """Return a sentence if recorded strokes of the last sound stage do not finish the work.

    The ideal stroke finishes it (``process.check_reach``), but clearance, contacts and an
    elastic frame keep the output above its ideal path.
    """
    process = scene.process
    sound = [stage for stage in stages if not stage.failed]
    if process is None or isinstance(process, Coining) or not sound:
        return []
    stage = sound[-1]
    height, _ = motion_of_work(scene, stage)
    lowest = []
    for stroke in sampled_strokes(scene, stage):
        rows = (stage.clock >= stroke.start) & (stage.clock < stroke.end)
        lowest.append(float(height[rows].min(initial=process.height)))
    depth = process.curve[-1][0] if process.fracture is None else process.fracture
    unfinished = [end for end in lowest if process.height - end < depth]
    if not unfinished:
        return []
    highest = max(unfinished)
    reached = _millimetres(process.height - highest)
    needed = _millimetres(depth)
    allowed = _millimetres(_MARGIN * (highest + depth))
    return [
        f"{_ENDS[process.kind]} in {len(unfinished)} of {len(lowest)} strokes: {scene.output} "
        f"goes {reached} deep into the work, which ends at {needed}, because clearance, contacts "
        "and frame give way. Work, torque, pressure and wear are those of an unfinished stroke. "
        f"Use process.height = {allowed} or more, or a stiffer press."
    ]


def _millimetres(length: float) -> str:
    return f"{readable(1e3 * length)} mm"


def high_bumps(scene: Scene, stages: Sequence[StageResult]) -> list[str]:
    """Return sentences on stages whose surfaces have bumps higher than the penetration."""
    advice = (
        "life.quick = off"
        if scene.is_quick
        else "more cycles, or extrapolation = steps"
    )
    sentences = []
    for stage in stages:
        rough = []
        for name, bumps in stage.statistics.high_bumps.items():
            height = readable(1e6 * bumps.height, 2)
            penetration = readable(1e6 * bumps.penetration, 2)
            rough.append(f"{name} ({height} µm, penetration {penetration} µm)")
        if rough:
            sentences.append(
                f"{stage.name.capitalize()}: bumps are higher than the penetration at joint "
                f"{' and '.join(rough)}, because one jump multiplies the noise of its wear map. "
                f"Contacts and peak values have no interval; use {advice}."
            )
    return sentences


def run_warnings(scene: Scene, stages: Sequence[StageResult]) -> list[str]:
    """Return sentences on unfinished work, contacts too deep for the model, rough surfaces."""
    return [
        *unfinished_work(scene, stages),
        *deep_contacts(scene, stages),
        *high_bumps(scene, stages),
    ]
