"""Tables of the report of a result: rows as data, and the records that they are read from."""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import fields
from itertools import permutations
from typing import Any

import numpy as np

from presswear.analysis.contact_modes import MODES, Timeline, combine
from presswear.physics.bottom import bottom_of
from presswear.physics.statics import heights_at_bottom, pull_of
from presswear.recording.soundness import RESIDUAL
from presswear.recording.statistics import STARTUP_CYCLES
from presswear.results.folder import SCHEMA
from presswear.results.life import LifeResult, LimitResult, digits_of, span_of, words_of
from presswear.results.press_analysis import (
    ENERGY_BOUND,
    PHASES,
    SNAP_THROUGH,
    SNAP_THROUGH_S,
    WORK,
    DriveDuty,
    drives_of,
    energy_of,
    has_motion,
    height_of,
    ideal_drives,
    period_of,
    process_force,
    resonance,
    rise,
    settled_span,
    spectra_of,
    strokes_of,
    timeline_of,
    tonnage_of,
)
from presswear.results.result import Result
from presswear.results.stage import SIDES, StageResult, WearStep
from presswear.scene.bearing import CONVENTIONS, Conventions
from presswear.scene.catalog import changes_of
from presswear.scene.scene import Scene
from presswear.scene.settings import Setting, settings_of
from presswear.show.figures.life import limit_text
from presswear.show.figures.style import maps_turn, stage_names
from presswear.show.page import NOTHING, Row, Table, column_table, row_table
from presswear.tools.arrays import Array
from presswear.tools.errors import RunFailed
from presswear.tools.numbers import (
    given,
    large,
    readable,
    unit_scale,
    with_interval,
)
from presswear.tools.quantities import Choice

Record = dict[str, Any]

_HARMONICS = (1, 2, 3)  # orders of the crank whose amplitudes are listed
_MIN_LINES = 8  # spectral lines per order; with fewer, noise too has most power at whole orders
_SNAP_THROUGH = f"{given(1e3 * SNAP_THROUGH_S)} ms"

SLIDER_ROWS = (
    Row("highest displacement", "statistics.output.displacement_max", "mm", digits=4),
    Row("lowest velocity", "statistics.output.velocity_min", "m/s"),
    Row("highest velocity", "statistics.output.velocity_max", "m/s"),
    Row("largest acceleration", "statistics.output.acceleration_max", "m/s²"),
    Row("cycles", "statistics.cycles"),
    Row(
        "energy created by the contact forces, relative to the energy dissipated in the joints",
        "statistics.energy_made_fraction",
        "%",
        digits=2,
    ),
)
FORCE_ROWS = (Row("largest normal force", "statistics.joints.{joint}.peak_force", "N"),)
DEPTH_ROWS = (
    Row("deepest wear at the start, {part}", "wear.{joint}.depth.{side}.depth", "µm"),
    Row("its angle, {part}", "wear.{joint}.depth.{side}.angle", "degrees", digits=4),
    Row("next wear update: deepest, {part}", "wear.{joint}.wear.{side}.depth", "µm"),
    Row("its angle in the update, {part}", "wear.{joint}.wear.{side}.angle", "degrees", digits=4),
)
CONTACT_ROWS = (
    Row("next wear update: volume", "statistics.joints.{joint}.wear_volume.mean", "mm³"),
    Row("time in contact", "statistics.joints.{joint}.contact_time_fraction", "%"),
    Row("contacts", "statistics.joints.{joint}.contacts"),
    Row("fewest steps in a contact", "statistics.joints.{joint}.min_steps_per_contact"),
)
SLIDER_MEANS = (
    Row("highest displacement", "statistics.output.displacement_max_per_cycle", "mm"),
    Row("highest velocity", "statistics.output.velocity_max_per_cycle", "m/s"),
    Row("largest acceleration", "statistics.output.acceleration_max_per_cycle", "m/s²"),
    Row("energy created by the contact forces", "statistics.energy_made_per_cycle", "mJ"),
    Row("cycles in the means", "statistics.output.displacement_max_per_cycle.samples"),
)
JOINT_MEANS = (
    Row("largest normal force", "statistics.joints.{joint}.peak_force_per_cycle", "N"),
    Row("contacts", "statistics.joints.{joint}.contacts_per_cycle"),
    Row(
        "normal force times sliding distance",
        "statistics.joints.{joint}.load_distance_per_cycle",
        "N m",
    ),
    Row("volume of the next wear update", "statistics.joints.{joint}.wear_volume", "mm³"),
)
DEPTH_MEANS = (
    Row(
        "deepest wear of the next update, {part}",
        "statistics.joints.{joint}.wear_peaks.{side}.depth",
        "µm",
    ),
)
BOTTOM_ROWS = (
    Row("standard deviation of the height", "statistics.bdc.standard_deviation", "µm"),
    Row("range of all strokes", "statistics.bdc.range_of_all", "µm"),
    Row("delay", "statistics.bdc.delay", "ms", "time behind the ideal motion"),
    Row("delay as {phase}", "statistics.bdc.delay_angle", "degrees"),
    Row("standard deviation of the delay", "statistics.bdc.delay_standard_deviation", "ms"),
    Row(
        "dwell of the ideal motion",
        "dwell",
        "ms",
        "the ideal motion rests at bottom dead centre, so that no delay is defined",
    ),
    Row("settled strokes", "statistics.bdc.strokes"),
)
TONNAGE_ROWS = (
    Row("greatest force along the working direction", "tonnage.joints.{joint}.working_force", "N"),
    Row(
        f"greatest force against it within {_SNAP_THROUGH} of the fracture",
        "tonnage.joints.{joint}.reversed_force",
        "N",
    ),
    Row("reversed force over working force", "tonnage.joints.{joint}.reversed_fraction", "%"),
    Row("fracture to the first reversed force", "tonnage.joints.{joint}.reversal_time", "ms"),
)
VIBRATION_ROWS = (
    Row(f"{_SNAP_THROUGH} before the contact", "tonnage.vibration.before", "m/s²"),
    Row(f"{_SNAP_THROUGH} after the fracture", "tonnage.vibration.after", "m/s²"),
)
STROKE_ROWS = (
    Row("settled strokes", "tonnage.strokes"),
    Row("most loaded joint", "tonnage.most_loaded"),
)
DRIVE_ROWS = (
    Row("torque, mean", "duty.{body}.torque.mean", "N m"),
    Row("power, mean", "duty.{body}.power.mean", "W"),
    Row("power, rms", "duty.{body}.power.rms", "W"),
    Row("power, largest", "duty.{body}.power.peak", "W"),
    Row("share of the rms torque", "duty.{body}.share.rms_torque", "%"),
    Row("share of the peak power", "duty.{body}.share.peak_power", "%"),
    Row("share of the energy supplied", "duty.{body}.share.energy", "%"),
)
ENERGY_ROWS = (
    Row("net work of all drives", "work", "J", digits=4),
    Row(
        "energy residual, relative to the energy exchanged",
        "residual",
        "",
        f"below {given(ENERGY_BOUND)} at the tolerances of a trajectory, about "
        f"{given(10.0 * ENERGY_BOUND)} at those of a wear run; a run above {given(RESIDUAL)} fails",
        digits=2,
    ),
)
ENDING_COLUMNS = (
    Row("stage", "name"),
    Row("end", "ending"),
    Row("cycles", "statistics.cycles"),
    Row("error of the wear", "statistics.wear_error", "%", digits=2),
    Row("change with finer steps", "statistics.load_distance_step_error", "%", digits=2),
    Row("depth multiplied by", "multiplier"),
    Row("simulated", "stage.simulated_s", "s"),
    Row("computing time", "stage.wall_s", "s"),
)
GROWTH_ROWS = (
    Row("steps", "steps"),
    Row("cycles represented", "represented"),
    Row("cycles simulated", "cycles"),
    Row("depth multiplied by", "multiplier"),
    Row("largest change in a step, relative to the clearance", "change", "%"),
    Row("computing time", "wall", "s"),
)
GROWTH_JOINT_ROWS = (
    Row("deepest wear of the bearing afterwards", "last.max_depth.{joint}.bearing", "µm"),
    Row("deepest wear of the pin afterwards", "last.max_depth.{joint}.pin", "µm"),
    Row("largest normal force in its runs", "force.{joint}", "N"),
)
STROKE_OVERVIEW = (
    Row("strokes represented by the wear", "represented", "", "production strokes until the stage"),
    Row("strokes simulated", "statistics.cycles", "", "cycles of all replicates together"),
)
BOTTOM_OVERVIEW = (
    Row(
        "error of bottom dead centre",
        "statistics.bdc.error",
        "µm",
        "mean height of the lowest position in a stroke above that without clearance; negative "
        "means deeper",
    ),
    Row("change since the first stage", "rise", "µm", "shift of bottom dead centre by wear"),
    Row(
        "repeatability",
        "statistics.bdc.range",
        "µm",
        "range of bottom dead centre in successive strokes",
    ),
    Row("strokes per range", "range_strokes"),
)
WORK_OVERVIEW = (
    Row("force of the work", "tonnage.peak_force", "N", "greatest in a stroke, the tonnage"),
    Row("energy of the work", "tonnage.work", "J", "in a stroke, without clearance {ideal} J"),
)
JOINT_OVERVIEW = (
    Row(
        "largest joint force",
        "largest.statistics.peak_force",
        "N",
        "normal force in the settled strokes of all replicates; the first two strokes are left "
        "out if more ran",
    ),
    Row("joint with the largest force", "largest.joint"),
    Row("mean of the largest force in a stroke", "largest.statistics.peak_force_per_cycle", "N"),
    Row(
        "largest recorded force",
        "peak.force",
        "N",
        "motion and forces are recorded for the first strokes of the first replicate",
    ),
    Row("joint of the recorded force", "peak.joint"),
    Row("{phase} of the recorded force", "peak.angle", "degrees", digits=4),
    Row("height over bottom dead centre then", "peak.height", "mm"),
    Row("direction of motion then", "peak.direction"),
    Row("phase of the work then", "peak.phase"),
)
DRIVE_OVERVIEW = (
    Row(
        "{body}: largest torque",
        "drives.{body}.duty.torque.peak",
        "N m",
        "largest in magnitude; counterclockwise is positive",
    ),
    Row("{body}: largest torque, ideal joints", "drives.{body}.ideal.torque.peak", "N m"),
    Row("{body}: rms torque", "drives.{body}.duty.torque.rms", "N m"),
    Row("{body}: rms torque, ideal joints", "drives.{body}.ideal.torque.rms", "N m"),
    Row("{body}: energy supplied per cycle", "drives.{body}.duty.supplied", "J"),
    Row("{body}: energy supplied, ideal joints", "drives.{body}.ideal.supplied", "J"),
    Row("{body}: energy returned per cycle", "drives.{body}.duty.returned", "J"),
    Row("{body}: energy returned, ideal joints", "drives.{body}.ideal.returned", "J"),
)
PROVENANCE_ROWS = (
    Row("engine", "engine"),
    Row("source revision", "revision"),
    Row("packages", "packages"),
    Row("Python", "python"),
    Row("machine", "machine"),
    Row("started", "started"),
    Row("computing time", "wall", "s"),
    Row("schema of the result", "schema"),
)
LIMIT_COLUMNS = (
    Row("limit", "name"),
    Row("exceeded after (strokes)", "strokes"),
    Row("95 % interval", "interval"),
    Row("hours", "hours"),
    Row("value after {end} strokes", "last"),
)
CAUSE_COLUMNS = (
    Row("cause", "name"),
    Row("half width", "half", "%", digits=2),
    Row("interval by this cause alone (strokes)", "interval"),
)
PASS_COLUMNS = (
    Row("pass", "number"),
    Row("wear per cycle, relative to the clearance", "result.change", "%"),
    Row("cycles", "result.cycles"),
    Row("life (strokes)", "strokes"),
    Row("sampling error", "sampling", "%", digits=2),
)
PHASE_COLUMNS = (
    Row("phase", "name"),
    Row("strokes", "strokes"),
    Row("mm³ per million strokes", "rate"),
)


def stage_records(result: Result) -> list[Record]:
    """Return what the tables of a result read, one record per stage.

    Parameters
    ----------
    result : Result
        Its stored laws are not executed unless they are trusted.
    """
    scene, records = result.scene, []
    for name, stage in zip(stage_names(result, result.stages), result.stages, strict=True):
        bdc, joints = stage.statistics.bdc, stage.statistics.joints
        largest = max(joints, key=lambda joint: joints[joint].peak_force, default=None)
        records.append(
            {
                "name": name,
                "stage": stage,
                "statistics": stage.statistics,
                "dwell": None if bdc is None or bdc.delay else bdc.ideal_dwell,
                "rise": rise(stage, result.stages[0]) if stage is not result.stages[0] else None,
                "range_strokes": None if bdc is None or bdc.range is None else bdc.range_strokes,
                "rest": _heights_at_rest(result, stage),
                "wear": {joint: _wear_record(stage, joint) for joint in scene.clearance_joints},
                "tonnage": tonnage_of(scene, stage),
                "drives": None if scene.has_untrusted_loads else drives_of(scene, stage),
                "largest": largest and {"joint": largest, "statistics": joints[largest]},
                "peak": _recorded_peak(scene, stage),
                "represented": _represented_strokes(result, stage),
                "ending": _ending(stage),
                "multiplier": _multiplier(stage),
            }
        )
    return records


def _heights_at_rest(result: Result, stage: StageResult) -> Record | None:
    """Return total clearance and rise under a static force at bottom dead centre, m."""
    scene = result.scene
    is_trusted = all(law.is_trusted for law in scene.joint_laws.values())
    if stage.failed or not scene.clearance_joints or not is_trusted:
        return None
    linkage = scene.linkage(stage.surfaces)
    pull = pull_of(linkage)
    try:
        up, down, rest = map(float, heights_at_bottom(linkage, (pull, -pull, 0.0)))
    except RunFailed:
        return None
    return {"clearance": up - down, "rise": up - rest}


def _wear_record(stage: StageResult, joint: str) -> Record:
    """Return the deepest places of the wear maps at the start and of the next update."""
    statistics, arrays = stage.statistics.joints.get(joint), stage.joints[joint]
    record: Record = {"depth": {}, "wear": {}}
    for side, sides in {"bearing": SIDES[:1], "pin": SIDES[1:], "both": SIDES}.items():
        for kind in record:
            # The noise of few cycles may hide the deepest place of an update in steps.
            if kind == "wear" and (statistics is None or side not in statistics.wear_peaks):
                continue
            depth = np.sum([arrays.arrays[f"{kind}_{name}"] for name in sides], axis=0)
            angle = float(arrays.angle[int(depth.argmax())])
            is_worn = bool(np.any(depth > 0.0))
            record[kind][side] = {"depth": float(depth.max()), "angle": angle if is_worn else None}
    return record


def phase_degrees(scene: Scene, time: Array) -> Array:
    """Return the phase of the cycle at some times, degrees from 0 to 360."""
    return np.asarray(360.0 * ((time - 0.5 * scene.run_up) / scene.mechanism.period) % 360.0)


def _recorded_peak(scene: Scene, stage: StageResult) -> Record | None:
    """Return the largest recorded joint force, with joint, phase angle and position."""
    time, period = stage.time, scene.mechanism.period
    if time.size < 2 or not stage.has_joint_series:
        return None
    # The same cycles as in the statistics.
    cycles = int((float(time[-1]) - scene.run_up) / period + 1e-3)
    begin = scene.run_up + period * max(min(STARTUP_CYCLES, cycles - 1), 0)
    rows = np.flatnonzero(time >= begin - 1e-9 * period)
    forces = {name: joint.force[rows, 0] for name, joint in stage.joints.items()}
    joint = max(forces, key=lambda name: float(forces[name].max(initial=0.0)))
    if not np.any(forces[joint] > 0.0):
        return None
    row = int(rows[forces[joint].argmax()])
    angle = math.radians(float(phase_degrees(scene, time[row : row + 1])[0]))
    record: Record = {"joint": joint, "force": float(forces[joint].max()), "angle": angle}
    if bottom_of(scene.ideal) is not None:
        height = height_of(scene, stage)
        falls = height[min(row + 1, time.size - 1)] < height[max(row - 1, 0)]
        record["height"], record["direction"] = float(height[row]), "down" if falls else "up"
        record["phase"] = _work_phase(scene, stage, row)
    return record


def _work_phase(scene: Scene, stage: StageResult, row: int) -> str | None:
    """Return the phase of the work at a row of the series; None outside of it."""
    strokes, force, now = strokes_of(scene, stage), process_force(scene, stage), stage.time[row]
    if strokes is None or force is None:
        return None
    for contact, fracture in zip(strokes.contact[:, 0], strokes.fracture[:, 0], strict=True):
        is_pressed = force[row] > 0.0 if np.isnan(fracture) else now < fracture
        if contact <= now and is_pressed:
            return PHASES[WORK]
        if fracture <= now < fracture + SNAP_THROUGH_S:
            return PHASES[SNAP_THROUGH]
    return None


def _represented_strokes(result: Result, stage: StageResult) -> int | None:
    if not any(other.index > 0 for other in result.stages):
        return None
    earlier = [step for one in result.stages[: stage.index] for step in one.wear_steps]
    return round(sum(step.cycles_per_update for step in earlier))


def _ending(stage: StageResult) -> str:
    return {
        "completed": "all cycles completed",
        "enough": "stopped when the wear maps reached the tolerance",
        "failed": f"failed: {stage.message}",
    }.get(stage.status, stage.status)


def _multiplier(stage: StageResult) -> str | None:
    if not stage.joints:
        return None
    if len(stage.wear_steps) > 1:
        return f"{_factor_range(stage.wear_steps)}, in {len(stage.wear_steps)} steps"
    return readable(stage.amplification)


def _factor_range(steps: Sequence[WearStep]) -> str:
    ends = [readable(pick(step.factor for step in steps)) for pick in (min, max)]
    return " to ".join(dict.fromkeys(ends))


def _each_joint(result: Result, rows: Iterable[Row]) -> dict[str, list[Row]]:
    rows = list(rows)
    return {
        f"Joint {joint}": [row.of(joint=joint) for row in rows]
        for joint in result.scene.clearance_joints
    }


def _each_side(result: Result, rows: Iterable[Row]) -> list[Row]:
    """Return rows for each side of the wear maps; both together where maps are fixed in space."""
    sides = {side: side for side in SIDES} if maps_turn(result) else {"both": "bearing + pin"}
    return [
        Row(
            row.label.replace("{part}", part),
            row.path.replace("{side}", side),
            row.unit,
            row.meaning,
            row.digits,
        )
        for side, part in sides.items()
        for row in rows
    ]


def _stage_table(
    corner: str, records: Sequence[Record], groups: Mapping[str, Sequence[Row]]
) -> Table | None:
    return column_table(corner, [record["name"] for record in records], records, groups)


def overview_table(result: Result, records: Sequence[Record]) -> Table | None:
    """Return the main numbers of the stages that did not fail."""
    scene = result.scene
    sound = [record for record in records if not record["stage"].failed]
    phase = scene.mechanism.linkage().phase
    pull = given(pull_of(scene.linkage()))
    clearance = Row(
        f"total clearance at the {scene.output}",
        "rest.clearance",
        "µm",
        f"difference of its heights at bottom dead centre, drives held, under {pull} N up and down",
        digits=4,
    )
    ideal = "" if scene.process is None else given(scene.process.work)
    work = [
        Row(row.label, row.path, row.unit, row.meaning.replace("{ideal}", ideal))
        for row in WORK_OVERVIEW
    ]
    bodies = [drive.body for drive in scene.mechanism.linkage().drives]
    groups = {
        "Strokes": STROKE_OVERVIEW,
        "Bottom dead centre": [*BOTTOM_OVERVIEW, clearance] if scene.clearance_joints else [],
        "Work": work if scene.process is not None else [],
        "Joints": [row.of(phase=phase) for row in JOINT_OVERVIEW],
        "Drives": [row.of(body=body) for body in bodies for row in DRIVE_OVERVIEW],
    }
    return _stage_table("", sound, groups) if sound else None


def key_table(result: Result, records: Sequence[Record]) -> Table | None:
    """Return peaks, wear and contact of every stage."""
    rows = [*FORCE_ROWS, *_each_side(result, DEPTH_ROWS), *CONTACT_ROWS]
    slider = {result.scene.output.capitalize(): SLIDER_ROWS}
    return _stage_table("", records, {**slider, **_each_joint(result, rows)})


def mean_table(result: Result, records: Sequence[Record]) -> Table | None:
    """Return means over cycles with their 95 % intervals."""
    rows = [*JOINT_MEANS, *_each_side(result, DEPTH_MEANS)]
    slider = {result.scene.output.capitalize(): SLIDER_MEANS}
    return _stage_table("mean over cycles", records, {**slider, **_each_joint(result, rows)})


def bottom_table(result: Result, records: Sequence[Record]) -> Table | None:
    """Return accuracy and repeatability at bottom dead centre, beside those of the overview."""
    pull = given(pull_of(result.scene.linkage()))
    phase = result.scene.mechanism.linkage().phase
    rest = Row(f"rise from rest under {pull} N, drives held", "rest.rise", "µm", digits=4)
    return _stage_table(
        "bottom dead centre", records, {"": [*(row.of(phase=phase) for row in BOTTOM_ROWS), rest]}
    )


def tonnage_table(result: Result, records: Sequence[Record]) -> Table | None:
    """Return joint forces by phase of the stroke, vibration and shock."""
    if not any(record["tonnage"] and record["tonnage"].joints for record in records):
        return None
    phases = [
        Row(
            f"greatest force of a stroke, {phase}",
            f"tonnage.joints.{{joint}}.peak_by_phase.{phase}",
            "N",
        )
        for phase in PHASES
    ]
    groups = {
        f"Acceleration of the {result.scene.output} minus the ideal one, rms": VIBRATION_ROWS,
        **_each_joint(result, [*phases, *TONNAGE_ROWS]),
        "Strokes": STROKE_ROWS,
    }
    return _stage_table("mean over strokes", records, groups)


def moment_table(result: Result, records: Sequence[Record]) -> Table | None:
    """Return phase angles and heights at which strokes touch, break and leave the work."""
    scene = result.scene
    names = {"contact": "Touches the work", "fracture": "Breaks it", "separation": "Leaves it"}
    begin = scene.run_up + STARTUP_CYCLES * scene.mechanism.period
    moments = []
    for record in records:
        strokes = None if record["stage"].failed else strokes_of(scene, record["stage"])
        moments.append({"name": record["name"]})
        for name in names if strokes else ():
            rows = getattr(strokes, name)
            rows = rows[~np.isnan(rows[:, 0])]
            settled = rows[rows[:, 0] >= begin]
            rows = settled if len(settled) else rows
            if len(rows):
                angle = phase_degrees(scene, rows[:, 0])
                # Relative to the first, because 359 and 1 degrees are close.
                angle = angle[0] + (angle - angle[0] + 180.0) % 360.0 - 180.0
                moments[-1][name] = [_range_text(angle, 2), _range_text(1e3 * rows[:, 1], 3)]
    phase = scene.mechanism.linkage().phase
    groups = {
        heading: [
            Row(f"{phase} (degrees)", f"{name}.0"),
            Row("height over bottom dead centre (mm)", f"{name}.1"),
        ]
        for name, heading in names.items()
    }
    return _stage_table("moments of a stroke", moments, groups)


def _range_text(values: Array, decimals: int) -> str:
    low, mean, high = (
        f"{value:.{decimals}f}".replace("-", "−")
        for value in (values.min(), values.mean(), values.max())
    )
    return mean if low == high else f"{mean} ({low} to {high})"


def drive_table(result: Result) -> Table | None:
    """Return torque, power and energy of each drive beside ideal joints.

    None if torques were not stored, or if ideal torques would execute untrusted stored laws.
    """
    scene = result.scene
    if scene.has_untrusted_loads:
        return None
    records = []
    for name, stage in zip(stage_names(result, result.stages), result.stages, strict=True):
        drives, energy = drives_of(scene, stage), energy_of(scene, stage)
        if drives:
            duty: dict[str, DriveDuty] = {body: drive.duty for body, drive in drives.items()}
            work = None if energy is None else energy.drive_work
            residual = None if energy is None else energy.residual_fraction
            records.append({"name": name, "duty": duty, "work": work, "residual": residual})
    if not records:
        return None
    ideal = ideal_drives(scene)
    work_of_all = sum(drive.work for drive in ideal.values())
    records.append({"name": "ideal joints", "duty": ideal, "work": work_of_all})
    groups = {f"Drive of {body}": [row.of(body=body) for row in DRIVE_ROWS] for body in ideal}
    return _stage_table("drives", records, {**groups, "Energy per cycle": ENERGY_ROWS})


def ending_table(records: Sequence[Record]) -> Table:
    """Return how each stage ended and how accurate its wear maps are."""
    return row_table(ENDING_COLUMNS, records, numeric=False)


def growth_table(result: Result) -> Table | None:
    """Return the steps in which each wear update was applied; None if all were single jumps."""
    if not result.grew_in_steps:
        return None
    records = []
    for stage in result.stages:
        if steps := stage.wear_steps:
            records.append(
                {
                    "name": result.stage_name(stage.index + 1),
                    "steps": len(steps),
                    "represented": sum(step.cycles_per_update for step in steps),
                    "cycles": sum(step.cycles for step in steps),
                    "multiplier": _factor_range(steps),
                    "change": max(step.clearance_change for step in steps),
                    "wall": sum(step.wall_s for step in steps),
                    "last": steps[-1],
                    "force": {
                        joint: max(step.peak_force[joint] for step in steps)
                        for joint in result.scene.clearance_joints
                    },
                }
            )
    groups = {"": GROWTH_ROWS, **_each_joint(result, GROWTH_JOINT_ROWS)}
    return _stage_table("wear update", records, groups)


def motion_table(result: Result) -> Table | None:
    """Return contact modes, periodicity and spectra by stage; None if no cycle was recorded."""
    scene, joints = result.scene, result.scene.clearance_joints
    names = stage_names(result, result.stages)
    records = [
        {"name": name, **_motion_record(result, stage)}
        for name, stage in zip(names, result.stages, strict=True)
        if has_motion(scene, stage)
    ]
    if not records:
        return None
    groups = {
        f"Joint {joint}": [Row(mode, f"modes.{joint}.{mode}") for mode in MODES] for joint in joints
    }
    for joint in joints:
        groups[f"Joint {joint}, changes of mode per cycle"] = [
            Row(f"{a} to {b}", f"changes.{joint}.{a} to {b}") for a, b in permutations(MODES, 2)
        ]
    if len(joints) > 1:
        together = dict.fromkeys(mode for record in records for mode in record["together"])
        groups[f"{' and '.join(joints)} at the same time"] = [
            Row(mode, f"together.{mode}") for mode in together
        ]
    groups["Repetition"] = [
        Row("period, tolerance relative to the clearance", "period"),
        Row("recorded cycles after the start-up", "cycles"),
    ]
    series = {"": f"acceleration of the {scene.output} (m/s²)"}
    series |= {joint: f"force at {joint} (N)" for joint in joints}
    orders = ", ".join(map(str, _HARMONICS))
    groups["Spectra"] = [
        *(Row(f"{label}, orders {orders}", f"harmonics.{k}") for k, label in series.items()),
        *(Row(f"{label}, power at whole orders", f"whole.{k}", "%") for k, label in series.items()),
        *(Row(f"contact resonance of {joint}", f"resonance.{joint}", "Hz") for joint in joints),
    ]
    return _stage_table("share of the time, visits per cycle, mean visit", records, groups)


def _motion_record(result: Result, stage: StageResult) -> Record:
    scene, joints = result.scene, result.scene.clearance_joints
    begin, end = settled_span(scene, stage)
    cycles = (end - begin) / scene.mechanism.period
    lines = {joint: timeline_of(scene, stage, joint) for joint in joints}
    together = combine(list(lines.values()))
    spectra = spectra_of(scene, stage)
    return {
        "cycles": cycles,
        "modes": {
            joint: {mode: _visits(line, mode, cycles) for mode in MODES}
            for joint, line in lines.items()
        },
        "together": {
            mode: _visits(together, mode, cycles)
            for mode, share in together.shares.items()
            if share
        },
        "changes": {
            joint: {
                f"{a} to {b}": count / cycles
                for a, counts in zip(MODES, line.transitions.tolist(), strict=True)
                for b, count in zip(MODES, counts, strict=True)
                if count
            }
            for joint, line in lines.items()
        },
        "period": str(period_of(scene, stage)),
        "harmonics": {
            name: ", ".join(readable(spectrum.amplitude(order)) for order in _HARMONICS)
            for name, spectrum in spectra.items()
        },
        "whole": {
            name: spectrum.harmonic_share if spectrum.lines >= _MIN_LINES else None
            for name, spectrum in spectra.items()
        },
        "resonance": {joint: resonance(stage, joint) for joint in joints},
    }


def _visits(line: Timeline, mode: str, cycles: float) -> str:
    """Return the share of the time in a mode, its visits per cycle and their mean duration."""
    text, visits = f"{100.0 * line.shares[mode]:.2f} %", line.visits(mode)
    if visits.size:
        text += f", {visits.size / cycles:.3g} of {1e3 * float(visits.mean()):.3g} ms"
    return text


def parameter_table(result: Result) -> Table:
    """Return every value that can be set, without the conventions."""
    columns = (
        *(Row(name, name) for name in ("key", "value", "unit", "origin")),
        Row("meaning", "setting.meaning.text"),
    )
    conventions = {item.name for item in fields(Conventions)}
    records = [
        _setting_record(setting)
        for setting in settings_of(result.scene)
        if setting.key not in conventions
    ]
    return row_table(columns, records, numeric=False)


def _setting_record(setting: Setting) -> Record:
    meaning, value = setting.meaning, setting.value
    text = "none" if value is None else str(value)
    record = {"setting": setting, "key": setting.key, "value": text, "unit": ""}
    if isinstance(meaning, Choice):
        one_of = "one of " if meaning.words else ""
        return record | {"origin": f"{one_of}{', '.join(meaning.allowed())}"}
    if isinstance(value, int | float):
        record["value"] = given(value)
    return record | {"unit": meaning.unit.replace("^2", "²"), "origin": meaning.origin}


def convention_set(conventions: Conventions) -> str:
    """Return the name of a set of conventions."""
    names = (name for name, preset in CONVENTIONS.items() if conventions == preset)
    return next((f"the “{name}” set" for name in names), "a set of its own")


def convention_table(result: Result) -> Table:
    """Return each convention, its choice, the alternatives and their meaning."""
    columns = (
        Row("convention", "setting.key"),
        Row("chosen", "setting.value"),
        Row("alternatives", "choices"),
        Row("meaning, in the same order", "setting.meaning.text"),
    )
    names = {item.name for item in fields(Conventions)}
    records = [
        {"setting": setting, "choices": " or ".join(setting.meaning.words)}
        for setting in settings_of(result.scene)
        if setting.key in names and isinstance(setting.meaning, Choice)
    ]
    return row_table(columns, records, numeric=False)


def change_table(result: Result) -> Table | None:
    """Return the settings that differ from the named scene or the defaults; None if none does."""
    changes = changes_of(result.scene)
    names = ("key", "value", "was", "unit", "meaning")
    return (
        row_table([Row(name, name) for name in names], changes, numeric=False) if changes else None
    )


def provenance_table(result: Result) -> Table | None:
    """Return versions, machine and time of a result."""
    packages = result.provenance["packages"]
    record = {
        **result.provenance,
        "engine": result.scene.engine,
        "packages": ", ".join(f"{name} {number}" for name, number in packages.items()),
        "wall": result.wall_s,
        "schema": SCHEMA,
    }
    return column_table("", [""], [record], {"": PROVENANCE_ROWS})


def diagnostics_table(records: Sequence[Record]) -> Table | None:
    """Return the diagnostics of the solver in each stage."""
    keys = dict.fromkeys(key for record in records for key in record["stage"].diagnostics)
    rows = [
        Row(
            key.removesuffix("_s").replace("_", " "),
            f"stage.diagnostics.{key}",
            "s" if key.endswith("_s") else "",
        )
        for key in keys
        if key != "model"
    ]
    return _stage_table("", records, {"": rows})


def limit_table(scene: Scene, life: LifeResult) -> Table:
    """Return when each limit is exceeded, and the value at the end."""
    end = large(float(life.curves["strokes"][-1]))
    records = []
    for limit in life.limits:
        scale, unit = unit_scale(limit.unit, limit.value)
        half = None if limit.last_half_width is None else scale * limit.last_half_width
        # A level curve has no drift and no meaningful half width.
        is_level = limit.last == 0.0 and not half
        record = {
            "name": f"{words_of(limit.key)} over {limit_text(limit)}",
            "strokes": "not exceeded",
            "last": "no trend" if is_level else f"{with_interval(scale * limit.last, half)} {unit}",
        }
        if limit.strokes is not None:
            error = limit_error(limit)
            hours = limit.strokes * scene.mechanism.period / 3600.0
            record["strokes"] = large(limit.strokes, digits=digits_of(error))
            record["interval"] = span_of(limit.strokes, error) or "unknown"
            record["hours"] = readable(hours, digits_of(error))
        records.append(record)
    return row_table([row.of(end=end) for row in LIMIT_COLUMNS], records)


def limit_error(limit: LimitResult) -> float | None:
    """Return the half width of the logarithm of the strokes to a limit; None if unknown."""
    if limit.sampling is None or limit.step is None:
        return None
    return math.hypot(limit.sampling, limit.step)


def cause_table(scene: Scene, life: LifeResult) -> Table:
    """Return the contributions to the interval of a life."""
    causes = {
        f"sampling: {scene.draws} replicates of a chaotic motion": life.sampling,
        "step of the wear update, from passes with coarser steps": life.step,
        "scatter of the wear coefficients": life.scatter,
        "all together": life.total_error,
    }
    records = [
        {
            "name": name,
            "half": None if error is None else math.expm1(error),
            "interval": span_of(life.strokes, error) or NOTHING,
        }
        for name, error in causes.items()
    ]
    return row_table(CAUSE_COLUMNS, records)


def pass_table(life: LifeResult) -> Table:
    """Return the passes over a life, each with finer steps than the one before."""
    records = [
        {
            "number": str(number),
            "result": item,
            "strokes": None if item.strokes is None else large(item.strokes),
            "sampling": None if item.sampling is None else math.expm1(item.sampling),
        }
        for number, item in enumerate(life.passes, start=1)
    ]
    return row_table(PASS_COLUMNS, records)


def phase_table(life: LifeResult) -> Table:
    """Return the phases of the wear of each joint with their rates."""
    records = [
        {
            "name": f"{phase.joint}: {phase.name}",
            "strokes": large(phase.since, phase.until),
            "rate": with_interval(1e15 * phase.rate, 1e15 * phase.half_width),
        }
        for phase in life.phases
    ]
    return row_table(PHASE_COLUMNS, records)
