"""Key number of the pins: peak force; and the loads of their bearings that have limits."""

from collections.abc import Mapping

from presswear.recording.statistics.estimate import Estimate, key_of_greatest
from presswear.results.deep_contacts import (
    PRESCRIBED,
    SMALL_CONTACT,
    forces_by_law,
    has_deep_law,
    ideal_force,
    penetrations,
)
from presswear.results.motions import needs_warning, sentence_of
from presswear.results.motor_load import period_in
from presswear.results.stage import StageResult
from presswear.results.stage_statistics import JointStatistics
from presswear.scene.scene import Scene
from presswear.show.drive_numbers import IDEAL
from presswear.show.key_number import (
    ENOUGH,
    UNKNOWN,
    enough_cycles,
    fewest_strokes,
    measured,
)
from presswear.show.page import KeyNumber
from presswear.tools import numbers

# title, unit and meaning of each load of a bearing, by the setting that limits it
LOADS = {
    "pressure_limit": ("Pin pressure p", "Pa", "Peak force over projected area"),
    "pv_limit": ("p v", "W/m^2", "Mean of pressure times sliding speed"),
}


def joint_numbers(scene: Scene, stages: list[StageResult]) -> list[KeyNumber]:
    """Return the peak force at the pin where it is greatest; empty without a pin."""
    return [_peak_force(scene, stages)] if pins_of(scene, stages[-1]) else []


def _peak_force(scene: Scene, stages: list[StageResult]) -> KeyNumber:
    """Return the peak force at the pin where it is greatest."""
    first = stages[0]
    last = stages[-1]
    joints = pins_of(scene, last)
    forces = {name: joint.peak_force_per_cycle for name, joint in joints.items()}
    at = key_of_greatest(forces)
    largest = numbers.quantity_text(joints[at].peak_force, "N")
    where = "of all strokes" if last is first else "in the last stage"
    sentences = [
        f"Greatest in a stroke at joint {at}, on average.",
        f"Largest {where}: {largest}.",
    ]
    if scene.linkage().elastic_joints:
        sentences.append("With impacts.")
    else:
        sentences.append("With impacts; a frame that bends makes them smaller.")
    ideal = ideal_force(scene, at)
    if ideal > 0.0:
        sentences.append(f"With {IDEAL}: {numbers.quantity_text(ideal, 'N')}.")
    if last is not first and at in first.statistics.joints:
        new = _peak_forces_text(first, at)
        strokes = numbers.large(sum(stage.cycles_per_update for stage in stages[:-1]))
        sentences.append(f"Before the wear of {strokes} strokes: {new}.")
    settling = last.statistics.settling
    if settling and not needs_warning(settling):
        text = sentence_of(settling)
        if settling.verdict != "unwatched":
            sentences.append(f"{text}.")
        elif fewest_strokes(stages) == ENOUGH:  # else a warning says it
            text += f"; cycles = {enough_cycles(scene)} or more shows it"
            sentences.append(f"{text}.")
    peak = measured("Peak joint force", forces[at], "N", " ".join(sentences))
    if settling and settling.is_mixture:
        note = reason_without_interval(last)
        peak = peak._replace(value=_peak_forces_text(last, at), interval="", note=note)
    is_deep = penetrations(scene, stages)[at] > SMALL_CONTACT
    if is_deep and not has_deep_law(scene, at):
        peak = _with_laws(peak, scene, at, forces[at].mean, ideal)
    return peak


def bearing_loads(scene: Scene, stage: StageResult) -> dict[str, dict[str, Estimate]]:
    """Return pin pressure, Pa, and pressure times sliding speed, W/m^2, of each joint.

    The key of each is the setting that limits it. The pressure is the peak force of a
    stroke over the projected area 2 R b. p v needs the convention ``slip = sliding``,
    with which the wear uses the sliding distance, and a joint that wears without an oil
    film.
    """
    loads: dict[str, dict[str, Estimate]] = {key: {} for key in LOADS}
    for name, joint in pins_of(scene, stage).items():
        bearing = scene.bearing(name)
        per_area = 1.0 / (2.0 * bearing.bearing_radius * bearing.total_width)
        loads["pressure_limit"][name] = _largest_force(stage, name).scaled(per_area)
        if (
            scene.conventions.slip == "sliding"
            and bearing.materials.wear_coefficient > 0.0
            # With a film the load distance is that of asperities only.
            and not bearing.has_film
        ):
            rate = per_area / period_in(scene, stage)
            loads["pv_limit"][name] = joint.load_distance_per_cycle.scaled(rate)
    return {key: values for key, values in loads.items() if values}


def pins_of(scene: Scene, stage: StageResult) -> dict[str, JointStatistics]:
    """Return the statistics of the pins; those of the corners of slides are left out."""
    joints = stage.statistics.joints.items()
    return {name: joint for name, joint in joints if name in scene.loose_pins}


def reason_without_interval(stage: StageResult) -> str:
    """Return why peak values of a stage have no interval, or nothing."""
    settling = stage.statistics.settling
    if settling and settling.is_mixture:
        return f"{len(settling.motions)} motions"
    return "bumps, see the warning" if stage.statistics.high_bumps else ""


def explained(number: KeyNumber, stage: StageResult) -> KeyNumber:
    """Return a peak value of a stage with the reason for a missing interval as its note."""
    reason = reason_without_interval(stage)
    if number.interval == UNKNOWN and reason:
        return number._replace(note=reason)
    return number


def _largest_force(stage: StageResult, joint: str) -> Estimate:
    """Return the mean peak force at a joint, or of the motion with the largest one."""
    settling = stage.statistics.settling
    if settling and settling.is_mixture:
        forces = [motion.peak_force[joint] for motion in settling.motions]
        return max(forces, key=lambda force: force.mean)
    return stage.statistics.joints[joint].peak_force_per_cycle


def _peak_forces_text(stage: StageResult, joint: str) -> str:
    """Return the mean peak force at a joint, or of each motion if replicates differ."""
    settling = stage.statistics.settling
    joints = stage.statistics.joints
    forces = [joints[joint].peak_force_per_cycle.mean]
    if settling and settling.is_mixture:
        forces = [motion.peak_force[joint].mean for motion in settling.motions]
    factor, unit = numbers.unit_scale("N", max(forces))
    return f"{' or '.join(numbers.readable(factor * force) for force in forces)} {unit}"


def _with_laws(
    peak: KeyNumber, scene: Scene, joint: str, force: float, ideal: float
) -> KeyNumber:
    """Return the peak force of a deep contact, N, with the ranges of the elastic laws.

    ``ideal`` is the peak that the load prescribes with rigid joints, N. Runs with the
    laws lie between the range for an impact and that beyond the prescribed force. Laws
    agree on a peak that the load prescribes.
    """
    impact = forces_by_law(scene, joint, force)
    if not impact or force <= PRESCRIBED * ideal:
        return peak
    factor, unit = numbers.unit_scale("N", max(impact.values()))

    def range_of(forces: Mapping[str, float]) -> str:
        ends = (factor * end(forces.values()) for end in (min, max))
        return f"{' to '.join(map(numbers.readable, ends))} {unit}"

    laws = f"by contact law {range_of(impact)} in an impact"
    if ideal > 0.0:
        pressed = range_of(forces_by_law(scene, joint, force, ideal))
        laws += f", {pressed} under a prescribed force"
    meaning = f"{peak.meaning} The pin sinks in deep, and the contact law matters: estimates by "
    meaning += "the laws power, liu and foundation. A run with each law decides."
    interval = f"{peak.interval}; {laws}" if peak.interval else laws
    return peak._replace(interval=interval, meaning=meaning)
