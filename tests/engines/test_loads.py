"""Loads with a law in every engine: closed forms, orders, one against another, the energy."""

import math
from dataclasses import replace

import numpy as np
import pytest
from listeners import Keeps
from runs import energy_residual, in_every_engine
from scipy.integrate import quad, solve_ivp

from presswear.campaign.replicates import start_of
from presswear.engines.base import Plan, Run, Start
from presswear.engines.settings import Engine, ExudynJoints, InHouse
from presswear.linkage.bodies import Body
from presswear.linkage.joints import Guide
from presswear.linkage.linkage import Linkage, assemble
from presswear.linkage.load_laws import (
    Harmonics,
    Law,
    OverPosition,
    OverTime,
    check_load,
)
from presswear.linkage.loads import Force, Moment
from presswear.linkage.points import GROUND, Attachment, OutputPoint
from presswear.linkage.spring import Spring
from presswear.physics.loads import ELASTIC, OFF, WHOLE
from presswear.scene.catalog import wear_times
from presswear.tools.arrays import Array, State
from presswear.tools.errors import InputError
from presswear.tools.user_function import UserFunction
from presswear.validation.cases import finished, order_of

UP = 0.5 * math.pi


def guided(law: Law, gravity: float = 0.0, mass: float = 1.0) -> Linkage:
    """A mass on an inclined guide with a load along it, at a point that is not its centre."""
    direction = 0.0 if gravity == 0.0 else -UP
    return assemble(
        [Body("mass", mass, 1.0, {"tip": (0.1, 0.2)})],
        joints=[Guide("guide", "mass", direction=direction)],
        loads=[
            Force(
                Attachment("mass", 0.0, 0.2) if gravity == 0.0 else "mass",
                direction,
                law,
            )
        ],
        output=OutputPoint("mass", direction),
        gravity=gravity,
        cycle=1.0,
    )


def unit_of(linkage: Linkage) -> Array:
    direction = linkage.output.direction
    return np.array([math.cos(direction), math.sin(direction), 0.0])


def run(
    engine: Engine,
    linkage: Linkage,
    place: float,
    speed: float,
    duration: float,
    cycles: int = 1,
) -> Run:
    """Run a guided mass from a place and a speed along its guide."""
    unit = unit_of(linkage)
    start = Start(place * unit, speed * unit)
    return finished(
        engine.simulate(
            linkage, start, Plan(duration / cycles, cycles, recorded_cycles=1)
        )
    )


def along(ran: Run, linkage: Linkage) -> tuple[float, float]:
    """Place and speed along the guide at the end."""
    unit = unit_of(linkage)
    return float(ran.end.position @ unit), float(ran.end.velocity @ unit)


@in_every_engine
def test_a_table_over_time_moves_a_mass_as_its_double_integral_says(
    engine: Engine, within
):
    """With a jump where the table repeats, and bends that lie on no step."""
    table = [(0.0, 2.0), (0.1234, -1.0), (0.3137, 1.5)]
    period = 0.3137
    end = 1.1
    linkage = guided(OverTime(table, period))
    ran = run(engine, linkage, -0.5, 1.0, end)

    def force(t: float) -> float:
        return float(np.interp(t % period, *np.array(table).T))

    edges = [k * period + t for k in range(4) for t, _ in table if k * period + t < end]
    accuracy = {"points": edges, "epsabs": 1e-13, "limit": 200}
    speed = 1.0 + quad(force, 0.0, end, **accuracy)[0]
    place = -0.5 + end + quad(lambda t: (end - t) * force(t), 0.0, end, **accuracy)[0]
    found = along(ran, linkage)
    assert found == pytest.approx((place, speed), abs=within)
    work = float(ran.diagnostics["load_work_J"])
    assert work == pytest.approx(0.5 * speed**2 - 0.5, abs=within)
    assert energy_residual(ran) < max(1e-12, within)


FREQUENCY = 7.0
BUFFER = OverPosition([(0.1, 0.0), (0.1 + 2.0, -2.0 * FREQUENCY**2)], outside="hold")
"""A spring that begins at 0.1 m."""


def bounced(place: float, speed: float, end: float) -> tuple[float, float]:
    """Place and speed after a mass of 1 kg has run into the buffer and out again."""
    touch = (0.1 - place) / speed
    return 0.1 - speed * (end - touch - math.pi / FREQUENCY), -speed


@in_every_engine
def test_blanking_takes_the_area_under_its_table_and_lets_go(engine: Engine, within):
    """Twice through: the second stroke meets it again, once the whole way back is made."""
    table = [(0.0, 0.0), (0.02, -30.0), (0.05, -40.0)]
    law = OverPosition(table, sense="along", release=True)
    linkage = guided(law)
    ran = run(engine, linkage, -0.5, 4.0, 0.4)
    speed = math.sqrt(16.0 - 2.0 * (0.5 * 30.0 * 0.02 + 35.0 * 0.03))
    assert along(ran, linkage)[1] == pytest.approx(speed, abs=10.0 * within)
    # A spring swings it to and fro: three times through the table, twice in its sense.
    spring = Spring(
        "s", Attachment(GROUND, -3.0, 0.0), Attachment("mass", 0.0, 0.0), 400.0, 3.0
    )
    swung = linkage.changed(springs=[spring])
    energy = 0.5 * 400.0 * 0.3**2
    ran = run(engine, swung, -0.3, 0.0, 0.45)
    once = 0.5 * 30.0 * 0.02 + 35.0 * 0.03
    place, speed = along(ran, swung)
    assert 0.5 * speed**2 + 200.0 * place**2 == pytest.approx(
        energy - 2.0 * once, abs=20 * within
    )
    assert float(ran.diagnostics["load_work_J"]) == pytest.approx(
        -2.0 * once, abs=20 * within
    )


SHEET = OverPosition(
    [(0.0, 0.0), (0.1, -8.0), (1.0, -8.0)], "along", outside="hold", unloading=160.0
)
"""It yields at 8 N, at 0.1 m, and springs back twice as steeply."""


def dented(
    place: float, speed: float, end: float, g: float = 0.0
) -> tuple[float, float, float]:
    """Place and speed of a mass of 1 kg that falls into the sheet, and its deepest place."""
    table = np.array(SHEET.table).T
    accuracy = {"method": "DOP853", "rtol": 1e-13, "atol": 1e-14}

    def first(_: float, y: Array) -> list[float]:
        return [y[1], g + float(np.interp(y[0], *table))]

    def turns(_: float, y: Array) -> float:
        return float(y[1])

    def later(_: float, y: Array) -> list[float]:
        return [y[1], g - max(8.0 - SHEET.unloading * (deepest - y[0]), 0.0)]

    vars(turns).update(terminal=True, direction=-1.0)
    down = solve_ivp(first, (0.0, end), (place, speed), events=turns, **accuracy)
    deepest = float(down.y[0, -1])
    place, speed = solve_ivp(later, (down.t[-1], end), (deepest, 0.0), **accuracy).y[
        :, -1
    ]
    return place, speed, deepest


@in_every_engine
def test_a_mass_bounces_on_its_dent_for_ever(engine: Engine, within):
    """It falls into a sheet once; later falls reach the same depth, and take nothing."""
    g = 2.0
    fall = 0.5
    end = 4.3
    linkage = guided(SHEET, gravity=g)
    ran = run(engine, linkage, -fall, 0.0, end)
    place, speed, deepest = dented(-fall, 0.0, end, g)
    assert along(ran, linkage) == pytest.approx((place, speed), abs=40.0 * within)
    free = deepest - 8.0 / SHEET.unloading
    stored = 0.5 * SHEET.unloading * max(place - free, 0.0) ** 2
    taken = 8.0 * (deepest - 0.05) - 32.0 / SHEET.unloading + stored
    assert float(ran.diagnostics["load_work_J"]) == pytest.approx(
        -taken, abs=40.0 * within
    )
    assert energy_residual(ran) < max(1e-12, 40.0 * within)


@in_every_engine
def test_a_run_goes_on_from_within_a_sheet_bit_for_bit(engine: Engine, within):
    """Where it is loaded first, on the elastic line, and behind it."""
    linkage = guided(SHEET)
    kept: list[State] = []
    start = Start(np.array([-0.5, 0.0, 0.0]), np.array([2.0, 0.0, 0.0]))
    plan = Plan(0.1, 8, recorded_cycles=8)
    whole = engine.simulate(
        linkage, start, replace(plan, observers=(Keeps(kept.append),))
    )
    gates = [int(state["recorder/modes"]["branch"][0]) for state in kept]
    assert gates == [WHOLE] * 5 + [ELASTIC] + [OFF] * 2
    for cycle in (4, 6, 7):
        resumed = engine.simulate(linkage, start, replace(plan, resume=kept[cycle - 1]))
        assert resumed.end.position.tobytes() == whole.end.position.tobytes()
        assert resumed.end.velocity.tobytes() == whole.end.velocity.tobytes()
        assert resumed.recorder.rows.tobytes() == whole.recorder.rows.tobytes()
        for name in ("load_work_J", "steps"):
            assert resumed.diagnostics[name] == whole.diagnostics[name]


def errors(
    engines: list[Engine], law: OverPosition, exact: tuple[float, float]
) -> list[float]:
    """Errors of a mass that comes to a law."""
    linkage = guided(law)
    runs = [run(engine, linkage, -0.5, 2.0, 1.1) for engine in engines]
    return [math.dist(along(ran, linkage), exact) for ran in runs]


@pytest.mark.parametrize(
    ("law", "exact"),
    [(BUFFER, bounced(-0.5, 2.0, 1.1)), (SHEET, dented(-0.5, 2.0, 1.1)[:2])],
    ids=["buffer", "sheet"],
)
@pytest.mark.parametrize(
    ("kind", "counts", "order"),
    [("rk4", (107, 211, 419, 839), 4.0), ("trapezoidal", (501, 1003, 2001), 2.0)],
)
def test_a_bend_costs_no_order(
    kind,
    counts,
    order,
    law: OverPosition,
    exact,
):
    steps = [1.1 / n for n in counts]
    engines: list[Engine] = [
        InHouse("rk4", equal_step=step)
        if kind == "rk4"
        else ExudynJoints(50, 10, free_step=step, newton=1e-12)
        for step in steps
    ]
    assert order_of(steps, errors(engines, law, exact)) == pytest.approx(
        order, abs=0.35
    )


def test_order_eight_follows_its_tolerance_over_a_bend():
    """With two events, whatever the tolerance; one that stepped over them would need many steps."""
    tolerances = [1e-8, 1e-9, 1e-10, 1e-11]
    linkage = guided(BUFFER)
    exact = bounced(-0.5, 2.0, 1.1)
    found = []
    steps = []
    for tolerance in tolerances:
        ran = run(
            InHouse(integration_tolerance=tolerance, free_step=1.0),
            linkage,
            -0.5,
            2.0,
            1.1,
        )
        assert ran.diagnostics["events"] == 2
        found.append(math.dist(along(ran, linkage), exact))
        steps.append(int(ran.diagnostics["steps"]))
    assert 0.85 < order_of(tolerances, found) < 1.2
    assert max(steps) < 60


@in_every_engine
def test_what_rests_at_a_change_of_law_stays_there(engine: Engine, within):
    """At rest on a bend: round-off to and fro is no event."""
    spring = Spring(
        "s", Attachment(GROUND, 0.0, 1.0), Attachment("mass", 0.0, 0.0), 300.0, 0.9
    )
    bend = OverPosition([(-0.1, 0.0), (0.0, 20.0), (0.1, 0.0)])
    linkage = guided(bend, gravity=10.0)
    linkage = linkage.changed(springs=[spring])
    ran = run(engine, linkage, 0.0, 0.0, 1.0)
    assert along(ran, linkage) == pytest.approx((0.0, 0.0), abs=1e-9)
    assert int(ran.diagnostics["steps"]) < 4000


def test_a_load_on_a_crank_that_is_left_out_is_its_drives():
    """Held by a clearance joint alone, the crank is no body of Exudyn's."""
    linkage = replace(wear_times(), joints="A").linkage()
    loaded = linkage.changed(
        loads=[Moment("crank 2", Harmonics(1.0, 50.0, [(2.0, 1.5)]))]
    )
    start = start_of(wear_times())
    works = []
    for engine in (ExudynJoints(50, 10, free_step=1e-5), InHouse()):
        for own in (linkage, loaded):
            ran = finished(
                engine.simulate(own, start, Plan(0.005, 1, recorded_cycles=1))
            )
            works.append(
                [float(ran.diagnostics[f"{name}_work_J"]) for name in ("drive", "load")]
            )
    for without, with_load in (works[:2], works[2:]):
        assert without[1] == 0.0
        assert with_load[1] == pytest.approx(works[3][1], rel=1e-6)
        assert without[0] - with_load[0] == pytest.approx(with_load[1], rel=1e-6)
    # The crank turns at a speed that is given, backwards.
    speed = linkage.drives[0].speed
    phase = 50.0 * 0.005
    integral = 0.005 + (2.0 * math.sin(phase) + 1.5 * (1.0 - math.cos(phase))) / 50.0
    assert works[3][1] == pytest.approx(speed * integral, rel=1e-9)


def wobble(time: float, position: float, speed: float) -> float:
    return -3.0 * position - 0.2 * speed + math.sin(time)


@in_every_engine
def test_a_function_of_ones_own_is_a_load(engine: Engine, within):
    """A damped oscillator under sin t."""
    linkage = guided(wobble)
    ran = run(engine, linkage, -0.5, 1.0, 1.3)

    def rates(t: float, y: Array) -> list[float]:
        return [y[1], wobble(t, *y)]

    exact = solve_ivp(
        rates, (0.0, 1.3), (-0.5, 1.0), "DOP853", rtol=1e-13, atol=1e-14
    ).y[:, -1]
    assert along(ran, linkage) == pytest.approx(tuple(exact), abs=within)


@pytest.mark.parametrize(
    ("body", "words"),
    [
        (
            "-3.5 if speed > 0.0 else 5.0",
            "jumps from 5 to -3.5 N or N m at a speed of 0 m/s",
        ),
        ("-math.copysign(1.0, speed)", "jumps from 1 to -1"),
        (
            "-speed * (2.0 if speed < 0.3 else 3.0)",
            "jumps from -0.6 to -0.9 .* speed of 0.3 m/s",
        ),
        ("-math.copysign(position, speed)", "jumps from"),
        ("-math.tanh(speed / 1e-9)", "jumps from"),
        ("-math.tanh(speed / 1e-3)", ""),
        ("-math.tanh(speed / 1e-4) * abs(position)", ""),
        ("-20.0 * speed - 5.0 * abs(speed) * speed", ""),
        ("-min(max(speed, -0.1), 0.1)", ""),
        ("1.0 / speed", "jumps from"),
        ("5.0 if position > 0.5 else 0.0", ""),
        ("math.sqrt(position)", ""),
    ],
)
def test_a_law_that_jumps_with_the_speed_is_refused(body, words):
    source = f"def law(position, speed):\n    return {body}\n"
    function = UserFunction("law", source).trusted()
    if not words:
        check_load("loads[0].law", function)
        return
    with pytest.raises(InputError, match=words) as refusal:
        check_load("loads[0].law", function)
    assert "tanh(speed / 0.001)" in str(refusal.value)
