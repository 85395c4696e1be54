"""Options of a run that are not part of the mechanism: engines, recording plan, service life."""

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from itertools import chain
from typing import ClassVar, NamedTuple

from presswear.engines import settings
from presswear.tools.errors import InputError, unknown
from presswear.tools.fields import choice, count, free_text, quantity
from presswear.tools.quantities import Quantity, parse_quantity, written
from presswear.tools.serialize import Checked, check_fields


@dataclass(frozen=True)
class Numerics:
    """Engines, each with its settings; a run uses one of them."""

    tree: settings.ExudynTree = field(default_factory=settings.ExudynTree)
    joints: settings.ExudynJoints = field(default_factory=settings.ExudynJoints)
    dae: settings.InHouse = field(default_factory=settings.InHouse)

    def __post_init__(self) -> None:
        check_fields(self)
        for engine in vars(self).values():
            check_fields(engine)

    def resolved(
        self, purpose: settings.Purpose, error: float = settings.WEAR_ERROR
    ) -> "Numerics":
        """Return a copy with unspecified tolerances set for the purpose; see the engines."""
        return Numerics(
            tree=self.tree.resolved(purpose, error),
            joints=self.joints.resolved(purpose, error),
            dae=self.dae.resolved(purpose, error),
        )

    def of(self, engine: settings.Engine) -> "Numerics":
        """Return a copy with the settings of one engine."""
        names = {type(current): name for name, current in vars(self).items()}
        return Numerics(**{**vars(self), names[type(engine)]: engine})


@dataclass(frozen=True)
class Recording(Checked):
    """Series and sections that are stored of each stage."""

    recorded_cycles: int | None = count(
        None,
        low=1,
        high=1000,
        origin="chosen",
        text="first cycles that are stored; default: 5, or as the process needs",
    )
    rows_per_cycle: int = count(
        2000,
        low=100,
        high=20_000,
        origin="chosen",
        text="smallest number of rows in a cycle; contacts add rows",
    )
    series: str = choice(
        "all",
        ("all", "output"),
        "series that are stored: all, or only those of the output point",
    )
    digits: str = choice(
        "double",
        ("double", "single"),
        "digits of the series of joints: 16, or 7 for smaller files",
    )
    sections: int = count(
        0,
        low=0,
        high=360,
        origin="chosen",
        text="Poincare sections of every cycle, at equal angles of the cycle",
    )
    section_angle: float = quantity(
        0.0,
        unit="rad",
        low=0.0,
        high=2.0 * math.pi,
        origin="chosen",
        text="angle of the cycle of the first section",
    )

    @property
    def phases(self) -> tuple[float, ...]:
        """Fractions of a cycle at which the Poincaré sections lie, increasing, in (0, 1]."""
        first = self.section_angle / (2.0 * math.pi)
        phases = []
        for k in range(self.sections):
            # A section at the start of a cycle is stored at 1, the end of the cycle before.
            phases.append(1.0 - (1.0 - first - k / self.sections) % 1.0)
        return tuple(sorted(phases))


class LifeQuantity(NamedTuple):
    """Quantity of a joint or of the whole mechanism that a service life can limit."""

    unit: str
    # Kinds of joints, pin or guide, that have the quantity; empty for the whole mechanism
    kinds: tuple[str, ...]
    words: str  # name in sentences
    text: str  # description


_PIN = ("pin",)
_ANY = ("pin", "guide")
# Quantities that can have a limit, by name
LIFE_QUANTITIES: dict[str, LifeQuantity] = {
    "depth": LifeQuantity(
        "m", _ANY, "depth", "largest wear depth of bearing or pin, or of both walls"
    ),
    "wear_volume": LifeQuantity(
        "m^3", _ANY, "worn volume", "worn volume of bearing and pin, or of both walls"
    ),
    "radial_clearance": LifeQuantity(
        "m",
        _PIN,
        "radial clearance",
        "half of the largest play of the worn joint, as a dial gauge or a feeler measures it",
    ),
    "diametral_clearance": LifeQuantity(
        "m",
        _PIN,
        "diametral clearance",
        "largest play of the worn joint, as a dial gauge or a feeler measures it",
    ),
    "force_max": LifeQuantity(
        "N",
        _ANY,
        "peak force",
        "peak normal force of a stroke, at a pin or at a corner of a slide, mean over strokes",
    ),
    "tilt": LifeQuantity(
        "m/m", ("guide",), "tilt", "largest tilt of the slide between the worn walls"
    ),
    "total_clearance": LifeQuantity(
        "m",
        (),
        "total clearance",
        "travel of the output point between an upward and a downward pull",
    ),
    "bdc_error": LifeQuantity(
        "m",
        (),
        "error of bottom dead centre",
        "magnitude of the error of the height of bottom dead centre, mean over strokes",
    ),
    "bdc_drift": LifeQuantity(
        "m",
        (),
        "drift of bottom dead centre",
        "magnitude of the change of the mean height of bottom dead centre since new",
    ),
    "repeatability": LifeQuantity(
        "m", (), "repeatability", "standard deviation of bottom dead centre"
    ),
}


@dataclass(frozen=True)
class Limit:
    """Upper limit of a quantity of the service life, SI."""

    name: str  # name of a quantity in LIFE_QUANTITIES
    joint: str  # empty for the whole mechanism
    value: float
    new: float = 0.0  # value of the new mechanism

    @property
    def key(self) -> str:
        """Key as it is typed, such as ``A.depth``."""
        return f"{self.joint}.{self.name}" if self.joint else self.name

    @property
    def unit(self) -> str:
        """Unit of the value."""
        return LIFE_QUANTITIES[self.name].unit


@dataclass(frozen=True)
class Service:
    """Replacement of a bushing or of both walls of a guide, or rotation of a bushing."""

    joint: str
    strokes: float  # number of strokes before the service
    is_rotated: bool  # True: rotated by half a turn; False: replaced
    is_guide: bool = False

    @property
    def words(self) -> str:
        """Description of the service in words."""
        element = "walls" if self.is_guide else "bushing"
        change = "rotated by half a turn" if self.is_rotated else "replaced"
        return f"{element} of {self.joint} {change}"


# Settings of a bearing whose names stand for a quantity of LIFE_QUANTITIES
_ALIASES = {"clearance": "radial_clearance"}
# Quantities of a new joint relative to its radial clearance
NEW_OVER_CLEARANCE = {"radial_clearance": 1.0, "diametral_clearance": 2.0}
_TIMES_NEW = re.compile(r"([0-9.eE+-]+)\s*[x×]\s*new")
_DECIMAL_COMMA = re.compile(r"\d*,\d+")  # a limit after a comma begins with a name
_LIMIT = re.compile(r"\s*(?:([^\s.>]+)\.)?([^\s.>]+)\s*>=?\s*(\S.*?)\s*$")
_STROKES = Quantity("", 1.0, 1e15)  # allowed numbers of strokes


@dataclass(frozen=True)
class Life(Checked):
    """Service life: the joints wear until the first of some limits is exceeded."""

    kind: ClassVar[str] = "limits"

    until: str = free_text(
        "depth > 0.05 mm",
        "'bdc_drift > 0.05 mm, A.depth > 80 um'",
        "limits, the first to be exceeded ends the life: of every joint, or JOINT.NAME; names are "
        + ", ".join(LIFE_QUANTITIES)
        + "; clearance is the radial one, and clearances and tilts can be N x new",
    )
    at_most: float = quantity(
        5e7, "", 1.0, 1e15, "chosen", "largest number of strokes that is simulated"
    )
    replaced: str = free_text(
        "",
        "'A@2e6, C@4e6'",
        "bushings, or walls of a guide, to replace after so many strokes",
    )
    rotated: str = free_text(
        "", "'A@2e6'", "bushings to rotate by half a turn after so many strokes"
    )
    quick: str = choice(
        "off",
        ("off", "on"),
        "only the wear rates of the new and the once worn surfaces, in short",
    )
    max_cycles: int = count(
        10_000, 16, 10_000_000, "chosen", "largest number of cycles of all replicates"
    )

    def limits(
        self, clearances: Mapping[str, float], tilts: Mapping[str, float]
    ) -> tuple[Limit, ...]:
        """Return the limits. A limit without a joint applies to each joint with the quantity.

        Parameters
        ----------
        clearances : mapping of str to float
            Radial clearances of the new pin joints by name, m.
        tilts : mapping of str to float
            Largest tilts of the slides in the new guides by name, rad.

        Raises
        ------
        InputError
            If a limit cannot be read, or does not fit its joint.
        """
        limits = []
        names_of_kind = {"pin": tuple(clearances), "guide": tuple(tilts)}
        if comma := _DECIMAL_COMMA.search(self.until):
            raise InputError(
                f"until = {self.until!r}: use a decimal point, "
                f"{comma[0].replace(',', '.')!r}"
            )
        for text in map(str.strip, self.until.split(",")):
            specified, name, size = _parse_limit(text)
            for joint in _joints_of_limit(text, specified, name, names_of_kind):
                if name == "tilt":
                    new = tilts[joint]
                else:
                    # Other quantities than clearances grow from 0.
                    ratio = NEW_OVER_CLEARANCE.get(name, 0.0)
                    new = ratio * clearances.get(joint, 0.0)
                value = _limit_value(text, name, size, new)
                limits.append(Limit(name, joint, value, new))
        return tuple(limits)

    def services(
        self, pins: Sequence[str], guides: Sequence[str]
    ) -> tuple[Service, ...]:
        """Return the services in the order of strokes.

        ``pins`` and ``guides`` are the names of the joints with clearance.

        Raises
        ------
        InputError
            If a service cannot be read, or does not fit its joint.
        """
        services = []
        joints = (*pins, *guides)
        for key, text in (("replaced", self.replaced), ("rotated", self.rotated)):
            is_rotated = key == "rotated"
            for service in filter(None, map(str.strip, text.split(","))):
                joint, strokes = self._parse_service(key, service)
                if joint not in joints:
                    raise unknown(f"joint with clearance in {key}", joint, joints)
                is_guide = joint in guides
                if is_rotated and is_guide:
                    raise InputError(
                        f"{key} = {service!r}: the walls of a guide can be replaced only"
                    )
                services.append(Service(joint, strokes, is_rotated, is_guide))
        return tuple(sorted(services, key=lambda service: service.strokes))

    def _parse_service(self, key: str, text: str) -> tuple[str, float]:
        """Return the joint and the strokes of a text such as A@2e6."""
        label = f"{key} = {text!r}"
        joint, sign, size = map(str.strip, text.partition("@"))
        if not (joint and sign and size):
            raise InputError(f"{label}: JOINT@STROKES is expected, such as 'A@2e6'")
        strokes = float(parse_quantity(f"{key}: {joint}", size, _STROKES))
        if strokes >= self.at_most:
            raise InputError(f"{label}: allowed is below at_most = {self.at_most:g}")
        return joint, strokes


def _parse_limit(text: str) -> tuple[str | None, str, str]:
    """Return joint, quantity and value of a text such as A.depth > 0.05 mm.

    The joint is None if the limit is for all joints.
    """
    match = _LIMIT.match(text)
    if match is None:
        names = ", ".join(LIFE_QUANTITIES)
        raise InputError(
            f"until = {text!r}: NAME > VALUE is expected, such as "
            f"'depth > 0.05 mm'; names are {names}"
        )
    joint, name, size = match.groups()
    name = _ALIASES.get(name, name)
    if name not in LIFE_QUANTITIES:
        raise unknown("number in until", name, (*_ALIASES, *LIFE_QUANTITIES))
    return joint, name, size


def _joints_of_limit(
    text: str,
    specified: str | None,
    name: str,
    names_of_kind: Mapping[str, Sequence[str]],
) -> Sequence[str]:
    """Return the names of the joints to which a limit applies.

    A limit of the whole mechanism has one empty name. ``specified`` is the joint of the
    limit, None for all joints.
    """
    kinds = LIFE_QUANTITIES[name].kinds
    if not kinds:
        if specified is not None:
            raise InputError(f"until = {text!r}: {name} is of the whole mechanism")
        return ("",)
    with_clearance = list(chain.from_iterable(names_of_kind.values()))
    if specified is not None and specified not in with_clearance:
        raise unknown("joint with clearance in until", specified, with_clearance)
    joints = list(chain.from_iterable(names_of_kind[kind] for kind in kinds))
    if specified in joints:
        return (specified,)
    if specified is not None or not joints:
        example = f"such as {joints[0]}" if joints else "and none has clearance"
        raise InputError(
            f"until = {text!r}: {name} is of a {' or '.join(kinds)}, {example}"
        )
    return joints


def _limit_value(text: str, name: str, size: str, new: float) -> float:
    """Return the value of a limit, SI.

    ``new`` is the value of the new joint, SI. It is 0 for a quantity that grows from 0.
    """
    if size.endswith("new"):
        times = _TIMES_NEW.fullmatch(size)
        if times is None:
            raise InputError(
                f"until = {text!r}: VALUE x new is expected, such as 2.5 x new"
            )
        if new == 0.0:
            allowed = ", ".join(("clearance", *NEW_OVER_CLEARANCE, "tilt"))
            raise InputError(f"until = {text!r}: 'x new' is allowed for {allowed}")
        above_1 = Quantity("", 1.0, 1000.0, "", "times the new value", open_low=True)
        return float(parse_quantity(f"until: {name}", times[1], above_1)) * new
    unit = LIFE_QUANTITIES[name].unit
    text_of_range = LIFE_QUANTITIES[name].text
    positive = Quantity(unit, 0.0, math.inf, "", text_of_range, open_low=True)
    value = float(parse_quantity(f"until: {name}", size, positive))
    if value <= new:
        raise InputError(
            f"until = {text!r}: allowed is above {written(new, unit)}, that of the new joint"
        )
    return value


LIVES = {Life.kind: Life}  # kinds of life in a scene file
