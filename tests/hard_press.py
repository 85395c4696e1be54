"""Hard cases of the press and the slider-crank.

Laws and sizes at the ends of their ranges, worn profiles, dead points, and many cycles,
over which errors must not grow.
"""

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from functools import cache, partial
from typing import Any

import numpy as np
from hard_case import HardCase, energy_check, run_sound
from hard_impacts import BINS, DATA, Checks

from presswear.campaign.replicates import start_of
from presswear.engines.base import Run, Start
from presswear.engines.settings import ExudynJoints, ExudynTree, InHouse
from presswear.linkage.friction_settings import FRICTIONS
from presswear.linkage.mechanisms import SliderCrank
from presswear.linkage.normal_law import DAMPINGS, KELVIN_VOIGT
from presswear.linkage.press import Press
from presswear.linkage.surface import Surface, bin_centres
from presswear.physics.curve_following import motion_of
from presswear.scene.catalog import slider_crank, wear_times
from presswear.scene.conventions import CONVENTIONS
from presswear.scene.scene import Scene
from presswear.scene.settings import changed
from presswear.tools.errors import InputError
from presswear.validation import cases
from presswear.validation.cases import Check, first_contact, guarded

Worn = Mapping[str, tuple[Surface, Surface]]  # bearing and pin by joint

BASE = replace(wear_times(), wear_updates=0)  # clearance at A and C
CLEARANCES = (1e-3, 1e-4, 1e-5, 1e-6)  # m, of the approach to the ideal joint
MIN_CLEARANCE = 1e-9  # m, the smallest that a scene allows
APPROACH = 0.1  # s, half of a stroke and fifty contacts
# Energy residual allowed on worn surfaces with radial contact, relative to that
# exchanged: the law makes energy in blows of 1e4 N and more, whose rounding limits the
# error control.
RADIAL_ENERGY = 1e-4
MAX_CREATED = 0.5  # energy that radial contact may make, relative to that exchanged
FAST = 40.0 * math.pi  # rad/s; a cycle takes 50 ms and has some hundred contacts
LONGEST = 1200.0  # s of CPU time for many cycles
# Largest growth of the constraint error over ten times the cycles. Round-off of the
# crank angle grows ten times, an instability a hundred times or more.
GROWTH = 20.0
CALM = 100  # cycles from which on the error grows evenly
STEEP = ("deeper than c", "radial")  # refused, because the contact makes energy
# Refused from some initial states only, and left out
CHANCE = {("notch", "radial"), ("step", "radial")}


def run_scene(
    scene: Scene,
    duration: float = 0.0,
    start: Start | None = None,
    worn: Worn | None = None,
) -> Run:
    """Run a cycle of a scene, or a duration, s, in its engine."""
    period = scene.mechanism.period
    plan = guarded(duration or period)
    engine = scene.solver.for_cycle(period)
    return run_sound(scene.linkage(worn), start or start_of(scene), engine, plan)


def balanced(scene: Scene, duration: float = 0.0, start: Start | None = None) -> Checks:
    """Check the energy residual of a run."""
    yield energy_check(run_scene(scene, duration, start), scene.solver.word)


def in_engines(
    engines: tuple[str, ...],
    name: str,
    reason: str,
    scene: Scene,
    checks: Callable[[Scene], Checks] = balanced,
    **more: Any,
) -> Iterator[HardCase]:
    """Yield the case of a scene in some engines; ``more`` are fields of `HardCase`."""
    for engine in engines:
        chosen = replace(scene, engine=engine, purpose="trajectory")
        yield HardCase(
            name, reason, chosen.solver.word, partial(checks, chosen), **more
        )


in_both = partial(in_engines, ("exudyn", "dae"))
in_all = partial(in_engines, (ExudynTree.word, ExudynJoints.word, InHouse.word))


def approach(scene: Scene) -> Checks:
    """Check that the distance from the ideal press is of first order in the clearance.

    A micrometre remains without clearance: the elastic deflection of the contacts.
    """

    def distance(clearance: float) -> float:
        tight = replace(scene, bearings=replace(scene.bearings, clearance=clearance))
        recorder = run_scene(tight, APPROACH).recorder
        ideal = tight.ideal_slider(recorder.series("time"))[:, 0]
        return float(np.abs(recorder.series("displacement") - ideal).max())

    least = distance(MIN_CLEARANCE)
    distances = [distance(clearance) for clearance in CLEARANCES]
    order = cases.order_of(CLEARANCES, (np.array(distances) - least).tolist())
    yield Check("distance left at c = 1 nm (m)", least, 2e-6)
    yield Check(
        "order of the distance from the ideal press in c, less 1", order - 1.0, 0.1
    )
    yield Check("distance / c at c = 1 um", distances[-1] / CLEARANCES[-1], 10.0)


def law_cases() -> Iterator[HardCase]:
    """Yield laws, sizes and speeds at the ends of their ranges."""
    rows: list[tuple[str, str, dict[str, Any]]] = [*DATA["press"]]
    for name, law in DAMPINGS.items():
        # Damping without bounds makes a pin at rest stiff: at 0.01 the tree takes a
        # minute.
        nominal = 0.05 if law.least > 0.0 else 0.0
        settings: dict[str, Any] = {"normal_law": name, "restitution": nominal}
        if name != KELVIN_VOIGT:
            rows.append((f"{name}, ce = {nominal:g}", "strong damping", settings))
    for name in FRICTIONS:
        settings = {"friction_law": name, "friction": 0.8}
        rows.append((f"{name}, c_f = 0.8", "friction reverses the pin", settings))
    for name, reason, settings in rows:
        is_tight = settings.get("clearance", 1.0) <= 1e-6
        checks = partial(balanced, duration=APPROACH) if is_tight else balanced
        yield from in_both(name, reason, changed(BASE, settings), checks)
    yield from in_both("c -> 0", "the ideal joint is a stiff limit", BASE, approach)


def on_worn(scene: Scene, worn: Worn) -> Checks:
    """Check the energy of a run on worn surfaces."""
    run = run_scene(scene, worn=worn)
    check = energy_check(run, scene.solver.word)
    if scene.conventions.contact != "radial":
        yield check
        return
    yield replace(check, bound=RADIAL_ENERGY)
    exchanged = float(run.diagnostics["drive_exchange_J"])
    created_fraction = max(-float(run.diagnostics["contact_loss_J"]), 0.0) / exchanged
    yield Check(
        "energy that the radial law made / exchanged", created_fraction, MAX_CREATED
    )


def profile_cases() -> Iterator[HardCase]:
    """Yield worn profiles with radial contact and with the elastic foundation."""
    angle = bin_centres(BINS)
    new = Surface()
    notch = np.where(np.arange(BINS) % 30 == 0, 1.0, 0.0)
    narrow = "twelve notches of one degree, narrower than the arc"
    step = Surface(np.where(angle > 1.5, 3e-5, 0.0))
    deeper = Surface(5e-4 * (1.0 + np.cos(angle - 1.5)))
    profiles = (
        ("step", "an edge on each surface", step, step),
        ("notch", narrow, Surface(1e-4 * notch), new),
        ("shallow notch", narrow, Surface(1e-5 * notch), new),
        ("deeper than c", "1 mm of wear in a clearance of 0.8 mm", deeper, new),
        (
            "all deeper than c",
            "the clearance is more than doubled",
            Surface(1e-3 + 0 * angle),
            new,
        ),
    )
    for name, reason, bearing, pin in profiles:
        for conventions, law in (("paper", "radial"), ("refined", "foundation")):
            if (name, law) not in CHANCE:
                scene = replace(BASE, conventions=CONVENTIONS[conventions])
                refusal = "created .* too steep" if (name, law) == STEEP else ""
                checks = partial(on_worn, worn=dict.fromkeys("AC", (bearing, pin)))
                yield from in_both(
                    f"{name}, {law}", reason, scene, checks, refusal=refusal
                )


def displaced(penetration: float, closing: float = 0.0) -> Start:
    """Return an initial state of ``BASE`` with both pins at a penetration, m, by turning two rods.

    ``closing`` is an added rate of penetration of both, m/s.
    """

    def axis(angle: float) -> np.ndarray:
        return np.array([math.cos(angle), math.sin(angle)])

    start = start_of(BASE)
    linkage = BASE.linkage()
    press = BASE.mechanism
    assert isinstance(press, Press)
    q, v = start.position.copy(), start.velocity.copy()
    reach = BASE.bearings.clearance + penetration
    quarter = 0.5 * math.pi
    for body, length in (("rod 3", press.length_3), ("rod 5", press.length_5)):
        i = 3 * linkage.index(body)
        half = 0.5 * length
        angle = q[i + 2] + 2.0 * math.asin(0.5 * reach / length)
        spin = v[i + 2] + closing / length
        q[i : i + 2] += half * (axis(angle) - axis(q[i + 2]))
        before = v[i + 2] * axis(q[i + 2] + quarter)
        v[i : i + 2] += half * (spin * axis(angle + quarter) - before)
        q[i + 2], v[i + 2] = angle, spin
    return Start(q, v)


def met_together(scene: Scene, speed: float) -> Checks:
    """Check that both pins touch down within a picosecond, each at its closing speed."""
    run = run_scene(scene, start=displaced(-1e-9, speed))
    pins = [first_contact(run, k) for k in range(2)]
    difference = pins[0]["touchdown"] - pins[1]["touchdown"]
    yield Check("time between the two touches (s)", difference, 1e-12)
    worst = max(abs(pin["closing_speed"] / speed - 1.0) for pin in pins)
    yield Check("closing speed over that of the start, less 1", worst, 1e-5)
    yield energy_check(run, scene.solver.word)


@cache
def closest_to_dead_point() -> Press:
    """Return the press with the shortest rod 5 that is not refused, within 0.2 um."""
    short = 0.25209  # is refused
    long = 0.25211  # moves
    for _ in range(7):
        middle = 0.5 * (short + long)
        try:
            motion_of(Press(length_5=middle))
            long = middle
        except InputError:
            short = middle
    return Press(length_5=long)


def near_dead_point(scene: Scene) -> Checks:
    """Check the energy residual of the press that is closest to its dead point."""
    return balanced(replace(scene, mechanism=closest_to_dead_point()))


def beyond_dead_point() -> None:
    """Check the press with rod 5 shorter by 10 um, which is refused."""
    closest = closest_to_dead_point()
    shorter = replace(closest, length_5=closest.length_5 - 1e-5)
    replace(BASE, mechanism=shorter).check()


def state_cases() -> Iterator[HardCase]:
    """Yield initial states in contact or just before it, and mechanisms close to a dead point."""
    for penetration in (1e-6, 1e-12):
        name = f"start in contact, {penetration:g} m deep"
        checks = partial(balanced, start=displaced(penetration))
        yield from in_all(name, "no touchdown, hence no closing speed", BASE, checks)
    together = partial(met_together, speed=0.1)
    yield from in_all(
        "both joints touch at once", "two events in one step", BASE, together
    )
    yield from in_both(
        "toggle, as near as allowed",
        "rod 5 comes near its dead point",
        BASE,
        near_dead_point,
    )
    flat = replace(
        slider_crank(), mechanism=SliderCrank(rod_length=0.05001, slide_angle=0.0)
    )
    yield from in_both("rod as long as the crank", "the rod stands upright", flat)


def drifts(cycles: int, scene: Scene) -> Checks:
    """Compare many cycles with a tenth of them."""
    import resource  # not on Windows

    period = scene.mechanism.period
    runs = []
    memory = []
    engine = scene.solver.for_cycle(period)
    for count in (cycles // 10, cycles):
        plan = guarded(period, count, LONGEST)
        runs.append(run_sound(scene.linkage(), start_of(scene), engine, plan))
        # peak, MB
        memory.append(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0)
    run = runs[-1]
    yield energy_check(run, engine.word)
    yield Check("cycles missing", cycles - len(run.recorder.cycles), 0.0)
    yield Check("memory growth (MB)", memory[1] - memory[0], 8.0)
    if engine.word == "dae":
        early, late = (float(r.diagnostics["constraint_error_m"]) for r in runs)
        yield Check("greatest |Phi| / clearance", late / scene.bearings.clearance, 1e-5)
        if cycles // 10 > CALM:
            yield Check(
                "|Phi| over that of a tenth of the cycles", late / early, GROWTH
            )
    early, late = (abs(float(r.diagnostics["energy_residual_J"])) for r in runs)
    exchanged = float(run.diagnostics["drive_exchange_J"])
    per_cycle = (late / 10.0 - early) / (exchanged / 10.0)
    yield Check("residual a cycle, growth / exchanged", per_cycle, 1e-8)


def refusal_cases() -> Iterator[HardCase]:
    """Yield values beyond their ranges, which are refused by name, value and range."""

    def checks(make: Callable[[], object]) -> Checks:
        make()
        yield Check("was not refused", math.nan, 0.0)

    for key, values in DATA["beyond"].items():
        for value in values:
            name = f"{key} = {value:g}"
            make = partial(changed, BASE, {key: value})
            pattern = rf"{key} = .*allowed is"
            yield HardCase(
                name, "beyond its range", "any", partial(checks, make), pattern
            )
    pattern = "crank angle .* joint .* does not close or is at a dead point"
    yield HardCase(
        "toggle, one step nearer",
        "a dead point",
        "any",
        partial(checks, beyond_dead_point),
        pattern,
    )


def long_cases() -> Iterator[HardCase]:
    """Yield runs of many cycles.

    The in-house engine has constraints, which the tree keeps exactly.
    """
    fast = changed(BASE, {"speed": FAST, "coordinates": "all"})
    for cycles in (100, 2000):
        yield from in_both(
            f"{cycles:,} cycles at 40 pi",
            "errors accumulate",
            fast,
            partial(drifts, cycles),
            is_long=cycles > 100,
        )
