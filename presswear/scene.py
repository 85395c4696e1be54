"""A scene: everything a person chooses, as data that prints and stores itself."""

from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, field
from itertools import combinations
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
from presswear.mechanism import Mechanism
from presswear.press import Press
from presswear.quantities import Choice, check_fields, choice, quantity
from presswear.slider_crank import SliderCrank
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


_RESTORED: Mapping[str, Callable[[Mapping[str, Any]], Press | SliderCrank]] = {
    Press.kind: Press.from_dict,
    SliderCrank.kind: SliderCrank.from_dict,
}
"""What makes a stored mechanism anew, by its kind."""


def joint_words(mechanism: Mechanism) -> dict[str, tuple[str, ...]]:
    """The choices of joints with clearance: every combination by its letters, and ``none``."""
    names = mechanism.openable
    chosen = [some for count in range(len(names)) for some in combinations(names, count + 1)]
    return {"".join(some): some for some in chosen} | {"none": ()}


def _words(scene: "Scene") -> tuple[str, ...]:
    return tuple(joint_words(scene.mechanism))


@dataclass(frozen=True)
class Scene:
    """A study of a mechanism; see the fields' own texts for units and ranges.

    Attributes
    ----------
    statuses : mapping of str to str
        Where values come from, by key, where it is not what their fields say.
    """

    name: str
    title: str
    mechanism: Press | SliderCrank = field(default_factory=Press)
    bearings: Bearings = field(default_factory=Bearings)
    conventions: Conventions = field(default_factory=Conventions)
    joints: str = choice("AC", _words, "which joints have clearance")
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
    statuses: Mapping[str, str] = field(default_factory=dict, hash=False)

    def __post_init__(self) -> None:
        for name in ("name", "title"):
            if not isinstance(getattr(self, name), str):
                raise InputError(f"{name} = {getattr(self, name)!r}: a text is expected")
        for key, status in dict(self.statuses).items():
            if not (isinstance(key, str) and isinstance(status, str)):
                raise InputError(f"status {status!r} of {key!r}: texts are expected")
        check_fields(self)
        check_fields(self.conventions)
        self.mechanism.check_assembly()

    @property
    def clearance_joints(self) -> tuple[str, ...]:
        """Names of the joints with clearance."""
        return joint_words(self.mechanism)[self.joints]

    @property
    def amplification(self) -> "Amplification":
        """How the depth of the cycles run becomes one wear."""
        return Amplification(self.represented_cycles)

    def linkage(self, worn: Mapping[str, tuple[Surface, Surface]] | None = None) -> Linkage:
        """The linkage of a stage; ``worn`` gives bearing and pin surface by joint name."""
        ideal = self.mechanism.linkage()
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
            free_step=self.mechanism.period / self.free_steps,
        )

    def as_dict(self) -> dict[str, Any]:
        """The scene as plain data, SI units, radians; its mechanism says of which kind it is."""
        plain = asdict(self)
        return plain | {"mechanism": {"kind": self.mechanism.kind, **plain["mechanism"]}}

    @staticmethod
    def from_dict(data: Mapping[str, Any]) -> "Scene":
        """A scene from ``as_dict``; InputError names what does not fit."""
        try:
            plain = dict(data)
            mechanism = dict(plain.pop("mechanism"))
            kind = mechanism.pop("kind")
            Choice(tuple(_RESTORED), "").check("kind of mechanism", kind)
            return Scene(
                mechanism=_RESTORED[kind](mechanism),
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
