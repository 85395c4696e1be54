"""Tonnage, drives, strokes and deep contacts against closed forms, virtual work and balances."""
# mypy: disable-error-code="union-attr,operator"

import math
from dataclasses import replace
from functools import partial
from itertools import pairwise, product
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from closed_form import needed_by_virtual_work, press_motion
from four_bar_linkage import FOUR_BAR
from scipy.integrate import quad, simpson
from scipy.optimize import brentq
from scipy.stats import t as student

import presswear as pw
from presswear.physics.touchdown import CONTACT_COLUMNS
from presswear.recording.soundness import ENERGY_BOUND
from presswear.results.deep_contacts import deep_contacts, forces_by_law
from presswear.results.drives import curves_of, drives_of
from presswear.results.export import table_of, unit_of
from presswear.results.rigid_joints import ideal_drives, ideal_forces
from presswear.results.run_warnings import run_warnings
from presswear.results.strokes import (
    PHASES,
    SNAP_THROUGH_S,
    SampledStroke,
    height_of,
    process_force,
    sampled_strokes,
)
from presswear.results.tonnage import joint_tonnage
from presswear.scene.options import Numerics
from presswear.scene.settings import changed
from presswear.show.key_numbers import key_numbers
from presswear.show.stage_tables import drive_table
from presswear.tools.arrays import Array

PRESS = pw.Press()
PERIOD = PRESS.period
SHEET = pw.Blanking(cushion=30.0)
IDEAL = replace(pw.scenes.ideal(), process=SHEET, engine="dae", cycles=4)


@pytest.fixture(scope="module")
def ideal() -> pw.Result:
    return pw.run(IDEAL)


def slider(time: Array) -> Array:
    """Place, velocity and acceleration of the slider in closed form, shape (n, 3)."""
    return press_motion(PRESS, np.atleast_1d(time)).output(PRESS.linkage())


def standing(begin: float, end: float) -> float:
    """Time between two others at which the slider stands still, s."""
    return float(
        brentq(lambda time: slider(np.array(time))[0, 1], begin, end, xtol=1e-15)
    )


LOWEST = standing(0.04, 0.08)
HIGHEST = standing(0.25, 0.45)
BOTTOM = float(slider(np.array(LOWEST))[0, 0])


def force_at(depth: Array, velocity: Array) -> Array:
    places, forces = np.array(SHEET.curve).T
    held = SHEET.cushion * np.clip(depth / places[1], 0.0, 1.0)
    return np.asarray(
        np.interp(depth, places, forces, 0.0, 0.0) * (velocity < 0.0) + held
    )


def test_the_ideal_press_gives_a_part_its_force_and_work(ideal: pw.Result) -> None:
    stage = ideal.stages[0]
    height = ideal.height(0)
    force = np.asarray(ideal.process_force(0))
    np.testing.assert_allclose(height, slider(stage.time)[:, 0] - BOTTOM, atol=1e-8)
    expected = force_at(SHEET.height - height, stage.velocity)
    np.testing.assert_allclose(force, expected, atol=1e-6 * SHEET.force)
    table = table_of(ideal, 0)
    np.testing.assert_array_equal(
        [table["process_force"], table["height"]], [force, height]
    )
    tonnage = ideal.tonnage(0)
    # Of two sampled strokes and cycles.
    for work in (tonnage.work, stage.statistics.drive_work_per_cycle):
        assert work.samples == 2
        assert work.mean == pytest.approx(SHEET.work, abs=1e-6 * SHEET.work)
    assert (stage.statistics.energy_residual_fraction or 1.0) < ENERGY_BOUND
    duties = [drive.duty for drive in ideal.drives(0).values()]
    total = sum(duty.supplied for duty in duties)
    assert sum(duty.work for duty in duties) == pytest.approx(
        SHEET.work, abs=1e-9 * total
    )
    assert tonnage.peak_force.mean == pytest.approx(
        SHEET.force + SHEET.cushion, rel=1e-9
    )
    # Nothing is loose: what shakes is the round-off of the run.
    assert tonnage.vibration_after.mean < 1e-6 * stage.acceleration.std()


def test_ideal_drives_are_those_of_virtual_work(ideal: pw.Result) -> None:
    """Numbers of each drive by Simpson's rule over the smooth pieces of the closed form."""

    def passes(height: float, begin: float, end: float) -> float:
        def off(time: float) -> float:
            return float(slider(np.array(time))[0, 0]) - BOTTOM - height

        return float(brentq(off, begin, end, xtol=1e-15))

    begin = HIGHEST
    low = LOWEST + PERIOD
    end = HIGHEST + PERIOD
    heights = [SHEET.height - depth for depth, _ in SHEET.curve]
    edges = [begin, *(passes(each, begin, low) for each in heights), low]
    edges += [*sorted(passes(each, low, end) for each in heights[:2]), end]
    sums = np.zeros((2, 6))
    peaks = np.zeros(2)
    for first, last in pairwise(edges):
        time = np.linspace(first, last, 2001)
        # The piece that begins here is that of its inside.
        place, velocity, _ = slider(np.clip(time, first + 1e-12, last - 1e-12)).T
        force = force_at(SHEET.height - (place - BOTTOM), velocity)
        torque = needed_by_virtual_work(PRESS, time, force).T
        power = torque * np.array([[-PRESS.speed], [PRESS.speed]])
        rows = (torque, torque**2, power, power**2, power.clip(0.0), (-power).clip(0.0))
        sums += np.transpose([simpson(row, x=time) for row in rows])
        peaks = np.maximum(peaks, np.abs(torque).max(axis=1))
    drives = ideal.drives(0)
    assert list(drives) == ["crank 2", "crank 7"]
    for k, found in enumerate(drives.values()):
        duty = found.ideal
        mean, square, power, square_power = sums[k, :4] / PERIOD
        assert duty.torque.mean == pytest.approx(mean, rel=1e-6)
        assert duty.torque.rms == pytest.approx(math.sqrt(square), rel=1e-6)
        assert duty.power.mean == pytest.approx(power, rel=1e-6)
        assert duty.power.rms == pytest.approx(math.sqrt(square_power), rel=1e-6)
        exchange = sums[k, 4:].sum()
        gained_and_lost = duty.supplied, duty.returned
        assert gained_and_lost == pytest.approx(tuple(sums[k, 4:]), abs=1e-6 * exchange)
        assert abs(duty.torque.peak) == pytest.approx(peaks[k], rel=1e-7)
        # The run, whose peaks stand in rows at the ends of the pieces.
        assert found.duty.torque.rms == pytest.approx(duty.torque.rms, rel=1e-6)
        assert abs(found.duty.torque.peak) == pytest.approx(peaks[k], rel=1e-4)


def test_ideal_peaks_include_work_that_is_shorter_than_a_piece() -> None:
    """A foil is cut within 60 µs; the ideal motion is followed in pieces of 0.8 ms."""
    foil = pw.Blanking(
        height=15e-3, thickness=20e-6, rise=15e-6, plateau=0.5, snap=5e-6
    )
    scene = replace(IDEAL, process=foil)

    def off(time: float) -> float:
        return (
            float(slider(np.array(time))[0, 0]) - BOTTOM - foil.height + foil.fracture
        )

    fracture = np.array([brentq(off, HIGHEST, LOWEST + PERIOD, xtol=1e-15)])
    acceleration = slider(fracture)[0, 2]
    torque = np.abs(needed_by_virtual_work(PRESS, fracture, np.array([foil.force])))[0]
    _, forces = ideal_forces(scene)
    weight = PRESS.mass_6 * (PRESS.gravity + acceleration)
    assert abs(forces["E"].imag).max() == pytest.approx(foil.force - weight, rel=1e-9)
    duties = ideal_drives(scene)
    for body, peak in zip(duties, torque, strict=True):
        assert abs(duties[body].torque.peak) >= peak * (1.0 - 1e-7)
    greatest = max(abs(duty.torque.peak) for duty in duties.values())
    pw.changed(scene, {"torque_limit": 1.001 * greatest}).check()
    with pytest.raises(pw.InputError, match="the ideal motion needs"):
        pw.changed(scene, {"torque_limit": 0.999 * greatest}).check()


@pytest.mark.parametrize("run_up", [0, 2])
def test_ideal_forces_are_those_of_the_second_cycle_after_the_run_up(
    run_up: int,
) -> None:
    """The work of the first cycle may start within its stroke."""
    scene = replace(IDEAL, mechanism=replace(PRESS, run_up=run_up))
    time, forces = ideal_forces(scene)
    assert scene.run_up >= run_up * PERIOD
    assert time[0] == pytest.approx(scene.run_up + PERIOD, rel=1e-12)
    assert 0.0 < scene.run_up + 2.0 * PERIOD - time[-1] <= PERIOD / 720.0 * (1.0 + 1e-9)
    assert {force.shape for force in forces.values()} == {time.shape}


def test_strokes_of_the_ideal_press_are_those_of_its_dead_centres(
    ideal: pw.Result,
) -> None:
    strokes = sampled_strokes(IDEAL, ideal.stages[0])
    moments = ideal.strokes(0)
    # The speed is a line over each 1440th of the cycle: off by h^2 / 8 jerk /
    # acceleration.
    off = (PERIOD / 1440.0) ** 2 / 8.0 * 20.0 * PRESS.speed
    starts, bottoms = (
        [getattr(each, name) for each in strokes] for name in ("start", "bottom")
    )
    assert starts == pytest.approx([HIGHEST + k * PERIOD for k in (1, 2)], abs=off)
    assert bottoms == pytest.approx([LOWEST + k * PERIOD for k in (2, 3)], abs=off)
    assert {each.fracture for each in strokes} <= set(moments.fracture[:, 0])


@pytest.mark.parametrize("engine", ["dae", "exudyn-tree"])
def test_work_and_energies_of_a_loose_press_are_those_of_its_engine(
    engine: str,
) -> None:
    """The force over the recorded height, and the work that the engine summed step by step."""
    short: dict[str, Any] = {
        "engine": engine,
        "wear_updates": 0,
        "replicates": 1,
        "cycles": 3,
    }
    short["purpose"] = "trajectory"
    scene: Any = replace(pw.scenes.press_blanking(), **short, process=SHEET)
    assert scene.stores_torques
    result = pw.run(scene)
    stage = result.stages[0]
    force = np.asarray(process_force(scene, stage))
    exchange = float(stage.diagnostics["drive_exchange_J"] or 0.0)
    work = -float(np.trapezoid(force, height_of(scene, stage)))
    taken = -float(stage.diagnostics["load_work_J"] or 0.0)
    # Beside what the thinned rows leave out where the slider turns on the work.
    assert work == pytest.approx(taken, abs=1e-5 * exchange)
    total = pytest.approx(stage.diagnostics["drive_work_J"], abs=1e-12)
    assert stage.each_cycle("drive_work").sum() == total
    assert (stage.statistics.energy_residual_fraction or 1.0) < ENERGY_BOUND
    told = result.tonnage(0)
    assert told.strokes == 1
    for own in told.joints.values():
        assert set(own.peak_by_phase) == set(PHASES)
        assert 0.0 < own.working_force.mean <= own.peak_by_phase["work"].mean
        # A cushion may hold the load on its side.
        assert 0.0 <= own.reversed_force.mean <= own.peak_by_phase["snap-through"].mean
        assert (own.reversal_time is None) == (own.reversed_force.mean == 0.0)


def test_without_work_there_are_approach_and_return_alone() -> None:
    scene = replace(
        pw.scenes.wear_times(), engine="dae", wear_updates=0, replicates=1, cycles=3
    )
    result = pw.run(scene)
    assert not scene.stores_torques
    assert result.drives(0) == {}
    told = result.tonnage(0)
    assert told.peak_force is None
    assert told.vibration_after is None
    for own in told.joints.values():
        assert set(own.peak_by_phase) == {"approach", "return"}
        assert own.reversed_force is None
    assert process_force(scene, result.stages[0]) is None
    assert "crank 2_torque" not in table_of(result, 0)
    assert "crank 2_angle" in table_of(result, 0)


NO_CONTACTS = np.zeros((0, len(CONTACT_COLUMNS)))
STROKE = SampledStroke(
    start=1.0, bottom=1.5, end=2.0, contact=1.4, fracture=1.45, done=1.45
)


@pytest.mark.parametrize(
    ("angle", "back", "delay"),
    [
        (0.3, 0.0, 0.0),
        (2.0, 70.0, 0.0),
        (4.0, 250.0, 0.011),
        (6.0, 0.1, 0.0175),
        (1.0, 90.0, 0.03),
    ],
)
def test_a_reversal_is_along_the_force_that_worked(
    angle: float, back: float, delay: float
) -> None:
    """Half a sine one way up to the fracture, and one of 4 ms the other way after a delay."""
    time = np.linspace(1.0, 2.0, 20_001)
    pressed = 100.0

    def pulse(begin: float, end: float) -> Array:
        part = np.clip((time - begin) / (end - begin), 0.0, 1.0)
        # Beyond its ends a sine is zero but for round-off.
        return np.where((part > 0.0) & (part < 1.0), np.sin(math.pi * part), 0.0)

    late = STROKE.fracture + delay
    size = pressed * pulse(STROKE.contact, STROKE.fracture) - back * pulse(
        late, late + 4e-3
    )
    unit = np.array([math.cos(angle), math.sin(angle)])
    arrays = {
        "force": np.column_stack([size, 0.0 * size]),
        "eccentricity": np.tile(unit, (time.size, 1)),
        "contacts": NO_CONTACTS,
    }
    tonnage = joint_tonnage(time, pw.results.JointResult("A", None, arrays), [STROKE])
    assert tonnage.working_force.mean == pytest.approx(pressed, rel=1e-4)
    is_seen = back > 0.0 and delay < SNAP_THROUGH_S
    expected = back if is_seen else 0.0
    assert tonnage.reversed_force.mean == pytest.approx(
        expected, rel=1e-3, abs=1e-9 * pressed
    )
    assert (tonnage.reversal_time is not None) == is_seen
    if tonnage.reversal_time is not None:
        assert delay - 1e-9 <= tonnage.reversal_time.mean <= delay + 1.1e-4


def test_a_reversed_force_counts_the_friction_on_the_bearing() -> None:
    """(3, -4) N works where the pin presses along x with friction; 5 N along y has 4 N against."""
    time = np.linspace(1.0, 2.0, 20_001)
    works = (time > 1.41) & (time < 1.44)
    back = (time > 1.451) & (time < 1.455)
    force = np.outer(works, [3.0, 4.0]) + np.outer(back, [5.0, 0.0])
    directions = np.where(back[:, np.newaxis], [0.0, 1.0], [1.0, 0.0])
    arrays = {"force": force, "eccentricity": directions, "contacts": NO_CONTACTS}
    found = joint_tonnage(time, pw.results.JointResult("A", None, arrays), [STROKE])
    assert found.working_force.mean == pytest.approx(5.0)
    assert found.reversed_force.mean == pytest.approx(4.0)


def test_peaks_between_rows_are_those_of_contacts_in_the_phase() -> None:
    """A contact lies in the approach, a second ends in the work, a third is in no stroke."""
    time = np.linspace(1.0, 2.0, 101)
    contacts = np.zeros((3, len(CONTACT_COLUMNS)))
    spans = {"touchdown": (1.2, 1.39, 0.5), "separation": (1.201, 1.41, 0.6)}
    for name, values in {**spans, "peak_force": (200.0, 900.0, 800.0)}.items():
        contacts[:, CONTACT_COLUMNS.index(name)] = values
    force = np.tile([30.0, 40.0], (time.size, 1))
    arrays = {
        "force": force,
        "eccentricity": np.ones((time.size, 2)),
        "contacts": contacts,
    }
    tonnage = joint_tonnage(time, pw.results.JointResult("A", None, arrays), [STROKE])
    peaks = {name: peak.mean for name, peak in tonnage.peak_by_phase.items()}
    assert peaks == {
        "approach": 200.0,
        "work": 50.0,
        "snap-through": 50.0,
        "return": 50.0,
    }


def test_light_contacts_of_the_approach_do_not_need_rows() -> None:
    """In simulated strokes the greatest force of a phase is that of a row, or of a contact.

    A stroke may have no contact in its approach: the motion is chaotic.
    """
    scene = replace(
        pw.scenes.press_blanking(conventions="refined"), engine="dae", wear_updates=0
    )
    result = pw.run(replace(scene, cycles=4), jobs=1)
    stage = result.stages[0]
    strokes = sampled_strokes(scene, stage)
    is_between_rows = []
    for joint, stroke in product(stage.joints.values(), strokes):
        start, end = stroke.phases["approach"]
        begins, ends, peak = map(
            joint.contact, ("touchdown", "separation", "peak_force")
        )
        strongest = peak[(begins >= start) & (ends < end)].max(initial=0.0)
        rows = (stage.time >= start) & (stage.time < end)
        highest = np.hypot(*joint.force[rows].T).max()
        tonnage = joint_tonnage(stage.time, joint, [stroke])
        assert tonnage.peak_by_phase["approach"].mean == pytest.approx(
            max(strongest, highest)
        )
        is_between_rows.append(strongest > highest)
    assert len(strokes) > 1
    assert any(is_between_rows)


def test_peaks_are_told_by_phase_with_their_scatter() -> None:
    """Three strokes with planted peaks; Student's interval from scipy."""
    strokes = [SampledStroke(*(moment + k for moment in STROKE)) for k in range(3)]
    time = np.linspace(1.0, 4.0, 6001)
    planted = {"approach": 1.2, "work": 1.42, "snap-through": 1.46, "return": 1.7}
    sizes = {
        name: 100.0 * (1 + k) + np.array([0.0, 7.0, 5.0])
        for k, name in enumerate(planted)
    }
    force = np.zeros((time.size, 2))
    for name, at in planted.items():
        for k in range(3):
            row = int(np.abs(time - at - k).argmin())
            force[row] = 0.8 * sizes[name][k], 0.6 * sizes[name][k]
    along = np.tile([1e-4, 0.0], (time.size, 1))
    arrays = {"force": force, "eccentricity": along, "contacts": NO_CONTACTS}
    found = joint_tonnage(time, pw.results.JointResult("A", None, arrays), strokes)
    assert set(found.peak_by_phase) == set(PHASES)
    for name, own in sizes.items():
        half = float(student.ppf(0.975, 2)) * own.std(ddof=1) / math.sqrt(3.0)
        assert found.peak_by_phase[name].mean == pytest.approx(own.mean())
        # The interval of the logarithm
        ends = own.mean() * np.exp(np.array([-half, half]) / own.mean())
        peak = found.peak_by_phase[name]
        assert (peak.low, peak.high) == pytest.approx(tuple(ends))
        assert found.peak_by_phase[name].samples == 3
    # Both push the same way: nothing is reversed.
    assert found.reversed_fraction.mean == 0.0
    assert found.reversal_time is None


PENDULUM = pw.assemble(
    bodies=[pw.Bar("crank", length=0.4, mass=2.0)],
    joints=[pw.Pin("O", (0.0, 0.0), "crank.tail")],
    drives=[pw.Drive("crank", speed=5.0, angle=0.3)],
    name="a bar that is turned",
)


def turned(linkage: pw.linkage.Linkage, cycles: int, engine: str = "dae") -> pw.Scene:
    scene = pw.Scene(
        linkage, joints="none", wear_updates=0, cycles=cycles, engine=engine
    )
    return changed(scene, {"drive_torque": "on"})


@pytest.mark.parametrize("run_up", [0, 1])
def test_a_bar_that_is_turned_bears_its_weight(run_up: int) -> None:
    """M = m g r cos a + J a'': closed form, run-up included."""
    scene = turned(replace(PENDULUM, run_up=run_up), cycles=3)
    stage = pw.run(scene).stages[0]
    found = drives_of(scene, stage)["crank"]
    curve = curves_of(scene, stage)["crank"]
    motion = scene.ideal.at(stage.time)
    levels = motion.position, motion.velocity, motion.acceleration
    angle, speed, faster = (level[:, 2] for level in levels)
    inertia = 2.0 * 0.4**2 / 3.0
    torque = 2.0 * 9.81 * 0.2 * np.cos(angle) + inertia * faster
    np.testing.assert_allclose(curve.torque, torque, atol=1e-6)
    np.testing.assert_allclose(curve.power, torque * speed, atol=1e-5)
    weight = 2.0 * 9.81 * 0.2
    # Over whole turns at constant speed the weight does no work.
    exact = 1e-6
    assert stage.each_cycle("drive_work") == pytest.approx(np.zeros(3), abs=exact)
    for duty in (found.duty, found.ideal):
        assert duty.torque.mean == pytest.approx(0.0, abs=exact)
        assert duty.torque.rms == pytest.approx(weight / math.sqrt(2.0), rel=exact)
        assert abs(duty.torque.peak) == pytest.approx(weight, rel=1e-4)
        assert abs(duty.power.peak) == pytest.approx(5.0 * weight, rel=1e-4)
        # Half a turn up, half a turn down.
        assert (duty.supplied, duty.returned) == pytest.approx(
            (2.0 * weight,) * 2, rel=10 * exact
        )
    columns = table_of(pw.run(scene), 0)
    np.testing.assert_array_equal(columns["crank_power"], curve.power)
    np.testing.assert_array_equal(columns["crank_angle"], angle)
    assert unit_of("crank_power") == "W"
    assert unit_of("my_crank_torque") == "N m"


@pytest.mark.parametrize("engine", ["dae", "exudyn-tree", "exudyn-joints"])
def test_works_of_the_drives_add_up_to_the_ledger_for_any_number_of_rows(
    engine: str,
) -> None:
    duties = []
    for rows in (100, 3000):
        scene: Any = pw.Scene(FOUR_BAR, joints="B", wear_updates=0, engine=engine)
        settings = {"drive_torque": "on", "rows_per_cycle": rows}
        scene = changed(scene, {"cycles": 1, "replicates": 1, **settings})
        stage = pw.run(scene).stages[0]
        own = {name: found.duty for name, found in drives_of(scene, stage).items()}
        gross = sum(duty.supplied + duty.returned for duty in own.values())
        total = sum(duty.work for duty in own.values())
        assert total == pytest.approx(
            stage.diagnostics["drive_work_J"], abs=1e-6 * gross
        )
        duties.append(own)
    assert duties[0] == duties[1]


@pytest.mark.parametrize("engine", ["dae", "exudyn-joints"])
def test_an_uneven_drive_of_a_mere_inertia_has_the_duty_of_its_law(engine: str) -> None:
    """A wheel whose speed is w + a cos(w t): M = -J a w sin(w t), in closed form."""
    speed = 5.0
    part = 2.0
    inertia = 0.8
    wheel = pw.assemble(
        bodies=[pw.Body("wheel", mass=1.0, inertia=inertia)],
        joints=[pw.Pin("O", (0.0, 0.0), "wheel.centre")],
        drives=[pw.Drive("wheel", speed=speed, harmonics=[(0.0, part / speed)])],
        gravity=0.0,
    )
    scene = turned(wheel, cycles=2, engine=engine)
    duty = drives_of(scene, pw.run(scene).stages[0])["wheel"].duty
    exact = 1e-6 if engine == "dae" else 1e-4  # equal steps of the trapezoidal rule
    assert duty.torque.rms == pytest.approx(
        inertia * part * speed / math.sqrt(2.0), rel=exact
    )
    # From the least speed to the greatest, and back.
    work = 0.5 * inertia * ((speed + part) ** 2 - (speed - part) ** 2)
    assert (duty.supplied, duty.returned) == pytest.approx((work, work), rel=exact)
    assert abs(duty.torque.peak) == pytest.approx(inertia * part * speed, rel=1e-4)


def test_a_run_that_ends_in_its_run_up_has_no_duties() -> None:
    """A stage that failed before its first cycle: nothing is whole, and nothing breaks."""
    scene = turned(replace(PENDULUM, run_up=2), cycles=1)
    result = pw.run(scene)
    stage = result.stages[0]
    rows = {
        name: stage.arrays[name][:900] for name in ("time", "slider", "drive_torque")
    }
    assert rows["time"][-1] < scene.run_up
    rows |= {name: stage.arrays[name][:0] for name in ("cycles", "cycle_start")}
    cut = replace(stage, arrays={**stage.arrays, **rows})
    assert drives_of(scene, cut) == {}
    assert drive_table(replace(result, stages=(cut,))) is None


CRANK = pw.SliderCrank(slide_angle=0.0, speed=30.0, gravity=0.0)
THIN_SHEET = pw.Blanking(height=3e-3, force=50.0)
SOFT = pw.Bearing(clearance=1e-4, friction=0.0, normal_law="flores", restitution=0.1)
"""Pins come to rest on it, and nothing grows."""


@pytest.fixture(scope="module")
def both() -> list[pw.Result]:
    """Of the highest place as it stands, and of the lowest turned by half a turn."""
    linkage = CRANK.linkage()
    turned = linkage.changed(
        drives=(replace(linkage.drives[0], angle=math.pi),),
        guess={"crank": math.pi, "rod": math.pi},
    )
    exact = Numerics(dae=pw.engines.InHouse(integration_tolerance=1e-12))
    short: dict[str, Any] = {"wear_updates": 0, "cycles": 3, "engine": "dae"}
    short |= {"numerics": exact, "conventions": "paper"}
    scenes = [
        pw.Scene(mechanism, process=process, bearings={"B": SOFT}, **short)
        for mechanism, process in (
            (linkage, replace(THIN_SHEET, bottom="highest")),
            (turned, THIN_SHEET),
        )
    ]
    return [pw.run(scene) for scene in scenes]


def test_the_highest_place_is_bottom_dead_centre_everywhere(
    both: list[pw.Result],
) -> None:
    scenes = [result.scene for result in both]
    # Rod and crank in line, farthest from the axis.
    for scene in scenes:
        assert scene.bottom == pytest.approx(
            -CRANK.rod_length - CRANK.crank_length, abs=1e-15
        )
    near = 1e-9
    stages: list[pw.results.StageResult] = [result.stages[0] for result in both]
    one, other = (stage.bdc for stage in stages)
    assert one.strokes == other.strokes == 1
    for name in ("height", "error", "delay"):
        assert getattr(one, name).mean == pytest.approx(
            getattr(other, name).mean, abs=near
        )
    assert one.ideal_height == pytest.approx(other.ideal_height, abs=near)
    # Pulled away from the work the pin gives way by its clearance; below 1 mm either
    # way.
    assert -1e-3 < one.error.mean < 0.0
    for name in ("contact", "fracture", "separation"):
        first, second = (getattr(result.strokes(0), name) for result in both)
        np.testing.assert_allclose(first, second, atol=1e-9)
    tonnages = [result.tonnage(0) for result in both]
    forces = [
        own.joints["B"].peak_by_phase["work"].mean
        for own in tonnages
        if own is not None
    ]
    assert forces[0] == pytest.approx(forces[1], rel=1e-6)
    heights = [result.height(0) for result in both]
    assert heights[0].max() == pytest.approx(2.0 * CRANK.crank_length, abs=1e-3)
    # Rows are apart by a 2000th of a cycle.
    for end in (np.min, np.max):
        assert end(heights[0]) == pytest.approx(end(heights[1]), abs=1e-6)


def test_what_is_pushed_away_from_the_work_rises(both: list[pw.Result]) -> None:
    loose = [result.scene.linkage() for result in both]
    total = [pw.statics.total_clearance(linkage, force=100.0) for linkage in loose]
    rise = [pw.statics.deflection(linkage, force=50.0, idle=-10.0) for linkage in loose]
    assert total[0] == pytest.approx(total[1], rel=1e-9)
    assert rise[0] == pytest.approx(rise[1], rel=1e-9)
    assert total[0] > 2e-4
    assert rise[0] > 2e-4


SCENE = pw.scenes.press_blanking(
    conventions="paper", wear_updates=0, cycles=1, clearance="0.5 mm"
)
EQUAL = (
    "Contacts are deep: pins penetrate their bearings at joint C by 500 µm, 1.00 times the "
    "clearance, over 120 degrees. The stiffness is that of small contacts; here bottom dead "
    "centre under load may be wrong, forces less so."
)
ADVICE = (
    "Use stiffness = conforming with contact = foundation, which is for deep contacts, or a "
    "measured contact_stiffness."
)


def deep_stage() -> pw.results.StageResult:
    """A stage with a penetration of 0.5 mm at C."""
    stage = pw.results.StageResult(
        0, "completed", "", None, 1.0, (), 0.0, 0.0, {}, STATISTICS
    )
    arrays = {"cycles": np.zeros((1, 40)), "C_penetration": np.array([-1e-4, 5e-4])}
    return replace(stage, arrays=arrays, joint_names=("A", "C"))


@pytest.mark.parametrize("law", [{"elasticity": "power"}, {"exponent": 1.4}])
def test_a_deep_pin_touches_a_third_of_the_turn(law: dict[str, Any]) -> None:
    """Half the arc is 60 degrees."""
    scene = replace(SCENE, bearings=replace(SCENE.bearings, **law))
    stage = deep_stage()
    assert deep_contacts(scene, [stage]) == [f"{EQUAL} {ADVICE}"]
    assert deep_contacts(scene, [replace(stage, status="failed")]) == []


def test_a_foundation_of_conforming_pins_is_for_deep_contacts() -> None:
    """A given contact stiffness takes the place of that of conforming pins."""
    scene = pw.changed(SCENE, {"contact": "foundation", "stiffness": "conforming"})
    stage = deep_stage()
    assert deep_contacts(scene, [stage]) == []
    given = pw.changed(scene, {"contact_stiffness": 1e10})
    assert len(deep_contacts(given, [stage])) == 1


@pytest.mark.parametrize("used", ["power", "liu", "foundation"])
@pytest.mark.parametrize("part", [1e-4, 0.3, 2.0])
def test_peak_forces_of_the_laws_store_the_same_energy(used: str, part: float) -> None:
    """Forces and energies by quadrature of each law as printed, with K of small contacts."""
    c = 5e-5
    stiffness = 2e11
    settings = {"clearance": c, "contact_stiffness": stiffness, "elasticity": used}
    scene = pw.changed(SCENE, {**settings, "contact": "radial"})

    def foundation(depth: float) -> float:
        half = math.acos(c / (c + depth))
        bed = 0.75 * stiffness * math.sqrt(0.5 * c)
        return bed * ((c + depth) * half - c * math.sin(half))

    laws = {
        "power": lambda depth: stiffness * depth**1.5,
        "liu": lambda depth: stiffness * depth**1.5 / math.sqrt(1.0 + depth / c),
        "foundation": foundation,
    }
    forces = forces_by_law(scene, "C", laws[used](part * c))
    assert forces[used] == pytest.approx(laws[used](part * c), rel=1e-9)
    energy = quad(laws[used], 0.0, part * c)[0]
    for law, force in laws.items():
        excess = partial(lambda x, force: quad(force, 0.0, x)[0] - energy, force=force)
        depth = brentq(excess, 0.1 * part * c, 10.0 * part * c, xtol=1e-16)
        assert forces[law] == pytest.approx(force(depth), rel=1e-6)
    assert max(forces.values()) < (1.0 + part) * min(forces.values())

    # beyond a prescribed force, from its equilibrium on
    given = 0.6 * laws[used](part * c)
    forces = forces_by_law(scene, "C", laws[used](part * c), given)
    assert forces[used] == pytest.approx(laws[used](part * c), rel=1e-9)

    def start_of(law: str) -> float:
        return float(brentq(lambda x: laws[law](x) - given, 0.0, 10.0 * part * c))

    def beyond(depth: float, law: str, energy: float = 0.0) -> float:
        work = quad(lambda x: laws[law](x) - given, start_of(law), depth)[0]
        return float(work) - energy

    energy = beyond(part * c, used)
    for law, force in laws.items():
        ends = start_of(law), 10.0 * part * c
        depth = brentq(beyond, *ends, args=(law, energy), xtol=1e-16)
        assert forces[law] == pytest.approx(force(depth), rel=1e-5)
    all_by_load = forces_by_law(scene, "C", 1e5, 2e5)
    assert [*all_by_load.values()] == pytest.approx([1e5] * 3, rel=1e-9)


def test_the_range_of_the_laws_has_the_stiffness_of_each() -> None:
    """Without a contact stiffness Liu's law has that of the width; others have no range."""
    scene = pw.changed(SCENE, {"conventions": "refined", "width": "0.1 mm"})
    forces = forces_by_law(scene, "C", 1000.0)
    assert forces["foundation"] == pytest.approx(1000.0, rel=1e-12)
    assert forces["liu"] < 0.5 * forces["foundation"] < forces["power"]
    bent = pw.changed(SCENE, {"exponent": 1.4})
    assert forces_by_law(bent, "C", 1000.0) == {}


@pytest.mark.slow
def test_runs_lie_between_the_ranges_of_the_laws() -> None:
    """The load prescribes the peak at C; pins strike at A of a press of 250 kN."""
    file = Path(__file__).parents[2] / "scenarios" / "press-250kN.toml"
    settings = {"wear_updates": 0, "cycles": 6, "replicates": 1}
    scene = pw.changed(pw.scene_from(file), settings)
    peaks = {}
    for law in ("foundation", "liu", "power"):
        radial = {"contact": "radial", "elasticity": law}
        one = scene if law == "foundation" else pw.changed(scene, radial)
        joints = pw.run(one, engine="dae").stages[-1].statistics.joints
        peaks[law] = {name: joints[name].peak_force_per_cycle.mean for name in "AC"}
    ideal = {name: float(abs(ideal_forces(scene)[1][name]).max()) for name in "AC"}
    impact, pressed = (
        {
            name: forces_by_law(
                scene, name, peaks["foundation"][name], part * ideal[name]
            )
            for name in "AC"
        }
        for part in (0.0, 1.0)
    )
    for law in ("liu", "power"):
        assert peaks[law]["C"] == pytest.approx(pressed["C"][law], rel=3e-3)
    assert impact["C"]["power"] > 1.2 * peaks["power"]["C"]
    assert pressed["A"]["power"] < peaks["power"]["A"] < impact["A"]["power"]


def test_a_press_that_gives_way_does_not_break_its_sheet() -> None:
    """A frame of 1 MN/m bends by 1 mm under 1 kN, so that a sheet is touched 1 mm longer.

    It breaks 0.4 mm + 0.1 mm deep: with 1.3 mm the press stops 0.3 mm deep in it, and
    with 1.6 mm it breaks it.
    """
    mechanism = pw.SliderCrank(
        crank_length="50 mm",
        rod_length="300 mm",
        slide_angle="-90 deg",
        gravity=0.0,
        speed="5 spm",
        frame_mass=100.0,
        frame_stiffness=1e6,
        frame_damping=0.5,
    )
    process = pw.Blanking(force="1 kN", height="1.3 mm")
    scene = pw.Scene(
        mechanism, joints="none", process=process, cycles=3, wear_updates=0
    )
    result = pw.run(scene, engine="dae")
    (sentence,) = run_warnings(scene, result.stages)
    assert sentence.startswith(
        "The sheet does not break in 1 of 1 strokes: the slider goes "
    )
    depth = float(sentence.split("goes ")[1].split(" mm")[0])
    assert depth == pytest.approx(0.3, abs=0.005)
    assert "Use process.height = 1.53 mm or more" in sentence
    assert sentence in str(result).splitlines()
    result = pw.run(pw.changed(scene, {"process.height": "1.6 mm"}), engine="dae")
    assert run_warnings(scene, result.stages) == []


STATISTICS: Any = type("Statistics", (), {"joints": {}})


@pytest.mark.parametrize(
    ("force", "joints", "struck"),
    [("500 N", 0, ""), ("50 kN", 2, ""), ("5 kN", 2, "A")],
)
def test_a_result_names_joints_whose_pins_sink_in_deep(
    force: str, joints: int, struck: str
) -> None:
    """Laws differ where pins strike; at 50 kN the load prescribes both peaks, at 5 kN that at C."""
    scene = pw.changed(SCENE, {"process.force": force, "replicates": 2})
    result = pw.run(scene)
    sentences = deep_contacts(scene, result.stages)
    assert sum("an impact of the same" in line for line in sentences) == len(struck)
    assert all(f"energy is, at joint {struck}," in line for line in sentences if struck)
    assert all("; at joint" not in line for line in sentences)
    card = next(one for one in key_numbers(result) if one.name == "Peak joint force")
    assert "by contact law" not in card.interval  # of C
    assert len(sentences) == min(joints, 1)
    assert all(
        "at joint A by " in line and "and joint C by" in line for line in sentences
    )
    assert all(line in str(result).splitlines() for line in sentences)
