"""Tonnage and strokes against closed forms, virtual work and planted forces."""
# mypy: disable-error-code="union-attr,operator,index,arg-type"

import math
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from closed_form import needed_by_virtual_work, press_motion
from numpy.testing import assert_allclose, assert_array_equal
from refusals import refused
from scipy.integrate import simpson
from scipy.optimize import brentq
from scipy.stats import t as student

import presswear as pw
from presswear.physics.touchdown import CONTACT_COLUMNS
from presswear.recording.soundness import ENERGY_BOUND
from presswear.results.export import table_of
from presswear.results.rigid_joints import ideal_drives, ideal_forces
from presswear.results.strokes import (
    PHASES,
    SNAP_THROUGH_S,
    SampledStroke,
    height_of,
    process_force,
    sampled_strokes,
)
from presswear.results.tonnage import joint_tonnage
from presswear.tools.arrays import Array

PRESS = pw.Press()
PERIOD = PRESS.period
SHEET = pw.Blanking(cushion=30.0)
IDEAL = replace(pw.scenes.ideal(), process=SHEET, engine="dae", cycles=4)


@pytest.fixture(scope="module")
def ideal():
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


def test_the_ideal_press_gives_a_part_its_force_and_work(ideal):
    stage = ideal.stages[0]
    height = ideal.height(0)
    force = np.asarray(ideal.process_force(0))
    assert_allclose(height, slider(stage.time)[:, 0] - BOTTOM, atol=1e-8)
    expected = force_at(SHEET.height - height, stage.velocity)
    assert_allclose(force, expected, atol=1e-6 * SHEET.force)
    table = table_of(ideal, 0)
    assert_array_equal([table["process_force"], table["height"]], [force, height])
    tonnage = ideal.tonnage(0)
    # Of two sampled strokes and cycles.
    for work in (tonnage.work, stage.statistics.drive_work_per_cycle):
        assert work.samples == 2
        assert work.mean == pytest.approx(SHEET.work, abs=1e-6 * SHEET.work)
    assert stage.statistics.energy_residual_fraction < ENERGY_BOUND
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


def test_ideal_drives_are_those_of_virtual_work(ideal):
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


def test_ideal_peaks_include_work_that_is_shorter_than_a_piece():
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
    with refused("the ideal motion needs"):
        pw.changed(scene, {"torque_limit": 0.999 * greatest}).check()


def test_strokes_of_the_ideal_press_are_those_of_its_dead_centres(ideal):
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


@pytest.mark.parametrize(
    "engine", ["dae", pytest.param("exudyn-tree", marks=pytest.mark.slow)]
)
def test_work_and_energies_of_a_loose_press_are_those_of_its_engine(engine):
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
    assert stage.statistics.energy_residual_fraction < ENERGY_BOUND
    told = result.tonnage(0)
    assert told.strokes == 1
    for own in told.joints.values():
        assert set(own.peak_by_phase) == set(PHASES)
        assert 0.0 < own.working_force.mean <= own.peak_by_phase["work"].mean
        # A cushion may hold the load on its side.
        assert 0.0 <= own.reversed_force.mean <= own.peak_by_phase["snap-through"].mean
        assert (own.reversal_time is None) == (own.reversed_force.mean == 0.0)


def test_without_work_there_are_approach_and_return_alone():
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
        (4.0, 250.0, 0.011),
        (6.0, 0.1, 0.0175),
        (1.0, 90.0, 0.03),
    ],
)
def test_a_reversal_is_along_the_force_that_worked(angle, back, delay):
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


def test_a_reversed_force_counts_the_friction_on_the_bearing():
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


def test_peaks_between_rows_are_those_of_contacts_in_the_phase():
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


def test_peaks_are_told_by_phase_with_their_scatter():
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
