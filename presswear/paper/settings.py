"""Settings of the paper, and the cases under which they are run.

Every setting runs with the standard geometry, with two others that fit the paper as well, and with
the refined conventions; one setting runs with all 200 cycles of each replicate; and the first
setting runs with one assumption changed at a time.
"""

import tomllib
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import partial
from importlib.resources import files
from typing import Any, NamedTuple

import presswear as pw

Change = Callable[[pw.Scene], pw.Scene]

REPLICATES = 4  # of the paper's own settings
FEW_REPLICATES = 3  # of every other run: the fewest with an interval
TOLERANCE = 0.05  # relative error of the wear maps of a setting, from all replicates together
_COMMON: dict[str, Any] = {"tolerance": TOLERANCE, "purpose": "wear", "conventions": "paper"}
QUICK_CYCLES = 4  # of each stage and replicate in a quick run


class Setting(NamedTuple):
    """Setting of the paper: its label, a short one, and the named scene."""

    label: str
    short: str
    make: Callable[..., pw.Scene]


WEAR, FRICTION, HIGH_FRICTION = "wear-times", "friction-0.05", "friction-0.1"
SLOW, FAST = "speed-4pi", "speed-8pi"
SETTINGS = {
    WEAR: Setting("3.5π rad/s, 0.8 mm, c_f 0.02", "3.5π", pw.scenes.wear_times),
    FRICTION: Setting("6π rad/s, 0.6 mm, c_f 0.05", "c_f 0.05", pw.scenes.friction),
    HIGH_FRICTION: Setting("6π rad/s, 0.6 mm, c_f 0.1", "c_f 0.1", pw.scenes.friction_high),
    SLOW: Setting("4π rad/s, 0.8 mm, c_f 0.03", "4π", pw.scenes.speed),
    FAST: Setting("8π rad/s, 0.8 mm, c_f 0.03", "8π", pw.scenes.speed_high),
}
JOINTS = ("A", "C")
STAGES = ("no wear", "first wear", "second wear", "third wear")

BASE, REFINED, LONG, PAPER_STEP = "standard", "refined", "200-cycles", "paper-step"
GEOMETRIES = (BASE, "swapped", "lifted")
JUDGED = (*GEOMETRIES, REFINED)  # cases with all settings, in which every claim is judged
LONG_SETTINGS = (FAST,)  # 200 cycles take the least time at this speed

TABLES: dict[str, Any] = tomllib.loads(
    files("presswear.paper").joinpath("settings.toml").read_text("utf-8")
)


def _changed(values: Mapping[str, Any], scene: pw.Scene) -> pw.Scene:
    """Return a scene with changed settings; see ``settings.toml``."""
    settings = dict(values.get("set", {}))
    for key, factor in values.get("scale", {}).items():
        settings[key] = factor * getattr(scene.bearings.materials, key)
    for key, distance in values.get("move", {}).items():
        assert isinstance(scene.mechanism, pw.Press)
        settings[key] = round(getattr(scene.mechanism.geometry, key) + distance, 9)
    return pw.changed(scene, settings)


def _with(**settings: Any) -> Change:
    return partial(_changed, {"set": settings})


def _finer_steps(scene: pw.Scene) -> pw.Scene:
    finer = scene.solver.finer(100.0)
    return scene if finer is None else replace(scene, numerics=scene.numerics.of(finer))


def _other_engine(scene: pw.Scene) -> pw.Scene:
    return replace(scene, engine="exudyn" if scene.engine == "dae" else "dae")


SENSITIVITIES: dict[str, tuple[str, Change]] = {
    name: (one["label"], partial(_changed, one)) for name, one in TABLES["sensitivities"].items()
}
SENSITIVITIES["finer"] = "steps 100 times more accurate", _finer_steps
SENSITIVITIES["other-engine"] = "the other engine", _other_engine


@dataclass(frozen=True)
class Case:
    """Assumptions under which some settings run."""

    name: str
    label: str
    settings: tuple[str, ...]  # keys of SETTINGS
    change: Change
    wear_updates: int = 1  # at most
    replicates: int = FEW_REPLICATES
    tolerance_factor: float = 2.0  # on the relative error of the wear maps


CASES = (
    Case(BASE, "standard geometry", tuple(SETTINGS), lambda scene: scene, 2, REPLICATES, 1.0),
    *(
        Case(name, f"{name} geometry", tuple(SETTINGS), _with(geometry=name), 2)
        for name in GEOMETRIES[1:]
    ),
    Case(
        *(REFINED, "refined conventions", tuple(SETTINGS)),
        _with(conventions="refined", wear_maps="raw"),
    ),
    Case(LONG, "200 cycles", LONG_SETTINGS, _with(cycles=200), tolerance_factor=1.0),
    *(Case(name, label, (WEAR,), change) for name, (label, change) in SENSITIVITIES.items()),
)


def run_name(case: str, setting: str) -> str:
    """Return the name of the folder of a setting under a case."""
    return f"{case}--{setting}"


def run_label(name: str) -> str:
    """Return the label of a run from the name of its folder."""
    case, _, setting = name.partition("--")
    label = next(one.label for one in CASES if one.name == case)
    return f"{label}, {SETTINGS[setting].label}"


def base_scene(setting: str, **settings: Any) -> pw.Scene:
    """Return the scene of a setting, with further settings."""
    return SETTINGS[setting].make(**_COMMON | settings)


def make_scenes(engine: str | None = None, quick: bool = False) -> dict[str, pw.Scene]:
    """Return all scenes by the names of their folders; see ``run_paper``."""
    common: dict[str, Any] = {} if engine is None else {"engine": engine}
    common |= {"cycles": QUICK_CYCLES} if quick else {}
    scenes = {}
    for case in CASES:
        for setting in case.settings:
            scene = base_scene(setting, **common)
            scene = replace(
                scene,
                tolerance=TOLERANCE * case.tolerance_factor,
                wear_updates=min(scene.wear_updates, case.wear_updates),
                replicates=case.replicates,
            )
            scenes[run_name(case.name, setting)] = case.change(scene)
    return scenes
