"""The runs of the study ``paper``.

Five settings of the paper, each from several starts; the same under other geometries and
under the refined conventions; once over the full 200 cycles; and the first setting with
one chosen thing changed at a time.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

from presswear.scene.bearing import CONVENTIONS
from presswear.scene.catalog import friction, friction_high, speed, speed_high, wear_times
from presswear.scene.scene import Scene
from presswear.scene.settings import changed

Change = Callable[[Scene], Scene]


def unchanged(scene: Scene) -> Scene:
    """Return the scene."""
    return scene


STARTS = 4
"""Starts of each run of the paper's own settings."""
FEW = 3
"""Starts of every other run: the fewest with an interval."""
TOLERANCE = 0.05
"""How well the wear maps of a setting are to be known from all its starts together."""


@dataclass(frozen=True)
class PaperScene:
    """A setting of the paper, its label for people, a shorter one, and its scene."""

    label: str
    short: str
    scene: Callable[[], Scene]


WEAR, FRICTION, HIGH_FRICTION = "wear-times", "friction-0.05", "friction-0.1"
SLOW, FAST = "speed-4pi", "speed-8pi"
SETTINGS = {
    WEAR: PaperScene("3.5π rad/s, 0.8 mm, c_f 0.02", "3.5π", wear_times),
    FRICTION: PaperScene("6π rad/s, 0.6 mm, c_f 0.05", "c_f 0.05", friction),
    HIGH_FRICTION: PaperScene("6π rad/s, 0.6 mm, c_f 0.1", "c_f 0.1", friction_high),
    SLOW: PaperScene("4π rad/s, 0.8 mm, c_f 0.03", "4π", speed),
    FAST: PaperScene("8π rad/s, 0.8 mm, c_f 0.03", "8π", speed_high),
}

BASE = "standard"
GEOMETRIES = (BASE, "swapped", "lifted")
REFINED = "refined"
JUDGED = (*GEOMETRIES, REFINED)
"""Cases of all settings, in which every claim is judged."""
LONG = "200-cycles"
LONG_SETTINGS = (FAST,)
"""Settings that also run all 200 cycles: of all the one where these take the least time."""
PAPER_STEP = "paper-step"


def _with(**settings: Any) -> Change:
    return lambda scene: changed(scene, settings)


def _finer(scene: Scene) -> Scene:
    """Make the steps a hundred times more accurate."""
    finer = scene.solver.finer(100.0)
    return scene if finer is None else replace(scene, numerics=scene.numerics.of(finer))


def _worn(factor: float) -> Change:
    """Multiply the wear coefficient."""
    return lambda scene: changed(
        scene, {"wear_coefficient": scene.bearings.materials.wear_coefficient * factor}
    )


def _moved(key: str, by: float) -> Change:
    """Move a length of the frame by so many m."""

    def change(scene: Scene) -> Scene:
        assert hasattr(scene.mechanism, "geometry")
        return changed(scene, {key: round(getattr(scene.mechanism.geometry, key) + by, 9)})

    return change


SENSITIVITIES: dict[str, tuple[str, Change]] = {
    "wear-half": ("K_d / b halved", _worn(0.5)),
    "wear-double": ("K_d / b doubled", _worn(2.0)),
    "hx-less": ("O2 5 mm to the left", _moved("hx", -5e-3)),
    "hx-more": ("O2 5 mm to the right", _moved("hx", 5e-3)),
    "hy-less": ("O2 5 mm lower", _moved("hy", -5e-3)),
    "hy-more": ("O2 5 mm higher", _moved("hy", 5e-3)),
    "weightless": ("no gravity", _with(gravity=0.0)),
    "angles": ("720 angles instead of 360", _with(angles=720)),
    "half-wear": (
        "a wear of 2 million cycles, as the paper's text says",
        _with(cycles_per_update=2e6),
    ),
    "stiffness": ("refined stiffness (R_i − R_j)", _with(stiffness="refined")),
    "slip": ("slip is true sliding", _with(slip="sliding")),
    "map-frame": ("wear maps turn with the bodies", _with(map_frame="body")),
    "wear_distribution": ("wear over the contact arc, in steps", _with(wear_distribution="arc")),
    "contact": ("worn surfaces meet on a foundation", _with(contact="foundation")),
    "steps": ("wear in steps", _with(extrapolation="steps")),
    "finer": ("steps 100 times more accurate", _finer),
    "other-engine": (
        "the other engine",
        lambda scene: replace(scene, engine="exudyn" if scene.engine == "dae" else "dae"),
    ),
    PAPER_STEP: (
        "the paper's own step, RK4 at 1e-4 s",
        _with(engine="dae", integrator="rk4-paper"),
    ),
}
"""One chosen thing changed in the first setting: label and change by key."""


@dataclass(frozen=True)
class PaperCase:
    """A way of running some of the settings.

    Attributes
    ----------
    settings : tuple of str
        Keys of SETTINGS.
    change : callable
        Scene -> Scene.
    wear_updates : int
        Most wears.
    coarser : float
        The wear maps are known so many times worse than asked for.
    """

    key: str
    label: str
    settings: tuple[str, ...]
    change: Change
    wear_updates: int = 1
    replicates: int = FEW
    coarser: float = 2.0


CASES = (
    PaperCase(BASE, "standard geometry", tuple(SETTINGS), unchanged, 2, STARTS, 1.0),
    *(
        PaperCase(name, f"{name} geometry", tuple(SETTINGS), _with(geometry=name), 2)
        for name in GEOMETRIES[1:]
    ),
    PaperCase(
        REFINED,
        "refined conventions",
        tuple(SETTINGS),
        lambda scene: replace(scene, conventions=CONVENTIONS["refined"]),
    ),
    PaperCase(
        LONG,
        "200 cycles",
        LONG_SETTINGS,
        lambda scene: replace(scene, cycles=scene.max_cycles),
        coarser=1.0,
    ),
    *(PaperCase(key, label, (WEAR,), change) for key, (label, change) in SENSITIVITIES.items()),
)
"""All cases of the study, the paper's own first."""


def variant_key(case: str, setting: str) -> str:
    """Name of the folder of one setting under a case."""
    return f"{case}--{setting}"


def base_scene(setting: str, change: Change = unchanged) -> Scene:
    """A setting as the study takes it, with a person's change."""
    return change(replace(SETTINGS[setting].scene(), tolerance=TOLERANCE, purpose="wear"))


def make_scenes(change: Change = unchanged) -> dict[str, Scene]:
    """Return the scenes of the study by the names of their folders."""
    scenes = {}
    for case in CASES:
        for setting in case.settings:
            scene = base_scene(setting, change)
            scene = replace(
                scene,
                tolerance=min(scene.tolerance * case.coarser, 1.0),
                wear_updates=min(scene.wear_updates, case.wear_updates),
                replicates=case.replicates,
            )
            scenes[variant_key(case.key, setting)] = case.change(scene)
    return scenes


def label_of(name: str) -> str:
    """Return the label of a run from the name of its folder."""
    case, _, setting = name.partition("--")
    label = next(own.label for own in CASES if own.key == case)
    return f"{label}, {SETTINGS[setting].label}"
