"""Values that are not plausible: unusual numbers, and servo motions that a press cannot follow.

An unusual number, such as a mass in g that was written as kg, gives a warning. A servo motion that
the linkage cannot follow is an error, with the value to change and its range.
"""

import math
from dataclasses import fields, replace
from itertools import combinations
from operator import attrgetter
from typing import Any

from presswear.linkage.elements import Body
from presswear.linkage.linkage import Linkage
from presswear.linkage.mechanisms import Press
from presswear.physics.ideal import motion_of
from presswear.scene.scene import Scene
from presswear.tools.errors import InputError
from presswear.tools.numbers import quantity_text, readable
from presswear.tools.quantities import Quantity, meaning_of

_MASS = attrgetter("mass")
STEEL = 7850.0  # density, kg/m^3
# Lowest and highest usual value of each quantity, and its SI unit
USUAL = {
    "length": (0.0, 10.0, "m"),
    "mass ratio": (0.0, 1e3, ""),
    "gyration": (0.03, 30.0, ""),  # 0.29 of a bar; a flywheel on a small eccentric is far above
    "relative clearance": (1e-5, 0.1, ""),  # 1e-3 of a new bearing; 0.053 in the paper
    "speed": (0.0, 2000.0, "rad/s"),
    "stress": (0.0, 300e6, "Pa"),  # a structural steel yields
    "pin pressure": (0.0, 300e6, "Pa"),  # bronze bears 60 MPa, hardened steel 250 MPa
}


def unusual(key: str, value: float, words: str) -> list[str]:
    """Return a sentence on an SI value outside its usual range, else nothing."""
    low, high, unit = USUAL[key]
    if low <= value <= high:
        return []
    limit = f"at least {readable(low)}" if value < low else f"up to {quantity_text(high, unit)}"
    return [f"{words} is {quantity_text(value, unit)} (usual: {limit}); check the units"]


def doubts(scene: Scene) -> list[str]:
    """Return a sentence on each number of a scene that is not plausible."""
    linkage, lines = scene.base_linkage, []
    heavy, light = max(linkage.bodies, key=_MASS), min(linkage.bodies, key=_MASS)
    words = f"the mass of {heavy.name}, {readable(heavy.mass)} kg, divided by that of {light.name}"
    lines += unusual("mass ratio", heavy.mass / light.mass, words)
    for body in linkage.bodies:
        length = _length(linkage, body)
        lines += unusual("length", length, f"the distance of the joints of {body.name}")
        if length and body.inertia:
            ratio = math.sqrt(body.inertia / body.mass) / length
            words = f"the radius of gyration of {body.name}, divided by the distance of its joints,"
            lines += unusual("gyration", ratio, words)
    for drive in linkage.drives:
        lines += unusual("speed", abs(drive.speed), f"the speed of {drive.body}")
    for name in scene.clearance_joints:
        bearing = scene.bearing(name)
        words = f"the clearance of joint {name}, divided by the radius of its bearing,"
        lines += unusual("relative clearance", bearing.clearance / bearing.bearing_radius, words)
    if scene.process is not None:
        # The body that is too light for the force of the process, as a bar.
        force = max(force for _, force in scene.process.curve)
        body = max(linkage.bodies, key=lambda one: _length(linkage, one) / one.mass)
        stress = force * STEEL * _length(linkage, body) / body.mass
        words = f"the mean stress in a steel bar of the length and mass of {body.name}, "
        words += f"{readable(body.mass)} kg, under the process force of {quantity_text(force, 'N')}"
        lines += unusual("stress", stress, words)
    return lines


def _length(linkage: Linkage, body: Body) -> float:
    """Return the largest distance between joints of a body, m."""
    ends = [end for joint in linkage.revolutes for end in (joint.first, joint.second)]
    points = [(end.x, end.y) for end in ends if end.body == body.name]
    return max((math.dist(*pair) for pair in combinations(points, 2)), default=0.0)


# Servo motions ------------------------------------------------------------------------------------

_STEPS = 8  # most steps from a value that does not work to one that does
_ANGLE_STEP = math.radians(15.0)
_RELATIVE_STEP = 0.15  # of values that are no angles
_HALVINGS = 3  # of the step in which a range ends
_MARGIN = 0.01  # part of a range that is left out at its ends


def servo_fault(press: Press) -> InputError | None:
    """Return the error for a servo value with the range that works; None if no range is found.

    The other values stay as they are. Values that differ from their defaults are tried first.
    """
    servo: Any = press.servo
    default = type(servo)()
    meanings = {
        item.name: meaning
        for item in fields(servo)
        if isinstance(meaning := meaning_of(item), Quantity)
    }

    def is_default(name: str) -> bool:
        return math.isclose(getattr(servo, name), getattr(default, name), rel_tol=1e-5)

    for name in sorted(meanings, key=is_default):
        meaning = meanings[name]
        if ends := _range(press, name, meaning):
            margin = _MARGIN * (ends[1] - ends[0])
            low, high = meaning.written(ends[0] + margin, 3), meaning.written(ends[1] - margin, 3)
            allowed = f"with the other values of the servo allowed is {low} to {high}"
            label = f"servo.{name} = {meaning.written(getattr(servo, name))}"
            return InputError(f"{label}: the linkage cannot follow this motion; {allowed}")
    return None


def _range(press: Press, name: str, meaning: Quantity) -> tuple[float, float] | None:
    """Return the interval of a servo value that works and is nearest to the present value."""
    servo: Any = press.servo
    value = getattr(servo, name)
    step = _ANGLE_STEP if meaning.unit == "rad" else _RELATIVE_STEP * value

    def works(value: float) -> bool:
        try:
            motion_of(replace(press, servo=replace(servo, **{name: value})))
        except InputError:
            return False
        return True

    def end(inside: float, outside: float) -> float:
        for _ in range(_HALVINGS):
            middle = 0.5 * (inside + outside)
            inside, outside = (middle, outside) if works(middle) else (inside, middle)
        return inside

    for count in range(1, _STEPS + 1):
        for way in (-step, step):
            near = far = value + count * way
            if works(near):
                while works(far + way):
                    far += way
                low, high = sorted((end(near, near - way), end(far, far + way)))
                return low, high
    return None
