"""Bearing of a joint with clearance, or of a rigid joint with friction, as a user chooses it."""

from collections.abc import Callable
from dataclasses import InitVar, dataclass, fields
from typing import Any, get_args

from presswear.linkage.friction_law import (
    RATE_PARAMETERS,
    STATE_PARAMETERS,
    FrictionLaw,
    has_state,
    rate_of,
)
from presswear.linkage.friction_settings import (
    FRICTIONS,
    WITH_SETTINGS,
    WITHOUT_SETTINGS,
    FrictionSettings,
    LawSettings,
    friction_settings,
)
from presswear.linkage.joints import elastic_damping, elastic_stiffness
from presswear.linkage.materials import MATERIALS, UNLISTED, Materials
from presswear.linkage.normal_law import (
    DAMPINGS,
    KELVIN_VOIGT,
    NORMAL_PARAMETERS,
    Elasticity,
)
from presswear.linkage.oil import MAX_FILM_WIDTH, MIN_FILM_WIDTH, OILED_CLEARANCE
from presswear.linkage.wear_law import ARCHARD, WEAR_PARAMETERS
from presswear.scene.fits import fit_of, middle_of
from presswear.tools.errors import InputError
from presswear.tools.fields import choice, count, named_set, quantity
from presswear.tools.quantities import Quantity, written
from presswear.tools.serialize import Checked
from presswear.tools.user_function import UserFunction

# Smallest width of the friction ramp, m/s. Steps inside the ramp shorten with its width.
LEAST_RAMP = 1e-5
# Smallest viscosity with film = run, Pa s: a film of a lower viscosity is too stiff for
# explicit steps. Petrol has five times as much.
LEAST_VISCOSITY = 1e-4
_ROUND_OFF = 1e-6  # relative excess of an allowed value that is round-off
AUTO = "auto"  # elasticity that follows from the contact of surfaces
MIN_ANGLES = 16  # bins of a wear map
# Settings that a rigid joint reads
_READ_RIGID = {
    "clearance",
    "bearing_radius",
    "friction_law",
    "friction",
    "lower_speed",
    "upper_speed",
    "stiffness",
    "damping_ratio",
    "parallel_rods",
}
# Settings that cannot be set for all joints at once
NOT_COMMON = "stiffness", "damping_ratio"

Law = str | UserFunction | Callable[..., float]
# Settings with twice the value of the settings that they replace
DIAMETRAL = "diametral_clearance"
DIAMETER = "diameter"
DOUBLED = {DIAMETRAL: "clearance", DIAMETER: "bearing_radius"}
DOUBLED_MEANINGS = {
    DIAMETRAL: Quantity("m", 0.0, 2.0, text="clearance in diameter"),
    DIAMETER: Quantity("m", 2e-4, 2.0, text="diameter of the bearing"),
}
LEAST_CLEARANCE = 1e-9  # m, of a joint with clearance


def halved(key: str, value: float | str) -> float | str:
    """Return half of a value of a setting of ``DOUBLED``, m; return a fit unchanged.

    The value is a number, m, or a text with its unit.
    """
    if key == DIAMETRAL and fit_of(value):
        return value
    return 0.5 * float(DOUBLED_MEANINGS[key].convert(key, value))


@dataclass(frozen=True)
class DryContact(Checked):
    """Sizes, materials and laws of a dry contact of a pin with its bearing."""

    clearance: float = quantity(
        0.3e-3,
        unit="m",
        low=0.0,
        high=1.0,
        origin="chosen",
        text="radial clearance R_i - R_j, half of that in diameter; 0: a rigid joint with friction",
    )
    bearing_radius: float = quantity(
        0.015, "m", 1e-4, 1.0, "paper", "radius of the bearing, R_i"
    )
    width: float = quantity(
        0.02, "m", 0.0, 1.0, "assumed", "axial width b", open_low=True
    )
    materials: Materials | Any = named_set(
        "paper", MATERIALS, "materials, pin first", UNLISTED
    )
    contact_stiffness: float | None = quantity(
        None,
        unit="N/m^n",
        low=1e3,
        high=1e15,
        origin="chosen",
        text="stiffness K of small contacts; default: from E and nu, by Hertz or by Liu",
    )
    exponent: float = quantity(
        1.5, "", 1.0, 2.5, "paper", "exponent n of the normal force"
    )
    elasticity: str = choice(
        AUTO,
        (AUTO, *get_args(Elasticity)),
        "elastic force: K delta^n, Liu's, or a foundation; auto: as contact has it, else power",
    )
    normal_law: Law = choice(
        "lankarani-nikravesh",
        tuple(DAMPINGS),
        "normal force law",
        NORMAL_PARAMETERS,
    )
    restitution: float = quantity(0.9, "", 0.0, 1.0, "paper", "nominal restitution c_e")
    viscous_damping: float = quantity(
        0.0, "N s/m", 0.0, 1e8, "chosen", f"D of normal_law = {KELVIN_VOIGT}"
    )
    friction_law: Law = choice(
        "ramp", tuple(FRICTIONS), "friction law", STATE_PARAMETERS
    )
    friction: float = quantity(
        0.02, "", 0.0, 0.8, "paper, per study", "friction coefficient c_f"
    )
    lower_speed: float = quantity(
        1e-4, "m/s", 0.0, 1.0, "paper", "v_0: no friction below"
    )
    upper_speed: float = quantity(
        1e-3, "m/s", LEAST_RAMP, 1.0, "paper", "v_1: full friction above"
    )
    wear_law: Law = choice(
        ARCHARD,
        (ARCHARD,),
        "wear coefficient: constant, but for running_in and pressure_exponent, or a user law",
        WEAR_PARAMETERS,
    )


@dataclass(frozen=True)
class Bearing(FrictionSettings, DryContact):
    """Joint with clearance: dimensions, contact laws and materials.

    Numbers are in SI, or texts with units such as "0.5 mm". ``diametral_clearance``
    stands for twice the clearance, and ``diameter`` for twice the radius of the bearing,
    in their place. A clearance can be a fit such as "110 H8/f7": it is then the middle
    of the fit. A clearance of 0 is a rigid joint with friction. Its moment is
    r F_t(r omega, F), with the radius r of the bearing, the relative angular velocity
    omega, the joint force F and the friction law F_t. A law can be a function that
    returns a force, N, of some of NORMAL_PARAMETERS or STATE_PARAMETERS.
    """

    viscosity: float | None = quantity(
        None,
        unit="Pa s",
        low=1e-5,
        high=1e3,
        origin="chosen",
        text="viscosity of a lubricant at running temperature; default: dry",
    )
    film: str = choice(
        "report",
        ("report", "run"),
        "oil film of viscosity: report: beside a dry run; run: in the run, in place of dry contact",
    )
    roughness: float = quantity(
        0.3e-6,
        unit="m",
        low=1e-9,
        high=1e-4,
        origin="assumed",
        text="R_q of each surface: compared with the oil film, and depth of running-in",
    )
    asperity_pressure: float = quantity(
        50e6,
        unit="Pa",
        low=1e5,
        high=1e9,
        origin="assumed",
        text="p_0 of asperities that touch through the oil film of film = run",
    )
    pressure_limit: float | None = quantity(
        None,
        unit="Pa",
        low=1e3,
        high=1e10,
        origin="chosen",
        text="largest pin pressure p = F / (2 R_i b); default: none",
    )
    pv_limit: float | None = quantity(
        None,
        unit="W/m^2",
        low=1.0,
        high=1e12,
        origin="chosen",
        text="largest mean of p times sliding speed; default: none",
    )
    stiffness: float | None = elastic_stiffness(
        "of the pin with one of its rods, with clearance = 0; default: rigid"
    )
    damping_ratio: float = elastic_damping(
        "damping of an elastic pin, part of the critical one"
    )
    parallel_rods: int = count(
        1,
        low=1,
        high=16,
        origin="chosen",
        text="equal rods side by side, each with a bearing of this width and stiffness",
    )
    angles: int = count(360, MIN_ANGLES, 100_000, "assumed", "bins of a wear map")
    diametral_clearance: InitVar[float | str | None] = None  # in place of ``clearance``
    diameter: InitVar[float | str | None] = None  # in place of ``bearing_radius``

    def __post_init__(
        self, diametral_clearance: float | str | None, diameter: float | str | None
    ) -> None:
        """Check each value, and the values against each other."""
        for key, value in ((DIAMETRAL, diametral_clearance), (DIAMETER, diameter)):
            if value is not None:
                object.__setattr__(self, DOUBLED[key], halved(key, value))
        if fit := fit_of(self.clearance):
            radius = Quantity("m").convert("bearing_radius", self.bearing_radius)
            object.__setattr__(self, "clearance", middle_of(fit, 2.0 * radius))
        super().__post_init__()
        self._check_clearance()
        self._check_damping()
        self._check_friction_settings()
        if not isinstance(self.friction_law, str) and self.friction == 0.0:
            raise InputError(
                f"friction = 0: with friction_law = {self.friction_law} allowed is above 0"
            )
        self._check_wear_law()
        if self.elasticity in ("liu", "foundation") and self.exponent != 1.5:
            allowed = f"with elasticity = {self.elasticity} allowed is 1.5"
            raise InputError(f"exponent = {self.exponent:g}: {allowed}")
        # The difference of two speeds has a larger round-off than the speeds.
        if not self.upper_speed - self.lower_speed >= 0.999 * LEAST_RAMP:
            low = written(self.lower_speed, "m/s")
            high = written(self.upper_speed, "m/s")
            allowed = f"0 to {written(LEAST_RAMP, 'm/s')} below upper_speed, {high}"
            raise InputError(f"lower_speed = {low}: allowed is {allowed}")

    def _check_damping(self) -> None:
        """Raise InputError for a restitution or a damping that the normal law refuses."""
        law = self.normal_law
        if not isinstance(law, str):
            return
        allowed = f"with normal_law = {law!r} allowed is"
        least = DAMPINGS[law].least
        damping = self.viscous_damping
        if self.restitution < least:
            raise InputError(
                f"restitution = {self.restitution:g}: {allowed} {least:g} to 1"
            )
        if damping > 0.0 and law != KELVIN_VOIGT:
            raise InputError(f"viscous_damping = {damping:g} N s/m: {allowed} 0 N s/m")

    def _check_clearance(self) -> None:
        """Raise InputError if the clearance is too small, or does not fit film or spring."""
        if 0.0 < self.clearance < LEAST_CLEARANCE:
            allowed = (
                f"allowed is 0, a rigid joint, or from {written(LEAST_CLEARANCE, 'm')}"
            )
            raise InputError(f"clearance = {written(self.clearance, 'm')}: {allowed}")
        if self.stiffness is not None and self.clearance > 0.0:
            clearance = written(self.clearance, "m")
            raise InputError(
                f"clearance = {clearance}: with stiffness = {written(self.stiffness, 'N/m')} "
                "allowed is 0; a joint stretches or has clearance"
            )
        if self.has_film:
            self._check_film()

    def _check_friction_settings(self) -> None:
        """Raise InputError for settings that the friction law refuses or does not read."""
        user = self.friction_law
        if isinstance(user, UserFunction) and has_state(user):
            reason = "film = run" if self.has_film else ""
            if self.clearance == 0.0:
                reason = "clearance = 0"
            if reason:
                raise InputError(
                    f"friction_law = {user}: with {reason} allowed is a law without a state"
                )
            rate_of(user).parameters("friction_law", RATE_PARAMETERS)
        for law, settings in WITH_SETTINGS.items():
            if self.friction_law != law:
                self._check_unset(law, settings)
                continue
            if self.clearance == 0.0:
                raise InputError(
                    f"friction_law = {law}: with clearance = 0 allowed is "
                    f"{', '.join(WITHOUT_SETTINGS)}"
                )
            settings.check(self, self.friction)

    def _check_unset(self, law: str, settings: type[LawSettings]) -> None:
        """Raise InputError if a setting of a friction law that is not used has a value."""
        for item in fields(settings):
            value = getattr(self, item.name)
            if item.default is None and value is not None:
                raise InputError(
                    f"{item.name} = {value:g}: it needs friction_law = {law}"
                )

    def _check_wear_law(self) -> None:
        """Raise InputError for numbers that a user wear law does not read, and K_d = 0."""
        if self.wear_law == ARCHARD:
            return
        pair = self.materials
        for key in ("running_in", "pressure_exponent"):
            value = getattr(pair, key)
            if value != 1.0:
                raise InputError(
                    f"{key} = {value:g}: with wear_law = {self.wear_law} allowed is 1"
                )
        if pair.wear_coefficient == 0.0:
            raise InputError(
                f"wear_coefficient = 0: with wear_law = {self.wear_law} allowed is above 0"
            )

    @property
    def wears_by_pressure(self) -> bool:
        """True if a user wear law depends on the pressure."""
        law = self.wear_law
        return isinstance(law, UserFunction) and "pressure" in law.parameters(
            "wear_law", WEAR_PARAMETERS
        )

    @property
    def has_film(self) -> bool:
        """True if an oil film acts in the run."""
        return self.film == "run"

    def _check_film(self) -> None:
        """Raise InputError if no oil film can act in the run."""
        if self.viscosity is None:
            raise InputError("film = run: it needs a viscosity, such as 0.1 Pa s")
        if self.viscosity < LEAST_VISCOSITY:
            raise InputError(
                f"film = run: viscosity = {self.viscosity:g} Pa s: allowed is from "
                f"{LEAST_VISCOSITY:g} Pa s"
            )
        if self.clearance == 0.0:
            raise InputError("film = run: with clearance = 0 allowed is report")
        relative = self.clearance / self.bearing_radius
        if relative > (1.0 + _ROUND_OFF) * OILED_CLEARANCE:
            raise InputError(
                f"film = run: clearance = {written(self.clearance, 'm')} is "
                f"{1e3 * relative:.3g} per mille of the radius of the bearing; allowed is up to "
                f"{1e3 * OILED_CLEARANCE:g} per mille, or film = report"
            )
        ratio = 0.5 * self.width / self.bearing_radius
        lowest = (1.0 - _ROUND_OFF) * MIN_FILM_WIDTH
        highest = (1.0 + _ROUND_OFF) * MAX_FILM_WIDTH
        if not lowest <= ratio <= highest:
            raise InputError(
                f"film = run: width = {written(self.width, 'm')} is {ratio:.3g} of the diameter of "
                f"the bearing; allowed is {MIN_FILM_WIDTH:g} to {MAX_FILM_WIDTH:g}, "
                "or film = report"
            )
        self._check_laws_with_film()

    def _check_laws_with_film(self) -> None:
        """Raise InputError for laws of contact and wear that an oil film does not allow."""
        if not isinstance(self.normal_law, str):
            raise InputError(
                f"normal_law = {self.normal_law}: with film = run allowed is "
                f"{', '.join(DAMPINGS)}"
            )
        if self.friction_law in [*WITH_SETTINGS]:
            raise InputError(
                f"friction_law = {self.friction_law}: with film = run allowed is "
                f"{', '.join(WITHOUT_SETTINGS)} or a user law"
            )
        if self.wears_by_pressure:
            raise InputError(
                f"wear_law = {self.wear_law}: with film = run allowed is a law without pressure"
            )
        if self.materials.pressure_exponent != 1.0:
            raise InputError(
                f"pressure_exponent = {self.materials.pressure_exponent:g}: with film = run "
                "allowed is 1"
            )

    @property
    def unread(self) -> tuple[str, ...]:
        """Names of the settings that have no effect with this clearance and these laws."""
        if self.clearance == 0.0:
            read = _READ_RIGID
            if self.stiffness is None:
                read = read.difference(NOT_COMMON)
            return tuple(item.name for item in fields(self) if item.name not in read)
        names = [*NOT_COMMON]
        if self.has_film:
            names += "normal_law", "viscous_damping"
        else:
            names.append("asperity_pressure")
        if self.viscosity is None:
            names.append("film")
        for law, settings in WITH_SETTINGS.items():
            if self.friction_law != law:
                names += [item.name for item in fields(settings)]
        if self.normal_law != KELVIN_VOIGT and not self.has_film:
            names.append("viscous_damping")
        if not self._reads_roughness:
            names.append("roughness")
        if self.materials.running_in == 1.0:
            names.append("running_in_depth")
        if self.materials.pressure_exponent == 1.0:
            names.append("pressure_reference")
        if self.wear_law != ARCHARD:
            names += "running_in", "pressure_exponent"
        return tuple(names)

    @property
    def _reads_roughness(self) -> bool:
        """True if the oil film or the depth of running-in is compared with the roughness."""
        pair = self.materials
        runs_in = pair.running_in != 1.0 and pair.running_in_depth is None
        return self.viscosity is not None or runs_in

    @property
    def total_width(self) -> float:
        """Axial width of all parallel rods together, m."""
        return self.parallel_rods * self.width

    @property
    def friction_parameters(self) -> FrictionLaw:
        """Friction law with its parameters."""
        law = self.friction_law
        function = law if isinstance(law, UserFunction) else None
        name = "ramp" if function else str(law)
        ramp = self.friction, self.lower_speed, self.upper_speed
        return FrictionLaw(*ramp, name, function, friction_settings(name, self))
