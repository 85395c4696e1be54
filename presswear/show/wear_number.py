"""Key number of the wear: deepest wear per million strokes."""

from collections.abc import Mapping

from presswear.linkage.wear_law import ARCHARD
from presswear.recording.statistics.estimate import Estimate, key_of_greatest
from presswear.results.oil_film import ASSUMES, oil_films
from presswear.results.stage import StageResult
from presswear.scene.scene import Scene
from presswear.show.joint_numbers import pins_of
from presswear.show.key_number import measured
from presswear.show.page import KeyNumber
from presswear.tools import numbers
from presswear.tools.quantities import Quantity, written


def wear_per_million_strokes(scene: Scene, stage: StageResult) -> list[KeyNumber]:
    """Return the deepest wear of the wear update after a stage; empty if it is not known.

    The wear is that of a million strokes, so that results of different updates can be
    compared.
    """
    per_million = 1e6 / stage.cycles_per_update
    wear = {}
    for name, joint in pins_of(scene, stage).items():
        for side, peak in joint.wear_peaks.items():
            is_worn = peak.depth.mean > 0.0 and not joint.is_unworn
            if side != "both" and is_worn:
                wear[name, side] = peak.depth.scaled(per_million)
    if not wear:
        return []
    place = key_of_greatest(wear)
    name, _ = place
    text = _place_text(scene, stage, place)
    text += _other_joints_text(scene, wear, name)
    text += _oil_text(scene, name)
    strokes = stage.statistics.joints[name].peak_force_per_cycle.samples
    return [measured("Wear per million strokes", wear[place], "m", text, strokes)]


def _place_text(scene: Scene, stage: StageResult, place: tuple[str, str]) -> str:
    """Return sentences on the deepest place, a joint and a side, and its wear law."""
    name, side = place
    materials = scene.bearing(name).materials
    represented = numbers.large(stage.cycles_per_update)
    surfaces = "worn" if stage.is_worn else "new"
    coefficient = Quantity("1/Pa").typeset(materials.wear_coefficient)
    text = (
        f"Deepest place, on the {side} of joint {name}, as a mean over {represented} "
    )
    text += f"strokes on {surfaces} surfaces, with wear_coefficient = {coefficient}."
    if materials.running_in != 1.0:
        text += f" New surfaces wear {materials.running_in:g} times as fast."
    if materials.pressure_exponent != 1.0:
        reference = written(materials.pressure_reference, "Pa")
        text += " Wear grows as the pressure to the power of "
        text += f"{materials.pressure_exponent:g}, and the coefficient is that at {reference}."
    if (law := scene.bearing(name).wear_law) != ARCHARD:
        text += f" The {law} changes this coefficient."
    return text + (f" It is for {scene.bin_remark}." if scene.bin_remark else "")


def _other_joints_text(
    scene: Scene, wear: Mapping[tuple[str, str], Estimate], deepest: str
) -> str:
    """Return a sentence on the deepest wear of each joint other than the deepest one."""
    texts = []
    for joint in scene.loose_pins:
        depths = [depth.mean for (name, _), depth in wear.items() if name == joint]
        if joint != deepest and depths:
            texts.append(f"{joint} {numbers.quantity_text(max(depths), 'm')}")
    return f" Other joints: {', '.join(texts)}." if texts else ""


def _oil_text(scene: Scene, joint: str) -> str:
    """Return sentences on the wear under oil films of the run, or beside the run."""
    text = ""
    if scene.bearing(joint).has_film:
        text += " Asperities wear, which touch through the oil film of the run."
    if films := oil_films(scene):
        shares = ", ".join(
            f"{numbers.percent(film.full_share)} of the cycle at {name}"
            for name, film in films.items()
        )
        text += (
            " The wear is that of dry contact: an upper bound where oil carries. Full "
        )
        text += f"oil film for {shares}. {ASSUMES}."
    return text
