"""Improvement of a mechanism: what changes of joints do to life, force and bottom dead centre.

Each joint is changed in one way at a time, and every change is run like the mechanism as it is.
"""

import json
import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

from matplotlib import rc_context

from presswear.linkage.laws import MATERIALS
from presswear.recording.statistics import Estimate
from presswear.results.folder import program_digest
from presswear.scene.scene import Scene
from presswear.scene.settings import changed
from presswear.show.figures import style
from presswear.show.figures.style import SETTINGS, Drawing
from presswear.sweeps import runner
from presswear.sweeps.responses import request
from presswear.tools.errors import InputError, RunFailed
from presswear.tools.files import digest

CLEARANCE, SIZE = 0.5, 1.25  # factors on the clearance, and on radius and width of a bearing
LIFE, FORCE, BOTTOM = "life", "peak force", "error of bottom dead centre"
SHOWN = 10  # changes in a panel of the figure, the best first
BAR = 0.28  # height of a bar with its gap, inches


@dataclass(frozen=True)
class Change:
    """Change of a joint, in words and in settings; no joint: the mechanism as it is."""

    joint: str
    words: str
    settings: dict[str, float | str]

    @property
    def label(self) -> str:
        """Joint and change in words."""
        return f"joint {self.joint}, {self.words}"


@dataclass(frozen=True)
class Effect:
    """Factor by which a change multiplies a quantity, with its 95 % interval."""

    change: Change
    factor: Estimate
    is_better: bool  # whether the interval excludes no change, on the good side

    def __str__(self) -> str:
        low, high = self.factor.low, self.factor.high
        interval = "" if low is None or high is None else f" ({low:.2f} to {high:.2f})"
        return f"{self.change.label}: {self.factor.mean:.2f}{interval}"


@dataclass(frozen=True)
class Improvement:
    """Effects of the changes by quantity, the best first; errors of failed runs by change."""

    effects: dict[str, list[Effect]]
    failures: dict[str, str]

    @property
    def sentences(self) -> list[str]:
        """A sentence for each quantity: the best change, or that none is certain."""
        lines = []
        for key, items in self.effects.items():
            best = next((item for item in items if item.is_better), None)
            if best is None:
                lines.append(f"{key}: no change of a single joint is certain to improve it")
            else:
                lines.append(f"{key}: best is {best} times the present value")
        return lines

    def draw(self) -> Drawing:
        """Draw the factors of the best changes as bars with their intervals."""
        most = max(min(len(items), SHOWN) for items in self.effects.values())
        height = len(self.effects) * (0.8 + BAR * most)
        with rc_context(SETTINGS):
            sheet, grid = style.panels(len(self.effects), 1, height, layout="constrained")
            for (axes,), (key, items) in zip(grid, self.effects.items(), strict=True):
                shown = items[:SHOWN]
                colours = [style.LINES[2][0] if one.is_better else style.MUTED for one in shown]
                axes.barh(range(len(shown)), [one.factor.mean for one in shown], color=colours)
                for place, one in enumerate(shown):
                    if one.factor.low is not None and one.factor.high is not None:
                        axes.plot([one.factor.low, one.factor.high], [place] * 2, color="black")
                axes.axvline(1.0, color=style.REFERENCE, linestyle="dotted")
                axes.set_yticks(range(len(shown)), [one.change.label for one in shown])
                axes.invert_yaxis()
                axes.set_xlabel(f"{key}, factor")
            return style.finished("improve", sheet)[0]


def changes_of(scene: Scene) -> list[Change]:
    """Return the changes that are tried; `InputError` if no joint has clearance."""
    if not scene.clearance_joints:
        raise InputError(f"{scene.name}: no joint has clearance, so none can be improved")
    changes = []
    for name in scene.clearance_joints:
        bearing = scene.bearing(name)
        smaller = {f"{name}.clearance": CLEARANCE * bearing.clearance}
        keys = ("bearing_radius", "width")
        larger = {f"{name}.{key}": SIZE * getattr(bearing, key) for key in keys}
        changes.append(Change(name, f"clearance times {CLEARANCE:g}", {**smaller}))
        changes.append(Change(name, f"radius and width times {SIZE:g}", {**larger}))
        for word, pair in MATERIALS.items():
            if pair != bearing.materials:
                changes.append(Change(name, f"materials {word}", {f"{name}.materials": word}))
    return changes


def improve(
    scene: Scene,
    folder: Path,
    jobs: int | None = None,
    on_progress: Callable[[runner.Progress], object] = lambda progress: None,
) -> Improvement:
    """Run the mechanism as it is and with each change; return the effects of the changes.

    Parameters
    ----------
    scene : Scene
        At least one wear update is run; a service life is not.
    folder : Path
        Runs that it holds are not repeated.

    Raises
    ------
    InputError
        If no joint has clearance, or a change does not fit the mechanism.
    RunFailed
        If the mechanism as it is cannot be run.
    """
    scene = replace(scene, life=None, wear_updates=1)
    changes = [Change("", "as it is", {}), *changes_of(scene)]
    scenes = [changed(scene, change.settings) for change in changes]
    program, names = program_digest(), []
    for one in scenes:
        one.check()
        names.append(digest(json.dumps([one.as_dict(), program], sort_keys=True).encode()))
    requested = request(scene)
    makers = {name: partial(lambda one: one, one) for name, one in zip(names, scenes, strict=True)}
    folder.mkdir(parents=True, exist_ok=True)
    with runner.open_executor("", jobs) as (executor, slots):
        runner.run_rows(folder, makers, requested, executor, slots, on_progress=on_progress)
    plain, *others = (runner.read_row(folder, name) or runner.Outcome() for name in names)
    if plain.error:
        raise RunFailed(f"the mechanism as it is: {plain.error}")
    before = _quantities(scene, plain)
    effects: dict[str, list[Effect]] = {key: [] for key in before}
    for change, outcome in zip(changes[1:], others, strict=True):
        for key, value in _quantities(scene, outcome).items():
            if key in effects:
                effects[key].append(_effect(change, key, value, before[key]))
    for key, items in effects.items():
        items.sort(key=lambda item: item.factor.mean, reverse=key == LIFE)
    pairs = zip(changes[1:], others, strict=True)
    return Improvement(effects, {one.label: each.error for one, each in pairs if each.error})


def _quantities(scene: Scene, outcome: runner.Outcome) -> dict[str, Estimate]:
    """Return the quantities of a run; none if it failed.

    The life is that until a depth is reached: inversely proportional to the largest depth.
    """
    values_of: dict[str, Estimate] = {}
    for key, name in ((LIFE, "depth"), (FORCE, "force_max")):
        each = [outcome.response(f"{joint}.{name}@last") for joint in scene.clearance_joints]
        values = [(one.value, one.half_width) for one in each if one and one.value]
        if values:
            values_of[key] = Estimate.symmetric(*max(values))
    bottom = outcome.response("bdc_error@last")
    if bottom and bottom.value:
        values_of[BOTTOM] = Estimate.symmetric(abs(bottom.value), bottom.half_width)
    return values_of


def _effect(change: Change, key: str, value: Estimate, plain: Estimate) -> Effect:
    """Return the ratio of two independent numbers, with the interval of its logarithm."""
    if key == LIFE:
        value, plain = plain, value
    ratio = value.mean / plain.mean
    if value.half_width is None or plain.half_width is None:
        return Effect(change, Estimate(ratio), False)
    half = math.hypot(value.half_width / value.mean, plain.half_width / plain.mean)
    low, high = ratio * math.exp(-half), ratio * math.exp(half)
    return Effect(change, Estimate(ratio, low, high), low > 1.0 if key == LIFE else high < 1.0)
