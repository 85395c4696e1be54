"""A scene: everything a person chooses, as data that prints and stores itself."""

from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass, field, fields, replace
from itertools import combinations
from typing import Any, get_args

import numpy as np

from presswear.engines.settings import Engine, ExudynJoints, ExudynTree, InHouse
from presswear.linkage.elements import (
    ClearanceJoint,
    Footprint,
    Linkage,
    MapFrame,
    Revolute,
    Slip,
    SurfaceContact,
    WearLaw,
)
from presswear.linkage.laws import (
    FrictionLaw,
    NormalLaw,
    StiffnessReading,
    hertz_stiffness,
    lankarani_nikravesh_damping,
)
from presswear.linkage.press import Press
from presswear.linkage.slider_crank import SliderCrank
from presswear.linkage.surface import Surface
from presswear.linkage.topology import branches_of
from presswear.linkage.written import read, written
from presswear.physics.assembly import IdealMotion, followed, motion_of
from presswear.tools.arrays import Array
from presswear.tools.documents import typed
from presswear.tools.errors import InputError, unknown
from presswear.tools.quantities import Choice, check_fields, choice, count, named_set, quantity


@dataclass(frozen=True)
class Conventions:
    """How the paper's wear model is read; each choice stands alone."""

    stiffness: StiffnessReading = choice(
        "paper", get_args(StiffnessReading), "K with R_i + R_j as printed, or R_i - R_j"
    )
    slip: Slip = choice("angle", get_args(Slip), "ds = (R_j + delta) |d phi| (eq. 24), or |v_t| dt")
    map_frame: MapFrame = choice(
        "fixed", get_args(MapFrame), "wear maps fixed in direction, or turning with their bodies"
    )
    footprint: Footprint = choice(
        "bin", get_args(Footprint), "wear into the one bin of the contact, or over the contact arc"
    )
    contact: SurfaceContact = choice(
        "radial",
        get_args(SurfaceContact),
        "worn surfaces meet where e points, or over all of the arc on an elastic foundation",
    )

    @property
    def name(self) -> str:
        """Name of the set, or ``own`` for one that has none."""
        return next((name for name, preset in CONVENTIONS.items() if self == preset), "own")


CONVENTIONS: dict[str, Conventions] = {
    "paper": Conventions(),
    "refined": Conventions("refined", "sliding", "body", "arc", "foundation"),
}
"""The two named sets; every choice can be made alone."""


LEAST_RAMP = 1e-5
"""Least width of the ramp of friction, m/s.

A pin that sticks creeps inside the ramp, in steps that shorten with it: at this width a cycle
of the press with c_f = 0.8 takes half a million steps, at 1e-6 m/s ten times as many.
"""


@dataclass(frozen=True)
class Bearings:
    """A joint with clearance: pin, bearing and what they are made of."""

    clearance: float = quantity(0.8e-3, "m", 1e-9, 1.0, "paper, per study", "c = R_i - R_j")
    bearing_radius: float = quantity(0.015, "m", 1e-4, 1.0, "paper", "R_i")
    width: float = quantity(
        0.02, "m", 0.0, 1.0, "assumed", "axial width b; only K_d / b matters", open_low=True
    )
    youngs_modulus: float = quantity(200e9, "Pa", 1e9, 1e12, "paper", "E of pin and bearing")
    poisson_ratio: float = quantity(0.3, "", 0.0, 0.5, "paper", "nu of pin and bearing")
    restitution: float = quantity(0.9, "", 0.05, 1.0, "paper", "nominal restitution ce")
    exponent: float = quantity(1.5, "", 1.0, 2.5, "paper", "n of the normal force")
    friction: float = quantity(0.02, "", 0.0, 0.8, "paper, per study", "friction coefficient c_f")
    lower_speed: float = quantity(1e-4, "m/s", 0.0, 1.0, "paper", "v_0: no friction below")
    upper_speed: float = quantity(1e-3, "m/s", LEAST_RAMP, 1.0, "paper", "v_1: full friction above")
    wear_coefficient: float = quantity(
        1.2e-15, "1/Pa", 0.0, 1e-9, "assumed, one number for all scenes", "K_d"
    )
    bearing_share: float = quantity(
        0.5, "", 0.0, 1.0, "paper", "part of the wear depth that the bearing loses"
    )
    angles: int = count(360, 16, 100_000, "assumed", "bins of a wear map")

    def __post_init__(self) -> None:
        check_fields(self)
        if self.clearance >= self.bearing_radius:
            raise InputError(
                f"clearance = {self.clearance:g} m: allowed is 1e-9 m up to below the bearing "
                f"radius, {self.bearing_radius:g} m"
            )
        if not self.upper_speed - self.lower_speed >= 0.999 * LEAST_RAMP:
            raise InputError(
                f"lower_speed = {self.lower_speed:g} m/s: allowed is 0 to {LEAST_RAMP:g} m/s below "
                f"upper_speed, {self.upper_speed:g} m/s"
            )

    def joint(
        self,
        revolute: Revolute,
        conventions: Conventions,
        worn: tuple[Surface, Surface],
    ) -> ClearanceJoint:
        """A revolute joint opened: bearing on its first end, pin on its second."""
        stiffness = hertz_stiffness(
            self.bearing_radius,
            self.bearing_radius - self.clearance,
            self.youngs_modulus,
            self.poisson_ratio,
            conventions.stiffness,
        )
        law = WearLaw(
            self.wear_coefficient,
            conventions.slip,
            conventions.footprint,
            self.bearing_share,
            self.angles,
        )
        return ClearanceJoint(
            revolute.name,
            revolute.first,
            revolute.second,
            self.bearing_radius,
            self.clearance,
            self.width,
            NormalLaw(stiffness, self.exponent, lankarani_nikravesh_damping(self.restitution)),
            FrictionLaw(self.friction, self.lower_speed, self.upper_speed),
            law if self.wear_coefficient > 0.0 else None,
            conventions.map_frame,
            conventions.contact,
            *worn,
        )


OneMechanism = Press | SliderCrank | Linkage
MECHANISMS: dict[str, type[Press | SliderCrank]] = {
    kind.kind: kind for kind in (Press, SliderCrank)
}
"""The mechanisms that are made of a few quantities, by their kinds."""


ENGINES = ("exudyn", ExudynTree.word, ExudynJoints.word, InHouse.word)


@dataclass(frozen=True)
class Numerics:
    """The engines, each with its settings; a run uses one of them."""

    tree: ExudynTree = field(default_factory=ExudynTree)
    joints: ExudynJoints = field(default_factory=ExudynJoints)
    dae: InHouse = field(default_factory=InHouse)

    def __post_init__(self) -> None:
        for item in fields(self):
            check_fields(getattr(self, item.name))

    def of(self, engine: Engine) -> "Numerics":
        """The same with the settings of one engine."""
        engines: dict[str, Any] = {item.name: getattr(self, item.name) for item in fields(self)}
        place = next(name for name, own in engines.items() if type(own) is type(engine))
        return Numerics(**{**engines, place: engine})

    def having(self, **settings: Any) -> "Numerics":
        """The same with some settings changed, by their own names."""
        changed = {}
        for item in fields(self):
            engine = getattr(self, item.name)
            own = {key: settings.pop(key) for key in asdict(engine).keys() & settings.keys()}
            changed[item.name] = replace(engine, **own)
        if settings:
            raise TypeError(f"no engine has a setting {', '.join(settings)}")
        return Numerics(**changed)


DRAWS = 4
"""Starts of a scene that wears and does not say how many: the fewest with a usable interval."""


def joint_words(mechanism: OneMechanism) -> dict[str, tuple[str, ...]]:
    """The choices of joints with clearance: every combination of their names, and ``none``.

    Names of one letter stand side by side, longer ones with a comma between.
    """
    names = mechanism.openable
    between = "" if all(len(name) == 1 for name in names) else ","
    chosen = [some for count in range(len(names)) for some in combinations(names, count + 1)]
    return {between.join(some): some for some in chosen} | {"none": ()}


def _words(scene: "Scene") -> tuple[str, ...]:
    return tuple(joint_words(scene.mechanism))


@dataclass(frozen=True)
class Scene:
    """A study of a mechanism; see the fields' own texts for units and ranges.

    Attributes
    ----------
    bearings : Bearings
        Of every joint with clearance that is not set apart.
    apart : mapping of str to Bearings
        Those of single joints that differ, by name.
    statuses : mapping of str to str
        Where values come from, by key, where it is not what their fields say.
    """

    name: str = "scene"
    title: str = "A scene of one's own"
    mechanism: OneMechanism = field(default_factory=Press)
    bearings: Bearings = field(default_factory=Bearings)
    apart: Mapping[str, Bearings] = field(default_factory=dict, hash=False)
    conventions: Conventions = named_set(
        "paper", CONVENTIONS, "what the paper prints, or what a careful engineer would compute"
    )
    numerics: Numerics = field(default_factory=Numerics)
    joints: str = choice("AC", _words, "which joints have clearance")
    engine: str = choice(
        "exudyn",
        ENGINES,
        "what solves the motion; exudyn takes the open tree where there is one, or the joints",
    )
    drive_torque: str = choice("off", ("off", "on"), "whether drive torques are stored")
    wears: int = count(2, 0, 20, "paper, per study", "how often the joints are worn")
    cycles: int | None = count(
        None,
        1,
        100_000,
        "chosen",
        "cycles of each stage and start; none given: until the maps are known",
    )
    tolerance: float = quantity(
        0.1, "", 1e-3, 1.0, "chosen", "how well the wear maps must be known, part of their rms"
    )
    most_cycles: int = count(200, 1, 100_000, "paper", "cycles of a stage at most without --cycles")
    represented_cycles: float = quantity(
        4e6,
        "",
        1.0,
        1e12,
        "paper",
        "cycles that one wear stands for: 200 x 20,000, which the paper calls 2 million",
    )
    extrapolation: str = choice(
        "conventions",
        ("conventions", "single", "steps"),
        "how a wear is applied: in a single jump, as the paper does, in steps of a cycle each, "
        "or in steps only where the footprint is an arc",
    )
    starts: int | None = count(
        None,
        1,
        100,
        "chosen",
        "starts 1e-9 m apart, each through all stages on surfaces of its own: independent draws; "
        "none given: 4 where something wears, else 1",
    )
    seed: int = count(0, 0, 100_000, "chosen", "draws the starts anew, for an independent run")
    statuses: Mapping[str, str] = field(default_factory=dict, hash=False)

    def __post_init__(self) -> None:
        for name in ("name", "title"):
            if not isinstance(getattr(self, name), str):
                raise InputError(f"{name} = {getattr(self, name)!r}: a text is expected")
        for key, status in dict(self.statuses).items():
            if not (isinstance(key, str) and isinstance(status, str)):
                raise InputError(f"status {status!r} of {key!r}: texts are expected")
        for part, kind in (("bearings", Bearings), ("conventions", Conventions)):
            if not isinstance(getattr(self, part), kind):
                raise InputError(f"{part} = {getattr(self, part)!r}: a {kind.__name__} is expected")
        check_fields(self)
        check_fields(self.conventions)
        for name, own in dict(self.apart).items():
            if name not in self.mechanism.openable:
                raise unknown("joint", name, self.mechanism.openable)
            if not isinstance(own, Bearings):
                raise InputError(f"apart of {name} = {own!r}: a Bearings is expected")
            if own.angles != self.bearings.angles:
                raise InputError(
                    f"{name}.angles = {own.angles}: all maps have as many bins; allowed is "
                    f"{self.bearings.angles}"
                )
        alike = {name: own for name, own in self.apart.items() if own != self.bearings}
        object.__setattr__(self, "apart", alike)
        for name, own in {"": self.bearings, **self.apart}.items():
            if self.conventions.contact == "foundation" and own.exponent != 1.5:
                key = f"{name}.exponent" if name else "exponent"
                raise InputError(
                    f"{key} = {own.exponent:g}: with contact = 'foundation', which is linear "
                    "and gives the exponent 1.5 of a round joint, allowed is 1.5"
                )
        if self.draws > 1 and not self.clearance_joints:
            raise InputError(f"starts = {self.starts}: without a clearance joint allowed is 1")
        _ = self.ideal
        reason = branches_of(self.linkage()) if self.engine == ExudynTree.word else ""
        if isinstance(reason, str) and reason:
            others = ", ".join(name for name in ENGINES if name != ExudynTree.word)
            raise InputError(
                f"engine = {ExudynTree.word!r}: a linkage without loops is needed, but {reason}; "
                f"allowed here is one of {others}"
            )

    @property
    def clearance_joints(self) -> tuple[str, ...]:
        """Names of the joints with clearance."""
        return joint_words(self.mechanism)[self.joints]

    def bearing(self, joint: str) -> Bearings:
        """The bearing of a joint."""
        return self.apart.get(joint, self.bearings)

    @property
    def draws(self) -> int:
        """Number of independent starts."""
        if self.starts is not None:
            return self.starts
        return DRAWS if self.wears > 0 and self.clearance_joints else 1

    @property
    def wears_in_steps(self) -> bool:
        """True where a wear is applied in steps.

        By the conventions where the scene leaves it to them: a profile whose depth depends on
        the width of its bins has no step that is small enough.
        """
        if self.extrapolation == "conventions":
            return self.conventions.footprint == "arc"
        return self.extrapolation == "steps"

    def linkage(self, worn: Mapping[str, tuple[Surface, Surface]] | None = None) -> Linkage:
        """The linkage of a stage; ``worn`` gives bearing and pin surface by joint name."""
        ideal = followed(self.mechanism.linkage())
        surfaces = dict.fromkeys(self.clearance_joints, (Surface(), Surface())) | dict(worn or {})
        joints = (joint for joint in ideal.revolutes if joint.name in self.clearance_joints)
        return ideal.opened(
            tuple(self.bearing(j.name).joint(j, self.conventions, surfaces[j.name]) for j in joints)
        )

    @property
    def solver(self) -> Engine:
        """The engine that runs: for ``exudyn`` the smallest model that the linkage allows."""
        numerics = self.numerics
        if self.engine == "exudyn":
            is_tree = not isinstance(branches_of(self.linkage()), str)
            return numerics.tree if is_tree else numerics.joints
        named = {engine.word: engine for engine in (numerics.tree, numerics.joints, numerics.dae)}
        return named[self.engine]

    @property
    def ideal(self) -> IdealMotion:
        """The motion of the mechanism with all joints closed."""
        return motion_of(self.mechanism)

    @property
    def run_up(self) -> float:
        """Time in which the mechanism runs up from rest, s; cycles are counted behind it."""
        return self.mechanism.linkage().run_up_time

    @property
    def watched(self) -> str:
        """The body that is watched, in a word."""
        body = self.mechanism.linkage().probe.body
        return "slider" if body.startswith("slider") else body

    def ideal_slider(self, time: Array) -> Array:
        """Displacement from the start, velocity and acceleration of the slider, joints closed.

        Parameters
        ----------
        time : ndarray, shape (n,)
            s.

        Returns
        -------
        ndarray, shape (n, 3)
            m, m/s, m/s^2.
        """
        slider = self.ideal.at(np.append(0.0, time)).watched(self.mechanism.linkage())
        slider[:, 0] -= slider[0, 0]
        return slider[1:]

    def modelled(self) -> dict[str, Any]:
        """What is computed as plain data; how finely, by what and how often is left out."""
        names = (
            *("mechanism", "bearings", "apart", "conventions"),
            *("extrapolation", "represented_cycles"),
        )
        return {name: value for name, value in self.as_dict().items() if name in names}

    def as_dict(self) -> dict[str, Any]:
        """The scene as plain data, SI units, radians; its mechanism says of which kind it is."""
        mechanism = self.mechanism
        own = written(mechanism) if isinstance(mechanism, Linkage) else asdict(mechanism)
        plain = asdict(self)
        return plain | {"mechanism": {"kind": mechanism.kind, **own}}

    @staticmethod
    def from_dict(data: Mapping[str, Any]) -> "Scene":
        """A scene from ``as_dict``; InputError names what does not fit or is missing.

        Nothing is filled in: a value that got lost is not today's default.
        """
        try:
            plain = dict(data)
            mechanism = dict(plain.pop("mechanism"))
            kind = mechanism.pop("kind")
            Choice((*MECHANISMS, Linkage.kind), "").check("kind of mechanism", kind)
            is_own = kind == Linkage.kind
            scene = Scene(
                mechanism=read(mechanism, "mechanism")
                if is_own
                else MECHANISMS[kind].from_dict(mechanism),
                bearings=Bearings(**plain.pop("bearings")),
                apart={name: Bearings(**own) for name, own in plain.pop("apart").items()},
                conventions=Conventions(**plain.pop("conventions")),
                numerics=_numerics(dict(plain.pop("numerics"))),
                **plain,
            )
            lacking = next(_lacking(scene.as_dict(), data), None)
            if lacking is not None:
                raise InputError(f"this is no whole scene: {lacking!r} is missing")
            # What no person can set has no range of its own.
            for part in ("numerics",) if is_own else ("mechanism", "numerics"):
                typed(data[part], type(getattr(scene, part)), f"this is no stored scene: {part}")
            return scene
        except InputError:
            raise
        except (KeyError, TypeError, ValueError, OverflowError) as error:
            raise InputError(f"this is not a stored scene: {error}") from None


def _numerics(stored: Mapping[str, Any]) -> Numerics:
    """The engines from their settings as plain data."""
    kinds = {item.name: type(getattr(Numerics(), item.name)) for item in fields(Numerics)}
    return Numerics(**{name: kinds[name](**settings) for name, settings in stored.items()})


def _lacking(whole: Mapping[str, Any], data: Mapping[str, Any]) -> Iterator[str]:
    """Names in nested data that other data of the same kind lack."""
    for name, value in whole.items():
        if name not in data:
            yield name
        elif isinstance(value, Mapping) and name != "statuses":
            yield from _lacking(value, data[name])


_ORDINALS = (
    "first",
    "second",
    "third",
    "fourth",
    "fifth",
    "sixth",
    "seventh",
    "eighth",
    "ninth",
    "tenth",
)


def stage_name(index: int) -> str:
    """Name of a stage: ``no wear``, ``first wear``, ..."""
    if index == 0:
        return "no wear"
    return f"{_ORDINALS[index - 1]} wear" if index <= len(_ORDINALS) else f"wear {index}"
