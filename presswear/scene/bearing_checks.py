"""Checks of a bearing against the conventions of its scene."""

from presswear.linkage.clearance_joint import SurfaceContact
from presswear.linkage.normal_law import DAMPINGS
from presswear.scene.bearing import AUTO, Bearing
from presswear.scene.conventions import Conventions
from presswear.tools.errors import InputError
from presswear.tools.quantities import written


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
