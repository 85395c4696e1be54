"""Hard cases, in which a run could hang, fail, or be wrong without a message.

Those of the press are laws and sizes at the ends of their ranges, worn profiles, dead points, and
many cycles, over which constraints, energy and memory must not drift.
"""

import math
import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswear.campaign.replicates import start_of
from presswear.engines.base import Run, Start
from presswear.linkage.laws import DAMPINGS, FRICTIONS, KELVIN_VOIGT
from presswear.linkage.mechanisms import Press, SliderCrank
from presswear.linkage.surface import Surface, bin_centres
from presswear.physics.ideal import motion_of
from presswear.recording.observer import Observer
from presswear.recording.recorder import Recorder
from presswear.scene.bearing import CONVENTIONS
from presswear.scene.catalog import slider_crank, wear_times
from presswear.scene.scene import Scene
from presswear.scene.settings import changed
from presswear.tools.errors import InputError
from presswear.validation.cases import (
    PATIENCE,
    Case,
    Check,
    energy_check,
    first_contact,
    guarded,
    order_of,
    run_sound,
)
from presswear.validation.hard_impacts import impact_cases

Array = NDArray[np.float64]

BASE = replace(wear_times(), wear_updates=0)  # clearance at A and C
CLEARANCES = (1e-3, 1e-4, 1e-5, 1e-6)  # m, of the approach to the ideal joint
MIN_CLEARANCE = 1e-9  # m, the smallest that a scene allows
APPROACH = 0.1  # s, half of a stroke and fifty contacts
BINS = 360
# Energy residual allowed on worn surfaces with radial contact, relative to that exchanged. A force
# along the eccentricity over a sloping profile makes energy, 2e-3 to 4e-2 of what the drives
# exchange, in blows of 1e4 N and more, whose rounding limits the error control.
RADIAL_ENERGY = 1e-4
MADE = 0.5  # energy that radial contact may make, relative to that exchanged
FAST = 40.0 * math.pi  # rad/s; a cycle takes 50 ms and has some hundred contacts
LONGEST = 1200.0  # s of CPU time for many cycles
# Largest growth of the constraint error over ten times the cycles. Crank angles grow by 6 rad a
# cycle, and so does their round-off: the error grows ten times, from 1.4e-10 m after 200 cycles. An
# instability grows a hundred times or more.
GROWTH = 20.0
CALM = 100  # cycles from which on the error grows evenly
WORN_PATIENCE = 20.0  # s of CPU time on worn surfaces; most runs take up to 8
STEEP = ("deeper than c", "radial")  # refused, because the contact makes energy
CHANCE = ("notch", "radial")  # refused from some initial states only, and left out


def bearings(**changes: Any) -> Scene:
    """Return the press with changed bearings."""
    return changed(BASE, changes)


def turning(speed: float) -> Scene:
    """Return the press at a crank speed, rad/s."""
    return replace(BASE, mechanism=Press(speed=speed))


def run_scene(
    scene: Scene,
    duration: float = 0.0,
    start: Start | None = None,
    worn: Mapping[str, tuple[Surface, Surface]] | None = None,
    patience: float = PATIENCE,
) -> Run:
    """Run a cycle of a scene, or a duration, s, in its engine."""
    period = scene.mechanism.period
    plan = guarded(duration or period, patience=patience)
    return run_sound(
        scene.linkage(worn), start or start_of(scene), scene.solver.for_cycle(period), plan
    )


def balanced(scene: Scene, duration: float = 0.0, start: Start | None = None) -> Iterator[Check]:
    """Check the energy residual of a run."""
    yield energy_check(run_scene(scene, duration, start), scene.solver.word)


def in_both(
    name: str,
    reason: str,
    scene: Scene,
    checks: Callable[[Scene], Iterator[Check]] = balanced,
    refusal: str = "",
    is_long: bool = False,
) -> Iterator[Case]:
    """Yield the case of a scene in Exudyn and in ``dae``."""
    for engine in ("exudyn", "dae"):
        chosen = replace(scene, engine=engine)
        yield Case(name, reason, chosen.solver.word, partial(checks, chosen), refusal, is_long)


def law_cases() -> Iterator[Case]:
    """Yield laws, sizes and speeds at the ends of their ranges."""
    yield from in_both("ce = 1", "no damping", bearings(restitution=1.0))
    for name, law in DAMPINGS.items():
        if name == KELVIN_VOIGT:
            viscous = bearings(normal_law=name, viscous_damping=300.0)
            yield from in_both(name, "forces start with a jump", viscous)
        else:
            # Damping without bounds makes a pin at rest stiff: at 0.01 the tree takes a minute.
            nominal = 0.05 if law.least > 0.0 else 0.0
            strong = bearings(normal_law=name, restitution=nominal)
            yield from in_both(f"{name}, ce = {nominal:g}", "strong damping", strong)
    for elasticity in ("liu", "foundation"):
        deep = bearings(elasticity=elasticity, youngs_modulus=1e9)
        yield from in_both(elasticity, "deep conformal contacts", deep)
    for name in FRICTIONS:
        rough = bearings(friction_law=name, friction=0.8)
        yield from in_both(f"{name}, c_f = 0.8", "friction reverses the pin", rough)
    yield from in_both("c_f = 0", "no friction", bearings(friction=0.0))
    calm = bearings(restitution=1.0, friction=0.0)
    yield from in_both("ce = 1 and c_f = 0", "no losses", calm)
    for modulus in (1e9, 1e12):
        name = f"E = {1e-9 * modulus:g} GPa"
        reason = "deep contacts" if modulus < 1e10 else "short contacts"
        yield from in_both(name, reason, bearings(youngs_modulus=modulus))
    yield from in_both("c = 5 mm", "strong impacts", bearings(clearance=5e-3))
    for clearance in (1e-6, 1e-9):
        reason = (
            "penetration exceeds the clearance"
            if clearance < 1e-8
            else "touchdowns in rapid succession"
        )
        checks = partial(balanced, duration=APPROACH)
        yield from in_both(f"c = {clearance:g} m", reason, bearings(clearance=clearance), checks)
    yield from in_both("speed 0.1 pi", "a cycle of 20 s, pins at rest", turning(0.1 * math.pi))
    yield from in_both("speed 40 pi", "impacts of 10 kN", turning(40.0 * math.pi))
    for joint, reason in (("A", "a closed loop"), ("C", "hangs from a moving plate")):
        alone = replace(BASE, joints=joint)
        yield from in_both(f"clearance at {joint} alone", reason, alone)
    yield from in_both("c -> 0", "the ideal joint is a stiff limit", BASE, approach)


def slider_distance(scene: Scene, clearance: float) -> float:
    """Return the largest distance of the slider from that of the ideal press, m."""
    tight = replace(scene, bearings=replace(scene.bearings, clearance=clearance))
    recorder = run_scene(tight, APPROACH).recorder
    ideal = tight.ideal_slider(recorder.series("time"))[:, 0]
    return float(np.abs(recorder.series("displacement") - ideal).max())


def approach(scene: Scene) -> Iterator[Check]:
    """Check that the distance from the ideal press is of first order in the clearance.

    A micrometre remains without clearance: the elastic deflection of the contacts.
    """
    least = slider_distance(scene, MIN_CLEARANCE)
    distances = [slider_distance(scene, clearance) for clearance in CLEARANCES]
    order = order_of(CLEARANCES, (np.array(distances) - least).tolist())
    yield Check("distance left at c = 1 nm (m)", least, 2e-6)
    yield Check("order of the distance from the ideal press in c, less 1", order - 1.0, 0.1)
    yield Check("distance / c at c = 1 um", distances[-1] / CLEARANCES[-1], 10.0)


def profiles() -> dict[str, tuple[str, Surface, Surface]]:
    """Return worn surfaces by name: the reason why they are hard, bearing and pin."""
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
    """Check the energy of a run on worn surfaces."""
    run = run_scene(scene, worn=worn, patience=WORN_PATIENCE)
    check = energy_check(run, scene.solver.word)
    if scene.conventions.contact != "radial":
        yield check
        return
    yield replace(check, bound=RADIAL_ENERGY)
    exchanged = float(run.diagnostics["drive_exchange_J"])
    made = max(-float(run.diagnostics["contact_loss_J"]), 0.0) / exchanged
    yield Check("energy that the radial law made / exchanged", made, MADE)


def profile_cases() -> Iterator[Case]:
    """Yield worn profiles with radial contact and with the elastic foundation."""
    for name, (reason, bearing, pin) in profiles().items():
        for conventions, law in (("paper", "radial"), ("refined", "foundation")):
            if (name, law) == CHANCE:
                continue
            scene = replace(BASE, conventions=CONVENTIONS[conventions])
            refusal = "made .* too steep" if (name, law) == STEEP else ""
            checks = partial(on_worn, worn=dict.fromkeys("AC", (bearing, pin)))
            yield from in_both(f"{name}, {law}", reason, scene, checks, refusal)


def displaced(scene: Scene, penetration: float, closing: float = 0.0) -> Start:
    """Return an initial state with both pins at a penetration, m.

    Rod 3 is turned about B, rod 5 about E.

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
        hinge = q[i : i + 2] - half * _axis(angle)
        hinge_rate = v[i : i + 2] - half * spin * _axis(angle + 0.5 * math.pi)
        angle += 2.0 * math.asin(0.5 * reach / length)
        spin += closing / length
        q[i : i + 2] = hinge + half * _axis(angle)
        v[i : i + 2] = hinge_rate + half * spin * _axis(angle + 0.5 * math.pi)
        q[i + 2], v[i + 2] = angle, spin
    return Start(q, v)


def _axis(angle: float) -> Array:
    return np.array([math.cos(angle), math.sin(angle)])


def met_together(scene: Scene, speed: float) -> Iterator[Check]:
    """Check that both pins touch down within a picosecond, each at its closing speed."""
    run = run_scene(scene, start=displaced(scene, -1e-9, speed))
    pins = [first_contact(run, k) for k in range(2)]
    difference = pins[0]["touchdown"] - pins[1]["touchdown"]
    yield Check("time between the two touches (s)", difference, 1e-12)
    worst = max(abs(pin["closing_speed"] / speed - 1.0) for pin in pins)
    yield Check("closing speed over that of the start, less 1", worst, 1e-5)
    yield energy_check(run, scene.solver.word)


def start_cases() -> Iterator[Case]:
    """Yield initial states in contact and just before it."""
    for penetration in (1e-6, 1e-12):
        name = f"start in contact, {penetration:g} m deep"
        checks = partial(balanced, start=displaced(BASE, penetration))
        yield from in_both(name, "no touchdown, hence no closing speed", BASE, checks)
    together = partial(met_together, speed=0.1)
    yield from in_both("both joints touch at once", "two events in one step", BASE, together)


def closest_to_dead_point() -> Press:
    """Return the press with the shortest rod 5 that is not refused."""
    short, long = 0.05, Press().length_5
    for _ in range(40):
        middle = 0.5 * (short + long)
        try:
            motion_of(Press(length_5=middle))
            long = middle
        except InputError:
            short = middle
    return Press(length_5=long)


def toggle_cases() -> Iterator[Case]:
    """Yield mechanisms close to a dead point."""
    reason = "rod 5 comes as near its dead point as is allowed"
    scene = replace(BASE, mechanism=closest_to_dead_point())
    yield from in_both("toggle, as near as allowed", reason, scene)
    flat = replace(slider_crank(), mechanism=SliderCrank(rod_length=0.05001, crank_length=0.05))
    yield from in_both("rod as long as the crank", "the rod stands upright", flat)


class _Memory(Observer):
    """Record the peak memory of the process after each cycle, MB."""

    def __init__(self) -> None:
        self.sizes: list[float] = []

    def on_cycle(self, recorder: Recorder, state: object) -> bool:
        """Record the memory and continue."""
        import resource  # not on Windows

        self.sizes.append(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0)
        return False


def many_cycles(scene: Scene, cycles: int) -> tuple[Run, float]:
    """Run many cycles; return the run and the growth of memory after a tenth of them, MB."""
    memory, period = _Memory(), scene.mechanism.period
    plan = guarded(period, cycles, LONGEST)
    plan = replace(plan, observers=(*plan.observers, memory))
    run = run_sound(scene.linkage(), start_of(scene), scene.solver.for_cycle(period), plan)
    return run, memory.sizes[-1] - memory.sizes[cycles // 10]


def drifts(cycles: int, scene: Scene) -> Iterator[Check]:
    """Compare many cycles with a tenth of them."""
    engine = scene.solver.word
    first, _ = many_cycles(scene, cycles // 10)
    run, growth = many_cycles(scene, cycles)
    yield energy_check(run, engine)
    yield Check("cycles missing", cycles - len(run.recorder.cycles), 0.0)
    yield Check("memory growth (MB)", growth, 8.0)
    if engine == "dae":
        early, late = (float(r.diagnostics["constraint_error_m"]) for r in (first, run))
        yield Check("greatest |Phi| / clearance", late / scene.bearings.clearance, 1e-5)
        if cycles // 10 > CALM:
            yield Check("|Phi| over that of a tenth of the cycles", late / early, GROWTH)
    early, late = (abs(float(r.diagnostics["energy_residual_J"])) for r in (first, run))
    exchanged = float(run.diagnostics["drive_exchange_J"])
    per_cycle = (late / 10.0 - early) / (exchanged / 10.0)
    yield Check("residual a cycle, growth / exchanged", per_cycle, 1e-8)


def drift_cases() -> Iterator[Case]:
    """Yield 100 and 2,000 cycles, in ``dae`` with constraints, which the tree keeps exactly."""
    fast = turning(FAST)
    dae = replace(fast.numerics.dae, coordinates="all")
    fast = replace(fast, numerics=replace(fast.numerics, dae=dae))
    for cycles, is_long in ((100, False), (2000, True)):
        name = f"{cycles:,} cycles at 40 pi"
        yield from in_both(
            name, "errors accumulate", fast, partial(drifts, cycles), is_long=is_long
        )


def refused(make: Callable[[], object]) -> Iterator[Check]:
    """Yield a miss unless making the object is refused."""
    make()
    yield Check("was not refused", math.nan, 0.0)


def refusal_cases() -> Iterator[Case]:
    """Yield values beyond their ranges, which are refused by name, value and range."""

    def case(name: str, reason: str, pattern: str, make: Callable[[], object]) -> Case:
        return Case(name, reason, "any", partial(refused, make), pattern)

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
    check = replace(BASE, mechanism=shorter).check
    yield case("toggle, one step nearer", "a dead point", pattern, check)


def hard_cases() -> Iterator[Case]:
    """Yield every hard case, long ones included."""
    yield from impact_cases()
    makers = law_cases, profile_cases, start_cases, toggle_cases, refusal_cases, drift_cases
    for cases in makers:
        yield from cases()
