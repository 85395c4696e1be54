"""The report of a result folder: one HTML file that opens anywhere."""

from collections.abc import Sequence
from functools import partial
from pathlib import Path

from presswear.linkage.laws import DAMPINGS, KELVIN_VOIGT, delivered_restitution
from presswear.linkage.surface import SIDES
from presswear.results.conformity import deep_contacts
from presswear.results.result import FINISHED, Result
from presswear.results.stage import StageResult
from presswear.scene.bearing import Bearing
from presswear.scene.catalog import title_of
from presswear.scene.scene import Scene
from presswear.scene.settings import SET, settings_of
from presswear.show.figures import NAMES, drawn
from presswear.show.figures.life import FILE as LIFE
from presswear.show.figures.style import stage_names
from presswear.show.report.bottom import bottom, under_load
from presswear.show.report.drives import drives
from presswear.show.report.life import life_head
from presswear.show.report.moments import moments
from presswear.show.report.motion import FILES as MOTION
from presswear.show.report.motion import motion
from presswear.show.report.origin import (
    changed_values,
    convention_set,
    conventions,
    diagnostics,
    parameters,
    provenance,
)
from presswear.show.report.overview import (
    OPENING,
    in_short,
    overview,
)
from presswear.show.report.page import Illustration, Words, illustrated, render_page
from presswear.show.report.parts import (
    CUBIC_MILLIMETRES,
    MICRONS,
    MILLI,
    Rows,
    Table,
    by_joint,
    count,
    estimated,
    mean,
    number,
    stage_table,
)
from presswear.show.report.tonnage import tonnage
from presswear.show.report.wear import deepest, growth, one_wear, spread
from presswear.tools.errors import InputError
from presswear.tools.files import inside, write_bytes
from presswear.tools.numbers import large, readable, whole
from presswear.tools.quantities import Quantity


def write_report(result: Result) -> Path:
    """Draw the figures and write ``report.html`` into the result folder; returns its path.

    InputError for a result in memory, which has no folder.
    """
    if result.path is None:
        raise InputError(f"{result.scene.name} ran in memory: a report needs a folder")
    into = inside(result.path, "figures")
    drawers = [partial(drawn, name, result, result.stages) for name in NAMES]
    # Of an ideal motion there are few: processes would take longer to begin.
    at_once = None if result.scene.clearance_joints else 1
    words, figures = illustrated(partial(words_of, result), drawers, into, at_once)
    path = result.path / "report.html"
    write_bytes(path, render(words, figures).encode())
    return path


def render(words: Words, figures: Sequence[Illustration]) -> str:
    """The page as text."""
    return render_page(
        "report.html",
        **words,
        life_figures=[figure for figure in figures if figure.file == LIFE],
        opening=[figure for figure in figures if figure.file in OPENING],
        motion_figures=[figure for figure in figures if figure.file in MOTION],
        figures=[figure for figure in figures if figure.file not in (*OPENING, *MOTION, LIFE)],
    )


def words_of(result: Result) -> Words:
    """What the page says of a result."""
    loaded = under_load(result)
    differs, changes = changed_values(result)
    return {
        "scene": result.scene,
        "title": title_of(result.scene),
        "differs": differs,
        "changes": changes,
        "life": life_head(result),
        "in_short": in_short(result),
        "overview": overview(result, loaded),
        "moments": moments(result),
        "status": status(result),
        "style": result.status if result.status in FINISHED else "unfinished",
        "modelled": modelled(result),
        "key_numbers": key_numbers(result),
        "bottom": bottom(result, loaded),
        "tonnage": tonnage(result),
        "drives": drives(result),
        "endings": endings(result),
        "growth": growth(result),
        "motion": motion(result),
        "means": cycle_means(result),
        "notes": notes(result),
        "parameters": parameters(result),
        "convention_set": convention_set(result.scene.conventions),
        "conventions": conventions(result),
        "provenance": provenance(result),
        "diagnostics": diagnostics(result),
    }


def status(result: Result) -> str:
    """The status of a result in plain words."""
    stored, wanted = len(result.stages), result.scene.wear_updates + 1
    match result.status:
        case "completed":
            return f"Completed: {_stages(stored)} run to the end.{_known(result)}"
        case "unconverged":
            return f"Not converged: {result.message}. {_stages(stored)} run to the end."
        case "failed":
            return f"Failed: {result.message or 'no reason was given'}"
        case "running":
            return (
                f"Unfinished: {stored} of {_stages(wanted)} stored; it was running or interrupted "
                "when this was written."
            )
        case other:
            return f"Ended as “{other}”. {result.message}".strip()


def _known(result: Result) -> str:
    """A sentence on how well the wear of a run is known that was to run so many cycles."""
    errors = [stage.statistics.wear_error for stage in result.stages]
    known = [error for error in errors if error is not None]
    if not known:
        return " How well its wear is known cannot be told from so few cycles." * any(
            stage.joints for stage in result.stages
        )
    return f" Its wear is known to {readable(100.0 * max(known), 2)} %."


def _stages(count: int) -> str:
    return "1 stage" if count == 1 else f"{count} stages"


def modelled(result: Result) -> list[str]:
    """Sentences on what was modelled, with the stages that share it."""
    models: dict[str, list[str]] = {}
    for name, stage in zip(stage_names(result, result.stages), result.stages, strict=True):
        models.setdefault(str(stage.diagnostics.get("model", "not stated")), []).append(name)
    if len(models) == 1:
        return list(models)
    return [f"{', '.join(names)}: {model}" for model, names in models.items()]


def key_numbers(result: Result) -> Table:
    """Peaks, wear and contact of every stage."""

    def of_joint(joint: str) -> Rows[StageResult]:
        return {
            "largest normal force (N)": number(joint, "peak_force"),
            **deepest(result, joint),
            "one more wear: volume (mm³)": number(joint, "wear_volume", CUBIC_MILLIMETRES),
            "time in contact (%)": number(joint, "contact_time_fraction", 100.0),
            "contacts": count(joint, "contacts"),
            "fewest steps in a contact": count(joint, "min_steps_per_contact"),
        }

    slider: Rows[StageResult] = {
        "highest displacement (mm)": number("", "displacement_max", MILLI, 4),
        "lowest velocity (m/s)": number("", "velocity_min"),
        "highest velocity (m/s)": number("", "velocity_max"),
        "largest acceleration (m/s²)": number("", "acceleration_max"),
        "cycles": lambda stage: whole(stage.cycles),
        "energy made by contacts (% of what they and friction took)": lambda stage: readable(
            100.0 * stage.statistics.energy_made_fraction, 2
        ),
    }
    watched = {result.scene.watched.capitalize(): slider}
    return stage_table(result, "", {**watched, **by_joint(result, of_joint)})


def cycle_means(result: Result) -> Table:
    """Means over cycles with the half widths of their 95 % intervals."""

    def of_joint(joint: str) -> Rows[StageResult]:
        return {
            "largest normal force (N)": mean(joint, "peak_force_per_cycle"),
            "contacts": mean(joint, "contacts_per_cycle"),
            "force times slip (N m)": mean(joint, "load_distance_per_cycle"),
            **one_wear(result, joint),
        }

    slider: Rows[StageResult] = {
        "highest displacement (mm)": mean("", "displacement_max_per_cycle", MILLI),
        "highest velocity (m/s)": mean("", "velocity_max_per_cycle"),
        "largest acceleration (m/s²)": mean("", "acceleration_max_per_cycle"),
        "energy made by contacts (mJ)": lambda stage: estimated(
            stage.statistics.energy_made_per_cycle, MILLI
        ),
        "cycles in the means": lambda stage: whole(
            stage.statistics.output and stage.statistics.output.displacement_max_per_cycle.samples
        ),
    }
    return stage_table(
        result,
        "mean over cycles",
        {result.scene.watched.capitalize(): slider, **by_joint(result, of_joint)},
    )


def endings(result: Result) -> Table:
    """The end of each stage, and how well its wear maps are known."""
    rows = []
    for name, stage in zip(stage_names(result, result.stages), result.stages, strict=True):
        error = stage.statistics.wear_error
        ended = {
            "completed": "ran all its cycles",
            "enough": "ended early: its wear maps are known to the tolerance",
            "failed": f"failed: {stage.message}",
        }.get(stage.status, stage.status)
        rows.append(
            (
                name,
                ended,
                whole(stage.cycles),
                _part(error),
                _part(stage.statistics.load_distance_step_error),
                _multiplied(stage) if stage.joints else "–",
                readable(stage.simulated_s),
                readable(stage.wall_s),
            )
        )
    head = (
        "stage",
        "how it ended",
        "cycles",
        "wear known to",
        "finer steps change it by",
        "depth multiplied by",
        "simulated (s)",
        "computed in (s)",
    )
    return Table(head, (("", tuple(rows)),), numeric=False)


def _part(part: float | None) -> str:
    return "–" if part is None else f"{readable(100.0 * part, 2)} %"


def _multiplied(stage: StageResult) -> str:
    steps = stage.wear_steps
    if len(steps) > 1:
        return f"{spread(steps)}, in {len(steps)} steps"
    return readable(stage.amplification)


def _restitution(bearing: Bearing) -> str:
    """What the normal law of a bearing gives back, in a sentence."""
    law = bearing.normal_law
    if not isinstance(law, str):
        return f"The normal force is {law}; what it gives back is not known."
    if law == KELVIN_VOIGT:
        return (
            f"The normal force has a viscous damping of {bearing.viscous_damping:g} N s/m; what "
            "that gives back depends on the masses that meet."
        )
    delivered = delivered_restitution(DAMPINGS[law].factor(bearing.restitution))
    return (
        f"The normal force is set to a restitution of {bearing.restitution:g}; the law of "
        f"{DAMPINGS[law].title} gives back {delivered:.3f}."
    )


def _made(result: Result) -> str:
    """Parts of the dissipated energy that contacts made, of the stages on worn surfaces."""
    worn = [stage for stage in result.stages if stage.is_worn]
    parts = [stage.statistics.energy_made_fraction for stage in worn]
    return ", ".join(f"{readable(100.0 * part, 2)} %" for part in parts)


def _given(scene: Scene) -> str:
    """A sentence on the surfaces that a scene begins on."""
    deepest = ", ".join(
        f"{side} at {joint} {readable(MICRONS * float(own.depth.max()))} µm"
        for joint, pair in scene.surfaces.items()
        for side, own in zip(SIDES, pair, strict=True)
        if own.is_worn
    )
    source = scene.origins.get("surfaces", "a script")
    return f"The first stage begins on surfaces from {source}, deepest: {deepest}."


def _one_wear(result: Result) -> str:
    """What a wear between two stages stands for."""
    last = "The wear that the last stage would cause is given, but no stage ran on it."
    if result.life is None:
        return f"{last} One wear stands for {whole(result.scene.cycles_per_update)} cycles."
    part = large(result.life.strokes_at(result.scene, 1))
    return (
        f"Stages stand at equal parts of the life: a wear from one to the next is of {part} "
        f"strokes. {last}"
    )


def notes(result: Result) -> list[str]:
    """Sentences to bear in mind when reading the numbers."""
    scene = result.scene
    chosen = [
        setting.key
        for setting in settings_of(scene)
        if isinstance(setting.meaning, Quantity)
        and setting.meaning.origin.startswith(("chosen", "assumed", SET))
    ]
    found = [
        f"{scene.mechanism.origin} Chosen or assumed are {', '.join(chosen)}; the table of "
        "parameters tells where each value comes from."
    ]
    if not scene.clearance_joints:
        return found
    found.insert(
        0,
        "Beyond some tens of impacts the motion is chaotic; a peak is one draw. The means over "
        "cycles are given below with 95 % intervals.",
    )
    if scene.surfaces:
        found.insert(0, _given(scene))
    found = [f"{own[0].upper()}{own[1:]}." for own in deep_contacts(scene, result.stages)] + found
    bearings = [scene.bearing(joint) for joint in scene.clearance_joints]
    laws: dict[str, list[str]] = {}
    for joint, own in zip(scene.clearance_joints, bearings, strict=True):
        laws.setdefault(_restitution(own), []).append(joint)
    found += [text if len(laws) == 1 else f"{', '.join(at)}: {text}" for text, at in laws.items()]
    steps = [stage.statistics.peak_force_step_error for stage in result.stages]
    if known := [part for part in steps if part is not None]:
        found.append(
            "Pieces of a cycle were run again with finer steps: their greatest forces change by "
            f"{readable(100.0 * max(known), 2)} % at most, in the mean over the pieces."
        )
    if any(stage.is_worn for stage in result.stages) and scene.conventions.contact == "radial":
        found.append(
            "A worn surface is met radially: the force points along the line of centres even "
            "where the profile slopes, which feeds energy into the joint or takes it out, and a "
            "pin can enter a groove narrower than itself. Of the energy that damping and friction "
            f"took, contacts had made {_made(result)} in the stages on them: forces and "
            "wear there are worth as much less."
        )
    if any(own.materials.wear_coefficient > 0.0 for own in bearings):
        found.append(_one_wear(result))
        scatters = sorted({f"{100.0 * own.materials.wear_scatter:g} %" for own in bearings})
        found.append(
            "Depths and volumes are as true as the wear coefficient, which no interval holds: from "
            f"pair to pair it scatters by {' or '.join(scatters)}."
        )
        if result.grew_in_steps:
            found.append(
                "A wear was applied in steps of a cycle each, by every start on surfaces of its "
                "own; half as many steps tell their error. The wear that the last stage would "
                "cause is a single jump at its rate, of which only the volume is told: its deepest "
                "places would be noise."
            )
        elif scene.wear_updates > 0:
            first = result.stages[0].statistics.joints.get(scene.clearance_joints[0])
            samples = first and first.peak_force_per_cycle.samples
            found.append(
                "A wear is a single jump: the mean map of all starts is multiplied and the "
                "surfaces are rebuilt once. The noise of the cycles makes them rough, so that "
                "forces and wear after a jump are those of maps of as many cycles, here "
                f"{whole(samples)}. Where there are several starts, "
                "each has run on its own map as well, which is of as many times fewer cycles: how "
                "they scatter, and how far they are from the others, is in the intervals."
            )
        if scene.conventions.wear_distribution == "bin":
            widths = dict.fromkeys(f"{360 / own.angles:g}°" for own in bearings)
            found.append(
                "All wear of a moment goes into one bin of the map, as in the paper. Depth and "
                f"volume then scale with the width of the bins, here {' and '.join(widths)}."
            )
    return found
