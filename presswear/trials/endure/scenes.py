"""Trials of scenes: any that is allowed runs in both engines, and its energy adds up.

Every quantity is drawn over its whole range, by its logarithm where that spans decades.  Links
are drawn around a geometry that assembles, all of one scale: independent ones never would.
Inertias are those that links of their masses and lengths can have, bearings are no larger than
the shortest link.
"""

import math
import random
from collections.abc import Callable, Iterator
from dataclasses import dataclass, fields, replace
from typing import Any

from presswear.campaign.starts import start_of
from presswear.engines.base import Plan, Run
from presswear.engines.settings import Engine, InHouse
from presswear.linkage.mechanism import HEAVIER
from presswear.linkage.press import GEOMETRIES, Press
from presswear.linkage.slider_crank import SliderCrank
from presswear.physics.packed import mass_of
from presswear.scene.catalog import slider_crank, wear_times
from presswear.scene.scene import LEAST_RAMP, Bearings, Conventions, Numerics, Scene
from presswear.tools.errors import AssemblyError, InputError, RunFailed
from presswear.tools.quantities import Meaning, choice_of, meaning_of
from presswear.trials.endure.trial import Trial
from presswear.trials.hard.case import energy_of, sound

ENGINES = ("exudyn", "dae")
MOST_STEPS = 60_000
"""Steps of a run: one that needs more in a cycle runs for the part that they reach."""
COARSEST = {"integration_tolerance": 1e-5, "tree_tolerance": 1e-4}
"""Coarsest tolerances drawn: those at which statistics are still honest in ``precision``.

Coarser ones are allowed, for showing how wrong they are; a run says so by its energy.
"""
_ENDS = 0.08
"""Part of all draws that take an end of their range."""
_LEAST = 1e-9
"""Smallest value drawn from a range that begins at zero, part of its end."""
GYRATION = (0.01, 10.0)
"""Radius of gyration of a link, part of its length."""
_CHANGE = 0.15
"""Standard deviation of the logarithm of a link's length."""
_LENGTHS = ("length_", "side_b", "side_cd", "crank_length", "rod_length")


def _value(draw: random.Random, meaning: Meaning) -> float:
    """A value of a range; its ends now and then."""
    low, high = meaning.low, meaning.high
    if draw.random() < _ENDS:
        end = draw.choice((low, high))
        if not (end == low and meaning.open_low):
            return end
    if low < 0.0 or (low == 0.0 and not meaning.unit):
        return draw.uniform(low, high)
    if low == 0.0:
        low = _LEAST * high
    if high > 10.0 * low:
        return min(max(math.exp(draw.uniform(math.log(low), math.log(high))), low), high)
    return draw.uniform(low, high)


def _drawn(draw: random.Random, owner: Any, apart: tuple[str, ...] = ()) -> dict[str, Any]:
    """Values of the quantities and choices of a data class, some left as they are."""
    found: dict[str, Any] = {}
    for item in fields(owner):
        meaning, words = meaning_of(item), choice_of(item, owner)
        if item.name.startswith(apart):
            continue
        if words is not None:
            found[item.name] = draw.choice(words.words)
        elif meaning is not None:
            value = _value(draw, meaning)
            found[item.name] = round(value) if meaning.whole else value
    return found


def _bearings(draw: random.Random, shortest: float) -> Bearings:
    """Bearings whose quantities fit together, no larger than the shortest link, m."""
    values = _drawn(draw, Bearings())
    values["bearing_radius"] = min(values["bearing_radius"], max(shortest, 1e-4))
    # Values that must be in order are drawn below each other.
    least, most = 1e-9, 0.999 * values["bearing_radius"]
    values["clearance"] = least * (most / least) ** draw.random()
    highest = max(values["upper_speed"] - LEAST_RAMP, 0.0)
    values["lower_speed"] = highest * draw.choice((0.0, _LEAST, draw.random(), 1.0))
    return Bearings(**values)


def _links(draw: random.Random, owner: Any, scale: float) -> dict[str, float]:
    """Lengths of links around those of a mechanism that assembles."""
    found: dict[str, float] = {}
    for item in fields(owner):
        meaning = meaning_of(item)
        if item.name.startswith(_LENGTHS) and meaning is not None:
            length = scale * getattr(owner, item.name) * math.exp(draw.gauss(0.0, _CHANGE))
            found[item.name] = min(max(length, meaning.low), meaning.high)
    return found


def _weights(
    draw: random.Random, owner: Any, links: tuple[tuple[str, str, float], ...]
) -> dict[str, float]:
    """Masses that can move together, and inertias of links that fit their masses and lengths."""
    found: dict[str, float] = {}
    heaviest = math.exp(draw.uniform(math.log(1e-6 * HEAVIER), math.log(1e4)))
    for item in fields(owner):
        if "mass" in item.name:
            found[item.name] = heaviest * HEAVIER ** -draw.random()
    for inertia, mass, length in links:
        least, most = GYRATION
        part = least * (most / least) ** draw.random()
        found[inertia] = min(max(found[mass] * (part * length) ** 2, 1e-9), 1e4)
    return found


def _mechanism(draw: random.Random) -> Press | SliderCrank:
    scale = math.exp(draw.uniform(math.log(0.05), math.log(20.0)))
    if draw.random() < 0.5:
        crank = SliderCrank()
        links = _links(draw, crank, scale)
        weights = _weights(draw, crank, (("rod_inertia", "rod_mass", links["rod_length"]),))
        return SliderCrank(**(_drawn(draw, crank, _LENGTHS) | weights | links))
    press = Press(geometry=draw.choice(list(GEOMETRIES.values())))
    geometry = press.geometry
    moved = {"hx": scale * geometry.hx, "hy": scale * geometry.hy}
    placed = replace(geometry, name="drawn", **moved, **_links(draw, geometry, scale))
    links = _links(draw, press, scale)
    turning = (
        ("inertia_3", "mass_3", links["length_3"]),
        ("inertia_4", "mass_4", placed.side_bd),
        ("inertia_5", "mass_5", links["length_5"]),
    )
    values = _drawn(draw, press, _LENGTHS) | _weights(draw, press, turning) | links
    return Press(geometry=placed, **values)


def _numerics(draw: random.Random) -> Numerics:
    """Steps and tolerances of methods with error control."""
    values = _drawn(draw, Numerics(), ("integrator", "equal_step"))
    values |= {key: min(values[key], most) for key, most in COARSEST.items()}
    return Numerics().having(integrator=draw.choice(("dop853", "dopri5")), **values)


def _shortest(mechanism: Press | SliderCrank) -> float:
    """Length of the shortest link, m."""
    return min(
        getattr(mechanism, item.name)
        for item in fields(mechanism)
        if item.name.startswith(_LENGTHS)
    )


def scene_of(draw: random.Random) -> Scene:
    """A random scene; InputError where it is refused."""
    mechanism = _mechanism(draw)
    base = wear_times() if isinstance(mechanism, Press) else slider_crank()
    conventions = Conventions(**_drawn(draw, Conventions()))
    bearings = _bearings(draw, _shortest(mechanism))
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
        wears=0,
        starts=1,
        statuses={},
    )


@dataclass(frozen=True)
class Ended:
    """How a scene ended in an engine.

    Attributes
    ----------
    part : float
        Of a cycle that was run.
    residual, bound : float
        Energy that is missing, part of what the drives exchanged.
    failure : str
        Why it failed, or nothing.
    is_outside : bool
        Whether a pin sank in deeper than it is thick: the watch says that no law of contact
        covers such a scene, which no range of a single quantity can tell.
    """

    scene: Scene
    part: float
    residual: float
    bound: float
    failure: str
    is_outside: bool = False

    @property
    def passed(self) -> bool:
        """Whether it ended well, with finite results and an energy that adds up."""
        return not self.failure and self.residual <= self.bound


class _OutsideError(RunFailed):
    """A run of a scene that no law of contact covers."""


class _TooLongError(RunFailed):
    """A run that has taken all its steps."""


def _counted(scene: Scene, accuracy: Engine, part: float, most: int) -> Run:
    """A part of a cycle in at most so many steps, give or take those between two looks."""
    period = scene.mechanism.period
    looks = 0

    def look(done: float) -> None:
        nonlocal looks
        looks += 1
        if looks * STEPS_BETWEEN_LOOKS[scene.solver.word] > most:
            raise _TooLongError(f"{done * part!r}")

    plan = Plan(part * period, 1, 1, progress=look)
    run = accuracy.simulate(scene.linkage(), start_of(scene), plan)
    if run.finding and run.finding.kind == "penetration":
        raise _OutsideError(run.message)
    return sound(run, plan)


STEPS_BETWEEN_LOOKS = {"dae": 2000, "exudyn-tree": 512, "exudyn-joints": 512}
"""Steps after which an engine tells how far it is."""


def ended(scene: Scene, most: int = MOST_STEPS) -> Ended:
    """Run a cycle of a scene, or what a number of steps reaches of it."""
    accuracy = scene.solver.over(scene.mechanism.period)
    if isinstance(accuracy, InHouse):
        # Of the whole cycle, also where only a part of it is run.
        accuracy = replace(accuracy, free_step=scene.mechanism.period / 500.0)
    part = 1.0
    try:
        try:
            run = _counted(scene, accuracy, part, most)
        except _TooLongError as reached:
            part = 0.9 * float(str(reached))
            run = _counted(scene, accuracy, part, 2 * most)
    except (InputError, RunFailed, ArithmeticError) as error:
        return Ended(scene, part, math.nan, 0.0, f"{error}", isinstance(error, _OutsideError))
    bound = min(energy_of(run, scene.solver.word).bound * coarser(scene), MISSING)
    return Ended(scene, part, missing(scene, run), bound, "")


UNEXCHANGED = 1e-7
"""Part of the kinetic energy that counts as exchanged: of a run of a few steps, hardly any is,
and what is missing is round-off of what all bodies hold."""


def missing(scene: Scene, run: Run) -> float:
    """Energy that is missing, part of what the drives exchanged."""
    kinetic = 0.5 * float(mass_of(scene.linkage()) @ run.end.velocity**2)
    exchanged = float(run.diagnostics["drive_exchange_J"]) + UNEXCHANGED * kinetic
    return abs(float(run.diagnostics["energy_residual_J"])) / exchanged


MISSING = 1e-2
"""Energy that may be missing however coarse a scene asks to be solved, part of that exchanged."""


def coarser(scene: Scene) -> float:
    """How much more than at standard steps and tolerances the error may be.

    It grows with the tolerance, and with the square of a step.
    """
    usual, numerics = Numerics(), scene.numerics
    ratio = {
        "dae": numerics.dae.integration_tolerance / usual.dae.integration_tolerance,
        "exudyn-tree": numerics.tree.tree_tolerance / usual.tree.tree_tolerance,
        "exudyn-joints": max(
            usual.joints.steps_per_contact / numerics.joints.steps_per_contact,
            usual.joints.steps_sustained / numerics.joints.steps_sustained,
            usual.joints.free_steps / numerics.joints.free_steps,
        )
        ** 2,
    }
    return max(1.0, ratio[scene.solver.word])


def random_scenes(count: int, seed: int) -> Iterator[tuple[Scene, int]]:
    """So many scenes, each with the number of those refused before it as not assembling."""
    for place in range(count):
        draw = random.Random(f"{seed} {place}")
        refused = 0
        while True:
            try:
                scene = scene_of(draw)
            except AssemblyError:
                refused += 1
            except InputError as error:
                if "triangle" not in str(error):
                    raise
                refused += 1
            else:
                yield scene, refused
                break


def valid_scenes(
    count: int,
    seed: int,
    progress: Callable[[float], None] = lambda part: None,
    most: int = MOST_STEPS,
) -> Trial:
    """Random scenes within all ranges, a cycle of each in both engines.

    A run that ends with a message says nothing false, but it is no survivor.

    Parameters
    ----------
    most : int
        Steps of a run, give or take; see ``ended``.
    """
    tried = survived = refused = parts = stopped = outside = 0
    worst = 0.0
    first = ""
    for place, (scene, before) in enumerate(random_scenes(2 * count, seed)):
        if tried == count:
            break
        refused += before
        found = [ended(replace(scene, engine=engine), most) for engine in ENGINES]
        if any(one.is_outside for one in found):
            outside += 1
            continue
        tried += 1
        wrong = next((one for one in found if not one.passed), None)
        survived += wrong is None
        stopped += wrong is not None and all(one.passed or one.failure for one in found)
        parts += any(one.part < 1.0 for one in found)
        worst = max([worst, *(one.residual for one in found if one.passed)])
        if wrong is not None and not first:
            told = wrong.failure or f"energy residual {wrong.residual:.1e} of that exchanged"
            first = f"; first scene {place} of seed {seed}, {wrong.scene.solver.word}: {told}"
        progress(tried / count)
    return Trial(
        "random scenes run a cycle in both engines, finite, energy adds up",
        tried,
        survived,
        f"{stopped} ended with a message; largest residual {worst:.1e} of the energy exchanged; "
        f"{parts} in part, at {most} steps; {refused} more did not assemble, in "
        f"{outside} pins sank in deeper than they are thick{first}",
    )
