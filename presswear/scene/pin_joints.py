"""Pin joints of a linkage from the settings of their bearings: sizes, laws and oil."""

import math
from dataclasses import replace
from typing import cast

from presswear.linkage.clearance_joint import (
    ClearanceJoint,
    SurfaceContact,
    deepest_wear,
)
from presswear.linkage.friction_law import (
    RATE_PARAMETERS,
    STATE_PARAMETERS,
    check_friction,
    has_state,
    rate_of,
)
from presswear.linkage.joints import Revolute
from presswear.linkage.normal_law import (
    DAMPINGS,
    NORMAL_PARAMETERS,
    Elasticity,
    NormalLaw,
    StiffnessReading,
    check_normal,
    conforming_stiffness,
    damping_ratio,
    hertz_stiffness,
    liu_stiffness,
)
from presswear.linkage.oil import OILED_WEAR, Oil
from presswear.linkage.surface import Surface
from presswear.linkage.wear_law import WEAR_PARAMETERS, WearLaw, check_wear
from presswear.scene.bearing import AUTO, Bearing
from presswear.scene.conventions import Conventions
from presswear.tools.compiled_law import check_compiles
from presswear.tools.errors import InputError
from presswear.tools.quantities import written
from presswear.tools.serialize import LARGEST
from presswear.tools.user_function import UserFunction


def elastic_law(bearing: Bearing, contact: SurfaceContact) -> Elasticity:
    """Return the elastic law of a contact of surfaces, new and worn."""
    if contact == "foundation":
        return "foundation"
    if bearing.elasticity == AUTO:
        return "power"
    return cast(Elasticity, bearing.elasticity)


def normal_stiffness(
    bearing: Bearing, elasticity: Elasticity, reading: StiffnessReading
) -> float:
    """Return the stiffness K, N/m^n, of all parallel rods together.

    It is the contact stiffness; by default that of Liu for his law, and of Hertz or of
    conforming pins for the other laws. Parallel rods bear equal parts of the force.
    """
    if bearing.contact_stiffness is not None:
        return bearing.parallel_rods * bearing.contact_stiffness
    compliance = bearing.materials.compliance
    width = bearing.total_width
    if elasticity == "liu":
        return liu_stiffness(width, bearing.clearance, compliance)
    if reading == "conforming":
        return conforming_stiffness(width, bearing.clearance, compliance)
    return bearing.parallel_rods * hertz_stiffness(
        bearing.bearing_radius,
        bearing.bearing_radius - bearing.clearance,
        compliance,
        reading,
    )


def _user_law(law: object) -> UserFunction | None:
    return law if isinstance(law, UserFunction) else None


def normal_law_of(bearing: Bearing, conventions: Conventions) -> NormalLaw:
    """Return the normal force law with its parameters."""
    user_law = _user_law(bearing.normal_law)
    # A user law gets the damping of this law as its parameter ``damping``.
    name = "lankarani-nikravesh" if user_law else str(bearing.normal_law)
    elasticity = elastic_law(bearing, conventions.contact)
    stiffness = normal_stiffness(bearing, elasticity, conventions.stiffness)
    if stiffness > LARGEST:
        raise InputError(
            f"stiffness of the contact = {stiffness:.3g} N/m^n, with clearance = "
            f"{written(bearing.clearance, 'm')}: allowed is up to {LARGEST:g} N/m^n, by a "
            "larger clearance, a smaller width or contact_stiffness"
        )
    return NormalLaw(
        stiffness=stiffness,
        exponent=bearing.exponent,
        damping=DAMPINGS[name].factor(bearing.restitution),
        viscosity=bearing.parallel_rods * bearing.viscous_damping,
        elasticity=elasticity,
        user_law=user_law,
    )


def check_user_laws(bearing: Bearing, joint: str, conventions: Conventions) -> None:
    """Raise InputError if a user law returns no number or creates energy; executes the law."""
    normal_law = _user_law(bearing.normal_law)
    if normal_law is not None:
        key = f"{joint}.normal_law"
        normal = normal_law_of(bearing, conventions)
        values = {
            "stiffness": normal.stiffness,
            "exponent": normal.exponent,
            "damping": normal.damping,
            "clearance": bearing.clearance,
        }
        check_normal(key, normal_law, values)
        check_compiles(normal_law, key, NORMAL_PARAMETERS)
    wear_law = _user_law(bearing.wear_law)
    if wear_law is not None:
        key = f"{joint}.wear_law"
        check_wear(key, wear_law, bearing.materials.wear_coefficient)
        check_compiles(wear_law, key, WEAR_PARAMETERS)
    check_user_friction(bearing, joint)


def check_user_friction(bearing: Bearing, joint: str) -> None:
    """Raise InputError if a user friction law is unsound; see ``check_user_laws``."""
    law = _user_law(bearing.friction_law)
    if law is None:
        return
    key = f"{joint}.friction_law"
    values = {
        "coefficient": bearing.friction,
        "lower_speed": bearing.lower_speed,
        "upper_speed": bearing.upper_speed,
    }
    check_friction(key, law, values)
    if has_state(law):
        check_compiles(rate_of(law), key, RATE_PARAMETERS)
    check_compiles(law, key, STATE_PARAMETERS)


def rigid_joint(bearing: Bearing, revolute: Revolute) -> Revolute:
    """Return a pin joint without clearance, ideal or elastic, with the friction of a bearing."""
    stiffness = bearing.stiffness
    if stiffness is not None:
        stiffness *= bearing.parallel_rods
    return replace(
        revolute,
        bearing_radius=bearing.bearing_radius,
        friction=bearing.friction_parameters,
        stiffness=stiffness,
        damping_ratio=bearing.damping_ratio,
    )


def deepest_joint_wear(bearing: Bearing, contact: SurfaceContact) -> float:
    """Return the largest wear depth for which the model is valid, m."""
    if bearing.has_film:
        return OILED_WEAR * bearing.clearance
    return deepest_wear(contact, bearing.clearance, bearing.bearing_radius)


def oil_of(bearing: Bearing) -> Oil | None:
    """Return the oil whose film acts in the run, or None for dry contact."""
    if not bearing.has_film or bearing.viscosity is None:
        return None
    return Oil(
        viscosity=bearing.viscosity,
        roughness=math.sqrt(2.0) * bearing.roughness,
        asperity_pressure=bearing.asperity_pressure,
        films=bearing.parallel_rods,
        damping_ratio=damping_ratio(bearing.restitution),
    )


def clearance_joint(
    bearing: Bearing,
    revolute: Revolute,
    conventions: Conventions,
    surfaces: tuple[Surface, Surface],
) -> ClearanceJoint:
    """Return a revolute joint with clearance: bearing on its first end, pin on its second.

    ``surfaces`` are those of bearing and pin.
    """
    wear = WearLaw(
        coefficient=bearing.materials.wear_coefficient,
        slip=conventions.slip,
        wear_distribution=conventions.wear_distribution,
        bearing_share=bearing.materials.bearing_share,
        angles=bearing.angles,
        running_in=bearing.materials.running_in,
        running_in_depth=bearing.materials.running_in_depth or bearing.roughness,
        pressure_exponent=bearing.materials.pressure_exponent,
        pressure_reference=bearing.materials.pressure_reference,
        user_law=_user_law(bearing.wear_law),
    )
    return ClearanceJoint(
        revolute.name,
        revolute.first,
        revolute.second,
        bearing_radius=bearing.bearing_radius,
        clearance=bearing.clearance,
        width=bearing.total_width,
        normal=normal_law_of(bearing, conventions),
        friction=bearing.friction_parameters,
        wear=wear if wear.coefficient > 0.0 else None,
        map_frame=conventions.map_frame,
        contact=conventions.contact,
        bearing_surface=surfaces[0],
        pin_surface=surfaces[1],
        oil=oil_of(bearing),
    )


def check_conventions(bearing: Bearing, where: str, conventions: Conventions) -> None:
    """Raise InputError if the joint cannot wear with the conventions.

    Asperities in an oil film and a user law of the pressure wear over an arc.
    ``where`` is the start of the message.
    """
    if bearing.wears_by_pressure and conventions.wear_distribution != "arc":
        raise InputError(
            f"{where}wear_law = {bearing.wear_law}: with wear_distribution = "
            f"{conventions.wear_distribution} allowed is a law without pressure; or use "
            "wear_distribution = arc"
        )
    if not bearing.has_film or bearing.materials.wear_coefficient == 0.0:
        return
    for key, allowed in (("wear_distribution", "arc"), ("slip", "sliding")):
        if getattr(conventions, key) != allowed:
            raise InputError(
                f"{where}film = run: with {key} = {getattr(conventions, key)} allowed is "
                f"report; or use {key} = {allowed}"
            )


def check_contact(
    bearing: Bearing, where: str, contact: SurfaceContact, is_worn: bool
) -> None:
    """Raise InputError if sizes and laws of a pin do not fit the contact of the surfaces.

    ``where`` is the start of the message.
    """
    if bearing.clearance >= bearing.bearing_radius:
        radius = f"the bearing radius, {written(bearing.bearing_radius, 'm')}"
        clearance = written(bearing.clearance, "m")
        raise InputError(f"{where}clearance = {clearance}: allowed is below {radius}")
    if contact != "foundation":
        return
    if bearing.elasticity not in (AUTO, "foundation"):
        allowed = (
            "with contact = 'foundation' allowed is auto or foundation, so that new and"
        )
        advice = f"worn surfaces have one law; use contact = 'radial' with {bearing.elasticity}"
        raise InputError(
            f"{where}elasticity = {bearing.elasticity}: {allowed} {advice}"
        )
    if bearing.exponent != 1.5:
        allowed = (
            "with contact = 'foundation' allowed is 1.5; or use contact = 'radial'"
        )
        raise InputError(f"{where}exponent = {bearing.exponent:g}: {allowed}")
    if is_worn and not isinstance(bearing.normal_law, str):
        allowed = f"one of {', '.join(DAMPINGS)}; or use contact = 'radial'"
        law = f"{where}normal_law = {bearing.normal_law}"
        raise InputError(f"{law}: with contact = 'foundation' allowed is {allowed}")
