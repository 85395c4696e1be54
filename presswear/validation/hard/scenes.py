"""Hard cases of the press: laws and sizes at the ends of their ranges, worn profiles, toggles.

Over many cycles constraints, energy and memory must not drift.
"""

import math
import re
import resource
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswear.campaign.replicates import start_of
from presswear.engines.base import Run, Start
from presswear.linkage.laws import DAMPINGS, FRICTIONS, KELVIN_VOIGT
from presswear.linkage.press import Press
from presswear.linkage.slider_crank import SliderCrank
from presswear.linkage.surface import Surface, bin_centres
from presswear.physics.following import motion_of
from presswear.recording.observer import Observer
from presswear.recording.recorder import Recorder
from presswear.scene.bearing import CONVENTIONS
from presswear.scene.catalog import slider_crank, wear_times
from presswear.scene.scene import Scene
from presswear.scene.settings import changed
from presswear.tools.errors import InputError
from presswear.validation.hard.case import HardCase, energy_of, ran
from presswear.validation.runs import PATIENCE, Check, contacts_of, guarded, order_of

Array = NDArray[np.float64]

BASE = replace(wear_times(), wear_updates=0)
"""The press with clearance at A and C."""
CLEARANCES = (1e-3, 1e-4, 1e-5, 1e-6)
"""Clearances of the approach to the ideal joint, m."""
LEAST_CLEARANCE = 1e-9
"""The smallest that a scene allows, m."""
APPROACH = 0.1
"""Time that the press runs in it, s: half of a stroke and fifty contacts."""
BINS = 360
RADIAL_ENERGY = 1e-4
"""Energy that may be missing on worn surfaces that meet radially, part of that exchanged.

A force along e over a sloping profile makes energy of its own, 2e-3 to 4e-2 of what the
drives exchange on these profiles (the ledger's contact loss is below zero), in blows of
1e4 N and more on the walls, whose rounding is all that the error control sees.
"""
MADE = 0.5
"""Energy that radial contact may make, part of what the drives exchange.

Beyond that the law drives the press as much as the drives do, and the run means nothing.
"""
FAST = 40.0 * math.pi
"""Crank speed of the many cycles, rad/s: a cycle takes 50 ms and some hundred contacts."""
LONGEST = 1200.0
"""Wall time that many cycles may take, s."""
GROWTH = 20.0
"""Most that the error of the constraints may grow over ten times the cycles.

Crank angles count on, 6 rad a cycle, and their round-off with them: the error grows ten
times, from 1.4e-10 m after 200 cycles.  What feeds on itself grows a hundred times or more.
"""
CALM = 100
"""Cycles after which errors grow as they go on to: the first ten are too calm to tell."""
WORN_PATIENCE = 20.0
"""Wall time after which a run on worn surfaces counts as hung, s; others take up to 8."""


def bearings(**changes: Any) -> Scene:
    """The press with other bearings."""
    return changed(BASE, changes)


def turning(speed: float) -> Scene:
    """The press at a crank speed, rad/s."""
    return replace(BASE, mechanism=Press(speed=speed))


def run_scene(
    scene: Scene,
    duration: float = 0.0,
    start: Start | None = None,
    worn: Mapping[str, tuple[Surface, Surface]] | None = None,
    patience: float = PATIENCE,
) -> Run:
    """Run a cycle of a scene, or some seconds, by its engine."""
    period = scene.mechanism.period
    plan = guarded(duration or period, patience=patience)
    return ran(scene.linkage(worn), start or start_of(scene), scene.solver.over(period), plan)


def balanced(scene: Scene, duration: float = 0.0, start: Start | None = None) -> Iterator[Check]:
    """Run, and see that the energy adds up."""
    yield energy_of(run_scene(scene, duration, start), scene.solver.word)


def in_both(
    name: str,
    hard: str,
    scene: Scene,
    checks: Callable[[Scene], Iterator[Check]] = balanced,
    refusal: str = "",
    long: bool = False,
) -> Iterator[HardCase]:
    """A scene under both engines."""
    for engine in ("exudyn", "dae"):
        chosen = replace(scene, engine=engine)
        yield HardCase(name, hard, chosen.solver.word, partial(checks, chosen), refusal, long)


def law_cases() -> Iterator[HardCase]:
    """Laws, sizes and speeds at the ends of their ranges."""
    yield from in_both("ce = 1", "nothing calms the pins", bearings(restitution=1.0))
    for name, law in DAMPINGS.items():
        if name == KELVIN_VOIGT:
            viscous = bearings(normal_law=name, viscous_damping=300.0)
            yield from in_both(name, "forces begin with a jump", viscous)
        else:
            # Damping without bounds makes a pin at rest stiff: at 0.01 the tree takes a minute.
            nominal = 0.05 if law.least > 0.0 else 0.0
            strong = bearings(normal_law=name, restitution=nominal)
            yield from in_both(f"{name}, ce = {nominal:g}", "strong damping", strong)
    for elasticity in ("liu", "foundation"):
        deep = bearings(elasticity=elasticity, youngs_modulus=1e9)
        yield from in_both(elasticity, "deep contacts of pins that conform", deep)
    for name in FRICTIONS:
        rough = bearings(friction_law=name, friction=0.8)
        yield from in_both(f"{name}, c_f = 0.8", "friction turns the pin back", rough)
    yield from in_both("c_f = 0", "no friction", bearings(friction=0.0))
    calm = bearings(restitution=1.0, friction=0.0)
    yield from in_both("ce = 1 and c_f = 0", "nothing is lost", calm)
    for modulus in (1e9, 1e12):
        name = f"E = {1e-9 * modulus:g} GPa"
        hard = "deep contacts" if modulus < 1e10 else "short contacts"
        yield from in_both(name, hard, bearings(youngs_modulus=modulus))
    yield from in_both("c = 5 mm", "hard blows", bearings(clearance=5e-3))
    for clearance in (1e-6, 1e-9):
        hard = "penetration exceeds the clearance" if clearance < 1e-8 else "touches follow fast"
        checks = partial(balanced, duration=APPROACH)
        yield from in_both(f"c = {clearance:g} m", hard, bearings(clearance=clearance), checks)
    yield from in_both("speed 0.1 pi", "a cycle of 20 s, pins at rest", turning(0.1 * math.pi))
    yield from in_both("speed 40 pi", "blows of 10 kN", turning(40.0 * math.pi))
    for joint, hard in (("A", "a closed loop"), ("C", "hangs from a moving plate")):
        alone = replace(BASE, joints=joint)
        yield from in_both(f"clearance at {joint} alone", hard, alone)
    yield from in_both("c -> 0", "the ideal joint is a limit, and a stiff one", BASE, approach)


def slider_distance(scene: Scene, clearance: float) -> float:
    """Greatest distance of the slider from that of the ideal press, m."""
    tight = replace(scene, bearings=replace(scene.bearings, clearance=clearance))
    recorder = run_scene(tight, APPROACH).recorder
    ideal = tight.ideal_slider(recorder.series("time"))[:, 0]
    return float(np.abs(recorder.series("displacement") - ideal).max())


def approach(scene: Scene) -> Iterator[Check]:
    """The distance from the ideal press falls at first order in the clearance.

    A micrometre is left without clearance: the contacts give way by it.
    """
    least = slider_distance(scene, LEAST_CLEARANCE)
    distances = [slider_distance(scene, clearance) for clearance in CLEARANCES]
    gone = np.array(distances) - least
    order = order_of(CLEARANCES, gone.tolist())
    yield Check("distance left at c = 1 nm (m)", least, 2e-6)
    yield Check("order of the distance from the ideal press in c, less 1", order - 1.0, 0.1)
    yield Check("distance / c at c = 1 um", distances[-1] / CLEARANCES[-1], 10.0)


def profiles() -> dict[str, tuple[str, Surface, Surface]]:
    """Worn surfaces, bearing and pin, by name, and what is hard about them."""
    angle, number = bin_centres(BINS), np.arange(BINS)
    new = Surface()
    step = Surface(np.where(angle > 1.5, 3e-5, 0.0))
    return {
        "step": ("an edge on each surface", step, step),
        **{
            name: (
                "twelve notches of one degree, narrower than the arc",
                Surface(np.where(number % 30 == 0, depth, 0.0)),
                new,
            )
            for name, depth in (("notch", 1e-4), ("shallow notch", 1e-5))
        },
        "deeper than c": (
            "1 mm of wear in a clearance of 0.8 mm",
            Surface(5e-4 * (1.0 + np.cos(angle - 1.5))),
            new,
        ),
        "all deeper than c": ("the clearance is more than doubled", Surface(1e-3 + 0 * angle), new),
    }


def on_worn(scene: Scene, worn: Mapping[str, tuple[Surface, Surface]]) -> Iterator[Check]:
    """Run on worn surfaces, and see that the energy adds up."""
    run = run_scene(scene, worn=worn, patience=WORN_PATIENCE)
    found = energy_of(run, scene.solver.word)
    if scene.conventions.contact != "radial":
        yield found
        return
    yield replace(found, bound=RADIAL_ENERGY)
    exchanged = float(run.diagnostics["drive_exchange_J"])
    made = max(-float(run.diagnostics["contact_loss_J"]), 0.0) / exchanged
    yield Check("energy that the radial law made / exchanged", made, MADE)


STEEP = ("deeper than c", "radial")
"""Profile and law that end with a refusal."""
CHANCE = ("notch", "radial")
"""Profile and law that end with a refusal from some starts, and not from others."""


def profile_cases() -> Iterator[HardCase]:
    """Worn profiles under both laws of contact."""
    for name, (hard, bearing, pin) in profiles().items():
        for conventions, law in (("paper", "radial"), ("refined", "foundation")):
            if (name, law) == CHANCE:
                continue
            scene = replace(BASE, conventions=CONVENTIONS[conventions])
            # A radial force over so steep a wall makes energy without end.
            refusal = "made .* too steep" if (name, law) == STEEP else ""
            checks = partial(on_worn, worn=dict.fromkeys("AC", (bearing, pin)))
            yield from in_both(f"{name}, {law}", hard, scene, checks, refusal)


def displaced(scene: Scene, penetration: float, closing: float = 0.0) -> Start:
    """A start with both pins at a penetration, m: rod 3 turned about B, rod 5 about E.

    Parameters
    ----------
    closing : float
        Added rate of penetration of both, m/s.
    """
    start, linkage = start_of(scene), scene.linkage()
    q, v = start.position.copy(), start.velocity.copy()
    reach = scene.bearings.clearance + penetration
    press = scene.mechanism
    assert isinstance(press, Press)
    for body, length in (("rod 3", press.length_3), ("rod 5", press.length_5)):
        i = 3 * linkage.index(body)
        half, angle, spin = 0.5 * length, q[i + 2], v[i + 2]
        held = q[i : i + 2] - half * _axis(angle)
        held_rate = v[i : i + 2] - half * spin * _axis(angle + 0.5 * math.pi)
        angle += 2.0 * math.asin(0.5 * reach / length)
        spin += closing / length
        q[i : i + 2] = held + half * _axis(angle)
        v[i : i + 2] = held_rate + half * spin * _axis(angle + 0.5 * math.pi)
        q[i + 2], v[i + 2] = angle, spin
    return Start(q, v)


def _axis(angle: float) -> Array:
    return np.array([math.cos(angle), math.sin(angle)])


def met_together(scene: Scene, speed: float) -> Iterator[Check]:
    """See both pins touch down within a picosecond, each at its closing speed."""
    run = run_scene(scene, start=displaced(scene, -1e-9, speed))
    one, other = (contacts_of(run, k) for k in range(2))
    apart = float(one["touchdown"][0] - other["touchdown"][0])
    yield Check("time between the two touches (s)", apart, 1e-12)
    worst = max(abs(float(own["closing_speed"][0]) / speed - 1.0) for own in (one, other))
    yield Check("closing speed over that of the start, less 1", worst, 1e-5)
    yield energy_of(run, scene.solver.word)


def start_cases() -> Iterator[HardCase]:
    """Starts in contact and on the point of it."""
    for penetration in (1e-6, 1e-12):
        name = f"start in contact, {penetration:g} m deep"
        checks = partial(balanced, start=displaced(BASE, penetration))
        yield from in_both(name, "no touch tells the closing speed", BASE, checks)
    together = partial(met_together, speed=0.1)
    yield from in_both("both joints touch at once", "two events in one step", BASE, together)


def closest_to_dead_point() -> Press:
    """The press with the shortest rod 5 that is not refused: almost across its guide once."""
    short, long = 0.05, Press().length_5
    for _ in range(40):
        middle = 0.5 * (short + long)
        try:
            motion_of(Press(length_5=middle))
            long = middle
        except InputError:
            short = middle
    return Press(length_5=long)


def toggle_cases() -> Iterator[HardCase]:
    """Positions in which two links are stretched."""
    hard = "rod 5 comes as near its dead point as is allowed"
    scene = replace(BASE, mechanism=closest_to_dead_point())
    yield from in_both("toggle, as near as allowed", hard, scene)
    flat = replace(slider_crank(), mechanism=SliderCrank(rod_length=0.05001, crank_length=0.05))
    yield from in_both("rod as long as the crank", "the rod stands upright", flat)


class _Memory(Observer):
    """Notes the peak memory of the process after each cycle, MB."""

    def __init__(self) -> None:
        self.sizes: list[float] = []

    def on_cycle(self, recorder: Recorder, state: object) -> bool:
        """Note the memory; it never ends the run."""
        self.sizes.append(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0)
        return False


def many_cycles(scene: Scene, cycles: int) -> tuple[Run, float]:
    """Run many cycles, and see by how much the process grew after a tenth of them, MB."""
    memory, period = _Memory(), scene.mechanism.period
    plan = guarded(period, cycles, LONGEST)
    plan = replace(plan, observers=(*plan.observers, memory))
    run = ran(scene.linkage(), start_of(scene), scene.solver.over(period), plan)
    return run, memory.sizes[-1] - memory.sizes[cycles // 10]


def drifts(cycles: int, scene: Scene) -> Iterator[Check]:
    """Compare many cycles with a tenth of them."""
    engine = scene.solver.word
    first, _ = many_cycles(scene, cycles // 10)
    run, grown = many_cycles(scene, cycles)
    yield energy_of(run, engine)
    yield Check("cycles missing", cycles - len(run.recorder.cycles), 0.0)
    yield Check("memory grown (MB)", grown, 8.0)
    if engine == "dae":
        early, late = (float(r.diagnostics["constraint_error_m"]) for r in (first, run))
        yield Check("greatest |Phi| / clearance", late / scene.bearings.clearance, 1e-5)
        if cycles // 10 > CALM:
            yield Check("|Phi| over that of a tenth of the cycles", late / early, GROWTH)
    early, late = (abs(float(r.diagnostics["energy_residual_J"])) for r in (first, run))
    exchanged = float(run.diagnostics["drive_exchange_J"])
    per_cycle = (late / 10.0 - early) / (exchanged / 10.0)
    yield Check("residual a cycle, growth / exchanged", per_cycle, 1e-8)


def drift_cases() -> Iterator[HardCase]:
    """A hundred cycles, and 2,000; in-house with constraints: those of the tree hold exactly."""
    fast = turning(FAST)
    held = replace(fast.numerics.dae, coordinates="all")
    fast = replace(fast, numerics=replace(fast.numerics, dae=held))
    for cycles, long in ((100, False), (2000, True)):
        name = f"{cycles:,} cycles at 40 pi"
        yield from in_both(name, "errors add up", fast, partial(drifts, cycles), long=long)


def refused(make: Callable[[], object]) -> Iterator[Check]:
    """Make something that must be refused."""
    make()
    yield Check("was not refused", math.nan, 0.0)


def refusal_cases() -> Iterator[HardCase]:
    """Values beyond the ranges are refused by name, value and range."""

    def case(name: str, hard: str, pattern: str, make: Callable[[], object]) -> HardCase:
        return HardCase(name, hard, "any", partial(refused, make), pattern)

    beyond = {
        "restitution": (-0.01, 1.01, math.nan),
        "friction": (-0.1, 0.81),
        "clearance": (0.0, 0.015),
        "youngs_modulus": (0.9e9, 1.1e12, math.inf),
    }
    for key, values in beyond.items():
        for value in values:
            name, make = f"{key} = {value:g}", partial(bearings, **{key: value})
            yield case(name, "beyond its range", re.escape(name) + ".*allowed is", make)
    for speed in (0.09 * math.pi, 41.0 * math.pi):
        pattern = re.escape(f"speed = {speed:g} rad/s: allowed is")
        make = partial(turning, speed)
        yield case(f"speed {speed / math.pi:g} pi", "beyond its range", pattern, make)
    closest = closest_to_dead_point()
    shorter = replace(closest, length_5=closest.length_5 - 1e-5)
    pattern = "crank angle .* joint .* does not close or is at a dead point"
    make = partial(replace, BASE, mechanism=shorter)
    yield case("toggle, one step nearer", "a dead point", pattern, make)


def scene_cases() -> Iterator[HardCase]:
    """All hard cases of the press."""
    makers = law_cases, profile_cases, start_cases, toggle_cases, refusal_cases, drift_cases
    for cases in makers:
        yield from cases()
