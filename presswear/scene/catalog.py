"""The named scenes, and titles of scenes that were changed."""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

from presswear.linkage.linkage import Linkage
from presswear.linkage.materials import Materials
from presswear.linkage.mechanism import LITERATURE
from presswear.linkage.mechanisms import SliderCrank, TwoPoint
from presswear.linkage.motor import Motor
from presswear.linkage.press import Press
from presswear.linkage.process import Blanking, Drawing
from presswear.linkage.servos import Dwell, Forming, Pendulum
from presswear.scene.bearing import Bearing
from presswear.scene.conventions import CONVENTIONS
from presswear.scene.differences import Change, changes_from
from presswear.scene.scene import Scene
from presswear.scene.setting_list import DEFAULT, IN_FILE
from presswear.scene.settings import changed
from presswear.tools.errors import unknown

_MAX_CHANGES = 4  # changes in a title; if there are more, the last counts the rest

Make = Callable[..., Scene]


@dataclass(frozen=True)
class Entry:
    """Named scene: its title, and the function that makes it."""

    title: str
    make: Make


SCENES: dict[str, Entry] = {}  # named scenes by name


def _named(name: str, title: str, base: Make = Scene, **changes: Any) -> Make:
    """Register a scene: a base scene with some fields changed.

    The returned function takes settings by key, as texts with units or numbers, SI, and
    the initial surfaces of the joints.
    """

    def make(*, surfaces: Any = None, **settings: Any) -> Scene:
        scene = replace(base(), name=name, title=title, **changes)
        scene = changed(scene, settings) if settings else scene
        return scene if surfaces is None else replace(scene, surfaces=surfaces)

    make.__name__ = name
    make.__doc__ = f"{title}; takes settings by key and initial surfaces."
    SCENES[name] = Entry(title, make)
    return make


_STUDY: dict[str, Any] = {  # choices of the scenes of the paper
    "conventions": replace(CONVENTIONS["paper"], wear_maps="smoothed"),
    "engine": "exudyn",
    "max_cycles": 200,
}
ideal = _named(
    "ideal",
    "The press without clearance, against the closed form",
    joints="none",
    wear_updates=0,
    cycles=2,
    **_STUDY,
)


def _paper(
    name: str,
    title: str,
    speed: float,
    clearance: float,
    friction: float,
    wear_updates: int = 1,
) -> Make:
    """Register a scene of the paper: crank speed in units of pi rad/s, clearance in m."""
    bearings = Bearing(clearance=clearance, friction=friction)
    mechanism = Press(speed=speed * math.pi)
    changes: dict[str, Any] = {"wear_updates": wear_updates, "cycles_per_update": 4e6}
    changes |= {"mechanism": mechanism, "bearings": bearings, **_STUDY}
    origins = dict.fromkeys(("cycles_per_update", "max_cycles"), "paper")
    origins |= dict.fromkeys(("clearance", "wear_updates"), "paper, per study")
    return _named(name, title, **changes, origins=origins)


wear_times = _paper(
    "wear-times",
    "Clearance at A and C, worn twice (paper, sections 5.3.1 and 5.4.1)",
    3.5,
    0.8e-3,
    0.02,
    wear_updates=2,
)
friction = _paper(
    "friction",
    "Friction 0.05 at 6 pi rad/s (paper, 5.3.2 and 5.4.2)",
    6.0,
    0.6e-3,
    0.05,
)
friction_high = _paper(
    "friction-0.1", "Friction 0.1, else as friction", 6.0, 0.6e-3, 0.1
)
speed = _paper(
    "speed", "Cranks at 4 pi rad/s (paper, 5.3.3 and 5.4.3)", 4.0, 0.8e-3, 0.03
)
speed_high = _paper(
    "speed-8pi", "Cranks at 8 pi rad/s, else as speed", 8.0, 0.8e-3, 0.03
)
clearance_a = _named(
    "clearance-a",
    "The press with clearance at A alone",
    wear_times,
    joints="A",
    wear_updates=0,
    cycles=5,
)
clearance_c = _named(
    "clearance-c", "The press with clearance at C alone", clearance_a, joints="C"
)

# 500 N at 0.16 m/s, 300 N at 0.26 m/s: some 80 W at the punch, for links of 0.8 kg in
# all.
press_blanking = _named(
    "press-blanking",
    "The press cuts a sheet: clearance at A and C, worn once",
    bearings=Bearing(clearance=0.8e-3),
    process=Blanking(),
    cycles_per_update=4e6,
)
press_drawing = _named(
    "press-drawing",
    "The press draws a cup over a cushion, worn once",
    press_blanking,
    process=Drawing(cushion=20.0),
)


def _servo_press(name: str, title: str, servo: Any) -> Make:
    return _named(
        name, f"press-blanking {title}", press_blanking, mechanism=Press(servo=servo)
    )


press_servo_dwell = _servo_press(
    "press-servo-dwell", "with a dwell, by servo 7", Dwell()
)
press_servo_forming = _servo_press(
    "press-servo-forming", "at a constant speed", Forming()
)
press_pendulum = _servo_press("press-pendulum", "while crank 7 swings", Pendulum())

# Crank 7 points along its joint force at the work, so that the motor does the work.
# The flywheel, 15.8 g m^2 at crank 2, lets the speed drop by 15 %.
_SWINGING_SERVO = Pendulum(
    middle=math.radians(-60.0),
    amplitude=math.radians(20.0),
    phase=math.radians(220.0),
    stiffness=200.0,
    damping=0.5,
)
press_hybrid = _named(
    "press-hybrid",
    "press-blanking with a motor and a flywheel at crank 2, a servo at crank 7",
    press_blanking,
    mechanism=Press(motor=Motor(0.02, ratio=15.0, inertia=7e-5), servo=_SWINGING_SERVO),
)

# 60 strokes a minute; bushings of bronze, at 38 MPa under half of the nominal force.
# All assumed.
two_point = _named(
    "two-point",
    "A press on two points of 1,000 kN cuts a sheet: clearance at the slide",
    mechanism=TwoPoint(),
    joints="B1, B2",
    bearings=Bearing(0.1e-3, 0.065, width=0.1, friction=0.08, restitution=0.8),
    process=Blanking(
        force=900e3, height=6e-3, thickness=4e-3, rise=0.3e-3, snap=0.2e-3
    ),
    wear_updates=0,
    cycles=10,
)

# Settings of the press whose work is off centre, all assumed
_OFF_CENTRE = (
    "crank_length",
    "rod_length",
    "crank_mass",
    "rod_mass",
    "slider_mass",
    "crank_inertia",
    "speed",
    "guide_length",
    "guide_width",
    "clearance",
    "width",
    "friction",
    "restitution",
)
# 60 strokes a minute; the slide in gibs of 100 mm.
press_off_centre = _named(
    "press-off-centre",
    "A press of 100 kN cuts beside the middle: the slide tilts in its guide",
    mechanism=SliderCrank(
        crank_length=0.04,
        rod_length=0.6,
        crank_mass=60.0,
        rod_mass=50.0,
        slider_mass=300.0,
        crank_inertia=0.5,
        speed=2.0 * math.pi,
        guide_length=0.4,
        guide_width=0.3,
    ),
    joints="guide",
    bearings=Bearing(0.05e-3, width=0.1, friction=0.1, restitution=0.8),
    process=Blanking(
        force=100e3,
        height=5e-3,
        thickness=3e-3,
        rise=0.2e-3,
        snap=0.15e-3,
        offset=0.06,
    ),
    wear_updates=0,
    cycles=10,
    origins=dict.fromkeys(_OFF_CENTRE, "assumed"),
)

# Settings of the slider-crank that the literature states
_OF_LITERATURE = (
    "bearing_radius",
    "clearance",
    "youngs_modulus",
    "poisson_ratio",
    "restitution",
    "exponent",
    "crank_inertia",
    "rod_inertia",
    "slide_angle",
)
# Flores' slider-crank. The literature computes the stiffness with R_i - R_j.
slider_crank = _named(
    "slider-crank",
    "A slider-crank with clearance between rod and slider",
    mechanism=SliderCrank(slide_angle=0.0, crank_inertia=1e-4, rod_inertia=2.5e-4),
    bearings=Bearing(
        0.5e-3, 0.010, materials=Materials(youngs_modulus=207e9), friction=0.0
    ),
    joints="B",
    wear_updates=0,
    cycles=10,
    origins=dict.fromkeys(_OF_LITERATURE, LITERATURE)
    | dict.fromkeys(
        ("friction", "lower_speed", "upper_speed", "bearing_share"), "assumed"
    ),
)


def __getattr__(name: str) -> Any:
    """Raise AttributeError with the nearest scene, or all of them."""
    makes = [entry.make for entry in SCENES.values()]
    functions = [key for key, value in globals().items() if value in makes]
    raise AttributeError(f"{unknown('scene', name, functions)}")


def scene_named(name: str) -> Scene:
    """Return a named scene; InputError lists the names."""
    if name not in SCENES:
        raise unknown("scene", name, SCENES)
    return SCENES[name].make()


def named_scene(scene: Scene) -> Scene | None:
    """Return the named scene whose title, or else whose name, a scene has; None for none."""
    titles = {entry.title: name for name, entry in SCENES.items()}
    name = titles.get(scene.title, scene.name)
    return SCENES[name].make() if name in SCENES else None


def base_of(scene: Scene) -> Scene:
    """Return the named scene of a scene, or the defaults of its mechanism."""
    mechanism = scene.mechanism
    default = mechanism if isinstance(mechanism, Linkage) else type(mechanism)()
    return named_scene(scene) or Scene(default)


def changes_of(scene: Scene) -> tuple[Change, ...]:
    """Return the changes of a scene against its named scene, or the defaults of its mechanism."""
    return changes_from(base_of(scene), scene)


def title_of(scene: Scene) -> str:
    """Return the title of a scene, followed by its changes of a named scene or a file.

    Without a title it is the name of the scene, or else of its mechanism.
    """
    title = scene.title or _unchanged_name(scene)
    titles = [entry.title for entry in SCENES.values()]
    if named_scene(scene) is not None and title not in titles:
        return title  # the user has replaced the title of the named scene
    return _with_changes(title, scene)


def name_of(scene: Scene) -> str:
    """Return the name of a scene, else of its mechanism, and its changes as in ``title_of``."""
    return _with_changes(_unchanged_name(scene), scene)


def short_name_of(scene: Scene) -> str:
    """Return the name of a scene, and whether it was changed."""
    name = _unchanged_name(scene)
    return name if name_of(scene) == name else f"{name}, changed"


def _unchanged_name(scene: Scene) -> str:
    is_named = scene.name != Scene.name
    return scene.name if is_named else scene.mechanism.linkage().name


def _with_changes(first: str, scene: Scene) -> str:
    changes = changes_of(scene)
    if named_scene(scene) is None:
        unchanged = IN_FILE, DEFAULT  # a fit in the file has its limits behind it
        changes = tuple(
            change
            for change in changes
            if not scene.origins.get(change.key, DEFAULT).startswith(unchanged)
        )
    if not changes:
        return first
    texts = list(map(str, changes))
    if len(texts) > _MAX_CHANGES:
        shown = _MAX_CHANGES - 1
        texts[shown:] = [f"{len(texts) - shown} more"]
    return f"{first}, changed: {', '.join(texts)}"
