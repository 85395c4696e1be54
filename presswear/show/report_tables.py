"""Tables of the report of a result: rows from ``templates/tables.toml``, and their records."""

import math
import tomllib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import fields
from importlib.resources import files
from itertools import groupby, permutations
from typing import Any

import numpy as np

from presswear.analysis.contact_modes import MODES, Timeline, combine, resonance, timeline_of
from presswear.analysis.periods import period_of
from presswear.analysis.spectra import spectra_of
from presswear.linkage.surface import SIDES
from presswear.physics.ideal import bottom_of
from presswear.physics.statics import heights_at_bottom, pull_of
from presswear.recording.soundness import RESIDUAL
from presswear.recording.statistics import STARTUP_CYCLES
from presswear.results import press_analysis as press
from presswear.results.folder import SCHEMA
from presswear.results.life import LifeResult, LimitResult, digits_of, span_of, words_of
from presswear.results.result import Result
from presswear.results.stage import StageResult, WearStep
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

_TABLES = tomllib.loads(
    files("presswear.show").joinpath("templates/tables.toml").read_text("utf-8")
)
_HARMONICS = (1, 2, 3)  # orders of the crank whose amplitudes are listed
_MIN_LINES = 8  # spectral lines per order; with fewer, noise too has most power at whole orders
_ENDINGS = {
    "completed": "all cycles completed",
    "enough": "stopped when the wear maps reached the tolerance",
}
_TEXTS = {  # names in braces that are the same for all results
    "snap": f"{short_number(1e3 * press.SNAP_THROUGH_S)} ms",
    "residual": short_number(press.ENERGY_BOUND),
    "residual_of_wear": short_number(10.0 * press.ENERGY_BOUND),
    "residual_of_failure": short_number(RESIDUAL),
    "orders": ", ".join(map(str, _HARMONICS)),
}


def stage_tables(result: Result) -> dict[str, Table | None]:
    """Return the tables with a column per stage, by name; None for a table without any value.

    Stored laws of the result are not executed unless they are trusted.
    """
    records = stage_records(result)
    sound = [record for record in records if not record["stage"].failed]
    tables = {
        name: _result_table(name, result, sound if name in ("overview", "moments") else records)
        for name in ("overview", "moments", "key", "means", "bottom", "tonnage")
    }
    keys = dict.fromkeys(key for record in records for key in record["stage"].diagnostics)
    diagnostics = [
        Row(
            key.removesuffix("_s").replace("_", " "),
            f"stage.diagnostics.{key}",
            "s" if key.endswith("_s") else "",
        )
        for key in keys
        if key != "model"
    ]
    names = [record["name"] for record in records]
    return {
        **tables,
        "endings": _line_table("endings", records),
        "diagnostics": column_table("", names, records, {"": diagnostics}),
    }


def _result_table(
    name: str, result: Result, records: Sequence[Record], **more: Sequence[str]
) -> Table | None:
    """Return a table of ``tables.toml`` with a column per record; ``more`` are repeated names."""
    scene, joints = result.scene, result.scene.clearance_joints
    linkage = scene.mechanism.linkage()
    texts = {
        **_TEXTS,
        "phase": linkage.phase,
        "pull": quantity_text(pull_of(scene.linkage()), "N"),
        "output": scene.output,
        "Output": scene.output.capitalize(),
        "joints": " and ".join(joints),
    }
    repeated: dict[str, Sequence[str]] = {
        "joint": joints,
        "body": [drive.body for drive in linkage.drives],
        "part_of_stroke": press.PHASES,
        "mode": MODES,
        "change": [f"{a} to {b}" for a, b in permutations(MODES, 2)],
        **more,
    }
    names = {key: [{key: value} for value in values] for key, values in repeated.items()}
    # Maps that are fixed in space have one angle for both surfaces.
    sides = {side: side for side in SIDES} if maps_turn(result) else {"both": "bearing + pin"}
    names["side"] = [{"side": side, "part": part} for side, part in sides.items()]
    rows = {heading: [Row(*row) for row in lines] for heading, lines in _TABLES[name].items()}
    columns = [record["name"] for record in records]
    corner = _TABLES["corners"].get(name, "")
    return column_table(corner, columns, records, expanded(rows, texts, names))


def expanded(
    groups: Mapping[str, Sequence[Row]],
    texts: Mapping[str, str],
    names: Mapping[str, Sequence[Mapping[str, str]]],
) -> dict[str, list[Row]]:
    """Return rows by heading with all names in braces replaced.

    ``texts`` are names with one value. A heading or a sequence of adjacent rows is repeated for
    the values of ``names``.
    """

    def name_in(text: str, used: Mapping[str, str]) -> str:
        return next((key for key in names if key not in used and f"{{{key}}}" in text), "")

    result = {}
    for heading, rows in groups.items():
        for outer in names.get(name_in(heading, {}), [{}]):
            lines: list[Row] = []
            for key, adjacent in groupby(rows, lambda row: name_in(row.label + row.path, outer)):  # noqa: B023
                block = list(adjacent)
                inner = names.get(key, [{}])
                lines += [row.of(**texts, **outer, **each) for each in inner for row in block]
            result[heading.format(**texts, **outer)] = lines
    return result


def _line_table(name: str, records: Iterable[Any], numeric: bool = False, **texts: str) -> Table:
    """Return a table of ``tables.toml`` with a line per record."""
    columns = [Row(*row).of(**texts) for row in _TABLES["columns"][name]]
    return row_table(columns, list(records), numeric)


def stage_records(result: Result) -> list[Record]:
    """Return the values of the tables that are not attributes of the stages; one per stage."""
    scene, records = result.scene, []
    first = result.stages[0] if result.stages else None
    has_wear = any(stage.index > 0 for stage in result.stages)
    represented = 0.0
    for name, stage in zip(stage_names(result, result.stages), result.stages, strict=True):
        joints = stage.statistics.joints
        bdc = stage.statistics.bdc if scene.clearance_joints else None
        largest = max(joints, key=lambda joint: joints[joint].peak_force, default="")
        peaks = joints.get(largest)
        ending = _ENDINGS.get(stage.status, stage.status)
        records.append(
            {
                "name": name,
                "stage": stage,
                "statistics": stage.statistics,
                "output": stage.statistics.output,
                "joints": joints,
                "bdc": bdc,
                "dwell": None if bdc is None or bdc.delay else bdc.ideal_dwell,
                "rise": press.rise(stage, first) if bdc and first and stage is not first else None,
                "range_strokes": None if bdc is None or bdc.range is None else bdc.range_strokes,
                "rest": _heights_at_rest(result, stage),
                "wear": {joint: _wear_record(stage, joint) for joint in scene.clearance_joints},
                "tonnage": press.tonnage_of(scene, stage),
                "ideal_work": None if scene.process is None else scene.process.work,
                "drives": None if scene.has_untrusted_loads else press.drives_of(scene, stage),
                "largest": peaks
                and {
                    "joint": largest,
                    "force": peaks.peak_force,
                    "mean": peaks.peak_force_per_cycle,
                },
                "peak": _recorded_peak(scene, stage),
                "moments": _moments(scene, stage),
                "represented": round(represented) if has_wear else None,
                "ending": f"failed: {stage.message}" if stage.failed else ending,
                "multiplier": _multiplier(stage) if stage.joints else None,
            }
        )
        represented += sum(step.cycles_per_update for step in stage.wear_steps)
    return records


def _heights_at_rest(result: Result, stage: StageResult) -> Record | None:
    """Return total clearance and rise under a static force at bottom dead centre, m."""
    scene = result.scene
    is_trusted = all(law.is_trusted for law in scene.user_laws.values())
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
        height = press.height_of(scene, stage)
        falls = height[min(row + 1, time.size - 1)] < height[max(row - 1, 0)]
        record["height"], record["direction"] = float(height[row]), "down" if falls else "up"
        record["phase"] = _work_phase(scene, stage, row)
    return record


def _work_phase(scene: Scene, stage: StageResult, row: int) -> str | None:
    """Return the phase of the work at a row of the series; None outside of it."""
    strokes, force, now = (
        press.strokes_of(scene, stage),
        press.process_force(scene, stage),
        stage.time[row],
    )
    if strokes is None or force is None:
        return None
    for contact, fracture in zip(strokes.contact[:, 0], strokes.fracture[:, 0], strict=True):
        is_pressed = force[row] > 0.0 if np.isnan(fracture) else now < fracture
        if contact <= now and is_pressed:
            return press.PHASES[press.WORK]
        if fracture <= now < fracture + press.SNAP_THROUGH_S:
            return press.PHASES[press.SNAP_THROUGH]
    return None


def _moments(scene: Scene, stage: StageResult) -> dict[str, list[str]]:
    """Return phase angles and heights at which strokes touch, break and leave the work."""
    start = scene.run_up + STARTUP_CYCLES * scene.mechanism.period
    strokes, moments = press.strokes_of(scene, stage), {}
    for name in ("contact", "fracture", "separation") if strokes else ():
        rows = getattr(strokes, name)
        rows = rows[~np.isnan(rows[:, 0])]
        settled = rows[rows[:, 0] >= start]
        rows = settled if len(settled) else rows
        if len(rows):
            angle = phase_degrees(scene, rows[:, 0])
            # Relative to the first, because 359 and 1 degrees are close.
            angle = angle[0] + (angle - angle[0] + 180.0) % 360.0 - 180.0
            moments[name] = [_range_text(angle, 2), _range_text(1e3 * rows[:, 1], 3)]
    return moments


def _range_text(values: Array, decimals: int) -> str:
    low, mean, high = (
        f"{value:.{decimals}f}".replace("-", "−")
        for value in (values.min(), values.mean(), values.max())
    )
    return mean if low == high else f"{mean} ({low} to {high})"


def _multiplier(stage: StageResult) -> str:
    steps = stage.wear_steps
    if len(steps) > 1:
        return f"{_factor_range(steps)}, in {len(steps)} steps"
    return readable(stage.amplification)


def _factor_range(steps: Sequence[WearStep]) -> str:
    ends = [readable(pick(step.factor for step in steps)) for pick in (min, max)]
    return " to ".join(dict.fromkeys(ends))


def drive_table(result: Result) -> Table | None:
    """Return torque, power and energy of each drive beside ideal joints.

    None if torques were not stored, or if ideal torques would execute untrusted stored laws.
    """
    scene = result.scene
    if scene.has_untrusted_loads:
        return None
    records: list[Record] = []
    for name, stage in zip(stage_names(result, result.stages), result.stages, strict=True):
        drives, energy = (
            press.drives_of(scene, stage),
            press.energy_of(scene, stage),
        )
        if drives:
            duty = {body: drive.duty for body, drive in drives.items()}
            balance = (
                {"work": energy.drive_work, "residual": energy.residual_fraction} if energy else {}
            )
            records.append({"name": name, "duty": duty, **balance})
    if not records:
        return None
    ideal = press.ideal_drives(scene)
    work = sum(drive.work for drive in ideal.values())
    return _result_table(
        "drives", result, [*records, {"name": "ideal joints", "duty": ideal, "work": work}]
    )


def growth_table(result: Result) -> Table | None:
    """Return the steps in which each wear update was applied; None if all were single jumps."""
    if not result.grew_in_steps:
        return None
    joints = result.scene.clearance_joints
    records = [
        {
            "name": result.stage_name(stage.index + 1),
            "steps": len(steps),
            "represented": sum(step.cycles_per_update for step in steps),
            "cycles": sum(step.cycles for step in steps),
            "multiplier": _factor_range(steps),
            "change": max(step.clearance_change for step in steps),
            "wall": sum(step.wall_s for step in steps),
            "last": steps[-1],
            "force": {joint: max(step.peak_force[joint] for step in steps) for joint in joints},
        }
        for stage in result.stages
        if (steps := stage.wear_steps)
    ]
    return _result_table("growth", result, records)


def motion_table(result: Result) -> Table | None:
    """Return contact modes, periodicity and spectra by stage; None if no cycle was recorded."""
    scene, joints = result.scene, result.scene.clearance_joints
    names = stage_names(result, result.stages)
    records = [
        {"name": name, **_motion_record(result, stage)}
        for name, stage in zip(names, result.stages, strict=True)
        if press.has_motion(scene, stage)
    ]
    if not records:
        return None
    several = dict.fromkeys(mode for record in records for mode in record["together"])
    series = list(records[0]["harmonics"])
    modes = list(several) if len(joints) > 1 else []
    return _result_table("motion", result, records, modes=modes, series=series, spectrum=series)


def _motion_record(result: Result, stage: StageResult) -> Record:
    scene, joints = result.scene, result.scene.clearance_joints
    start, end = press.settled_span(scene, stage)
    cycles = (end - start) / scene.mechanism.period
    lines = {joint: timeline_of(scene, stage, joint) for joint in joints}
    together = combine(list(lines.values()))
    labels = [f"acceleration of the {scene.output} (m/s²)"]
    labels += [f"force at {joint} (N)" for joint in joints]
    spectra = dict(zip(labels, spectra_of(scene, stage).values(), strict=True))
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
    conventions = {item.name for item in fields(Conventions)}
    settings = [each for each in settings_of(result.scene) if each.key not in conventions]
    return _line_table("parameters", map(_setting_record, settings))


def _setting_record(setting: Setting) -> Record:
    meaning, value = setting.meaning, setting.value
    record = {"setting": setting, "value": "none" if value is None else str(value), "unit": ""}
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
    names = {item.name for item in fields(Conventions)}
    records = [
        {"setting": setting, "choices": " or ".join(setting.meaning.words)}
        for setting in settings_of(result.scene)
        if setting.key in names and isinstance(setting.meaning, Choice)
    ]
    return _line_table("conventions", records)


def change_table(result: Result) -> Table | None:
    """Return the settings that differ from the named scene or the defaults; None if none does."""
    changes = changes_of(result.scene)
    return _line_table("changes", changes) if changes else None


def provenance_table(result: Result) -> Table:
    """Return versions, machine and time of a result."""
    stored = result.provenance
    packages = ", ".join(f"{name} {number}" for name, number in stored["packages"].items())
    values = {
        "engine": result.scene.engine,
        "source revision": stored["revision"],
        "packages": packages,
        "Python": stored["python"],
        "machine": stored["machine"],
        "started": stored["started"],
        "computing time (s)": readable(result.wall_s),
        "schema of the result": str(SCHEMA),
    }
    return _line_table("provenance", values.items())


def life_tables(scene: Scene, life: LifeResult) -> dict[str, Table]:
    """Return the tables of a service life: limits, causes of its error, phases and refinements."""
    causes = {
        f"sampling: {scene.replicate_count} replicates of a chaotic motion": life.sampling,
        "step of the wear update, from refinements with coarser steps": life.step,
        "scatter of the wear coefficients": life.scatter,
        "all together": life.total_error,
    }
    lines: dict[str, list[tuple[str, ...]]] = {
        "limits": [_limit_line(scene, limit) for limit in life.limits],
        "causes": [
            (name, _percent(error), span_of(life.strokes, error) or NOTHING)
            for name, error in causes.items()
        ],
        "phases": [
            (
                f"{phase.joint}: {phase.name}",
                large(phase.since, phase.until),
                with_interval(1e15 * phase.rate, 1e15 * phase.half_width),
            )
            for phase in life.phases
        ],
        "refinements": [
            (
                str(number),
                readable(100.0 * each.change),
                whole(each.cycles),
                NOTHING if each.strokes is None else large(each.strokes),
                _percent(each.sampling),
            )
            for number, each in enumerate(life.refinements, start=1)
        ],
    }
    end = large(float(life.curves["strokes"][-1]))
    return {name: _line_table(name, records, True, end=end) for name, records in lines.items()}


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
