"""Settings of the paper, and the cases under which they are run; the tables in ``settings.toml``.

Every setting runs with the standard geometry, with two others that fit the paper as
well, and with the refined conventions; one setting runs with all 200 cycles of each
replicate; and the first setting runs with one assumption changed at a time.
"""

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from importlib.resources import files
from typing import Any, NamedTuple

import presswear as pw

# Relative error of the wear maps of a setting, from all replicates together
TOLERANCE = 0.05
_COMMON: dict[str, Any] = {
    "tolerance": TOLERANCE,
    "purpose": "wear",
    "conventions": "paper",
}
QUICK_CYCLES = 4  # cycles of each stage and replicate in a quick run


def read(file: str) -> dict[str, Any]:
    """Return the data of a TOML file beside this module."""
    return tomllib.loads(files("presswear.paper").joinpath(file).read_text("utf-8"))


TABLES = read("settings.toml")


class Setting(NamedTuple):
    """Setting of the paper: its label, a short label, and the name of its scene."""

    label: str
    short: str
    scene: str


SETTINGS = {name: Setting(*row) for name, row in TABLES["settings"].items()}
WEAR, FRICTION, HIGH_FRICTION, SLOW, FAST = SETTINGS
JOINTS = ("A", "C")
STAGES = ("no wear", "first wear", "second wear", "third wear")


@dataclass(frozen=True)
class Case:
    """Assumptions under which some settings run."""

    label: str
    settings: tuple[str, ...] = tuple(SETTINGS)
    set: Mapping[str, Any] = field(default_factory=dict)  # settings of the scene
    # factors on properties of the materials, by name
    scale: Mapping[str, float] = field(default_factory=dict)
    # displacements of the second frame joint, m, by name of the coordinate
    move: Mapping[str, float] = field(default_factory=dict)
    finer: float = 1.0  # factor by which the tolerance of the engine is smaller
    # runs with Exudyn instead of dae, or with dae instead of Exudyn
    other_engine: bool = False
    wear_updates: int = 1  # largest number of wear updates
    replicates: int = 3  # the fewest with an interval
    tolerance_factor: float = 2.0  # on the relative error of the wear maps

    def change(self, scene: pw.Scene) -> pw.Scene:
        """Return a scene under the assumptions of the case."""
        settings = dict(self.set)
        if self.other_engine:
            settings["engine"] = "exudyn" if scene.engine == "dae" else "dae"
        for key, factor in self.scale.items():
            settings[key] = factor * getattr(scene.bearings.materials, key)
        for key, distance in self.move.items():
            assert isinstance(scene.mechanism, pw.Press)
            settings[key] = round(getattr(scene.mechanism.geometry, key) + distance, 9)
        finer = scene.solver.finer(self.finer)
        if self.finer > 1.0 and finer is not None:
            scene = replace(scene, numerics=scene.numerics.of(finer))
        return pw.changed(scene, settings)


SENSITIVITIES = {
    name: Case(settings=(WEAR,), **row) for name, row in TABLES["sensitivities"].items()
}
CASES = {name: Case(**row) for name, row in TABLES["cases"].items()} | SENSITIVITIES
BASE, *_, LONG = TABLES["cases"]  # names of the first and the last case
PAPER_STEP = "paper-step"
# Cases whose runs take the most time: Exudyn, 1,800 cycles, worn foundations
LONGEST = ("other-engine", LONG, "refined")
# Cases with all settings, in which every claim is judged
JUDGED = tuple(TABLES["cases"])[:-1]
GEOMETRIES = JUDGED[:-1]


def run_name(case: str, setting: str) -> str:
    """Return the name of the folder of a setting under a case."""
    return f"{case}--{setting}"


def run_label(name: str) -> str:
    """Return the label of a run from the name of its folder."""
    case, _, setting = name.partition("--")
    return f"{CASES[case].label}, {SETTINGS[setting].label}"


def base_scene(setting: str, **settings: Any) -> pw.Scene:
    """Return the scene of a setting, with further settings."""
    make = getattr(pw.scenes, SETTINGS[setting].scene)
    return make(**_COMMON | settings)


def make_scenes(engine: str | None = None, quick: bool = False) -> dict[str, pw.Scene]:
    """Return all scenes by the names of their folders; see ``run_paper``."""
    common: dict[str, Any] = {}
    if engine is not None:
        common["engine"] = engine
    if quick:
        common["cycles"] = QUICK_CYCLES
    scenes = {}
    for name, case in CASES.items():
        for setting in case.settings:
            scene = base_scene(setting, **common)
            scene = replace(
                scene,
                tolerance=TOLERANCE * case.tolerance_factor,
                wear_updates=min(scene.wear_updates, case.wear_updates),
                replicates=case.replicates,
            )
            scenes[run_name(name, setting)] = case.change(scene)
    return scenes
