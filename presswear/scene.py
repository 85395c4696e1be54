"""A scene: everything a person chooses, as data that prints and stores itself."""

from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass, field, fields, replace
from typing import Any

from presswear.engines.base import Accuracy, DaeAccuracy, Integrator
from presswear.errors import InputError
from presswear.laws import (
    FrictionLaw,
    NormalLaw,
    StiffnessReading,
    hertz_stiffness,
    lankarani_nikravesh_damping,
)
from presswear.linkage import (
    ClearanceJoint,
    Footprint,
    Linkage,
    MapFrame,
    Revolute,
    Slip,
    WearLaw,
)
from presswear.press import GEOMETRIES, Geometry, Press
from presswear.quantities import (
    Choice,
    Meaning,
    check_fields,
    choice,
    choice_of,
    meaning_of,
    parse_quantity,
    quantity,
)
from presswear.surface import Surface


@dataclass(frozen=True)
class Conventions:
    """How the paper's wear model is read; each choice stands alone."""

    stiffness: StiffnessReading = choice(
        "paper", ("paper", "refined"), "K with R_i + R_j as printed, or R_i - R_j"
    )
    slip: Slip = choice(
        "angle", ("angle", "sliding"), "ds = (R_j + delta) |d phi| (eq. 24), or |v_t| dt"
    )
    map_frame: MapFrame = choice(
        "fixed", ("fixed", "body"), "wear maps fixed in direction, or turning with their bodies"
    )
    footprint: Footprint = choice(
        "bin", ("bin", "arc"), "wear into the one bin of the contact, or over the contact arc"
    )


CONVENTIONS: dict[str, Conventions] = {
    "paper": Conventions(),
    "refined": Conventions("refined", "sliding", "body", "arc"),
}
"""The two named sets; every choice can be made alone."""


@dataclass(frozen=True)
class Bearings:
    """The clearance joints of a scene: both alike."""

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
    upper_speed: float = quantity(
        1e-3, "m/s", 0.0, 1.0, "paper", "v_1: full friction above", open_low=True
    )
    wear_coefficient: float = quantity(
        1.2e-15, "1/Pa", 0.0, 1e-9, "assumed, one number for all scenes", "K_d"
    )
    bearing_share: float = quantity(
        0.5, "", 0.0, 1.0, "paper", "part of the wear depth that the bearing loses"
    )
    angles: int = quantity(360, "", 16, 100_000, "assumed", "bins of a wear map", whole=True)

    def __post_init__(self) -> None:
        check_fields(self)
        if self.clearance >= self.bearing_radius:
            raise InputError(
                f"clearance = {self.clearance:g} m: allowed is 1e-9 m up to below the bearing "
                f"radius, {self.bearing_radius:g} m"
            )
        if self.lower_speed >= self.upper_speed:
            raise InputError(
                f"lower_speed = {self.lower_speed:g} m/s: allowed is 0 up to below upper_speed, "
                f"{self.upper_speed:g} m/s"
            )

    def joint(
        self,
        revolute: Revolute,
        conventions: Conventions,
        worn: tuple[Surface, Surface],
        wear: bool,
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
            law if wear else None,
            conventions.map_frame,
            *worn,
        )


JOINTS = {"A": ("A",), "C": ("C",), "AC": ("A", "C"), "none": ()}


@dataclass(frozen=True)
class Scene:
    """A study of the press; see the fields' own texts for units and ranges."""

    name: str
    title: str
    press: Press = field(default_factory=Press)
    bearings: Bearings = field(default_factory=Bearings)
    conventions: Conventions = field(default_factory=Conventions)
    joints: str = choice("AC", tuple(JOINTS), "which joints have clearance")
    engine: str = choice("exudyn", ("exudyn", "exudyn-joints", "dae"), "what solves the motion")
    wears: int = quantity(
        2, "", 0, 20, "paper, per study", "how often the joints are worn", whole=True
    )
    cycles: int | None = quantity(
        None,
        "",
        1,
        100_000,
        "chosen",
        "cycles of each stage; none given: until the maps are known",
        whole=True,
    )
    tolerance: float = quantity(
        0.1, "", 1e-3, 1.0, "chosen", "how well the wear maps must be known, part of their rms"
    )
    most_cycles: int = quantity(
        200, "", 1, 100_000, "paper", "cycles at most without --cycles", whole=True
    )
    represented_cycles: float = quantity(
        4e6,
        "",
        1.0,
        1e12,
        "paper",
        "cycles that one wear stands for: 200 x 20,000, which the paper calls 2 million",
    )
    steps_per_contact: int = quantity(
        50, "", 20, 10_000, "chosen", "solver steps in one impact", whole=True
    )
    steps_sustained: int = quantity(
        10,
        "",
        5,
        10_000,
        "chosen",
        "least steps in half a period of a pin at rest on its bearing",
        whole=True,
    )
    free_steps: int = quantity(
        10_000, "", 1000, 10_000_000, "chosen", "least solver steps in a cycle", whole=True
    )
    integrator: Integrator = choice(
        "dop853",
        ("dop853", "dopri5", "rk4", "rk4-paper"),
        "of engine dae: order 8 or 5 with located touches, 4 at equal steps, the paper's 1e-4 s",
    )
    integration_tolerance: float = quantity(
        1e-9,
        "",
        1e-14,
        1e-3,
        "chosen",
        "of dop853 and dopri5, per step: times 1 mm and 1 m/s + speed",
    )
    equal_step: float = quantity(1e-5, "s", 1e-9, 1e-2, "chosen", "step of rk4")
    projection: str = choice(
        "off", ("off", "on"), "of engine dae: whether each state is moved onto the constraints"
    )

    def __post_init__(self) -> None:
        for name in ("name", "title"):
            if not isinstance(getattr(self, name), str):
                raise InputError(f"{name} = {getattr(self, name)!r}: a text is expected")
        check_fields(self)
        check_fields(self.conventions)
        self.press.check_assembly()

    @property
    def clearance_joints(self) -> tuple[str, ...]:
        """Names of the joints with clearance."""
        return JOINTS[self.joints]

    @property
    def amplification(self) -> "Amplification":
        """How the depth of the cycles run becomes one wear."""
        return Amplification(self.represented_cycles)

    def linkage(self, worn: Mapping[str, tuple[Surface, Surface]] | None = None) -> Linkage:
        """The linkage of a stage; ``worn`` gives bearing and pin surface by joint name."""
        ideal = self.press.linkage()
        surfaces = worn or {}
        opened = tuple(
            self.bearings.joint(
                joint,
                self.conventions,
                surfaces.get(joint.name, (Surface(), Surface())),
                wear=self.bearings.wear_coefficient > 0.0,
            )
            for joint in ideal.revolutes
            if joint.name in self.clearance_joints
        )
        return ideal.opened(opened)

    def accuracy(self) -> Accuracy | DaeAccuracy:
        """How finely the scene's engine integrates."""
        if self.engine == "dae":
            return DaeAccuracy(
                self.integrator,
                self.integration_tolerance,
                self.equal_step,
                projected=self.projection == "on",
            )
        return self.exudyn_accuracy()

    def exudyn_accuracy(self) -> Accuracy:
        """Step lengths of an Exudyn run."""
        return Accuracy(
            steps_per_contact=self.steps_per_contact,
            steps_sustained=self.steps_sustained,
            free_step=self.press.period / self.free_steps,
        )

    def as_dict(self) -> dict[str, Any]:
        """The scene as plain data, SI units, radians."""
        return asdict(self)

    @staticmethod
    def from_dict(data: Mapping[str, Any]) -> "Scene":
        """A scene from ``as_dict``; InputError names what does not fit."""
        try:
            plain = dict(data)
            press = dict(plain.pop("press"))
            return Scene(
                press=Press(geometry=Geometry(**press.pop("geometry")), **press),
                bearings=Bearings(**plain.pop("bearings")),
                conventions=Conventions(**plain.pop("conventions")),
                **plain,
            )
        except InputError:
            raise
        except (KeyError, TypeError, ValueError, OverflowError) as error:
            raise InputError(f"this is not a stored scene: {error}") from None


@dataclass(frozen=True)
class Amplification:
    """Depth of some cycles multiplied to that of the cycles one wear stands for."""

    represented_cycles: float

    def factor(self, cycles: int) -> float:
        """Multiplier of the depth that ``cycles`` cycles added."""
        return self.represented_cycles / cycles


@dataclass(frozen=True)
class Setting:
    """One thing that ``--set`` can change."""

    key: str
    value: Any
    meaning: Meaning | Choice

    def described(self) -> str:
        """Value, range and text in one line."""
        if isinstance(self.meaning, Choice):
            return f"{self.value}  ({' | '.join(self.meaning.words)})  {self.meaning.text}"
        unit = f" {self.meaning.unit}" if self.meaning.unit else ""
        value = "none" if self.value is None else f"{self.value:.6g}{unit}"
        return f"{value}  ({self.meaning.range_text()}; {self.meaning.status})  {self.meaning.text}"


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


_PARTS = ("press", "press.geometry", "bearings", "conventions", "")
_GEOMETRY_CHOICE = Choice(tuple(GEOMETRIES), "named geometry; a choice, the paper does not fix it")


def _part(scene: Scene, path: str) -> Any:
    owner: Any = scene
    for name in path.split(".") if path else ():
        owner = getattr(owner, name)
    return owner


def settings_of(scene: Scene) -> Iterator[Setting]:
    """Everything that ``--set`` can change, with its present value."""
    yield Setting("geometry", scene.press.geometry.name, _GEOMETRY_CHOICE)
    for path in _PARTS:
        owner = _part(scene, path)
        for item in fields(owner):
            meaning = meaning_of(item) or choice_of(item)
            if meaning is not None:
                yield Setting(item.name, getattr(owner, item.name), meaning)


def changed(scene: Scene, settings: Mapping[str, str]) -> Scene:
    """The scene with settings given as text, as on the command line.

    ``geometry`` is taken first, so that single lengths can be set on top of it.
    """
    known = {setting.key: setting for setting in settings_of(scene)}
    for key in settings:
        if key not in known:
            raise InputError(f"unknown key {key!r}; known are {', '.join(sorted(known))}")
    updates: dict[str, dict[str, Any]] = {path: {} for path in _PARTS}
    geometry = scene.press.geometry
    if "geometry" in settings:
        _GEOMETRY_CHOICE.check("geometry", settings["geometry"])
        geometry = GEOMETRIES[settings["geometry"]]
    for path in _PARTS:
        owner = _part(scene, path)
        for item in fields(owner):
            if item.name not in settings or item.name == "geometry":
                continue
            text = settings[item.name]
            meaning, words = meaning_of(item), choice_of(item)
            if words is not None:
                words.check(item.name, text)
                updates[path][item.name] = text
            elif meaning is not None:
                updates[path][item.name] = parse_quantity(item.name, text, meaning)
    if updates["press.geometry"]:
        geometry = replace(geometry, name=f"{geometry.name}, changed", **updates["press.geometry"])
    return replace(
        scene,
        press=replace(scene.press, geometry=geometry, **updates["press"]),
        bearings=replace(scene.bearings, **updates["bearings"]),
        conventions=replace(scene.conventions, **updates["conventions"]),
        **updates[""],
    )
