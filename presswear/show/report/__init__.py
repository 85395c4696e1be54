"""The report of a result folder: one HTML file that opens anywhere."""

from dataclasses import dataclass
from functools import partial
from pathlib import Path

from presswear.linkage.laws import delivered_restitution, lankarani_nikravesh_damping
from presswear.results.result import Result
from presswear.results.stage import StageResult
from presswear.scene.settings import SET, settings_of
from presswear.show.figures import draw_all
from presswear.show.report.origin import (
    convention_set,
    conventions,
    diagnostics,
    parameters,
    provenance,
)
from presswear.show.report.page import Illustration, render_page
from presswear.show.report.parts import (
    CUBIC_MILLIMETRES,
    MILLI,
    Row,
    Table,
    by_stage,
    number_at,
    scaled,
    stage_names,
)
from presswear.show.report.wear import deepest_with_interval, growth, spread, wear_rows
from presswear.tools.errors import InputError
from presswear.tools.files import write_bytes
from presswear.tools.numbers import readable, whole, with_interval
from presswear.tools.quantities import Choice


@dataclass(frozen=True)
class Status:
    """How a result stands: a word that styles it, and a sentence."""

    word: str
    sentence: str


def write_report(result: Result) -> Path:
    """Draw the figures and write ``report.html`` into the result folder; returns its path.

    InputError for a result in memory, which has no folder.
    """
    if result.path is None:
        raise InputError(f"{result.scene.name} ran in memory: a report needs a folder")
    folder = result.path / "figures"
    figures = draw_all(result, folder)
    text = render(result, [Illustration.of(figure, folder) for figure in figures])
    path = result.path / "report.html"
    write_bytes(path, text.encode())
    return path


def render(result: Result, figures: list[Illustration]) -> str:
    """The page as text."""
    return render_page(
        "report.html",
        scene=result.scene,
        status=status_of(result),
        modelled=modelled(result),
        key_numbers=key_numbers(result),
        endings=endings(result),
        growth=growth(result),
        figures=figures,
        means=cycle_means(result),
        notes=notes(result),
        parameters=parameters(result),
        convention_set=convention_set(result.scene.conventions),
        conventions=conventions(result),
        provenance=provenance(result),
        diagnostics=diagnostics(result),
    )


def status_of(result: Result) -> Status:
    """The status in plain words."""
    done = len(result.stages)
    of = result.scene.wears + 1
    match result.status:
        case "completed":
            return Status("completed", f"Completed: {_stages(done)} run to the end.")
        case "failed":
            return Status("failed", f"Failed: {result.message or 'no reason was given'}")
        case "running":
            return Status(
                "unfinished",
                f"Unfinished: {done} of {_stages(of)} stored; it was running or interrupted when "
                "this was written.",
            )
        case other:
            return Status("unfinished", f"Ended as “{other}”. {result.message}".strip())


def _stages(count: int) -> str:
    return "1 stage" if count == 1 else f"{count} stages"


def modelled(result: Result) -> list[str]:
    """What was modelled, with the stages that share it."""
    models: dict[str, list[str]] = {}
    for name, stage in zip(stage_names(result), result.stages, strict=True):
        models.setdefault(str(stage.diagnostics.get("model", "not stated")), []).append(name)
    if len(models) == 1:
        return list(models)
    return [f"{', '.join(names)}: {model}" for model, names in models.items()]


def key_numbers(result: Result) -> Table:
    """Peaks, wear and contact of every stage."""

    def statistic(label: str, factor: float, digits: int, *path: str) -> Row:
        return by_stage(
            result,
            label,
            lambda stage: readable(scaled(number_at(stage.statistics, *path), factor), digits),
        )

    def count(label: str, *path: str) -> Row:
        return by_stage(result, label, lambda stage: whole(number_at(stage.statistics, *path)))

    groups: list[tuple[str, tuple[Row, ...]]] = [
        (
            "Slider",
            (
                statistic("highest displacement (mm)", MILLI, 4, "slider", "displacement_max_m"),
                statistic("lowest velocity (m/s)", 1.0, 3, "slider", "velocity_min_m_s"),
                statistic("highest velocity (m/s)", 1.0, 3, "slider", "velocity_max_m_s"),
                statistic("largest acceleration (m/s²)", 1.0, 3, "slider", "acceleration_max_m_s2"),
                count("cycles", "cycles"),
            ),
        )
    ]
    for joint in result.scene.clearance_joints:
        own = ("joints", joint)
        rows = [
            statistic("largest normal force (N)", 1.0, 3, *own, "force_max_N"),
            *wear_rows(result, joint),
            statistic("one more wear: volume (mm³)", CUBIC_MILLIMETRES, 3, *own, "wear_volume_m3"),
            statistic("time in contact (%)", 100.0, 3, *own, "part_of_time_in_contact"),
            count("contacts", *own, "contacts"),
            count("fewest steps in a contact", *own, "fewest_steps_in_a_contact"),
        ]
        groups.append((f"Joint {joint}", tuple(rows)))
    return Table(("", *stage_names(result)), tuple(groups))


def cycle_means(result: Result) -> Table:
    """Means over cycles with the half widths of their 95 % intervals."""

    def known(label: str, factor: float, value: Row, half_width: Row) -> Row:
        def text(stage: StageResult) -> str:
            return with_interval(
                scaled(number_at(stage.statistics, *value), factor),
                scaled(number_at(stage.statistics, *half_width), factor),
            )

        return by_stage(result, label, text)

    def mean(label: str, factor: float, *path: str) -> Row:
        return known(label, factor, (*path, "mean"), (*path, "half_width"))

    slider = (
        mean("highest displacement (mm)", MILLI, "slider", "displacement_max_per_cycle_m"),
        mean("highest velocity (m/s)", 1.0, "slider", "velocity_max_per_cycle_m_s"),
        mean("largest acceleration (m/s²)", 1.0, "slider", "acceleration_max_per_cycle_m_s2"),
        by_stage(
            result,
            "cycles in the means",
            lambda stage: whole(
                number_at(stage.statistics, "slider", "displacement_max_per_cycle_m", "cycles")
            ),
        ),
    )
    joints = [
        (
            f"Joint {joint}",
            (
                mean("largest normal force (N)", 1.0, "joints", joint, "force_max_per_cycle_N"),
                mean("contacts", 1.0, "joints", joint, "contacts_per_cycle"),
                mean("force times slip (N m)", 1.0, "joints", joint, "dose_per_cycle_Nm"),
                known(
                    "worn by one wear (mm³)",
                    CUBIC_MILLIMETRES,
                    ("joints", joint, "wear_volume_m3"),
                    ("joints", joint, "wear_volume_half_width_m3"),
                ),
                by_stage(
                    result,
                    "deepest of one wear (µm)",
                    partial(deepest_with_interval, result, joint),
                ),
            ),
        )
        for joint in result.scene.clearance_joints
    ]
    return Table(("mean over cycles", *stage_names(result)), (("Slider", slider), *joints))


def endings(result: Result) -> Table:
    """How each stage ended and how well its wear maps are known."""
    rows = []
    for name, stage in zip(stage_names(result), result.stages, strict=True):
        found = stage.statistics
        errors = [
            error
            for joint in result.scene.clearance_joints
            if (error := number_at(found, "joints", joint, "wear_map_error")) is not None
        ]
        ended = {
            "completed": "ran all its cycles",
            "enough": "ended early: its wear maps are known to the tolerance",
            "failed": f"failed: {stage.message}",
        }.get(stage.status, stage.status)
        rows.append(
            (
                name,
                ended,
                whole(found.get("cycles")),
                f"{readable(100.0 * max(errors), 2)} %" if errors else "–",
                _multiplied(stage) if errors else "–",
                readable(stage.simulated_s),
                readable(stage.wall_s),
            )
        )
    head = (
        "stage",
        "how it ended",
        "cycles",
        "wear maps known to",
        "depth multiplied by",
        "simulated (s)",
        "computed in (s)",
    )
    return Table(head, (("", tuple(rows)),), numeric=False)


def _multiplied(stage: StageResult) -> str:
    steps = stage.wear_steps
    if len(steps) > 1:
        return f"{spread(steps)}, in {len(steps)} steps"
    return readable(stage.amplification)


def notes(result: Result) -> list[str]:
    """What to bear in mind when reading the numbers."""
    scene = result.scene
    chosen = [
        setting.key
        for setting in settings_of(scene)
        if not isinstance(setting.meaning, Choice)
        and setting.meaning.status.startswith(("chosen", "assumed", SET))
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
    nominal = scene.bearings.restitution
    delivered = delivered_restitution(lankarani_nikravesh_damping(nominal))
    found.append(
        f"The normal force is set to a restitution of {nominal:g}; the law of Lankarani and "
        f"Nikravesh gives back {delivered:.3f}."
    )
    if len(result.stages) > 1 and scene.conventions.contact == "radial":
        found.append(
            "A worn surface is met radially: the force points along the line of centres even "
            "where the profile slopes, which feeds energy into the joint or takes it out, and a "
            "pin can enter a groove narrower than itself. Forces and wear after a wear are less "
            "certain than those before it."
        )
    if scene.bearings.wear_coefficient > 0.0:
        found.append(
            "The wear that the last stage would cause is given, but no stage ran on it. One wear "
            f"stands for {whole(scene.represented_cycles)} cycles."
        )
        if result.grew_in_steps:
            found.append(
                "A wear was applied in steps with a run after each, so that no surface changed by "
                f"more than {readable(100.0 * scene.depth_step)} % of the clearance in one. The "
                "wear that the last stage would cause is a single jump at the rate of that stage."
            )
        elif scene.wears > 0:
            found.append(
                "A wear is a single jump: the depth of the cycles run is multiplied and the "
                "surfaces are rebuilt once."
            )
        if scene.conventions.footprint == "bin":
            found.append(
                "All wear of a moment goes into one bin of the map, as in the paper. Depth and "
                "volume then scale with the width of the bins, here "
                f"{360 / scene.bearings.angles:g}°."
            )
    return found
