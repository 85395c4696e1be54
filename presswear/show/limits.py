"""Limits of the last stage: the numbers that have one, beside it, with a verdict in a word."""

from presswear.recording.statistics.estimate import Estimate, key_of_greatest
from presswear.results.frame_load import ALLOWED_REVERSE, frame_loads
from presswear.results.guide_tilt import ALLOWED_TILT, GuideTilt, guide_tilts
from presswear.results.motor_load import ALLOWED_DROP, leader_speed, motor_loads
from presswear.results.stage import StageResult
from presswear.scene.scene import Scene
from presswear.show.joint_numbers import LOADS, bearing_loads, explained
from presswear.show.key_number import measured
from presswear.show.page import LimitLine, Verdict
from presswear.show.words import number_in_words_of
from presswear.tools import numbers

_NEAR = 0.9  # part of a limit above which a number is near it


WITHIN = Verdict("within the limit", "●", "good")
NEAR = Verdict("near the limit", "▲", "half")
ABOVE = Verdict("above the limit", "■", "bad")
NO_LIMIT = Verdict("no limit is set", "○", "open")


def limit_lines(scene: Scene, stage: StageResult) -> list[LimitLine]:
    """Return the numbers of a stage that a user or makers of presses limit."""
    lines = [
        *_bearing_lines(scene, stage),
        *_tilt_lines(scene, stage),
        *_motor_lines(scene, stage),
        *_frame_lines(scene, stage),
    ]
    return [
        line._replace(number=number_in_words_of(scene, line.number)) for line in lines
    ]


def verdict_on(value: Estimate, limit: float) -> Verdict:
    """Return the verdict on a number: near a limit are also those that may be above it."""
    if value.mean > limit:
        return ABOVE
    highest = value.mean if value.high is None else value.high
    return NEAR if max(highest, value.mean / _NEAR) > limit else WITHIN


def _bearing_lines(scene: Scene, stage: StageResult) -> list[LimitLine]:
    """Return pin pressure and p v at the pins where they are closest to their limits.

    Without limits they are those of the pins where they are greatest.
    """
    lines = []
    settling = stage.statistics.settling
    for key, loads in bearing_loads(scene, stage).items():
        limits = {name: getattr(scene.bearing(name), key) for name in loads}
        ratios = {
            name: loads[name].scaled(1.0 / limit)
            for name, limit in limits.items()
            if limit
        }
        at = key_of_greatest(ratios or loads)
        bearing = scene.bearing(at)
        title, unit, words = LOADS[key]
        size = f"{_mm(2.0 * bearing.bearing_radius)} × {_mm(bearing.width)} mm"
        if key == "pressure_limit" and settling and settling.is_mixture:
            words += ", of the motion with the largest force,"
        number = measured(title, loads[at], unit, f"{words} at joint {at} ({size}).")
        number = explained(number, stage)
        if limits[at]:
            limit = numbers.quantity_text(limits[at], unit)
            lines.append(LimitLine(number, limit, verdict_on(ratios[at], 1.0)))
        else:
            lines.append(LimitLine(number, f"set {key}", NO_LIMIT))
    return lines


def _tilt_lines(scene: Scene, stage: StageResult) -> list[LimitLine]:
    """Return the tilt of the slide in each guide of the frame with clearance, under load."""
    tilts = guide_tilts(scene, stage) if scene.process is not None else {}
    on_frame = [guide.name for guide in scene.loose_guides if not guide.is_moving]
    limit = f"{1e6 * ALLOWED_TILT:.0f} µm/m"
    lines = []
    for name in on_frame if tilts else ():
        at_work = tilts[name].at_work
        if at_work:  # empty without a series
            at = key_of_greatest(at_work)
            text = _tilt_text(name, tilts[name], at)
            number = measured(
                "Tilt of the slide", at_work[at].scaled(1e6), "µm/m", text
            )
            verdict = verdict_on(at_work[at], ALLOWED_TILT)
            lines.append(LimitLine(number, limit, verdict))
    return lines


def _tilt_text(guide: str, tilt: GuideTilt, at: str) -> str:
    """Return the meaning of the largest tilt at the work, and the tilts at other times."""
    text = (
        f"In {guide}, largest at {at}; makers of presses ask for the limit under load."
    )
    rest = []
    for words, value in tilt.at_work.items():
        if words != at:
            rest.append(f"at {words} {microns_per_metre(value)}")
    if tilt.greatest is not None:
        rest.append(f"greatest in a stroke {microns_per_metre(tilt.greatest)}")
    text += f" Also {', '.join(rest)} µm/m." if rest else ""
    if tilt.corner_force is not None:
        force = numbers.quantity_text(tilt.corner_force.mean, "N")
        text += f" Greatest force of a corner: {force}."
    return text


def _motor_lines(scene: Scene, stage: StageResult) -> list[LimitLine]:
    """Return the drop of the speed by the work, and the rms torque of each motor."""
    lines = []
    speed = leader_speed(scene, stage)
    if speed is not None and speed.drop is not None:
        text = "From the touch of the work until its force has vanished; press makers allow the "
        text += "limit. A larger flywheel reduces the drop."
        lines.append(_percent("Drop of the speed", speed.drop, ALLOWED_DROP, text))
    for body, load in motor_loads(scene, stage).items():
        text = f"Over the rated torque, of the motor of {body}; above it the motor overheats."
        lines.append(_percent("Rms torque of the motor", load.rms_fraction, 1.0, text))
    return lines


def _frame_lines(scene: Scene, stage: StageResult) -> list[LimitLine]:
    """Return the reverse force of each elastic frame after the fracture."""
    lines = []
    for name, load in frame_loads(scene, stage).items():
        reverse = load.reverse_fraction
        if reverse is not None:
            text = f"Of {name} after the fracture, over its greatest force; press makers allow "
            text += "the limit."
            title = "Reverse force of the frame"
            lines.append(_percent(title, reverse, ALLOWED_REVERSE, text))
    return lines


def _percent(name: str, share: Estimate, limit: float, meaning: str) -> LimitLine:
    """Return the line of a share, 0 to 1, that is shown in per cent."""
    number = measured(name, share.scaled(100.0), "%", meaning)
    return LimitLine(number, f"{100.0 * limit:.0f} %", verdict_on(share, limit))


def microns_per_metre(tilt: Estimate) -> str:
    """Return the mean of a tilt, rad, in um/m as a text."""
    return numbers.readable(1e6 * tilt.mean, 2)


def _mm(length: float) -> str:
    return numbers.short_number(1e3 * length)
