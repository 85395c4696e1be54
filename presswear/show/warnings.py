"""Warnings of a result: sentences on what makes its numbers doubtful."""

from presswear.recording.statistics import STARTUP_CYCLES
from presswear.results.guide_tilt import self_locking
from presswear.results.motions import SETTLE_ADVICE, needs_warning, sentence_of
from presswear.results.motor_load import saturated_servos
from presswear.results.result import Result
from presswear.results.run_warnings import run_warnings
from presswear.results.stage import StageResult
from presswear.scene.plausible import doubts, unusual_joints
from presswear.scene.scene import Scene
from presswear.show.joint_numbers import bearing_loads
from presswear.show.key_number import ENOUGH, enough_cycles, fewest_strokes
from presswear.show.words import in_words_of
from presswear.tools import numbers
from presswear.tools.quantities import written
from presswear.tools.user_function import UserFunction

# Energy created by contacts over the energy that they dissipate
MAX_CREATED_ENERGY = 0.02
FOUNDATION_ADVICE = (
    ' Use --set contact=foundation, or contact = "foundation" in [settings].'
)
MAX_STEP_ERROR = 0.1  # change of peak forces with finer time steps, relative


def warnings(result: Result) -> list[str]:
    """Return sentences on what makes the numbers of a result doubtful."""
    scene = result.scene
    stages = [stage for stage in result.stages if not stage.failed]
    lines = doubts(scene)
    lines += run_warnings(scene, result.stages)
    lines += [
        f"The slide may jam in {name}: with the force of the work beside the middle its "
        f"friction = {friction:g} is above {numbers.readable(limit)}, from which two "
        "opposite corners hold it (self-locking)."
        for name, (friction, limit) in self_locking(scene).items()
    ]
    for stage in stages:
        lines += _settling_warnings(stage)
    for stage in stages:
        lines += _servo_warnings(scene, stage)
        lines += _energy_warnings(scene, stage)
    lines += _sampling_warnings(scene, stages)
    for stage in stages[-1:]:
        lines += _load_warnings(scene, stage)
    return [in_words_of(scene, line) for line in lines]


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


def _energy_warnings(scene: Scene, stage: StageResult) -> list[str]:
    """Return a sentence on a stage whose contact forces create energy."""
    created_fraction = stage.statistics.energy_made_fraction
    if created_fraction <= MAX_CREATED_ENERGY:
        return []
    percent = numbers.readable(100.0 * created_fraction, 2)
    laws = [scene.bearing(name).normal_law for name in scene.loose_pins]
    has_user_law = any(isinstance(law, UserFunction) for law in laws)
    is_radial = scene.conventions.contact == "radial"
    return [
        f"{stage.name.capitalize()}: contact forces create {percent} % of the energy that the "
        "joints dissipate. Forces and wear may be wrong by as much."
        + (FOUNDATION_ADVICE if is_radial and not has_user_law else "")
    ]


def _sampling_warnings(scene: Scene, stages: list[StageResult]) -> list[str]:
    """Return sentences on peak forces that time steps or too few strokes make uncertain."""
    lines = []
    errors = [stage.statistics.peak_force_step_error or 0.0 for stage in stages]
    if (error := max(errors, default=0.0)) > MAX_STEP_ERROR:
        percent = numbers.readable(100.0 * error, 2)
        name = scene.solver.tolerance_name
        advice = f"a smaller {name}" if name else "more steps_per_contact"
        line = f"Finer time steps change peak forces by {percent} %: use {advice}."
        lines.append(line)
    strokes = fewest_strokes(stages)
    if strokes < ENOUGH:
        counted = numbers.counted(strokes, "stroke")
        line = f"Few strokes: peak forces are means of {counted}, and uncertain."
        settlings = [stage.statistics.settling for stage in stages]
        if any(settling and settling.verdict == "unwatched" for settling in settlings):
            line += " They are too few to see whether the motion settles."
        lines.append(f"{line} Run more: cycles = {enough_cycles(scene)} or more.")
    return lines


def _load_warnings(scene: Scene, stage: StageResult) -> list[str]:
    """Return sentences on pin pressures of unusual size, and on a p v that is not computed."""
    lines = []
    loads = bearing_loads(scene, stage)
    has_limit = any(scene.bearing(name).pv_limit for name in stage.joints)
    if has_limit and "pv_limit" not in loads:
        lines.append(
            "pv_limit is not compared: it needs slip = sliding, as in refined, and no film."
        )
    pressures = {}
    for name, load in loads.get("pressure_limit", {}).items():
        if scene.bearing(name).pressure_limit is None:
            pressures[name] = load.mean
    words = "the pin pressure of {joints}"
    return lines + unusual_joints("pin pressure", pressures, words)


def _servo_warnings(scene: Scene, stage: StageResult) -> list[str]:
    """Return a sentence on each servo that reaches the limit of its torque."""
    return [
        f"{stage.name.capitalize()}: the servo of {body} reaches its torque_limit of "
        f"{written(limit, 'N m')} and falls behind its motion."
        for body, limit in saturated_servos(scene, stage).items()
    ]
