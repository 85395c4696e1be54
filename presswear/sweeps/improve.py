"""Effects of changed joints on life, peak force and bottom dead centre of a mechanism.

The unchanged mechanism is run, and then the mechanism with each change. A change
concerns one property of one joint. The report has bars that start at 1, and tables.
"""

import shlex
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.patches import Patch

from presswear.campaign.runs import run_scenes
from presswear.linkage.materials import MATERIALS, Materials
from presswear.recording.statistics.estimate import Estimate, greatest, ratio
from presswear.results.frame_load import frame_loads
from presswear.results.guide_tilt import guide_tilts
from presswear.results.motor_load import leader_speed
from presswear.results.result import Result
from presswear.scene.catalog import title_of
from presswear.scene.scene import Scene
from presswear.scene.settings import changed
from presswear.show import page
from presswear.show.figures import style
from presswear.show.figures.style import SETTINGS, Drawing
from presswear.show.page import NOTHING, Section, plain_table
from presswear.show.stroke_numbers import NEGLIGIBLE
from presswear.tools.errors import InputError, RunFailed
from presswear.tools.files import inside, name_for, write_bytes
from presswear.tools.numbers import large, percent, quantity_text, readable

CLEARANCE_FACTOR = 0.5  # changed over present clearance of a joint
SIZE_FACTOR = 1.25  # changed over present radius and width of a bearing
LIFE = "life"
FORCE = "peak force"
BOTTOM = "error of bottom dead centre"
TILT = "tilt of the slide"
DROP = "drop of the speed by the work"
REVERSE = "reverse force of the frame over its greatest force"
PLAIN = "as it is"
SHOWN = 10  # largest number of changes in a panel of the figure
# Least distance of a whole interval from 1; a smaller factor is printed as 1.00
MIN_EFFECT = 0.005
# Least range of the axis on both sides of 1, so that a per cent is not a long bar
LEAST_RANGE = 0.1
REPORT = "report.html"
_HEAD = ("change", "factor", "95 % interval", "verdict")
BAR = 0.28  # height of a bar with its gap, inches
# Colour of a change that certainly improves a quantity
CERTAIN_COLOUR = style.LINES[2][0]


@dataclass(frozen=True)
class Effect:
    """Factor by which a change multiplies a quantity, with its 95 % interval."""

    change: str
    factor: Estimate
    # whether the whole interval lies on the good side of 1, by more than MIN_EFFECT
    is_better: bool

    @property
    def interval(self) -> tuple[float, float] | None:
        """Ends of the interval of the factor; None: unknown."""
        if self.factor.low is None or self.factor.high is None:
            return None
        return self.factor.low, self.factor.high

    @property
    def verdict(self) -> str:
        """Verdict on the change, by the interval of its factor."""
        if self.is_better:
            return "certain improvement"
        if self.interval is None:
            return "not certain"
        low, high = self.interval
        if low > 1.0 + MIN_EFFECT or high < 1.0 - MIN_EFFECT:
            return "certainly worse"
        if low > 1.0 - MIN_EFFECT and high < 1.0 + MIN_EFFECT:
            return "no effect"
        return "not certain"

    def __str__(self) -> str:
        text = f"{self.change}: {self.factor.mean:.2f}"
        if self.interval is None:
            return text
        low, high = self.interval
        return f"{text} ({low:.2f} to {high:.2f})"


@dataclass(frozen=True)
class Improvement:
    """Effects of the changes by quantity, the best first; errors of failed runs by change."""

    effects: dict[str, list[Effect]]
    failures: dict[str, str]
    present: dict[str, str] = field(default_factory=dict)  # values as it is, in words

    def heading(self, key: str) -> str:
        """Return the name of a quantity with its present value."""
        now = f", now {self.present[key]}" if key in self.present else ""
        return f"factor on the {key}{now}"

    @property
    def sentences(self) -> list[str]:
        """A sentence for each quantity: the best change, or that none improves it."""
        lines = []
        changes = list(self.failures)
        for key, effects in self.effects.items():
            changes += [effect.change for effect in effects]
            best = next((effect for effect in effects if effect.is_better), None)
            if best is None:
                lines.append(f"{key}: no tried change improves it beyond its interval")
            else:
                lines.append(f"{key}: best is {best} times the present value")
        if not any("materials" in change for change in changes):
            lines.append("materials: no listed pair wears less than the present one")
        return lines

    def draw(self) -> Drawing:
        """Draw the factors of the best changes as bars from 1, with their intervals."""
        rows = max(min(len(effects), SHOWN) for effects in self.effects.values())
        height = len(self.effects) * (0.8 + BAR * rows)
        with rc_context(SETTINGS):
            sheet, grid = style.panels(len(self.effects), 1, height)
            for (axes,), key in zip(grid, self.effects, strict=True):
                _draw_factors(axes, self.effects[key][:SHOWN])
                axes.set_xlabel(self.heading(key))
            handles = [
                Patch(color=CERTAIN_COLOUR, label="certain improvement"),
                Patch(color=style.MUTED, label="no certain improvement"),
            ]
            sheet.legend(handles=handles, loc="outside upper center", ncols=2)
            (drawing,) = style.finished("improve", sheet)
            return drawing


def _draw_factors(axes: Axes, effects: list[Effect]) -> None:
    """Draw the factor of each change as a bar from 1, with its interval."""
    rows = range(len(effects))
    for row, effect in enumerate(effects):
        colour = CERTAIN_COLOUR if effect.is_better else style.MUTED
        axes.barh(row, effect.factor.mean - 1.0, left=1.0, color=colour)
        if effect.interval:
            axes.plot(effect.interval, [row, row], color="black")
    left, right = axes.get_xlim()
    axes.set_xlim(min(left, 1.0 - LEAST_RANGE), max(right, 1.0 + LEAST_RANGE))
    axes.axvline(1.0, color=style.REFERENCE, linestyle="dotted")
    axes.set_yticks(rows, [effect.change for effect in effects])
    axes.invert_yaxis()


def changes_of(scene: Scene) -> dict[str, dict[str, Any]]:
    """Return the settings that are tried, by change; `InputError` if no joint has clearance."""
    guides = [guide.name for guide in scene.loose_guides]
    if not (scene.loose_pins or guides):
        raise InputError(
            f"{scene.name}: no joint has clearance, so none can be improved"
        )
    changes: dict[str, dict[str, Any]] = {}
    for name in (*scene.loose_pins, *guides):
        bearing = scene.bearing(name)
        label = f"joint {name}, clearance times {CLEARANCE_FACTOR:g}"
        clearance = CLEARANCE_FACTOR * bearing.clearance
        changes[label] = {f"{name}.clearance": clearance}
        is_guide = name in guides
        sizes = {f"{name}.width": SIZE_FACTOR * bearing.width}
        words = "width"
        if not is_guide:
            radius = SIZE_FACTOR * bearing.bearing_radius
            sizes[f"{name}.bearing_radius"] = radius
            words = "radius and width"
        changes[f"joint {name}, {words} times {SIZE_FACTOR:g}"] = sizes
        present = _coefficient_of_worse_side(bearing.materials, is_guide)
        for materials, pair in MATERIALS.items():
            if _coefficient_of_worse_side(pair, is_guide) < present:
                label = f"joint {name}, materials {materials}"
                changes[label] = {f"{name}.materials": materials}
    return changes


def _coefficient_of_worse_side(pair: Materials, is_guide: bool) -> float:
    """Return the wear coefficient of the side that wears more, 1/Pa.

    In a guide only the wall wears.
    """
    share = max(pair.bearing_share, 1.0 - pair.bearing_share)
    return pair.wear_coefficient * (1.0 if is_guide else share)


def improve(
    scene: Scene,
    folder: Path,
    jobs: int | None = None,
    on_progress: Callable[[str, float, str], object] = lambda name, share, words: None,
) -> Improvement:
    """Run a mechanism unchanged and with each change, and return the effects of the changes.

    Each run has one wear update of the same number of strokes, and no service life. The
    other parameters are those of `run_scenes`.

    Raises
    ------
    InputError
        If no joint has clearance, or a change does not fit the mechanism.
    RunFailed
        If the run of the unchanged mechanism fails.
    """
    scene = replace(scene, life=None, wear_updates=1)
    changes = changes_of(scene)
    for values in ({}, *changes.values()):
        changed(scene, values).check()

    def run_all(scenes: dict[str, Scene]) -> dict[str, Result]:
        named = {name_for(change): scene for change, scene in scenes.items()}
        results = run_scenes(named, folder, jobs=jobs, on_progress=on_progress)
        return dict(zip(scenes, results.values(), strict=True))

    unchanged = run_all({PLAIN: scene})[PLAIN]
    if unchanged.status == "failed":
        raise RunFailed(f"the mechanism {PLAIN}: {unchanged.message}")
    # Every change is compared after the same strokes, however much the joints wear.
    strokes = unchanged.stages[0].cycles_per_update
    scene = replace(scene, cycles_per_update=strokes)
    scenes = {change: changed(scene, values) for change, values in changes.items()}
    results = run_all(scenes)
    failures = {}
    quantities = {}
    for change, result in results.items():
        if result.status == "failed":
            failures[change] = result.message
        else:
            quantities[change] = _quantities(result)
    present = _quantities(unchanged)
    texts = {}
    for key, value in present.items():
        text = _text_of(key, value.mean)
        if text:
            texts[key] = f"{text} after {large(strokes)} strokes"
    return Improvement(_effects(present, quantities), failures, texts)


def _effects(
    present: dict[str, Estimate], quantities: dict[str, dict[str, Estimate]]
) -> dict[str, list[Effect]]:
    """Return the effects by quantity, the best first; ``quantities`` are by change."""
    effects: dict[str, list[Effect]] = {key: [] for key in present}
    for change, values in quantities.items():
        for key in effects.keys() & values.keys():
            effects[key].append(_effect(change, key, values[key], present[key]))
    for key in effects:
        effects[key].sort(key=lambda effect: effect.factor.mean, reverse=key == LIFE)
        # Factors without an interval are the last.
        effects[key].sort(key=lambda effect: effect.factor.low is None)
    return effects


def _text_of(key: str, value: float) -> str:
    """Return a quantity in words; nothing for the wear rate, which stands for the life."""
    if key == FORCE:
        return quantity_text(value, "N")
    if key == BOTTOM:
        return quantity_text(value, "m")
    if key == TILT:
        return f"{readable(1e6 * value)} µm/m"
    return "" if key == LIFE else percent(value)


def _quantities(result: Result) -> dict[str, Estimate]:
    """Return the quantities after the wear update.

    The life is represented by the wear depth of a stroke, to which it is inversely
    proportional. Quantities that the mechanism does not have, or that are 0, are omitted.
    """
    scene = result.scene
    stage = result.stages[-1]
    joints = stage.statistics.joints
    bottom = stage.statistics.bdc
    tilts = guide_tilts(scene, stage).values()
    speed = leader_speed(scene, stage)
    forces = [joints[name].peak_force_per_cycle for name in scene.loose_pins]
    forces += [tilt.corner_force for tilt in tilts if tilt.corner_force]
    frames = frame_loads(scene, stage).values()
    is_off_bottom = bottom is not None and abs(bottom.error.mean) > NEGLIGIBLE
    working_tilts = [tilt.working for tilt in tilts if tilt.working]
    reverse = [load.reverse_fraction for load in frames if load.reverse_fraction]
    quantities = {
        LIFE: greatest(_depths_per_stroke(result)),
        FORCE: greatest(forces),
        BOTTOM: bottom.error if bottom and is_off_bottom else None,
        TILT: greatest(working_tilts),
        DROP: speed.drop if speed else None,
        REVERSE: greatest(reverse),
    }
    return {
        key: value
        for key, value in quantities.items()
        if value is not None and value.mean
    }


def _depths_per_stroke(result: Result) -> list[Estimate]:
    """Return the depths that a stroke wears off each side of the pins, and off each wall, m."""
    first = result.stages[0]
    statistics = first.statistics
    per_stroke = 1.0 / first.cycles_per_update
    depths = []
    for name in result.scene.loose_pins:
        for side, peak in statistics.joints[name].wear_peaks.items():
            if side != "both":
                depths.append(peak.depth.scaled(per_stroke))
    for walls in statistics.walls.values():
        depths += [wall.depth_per_cycle for wall in walls.values()]
    return depths


def _effect(change: str, key: str, value: Estimate, present: Estimate) -> Effect:
    """Return the factor by which a change multiplies a quantity, and if that is an improvement."""
    if key == LIFE:  # inversely proportional to the depth of a stroke
        factor = ratio(present, value)
        is_better = factor.low is not None and factor.low > 1.0 + MIN_EFFECT
    else:
        factor = ratio(value, present)
        is_better = factor.high is not None and factor.high < 1.0 - MIN_EFFECT
    return Effect(change, factor, is_better)


def write_report(improvement: Improvement, scene: Scene, folder: Path) -> Path:
    """Write ``report.html`` and its figure into the folder of an improvement; return the page."""
    figures = page.illustrated([improvement.draw()], inside(folder, "figures"))
    sections = [Section("Factors on each quantity", figures=figures, is_open=True)]
    for quantity, effects in improvement.effects.items():
        sections.append(_section(improvement.heading(quantity), effects, folder))
    if improvement.failures:
        rows = improvement.failures.items()
        table = plain_table(("change", "reason"), rows, numeric=False)
        sections.append(Section("Runs that failed", tables=[("", table)]))
    text = page.render_page(
        f"{title_of(scene)}: changes of one joint at a time",
        page.FirstScreen(),
        sections,
        answer=[f"{_capitalized(text)}." for text in improvement.sentences],
    )
    file = folder / REPORT
    write_bytes(file, text.encode())
    return file


def _capitalized(text: str) -> str:
    return text[:1].upper() + text[1:]


def _section(heading: str, effects: list[Effect], folder: Path) -> Section:
    """Return the section of a quantity, with the command that compares the first change."""
    rows = []
    for effect in effects:
        interval = NOTHING
        if effect.interval:
            interval = " to ".join(map(readable, effect.interval))
        factor = readable(effect.factor.mean)
        rows.append((effect.change, factor, interval, effect.verdict))
    table = plain_table(_HEAD, rows, numeric=False)
    notes = []
    if effects:
        plain = shlex.quote(f"{folder / name_for(PLAIN)}")
        changed = shlex.quote(f"{folder / name_for(effects[0].change)}")
        command = f"presswear report {plain} {changed}"
        notes.append(f"Side by side with the first change: {command}")
    return Section(_capitalized(heading), tables=[("", table)], notes=notes)
