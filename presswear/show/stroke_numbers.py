"""Key numbers of the strokes: motion, work, frame, slide, flywheel and bottom dead centre."""

from presswear.physics import statics
from presswear.physics.dead_centre import bottom_of
from presswear.recording.statistics import Estimate
from presswear.results.frame_load import carried_weight, frame_loads
from presswear.results.guide_tilt import guide_tilts
from presswear.results.motor_load import leader_speed
from presswear.results.run_film import run_films
from presswear.results.stage import StageResult
from presswear.results.stage_statistics import BottomStatistics
from presswear.results.tonnage import tonnage_of
from presswear.scene.scene import Scene
from presswear.show.key_number import SCATTERS, exact, measured
from presswear.show.page import KeyNumber
from presswear.tools import numbers
from presswear.tools.errors import InputError, RunFailed

# Weight along a level guide over the force of the guide, by the round-off of directions
ROUND_OFF = 1e-9
NEGLIGIBLE = 1e-8  # m, error of bottom dead centre that no instrument of a press shows


def motion_numbers(scene: Scene, stage: StageResult) -> list[KeyNumber]:
    """Return the stroke and the strokes a minute, those that a motor reaches if there is one."""
    result = []
    if bottom_of(scene.ideal) is not None:
        text = f"Of {scene.output} from end to end, without clearance."
        result.append(exact("Stroke", scene.stroke, "m", text))
    rate = 60.0 / scene.mechanism.period
    nominal = numbers.readable(rate)
    speed = leader_speed(scene, stage)
    if speed is None:
        text = "Prescribed by the drives."
        return [*result, exact("Strokes a minute", rate, "", text)]
    text = f"Reached by the motor, on average; nominal: {nominal}."
    reached = speed.stroke_rate.scaled(60.0)
    return [*result, measured("Strokes a minute", reached, "", text)]


def stroke_numbers(scene: Scene, stage: StageResult) -> list[KeyNumber]:
    """Return the numbers of work, frame, slide, film, flywheel and bottom dead centre."""
    result = [
        *_work_numbers(scene, stage),
        *_frame_numbers(scene, stage),
        *_flywheel_numbers(scene, stage),
        *_guide_numbers(scene, stage),
        *_film_numbers(scene, stage),
    ]
    bdc = stage.statistics.bdc
    if bdc is None or not scene.has_deviations:
        return result
    text = "Against rigid joints without clearance; negative is deeper."
    if bottoms := equal_bottoms_text(scene, bdc):
        text += f" The stroke has equal bottoms, {bottoms}: no delay is defined."
    result.append(_of_bottom("Bottom dead centre error", bdc.error, text, bdc.strokes))
    text = "Standard deviation of bottom dead centre, stroke to stroke."
    scatter = bdc.standard_deviation
    return [*result, _of_bottom("Repeatability", scatter, text, bdc.strokes)]


def _work_numbers(scene: Scene, stage: StageResult) -> list[KeyNumber]:
    """Return force and work of a stroke on the work, and the deflection under this force."""
    tonnage = tonnage_of(scene, stage)
    if tonnage is None or tonnage.peak_force is None:
        return []
    text = f"Greatest force of the work on {scene.output} in a stroke."
    result = [measured("Working force", tonnage.peak_force, "N", text)]
    if tonnage.work is not None:
        text = f"Energy that the work takes from {scene.output}."
        result.append(measured("Work of a stroke", tonnage.work, "J", text))
    force = tonnage.peak_force.mean
    if (rise := _deflection(scene, stage, force)) is not None:
        text = f"Rise of bottom dead centre under a static {numbers.quantity_text(force, 'N')}, "
        text += "with clearance, contacts and springs, drives held."
        number = exact("Deflection under load", rise, "m", text)
        result.append(number._replace(depends_on_wear=True))
    return result


def _deflection(scene: Scene, stage: StageResult, force: float) -> float | None:
    """Return the rise of bottom dead centre under a static force, m; None if nothing deflects.

    It is also None without a static equilibrium, and for stored laws that are not trusted.
    """
    if not (scene.has_deviations and scene.is_trusted):
        return None
    try:
        rise = float(statics.deflection(scene.linkage(stage.surfaces), force))
    except (InputError, RunFailed):
        return None
    # The load may leave all joints closed.
    return rise if abs(rise) > NEGLIGIBLE else None


def _flywheel_numbers(scene: Scene, stage: StageResult) -> list[KeyNumber]:
    """Return the energy of the flywheel of the first motor, J, and what the work takes from it."""
    leader = scene.linkage().leader
    speed = leader_speed(scene, stage)
    if leader is None or leader.motor is None or speed is None:
        return []
    inertia = leader.motor.reflected_inertia
    if inertia == 0.0:
        return []
    energy = 0.5 * inertia * leader.speed**2
    text = f"Of rotor and flywheel at the nominal speed of {leader.body}."
    if speed.touch is not None and speed.drop is not None:
        delivered = energy * speed.touch.mean**2 * (1.0 - (1.0 - speed.drop.mean) ** 2)
        text += f" Its drop in the work gives {numbers.quantity_text(delivered, 'J')}."
    return [exact("Flywheel energy", energy, "J", text)]


def _guide_numbers(scene: Scene, stage: StageResult) -> list[KeyNumber]:
    """Return the tilt of each slide in a guide with clearance, if there is no work."""
    if scene.process is not None:
        return []  # a table of limits shows the tilt beside its limit
    return [
        measured("Tilt of the slide", tilt.working.scaled(1e6), "µm/m", f"In {name}.")
        for name, tilt in guide_tilts(scene, stage).items()
        if tilt.working is not None
    ]


def _of_bottom(
    name: str, length: Estimate | None, meaning: str, strokes: int
) -> KeyNumber:
    """Return a length of bottom dead centre; a negligible one is not printed in picometres."""
    if length is not None and abs(length.mean) < NEGLIGIBLE:
        return KeyNumber(name, f"below {1e9 * NEGLIGIBLE:.0f} nm", "", meaning)
    number = measured(name, length, "m", meaning, strokes)
    if number.note == SCATTERS:
        number = number._replace(note="single strokes decide it")
    return number


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
    """Return the stretch of each elastic frame."""
    result = []
    linkage = scene.linkage()
    carried = {
        guide.name: carried_weight(linkage, guide) for guide in linkage.elastic_guides
    }
    for name, load in frame_loads(scene, stage).items():
        if load.stretch is None or load.force is None:
            continue
        force = numbers.quantity_text(load.force.mean, "N")
        text = f"Stretch of {name} at its greatest force, {force}"
        weight = abs(carried[name])
        if weight > ROUND_OFF * load.force.mean:
            size = numbers.quantity_text(weight, "N")
            text += f"; both from rest under the carried weight, {size}"
        text += "."
        result.append(measured("Stretch of the frame", load.stretch, "m", text))
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
    text += (
        f"{roughness}. Full film for {numbers.percent(film.full_share)} of the cycle."
    )
    value = numbers.quantity_text(thinnest[joint], "m")
    single = Estimate(thinnest[joint])
    return [KeyNumber("Least oil film", value, "", text, estimate=single)]
