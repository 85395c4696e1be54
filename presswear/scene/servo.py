"""Servo motions that the linkage of the press cannot follow: the value to change, and its range."""

import math
from dataclasses import fields, replace
from typing import Any

from presswear.linkage.mechanisms import Press
from presswear.physics.ideal import motion_of
from presswear.tools.errors import InputError
from presswear.tools.quantities import Quantity, meaning_of

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
