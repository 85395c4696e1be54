"""Warnings about numbers that machines rarely have, such as a mass in g written as kg."""

import math
from collections.abc import Mapping, Sequence
from itertools import combinations

from presswear.linkage.bodies import Body
from presswear.linkage.linkage import Linkage
from presswear.linkage.oil import MAX_FILM_WIDTH, MIN_FILM_WIDTH, OILED_CLEARANCE
from presswear.linkage.process import Process
from presswear.scene.bearing import Bearing
from presswear.scene.scene import Scene
from presswear.tools.numbers import quantity_text, readable

STEEL = 7850.0  # density, kg/m^3
# Lowest and highest usual value of each quantity, and its SI unit
USUAL = {
    "length": (0.0, 10.0, "m"),
    "mass ratio": (0.0, 1e3, ""),
    # 0.29 of a bar; a flywheel on a small eccentric is far above
    "gyration": (0.03, 30.0, ""),
    "relative clearance": (1e-5, 0.1, ""),  # 1e-3 of a new bearing; 0.053 in the paper
    "speed": (0.0, 2000.0, "rad/s"),
    "stress": (0.0, 300e6, "Pa"),  # a structural steel yields
    "viscosity": (1e-3, 0.9, "Pa s"),  # water at 20 °C; ISO VG 1000 at 40 °C
    # The formulas of the oil film hold between these values.
    "oiled clearance": (1e-5, OILED_CLEARANCE, ""),
    "oiled width": (MIN_FILM_WIDTH, MAX_FILM_WIDTH, ""),
    "pin pressure": (0.0, 300e6, "Pa"),  # bronze bears 60 MPa, hardened steel 250 MPa
}


def unusual(key: str, value: float, words: str) -> list[str]:
    """Return a sentence on an SI value outside its usual range; empty inside the range."""
    low, high, _ = USUAL[key]
    if low <= value <= high:
        return []
    return [_unusual_text(key, [value], words)]


def unusual_joints(key: str, values: Mapping[str, float], words: str) -> list[str]:
    """Return sentences on SI values of joints below and above their usual range.

    ``words`` contain ``{joints}`` where the names of the joints are to be.
    """
    low, high, _ = USUAL[key]
    below = {name: value for name, value in values.items() if value < low}
    above = {name: value for name, value in values.items() if value > high}
    lines = []
    for side in (below, above):
        if side:
            noun = "joint" if len(side) == 1 else "joints"
            joints = f"{noun} {' and '.join(side)}"
            text = words.format(joints=joints)
            lines.append(_unusual_text(key, list(side.values()), text))
    return lines


def _unusual_text(key: str, values: Sequence[float], words: str) -> str:
    """Return the sentence on SI values on one side of their usual range."""
    low, high, unit = USUAL[key]
    limit = f"up to {quantity_text(high, unit)}"
    if values[0] < low:
        limit = f"at least {readable(low)}"
    texts = " and ".join(dict.fromkeys(quantity_text(value, unit) for value in values))
    return f"{words} is {texts} (usual: {limit}); check the units"


def doubts(scene: Scene) -> list[str]:
    """Return a sentence on each number of a scene that is not plausible, or not unique."""
    linkage = scene.base_linkage
    lines = []
    if repeated := scene.ideal.rows.repeated:
        lines.append(
            f"without clearance {repeated} of the constraints of joints and drives repeats others: "
            "the forces without clearance are those of smallest norm"
        )
    lines += _unused_limit(scene)
    lines += _body_doubts(linkage)
    for drive in linkage.drives:
        lines += unusual("speed", abs(drive.speed), f"the speed of {drive.body}")
    bearings = {name: scene.bearing(name) for name in scene.loose_pins}
    lines += _clearance_doubts(bearings)
    if scene.process is not None:
        lines += _stress_doubts(linkage, scene.process)
    return lines


def _body_doubts(linkage: Linkage) -> list[str]:
    """Return sentences on masses, lengths and inertias that are not plausible."""
    heavy = max(linkage.bodies, key=lambda body: body.mass)
    light = min(linkage.bodies, key=lambda body: body.mass)
    words = f"the mass of {heavy.name}, {readable(heavy.mass)} kg, divided by that of {light.name}"
    lines = unusual("mass ratio", heavy.mass / light.mass, words)
    for body in linkage.bodies:
        length = _length(linkage, body)
        lines += unusual("length", length, f"the distance of the joints of {body.name}")
        if length and body.inertia:
            ratio = math.sqrt(body.inertia / body.mass) / length
            words = f"the radius of gyration of {body.name}, divided by the distance of its joints,"
            lines += unusual("gyration", ratio, words)
    return lines


def _stress_doubts(linkage: Linkage, process: Process) -> list[str]:
    """Return a sentence if the force of a process is too large for the thinnest body.

    A body is taken as a steel bar of its length and mass.
    """
    force = max(force for _, force in process.curve)
    thinnest = max(linkage.bodies, key=lambda body: _length(linkage, body) / body.mass)
    stress = force * STEEL * _length(linkage, thinnest) / thinnest.mass
    words = (
        f"the mean stress in a steel bar of the length and mass of {thinnest.name}, "
        f"{readable(thinnest.mass)} kg, under the process force of {quantity_text(force, 'N')}"
    )
    return unusual("stress", stress, words)


def _unused_limit(scene: Scene) -> list[str]:
    """Return a sentence on a torque limit of a mechanism of which no drive has one."""
    limit = getattr(scene.mechanism, "torque_limit", None)
    drives = scene.base_linkage.drives
    if limit is None or any(drive.torque_limit is not None for drive in drives):
        return []
    return [
        f"torque_limit = {quantity_text(limit, 'N m')} has no effect beside a motor, whose "
        "greatest torque is breakdown x torque"
    ]


def _clearance_doubts(bearings: Mapping[str, Bearing]) -> list[str]:
    """Return sentences on clearances, and on oiled joints for which no formula of a film holds."""
    clearance = {}  # over the radius of the bearing
    oiled_clearance = {}
    oiled_width = {}  # over the diameter of the bearing
    viscosity = {}
    for name, bearing in bearings.items():
        clearance[name] = bearing.clearance / bearing.bearing_radius
        if bearing.viscosity is not None:
            viscosity[name] = bearing.viscosity
            oiled_clearance[name] = clearance[name]
            oiled_width[name] = 0.5 * bearing.width / bearing.bearing_radius
    clearance_words = "the clearance of {joints}, divided by the radius of the bearing,"
    oiled_words = "the clearance divided by the radius of the oiled bearing of {joints}"
    width_words = "the width divided by the diameter of the oiled bearing of {joints}"
    return [
        *unusual_joints("relative clearance", clearance, clearance_words),
        *unusual_joints("viscosity", viscosity, "the viscosity of {joints}"),
        *unusual_joints("oiled clearance", oiled_clearance, oiled_words),
        *unusual_joints("oiled width", oiled_width, width_words),
    ]


def _length(linkage: Linkage, body: Body) -> float:
    """Return the largest distance between joints of a body, m."""
    points = []
    for joint in linkage.revolutes:
        points += [(end.x, end.y) for end in joint.ends if end.body == body.name]
    return max((math.dist(*pair) for pair in combinations(points, 2)), default=0.0)
