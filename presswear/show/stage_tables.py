"""Tables of a report with a column per stage: joints, bottom dead centre, tonnage, drives."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from presswear.linkage.surface import SIDES, Surface
from presswear.physics import statics
from presswear.recording.statistics import Estimate
from presswear.results.bottom_dead_centre import rise
from presswear.results.drive_duty import DriveDuty
from presswear.results.drives import drives_of
from presswear.results.frame_load import frame_loads
from presswear.results.guide_tilt import guide_tilts
from presswear.results.motor_load import leader_speed, motor_loads
from presswear.results.pin_load import elastic_pin_forces
from presswear.results.result import Result
from presswear.results.rigid_joints import ideal_drives, rubbing_drives
from presswear.results.stage import StageResult, WearStep
from presswear.results.tonnage import tonnage_of
from presswear.scene.scene import Scene
from presswear.show.drive_numbers import IDEAL, RUBBING
from presswear.show.figures.style import stage_names
from presswear.show.page import Table
from presswear.show.stroke_numbers import equal_bottoms_text
from presswear.show.tables import Record, filled_tables, line_table, result_table
from presswear.tools import numbers
from presswear.tools.errors import InputError, RunFailed

_TILTS = ("touch", "fracture", "bottom", "greatest")  # fields of a tilt of a slide
# Ratio of a mean to the rms of a drive, or to the energy supplied, below which the mean is 0
_ROUND_OFF = 1e-9


def stage_tables(result: Result) -> dict[str, Table | None]:
    """Return the tables with a column or a line per stage, by name; None for one without values.

    Numbers of failed stages are left out. Stored laws of the result are not executed
    unless they are trusted.
    """
    scene = result.scene
    endings = filled_tables(result)["endings"]
    records = []
    titles = stage_names(result, result.stages)
    for title, stage in zip(titles, result.stages, strict=True):
        record = {"name": title, **_stage_record(scene, stage)}
        record |= _bottom_record(result, stage)
        ending = endings.get(stage.status, stage.status)
        record["ending"] = f"failed: {stage.message}" if stage.failed else ending
        records.append(record)
    sound = [record for record in records if not record["stage"].failed]
    names = ["joints", "bottom", "tonnage"]
    if scene.linkage().elastic_pins:
        names.append("elastic_pins")
    if scene.loose_guides:
        names.append("guide")
    if scene.linkage().leader is not None:
        names.append("motor")
    tables: dict[str, Table | None] = dict.fromkeys(("elastic_pins", "guide", "motor"))
    tables |= {name: result_table(name, result, sound) for name in names}
    tables["endings"] = line_table("endings", result, records)
    tables["diagnostics"] = result_table("diagnostics", result, records)
    return tables


def _stage_record(scene: Scene, stage: StageResult) -> Record:
    """Return the values of a stage, other than those of bottom dead centre."""
    speed = leader_speed(scene, stage)
    angles = {}
    for joint, statistics in stage.statistics.joints.items():
        peaks = statistics.wear_peaks.items()
        angles[joint] = {side: _direction(peak.angle) for side, peak in peaks}
    return {
        "stage": stage,
        "angles": angles,
        "worn": {joint: _deepest(stage, joint) for joint in scene.loose_pins},
        "tonnage": tonnage_of(scene, stage),
        "frames": frame_loads(scene, stage),
        "pins": elastic_pin_forces(scene, stage),
        "guides": _guides_of(scene, stage),
        "motors": motor_loads(scene, stage),
        "speed": speed,
        "strokes_per_minute": speed and speed.stroke_rate.scaled(60.0),
        "ideal_work": None if scene.process is None else scene.process.work,
        "represented": stage.cycles_per_update if stage.joints else None,
    }


def _bottom_record(result: Result, stage: StageResult) -> Record:
    """Return the values of bottom dead centre of a stage; None for missing ones."""
    scene = result.scene
    first = result.stages[0]
    bdc = stage.statistics.bdc if scene.has_deviations else None
    record: Record = {
        "bdc": bdc,
        "rest": None if stage.failed else heights_at_rest(scene, stage.surfaces),
        "rise": None,
        "bottoms": None,
        "dwell": None,
    }
    if bdc is None:
        return record
    if stage is not first:
        record["rise"] = rise(stage, first)
    record["bottoms"] = equal_bottoms_text(scene, bdc) or None
    if not (bdc.delay or bdc.equal_bottoms):
        record["dwell"] = bdc.ideal_dwell
    return record


def _guides_of(scene: Scene, stage: StageResult) -> Record:
    """Return the tilts and loads of slides by guide; tilts in um/m, shares by state."""
    guides: Record = {}
    for name, tilt in guide_tilts(scene, stage).items():
        guides[name] = {
            "force": tilt.corner_force,
            "loss": tilt.friction_loss,
            "time": tilt.time_shares,
            "load": tilt.load_shares,
            "walls": _walls_of(stage, name),
        }
        for key in _TILTS:
            estimate = getattr(tilt, key)
            guides[name][key] = estimate and estimate.scaled(1e6)
    return guides


def _walls_of(stage: StageResult, guide: str) -> Record:
    """Return the wear of both walls of a guide, by side; rates in a million strokes; SI units."""
    walls = stage.statistics.walls.get(guide, {})
    depths = stage.wall_depth(guide)[1].max(axis=1) if walls else ()
    record: Record = {}
    for (side, wall), worn in zip(walls.items(), depths, strict=True):
        record[side] = {
            "depth": wall.depth_per_cycle.scaled(1e6),
            "place": wall.place,
            "volume": wall.volume_per_cycle.scaled(1e6),
            "worn": float(worn) or None,
        }
    return record


def heights_at_rest(
    scene: Scene, surfaces: Mapping[str, tuple[Surface, Surface]] | None = None
) -> Record | None:
    """Return total clearance and rise under a static force at bottom dead centre, m."""
    if not (scene.has_deviations and scene.is_trusted):
        return None
    linkage = scene.linkage(surfaces)
    pull = statics.pull_of(linkage)
    try:
        heights = statics.heights_at_bottom(linkage, (pull, -pull, 0.0))
    except (InputError, RunFailed):
        return None  # the output stands still, or no equilibrium is found
    up, down, rest = (float(height) for height in heights)
    return {"clearance": up - down, "rise": up - rest}


def _deepest(stage: StageResult, joint: str) -> dict[str, tuple[float, float | None]]:
    """Return depth, m, and angle, rad, of the deepest wear by side; no angle without wear."""
    maps = stage.joints[joint]
    depths = {side: maps.depth(side) for side in SIDES}
    depths["both"] = np.sum(list(depths.values()), axis=0)
    deepest = {}
    for side, depth in depths.items():
        place = int(depth.argmax())
        angle = float(maps.angle[place]) if depth[place] > 0.0 else None
        deepest[side] = float(depth[place]), angle
    return deepest


def _direction(angle: Estimate) -> str:
    """Return an angle in degrees from 0 to 360, with its interval, as a text.

    The half width of the interval has two digits. An interval of half a turn or more
    belongs to a surface that wears most at different places from cycle to cycle.
    """
    mean = math.degrees(angle.mean)
    if angle.low is None or angle.high is None:
        return f"{mean:.1f} (too few cycles)"
    low = math.degrees(angle.low)
    high = math.degrees(angle.high)
    digits = max(1 - math.floor(math.log10(0.5 * (high - low))), 0)

    def text(degrees: float) -> str:
        return f"{round(degrees, digits) % 360.0:.{digits}f}"

    if high - low >= 180.0:
        return f"{text(mean)} (no single place)"
    return f"{text(mean)} ({text(low)} to {text(high)})"


def drive_table(result: Result) -> Table | None:
    """Return torque, power and energy of each drive beside rigid joints.

    None if torques were not stored, or if ideal torques would execute untrusted stored
    laws.
    """
    scene = result.scene
    if scene.has_untrusted_loads:
        return None
    records: list[Record] = []
    names = stage_names(result, result.stages)
    for name, stage in zip(names, result.stages, strict=True):
        drives = drives_of(scene, stage)
        if drives:
            duty = {body: drive.duty for body, drive in drives.items()}
            records.append({"name": name, "duty": duty, "energy": stage.statistics})
    if not records:
        return None
    rigid = {RUBBING: rubbing_drives(scene), IDEAL: ideal_drives(scene)}
    for name, duties in rigid.items():
        if duties:
            supplied = sum(drive.supplied for drive in duties.values())
            work = sum(drive.work for drive in duties.values())
            energy = {"drive_work_per_cycle": _without_round_off(work, supplied)}
            duty = {body: _with_clear_means(drive) for body, drive in duties.items()}
            records.append({"name": name, "duty": duty, "energy": energy})
    return result_table("drives", result, records)


def _with_clear_means(drive: DriveDuty) -> DriveDuty:
    """Return a duty of rigid joints whose means are 0 where they are round-off."""
    torque = _without_round_off(drive.torque.mean, drive.torque.rms)
    power = _without_round_off(drive.power.mean, drive.power.rms)
    return replace(
        drive,
        torque=drive.torque._replace(mean=torque),
        power=drive.power._replace(mean=power),
    )


def _without_round_off(value: float, scale: float) -> float:
    return 0.0 if abs(value) < _ROUND_OFF * scale else value


def growth_table(result: Result) -> Table | None:
    """Return the steps in which each wear update was applied; None if all were single jumps."""
    if not result.grew_in_steps:
        return None
    joints = result.scene.loose_pins
    records = []
    for stage in result.stages:
        if stage.wear_steps:
            name = result.stage_name(stage.index + 1)
            records.append({"name": name, **_steps_record(stage.wear_steps, joints)})
    return result_table("growth", result, records)


def _steps_record(steps: Sequence[WearStep], joints: Sequence[str]) -> Record:
    """Return the values of the steps of a wear update."""
    forces = {}
    for joint in joints:
        forces[joint] = max(step.peak_force[joint] for step in steps)
    return {
        "steps": len(steps),
        "represented": sum(step.cycles_per_update for step in steps),
        "cycles": sum(step.cycles for step in steps),
        "multiplier": _factor_range(steps),
        "change": max(step.clearance_change for step in steps),
        "wall": sum(step.wall_s for step in steps),
        "last": steps[-1],
        "force": forces,
    }


def _factor_range(steps: Sequence[WearStep]) -> str:
    factors = [step.factor for step in steps]
    low = numbers.readable(min(factors))
    high = numbers.readable(max(factors))
    return low if low == high else f"{low} to {high}"
