"""Report of a result folder: one HTML file that can be opened anywhere.

Its sentences are in ``templates/report.html``, the rows of its tables in
``templates/tables.toml``. A table has a column per stage, or a line per record; a
record holds the values of one of them.
"""

import math
import shlex
import tomllib
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import lru_cache
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np

from presswear.analysis.contact_modes import (
    MODES,
    Timeline,
    combine,
    resonance,
    timeline_of,
)
from presswear.analysis.periods import period_of
from presswear.analysis.spectra import spectra_of
from presswear.linkage.elements import GROUND, INERTIA, MASS, Attachment
from presswear.linkage.laws import DAMPINGS, KELVIN_VOIGT, delivered_restitution
from presswear.linkage.surface import SIDES, Surface
from presswear.physics import statics
from presswear.physics.ideal import bottom_of
from presswear.recording.columns import CYCLE, JOINT_CYCLE, with_mean
from presswear.recording.soundness import ENERGY_BOUND, RESIDUAL
from presswear.recording.statistics import Estimate
from presswear.results.bottom_dead_centre import rise
from presswear.results.drives import drives_of
from presswear.results.folder import FINISHED, SCHEMA
from presswear.results.frame_load import ALLOWED_REVERSE, frame_loads
from presswear.results.guide_tilt import (
    ALLOWED_TILT,
    LEAST_ALLOWED_TILT,
    STATES,
    guide_tilts,
)
from presswear.results.life import (
    WITHOUT_CURVES,
    LifeResult,
    LimitResult,
    digits_of,
    span_of,
    words_of,
)
from presswear.results.motor_load import (
    ALLOWED_DROP,
    RECOVERED,
    leader_speed,
    mean_period,
    motor_loads,
)
from presswear.results.oil_film import dry_contact
from presswear.results.readings import FILE as READINGS
from presswear.results.remaining_life import remaining_life
from presswear.results.result import Result
from presswear.results.rigid_joints import (
    ideal_drives,
    ideal_forces,
    rubbing_drives,
    rubbing_joints,
)
from presswear.results.run_film import film_sentences
from presswear.results.sampled_cycles import has_motion, sampled_span
from presswear.results.stage import StageResult, WearStep
from presswear.results.strokes import PHASES, SNAP_THROUGH_S
from presswear.results.tonnage import tonnage_of
from presswear.scene.bearing import CONVENTIONS, Bearing
from presswear.scene.catalog import base_of, changes_of, named_scene, title_of
from presswear.scene.scene import Scene
from presswear.scene.settings import (
    DEFAULT,
    SET,
    Setting,
    settings_of,
    used_settings_of,
)
from presswear.show import page
from presswear.show.figures import drawings, first_drawings
from presswear.show.figures.life import limit_text, services_done
from presswear.show.figures.style import TEMPLATES, maps_turn, stage_names
from presswear.show.key_numbers import (
    IDEAL,
    RUBBING,
    equal_bottoms_text,
    key_numbers,
    warnings,
)
from presswear.show.page import NOTHING, Illustration, Line, Row, Table
from presswear.show.wear_law import wear_law_numbers
from presswear.tools import numbers
from presswear.tools.errors import InputError, NotStored, RunFailed
from presswear.tools.files import inside, write_bytes
from presswear.tools.quantities import Quantity

Record = dict[str, Any]

_TABLES = TEMPLATES.from_string(
    (files(__package__) / "templates/tables.toml").read_text("utf-8")
)
_TILTS = ("touch", "fracture", "bottom", "greatest")  # of a slide
_HARMONICS = (1, 2, 3)  # orders of the crank whose amplitudes are listed
_TOGETHER = 8  # most frequent modes of all joints together that are listed
# spectral lines per order; with fewer, noise too has most power at whole orders
_MIN_LINES = 8


def prepare(scene: Scene) -> None:
    """Compile the kernels of a report, and compute what does not depend on the run."""
    if not scene.has_untrusted_loads:
        ideal_drives(scene)
        rubbing_drives(scene)
        ideal_forces(scene)
    _heights_at_rest(scene)


def write_report(
    result: Result,
    notify: Callable[[int], None] = lambda count: None,
    has_all_figures: bool = True,
) -> Path:
    """Draw the figures and write ``report.html`` into the folder of a result; return the page.

    ``notify`` is called with the number of figures before they are drawn. Without all
    figures there are those of ``first_drawings``, and the page states the command that
    draws the others.
    """
    if result.path is None:
        raise InputError(f"{result.scene.name} ran in memory: a report needs a folder")
    sheets = list(drawings(result) if has_all_figures else first_drawings(result))
    notify(len(sheets))
    figures = page.illustrated(sheets, inside(result.path, "figures"))
    command = (
        "" if has_all_figures else f"presswear report {shlex.quote(str(result.path))}"
    )
    file = result.path / "report.html"
    write_bytes(file, render_report(result, figures, command).encode())
    return file


def render_report(
    result: Result, figures: Sequence[Illustration] = (), figures_command: str = ""
) -> str:
    """Return the report of a result as HTML, with some figures.

    The page states the command that draws all figures, unless it is empty.
    """
    scene = result.scene
    changes = changes_of(result.scene)
    stages = list(zip(stage_names(result, result.stages), result.stages, strict=True))
    untrusted = [name for name, law in scene.user_laws.items() if not law.is_trusted]
    missing: list[str] = []  # what an earlier version did not store
    content: Record = {
        "result": result,
        "scene": scene,
        "base": named_scene(scene),
        "stages": stages,
        "moves": bottom_of(scene.ideal) is not None,
        "untrusted": untrusted,
        "laws": _normal_laws(scene),
        "has_rubbing_joints": bool(rubbing_joints(scene)),
        "bearings": [scene.bearing(joint) for joint in scene.loose_pins],
        "wear_law": wear_law_numbers(scene),
        "oil": [] if untrusted else _oil_sentences(result),
        "presets": CONVENTIONS,
        "tables": {
            **stage_tables(result),
            **setting_tables(result),
            **mechanism_tables(result),
            "changes": _line_table("changes", result, changes) if changes else None,
            **{
                name: _if_stored(table, result, missing)
                for name, table in _OPTIONAL.items()
            },
            "provenance": provenance_table(result),
        },
        "life": result.life and _life(result, result.life),
        "words_of": words_of,
        "limit_text": limit_text,
        "span_of": span_of,
        "figures_command": figures_command,
    }
    return page.render_page(
        title_of(scene),
        page.FirstScreen(
            status=_status(result),
            style=result.status if result.status in FINISHED else "unfinished",
            key_numbers=key_numbers(result),
            warnings=[*warnings(result), *missing],
            picture=next(
                (figure for figure in figures if figure.file == "mechanism.png"), None
            ),
        ),
        template="report.html",
        figures=figures,
        **content,
    )


def _status(result: Result) -> str:
    """Return a sentence on the end of the run."""
    count = len(result.stages)
    message = result.message
    total = result.scene.wear_updates + 1
    return {
        "completed": f"Completed: {f'all {count} stages' if count > 1 else 'the stage'} ran.",
        "unconverged": f"Not converged: {message}. {numbers.counted(count, 'stage')} ran.",
        "failed": f"Failed: {message or 'no reason was stored'}",
        "running": f"Unfinished: {count} of {total} stages are stored; "
        "the run goes on or was stopped.",
    }.get(result.status, f"Ended with the status “{result.status}”. {message}")


def _oil_sentences(result: Result) -> list[str]:
    """Return paragraphs on the oil films beside the run, and in it, of the last stage."""
    in_run = [film_sentences(result.scene, stage) for stage in result.stages[-1:]]
    return [*dry_contact(result.scene), *(line for lines in in_run for line in lines)]


def _normal_laws(scene: Scene) -> list[tuple[list[str], Bearing, str, float | None]]:
    """Return the joints that share a normal law, their bearing, its title and its restitution.

    The restitution is the one that the law delivers, not the one that it is set to;
    None for a law whose restitution is unknown.
    """
    groups: dict[Any, tuple[list[str], Bearing, str, float | None]] = {}
    for joint in scene.loose_pins:
        bearing = scene.bearing(joint)
        law = bearing.normal_law
        restitution = bearing.restitution
        title = str(law)
        delivered = None
        if isinstance(law, str) and law != KELVIN_VOIGT:
            title = DAMPINGS[law].title
            delivered = delivered_restitution(DAMPINGS[law].factor(restitution))
        key = (law, restitution, bearing.viscous_damping)
        groups.setdefault(key, ([], bearing, title, delivered))[0].append(joint)
    return list(groups.values())


def _tables(result: Result, **names: Any) -> Record:
    """Return ``tables.toml`` filled with the names of a result, and with ``names``."""
    scene = result.scene
    linkage = scene.mechanism.linkage()
    # Maps that are fixed in space have one angle for both surfaces.
    sides = (
        {side: side for side in SIDES}
        if maps_turn(result)
        else {"both": "bearing + pin"}
    )
    content = {
        "scene": scene,
        "linkage": linkage,
        "joints": scene.loose_pins,
        "drives": [drive.body for drive in linkage.drives],
        "frames": [guide.name for guide in scene.linkage().elastic_guides],
        "guides": [guide.name for guide in scene.loose_guides],
        "states": STATES,
        "asked": f"{1e6 * LEAST_ALLOWED_TILT:.0f} to {1e6 * ALLOWED_TILT:.0f}",
        "allowed_reverse": ALLOWED_REVERSE,
        "leader": scene.linkage().leader,
        "motors": [
            drive.body
            for drive in linkage.drives
            if drive.motor is not None and drive.motor.has_slip
        ],
        "allowed_drop": ALLOWED_DROP,
        "recovered": RECOVERED,
        "pull": statics.pull_of(scene.linkage()),
        "statics": statics,
        "phases": PHASES,
        "snap_through_s": SNAP_THROUGH_S,
        "energy_bound": ENERGY_BOUND,
        "residual": RESIDUAL,
        "orders": _HARMONICS,
        "sides": sides,
        "modes": MODES,
        "means": with_mean(CYCLE),
        "joint_means": with_mean(JOINT_CYCLE),
    }
    return _parsed(_TABLES.render(content | names))


_parsed = lru_cache(maxsize=8)(tomllib.loads)


def _result_table(
    name: str,
    result: Result,
    records: Sequence[Record],
    numeric: bool = True,
    **names: Any,
) -> Table | None:
    """Return a table of ``tables.toml`` with a column per record."""
    content = _tables(result, **names)
    rows = {
        heading: [Row(*row) for row in lines]
        for heading, lines in content[name].items()
    }
    columns = [record["name"] for record in records]
    corner = content["corners"].get(name, "")
    return page.column_table(corner, columns, records, rows, numeric)


def _line_table(
    name: str,
    result: Result,
    records: Iterable[Any],
    numeric: bool = False,
    **names: str,
) -> Table:
    """Return a table of ``tables.toml`` with a line per record."""
    columns = [Row(*row) for row in _tables(result, **names)["columns"][name]]
    lines = (tuple(column.text(record) for column in columns) for record in records)
    return page.plain_table((column.head for column in columns), lines, numeric)


def stage_tables(result: Result) -> dict[str, Table | None]:
    """Return the tables with a column or a line per stage, by name; None for one without values.

    Numbers of failed stages are left out. Stored laws of the result are not executed
    unless they are trusted.
    """
    scene = result.scene
    records = list[Record]()
    endings = _tables(result)["endings"]
    for name, stage in zip(
        stage_names(result, result.stages), result.stages, strict=True
    ):
        bdc = stage.statistics.bdc if scene.has_deviations else None
        speed = leader_speed(scene, stage)
        ending = endings.get(stage.status, stage.status)
        records.append(
            {
                "name": name,
                "stage": stage,
                "bdc": bdc,
                "dwell": None
                if bdc is None or bdc.delay or bdc.equal_bottoms
                else bdc.ideal_dwell,
                "bottoms": None
                if bdc is None
                else equal_bottoms_text(scene, bdc) or None,
                "rise": rise(stage, result.stages[0]) if bdc and records else None,
                "rest": None
                if stage.failed
                else _heights_at_rest(scene, stage.surfaces),
                "angles": {
                    joint: {
                        side: _direction(peak.angle)
                        for side, peak in one.wear_peaks.items()
                    }
                    for joint, one in stage.statistics.joints.items()
                },
                "worn": {joint: _deepest(stage, joint) for joint in scene.loose_pins},
                "tonnage": tonnage_of(scene, stage),
                "frames": frame_loads(scene, stage),
                "guides": _guides_of(scene, stage),
                "motors": motor_loads(scene, stage),
                "speed": speed,
                "strokes_per_minute": speed and speed.stroke_rate.scaled(60.0),
                "ideal_work": None if scene.process is None else scene.process.work,
                "ending": f"failed: {stage.message}" if stage.failed else ending,
                "represented": stage.cycles_per_update if stage.joints else None,
            }
        )
    sound = [record for record in records if not record["stage"].failed]
    names: tuple[str, ...] = ("joints", "bottom", "tonnage")
    if scene.loose_guides:
        names = (*names, "guide")
    if scene.linkage().leader is not None:
        names = (*names, "motor")
    tables = {name: _result_table(name, result, sound) for name in names}
    tables.setdefault("motor", None)
    tables.setdefault("guide", None)
    tables["endings"] = _line_table("endings", result, records)
    return {**tables, "diagnostics": _result_table("diagnostics", result, records)}


def _guides_of(scene: Scene, stage: StageResult) -> Record:
    """Return the tilts and loads of slides by guide; tilts in um/m, shares by state."""
    guides: Record = {}
    for name, tilt in guide_tilts(scene, stage).items():
        each = {key: getattr(tilt, key) for key in _TILTS}
        guides[name] = {
            key: estimate and estimate.scaled(1e6) for key, estimate in each.items()
        }
        guides[name] |= {"force": tilt.corner_force, "loss": tilt.friction_loss}
        guides[name] |= {"time": tilt.time_shares, "load": tilt.load_shares}
    return guides


def _factor_range(steps: Sequence[WearStep]) -> str:
    ends = [
        numbers.readable(pick(step.factor for step in steps)) for pick in (min, max)
    ]
    return " to ".join(dict.fromkeys(ends))


def _heights_at_rest(
    scene: Scene, surfaces: Mapping[str, tuple[Surface, Surface]] | None = None
) -> Record | None:
    """Return total clearance and rise under a static force at bottom dead centre, m."""
    if not scene.has_deviations or not all(
        law.is_trusted for law in scene.user_laws.values()
    ):
        return None
    linkage = scene.linkage(surfaces)
    pull = statics.pull_of(linkage)
    try:
        up, down, rest = map(
            float, statics.heights_at_bottom(linkage, (pull, -pull, 0.0))
        )
    except (
        InputError,
        RunFailed,
    ):  # the output stands still, or no equilibrium is found
        return None
    return {"clearance": up - down, "rise": up - rest}


def _deepest(stage: StageResult, joint: str) -> dict[str, tuple[float, float | None]]:
    """Return depth, m, and angle, rad, of the deepest wear by side; no angle without wear."""
    maps = stage.joints[joint]
    deepest = {}
    depths = {side: maps.depth(side) for side in SIDES}
    for side, depth in {**depths, "both": np.sum([*depths.values()], axis=0)}.items():
        angle = float(maps.angle[int(depth.argmax())]) if np.any(depth > 0.0) else None
        deepest[side] = float(depth.max()), angle
    return deepest


def _direction(angle: Estimate) -> str:
    """Return an angle, degrees within one turn, to two digits of half the width of its interval."""
    mean, low, high = (
        math.degrees(end or 0.0) for end in (angle.mean, angle.low, angle.high)
    )
    if angle.low is None:
        return f"{mean:.1f} (too few cycles)"
    digits = max(1 - math.floor(math.log10(0.5 * (high - low))), 0)
    texts = [f"{round(end, digits) % 360.0:.{digits}f}" for end in (mean, low, high)]
    return f"{texts[0]} ({' to '.join(texts[1:]) if high - low < 360.0 else 'any'})"


def drive_table(result: Result) -> Table | None:
    """Return torque, power and energy of each drive beside rigid joints.

    None if torques were not stored, or if ideal torques would execute untrusted stored
    laws.
    """
    scene = result.scene
    records: list[Record] = []
    if scene.has_untrusted_loads:
        return None
    for name, stage in zip(
        stage_names(result, result.stages), result.stages, strict=True
    ):
        if drives := drives_of(scene, stage):
            duty = {body: drive.duty for body, drive in drives.items()}
            records.append({"name": name, "duty": duty, "energy": stage.statistics})
    if not records:
        return None
    rigid = {RUBBING: rubbing_drives(scene), IDEAL: ideal_drives(scene)}
    for name, duties in rigid.items():
        if duties:
            energy = {
                "drive_work_per_cycle": sum(drive.work for drive in duties.values())
            }
            records.append({"name": name, "duty": duties, "energy": energy})
    return _result_table("drives", result, records)


def growth_table(result: Result) -> Table | None:
    """Return the steps in which each wear update was applied; None if all were single jumps."""
    if not result.grew_in_steps:
        return None
    joints = result.scene.loose_pins
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
            "force": {
                joint: max(step.peak_force[joint] for step in steps) for joint in joints
            },
        }
        for stage in result.stages
        if (steps := stage.wear_steps)
    ]
    return _result_table("growth", result, records)


def motion_table(result: Result) -> Table | None:
    """Return contact modes, periodicity and spectra by stage; None if no cycle was recorded."""
    names = stage_names(result, result.stages)
    records = [
        {"name": name, **_motion_record(result.scene, stage)}
        for name, stage in zip(names, result.stages, strict=True)
        if has_motion(result.scene, stage)
    ]
    if not records:
        return None
    shares = Counter[str]()
    for record in records:
        shares.update(record["shares"])
    series = list(records[0]["harmonics"])
    is_alone = len(result.scene.loose_pins) == 1
    together = [] if is_alone else [mode for mode, _ in shares.most_common(_TOGETHER)]
    return _result_table("motion", result, records, together=together, series=series)


def _motion_record(scene: Scene, stage: StageResult) -> Record:
    joints = scene.loose_pins
    start, end = sampled_span(scene, stage)
    cycles = (end - start) / scene.mechanism.period
    lines = {joint: timeline_of(scene, stage, joint) for joint in joints}
    together = combine(list(lines.values())) if lines else None
    labels = {"": f"acceleration of {scene.output} (m/s²)"}
    labels |= {joint: f"force at {joint} (N)" for joint in joints}
    spectra_by_name = spectra_of(scene, stage)
    spectra = {label: spectra_by_name[name] for name, label in labels.items()}

    def visits(line: Timeline) -> dict[str, str]:
        """Return the share of the time in a mode, its visits per cycle and their mean duration."""
        texts = {mode: f"{100.0 * share:.2f} %" for mode, share in line.shares.items()}
        for mode in texts:
            if (times := line.visits(mode)).size:
                length = 1e3 * float(times.mean())
                texts[mode] += f", {times.size / cycles:.3g} of {length:.3g} ms"
        return texts

    def changes(line: Timeline) -> dict[str, float]:
        counts = line.transitions
        pairs = np.argwhere(counts)
        return {
            f"{MODES[a]} to {MODES[b]}": float(counts[a, b]) / cycles for a, b in pairs
        }

    return {
        "cycles": cycles,
        "modes": {joint: visits(line) for joint, line in lines.items()},
        "together": visits(together) if together else {},
        "shares": together.shares if together else {},
        "changes": {joint: changes(line) for joint, line in lines.items()},
        "period": str(period_of(scene, stage)),
        "harmonics": {
            name: ", ".join(
                numbers.readable(spectrum.amplitude(order)) for order in _HARMONICS
            )
            for name, spectrum in spectra.items()
        },
        "whole": {
            name: spectrum.harmonic_share if spectrum.lines >= _MIN_LINES else None
            for name, spectrum in spectra.items()
        },
        "resonance": {joint: resonance(stage, joint) for joint in joints},
    }


def setting_tables(result: Result) -> dict[str, Table]:
    """Return the tables ``parameters``, of all settings, and ``chosen``, of those the user set."""
    scene = result.scene
    before = {setting.key: setting.value for setting in settings_of(base_of(scene))}
    is_named = named_scene(scene) is not None
    records: dict[str, list[Record]] = {"parameters": [], "chosen": []}
    for setting in used_settings_of(scene):
        meaning = setting.meaning
        value = setting.value
        record: Record = {
            "setting": setting,
            "value": "none" if value is None else str(value),
        }
        if isinstance(meaning, Quantity) and isinstance(value, int | float):
            record["value"] = _engineers(meaning, value)
        record["origin"] = _origin(scene, setting, before, is_named)
        records["parameters"].append(record)
        if record["origin"].startswith(SET):
            records["chosen"].append(record)
    return {
        name: _line_table(name, result, lines)
        for name, lines in records.items()
        if lines
    }


def _origin(
    scene: Scene, setting: Setting, before: Mapping[str, Any], is_named: bool
) -> str:
    """Return the origin of a value; ``before`` are the values of the named scene, or defaults."""
    origin = scene.origins.get(setting.key, DEFAULT)
    if origin != DEFAULT:
        return origin
    if setting.value != before.get(setting.key, before):
        return SET
    if not (is_named and isinstance(setting.meaning, Quantity)):
        return DEFAULT
    return setting.meaning.origin


def _engineers(meaning: Quantity, value: float) -> str:
    """Return a value in the unit in which engineers write it."""
    (text,), unit = meaning.texts(value)
    return f"{text} {unit}".rstrip()


def mechanism_tables(result: Result) -> dict[str, Table]:
    """Return the tables ``bodies``, with the drives, and ``pins``, of all joints and contacts."""
    scene = result.scene
    linkage = scene.base_linkage
    speed = Quantity("rad/s")
    drives = {
        drive.body: _engineers(speed, drive.mean_speed)
        + ", not constant" * drive.repeats
        for drive in linkage.drives
    }
    loose = [guide.name for guide in scene.loose_guides]
    guided = {guide.body for guide in linkage.guides if guide.name not in loose}
    # a slide that begins to tilt gets an inertia
    moving = {body.name: body for body in scene.linkage().bodies}
    start = scene.ideal.at(np.zeros(1)).position.round(9).reshape(-1, 3).tolist()
    bodies = [
        {
            "name": body.name,
            "mass": _engineers(MASS, body.mass),
            "inertia": None
            if body.name in guided
            else _engineers(INERTIA, moving[body.name].inertia),
            "start": position,
            "speed": drives.get(body.name),
        }
        for body, position in zip(linkage.bodies, start, strict=True)
    ]
    places = {joint.name: (joint.first, joint.second) for joint in linkage.revolutes}
    titles = {}
    for guide in linkage.guides:
        ends = Attachment(GROUND, guide.x, guide.y), Attachment(guide.body, 0.0, 0.0)
        places[guide.name] = ends
        titles[guide.name] = (
            f"{guide.name}, along {math.degrees(guide.direction):.6g}°"
            + ", each corner" * (guide.name in loose)
        )
    radii = {one.name: one.pin_radius for one in scene.linkage().clearances}
    contacts = {joint.name: joint for joint in scene.linkage().clearances}
    contacts |= {corner.guide.name: corner for corner in scene.linkage().corners}
    pins = [
        {
            "name": titles.get(name, name),
            "contact": contacts.get(name),
            "pin_radius": radii.get(name),
            "places": [*map(_place, ends)],
        }
        for name, ends in places.items()
    ]
    tables = {"bodies": _line_table("bodies", result, bodies)}
    return tables | {"pins": _line_table("pins", result, pins)}


def _place(point: Attachment) -> str:
    x, y = (
        numbers.short_number(round(1e3 * value, 6) + 0.0)
        for value in (point.x, point.y)
    )
    return f"{point.body}: {x}, {y}"


_OPTIONAL = {"drives": drive_table, "growth": growth_table, "motion": motion_table}


def _if_stored(
    table: Callable[[Result], Table | None], result: Result, missing: list[str]
) -> Table | None:
    """Return a table; None, and a sentence in ``missing``, if its series are not in the result."""
    try:
        return table(result)
    except NotStored as error:
        version = result.provenance["packages"]["presswear"]
        missing.append(
            f"A table is left out. {error}; presswear {version} wrote the result."
        )
        return None


def provenance_table(result: Result) -> Table | None:
    """Return versions, machine and time of a result."""
    packages = result.provenance["packages"].items()
    listed = "; ".join(
        f"{name} {text.replace(', ', ', module ')}" for name, text in packages
    )
    record = {"name": "", "result": result, "schema": SCHEMA, "packages": listed}
    return _result_table("provenance", result, [record], numeric=False)


def _life(result: Result, life: LifeResult) -> Record:
    """Return what the template reads on the service life of a result."""
    first = life.first if life.ended in ("limit", *WITHOUT_CURVES) else None
    high = (life.interval.high if first else None) or 0.0
    rivals = [
        words_of(limit.key)
        for limit in life.limits
        if limit is not first
        and limit.strokes is not None
        and limit.strokes / math.exp(limit.error or 0.0) <= high
    ]
    period = mean_period(result)
    limits = [_limit_line(period, limit) for limit in life.limits]
    wear_rates = [
        (
            f"{rate.joint}: {rate.surfaces}",
            numbers.large(rate.since, rate.until),
            numbers.with_interval(1e15 * rate.rate, 1e15 * rate.half_width),
        )
        for rate in life.wear_rates
    ]
    end = numbers.large(
        float(life.curves["strokes"][-1]) if life.curves else life.strokes
    )
    return {
        "result": life,
        "period": period,
        "first": first,
        "rivals": rivals,
        "services": services_done(result),
        "repeating": _repeating(life),
        "pin": _pin_that_ends(result, life),
        "remaining": _remaining(result),
        "limits": _line_table("limits", result, limits, True, end=end),
        "wear_rates": _line_table("wear_rates", result, wear_rates, True, end=end),
    }


def _remaining(result: Result) -> tuple[str, ...]:
    """Return the lines on the remaining life by the readings in the folder of a result."""
    if result.path is None or not (result.path / READINGS).exists():
        return ()
    try:
        return remaining_life(result, result.path / READINGS).lines
    except InputError as error:
        return (f"{error}",)


def _repeating(life: LifeResult) -> str:
    """Return a sentence on the load blocks at whose end all histories repeat, or nothing."""
    seen = [settled for settled in life.settled if settled is not None]
    if not any(seen):
        return ""
    whole = seen.count(max(seen))
    blocks = numbers.counted(len(seen), "load block")
    return f"At the end of {whole} of {blocks} {max(seen)} wear histories repeat."


def _pin_that_ends(result: Result, life: LifeResult) -> str:
    """Return a sentence if a pin ends a life in which only its bushing was serviced, or nothing."""
    first = life.first
    stages = result.stages
    joint, _, name = first.key.partition(".") if first else ("", "", "")
    serviced = {service.joint for service in services_done(result)}
    is_whole = len(stages) == result.scene.wear_updates + 1 and not stages[-1].failed
    if (
        life.ended != "limit"
        or name != "depth"
        or joint not in serviced
        or not is_whole
    ):
        return ""
    end = stages[-1].joints[joint]  # on the surfaces at the end of the life
    bearing, pin = (
        numbers.quantity_text(float(end.depth(side).max()), "m") for side in SIDES
    )
    if end.depth("pin").max() <= end.depth("bearing").max():
        return ""
    return (
        f"The pin of {joint} ends this life: it is worn by {pin} at the end, its bushing by "
        f"{bearing}. A new or turned bushing does not renew the pin."
    )


def _limit_line(period: float, limit: LimitResult) -> Line:
    factor, unit = numbers.unit_scale(limit.unit, limit.value)
    half = None if limit.last_half_width is None else factor * limit.last_half_width
    # A level curve has no drift and no meaningful half width.
    is_level = limit.last == 0.0 and not half
    last = (
        "no trend"
        if is_level
        else f"{numbers.with_interval(factor * limit.last, half)} {unit}"
    )
    name = f"{words_of(limit.key)} over {limit_text(limit)}"
    if limit.strokes is None:
        return name, "not exceeded", NOTHING, NOTHING, last
    error = limit.error
    digits = digits_of(error)
    hours = limit.strokes * period / 3600.0
    interval = span_of(limit.strokes, error) or "unknown"
    strokes = numbers.large(limit.strokes, digits=digits)
    return name, strokes, interval, numbers.readable(hours, digits), last
