"""Random scenes, and how each ends in an engine.

Every quantity is drawn over its whole range, by its logarithm where that spans decades.  Links
are drawn around a geometry that assembles, all of one scale: independent ones never would.
Inertias are those that links of their masses and lengths can have, bearings are no larger than
the shortest link.
"""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, fields, replace
from random import Random
from typing import Any

from endurance.subject import OutsideError, run_part
from presswear.linkage.laws import DAMPINGS, KELVIN_VOIGT, LUGRE, Materials
from presswear.linkage.mechanisms import GEOMETRIES, Press, SliderCrank
from presswear.scene.bearing import LEAST_RAMP, Bearing, Conventions
from presswear.scene.catalog import slider_crank, wear_times
from presswear.scene.options import Numerics
from presswear.scene.scene import MAX_MASS_RATIO, Scene
from presswear.tools.errors import AssemblyError, InputError, RunFailed
from presswear.tools.quantities import Choice, Quantity, meaning_of
from presswear.validation.cases import ENERGY

# Coarsest tolerances drawn: those at which statistics are still usable for wear. Coarser ones are
# allowed, for showing how wrong they are; a run says so by its energy.
COARSEST = {"integration_tolerance": 1e-5, "tree_tolerance": 1e-4}
# Of the in-house solver: below, a stiff damper on a light link ends in round-off, and says so.
FINEST = 1e-11
GYRATION = (0.01, 10.0)  # Radius of gyration of a link, part of its length
# Energy that may be missing however coarse a scene asks to be solved, part of that exchanged.
MISSING = 1e-2
# Part of the kinetic energy that counts as exchanged: of a run of a few steps, hardly any is, and
# what is missing is round-off of what all bodies hold.
UNEXCHANGED = 1e-7
# Steps after which an engine tells how far it is.
STEPS_BETWEEN_LOOKS = {"dae": 2000, "exudyn-tree": 512, "exudyn-joints": 512}
_ENDS = 0.08  # Part of all draws that take an end of their range
_LEAST = 1e-9  # Smallest value drawn from a range that begins at zero, part of its end
_CHANGE = 0.15  # Standard deviation of the logarithm of a link's length
_LENGTHS = ("length_", "side_b", "side_cd", "crank_length", "rod_length")
# A cycle is run: that of a long run-up is hardly a motion. Drawn limits are mostly refused.
_DRAWN_APART = (*_LENGTHS, "run_up", "torque_limit")


def _spread(draw: Random, low: float, high: float) -> float:
    return math.exp(draw.uniform(math.log(low), math.log(high)))


def _value(draw: Random, meaning: Quantity) -> float:
    """A value of a range; its ends now and then."""
    low, high = meaning.low, meaning.high
    if draw.random() < _ENDS:
        end = draw.choice((low, high))
        if not (end == low and meaning.open_low):
            return end
    if low < 0.0 or (low == 0.0 and not meaning.unit):
        return draw.uniform(low, high)
    low = low or _LEAST * high
    if high > 10.0 * low:
        return min(max(_spread(draw, low, high), low), high)
    return draw.uniform(low, high)


def _drawn(draw: Random, owner: Any, apart: tuple[str, ...] = ()) -> dict[str, Any]:
    """Values of the quantities and choices of a data class, some left as they are."""
    results: dict[str, Any] = {}
    for item in fields(owner):
        meaning = meaning_of(item, owner)
        if item.name.startswith(apart):
            continue
        if isinstance(meaning, Choice) and not meaning.instances and not meaning.kinds:
            results[item.name] = draw.choice(meaning.words)
        elif isinstance(meaning, Quantity):
            value = _value(draw, meaning)
            results[item.name] = round(value) if meaning.whole else value
    return results


def _bearings(draw: Random, shortest: float) -> Bearing:
    """Bearing whose quantities fit together, no larger than the shortest link, m."""
    values = _drawn(draw, Bearing(), ("contact_stiffness",))
    values["materials"] = Materials(**_drawn(draw, Materials(), ("bearing_modulus",)))
    if values["elasticity"] != "power":
        values["exponent"] = 1.5
    held = max(values["static_friction"], values["friction"])
    values["static_friction"] = held if values["friction_law"] == LUGRE else None
    # Damping without bounds is stiff without bounds.
    least = DAMPINGS[values["normal_law"]].least
    values["restitution"] = max(values["restitution"], 0.05 if least > 0.0 else 0.0)
    viscous = min(values["viscous_damping"], 1e3)
    values["viscous_damping"] = viscous if values["normal_law"] == KELVIN_VOIGT else 0.0
    values["bearing_radius"] = min(values["bearing_radius"], max(shortest, 1e-4))
    # Values that must be in order are drawn below each other.
    least, most = 1e-9, 0.999 * values["bearing_radius"]
    values["clearance"] = least * (most / least) ** draw.random()
    highest = max(values["upper_speed"] - LEAST_RAMP, 0.0)
    values["lower_speed"] = highest * draw.choice((0.0, _LEAST, draw.random(), 1.0))
    return Bearing(**values)


def _links(draw: Random, owner: Any, scale: float) -> dict[str, float]:
    results: dict[str, float] = {}
    for item in fields(owner):
        meaning = meaning_of(item)
        if item.name.startswith(_LENGTHS) and isinstance(meaning, Quantity):
            length = scale * getattr(owner, item.name) * math.exp(draw.gauss(0.0, _CHANGE))
            results[item.name] = min(max(length, meaning.low), meaning.high)
    return results


def _weights(
    draw: Random, owner: Any, links: tuple[tuple[str, str, float], ...]
) -> dict[str, float]:
    """Masses that can move together, and inertias of links that fit their masses and lengths."""
    heaviest = _spread(draw, 1e-6 * MAX_MASS_RATIO, 1e4)
    masses = [item.name for item in fields(owner) if "mass" in item.name]
    results = {name: heaviest * MAX_MASS_RATIO ** -draw.random() for name in masses}
    for inertia, mass, length in links:
        least, most = GYRATION
        part = least * (most / least) ** draw.random()
        results[inertia] = min(max(results[mass] * (part * length) ** 2, 1e-9), 1e4)
    return results


def _mechanism(draw: Random) -> Press | SliderCrank:
    scale = _spread(draw, 0.05, 20.0)
    if draw.random() < 0.5:
        crank = SliderCrank()
        links = _links(draw, crank, scale)
        weights = _weights(draw, crank, (("rod_inertia", "rod_mass", links["rod_length"]),))
        return SliderCrank(**(_drawn(draw, crank, _DRAWN_APART) | weights | links))
    press = Press(geometry=draw.choice(list(GEOMETRIES.values())))
    geometry = press.geometry
    moved = {"hx": scale * geometry.hx, "hy": scale * geometry.hy}
    placed = replace(geometry, **moved, **_links(draw, geometry, scale))
    links = _links(draw, press, scale)
    turning = (
        ("inertia_3", "mass_3", links["length_3"]),
        ("inertia_4", "mass_4", placed.side_bd),
        ("inertia_5", "mass_5", links["length_5"]),
    )
    values = _drawn(draw, press, _DRAWN_APART) | _weights(draw, press, turning) | links
    return Press(geometry=placed, **values)


def _numerics(draw: Random) -> Numerics:
    usual = Numerics()
    values: dict[str, Any] = {}
    for engine in (usual.tree, usual.joints, usual.dae):
        values |= _drawn(draw, engine, ("integrator", "equal_step"))
    values |= {key: min(values[key], most) for key, most in COARSEST.items()}
    values["integration_tolerance"] = max(values["integration_tolerance"], FINEST)
    return usual.having(integrator=draw.choice(("dop853", "dopri5")), **values)


def scene_of(draw: Random) -> Scene:
    """A random scene; InputError where it is refused."""
    mechanism = _mechanism(draw)
    base = wear_times() if isinstance(mechanism, Press) else slider_crank()
    conventions = Conventions(**_drawn(draw, Conventions()))
    lengths = [item.name for item in fields(mechanism) if item.name.startswith(_LENGTHS)]
    bearings = _bearings(draw, min(getattr(mechanism, name) for name in lengths))
    if conventions.contact == "foundation":
        bearings = replace(bearings, exponent=1.5)
    joints = draw.choice([*mechanism.openable, "".join(mechanism.openable), "none"])
    return replace(
        base,
        mechanism=mechanism,
        bearings=bearings,
        conventions=conventions,
        numerics=_numerics(draw),
        joints=joints,
        wear_updates=0,
        replicates=1,
        origins={},
    )


def random_scenes(count: int, seed: int) -> Iterator[tuple[Scene, int]]:
    """So many scenes, each with the number of those refused before it as not assembling."""
    for place in range(count):
        draw = Random(f"{seed} {place}")
        refused = 0
        while True:
            try:
                scene = scene_of(draw)
                scene.check()
            except InputError as error:
                if not isinstance(error, AssemblyError) and "triangle" not in str(error):
                    raise
                refused += 1
            else:
                yield scene, refused
                break


@dataclass(frozen=True)
class Ended:
    """Outcome of a scene in an engine."""

    part: float  # of a cycle that was run
    residual: float = math.nan  # energy that is missing, part of what the drives exchanged
    bound: float = 0.0
    failure: str = ""
    is_outside: bool = False  # a pin sank in deeper than it is thick: no law of contact covers it

    @property
    def passed(self) -> bool:
        return not self.failure and self.residual <= self.bound


class TooLongError(RunFailed):
    """A run that has taken all its steps."""

    def __init__(self, done: float, steps: int) -> None:
        super().__init__(f"it takes more than {steps} steps")
        self.done = done


def limited(scene: Scene, most: int) -> Callable[[float], None]:
    """Return a function that stops a run after so many steps."""
    left = most // STEPS_BETWEEN_LOOKS[scene.solver.word]

    def look(done: float) -> None:
        nonlocal left
        left -= 1
        if left < 0:
            raise TooLongError(done, most)

    return look


def ended(scene: Scene, most: int) -> Ended:
    """Run a cycle of a scene, or what so many steps reach of it."""
    part = 1.0
    try:
        try:
            energy = run_part(scene, part, limited(scene, most))
        except TooLongError as reached:
            part = 0.9 * reached.done
            energy = run_part(scene, part, limited(scene, 2 * most))
    except (InputError, RunFailed, ArithmeticError) as error:
        return Ended(part, failure=f"{error}", is_outside=isinstance(error, OutsideError))
    residual = energy.missing / (energy.exchanged + UNEXCHANGED * energy.kinetic)
    return Ended(part, residual, min(ENERGY[scene.solver.word] * coarser(scene), MISSING))


def coarser(scene: Scene) -> float:
    """Return the factor of the allowed error relative to standard steps and tolerances.

    It grows with the tolerance, and with the square of a step.
    """
    usual, numerics = Numerics(), scene.numerics
    steps = ("steps_per_contact", "steps_sustained", "free_steps")
    ratio = {
        "dae": numerics.dae.tolerance / usual.dae.tolerance,
        "exudyn-tree": numerics.tree.tolerance / usual.tree.tolerance,
        "exudyn-joints": max(
            getattr(usual.joints, name) / getattr(numerics.joints, name) for name in steps
        )
        ** 2,
    }
    return max(1.0, ratio[scene.solver.word])
