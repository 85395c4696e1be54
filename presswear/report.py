"""The report of a result folder: one HTML file that opens anywhere."""

import base64
from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from jinja2 import Environment, PackageLoader, StrictUndefined

from presswear.figures import Figure, draw_all
from presswear.figures.numbers import given, readable, whole, with_interval
from presswear.figures.style import SIDES, maps_turn
from presswear.laws import delivered_restitution, lankarani_nikravesh_damping
from presswear.quantities import Choice
from presswear.results import StoredResult, write_whole
from presswear.scene import CONVENTIONS, Conventions, stage_name
from presswear.settings import SET, Setting, settings_of

Row = tuple[str, ...]

MICRONS = 1e6
MILLI = 1e3
CUBIC_MILLIMETRES = 1e9


@dataclass(frozen=True)
class Table:
    """A table as the page shows it.

    Attributes
    ----------
    head : tuple of str
        Column titles; the first column names the rows.
    groups : tuple
        Rows under a heading each; an empty heading is not shown.
    numeric : bool
        Whether all but the first column are numbers.
    """

    head: Row
    groups: tuple[tuple[str, tuple[Row, ...]], ...]
    numeric: bool = True


@dataclass(frozen=True)
class Status:
    """How a result stands: a word that styles it, and a sentence."""

    word: str
    sentence: str


def write_report(result: StoredResult) -> Path:
    """Draw the figures and write ``report.html`` into the result folder; returns its path."""
    folder = result.path / "figures"
    figures = draw_all(result, folder)
    text = render(result, [(figure, (folder / figure.file).read_bytes()) for figure in figures])
    path = result.path / "report.html"

    def write(file: BinaryIO) -> None:
        file.write(text.encode())

    write_whole(path, write)
    return path


def render(result: StoredResult, figures: list[tuple[Figure, bytes]]) -> str:
    """The page as text, figures (record and PNG) inside."""
    page = Environment(
        loader=PackageLoader("presswear"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    return page.get_template("report.html").render(
        scene=result.scene,
        status=status_of(result),
        modelled=modelled(result),
        key_numbers=key_numbers(result),
        endings=endings(result),
        figures=[(figure, base64.b64encode(png).decode()) for figure, png in figures],
        means=cycle_means(result),
        notes=notes(result),
        parameters=parameters(result),
        convention_set=convention_set(result.scene.conventions),
        conventions=conventions(result),
        provenance=provenance(result),
        diagnostics=diagnostics(result),
    )


def status_of(result: StoredResult) -> Status:
    """The status in plain words."""
    document = result.document
    done = len(document["stages"])
    of = result.scene.wears + 1
    match document["status"]:
        case "completed":
            return Status("completed", f"Completed: {_stages(done)} run to the end.")
        case "failed":
            return Status("failed", f"Failed: {document['message'] or 'no reason was given'}")
        case "running":
            return Status(
                "unfinished",
                f"Unfinished: {done} of {_stages(of)} stored; it was running or interrupted when "
                "this was written.",
            )
        case other:
            return Status("unfinished", f"Ended as “{other}”. {document['message']}".strip())


def _stages(count: int) -> str:
    return "1 stage" if count == 1 else f"{count} stages"


def _names(result: StoredResult) -> Row:
    """Column titles: the stages."""
    if not result.scene.clearance_joints:
        return ("computed",) * len(result.document["stages"])
    return tuple(stage_name(stage["index"]) for stage in result.document["stages"])


def _by_stage(result: StoredResult, label: str, value: Callable[[int], str]) -> Row:
    return (label, *(value(k) for k in range(len(result.document["stages"]))))


def _number(data: Mapping[str, Any], *path: str) -> float | None:
    """A number inside nested data; None where a stage that failed early has none."""
    found: Any = data
    for key in path:
        found = found.get(key) if isinstance(found, Mapping) else None
    return None if found is None else float(found)


def _scaled(value: float | None, factor: float) -> float | None:
    return None if value is None else factor * value


def modelled(result: StoredResult) -> list[str]:
    """What was modelled, with the stages that share it."""
    models: dict[str, list[str]] = {}
    for name, stage in zip(_names(result), result.document["stages"], strict=True):
        models.setdefault(str(stage["diagnostics"].get("model", "not stated")), []).append(name)
    if len(models) == 1:
        return list(models)
    return [f"{', '.join(names)}: {model}" for model, names in models.items()]


def key_numbers(result: StoredResult) -> Table:
    """Peaks, wear and contact of every stage."""

    def statistic(label: str, factor: float, digits: int, *path: str) -> Row:
        return _by_stage(
            result,
            label,
            lambda k: readable(_scaled(_number(result.statistics(k), *path), factor), digits),
        )

    def count(label: str, *path: str) -> Row:
        return _by_stage(result, label, lambda k: whole(_number(result.statistics(k), *path)))

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
            *_wear_rows(result, joint),
            statistic("one more wear: volume (mm³)", CUBIC_MILLIMETRES, 3, *own, "wear_volume_m3"),
            statistic("time in contact (%)", 100.0, 3, *own, "part_of_time_in_contact"),
            count("contacts", *own, "contacts"),
            count("fewest steps in a contact", *own, "fewest_steps_in_a_contact"),
        ]
        groups.append((f"Joint {joint}", tuple(rows)))
    return Table(("", *_names(result)), tuple(groups))


def _wear_rows(result: StoredResult, joint: str) -> list[Row]:
    """Deepest wear that each stage ran on, and that one wear after it adds."""
    rows = []
    parts = {side: (side,) for side in SIDES} if maps_turn(result) else {"bearing + pin": SIDES}
    for kind, text in (("depth", "deepest wear it ran on"), ("wear", "one more wear: deepest")):
        for part, sides in parts.items():

            def peak(k: int, kind: str = kind, sides: tuple[str, ...] = sides) -> str:
                arrays = result.stages[k]
                depth = np.sum([arrays[f"{joint}_{kind}_{side}"] for side in sides], axis=0)
                if not np.any(depth > 0.0):
                    return "0"
                angle = float(np.degrees(arrays["angle"][int(depth.argmax())]))
                return f"{readable(MICRONS * float(depth.max()))}\u00a0at\u00a0{angle:.1f}°"

            rows.append(_by_stage(result, f"{text}, {part} (µm)", peak))
    return rows


def cycle_means(result: StoredResult) -> Table:
    """Means over cycles with the half widths of their 95 % intervals."""

    def mean(label: str, factor: float, *path: str) -> Row:
        def text(k: int) -> str:
            found = result.statistics(k)
            return with_interval(
                _scaled(_number(found, *path, "mean"), factor),
                _scaled(_number(found, *path, "half_width"), factor),
            )

        return _by_stage(result, label, text)

    slider = (
        mean("highest displacement (mm)", MILLI, "slider", "displacement_max_per_cycle_m"),
        mean("highest velocity (m/s)", 1.0, "slider", "velocity_max_per_cycle_m_s"),
        mean("largest acceleration (m/s²)", 1.0, "slider", "acceleration_max_per_cycle_m_s2"),
        _by_stage(
            result,
            "cycles in the means",
            lambda k: whole(
                _number(result.statistics(k), "slider", "displacement_max_per_cycle_m", "cycles")
            ),
        ),
    )
    joints = [
        (
            f"Joint {joint}",
            (
                mean("largest normal force (N)", 1.0, "joints", joint, "force_max_per_cycle_N"),
                mean("force times slip (N m)", 1.0, "joints", joint, "dose_per_cycle_Nm"),
            ),
        )
        for joint in result.scene.clearance_joints
    ]
    return Table(("mean over cycles", *_names(result)), (("Slider", slider), *joints))


def endings(result: StoredResult) -> Table:
    """How each stage ended and how well its wear maps are known."""
    rows = []
    for k, (name, stage) in enumerate(zip(_names(result), result.document["stages"], strict=True)):
        found = result.statistics(k)
        errors = [
            error
            for joint in result.scene.clearance_joints
            if (error := _number(found, "joints", joint, "wear_map_error")) is not None
        ]
        ended = {
            "completed": "ran all its cycles",
            "enough": "ended early: its wear maps are known to the tolerance",
            "failed": f"failed: {stage['message']}",
        }.get(stage["status"], stage["status"])
        rows.append(
            (
                name,
                ended,
                whole(found.get("cycles")),
                f"{readable(100.0 * max(errors), 2)} %" if errors else "–",
                readable(stage["amplification"]) if errors else "–",
                readable(stage["simulated_s"]),
                readable(stage["wall_s"]),
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


def notes(result: StoredResult) -> list[str]:
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
    if len(result.stages) > 1:
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
        if scene.conventions.footprint == "bin":
            found.append(
                "All wear of a moment goes into one bin of the map, as in the paper. Depth and "
                "volume then scale with the width of the bins, here "
                f"{360 / scene.bearings.angles:g}°."
            )
    return found


def _value(setting: Setting) -> str:
    if setting.value is None:
        return "none"
    return given(setting.value) if isinstance(setting.value, int | float) else str(setting.value)


def _origin(setting: Setting) -> tuple[str, str]:
    """Unit and status of a setting; a choice has its allowed words instead."""
    meaning = setting.meaning
    if isinstance(meaning, Choice):
        return "", f"one of {', '.join(meaning.words)}"
    return meaning.unit.replace("^2", "²"), meaning.status


def parameters(result: StoredResult) -> Table:
    """Every value that a person can set, but the conventions."""
    apart = {item.name for item in fields(Conventions)}
    rows = tuple(
        (setting.key, _value(setting), *_origin(setting), setting.meaning.text)
        for setting in settings_of(result.scene)
        if setting.key not in apart
    )
    return Table(("key", "value", "unit", "status", "meaning"), (("", rows),), numeric=False)


def convention_set(chosen: Conventions) -> str:
    """Name of a set of conventions."""
    for name, preset in CONVENTIONS.items():
        if chosen == preset:
            return f"the “{name}” set"
    return "a set of its own"


def conventions(result: StoredResult) -> Table:
    """Each convention, its choice and what it decides."""
    apart = {item.name for item in fields(Conventions)}
    rows = tuple(
        (setting.key, _value(setting), " or ".join(setting.meaning.words), setting.meaning.text)
        for setting in settings_of(result.scene)
        if setting.key in apart and isinstance(setting.meaning, Choice)
    )
    head = ("convention", "chosen", "can be", "which means, in that order")
    return Table(head, (("", rows),), numeric=False)


def provenance(result: StoredResult) -> Table:
    """Where the numbers come from."""
    document = result.document
    origin = document["provenance"]
    packages = ", ".join(f"{name} {number}" for name, number in origin["packages"].items())
    rows = (
        ("engine", document["engine"]),
        ("source revision", origin["revision"]),
        ("packages", packages),
        ("Python", origin["python"]),
        ("machine", origin["machine"]),
        ("started", origin["started"]),
        ("wall time", f"{readable(document['wall_s'])} s"),
        ("schema of the result", str(document["schema"])),
    )
    return Table(("", ""), (("", rows),), numeric=False)


def diagnostics(result: StoredResult) -> Table:
    """What the solver says of each stage."""
    stages = [stage["diagnostics"] for stage in result.document["stages"]]
    keys = dict.fromkeys(key for stage in stages for key in stage if key != "model")
    rows = tuple(
        (_spelled(key), *(_diagnostic(stage.get(key)) for stage in stages)) for key in keys
    )
    return Table(("", *_names(result)), (("", rows),))


def _spelled(key: str) -> str:
    words = key.replace("_", " ")
    return f"{words[:-2]} (s)" if key.endswith("_s") else words


def _diagnostic(value: float | int | str | None) -> str:
    if isinstance(value, str):
        return value
    return whole(value) if isinstance(value, int) else readable(value)
