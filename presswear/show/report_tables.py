"""Tables of the report of a result: rows as data, and the records that they are read from."""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import fields
from itertools import permutations
from typing import Any

import numpy as np

from presswear.analysis.contact_modes import MODES, Timeline, combine
from presswear.physics.ideal import bottom_of
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
    large,
    quantity_text,
    readable,
    short_number,
    unit_scale,
    whole,
    with_interval,
)
from presswear.tools.quantities import Choice

Record = dict[str, Any]

_HARMONICS = (1, 2, 3)  # orders of the crank whose amplitudes are listed
_MIN_LINES = 8  # spectral lines per order; with fewer, noise too has most power at whole orders
_SNAP_THROUGH = f"{short_number(1e3 * SNAP_THROUGH_S)} ms"
_CLEARANCE = "change of its height at bottom dead centre, drives held, under {pull} up and down"
_ENDINGS = {
    "completed": "all cycles completed",
    "enough": "stopped when the wear maps reached the tolerance",
}
_TORQUE = "largest in magnitude; counterclockwise is positive"

OUTPUT_ROWS = (
    Row("highest displacement", "output.displacement_max", "mm", digits=4),
    Row("lowest velocity", "output.velocity_min", "m/s"),
    Row("highest velocity", "output.velocity_max", "m/s"),
    Row("largest acceleration", "output.acceleration_max", "m/s²"),
    Row("cycles", "statistics.cycles"),
    Row(
        "energy created by contacts over energy dissipated", "statistics.energy_made_fraction", "%"
    ),
)
DEPTH_ROWS = (
    Row("deepest wear at the start, {part}", "wear.{joint}.depth.{side}.depth", "µm"),
    Row("its angle, {part}", "wear.{joint}.depth.{side}.angle", "degrees", digits=4),
    Row("next wear update: deepest, {part}", "wear.{joint}.wear.{side}.depth", "µm"),
    Row("its angle in the update, {part}", "wear.{joint}.wear.{side}.angle", "degrees", digits=4),
)
CONTACT_ROWS = (
    Row("largest normal force", "joints.{joint}.peak_force", "N"),
    Row("next wear update: volume", "joints.{joint}.wear_volume.mean", "mm³"),
    Row("time in contact", "joints.{joint}.contact_time_fraction", "%"),
    Row("contacts", "joints.{joint}.contacts"),
    Row("fewest steps in a contact", "joints.{joint}.min_steps_per_contact"),
)
OUTPUT_MEANS = (
    Row("highest displacement", "output.displacement_max_per_cycle", "mm"),
    Row("highest velocity", "output.velocity_max_per_cycle", "m/s"),
    Row("largest acceleration", "output.acceleration_max_per_cycle", "m/s²"),
    Row("energy created by the contact forces", "statistics.energy_made_per_cycle", "mJ"),
    Row("cycles in the means", "output.displacement_max_per_cycle.samples"),
)
JOINT_MEANS = (
    Row("largest normal force", "joints.{joint}.peak_force_per_cycle", "N"),
    Row("contacts", "joints.{joint}.contacts_per_cycle"),
    Row("normal force times sliding distance", "joints.{joint}.load_distance_per_cycle", "N m"),
    Row("volume of the next wear update", "joints.{joint}.wear_volume", "mm³"),
)
DEPTH_MEAN = Row("deepest of the update, {part}", "joints.{joint}.wear_peaks.{side}.depth", "µm")
BOTTOM_ROWS = (
    Row("standard deviation of the height", "bdc.standard_deviation", "µm"),
    Row("range of all strokes", "bdc.range_of_all", "µm"),
    Row("delay", "bdc.delay", "ms", "time behind the ideal motion"),
    Row("delay as {phase}", "bdc.delay_angle", "degrees"),
    Row("standard deviation of the delay", "bdc.delay_standard_deviation", "ms"),
    Row("dwell of the ideal motion", "dwell", "ms", "no delay is defined where the ideal rests"),
    Row("settled strokes", "bdc.strokes"),
    Row("rise from rest under {pull}, drives held", "rest.rise", "µm", digits=4),
)
TONNAGE_ROWS = (
    *(
        Row(f"greatest in a stroke, {p}", f"tonnage.joints.{{joint}}.peak_by_phase.{p}", "N")
        for p in PHASES
    ),
    Row("greatest along the working direction", "tonnage.joints.{joint}.working_force", "N"),
    Row(
        f"against it, {_SNAP_THROUGH} after fracture", "tonnage.joints.{joint}.reversed_force", "N"
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
_RESIDUALS = (
    f"below {short_number(ENERGY_BOUND)} at the tolerances of a trajectory, about "
    f"{short_number(10.0 * ENERGY_BOUND)} at those of a wear run; a run above "
    f"{short_number(RESIDUAL)} fails"
)
ENERGY_ROWS = (
    Row("net work of all drives", "work", "J", digits=4),
    Row("energy residual over energy exchanged", "residual", "", _RESIDUALS, digits=2),
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
    Row("error of bottom dead centre", "bdc.error", "µm", "mean height above the ideal one"),
    Row("change since the first stage", "rise", "µm", "shift of bottom dead centre by wear"),
    Row("repeatability", "bdc.range", "µm", "range of bottom dead centre in successive strokes"),
    Row("strokes per range", "range_strokes"),
    Row("total clearance at the {output}", "rest.clearance", "µm", _CLEARANCE, digits=4),
)
WORK_OVERVIEW = (
    Row("force of the work", "tonnage.peak_force", "N", "greatest in a stroke, the tonnage"),
    Row("energy of the work", "tonnage.work", "J", "in a stroke"),
    Row("energy of the work, ideal joints", "ideal_work", "J"),
)
JOINT_OVERVIEW = (
    Row("largest joint force", "largest.force", "N", "in the settled strokes of all replicates"),
    Row("joint with the largest force", "largest.joint"),
    Row("mean of the largest force in a stroke", "largest.mean", "N"),
    Row("largest recorded force", "peak.force", "N", "in the first strokes of one replicate"),
    Row("joint of the recorded force", "peak.joint"),
    Row("{phase} of the recorded force", "peak.angle", "degrees", digits=4),
    Row("height over bottom dead centre then", "peak.height", "mm"),
    Row("direction of motion then", "peak.direction"),
    Row("phase of the work then", "peak.phase"),
)
DRIVE_OVERVIEW = (
    Row("{body}: largest torque", "drives.{body}.duty.torque.peak", "N m", _TORQUE),
    Row("{body}: largest torque, ideal joints", "drives.{body}.ideal.torque.peak", "N m"),
    Row("{body}: rms torque", "drives.{body}.duty.torque.rms", "N m"),
    Row("{body}: rms torque, ideal joints", "drives.{body}.ideal.torque.rms", "N m"),
    Row("{body}: energy supplied per cycle", "drives.{body}.duty.supplied", "J"),
    Row("{body}: energy supplied, ideal joints", "drives.{body}.ideal.supplied", "J"),
    Row("{body}: energy returned per cycle", "drives.{body}.duty.returned", "J"),
    Row("{body}: energy returned, ideal joints", "drives.{body}.ideal.returned", "J"),
)


def stage_tables(result: Result) -> dict[str, Table | None]:
    """Return the tables with a column per stage, by name; None for a table without any value.

    Parameters
    ----------
    result : Result
        Its stored laws are not executed unless they are trusted.
    """
    scene, records = result.scene, stage_records(result)
    linkage = scene.mechanism.linkage()
    names = {
        "phase": linkage.phase,
        "pull": quantity_text(pull_of(scene.linkage()), "N"),
        "output": scene.output,
    }
    bodies = [drive.body for drive in linkage.drives]
    sound = [record for record in records if not record["stage"].failed]
    overview = {
        "Strokes": STROKE_OVERVIEW,
        "Bottom dead centre": _named(BOTTOM_OVERVIEW, **names) if scene.clearance_joints else (),
        "Work": WORK_OVERVIEW if scene.process is not None else (),
        "Joints": _named(JOINT_OVERVIEW, **names),
        "Drives": [row for body in bodies for row in _named(DRIVE_OVERVIEW, body=body)],
    }
    output, depths = scene.output.capitalize(), _each_side(result, DEPTH_ROWS)
    means = [*JOINT_MEANS, *_each_side(result, [DEPTH_MEAN])]
    tonnage = {
        f"Acceleration of the {scene.output} minus the ideal one, rms": VIBRATION_ROWS,
        **_each_joint(result, TONNAGE_ROWS),
        "Strokes": STROKE_ROWS,
    }
    key = {output: OUTPUT_ROWS, **_each_joint(result, [*CONTACT_ROWS, *depths])}
    mean = {output: OUTPUT_MEANS, **_each_joint(result, means)}
    return {
        "overview": _stage_table("", sound, overview),
        "key": _stage_table("", records, key),
        "means": _stage_table("mean over cycles", records, mean),
        "bottom": _stage_table("bottom dead centre", records, {"": _named(BOTTOM_ROWS, **names)}),
        "tonnage": _stage_table("mean over strokes", records, tonnage),
        "moments": _moment_table(result, sound),
        "endings": row_table(ENDING_COLUMNS, records, numeric=False),
        "diagnostics": _diagnostics_table(records),
    }


def stage_records(result: Result) -> list[Record]:
    """Return the values of the tables that are not attributes of the stages; one per stage."""
    scene, records = result.scene, []
    for name, stage in zip(stage_names(result, result.stages), result.stages, strict=True):
        bdc, joints = stage.statistics.bdc, stage.statistics.joints
        largest = max(joints, key=lambda joint: joints[joint].peak_force, default="")
        peaks = joints.get(largest)
        earlier = [step for one in result.stages[: stage.index] for step in one.wear_steps]
        has_wear = any(one.index > 0 for one in result.stages)
        records.append(
            {
                "name": name,
                "stage": stage,
                "statistics": stage.statistics,
                "output": stage.statistics.output,
                "joints": joints,
                "bdc": bdc,
                "dwell": None if bdc is None or bdc.delay else bdc.ideal_dwell,
                "rise": rise(stage, result.stages[0]) if stage is not result.stages[0] else None,
                "range_strokes": None if bdc is None or bdc.range is None else bdc.range_strokes,
                "rest": _heights_at_rest(result, stage),
                "wear": {joint: _wear_record(stage, joint) for joint in scene.clearance_joints},
                "tonnage": tonnage_of(scene, stage),
                "ideal_work": None if scene.process is None else scene.process.work,
                "drives": None if scene.has_untrusted_loads else drives_of(scene, stage),
                "largest": peaks
                and {
                    "joint": largest,
                    "force": peaks.peak_force,
                    "mean": peaks.peak_force_per_cycle,
                },
                "peak": _recorded_peak(scene, stage),
                "represented": round(sum(step.cycles_per_update for step in earlier))
                if has_wear
                else None,
                "ending": f"failed: {stage.message}"
                if stage.failed
                else _ENDINGS.get(stage.status, stage.status),
                "multiplier": _multiplier(stage) if stage.joints else None,
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
    start = scene.run_up + period * max(min(STARTUP_CYCLES, cycles - 1), 0)
    rows = np.flatnonzero(time >= start - 1e-9 * period)
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


def _multiplier(stage: StageResult) -> str:
    steps = stage.wear_steps
    if len(steps) > 1:
        return f"{_factor_range(steps)}, in {len(steps)} steps"
    return readable(stage.amplification)


def _factor_range(steps: Sequence[WearStep]) -> str:
    ends = [readable(pick(step.factor for step in steps)) for pick in (min, max)]
    return " to ".join(dict.fromkeys(ends))


def _named(rows: Iterable[Row], **names: str) -> list[Row]:
    return [row.of(**names) for row in rows]


def _each_joint(result: Result, rows: Iterable[Row]) -> dict[str, list[Row]]:
    rows = list(rows)
    joints = result.scene.clearance_joints
    return {f"Joint {joint}": _named(rows, joint=joint) for joint in joints}


def _each_side(result: Result, rows: Sequence[Row]) -> list[Row]:
    """Return rows for each side of the wear maps; both together where maps are fixed in space."""
    sides = {side: side for side in SIDES} if maps_turn(result) else {"both": "bearing + pin"}
    names = [{"side": side, "part": part, "joint": "{joint}"} for side, part in sides.items()]
    return [row.of(**each) for each in names for row in rows]


def _stage_table(
    corner: str, records: Sequence[Record], groups: Mapping[str, Sequence[Row]]
) -> Table | None:
    return column_table(corner, [record["name"] for record in records], records, groups)


def _moment_table(result: Result, records: Sequence[Record]) -> Table | None:
    """Return phase angles and heights at which strokes touch, break and leave the work."""
    scene = result.scene
    names = {"contact": "Touches the work", "fracture": "Breaks it", "separation": "Leaves it"}
    start = scene.run_up + STARTUP_CYCLES * scene.mechanism.period
    moments = []
    for record in records:
        strokes = strokes_of(scene, record["stage"])
        moments.append({"name": record["name"]})
        for name in names if strokes else ():
            rows = getattr(strokes, name)
            rows = rows[~np.isnan(rows[:, 0])]
            settled = rows[rows[:, 0] >= start]
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
    start, end = settled_span(scene, stage)
    cycles = (end - start) / scene.mechanism.period
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
        record["value"] = short_number(value)
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


def provenance_table(result: Result) -> Table:
    """Return versions, machine and time of a result."""
    packages = result.provenance["packages"]
    values = {
        "engine": result.scene.engine,
        "source revision": result.provenance["revision"],
        "packages": ", ".join(f"{name} {number}" for name, number in packages.items()),
        "Python": result.provenance["python"],
        "machine": result.provenance["machine"],
        "started": result.provenance["started"],
        "computing time (s)": readable(result.wall_s),
        "schema of the result": str(SCHEMA),
    }
    return Table(("", ""), (("", tuple(values.items())),), numeric=False)


def _diagnostics_table(records: Sequence[Record]) -> Table | None:
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


def life_tables(scene: Scene, life: LifeResult) -> dict[str, Table]:
    """Return the tables of a service life: limits, causes of its error, phases and passes."""
    causes = {
        f"sampling: {scene.replicate_count} replicates of a chaotic motion": life.sampling,
        "step of the wear update, from passes with coarser steps": life.step,
        "scatter of the wear coefficients": life.scatter,
        "all together": life.total_error,
    }
    end = large(float(life.curves["strokes"][-1]))
    lines: dict[tuple[str, ...], list[tuple[str, ...]]] = {
        ("limit", "exceeded after (strokes)", "95 % interval", "hours", f"after {end} strokes"): [
            _limit_line(scene, limit) for limit in life.limits
        ],
        ("cause", "half width (%)", "interval by this cause alone (strokes)"): [
            (name, _percent(error), span_of(life.strokes, error) or NOTHING)
            for name, error in causes.items()
        ],
        ("phase", "strokes", "mm³ per million strokes"): [
            (
                f"{phase.joint}: {phase.name}",
                large(phase.since, phase.until),
                with_interval(1e15 * phase.rate, 1e15 * phase.half_width),
            )
            for phase in life.phases
        ],
        ("pass", "wear per cycle (% of the clearance)", "cycles", "life (strokes)", "error (%)"): [
            (
                str(number),
                readable(100.0 * item.change),
                whole(item.cycles),
                NOTHING if item.strokes is None else large(item.strokes),
                _percent(item.sampling),
            )
            for number, item in enumerate(life.passes, start=1)
        ],
    }
    names = ("limits", "causes", "phases", "passes")
    return {
        name: Table(head, (("", tuple(rows)),))
        for name, (head, rows) in zip(names, lines.items(), strict=True)
    }


def _percent(error: float | None) -> str:
    """Return the half width of a logarithm as a percentage."""
    return NOTHING if error is None else readable(100.0 * math.expm1(error), 2)


def limit_error(limit: LimitResult) -> float | None:
    """Return the half width of the logarithm of the strokes to a limit; None if unknown."""
    if limit.sampling is None or limit.step is None:
        return None
    return math.hypot(limit.sampling, limit.step)


def _limit_line(scene: Scene, limit: LimitResult) -> tuple[str, ...]:
    factor, unit = unit_scale(limit.unit, limit.value)
    half = None if limit.last_half_width is None else factor * limit.last_half_width
    # A level curve has no drift and no meaningful half width.
    is_level = limit.last == 0.0 and not half
    last = "no trend" if is_level else f"{with_interval(factor * limit.last, half)} {unit}"
    name = f"{words_of(limit.key)} over {limit_text(limit)}"
    if limit.strokes is None:
        return name, "not exceeded", NOTHING, NOTHING, last
    error = limit_error(limit)
    digits, hours = digits_of(error), limit.strokes * scene.mechanism.period / 3600.0
    interval = span_of(limit.strokes, error) or "unknown"
    return name, large(limit.strokes, digits=digits), interval, readable(hours, digits), last
