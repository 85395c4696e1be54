"""Random scenes, and how each ends in an engine.

Every quantity is drawn over its whole range, by its logarithm where that spans decades.
Links are drawn around a geometry that assembles, all of one scale: independent links
never would. Inertias fit the masses and lengths of the links; bearings are no larger
than the shortest link.
"""

import itertools
import math
import re
from collections.abc import Iterator
from dataclasses import dataclass, fields, replace
from random import Random
from typing import Any

from hard_case import ENERGY, sound

from presswear.campaign.replicates import start_of
from presswear.engines.base import Plan
from presswear.linkage.friction_settings import (
    LEAST_RELAXATION,
    LEAST_SLIP,
    LuGreSettings,
    greatest_bristle_damping,
)
from presswear.linkage.joints import MAX_SLIDE, MIN_SLIDE
from presswear.linkage.materials import Materials
from presswear.linkage.mechanisms import SliderCrank
from presswear.linkage.normal_law import DAMPINGS, KELVIN_VOIGT
from presswear.linkage.press import GEOMETRIES, Press
from presswear.physics.packed import mass_of
from presswear.scene.bearing import (
    LEAST_CLEARANCE,
    LEAST_RAMP,
    Bearing,
)
from presswear.scene.catalog import slider_crank, wear_times
from presswear.scene.conventions import Conventions
from presswear.scene.options import Numerics
from presswear.scene.pin_joints import elastic_law, normal_stiffness
from presswear.scene.run_checks import MAX_MASS_RATIO
from presswear.scene.scene import Scene
from presswear.scene.settings import changed
from presswear.tools.choices import Choice
from presswear.tools.errors import AssemblyError, InputError, RunFailed
from presswear.tools.fields import meaning_of
from presswear.tools.quantities import Quantity
from presswear.tools.serialize import LARGEST

# Coarsest tolerances at which statistics are usable for wear; coarser ones are reported
# by energy.
COARSEST = {"integration_tolerance": 1e-5, "tree_tolerance": 1e-4}
# of the in-house solver: below, a stiff damper on a light link ends in round-off
FINEST = 1e-11
MOST_BINS = 2000
GYRATION = (0.01, 10.0)  # radius of gyration of a link, part of its length
# energy that may be missing at any tolerance, part of the exchanged energy
MISSING = 1e-2
# Part of the kinetic energy that counts as exchanged: a run of a few steps exchanges
# hardly any.
UNEXCHANGED = 1e-7
# Part of the kinetic energy that Newton's method leaves open: ten times its tolerance
# of 1e-9. Measured: 8e-9 in 2,853 steps of free flight, and a tenth of it with a
# tolerance of 1e-10.
UNSOLVED = 1e-8
GUIDES = 0.3  # part of the scenes in which the slide tilts in its guide
SLIDE = (0.05, 2.0)  # length and width of a slide, parts of the rod to it
# Greatest clearance of a guide, part of the width and of what lets the slide turn over
GUIDE_CLEARANCE = 0.1
STEPS_BETWEEN_REPORTS = {"dae": 2000, "exudyn-tree": 512, "exudyn-joints": 512}
_ENDS = 0.08  # part of all draws that are an end of their range
_LEAST = 1e-9  # smallest value drawn from a range that begins at zero, part of its end
_CHANGE = 0.15  # standard deviation of the logarithm of the length of a link
_LENGTHS = ("length_", "side_b", "side_cd", "crank_length", "rod_length")
# A cycle with a long run-up is hardly a motion; drawn limits are mostly refused.
_NOT_DRAWN = ("frame_", *_LENGTHS, "run_up", "torque_limit")


def _spread(draw: Random, low: float, high: float) -> float:
    return math.exp(draw.uniform(math.log(low), math.log(high)))


def _value(draw: Random, meaning: Quantity) -> float:
    """A value of a range; its ends now and then."""
    low = meaning.low
    high = meaning.high
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


def _drawn(draw: Random, owner: Any, excluded: tuple[str, ...] = ()) -> dict[str, Any]:
    """Return random values of the quantities and choices of a data class."""
    results: dict[str, Any] = {}
    for item in fields(owner):
        meaning = meaning_of(item, owner)
        if item.name.startswith(excluded):
            continue
        if isinstance(meaning, Choice) and not meaning.instances and not meaning.kinds:
            results[item.name] = draw.choice(meaning.words)
        elif isinstance(meaning, Quantity):
            value = _value(draw, meaning)
            results[item.name] = round(value) if meaning.whole else value
    return results


def _bearings(draw: Random, shortest: float) -> Bearing:
    """Bearing whose quantities fit together, no larger than the shortest link, m."""
    # A film that acts needs a width that fits the diameter.
    values = _drawn(draw, Bearing(), ("contact_stiffness", "film"))
    values["materials"] = Materials(**_drawn(draw, Materials(), ("bearing_modulus",)))
    if values["elasticity"] in ("liu", "foundation"):
        values["exponent"] = 1.5
    held = max(values["static_friction"], values["friction"])
    values["static_friction"] = (
        held if values["friction_law"] == LuGreSettings.law else None
    )
    most = greatest_bristle_damping(values["friction"], held, values["stribeck_speed"])
    stiffest = min(values["friction"] / LEAST_SLIP, most / LEAST_RELAXATION)
    stiffness = min(values["bristle_stiffness"], stiffest)
    values["bristle_stiffness"] = max(stiffness, 1e2)
    least = values["bristle_stiffness"] * LEAST_RELAXATION
    values["bristle_damping"] = min(max(values["bristle_damping"], least), most)
    # Damping without bounds is stiff without bounds.
    least = DAMPINGS[values["normal_law"]].least
    values["restitution"] = max(values["restitution"], 0.05 if least > 0.0 else 0.0)
    viscous = min(values["viscous_damping"], 1e3)
    values["viscous_damping"] = viscous if values["normal_law"] == KELVIN_VOIGT else 0.0
    values["bearing_radius"] = min(values["bearing_radius"], max(shortest, 1e-4))
    # Values that must be in order are drawn below each other.
    least = 1e-9
    most = 0.999 * values["bearing_radius"]
    values["clearance"] = least * (most / least) ** draw.random()
    highest = max(values["upper_speed"] - LEAST_RAMP, 0.0)
    values["lower_speed"] = highest * draw.choice((0.0, _LEAST, draw.random(), 1.0))
    # A joint stretches or has clearance.
    values["stiffness"] = None
    # With a deep penetration each step wears a large part of all bins.
    values["angles"] = min(values["angles"], MOST_BINS)
    return Bearing(**values)


def _links(draw: Random, owner: Any, scale: float) -> dict[str, float]:
    results: dict[str, float] = {}
    for item in fields(owner):
        meaning = meaning_of(item)
        if item.name.startswith(_LENGTHS) and isinstance(meaning, Quantity):
            length = (
                scale * getattr(owner, item.name) * math.exp(draw.gauss(0.0, _CHANGE))
            )
            results[item.name] = min(max(length, meaning.low), meaning.high)
    return results


def _weights(
    draw: Random, owner: Any, links: tuple[tuple[str, str, float], ...]
) -> dict[str, float]:
    """Masses that can move together, and inertias of links that fit their masses and lengths."""
    heaviest = _spread(draw, 1e-6 * MAX_MASS_RATIO, 1e4)
    masses = [
        item.name
        for item in fields(owner)
        if "mass" in item.name and not item.name.startswith(_NOT_DRAWN)
    ]
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
        weights = _weights(
            draw, crank, (("rod_inertia", "rod_mass", links["rod_length"]),)
        )
        return SliderCrank(**(_drawn(draw, crank, _NOT_DRAWN) | weights | links))
    press = Press(geometry=draw.choice(list(GEOMETRIES.values())))
    geometry = press.geometry
    moved = {"hx": scale * geometry.hx, "hy": scale * geometry.hy}
    placed = replace(geometry, **moved, **_links(draw, geometry, scale))
    links = _links(draw, press, scale)
    lengths = {3: links["length_3"], 4: placed.side_bd, 5: links["length_5"]}
    turning = tuple(
        (f"inertia_{k}", f"mass_{k}", length) for k, length in lengths.items()
    )
    values = _drawn(draw, press, _NOT_DRAWN) | _weights(draw, press, turning) | links
    return Press(geometry=placed, **values)


def _with_guide(draw: Random, scene: Scene) -> Scene:
    """Scene whose slide tilts in a guide that fits its links."""
    mechanism = scene.mechanism
    assert isinstance(mechanism, Press | SliderCrank)
    rods = ("rod_length", "length_5")
    longest = max(getattr(mechanism, name, 0.0) for name in rods)
    length, width = (longest * _spread(draw, *SLIDE) for _ in range(2))
    length, width = (min(max(one, MIN_SLIDE), MAX_SLIDE) for one in (length, width))
    most = GUIDE_CLEARANCE * min(width, math.hypot(length, width) - width)
    clearance = _spread(draw, max(1e-6 * most, LEAST_CLEARANCE), most)
    # Their stiffness pi / 4 b E* is 1 kN/m at least.
    least_width = 1.001 * 4e3 / math.pi * scene.bearings.materials.compliance
    # Flat walls have neither Liu's law nor a foundation.
    bearing = replace(
        scene.bearings,
        elasticity="auto",
        width=max(scene.bearings.width, least_width),
        clearance=clearance,
        bearing_radius=max(scene.bearings.bearing_radius, 2.0 * clearance),
    )
    loosened = replace(mechanism, guide_length=length, guide_width=width)
    others = () if scene.joints == "none" else scene.bearing_joints
    return replace(
        scene,
        mechanism=loosened,
        joints=",".join([*others, "guide"]),
        joint_bearings={"guide": bearing},
    )


def _numerics(draw: Random) -> Numerics:
    usual = Numerics()
    values: dict[str, Any] = {}
    for engine in (usual.tree, usual.joints, usual.dae):
        values |= _drawn(draw, engine, ("integrator", "equal_step"))
    values |= {key: min(values[key], most) for key, most in COARSEST.items()}
    values["integration_tolerance"] = max(values["integration_tolerance"], FINEST)
    values["integrator"] = draw.choice(("dop853", "dopri5"))
    return changed(Scene(), values).numerics


def scene_of(draw: Random) -> Scene:
    """A random scene; InputError where it is refused."""
    mechanism = _mechanism(draw)
    base = wear_times() if isinstance(mechanism, Press) else slider_crank()
    conventions = Conventions(**_drawn(draw, Conventions()))
    lengths = [
        item.name for item in fields(mechanism) if item.name.startswith(_LENGTHS)
    ]
    bearings = _bearings(draw, min(getattr(mechanism, name) for name in lengths))
    if conventions.contact == "foundation":
        bearings = replace(bearings, exponent=1.5, elasticity="auto")
    law = elastic_law(bearings, conventions.contact)
    if normal_stiffness(bearings, law, conventions.stiffness) > LARGEST:
        stiffest = LARGEST / bearings.parallel_rods
        bearings = replace(bearings, contact_stiffness=stiffest)
    pins = [name for name in mechanism.allowed_joints if name != "guide"]
    joints = draw.choice([*pins, ",".join(pins), "none"])
    parts: dict[str, Any] = {
        "mechanism": mechanism,
        "bearings": bearings,
        "conventions": conventions,
    }
    parts |= {"numerics": _numerics(draw), "joints": joints, "origins": {}}
    scene = replace(base, **parts, wear_updates=0, replicates=1)
    return _with_guide(draw, scene) if draw.random() < GUIDES else scene


def random_scenes(count: int, seed: int) -> Iterator[tuple[Scene, int]]:
    """Yield scenes, each with the number of draws before it that did not assemble."""
    for place in range(count):
        draw = Random(f"{seed} {place}")
        refused = 0
        while True:
            try:
                scene = scene_of(draw)
                scene.check()
            except InputError as error:
                if not isinstance(error, AssemblyError) and "triangle" not in str(
                    error
                ):
                    raise
                refused += 1
            else:
                yield scene, refused
                break


@dataclass(frozen=True)
class Ended:
    """Outcome of a scene in an engine."""

    part: float  # of a cycle that was run
    # energy that is missing, part of what the drives exchanged
    residual: float = math.nan
    bound: float = 0.0
    failure: str = ""
    # the penetration exceeds the pin radius: no contact law covers it
    is_outside: bool = False

    @property
    def passed(self) -> bool:
        return not self.failure and self.residual <= self.bound


class OutsideError(RunFailed):
    """Raised if the penetration exceeds the radius of the pin."""


class TooLongError(RunFailed):
    """A run that has used all its steps, and the part of it that they reached."""

    def __init__(self, done: float) -> None:
        super().__init__("too many steps")
        self.done = done


def run_part(scene: Scene, part: float, most: int) -> float:
    """Run a part of a cycle in a number of steps and return the relative missing energy."""
    reports = itertools.count(1)

    def report(done: float, recorder: object) -> None:
        if next(reports) > most // STEPS_BETWEEN_REPORTS[scene.solver.word]:
            raise TooLongError(done)

    period = scene.mechanism.period
    linkage = scene.linkage()
    plan = Plan(part * period, 1, 1, report=report)
    run = scene.solver.for_cycle(period).simulate(linkage, start_of(scene), plan)
    if run.finding and run.finding.kind == "penetration":
        raise OutsideError(run.message)
    numbers = {
        name: value
        for name, value in sound(run, plan).diagnostics.items()
        if "_J" in name
    }
    # Where weights fall, their energy turns into heat without the drives.
    dissipated = float(numbers["contact_loss_J"]) + float(numbers["friction_loss_J"])
    exchanged = max(float(numbers["drive_exchange_J"]), dissipated)
    kinetic = 0.5 * float(mass_of(linkage) @ run.end.velocity**2)
    missing = abs(float(numbers["energy_residual_J"]))
    if "newton_iterations" in run.diagnostics:
        missing = max(0.0, missing - UNSOLVED * kinetic)
    return missing / (exchanged + UNEXCHANGED * kinetic)


def ended(scene: Scene, most: int) -> Ended:
    """Run a cycle of a scene, or the part of it that a number of steps reaches.

    A run that ends with the advice to set a smaller tolerance runs again as advised. A
    slow scene that draws the coarsest tolerance is advised twice: its drives exchange
    little energy.
    """
    result = _ended(scene, most)
    for _ in range(2):
        tolerance = _advised(scene, result.failure)
        if not tolerance or result.is_outside:
            break
        scene = changed(scene, tolerance)
        result = _ended(scene, most)
    return result


def _advised(scene: Scene, message: str) -> dict[str, str | float]:
    """Return the smaller tolerance that a message advises, by its key."""
    if advice := re.search(r"set a smaller (\w+), for example ([-\d.e]+)", message):
        return {advice[1]: advice[2]}
    if "a smaller integration_tolerance" in message:
        return {"integration_tolerance": 0.1 * scene.numerics.dae.tolerance}
    return {}


def _ended(scene: Scene, most: int) -> Ended:
    part = 1.0
    try:
        try:
            residual = run_part(scene, part, most)
        except TooLongError as reached:
            part = 0.9 * reached.done
            residual = run_part(scene, part, 2 * most)
    except (InputError, RunFailed, ArithmeticError) as error:
        return Ended(
            part, failure=f"{error}", is_outside=isinstance(error, OutsideError)
        )
    return Ended(
        part, residual, min(ENERGY[scene.solver.word] * coarser(scene), MISSING)
    )


def coarser(scene: Scene) -> float:
    """Return the factor of the allowed error relative to standard steps and tolerances.

    It grows with the tolerance, and with the square of a step.
    """
    usual = Numerics()
    numerics = scene.numerics
    word = scene.solver.word
    if word == "dae":
        return max(1.0, numerics.dae.tolerance / usual.dae.tolerance)
    if word == "exudyn-tree":
        return max(1.0, numerics.tree.tolerance / usual.tree.tolerance)
    steps = ("steps_per_contact", "steps_sustained", "free_steps")
    ratios = (
        getattr(usual.joints, name) / getattr(numerics.joints, name) for name in steps
    )
    return max(1.0, *ratios) ** 2
