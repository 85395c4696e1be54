"""Report of a result folder: one HTML file that can be opened anywhere.

The sentences are in ``templates/report.html``, the tables in ``report_tables``.
"""

import math
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Any

from presswear.linkage.laws import DAMPINGS, KELVIN_VOIGT, delivered_restitution
from presswear.linkage.surface import SIDES
from presswear.physics.ideal import bottom_of
from presswear.results.folder import FINISHED
from presswear.results.life import LifeResult, span_of, words_of
from presswear.results.press_analysis import deep_contacts
from presswear.results.result import Result
from presswear.results.stage import StageResult
from presswear.scene.bearing import Bearing
from presswear.scene.catalog import named_scene, title_of
from presswear.scene.scene import Scene
from presswear.scene.settings import SET, settings_of
from presswear.show import report_tables as tables
from presswear.show.figures import NAMES, drawn
from presswear.show.figures.life import limit_text, services_done
from presswear.show.figures.style import stage_names
from presswear.show.page import Illustration, illustrated, render_page
from presswear.tools.errors import InputError
from presswear.tools.files import inside, write_bytes
from presswear.tools.numbers import quantity_text
from presswear.tools.quantities import Quantity


def write_report(result: Result) -> Path:
    """Draw the figures and write ``report.html`` into the folder of a result; return the page.

    Raises
    ------
    InputError
        If the result is in memory only.
    """
    if result.path is None:
        raise InputError(f"{result.scene.name} ran in memory: a report needs a folder")
    drawers = [partial(drawn, name, result, result.stages) for name in NAMES]
    # An ideal motion has few figures: starting processes would take longer than drawing.
    processes = None if result.scene.clearance_joints else 1
    figures = illustrated(drawers, inside(result.path, "figures"), processes)
    path = result.path / "report.html"
    write_bytes(path, render_report(result, figures).encode())
    return path


def render_report(result: Result, figures: Sequence[Illustration] = ()) -> str:
    """Return the report of a result as HTML, with some figures."""
    scene = result.scene
    stages = list(zip(stage_names(result, result.stages), result.stages, strict=True))
    content: dict[str, Any] = {
        "result": result,
        "scene": scene,
        "style": result.status if result.status in FINISHED else "unfinished",
        "base": named_scene(scene),
        "untrusted": [key for key, law in scene.user_laws.items() if not law.is_trusted],
        "stages": stages,
        "wear_error": _largest(result, "wear_error"),
        "step_error": _largest(result, "peak_force_step_error"),
        "moves": bottom_of(scene.ideal) is not None,
        "models": _models(stages),
        "chosen": [
            setting.key
            for setting in settings_of(scene)
            if isinstance(setting.meaning, Quantity)
            and setting.meaning.origin.startswith(("chosen", "assumed", SET))
        ],
        "deep_contacts": deep_contacts(scene, result.stages),
        "worn_sides": [
            f"{side} of {joint} {quantity_text(float(surface.depth.max()), 'm')}"
            for joint, pair in scene.surfaces.items()
            for side, surface in zip(SIDES, pair, strict=True)
            if surface.is_worn
        ],
        "laws": _normal_laws(scene),
        "created": [one.statistics.energy_made_fraction for _, one in stages if one.is_worn],
        "bearings": [scene.bearing(joint) for joint in scene.clearance_joints],
        "convention_set": tables.convention_set(scene.conventions),
        "tables": {
            **tables.stage_tables(result),
            "changes": tables.change_table(result),
            "drives": tables.drive_table(result),
            "growth": tables.growth_table(result),
            "motion": tables.motion_table(result),
            "parameters": tables.parameter_table(result),
            "conventions": tables.convention_table(result),
            "provenance": tables.provenance_table(result),
        },
        "life": result.life and _life(result, result.life),
    }
    return render_page(title_of(scene), (), figures, "report.html", **content)


def _largest(result: Result, name: str) -> float | None:
    values = (getattr(stage.statistics, name) for stage in result.stages)
    return max((value for value in values if value is not None), default=None)


def _models(stages: Sequence[tuple[str, StageResult]]) -> list[str]:
    """Return descriptions of the model, with the stages that share it if there are several."""
    names: dict[str, list[str]] = {}
    for name, stage in stages:
        names.setdefault(str(stage.diagnostics.get("model", "not stated")), []).append(name)
    several = len(names) > 1
    return [f"{', '.join(of)}: {model}" if several else model for model, of in names.items()]


def _normal_laws(scene: Scene) -> list[tuple[list[str], Bearing, str, float | None]]:
    """Return the joints that share a normal law, their bearing, its title and its restitution.

    The restitution is the one that the law delivers, not the one that it is set to; None for a
    law whose restitution is unknown.
    """
    groups: dict[Any, list[str]] = {}
    for joint in scene.clearance_joints:
        bearing = scene.bearing(joint)
        key = (bearing.normal_law, bearing.restitution, bearing.viscous_damping)
        groups.setdefault(key, []).append(joint)
    laws: list[tuple[list[str], Bearing, str, float | None]] = []
    for (law, restitution, _), joints in groups.items():
        is_open = not isinstance(law, str) or law == KELVIN_VOIGT
        damping = None if is_open else DAMPINGS[law]
        delivered = delivered_restitution(damping.factor(restitution)) if damping else None
        title = damping.title if damping else str(law)
        laws.append((joints, scene.bearing(joints[0]), title, delivered))
    return laws


def _life(result: Result, life: LifeResult) -> dict[str, Any]:
    """Return what the template reads on the service life of a result."""
    scene = result.scene
    first = life.first if life.ended == "limit" else None
    high = life.interval.high if first else None
    rivals = [
        words_of(limit.key)
        for limit in life.limits
        if high is not None
        and limit is not first
        and limit.strokes is not None
        and limit.strokes / math.exp(tables.limit_error(limit) or 0.0) <= high
    ]
    return {
        "result": life,
        "first": None if first is None else f"{words_of(first.key)} over {limit_text(first)}",
        "reached": [
            f"{words_of(one.key)} {quantity_text(one.last, one.unit)} of {limit_text(one)}"
            for one in life.limits
        ],
        "rate": 60.0 / scene.mechanism.period,
        "hours": life.hours(scene),
        "total": span_of(life.strokes, life.total_error),
        "scatter": max(scene.bearing(j).materials.wear_scatter for j in scene.clearance_joints),
        "rivals": rivals,
        "services": services_done(result),
        **tables.life_tables(scene, life),
    }
