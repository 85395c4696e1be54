"""Warnings of a result: sentences on what makes its numbers doubtful."""

import math

from presswear.recording.statistics import STARTUP_CYCLES
from presswear.results.contact_warnings import contact_warnings
from presswear.results.frame_load import ALLOWED_REVERSE, frame_loads
from presswear.results.guide_tilt import ALLOWED_TILT, guide_tilts, self_locking
from presswear.results.motions import SETTLE_ADVICE, needs_warning, sentence_of
from presswear.results.motor_load import (
    ALLOWED_DROP,
    leader_speed,
    motor_loads,
    saturated_servos,
)
from presswear.results.result import Result
from presswear.results.stage import StageResult
from presswear.scene.plausible import doubts, unusual
from presswear.scene.scene import Scene
from presswear.show.joint_numbers import LOADS, bearing_loads
from presswear.show.key_number import ENOUGH
from presswear.show.stroke_numbers import ALLOWED_TILT_TEXT, microns_per_metre
from presswear.tools import numbers
from presswear.tools.quantities import written
from presswear.tools.user_function import UserFunction

MAX_CREATED_ENERGY = 0.02  # by contacts, relative to the energy that they dissipate
FOUNDATION_ADVICE = (
    ' Use --set contact=foundation, or contact = "foundation" in [settings].'
)
MAX_STEP_ERROR = 0.1  # change of peak forces with finer time steps, relative


def warnings(result: Result) -> list[str]:
    """Return sentences on what makes the numbers of a result doubtful."""
    scene = result.scene
    stages = [stage for stage in result.stages if not stage.failed]
    lines = doubts(scene)
    lines += contact_warnings(scene, result.stages)
    lines += [
        f"The slide may jam in {name}: with the force of the work beside the middle its "
        f"friction = {friction:g} is above {numbers.readable(limit)}, from which two "
        "opposite corners hold it (self-locking)."
        for name, (friction, limit) in self_locking(scene).items()
    ]
    for stage in stages:
        lines += _settling_warnings(stage)
    for stage in stages:
        lines += _frame_warnings(scene, stage)
        lines += _motor_warnings(scene, stage)
        lines += _guide_warnings(scene, stage)
        lines += _energy_warnings(scene, stage)
    lines += _sampling_warnings(scene, stages)
    for stage in stages[-1:]:
        lines += _limit_warnings(scene, stage)
    return lines


def _settling_warnings(stage: StageResult) -> list[str]:
    """Return a sentence on a stage whose replicates have not settled on one motion."""
    settling = stage.statistics.settling
    # The status of the run names stages of which some replicates have settled.
    if not settling or not needs_warning(settling) or settling.verdict == "mixed":
        return []
    text = f"{stage.name.capitalize()}: {sentence_of(settling)}. {SETTLE_ADVICE}."
    if (settling.starts[0] or 0) > STARTUP_CYCLES:
        text += " Figures over time show the first run before it came to rest."
    return [text]


def _frame_warnings(scene: Scene, stage: StageResult) -> list[str]:
    """Return sentences on frames with more reverse force than press makers allow."""
    return [
        f"{stage.name.capitalize()}: the reverse force of {name} after the fracture is "
        f"{numbers.readable(100.0 * load.reverse_fraction.mean, 2)} % of its greatest force; "
        f"press makers allow {100.0 * ALLOWED_REVERSE:.0f} %."
        for name, load in frame_loads(scene, stage).items()
        if load.is_excessive and load.reverse_fraction is not None
    ]


def _energy_warnings(scene: Scene, stage: StageResult) -> list[str]:
    """Return a sentence on a stage whose contact forces create energy."""
    created_fraction = stage.statistics.energy_made_fraction
    if created_fraction <= MAX_CREATED_ENERGY:
        return []
    part = numbers.readable(100.0 * created_fraction, 2)
    laws = [scene.bearing(name).normal_law for name in scene.loose_pins]
    has_user_law = any(isinstance(law, UserFunction) for law in laws)
    is_radial = scene.conventions.contact == "radial"
    return [
        f"{stage.name.capitalize()}: contact forces create {part} % of the energy that the "
        "joints dissipate. Forces and wear may be wrong by as much."
        + (FOUNDATION_ADVICE if is_radial and not has_user_law else "")
    ]


def _sampling_warnings(scene: Scene, stages: list[StageResult]) -> list[str]:
    """Return sentences on peak forces that time steps or too few strokes make uncertain."""
    lines = []
    errors = [stage.statistics.peak_force_step_error or 0.0 for stage in stages]
    if (error := max(errors, default=0.0)) > MAX_STEP_ERROR:
        part = numbers.readable(100.0 * error, 2)
        name = scene.solver.tolerance_name
        advice = f"a smaller {name}" if name else "more steps_per_contact"
        lines.append(f"Finer time steps change peak forces by {part} %: use {advice}.")
    joints = [joint for stage in stages for joint in stage.statistics.joints.values()]
    samples = [joint.peak_force_per_cycle.samples for joint in joints]
    strokes = min(samples, default=ENOUGH)
    if strokes < ENOUGH:
        cycles = STARTUP_CYCLES + math.ceil(ENOUGH / scene.replicate_count)
        lines.append(
            f"Few strokes: peak forces are means of {strokes} strokes, and uncertain. "
            f"Run at least {ENOUGH}: cycles = {cycles} or more."
        )
    return lines


def _limit_warnings(scene: Scene, stage: StageResult) -> list[str]:
    """Return sentences on pin pressure and p v above their limits, or of unusual size."""
    lines = []
    by_limit = bearing_loads(scene, stage)
    is_limited = any(scene.bearing(name).pv_limit for name in stage.joints)
    if is_limited and "pv_limit" not in by_limit:
        lines.append(
            "pv_limit is not compared: it needs slip = sliding, as in refined, and no film."
        )
    for key, loads in by_limit.items():
        unit = LOADS[key][1]
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


def _guide_warnings(scene: Scene, stage: StageResult) -> list[str]:
    """Return sentences on slides of presses that tilt more than press makers ask for."""
    lines: list[str] = []
    if scene.process is None:
        return lines
    for name, tilt in guide_tilts(scene, stage).items():
        if tilt.is_excessive:
            tilts = ", ".join(
                f"{microns_per_metre(one)} µm/m at {words}"
                for words, one in tilt.at_work.items()
                if one.mean > ALLOWED_TILT
            )
            lines.append(
                f"{stage.name.capitalize()}: the slide tilts in {name} by {tilts}; press "
                f"makers ask for {ALLOWED_TILT_TEXT}."
            )
    return lines


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
