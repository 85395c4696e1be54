"""Key numbers of a result, with intervals and short meanings, and warnings about them."""

import math
from collections.abc import Mapping
from typing import Any

from presswear.recording.statistics import STARTUP_CYCLES, Estimate
from presswear.results.contact_warnings import contact_warnings
from presswear.results.deep_contacts import SMALL_CONTACT, forces_by_law, penetrations
from presswear.results.drive_duty import DriveDuty
from presswear.results.drives import drives_of
from presswear.results.frame_load import ALLOWED_REVERSE, frame_loads
from presswear.results.guide_tilt import (
    ALLOWED_TILT,
    LEAST_ALLOWED_TILT,
    guide_tilts,
    self_locking,
)
from presswear.results.life import (
    QUICK,
    WITHOUT_CURVES,
    LifeResult,
    digits_of,
    span_of,
    words_of,
)
from presswear.results.motions import SETTLE_ADVICE, needs_warning, sentence_of
from presswear.results.motor_load import (
    ALLOWED_DROP,
    leader_speed,
    mean_period,
    motor_loads,
    period_in,
    saturated_servos,
)
from presswear.results.oil_film import ASSUMES, oil_films
from presswear.results.result import Result
from presswear.results.rigid_joints import ideal_drives, ideal_forces, rubbing_drives
from presswear.results.stage import BottomStatistics, JointStatistics, StageResult
from presswear.results.tonnage import tonnage_of
from presswear.scene.plausible import doubts, unusual
from presswear.scene.scene import Scene
from presswear.show.figures.life import limit_text
from presswear.show.page import NOTHING, KeyNumber
from presswear.tools import numbers
from presswear.tools.quantities import written
from presswear.tools.user_function import UserFunction

# Tilt that press makers ask for, as a text
_ASKED = f"{1e6 * LEAST_ALLOWED_TILT:.0f} to {1e6 * ALLOWED_TILT:.0f} µm/m"
ENOUGH = 20  # sampled strokes from which the intervals of peak forces are trusted
_MADE = 0.02  # energy that contacts make, relative to what they dissipate
_FOUNDATION = ' Use --set contact=foundation, or contact = "foundation" in [settings].'
UNKNOWN = "interval unknown"
_CLOSE = 0.9  # of the greatest wear or force, from which another joint is named as well
_STEP_ERROR = 0.1  # change of peak forces with finer time steps
# Linkages to which a run is compared
RUBBING = "rigid joints with friction"
IDEAL = "rigid joints without friction"
NEGLIGIBLE = 1e-8  # m, error of a bottom that no instrument of a press shows
# title, unit and words of the loads of bearings, by the settings that limit them
_LOADS = {
    "pressure_limit": ("Pin pressure p", "Pa", "Peak force over projected area"),
    "pv_limit": ("p v", "W/m^2", "Mean of pressure times sliding speed"),
}


def measured(
    name: str,
    estimate: Estimate | None,
    unit: str,
    meaning: str,
    strokes: int | None = None,
) -> KeyNumber:
    """Return a key number of an estimate in SI; a doubtful one has a note.

    ``strokes`` are the strokes behind it (default: the samples of the estimate).
    """
    if strokes is None:
        strokes = estimate.samples if estimate else 0
    note = f"{strokes} of {ENOUGH} strokes" if strokes < ENOUGH else ""
    if estimate is None:
        return KeyNumber(name, NOTHING, "", meaning, note=note)
    low = estimate.low
    mean = estimate.mean
    high = estimate.high
    factor, shown = numbers.unit_scale(unit, abs(mean))
    if low is None or high is None:
        value = f"{numbers.readable(factor * mean, 2)} {shown}"
        return KeyNumber(
            name, value, UNKNOWN, meaning, note=note or "scatters too much"
        )
    digits = 3 if high - low < 0.2 * abs(mean) else 2
    texts = [numbers.readable(factor * value, digits) for value in (mean, low, high)]
    interval = f"{texts[1]} to {texts[2]} {shown}" if texts[1] != texts[2] else ""
    return KeyNumber(name, f"{texts[0]} {shown}", interval, meaning, note=note)


def key_numbers(result: Result) -> list[KeyNumber]:
    """Return the key numbers of a life, and of the last stage that did not fail, if any."""
    stages = [
        stage for stage in result.stages if stage.statistics.output and not stage.failed
    ]
    life = [] if result.life is None else [_life(result, result.life)]
    if not stages:
        return life
    scene = result.scene
    last = stages[-1]
    reason = _reason_without_interval(last)

    def explained(peaks: list[KeyNumber]) -> list[KeyNumber]:
        """Say why peak values have no interval; that of wear and of strokes has others."""
        return [
            one._replace(note=reason or one.note) if one.interval == UNKNOWN else one
            for one in peaks
        ]

    return [
        *life,
        *explained(_joint_numbers(scene, stages)),
        *([] if life else _wear_depth(scene, stages)),
        *_stroke_numbers(scene, last),
        *_motor_numbers(scene, last),
        *explained(_drive_numbers(scene, stages)),
        *_improvement(scene, last, result.life),
    ]


def _reason_without_interval(stage: StageResult) -> str:
    """Return why peak values of a stage have no interval, or nothing."""
    settling = stage.statistics.settling
    if settling and settling.is_mixture:
        return f"{len(settling.motions)} motions"
    return "bumps, see the warning" if stage.statistics.high_bumps else ""


def _life(result: Result, life: LifeResult) -> KeyNumber:
    hours = numbers.readable(life.strokes * mean_period(result) / 3600.0, 2)
    first = life.first
    name = "Service life"
    name += f", {life.ended}" if life.ended in WITHOUT_CURVES else ""
    if first is None:
        value = f"more than {numbers.large(life.strokes)} strokes"
        return KeyNumber(name, value, "", f"No limit is exceeded in {hours} hours.")
    value = f"{numbers.large(life.strokes, digits=digits_of(life.total_error))} strokes"
    interval = span_of(life.strokes, life.total_error)
    meaning = (
        f"{hours} hours, until the {words_of(first.key)} exceeds {limit_text(first)}."
    )
    if life.ended == QUICK:
        meaning += " By two wear rates, with no error of steps."
    if interval:
        meaning += " The interval contains the scatter of the wear coefficients."
    return KeyNumber(name, value, interval and f"{interval} strokes", meaning)


def _bearing_loads(scene: Scene, stage: StageResult) -> dict[str, dict[str, Estimate]]:
    """Return pin pressure, Pa, and pressure times sliding speed, W/m^2, of each joint.

    Each is under the name of the setting that limits it. The pressure is the peak force
    of a stroke over the projected area 2 R b. The sliding distance is known where it is
    that of the wear.
    """
    loads: dict[str, dict[str, Estimate]] = {key: {} for key in _LOADS}
    for name, joint in _pins_of(scene, stage).items():
        bearing = scene.bearing(name)
        per_area = 1.0 / (2.0 * bearing.bearing_radius * bearing.total_width)
        loads["pressure_limit"][name] = _largest_force(stage, name).scaled(per_area)
        if (
            scene.conventions.slip == "sliding"
            and bearing.materials.wear_coefficient > 0.0
            and not bearing.has_film  # whose load distance is that of asperities
        ):
            rate = per_area / period_in(scene, stage)
            loads["pv_limit"][name] = joint.load_distance_per_cycle.scaled(rate)
    return {key: values for key, values in loads.items() if values}


def _pins_of(scene: Scene, stage: StageResult) -> dict[str, JointStatistics]:
    """Return the statistics of the pins; those of the corners of slides are left out."""
    joints = stage.statistics.joints.items()
    return {name: one for name, one in joints if name in scene.loose_pins}


def _joint_numbers(scene: Scene, stages: list[StageResult]) -> list[KeyNumber]:
    """Return peak force, pin pressure and p v at the joints where they are greatest."""
    first = stages[0]
    last = stages[-1]
    joints = _pins_of(scene, last)
    if not joints:
        return []
    forces = {name: joint.peak_force_per_cycle for name, joint in joints.items()}
    at = _greatest(forces)
    largest = numbers.quantity_text(joints[at].peak_force, "N")
    where = "" if last is first else " of the last stage"
    text = f"At joint {at}: greatest force in a stroke, on average. Largest of all strokes{where}: "
    text += f"{largest}. Impacts are included"
    is_rigid = not scene.linkage().elastic_joints
    text += "; a real frame bends and makes them smaller." if is_rigid else "."
    if not scene.has_untrusted_loads:
        ideal = float(abs(ideal_forces(scene)[1][at]).max())
        text += f" With {IDEAL}: {numbers.quantity_text(ideal, 'N')}."
    if last is not first and at in first.statistics.joints:
        new = _forces_of_motions(first, at)
        strokes = numbers.large(sum(one.cycles_per_update for one in stages[:-1]))
        text += f" Before the wear of {strokes} strokes: {new}."
    settling = last.statistics.settling
    if settling and not needs_warning(settling):
        text += f" {sentence_of(settling)}."
    peak = measured("Peak joint force", forces[at], "N", text)
    if settling and settling.is_mixture:
        note = _reason_without_interval(last)
        peak = peak._replace(value=_forces_of_motions(last, at), interval="", note=note)
    if penetrations(scene, stages)[at] > SMALL_CONTACT:
        peak = _with_laws(peak, forces_by_law(scene, at, forces[at].mean))
    result = [peak]
    for key, loads in _bearing_loads(scene, last).items():
        limits = {name: getattr(scene.bearing(name), key) for name in loads}
        ratios = {
            name: loads[name].scaled(1.0 / one) for name, one in limits.items() if one
        }
        at = _greatest(ratios or loads)
        bearing, (title, unit, words) = scene.bearing(at), _LOADS[key]
        size = f"{_mm(2.0 * bearing.bearing_radius)} × {_mm(bearing.width)} mm"
        limit = (
            numbers.quantity_text(limits[at], unit)
            if limits[at]
            else f"not given ({key})"
        )
        if key == "pressure_limit" and settling and settling.is_mixture:
            words += ", of the motion with the largest force,"
        text = f"{words} at joint {at} ({size}). Limit: {limit}."
        result.append(measured(title, loads[at], unit, text))
    return result


def _largest_force(stage: StageResult, joint: str) -> Estimate:
    """Return the mean peak force at a joint; of replicates with different motions the largest."""
    settling = stage.statistics.settling
    if settling and settling.is_mixture:
        return max(
            (one.peak_force[joint] for one in settling.motions),
            key=lambda one: one.mean,
        )
    return stage.statistics.joints[joint].peak_force_per_cycle


def _forces_of_motions(stage: StageResult, joint: str) -> str:
    """Return the mean peak force at a joint, or that of each motion of different replicates."""
    settling = stage.statistics.settling
    joints = stage.statistics.joints
    forces = [joints[joint].peak_force_per_cycle.mean]
    if settling and settling.is_mixture:
        forces = [motion.peak_force[joint].mean for motion in settling.motions]
    factor, unit = numbers.unit_scale("N", max(forces))
    return f"{' or '.join(numbers.readable(factor * force) for force in forces)} {unit}"


def _with_laws(peak: KeyNumber, forces: Mapping[str, float]) -> KeyNumber:
    """Return the peak force of a deep contact with the range of the elastic laws."""
    if not forces:
        return peak
    factor, unit = numbers.unit_scale("N", max(forces.values()))
    low, high = (numbers.readable(factor * end(forces.values())) for end in (min, max))
    laws = f"{low} to {high} {unit} by contact law"
    meaning = f"{peak.meaning} The pin sinks in deep: the range of the contact laws power, liu and "
    meaning += "foundation is that of an impact of the same elastic energy."
    interval = f"{peak.interval}; {laws}" if peak.interval else laws
    return peak._replace(interval=interval, meaning=meaning)


def _wear_depth(scene: Scene, stages: list[StageResult]) -> list[KeyNumber]:
    """Return the deepest wear of the last update that has one: a jump in one step has none.

    In a million strokes, so that results of different updates can be compared.
    """
    for stage in reversed(stages):
        wear = {
            (name, side): peak.depth.scaled(1e6 / stage.cycles_per_update)
            for name, joint in _pins_of(scene, stage).items()
            for side, peak in joint.wear_peaks.items()
            if side != "both" and peak.depth.mean > 0.0 and not joint.is_unworn
        }
        if wear:
            name, side = place = _greatest(wear)
            represented = numbers.large(stage.cycles_per_update)
            surfaces = "worn" if stage.is_worn else "new"
            text = f"Deepest place, on the {side} of joint {name}, as a mean over {represented} "
            bearing = scene.bearing(name)
            coefficient = written(bearing.materials.wear_coefficient, "1/Pa").replace(
                "^3", "³"
            )
            text += f"strokes on {surfaces} surfaces, with wear_coefficient = {coefficient}."
            if (ratio := bearing.materials.running_in) != 1.0:
                text += f" New surfaces wear {ratio:g} times as fast."
            if (power := bearing.materials.pressure_exponent) != 1.0:
                reference = written(bearing.materials.pressure_reference, "Pa")
                text += f" It grows as the pressure to the power of {power:g},"
                text += f" and the coefficient is that at {reference}."
            text += f" It is for {scene.bin_remark}." if scene.bin_remark else ""
            rest = [
                f"{joint} {numbers.quantity_text(max(depths), 'm')}"
                for joint in scene.loose_pins
                if joint != name
                and (depths := [wear[key].mean for key in wear if key[0] == joint])
            ]
            text += f" Other joints: {', '.join(rest)}." if rest else ""
            if scene.bearing(name).has_film:
                text += " Asperities wear, which touch through the oil film of the run."
            if films := oil_films(scene):
                shares = ", ".join(
                    f"{numbers.readable(100.0 * film.full_share)} % of the cycle at {at}"
                    for at, film in films.items()
                )
                text += " The wear is that of dry contact: an upper bound where oil carries. Full "
                text += f"oil film for {shares}. {ASSUMES}."
            strokes = stage.statistics.joints[name].peak_force_per_cycle.samples
            return [
                measured("Wear per million strokes", wear[place], "m", text, strokes)
            ]
    return []


def _greatest(values: Mapping[Any, Estimate]) -> Any:
    return max(values, key=lambda name: values[name].mean)


def _mm(length: float) -> str:
    return numbers.short_number(1e3 * length)


def _stroke_numbers(scene: Scene, stage: StageResult) -> list[KeyNumber]:
    """Return the force of the work, and accuracy and repeatability of bottom dead centre."""
    tonnage = tonnage_of(scene, stage)
    bdc = stage.statistics.bdc
    result = []
    if tonnage is not None and tonnage.peak_force is not None:
        text = f"Greatest force of the work on {scene.output} in a stroke."
        result.append(measured("Working force", tonnage.peak_force, "N", text))
    result += _frame_numbers(scene, stage)
    result += _guide_numbers(scene, stage)
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


def _frame_numbers(scene: Scene, stage: StageResult) -> list[KeyNumber]:
    """Return the stretch of each elastic frame, with its reverse force."""
    result = []
    for name, load in frame_loads(scene, stage).items():
        if load.stretch is None or load.force is None:
            continue
        force = numbers.quantity_text(load.force.mean, "N")
        text = f"Stretch of {name} at its greatest force, {force}."
        if load.reverse_fraction is not None:
            part = numbers.readable(100.0 * load.reverse_fraction.mean, 2)
            text += f" The reverse force after the fracture is {part} % of it; press makers "
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
        text = f"Tilt in {name} at {at}; makers of presses ask for {_ASKED} under load."
        first = tilts.pop(at)
        rest = [f"at {words} {_microns(one)}" for words, one in tilts.items()]
        if tilt.greatest is not None:
            rest.append(f"greatest in a stroke {_microns(tilt.greatest)}")
        text += f" Also {', '.join(rest)} µm/m."
        if tilt.corner_force is not None:
            force = numbers.quantity_text(tilt.corner_force.mean, "N")
            text += f" Greatest force of a corner: {force}."
        scaled = first.scaled(1e6)
        result.append(measured("Tilt of the slide", scaled, "µm/m", text))
    return result


def _microns(tilt: Estimate) -> str:
    return numbers.readable(1e6 * tilt.mean, 2)


def _guide_warnings(scene: Scene, stage: StageResult) -> list[str]:
    """Return sentences on slides of presses that tilt more than press makers ask for."""
    lines: list[str] = []
    if scene.process is None:
        return lines
    for name, tilt in guide_tilts(scene, stage).items():
        if tilt.is_excessive:
            tilts = ", ".join(
                f"{_microns(one)} µm/m at {words}"
                for words, one in tilt.at_work.items()
                if one.mean > ALLOWED_TILT
            )
            lines.append(
                f"{stage.name.capitalize()}: the slide tilts in {name} by {tilts}; press "
                f"makers ask for {_ASKED}."
            )
    return lines


def _motor_numbers(scene: Scene, stage: StageResult) -> list[KeyNumber]:
    """Return the strokes a minute that the motor reaches, with its drop and its torque."""
    speed = leader_speed(scene, stage)
    if speed is None:
        return []
    text = "Strokes a minute, on average."
    if speed.drop is not None:
        part = numbers.readable(100.0 * speed.drop.mean, 2)
        text += f" The work slows the motor by {part} %; press makers allow "
        text += f"{100.0 * ALLOWED_DROP:.0f} %."
    for body, load in motor_loads(scene, stage).items():
        part = numbers.readable(100.0 * load.rms_fraction.mean, 3)
        text += f" The rms torque of the motor of {body} is {part} % of the rated one."
    rate = speed.stroke_rate.scaled(60.0)
    return [measured("Speed reached", rate, "strokes a minute", text)]


def _motor_warnings(scene: Scene, stage: StageResult) -> list[str]:
    """Return sentences on motors that are slowed too much, overloaded or saturated."""
    name = stage.name.capitalize()
    speed = leader_speed(scene, stage)
    lines = []
    if speed is not None and speed.drop is not None and speed.is_excessive:
        part = numbers.readable(100.0 * speed.drop.mean, 2)
        lines.append(
            f"{name}: the work slows the motor by {part} %; press makers allow "
            f"{100.0 * ALLOWED_DROP:.0f} %. A larger flywheel reduces the drop."
        )
    for body, load in motor_loads(scene, stage).items():
        if load.is_overloaded:
            part = numbers.readable(100.0 * load.rms_fraction.mean, 3)
            lines.append(
                f"{name}: the rms torque of the motor of {body} is {part} % of its rated "
                "torque, so that the motor overheats."
            )
    for body, limit in saturated_servos(scene, stage).items():
        lines.append(
            f"{name}: the servo of {body} reaches its torque_limit of {written(limit, 'N m')} and "
            "falls behind its motion."
        )
    return lines


def equal_bottoms_text(scene: Scene, bdc: BottomStatistics) -> str:
    """Return where the equal bottoms of a stroke are; empty if it has one bottom."""
    if not bdc.equal_bottoms:
        return ""
    turn = 360.0 / scene.mechanism.period
    angles, times = (
        " and ".join(f"{factor * time:.2f}" for time in bdc.equal_bottoms)
        for factor in (turn, 1e3)
    )
    phase = scene.mechanism.linkage().phase
    return f"at {angles} degrees of {phase} since the start ({times} ms)"


def _drive_numbers(scene: Scene, stages: list[StageResult]) -> list[KeyNumber]:
    """Return torque and power of the drives with the largest; ideal ones if none were stored."""
    if scene.has_untrusted_loads or not scene.mechanism.linkage().drives:
        return []
    drives = drives_of(scene, stages[-1])
    ideal = ideal_drives(scene)
    rubbing = rubbing_drives(scene)
    new = drives_of(scene, stages[0]) if len(stages) > 1 else {}
    rigid = {RUBBING: rubbing, IDEAL: ideal} if rubbing else {IDEAL: ideal}
    if scene.base_linkage.has_motors:
        rigid = {f"{words}, at the nominal speed": one for words, one in rigid.items()}
    duties = {body: drive.duty for body, drive in drives.items()} or rubbing or ideal
    result = []
    for name, unit in (("torque", "N m"), ("power", "W")):
        closed = {
            body: Estimate(abs(getattr(duty, name).peak))
            for body, duty in duties.items()
        }
        peaks = {body: getattr(drive, f"peak_{name}") for body, drive in drives.items()}
        peaks = {
            body: peak for body, peak in peaks.items() if peak is not None
        } or closed
        body = _greatest(peaks)
        if name == "torque":
            typical = f"rms {numbers.quantity_text(duties[body].torque.rms, unit)}."
        else:
            typical = _mean_power(
                scene, [duty.power.mean for duty in duties.values()], peaks[body]
            )
        text = f"Largest in a stroke at {body}; {typical}"
        title = f"Peak drive {name}"
        compared = tuple(
            (words, _peak_text(one, name, unit)) for words, one in rigid.items()
        )
        if not drives:
            text += f" Computed with {RUBBING if rubbing else IDEAL}; drive_torque = on includes "
            text += "clearance and friction."
            value = numbers.quantity_text(peaks[body].mean, unit)
            result.append(KeyNumber(title, value, "", text, compared))
            continue
        before = getattr(new[body], f"peak_{name}") if body in new else None
        if before is not None:
            text += f" Before the wear: {numbers.quantity_text(before.mean, unit)}."
        result.append(
            measured(title, peaks[body], unit, text)._replace(compared=compared)
        )
    return result


def _peak_text(duties: Mapping[str, DriveDuty], name: str, unit: str) -> str:
    """Return the greatest peak of the drives as a text, with its drive if there are several."""
    peaks = {
        body: Estimate(abs(getattr(duty, name).peak)) for body, duty in duties.items()
    }
    body = _greatest(peaks)
    text = numbers.quantity_text(peaks[body].mean, unit)
    return f"{text} at {body}" if len(peaks) > 1 else text


def _mean_power(scene: Scene, means: list[float], peak: Estimate) -> str:
    """Return the mean power of all drives in words: one may brake while another drives."""
    total = sum(means)
    if abs(total) < 1e-9 * peak.mean:
        total = 0.0  # round-off of a cycle without net work
    together = " of all drives together" if len(means) > 1 else ""
    text = f"mean{together} {numbers.quantity_text(total, 'W')}."
    is_even = not any(drive.repeats for drive in scene.mechanism.linkage().drives)
    if total > 0.0 and is_even:
        text += " A motor with a flywheel delivers this mean."
    return text


def _improvement(
    scene: Scene, stage: StageResult, life: LifeResult | None
) -> list[KeyNumber]:
    """Return the joint to improve first: it ends the life, wears most, or is loaded most."""
    joints = _pins_of(scene, stage)
    if len(joints) < 2:
        return []
    if life is not None and life.first is not None and "." in life.first.key:
        joint = life.first.key.partition(".")[0]
        reason = "It ends the service life."
    else:
        volumes = {name: one.wear_volume for name, one in joints.items()}
        total = sum(one.mean for one in volumes.values())
        if total > 0.0:
            first = _rivals(volumes)
            joint = " or ".join(first)
            share = 100.0 * sum(volumes[name].mean for name in first) / total
            reason = f"{share:.0f} % of the material that the joints lose in a stroke is there."
            if len(first) == len(volumes):
                reason = "All joints lose about as much material in a stroke."
            if oil_films(scene):
                reason += " This is for dry contact; see the oil films."
        else:
            forces = {name: one.peak_force_per_cycle for name, one in joints.items()}
            joint = " or ".join(_rivals(forces))
            reason = "The largest force is there."
        reason += " The command presswear improve compares changes of each joint."
    return [KeyNumber("Improve first", f"joint {joint}", "", reason)]


def _rivals(values: Mapping[str, Estimate]) -> list[str]:
    """Return the name of the greatest value, and of those that are hardly smaller."""
    greatest = values[_greatest(values)]
    lowest = min(greatest.low or math.inf, _CLOSE * greatest.mean)
    return [
        name for name, one in values.items() if max(one.mean, one.high or 0.0) >= lowest
    ]


def warnings(result: Result) -> list[str]:
    """Return sentences on what makes the numbers of a result doubtful."""
    scene = result.scene
    lines = doubts(result.scene)
    lines += contact_warnings(scene, result.stages)
    lines += [
        f"The slide may jam in {name}: with the force of the work beside the middle its "
        f"friction = {friction:g} is above {numbers.readable(limit)}, from which two "
        "opposite corners hold it (self-locking)."
        for name, (friction, limit) in self_locking(scene).items()
    ]
    stages = [stage for stage in result.stages if not stage.failed]
    for stage in stages:
        settling = stage.statistics.settling
        # The status of the run names stages of which some replicates have settled.
        if settling and needs_warning(settling) and settling.verdict != "mixed":
            lines.append(
                f"{stage.name.capitalize()}: {sentence_of(settling)}. {SETTLE_ADVICE}."
            )
            if (settling.starts[0] or 0) > STARTUP_CYCLES:
                lines[-1] += (
                    " Figures over time show the first run before it came to rest."
                )
    for stage in stages:
        lines += [
            f"{stage.name.capitalize()}: the reverse force of {name} after the fracture is "
            f"{numbers.readable(100.0 * load.reverse_fraction.mean, 2)} % of its greatest force; "
            f"press makers allow {100.0 * ALLOWED_REVERSE:.0f} %."
            for name, load in frame_loads(scene, stage).items()
            if load.is_excessive and load.reverse_fraction is not None
        ]
        lines += _motor_warnings(scene, stage)
        lines += _guide_warnings(scene, stage)
        created_fraction = stage.statistics.energy_made_fraction
        if created_fraction > _MADE:
            part = numbers.readable(100.0 * created_fraction, 2)
            laws = [scene.bearing(name).normal_law for name in scene.loose_pins]
            is_radial = scene.conventions.contact == "radial"
            can_change = is_radial and not any(
                isinstance(law, UserFunction) for law in laws
            )
            lines.append(
                f"{stage.name.capitalize()}: contact forces create {part} % of the energy that the "
                "joints dissipate. Forces and wear may be wrong by as much."
                + (_FOUNDATION if can_change else "")
            )
    errors = [stage.statistics.peak_force_step_error or 0.0 for stage in stages]
    if (error := max(errors, default=0.0)) > _STEP_ERROR:
        part = numbers.readable(100.0 * error, 2)
        name = scene.solver.tolerance_name
        advice = f"a smaller {name}" if name else "more steps_per_contact"
        lines.append(f"Finer time steps change peak forces by {part} %: use {advice}.")
    joints = [joint for stage in stages for joint in stage.statistics.joints.values()]
    strokes = min((one.peak_force_per_cycle.samples for one in joints), default=ENOUGH)
    if strokes < ENOUGH:
        cycles = STARTUP_CYCLES + math.ceil(ENOUGH / scene.replicate_count)
        lines.append(
            f"Few strokes: peak forces are means of {strokes} strokes, and uncertain. "
            f"Run at least {ENOUGH}: cycles = {cycles} or more."
        )
    for stage in stages[-1:]:
        by_limit = _bearing_loads(scene, stage)
        is_limited = any(scene.bearing(name).pv_limit for name in stage.joints)
        if is_limited and "pv_limit" not in by_limit:
            lines.append(
                "pv_limit is not compared: it needs slip = sliding, as in refined, and no film."
            )
        for key, loads in by_limit.items():
            unit = _LOADS[key][1]
            for name, load in loads.items():
                limit = getattr(scene.bearing(name), key)
                if limit is None and key == "pressure_limit":
                    lines += unusual(
                        "pin pressure", load.mean, f"the pin pressure of joint {name}"
                    )
                elif limit and (highest := load.high or load.mean) > limit:
                    is_certain = load.mean > limit
                    value = numbers.quantity_text(
                        load.mean if is_certain else highest, unit
                    )
                    fault = "exceeds" if is_certain else "is possible and exceeds"
                    text = f"{fault} {key} = {numbers.quantity_text(limit, unit)}"
                    lines.append(f"Joint {name}: {value} {text}.")
    return lines
