"""Report of a result folder: one HTML file that can be opened anywhere.

Its sentences are in ``templates/report.html``, its tables are made in ``tables.py`` and
the files beside it.
"""

import shlex
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from presswear.linkage.normal_law import DAMPINGS, KELVIN_VOIGT, delivered_restitution
from presswear.linkage.oil import OILED_DAMPING
from presswear.physics.dead_centre import bottom_of
from presswear.results.folder import FINISHED, SCHEMA
from presswear.results.life import span_of, words_of
from presswear.results.oil_film import dry_contact
from presswear.results.result import Result
from presswear.results.rigid_joints import (
    ideal_drives,
    ideal_forces,
    rubbing_drives,
    rubbing_joints,
)
from presswear.results.run_film import film_sentences
from presswear.scene.bearing import Bearing
from presswear.scene.catalog import changes_of, named_scene, title_of
from presswear.scene.conventions import CONVENTIONS
from presswear.scene.scene import Scene
from presswear.show import page
from presswear.show.figures import (
    OF_MANY_CYCLES,
    Drawing,
    drawings,
    first_drawings,
    remove_others,
)
from presswear.show.figures.life import limit_text
from presswear.show.figures.style import stage_names
from presswear.show.key_numbers import key_numbers, stages_with_numbers, surfaces_of
from presswear.show.life_section import life_section
from presswear.show.limits import limit_lines
from presswear.show.motion_table import motion_table
from presswear.show.moving_mechanism import moving_mechanism
from presswear.show.page import Illustration, Table
from presswear.show.scene_tables import mechanism_tables, setting_tables
from presswear.show.stage_tables import (
    drive_table,
    growth_table,
    heights_at_rest,
    stage_tables,
)
from presswear.show.tables import Record, line_table, result_table
from presswear.show.warnings import warnings
from presswear.show.wear_law import user_wear_laws, wear_law_numbers
from presswear.show.words import in_words_of
from presswear.tools import numbers
from presswear.tools.errors import (
    InputError,
    NotStored,
    RunFailed,
    is_out_of_memory,
    unknown,
)
from presswear.tools.files import inside, write_bytes

PICTURE = "mechanism."  # start of the name of the figure on the first screen
MANY_CYCLES = 10  # recorded cycles from which sections and spectra show something

# Titles of the tables that a reader of HTML and of PDF sees, in their order, by name
TITLES = {
    "chosen": "Specified settings",
    "changes": "Changed settings",
    "bodies": "Bodies",
    "pins": "Joints",
    "joints": "Motion, forces and wear",
    "bottom": "Accuracy and repeatability at bottom dead centre",
    "tonnage": "Tonnage and shock",
    "elastic_pins": "Forces of elastic pins",
    "guide": "Tilt and load of the slide in its guide",
    "motor": "Speed, torque and energy of the motor",
    "drives": "Torque, power and energy of the drives",
    "growth": "Wear updates",
    "motion": "Modes of contact",
    "endings": "End of each stage",
}


def prepare(scene: Scene) -> None:
    """Compile the kernels of a report, and compute the quantities of the scene alone."""
    if not scene.has_untrusted_loads:
        ideal_drives(scene)
        rubbing_drives(scene)
        ideal_forces(scene)
    heights_at_rest(scene)


def write_report(
    result: Result,
    notify: Callable[[int], None] = lambda count: None,
    has_all_figures: bool = True,
    extra_figures: Sequence[str] = (),
) -> Path:
    """Draw the figures and write ``report.html`` into the folder of a result; return the page.

    Figures of an earlier report that are not drawn again are removed. ``notify`` is
    called with the number of figures before they are drawn. With ``has_all_figures`` =
    False the page has the figures of ``first_drawings`` and states the command that
    draws the others. ``extra_figures`` are names in ``OF_MANY_CYCLES``.
    RunFailed if memory runs out.
    """
    path = folder_of(result)
    command = f"presswear report {shlex.quote(str(path))}"
    try:
        extra = drawings_of_many_cycles(result, extra_figures)
        sheets = drawings(result) if has_all_figures else first_drawings(result)
        sheets = [*sheets, *extra]
        notify(len(sheets))
        figures = page.illustrated(sheets, inside(path, "figures"))
        remove_others(path / "figures", [figure.file for figure in figures])
        text = render_report(result, figures, "" if has_all_figures else command)
        file = path / "report.html"
        write_bytes(file, text.encode())
    except Exception as error:
        if not is_out_of_memory(error):
            raise
        raise RunFailed(
            "memory ran out while the report was drawn; the result is kept, and "
            f"{command} draws it"
        ) from None
    return file


def folder_of(result: Result) -> Path:
    """Return the folder of a result; InputError for a result in memory."""
    if result.path is None:
        raise InputError(f"{result.scene.name} ran in memory: a report needs a folder")
    return result.path


def drawings_of_many_cycles(result: Result, names: Sequence[str]) -> list[Drawing]:
    """Return some figures of ``OF_MANY_CYCLES``; InputError as ``check_cycles``."""
    check_cycles(result, names)
    return list(drawings(result, names)) if names else []


def check_cycles(result: Result, names: Sequence[str]) -> None:
    """Raise InputError for an unknown name, or for too few recorded cycles for the figures."""
    for name in names:
        if name not in OF_MANY_CYCLES:
            raise unknown("figure of many cycles", name, OF_MANY_CYCLES)
    scene = result.scene
    times = [stage.time[-1] for stage in result.stages if stage.time.size]
    cycles = [round((time - scene.run_up) / scene.mechanism.period) for time in times]
    if names and min(cycles, default=0) < MANY_CYCLES:
        raise InputError(
            f"{names[0]} needs {MANY_CYCLES} recorded cycles, and the run has "
            f"{min(cycles, default=0)}; run it with --set recorded_cycles=24"
        )


def render_report(
    result: Result, figures: Sequence[Illustration] = (), figures_command: str = ""
) -> str:
    """Return the report of a result as HTML, with ``figures``.

    The page states ``figures_command``, which draws all figures, unless it is empty.
    """
    scene = result.scene
    stages = list(zip(stage_names(result, result.stages), result.stages, strict=True))
    untrusted = [name for name, law in scene.user_laws.items() if not law.is_trusted]
    # Sentences on tables whose series an earlier version did not store
    missing = list[str]()
    content: Record = {
        "result": result,
        "titles": titles_of(scene),
        "scene": scene,
        "base": named_scene(scene),
        "stages": stages,
        "moving": moving_mechanism(result),
        "strokes": in_words_of(scene, "strokes"),
        "bottom": in_words_of(scene, "Bottom dead centre"),
        "moves": bottom_of(scene.ideal) is not None,
        "untrusted": untrusted,
        "laws": _normal_laws(scene),
        "has_rubbing_joints": bool(rubbing_joints(scene)),
        "bearings": [scene.bearing(joint) for joint in scene.wearing_joints],
        "wear_law": wear_law_numbers(scene),
        "user_wear": user_wear_laws(scene),
        "oil": [] if untrusted else _oil_sentences(result),
        "presets": CONVENTIONS,
        "tables": report_tables(result, missing),
        "life": result.life and life_section(result, result.life),
        "words_of": words_of,
        "limit_text": limit_text,
        "span_of": span_of,
        "figures_command": figures_command,
    }
    pictures = (figure for figure in figures if figure.file.startswith(PICTURE))
    screen = replace(first_screen(result, missing), picture=next(pictures, None))
    return page.render_page(
        title_of(scene),
        screen,
        template="report.html",
        figures=figures,
        **content,
    )


def titles_of(scene: Scene) -> dict[str, str]:
    """Return the titles of the tables by name, in the words of the linkage of a scene."""
    return {name: in_words_of(scene, title) for name, title in TITLES.items()}


def report_tables(result: Result, missing: list[str]) -> dict[str, Table | None]:
    """Return the tables of a report by name, None for one without values.

    A sentence on each table whose series an earlier version did not store is added to
    ``missing``.
    """
    changes = changes_of(result.scene)
    optional = {
        name: _if_stored(table, result, missing) for name, table in _OPTIONAL.items()
    }
    return {
        **stage_tables(result),
        **setting_tables(result),
        **mechanism_tables(result),
        "changes": line_table("changes", result, changes) if changes else None,
        **optional,
        "provenance": provenance_table(result),
    }


def first_screen(result: Result, missing: Sequence[str] = ()) -> page.FirstScreen:
    """Return status, limits, key numbers and warnings of a result; see ``report_tables``."""
    limits = []
    limits_stage = ""
    if sound := stages_with_numbers(result):
        limits = limit_lines(result.scene, sound[-1])
        limits_stage = in_words_of(result.scene, surfaces_of(result, sound[-1]))
    return page.FirstScreen(
        status=_status(result),
        style=result.status if result.status in FINISHED else "unfinished",
        made_by=made_by(result.provenance),
        limits=limits,
        limits_stage=limits_stage,
        key_numbers=key_numbers(result),
        warnings=[*warnings(result), *missing],
    )


def made_by(origin: Mapping[str, Any]) -> str:
    """Return the command that started a run, the version of presswear and the date."""
    command = origin.get("command", "")
    version = origin["packages"]["presswear"]
    date = origin["started"].replace("T", " ").replace("Z", " UTC")
    return f"{command}, presswear {version}, {date}".removeprefix(", ")


def _status(result: Result) -> str:
    """Return a sentence on the end of the run."""
    count = len(result.stages)
    message = result.message
    match result.status:
        case "completed":
            stages = f"all {count} stages" if count > 1 else "the stage"
            return f"Completed: {stages} ran."
        case "unconverged":
            return f"Not converged: {message}. {numbers.counted(count, 'stage')} ran."
        case "failed":
            return f"Failed: {message or 'no reason was stored'}"
        case "running":
            total = result.scene.wear_updates + 1
            stages = f"{count} of {total} stages are stored"
            reason = message or "the run goes on or was killed"
            return f"Unfinished: {stages}; {reason}."
        case status:
            return f"Ended with the status “{status}”. {message}"


def _oil_sentences(result: Result) -> list[str]:
    """Return paragraphs on the oil films beside the run, and on those in its last stage."""
    sentences = [*dry_contact(result.scene)]
    for stage in result.stages[-1:]:
        sentences += film_sentences(result.scene, stage)
    return sentences


def _normal_laws(scene: Scene) -> list[tuple[list[str], Bearing, str, float | None]]:
    """Return the joints that share a normal law, their bearing, its title and its restitution.

    The restitution is the one of an impact under the law, not the nominal one; None if it
    is unknown.
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
        if bearing.has_film:
            title = OILED_DAMPING
            delivered = restitution
        key = (title, restitution, bearing.viscous_damping)
        joints, *_ = groups.setdefault(key, ([], bearing, title, delivered))
        joints.append(joint)
    return list(groups.values())


def provenance_table(result: Result) -> Table | None:
    """Return versions, machine and time of a result."""
    packages = []
    for name, version in result.provenance["packages"].items():
        packages.append(f"{name} {version.replace(', ', ', module ')}")
    listed = "; ".join(packages)
    record = {"name": "", "result": result, "schema": SCHEMA, "packages": listed}
    return result_table("provenance", result, [record], numeric=False)


_OPTIONAL = {"drives": drive_table, "growth": growth_table, "motion": motion_table}


def _if_stored(
    table: Callable[[Result], Table | None], result: Result, missing: list[str]
) -> Table | None:
    """Return a table, or None if its series are not in the result.

    A sentence on a table that is left out is added to ``missing``.
    """
    try:
        return table(result)
    except NotStored as error:
        version = result.provenance["packages"]["presswear"]
        missing.append(
            f"A table is left out. {error}; presswear {version} wrote the result."
        )
        return None
