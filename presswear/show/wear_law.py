"""Numbers of the wear law of each joint, and the origin of each of them."""

from presswear.linkage.materials import UNLISTED, Materials, listed_pair
from presswear.linkage.wear_law import ARCHARD
from presswear.scene.scene import Scene
from presswear.scene.setting_list import DEFAULT, unread_of
from presswear.tools.quantities import Quantity, written

# Setting and unit by symbol of the law
NUMBERS = {
    "K_d": ("wear_coefficient", "1/Pa"),
    "rho": ("running_in", ""),
    "h_0": ("running_in_depth", "m"),
    "m": ("pressure_exponent", ""),
    "p_ref": ("pressure_reference", "Pa"),
}


def wear_law_numbers(scene: Scene) -> str:
    """Return the numbers of the wear law and their origins as one text, by joint if they differ."""
    parts = []
    for symbol, (key, unit) in NUMBERS.items():
        joints_by_text: dict[str, list[str]] = {}
        for joint in scene.wearing_joints:
            if key in unread_of(scene, joint):
                continue
            text = _number(scene, joint, key, unit)
            joints_by_text.setdefault(text, []).append(joint)
        for text, joints in joints_by_text.items():
            places = f" at {' and '.join(joints)}" if len(joints_by_text) > 1 else ""
            parts.append(f"{symbol} = {text}{places}")
    return "; ".join(parts)


def user_wear_laws(scene: Scene) -> list[str]:
    """Return a sentence on each user wear law and its joints."""
    joints: dict[str, list[str]] = {}
    for name in scene.loose_pins:
        law = scene.bearing(name).wear_law
        if law != ARCHARD:
            joints.setdefault(f"{law}", []).append(name)
    return [
        f"At {' and '.join(names)} the {law} gives the wear coefficient in place of K_d, p_ref, "
        "m, rho and h_0."
        for law, names in joints.items()
    ]


def _number(scene: Scene, joint: str, key: str, unit: str) -> str:
    """Return the value of a number of a joint and its origin as a text."""
    bearing = scene.bearing(joint)
    value = getattr(bearing.materials, key)
    if value is None:
        # The only number that can be unspecified is the depth of running-in.
        return f"{written(bearing.roughness, unit)} (the roughness)"
    return f"{Quantity(unit).typeset(value)} ({_origin(scene, joint, key, value)})"


def _origin(scene: Scene, joint: str, key: str, value: float) -> str:
    """Return the origin of a number: a setting, an assumption or a listed pair of materials."""
    origin = scene.origins.get(f"{joint}.{key}", scene.origins.get(key, DEFAULT))
    if origin != DEFAULT:
        return origin
    if value == getattr(Materials(), key):
        return "assumed"
    pair = "" if key in UNLISTED else listed_pair(scene.bearing(joint).materials)
    return f"materials {pair}" if pair else "set by the user"
