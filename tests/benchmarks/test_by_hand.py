"""The accounts of the hand-written loop are those of ``dae``, up to the integration tolerance."""

import numpy as np
import pytest
from by_hand.accounts import (
    CONTACTS,
    DISTANCE,
    DRIVES,
    EXCHANGE,
    FRICTION_LOSS,
    HIGHEST,
    JOINTS,
    PEAK,
    WORK,
)
from by_hand.equations import parameters, state_of
from by_hand.loop import Outcome, run
from numpy.testing import assert_allclose

import presswear as pw
from presswear.campaign.replicates import start_of
from presswear.engines.base import Plan, Run
from presswear.engines.settings import LEAST_STEPS, InHouse
from presswear.recording.columns import (
    DRIVE_CYCLE_COUNT,
    POWER_SQUARE,
    TORQUE,
    TORQUE_SQUARE,
)

END = 0.05  # s, with ten touchdowns
TOLERANCE = 1e-12
# relative, of both: a change of 1e-9 m grows to some 1e-7 of the last peak
ERROR = 2e-6
SCENE = pw.scenes.wear_times(conventions="paper")


@pytest.fixture(scope="module")
def loop() -> Outcome:
    longest = SCENE.mechanism.period / LEAST_STEPS
    start = state_of(SCENE.linkage(), start_of(SCENE))
    return run(parameters(SCENE), start, [END], TOLERANCE, longest)


@pytest.fixture(scope="module")
def engine() -> Run:
    dae = InHouse("dopri5", TOLERANCE).for_cycle(SCENE.mechanism.period)
    return dae.simulate(
        SCENE.linkage(), start_of(SCENE), Plan(END, 1, 1, torques=False)
    )


def test_the_accounts_of_joints_are_equal(loop: Outcome, engine: Run):
    for k in range(2):
        columns = {"force_max": PEAK, "load_distance": DISTANCE, "contacts": CONTACTS}
        for name, column in columns.items():
            (expected,) = engine.recorder.each_cycle(name, k)
            assert loop.cycles[0, JOINTS + 3 * k + column] == pytest.approx(
                expected, rel=ERROR
            )


def test_the_wear_maps_are_equal(loop: Outcome, engine: Run):
    (maps,) = engine.recorder.maps.sampled.reshape(-1, *loop.maps.shape)
    assert_allclose(loop.maps.sum(axis=2), maps.sum(axis=2), rtol=ERROR)
    # Steps of another length divide the wear between two bins at other places.
    assert_allclose(loop.maps, maps, rtol=0.0, atol=3e-4 * maps.max())


def test_the_balance_of_energy_closes(loop: Outcome, engine: Run):
    exchanged = loop.states[0, EXCHANGE]
    numbers = engine.diagnostics
    assert abs(loop.residual) < 1e-9 * exchanged
    # A step in which the power changes its sign makes an error in the integral of its
    # magnitude.
    assert exchanged == pytest.approx(numbers["drive_exchange_J"], rel=1e-3)
    assert loop.states[0, WORK] == pytest.approx(numbers["drive_work_J"], rel=ERROR)
    assert loop.states[0, FRICTION_LOSS] == pytest.approx(
        numbers["friction_loss_J"], rel=ERROR
    )


def test_the_drives_are_equal(loop: Outcome, engine: Run):
    drives = engine.recorder.cycles[0, -2 * DRIVE_CYCLE_COUNT :].reshape(2, -1)
    for k, row in enumerate(drives):
        ours = loop.states[0, DRIVES + 4 * k : DRIVES + 4 * k + 4]
        expected = row[[TORQUE, TORQUE_SQUARE, POWER_SQUARE]]
        assert_allclose(ours[[0, 1, 3]], expected, rtol=ERROR)


def test_film_and_series_hold_the_motion(loop: Outcome, engine: Run):
    frames, rows = (int(count) for count in loop.accounts.counts[:2])
    film = loop.accounts.film[:frames]
    recorder = engine.recorder
    ours = film[:, 0]
    theirs = recorder.film.time
    between = (ours > theirs[0]) & (ours < theirs[-1])
    for body in range(18):
        # Between frames of the engine, whose cubic is not drawn: 1.2e-3 s apart at
        # most.
        position = np.interp(ours[between], theirs, recorder.film.position[:, body])
        assert_allclose(film[between, 1 + body], position, atol=3e-5)
    series = loop.accounts.series[:rows]
    force = recorder.series("normal", 0)
    assert series[:, 3 + 4].max() == pytest.approx(force.max(), rel=5e-3)
    assert loop.cycles[0, HIGHEST] <= recorder.each_cycle("displacement_max")[0]
