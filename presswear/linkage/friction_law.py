"""Friction law of a joint, its state and its checks if it is a function of the user."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from presswear.tools.errors import InputError
from presswear.tools.serialize import Checked
from presswear.tools.user_function import UserFunction

FRICTION_PARAMETERS = ("sliding", "normal", "coefficient", "lower_speed", "upper_speed")
"""Parameters of a user friction law: m/s, N, -, m/s, m/s."""

STATE_PARAMETERS = (*FRICTION_PARAMETERS, "state")
"""Parameters of a user friction law with a state, m."""

RATE_PARAMETERS = ("sliding", *FRICTION_PARAMETERS[2:], "state", "closed")
"""Parameters of the rate of this state, m/s; ``closed`` is 1 in contact and 0 in flight."""

# Sliding speeds, m/s, and normal force, N, at which user laws are checked
CHECKED_SPEEDS = 0.01, 0.1, 0.4, 1.0, 4.0
CHECKED_FORCE = 100.0
BISECTIONS = 80  # bisections for the state of steady sliding, to round-off
STATE_SCALE = 1e-6  # m, of the state of a law without the number ``scale``


@dataclass(frozen=True)
class FrictionLaw(Checked):
    """Friction law of one joint: a named law, or a user function of FRICTION_PARAMETERS.

    The names are those of ``linkage.friction_settings.FRICTIONS``.
    """

    coefficient: float = 0.0  # c_f; 0: none, whatever the law
    lower: float = 1e-4  # v_0, m/s: no friction below
    upper: float = 1e-3  # v_1, m/s: full friction above
    name: str = "ramp"
    user_law: UserFunction | None = None  # force along the sliding, N
    settings: Any = None  # settings of a law that has some, such as LuGreSettings


def has_state(law: UserFunction) -> bool:
    """Return whether a user friction law has a state."""
    return "state" in law.parameters("friction_law", STATE_PARAMETERS)


def rate_of(law: UserFunction) -> UserFunction:
    """Return the function of RATE_PARAMETERS that is the rate of the state of a law."""
    rate = UserFunction(f"{law.name}_rate", law.source)
    numbers = rate.numbers("friction_law", RATE_PARAMETERS)
    names = {number.name for number in numbers}
    values = {name: value for name, value in law.values if name in names}
    return rate.with_values("friction_law", values, RATE_PARAMETERS)


def state_scale(law: UserFunction) -> float:
    """Return a change of the state that matters, m: the number ``scale`` of a law."""
    settings = law.settings("friction_law", STATE_PARAMETERS)
    values = {number.name: value for number, value in settings}
    return values.get("scale", STATE_SCALE)


def steady_state(key: str, law: UserFunction, values: Mapping[str, float]) -> float:
    """Return the state of steady sliding, m, between -1 and 1 m, by bisection."""
    rate = rate_of(law)

    def slope(state: float) -> float:
        point = {**values, "state": state, "closed": 1.0}
        return rate.evaluate(key, RATE_PARAMETERS, point)

    low = -1.0
    high = 1.0
    if not slope(low) >= 0.0 >= slope(high):
        raise InputError(
            f"{key}: {rate.name} must fall with the state, from above 0 at -1 m to below 0 at 1 m"
        )
    for _ in range(BISECTIONS):
        middle = 0.5 * (low + high)
        if slope(middle) > 0.0:
            low = middle
        else:
            high = middle
    return 0.5 * (low + high)


def check_friction(key: str, law: UserFunction, values: Mapping[str, float]) -> None:
    """Raise InputError where a user friction law gives no number, creates energy or jumps."""
    upper_speed = values["upper_speed"]
    for speed in (0.1 * upper_speed, upper_speed, *CHECKED_SPEEDS):
        for sliding in (speed, -speed):
            state = {**values, "sliding": sliding, "normal": CHECKED_FORCE}
            if has_state(law):
                state["state"] = steady_state(key, law, state)
            force = law.evaluate(key, STATE_PARAMETERS, state)
            if force * sliding > 0.0:
                fault = (
                    f"it gives {force:g} N where the surfaces slide at {sliding:g} m/s"
                )
                remedy = "a force against the sliding has the other sign"
                raise InputError(f"{key}: {law.name} makes energy: {fault}; {remedy}")
    if has_state(law):
        return  # The state changes steadily, and with it the force.
    if jump := law.jump("sliding", {**values, "normal": CHECKED_FORCE}):
        place, below, above = jump
        fault = (
            f"{law.name} jumps from {below:g} to {above:g} N at sliding = {place:g} m/s"
        )
        raise InputError(
            f"{key}: {fault}: it must be continuous; use tanh(sliding / upper_speed)"
        )
