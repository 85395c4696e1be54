"""Warnings about unfinished work, contacts too deep for the model, and rough surfaces."""

from collections.abc import Sequence

from presswear.results.deep_contacts import deep_contacts
from presswear.results.stage import StageResult
from presswear.results.unfinished_work import unfinished_work
from presswear.scene.scene import Scene
from presswear.tools.numbers import readable


def high_bumps(scene: Scene, stages: Sequence[StageResult]) -> list[str]:
    """Return sentences on stages whose surfaces have bumps higher than the penetration."""
    advice = (
        "life.quick = off"
        if scene.is_quick
        else "more cycles, or extrapolation = steps"
    )
    sentences = []
    for stage in stages:
        rough = [
            f"{name} ({readable(1e6 * bumps.height, 2)} µm, penetration "
            f"{readable(1e6 * bumps.penetration, 2)} µm)"
            for name, bumps in stage.statistics.high_bumps.items()
        ]
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
