"""Key numbers of the strokes: work, frame, slide, bottom dead centre and motor."""

from presswear.recording.statistics import Estimate
from presswear.results.frame_load import ALLOWED_REVERSE, frame_loads
from presswear.results.guide_tilt import ALLOWED_TILT, LEAST_ALLOWED_TILT, guide_tilts
from presswear.results.motor_load import ALLOWED_DROP, leader_speed, motor_loads
from presswear.results.run_film import run_films
from presswear.results.stage import BottomStatistics, StageResult
from presswear.results.tonnage import tonnage_of
from presswear.scene.scene import Scene
from presswear.show.key_number import measured
from presswear.show.page import KeyNumber
from presswear.tools import numbers

NEGLIGIBLE = 1e-8  # m, error of bottom dead centre that no instrument of a press shows
# Tilt that press makers ask for, as a text
ALLOWED_TILT_TEXT = f"{1e6 * LEAST_ALLOWED_TILT:.0f} to {1e6 * ALLOWED_TILT:.0f} µm/m"


def stroke_numbers(scene: Scene, stage: StageResult) -> list[KeyNumber]:
    """Return the numbers of work, frame, slide and bottom dead centre."""
    tonnage = tonnage_of(scene, stage)
    bdc = stage.statistics.bdc
    result = []
    if tonnage is not None and tonnage.peak_force is not None:
        text = f"Greatest force of the work on {scene.output} in a stroke."
        result.append(measured("Working force", tonnage.peak_force, "N", text))
    result += _frame_numbers(scene, stage)
    result += _guide_numbers(scene, stage)
    result += _film_numbers(scene, stage)
    if bdc is None or not scene.has_deviations:
        return result
    text = f"Lowest position of {scene.output} compared with rigid joints without clearance; "
    text += "negative is deeper."
    if bottoms := equal_bottoms_text(scene, bdc):
        text += f" The stroke has equal bottoms, {bottoms}: no delay is defined."
    result.append(_of_bottom("Bottom dead centre error", bdc.error, text, bdc.strokes))
    text = "Standard deviation of bottom dead centre from stroke to stroke."
    scatter = bdc.standard_deviation
    return [*result, _of_bottom("Repeatability", scatter, text, bdc.strokes)]


def _of_bottom(
    name: str, length: Estimate | None, meaning: str, strokes: int
) -> KeyNumber:
    """Return a length of bottom dead centre; a negligible one is not printed in picometres."""
    if length is not None and abs(length.mean) < NEGLIGIBLE:
        return KeyNumber(name, f"below {1e9 * NEGLIGIBLE:.0f} nm", "", meaning)
    return measured(name, length, "m", meaning, strokes)


def equal_bottoms_text(scene: Scene, bdc: BottomStatistics) -> str:
    """Return where the equal bottoms of a stroke are; empty if it has one bottom."""
    if not bdc.equal_bottoms:
        return ""
    turn = 360.0 / scene.mechanism.period
    angles = " and ".join(f"{turn * time:.2f}" for time in bdc.equal_bottoms)
    times = " and ".join(f"{1e3 * time:.2f}" for time in bdc.equal_bottoms)
    phase = scene.mechanism.linkage().phase
    return f"at {angles} degrees of {phase} since the start ({times} ms)"


def _frame_numbers(scene: Scene, stage: StageResult) -> list[KeyNumber]:
    """Return the stretch of each elastic frame, with its reverse force."""
    result = []
    for name, load in frame_loads(scene, stage).items():
        if load.stretch is None or load.force is None:
            continue
        force = numbers.quantity_text(load.force.mean, "N")
        text = f"Stretch of {name} at its greatest force, {force}."
        if load.reverse_fraction is not None:
            part = numbers.percent(load.reverse_fraction.mean, 2)
            text += (
                f" The reverse force after the fracture is {part} of it; press makers "
            )
            text += f"allow {100.0 * ALLOWED_REVERSE:.0f} %."
        result.append(measured("Stretch of the frame", load.stretch, "m", text))
    return result


def _guide_numbers(scene: Scene, stage: StageResult) -> list[KeyNumber]:
    """Return the tilt of each slide in a guide with clearance, and its greatest corner force."""
    result = []
    for name, tilt in guide_tilts(scene, stage).items():
        tilts = dict(tilt.at_work)
        if not tilts:
            continue
        at = next(iter(tilts))
        text = f"Tilt in {name} at {at}; makers of presses ask for {ALLOWED_TILT_TEXT} under load."
        first = tilts.pop(at)
        rest = [f"at {words} {microns_per_metre(one)}" for words, one in tilts.items()]
        if tilt.greatest is not None:
            rest.append(f"greatest in a stroke {microns_per_metre(tilt.greatest)}")
        text += f" Also {', '.join(rest)} µm/m."
        if tilt.corner_force is not None:
            force = numbers.quantity_text(tilt.corner_force.mean, "N")
            text += f" Greatest force of a corner: {force}."
        scaled = first.scaled(1e6)
        result.append(measured("Tilt of the slide", scaled, "µm/m", text))
    return result


def _film_numbers(scene: Scene, stage: StageResult) -> list[KeyNumber]:
    """Return the least oil film of the joints in which a film acts in the run."""
    films = run_films(scene, stage)
    if not films:
        return []
    thinnest = {name: float(film.thickness.min()) for name, film in films.items()}
    joint = min(thinnest, key=lambda name: thinnest[name])
    film = films[joint]
    roughness = numbers.quantity_text(film.roughness, "m")
    text = f"At joint {joint}, in the last recorded cycle; the roughness of both surfaces is "
    text += f"{roughness}. Full film for {numbers.percent(film.time_shares[0])} of the cycle."
    value = numbers.quantity_text(thinnest[joint], "m")
    return [KeyNumber("Least oil film", value, "", text)]


def motor_numbers(scene: Scene, stage: StageResult) -> list[KeyNumber]:
    """Return the strokes a minute that the motor reaches, with its drop and its torque."""
    speed = leader_speed(scene, stage)
    if speed is None:
        return []
    text = "Strokes a minute, on average."
    if speed.drop is not None:
        part = numbers.percent(speed.drop.mean, 2)
        text += f" The work slows the motor by {part}; press makers allow "
        text += f"{100.0 * ALLOWED_DROP:.0f} %."
    for body, load in motor_loads(scene, stage).items():
        part = numbers.percent(load.rms_fraction.mean)
        text += f" The rms torque of the motor of {body} is {part} of the rated one."
    rate = speed.stroke_rate.scaled(60.0)
    return [measured("Speed reached", rate, "strokes a minute", text)]


def microns_per_metre(tilt: Estimate) -> str:
    """Return the mean of a tilt, rad, in um/m as a text."""
    return numbers.readable(1e6 * tilt.mean, 2)
