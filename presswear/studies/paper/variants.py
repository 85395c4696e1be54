"""What the study ``paper`` runs.

Five settings of the paper, each from several starts; the same under other geometries and
under the refined conventions; once over the full 200 cycles; and the first setting with
one chosen thing changed at a time.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

from presswear.campaign.study import Change, Study, Variant, unchanged
from presswear.scene.catalog import friction, friction_high, speed, speed_high, wear_times
from presswear.scene.scene import CONVENTIONS, Scene
from presswear.scene.settings import changed

STARTS = 3
"""Starts of each run of the paper's own settings, 1e-9 m apart."""
TOLERANCE = 0.05
"""How well the wear maps of a setting are to be known from all its starts together."""

SETTINGS: dict[str, tuple[str, Callable[[], Scene]]] = {
    "wear-times": ("3.5π rad/s, 0.8 mm, c_f 0.02", wear_times),
    "friction-0.05": ("6π rad/s, 0.6 mm, c_f 0.05", friction),
    "friction-0.1": ("6π rad/s, 0.6 mm, c_f 0.1", friction_high),
    "speed-4pi": ("4π rad/s, 0.8 mm, c_f 0.03", speed),
    "speed-8pi": ("8π rad/s, 0.8 mm, c_f 0.03", speed_high),
}
"""The paper's settings: label and scene by key."""

BASE = "standard"
GEOMETRIES = (BASE, "swapped", "lifted")
REFINED = "refined"
LONG = "200-cycles"
LONG_SETTINGS = ("speed-8pi",)
"""Of all settings the one whose 200 cycles are soonest run."""
PAPER_STEP = "paper-step"
OTHER_ENGINE = "other-engine"


@dataclass(frozen=True)
class Case:
    """A way of running some of the settings.

    Attributes
    ----------
    key, label : str
    settings : tuple of str
        Keys of SETTINGS.
    starts : int
    coarser : float
        The wear maps are known so many times worse than asked for.
    wears : int
        Most wears.
    change : callable
        Scene -> Scene.
    """

    key: str
    label: str
    settings: tuple[str, ...]
    starts: int
    coarser: float
    wears: int
    change: Change


def _with(**settings: str) -> Change:
    return lambda scene: changed(scene, settings)


def _other_engine(scene: Scene) -> Scene:
    return replace(scene, engine="exudyn" if scene.engine == "dae" else "dae")


def _all_cycles(scene: Scene) -> Scene:
    """As many cycles as the paper runs, whatever is known before."""
    return replace(scene, cycles=scene.most_cycles)


def _refined(scene: Scene) -> Scene:
    return replace(scene, conventions=CONVENTIONS["refined"])


def _finer(scene: Scene) -> Scene:
    """Steps a hundred times more accurate."""
    numerics = scene.numerics
    return replace(
        scene,
        numerics=numerics.having(
            tree_tolerance=numerics.tree.tree_tolerance / 100.0,
            integration_tolerance=numerics.dae.integration_tolerance / 100.0,
        ),
    )


def _scaled(key: str, factor: float) -> Change:
    """The wear coefficient times a factor."""

    def change(scene: Scene) -> Scene:
        value = scene.bearings.wear_coefficient * factor
        return changed(scene, {key: f"{value:.6g}/Pa"})

    return change


def _moved(key: str, by: float) -> Change:
    """A length of the frame moved by so many m."""

    def change(scene: Scene) -> Scene:
        assert hasattr(scene.mechanism, "geometry")
        value = getattr(scene.mechanism.geometry, key) + by
        return changed(scene, {key: f"{value:.9g}m"})

    return change


SENSITIVITIES: dict[str, tuple[str, Change]] = {
    "wear-half": ("K_d / b halved", _scaled("wear_coefficient", 0.5)),
    "wear-double": ("K_d / b doubled", _scaled("wear_coefficient", 2.0)),
    "hx-less": ("O2 5 mm to the left", _moved("hx", -5e-3)),
    "hx-more": ("O2 5 mm to the right", _moved("hx", 5e-3)),
    "hy-less": ("O2 5 mm lower", _moved("hy", -5e-3)),
    "hy-more": ("O2 5 mm higher", _moved("hy", 5e-3)),
    "weightless": ("no gravity", _with(gravity="0m/s^2")),
    "angles": ("720 angles instead of 360", _with(angles="720")),
    "half-wear": (
        "a wear of 2 million cycles, as the paper's text says",
        _with(represented_cycles="2e6"),
    ),
    "stiffness": ("refined stiffness (R_i − R_j)", _with(stiffness="refined")),
    "slip": ("slip is true sliding", _with(slip="sliding")),
    "map-frame": ("wear maps turn with the bodies", _with(map_frame="body")),
    "footprint": ("wear over the contact arc, in steps", _with(footprint="arc")),
    "contact": ("worn surfaces meet on a foundation", _with(contact="foundation")),
    "steps": ("wear in steps", _with(extrapolation="steps")),
    "finer": ("steps 100 times more accurate", _finer),
    OTHER_ENGINE: ("the other engine", _other_engine),
    PAPER_STEP: (
        "the paper's own step, RK4 at 1e-4 s",
        _with(engine="dae", integrator="rk4-paper"),
    ),
}
"""One chosen thing changed in the first setting: label and change by key."""


def cases() -> tuple[Case, ...]:
    """All cases of the study, the paper's own first."""
    every = tuple(SETTINGS)
    first = every[:1]
    return (
        Case(BASE, "standard geometry", every, STARTS, 1.0, 2, unchanged),
        *(
            Case(name, f"{name} geometry", every, 1, 2.0, 2, _with(geometry=name))
            for name in GEOMETRIES[1:]
        ),
        Case(
            REFINED,
            "refined conventions",
            every,
            1,
            2.0,
            1,
            _refined,
        ),
        Case(LONG, "200 cycles", LONG_SETTINGS, 1, 1.0, 1, _all_cycles),
        *(
            Case(key, label, first, 1, 2.0, 1, change)
            for key, (label, change) in SENSITIVITIES.items()
        ),
    )


def variant_key(case: str, setting: str) -> str:
    """Name of the folder of one setting under a case."""
    return f"{case}--{setting}"


def base_scene(setting: str, change: Change = unchanged) -> Scene:
    """A setting as the study takes it, with a person's change.

    The steps are coarser than those of the scenes, by a tolerance of 1e-6: of chaotic motion
    only statistics are asked for here, and the study itself shows that finer steps do not
    move them (``finer``).
    """
    scene = SETTINGS[setting][1]()
    numerics = scene.numerics.having(
        tree_tolerance=1e-6, integrator="dopri5", integration_tolerance=1e-7
    )
    return change(replace(scene, tolerance=TOLERANCE, numerics=numerics))


def variants_of(case: Case, change: Change) -> list[Variant]:
    """The runs of a case."""
    found = []
    for setting in case.settings:
        scene = base_scene(setting, change)
        scene = replace(
            scene,
            tolerance=min(scene.tolerance * case.coarser, 1.0),
            wears=min(scene.wears, case.wears),
            starts=case.starts,
        )
        label = f"{case.label}, {SETTINGS[setting][0]}"
        found.append(Variant(variant_key(case.key, setting), label, case.change(scene)))
    return found


def make(change: Change = unchanged, some: tuple[Case, ...] | None = None) -> Study:
    """The study ``paper``, of all cases or of some."""
    return Study(
        "paper",
        "Chen, Tang and Gao's worn press, computed again",
        "Which numbers and claims of the paper hold when every contact is resolved and every "
        "peak is known for the draw that it is?",
        tuple(
            variant
            for case in (cases() if some is None else some)
            for variant in variants_of(case, change)
        ),
    )
