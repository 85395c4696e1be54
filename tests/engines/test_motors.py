"""Motors in all engines: closed forms of a crank alone, and a press with a flywheel.

The press is an upright slider-crank that blanks with 100 kN at 60 strokes a minute. Its
reference values are those of an independent simulator with located events.
"""

import math

import numpy as np
import pytest
from marks import slow
from runs import energy_residual
from upright_press import SHEET, blanked, from_the_top, upright_press

import presswear as pw
from presswear.campaign.replicates import start_of
from presswear.engines.base import Plan, Run, Start
from presswear.engines.settings import Engine, ExudynJoints, ExudynTree, InHouse
from presswear.linkage.linkage import Linkage
from presswear.linkage.load_laws import OverPosition
from presswear.tools.arrays import Array
from presswear.validation.cases import finished

TURN = 2.0 * math.pi
ENGINES: list[Engine] = [
    InHouse(integration_tolerance=1e-11),
    InHouse(integration_tolerance=1e-11, coordinates="all"),
    ExudynTree(tree_tolerance=1e-10),
    ExudynJoints(),
]
NAMES = ("fewest", "all", "exudyn-tree", "exudyn-joints")
in_every_engine = pytest.mark.parametrize("engine", ENGINES, ids=NAMES)
# 480 N m at a slip of 0.08 on a shaft of 144 kg m^2
LINE = pw.Motor(20.0, slip=0.08, breakdown=None, ratio=24, inertia=0.25)
INERTIA = 0.5 + 24.0**2 * 0.25


HALF_A_SECOND = 0.5043521534677609  # turns of the press


def cranks(*motors: pw.Motor, limit: float | None = None) -> Linkage:
    """Balanced cranks on the frame, each with a motor and a nominal turn a second."""
    bodies = [
        pw.Body(f"crank {k}", 10.0, 0.5, points={"O": (0.0, 0.0)})
        for k in range(len(motors))
    ]
    joints = [
        pw.Pin(f"O{k}", (float(k), 0.0), f"crank {k}.O") for k in range(len(motors))
    ]
    drives = [
        pw.Drive(f"crank {k}", TURN, motor=motor, torque_limit=limit)
        for k, motor in enumerate(motors)
    ]
    return pw.assemble(bodies, joints, drives, gravity=0.0)


def turned(
    engine: Engine, linkage: Linkage, turns: float, *speeds: float
) -> tuple[Array, Array, Run]:
    """Run cranks from initial speeds until the leader has turned; return angles and speeds.

    Without a leader a turn is a second.
    """
    position, velocity = np.zeros((2, len(speeds), 3))
    position[:, 0] = range(len(speeds))
    velocity[:, 2] = speeds
    start = Start(position.ravel(), velocity.ravel())
    run = finished(engine.for_cycle(turns).simulate(linkage, start, Plan(turns, 1)))
    return run.end.position[2::3], run.end.velocity[2::3], run


def within(engine: Engine) -> float:
    """Allowed error, part of the greatest angle or speed."""
    return {"dae": 1e-9, "exudyn-tree": 1e-7}.get(engine.word, 1e-5)


def impulse_response(omega: float, ratio: float, time: float) -> float:
    """Return the place of a damped oscillator of 1 kg behind a blow of 1 N s, m."""
    damped = omega * math.sqrt(1.0 - ratio**2)
    return math.exp(-ratio * omega * time) * math.sin(damped * time) / damped


@in_every_engine
def test_a_line_motor_runs_up_exponentially(engine: Engine):
    decay = INERTIA * TURN * 0.08 / 480.0
    left = math.exp(-0.2 / decay)
    turns = 0.2 - decay * (1.0 - left)
    _, (speed,), run = turned(engine, cranks(LINE), turns, 0.0)
    assert run.time == pytest.approx(0.2, rel=within(engine))
    assert speed == pytest.approx(TURN * (1.0 - left), rel=within(engine))
    # All work is in the flywheel.
    work = float(run.diagnostics["drive_work_J"])
    assert work == pytest.approx(0.5 * INERTIA * speed**2, rel=within(engine))


@in_every_engine
def test_an_induction_motor_runs_up_over_its_breakdown_torque(engine: Engine):
    """From rest to the slip s.

    t = J w_0 / (2 k M s_k) [(1 - s^2) / 2 + s_k^2 ln(1 / s)], and the turns are
    shorter by the integral of s over t.
    """
    motor = pw.Motor(20.0, slip=0.08, breakdown=2.75, ratio=24, inertia=0.25)
    slip = 0.1
    peak = motor.breakdown_slip or 0.0
    scale = INERTIA * TURN / (2.0 * 2.75 * 480.0 * peak)
    time = scale * (0.5 * (1.0 - slip**2) + peak**2 * math.log(1.0 / slip))
    turns = time - scale * ((1.0 - slip**3) / 3.0 + peak**2 * (1.0 - slip))
    _, (speed,), run = turned(engine, cranks(motor), turns, 0.0)
    assert speed == pytest.approx(0.9 * TURN, rel=within(engine))
    assert run.time == pytest.approx(time, rel=within(engine))


@in_every_engine
def test_a_servo_swings_about_the_motion_of_its_drive(engine: Engine):
    stiffness = 200.0
    ratio = 0.1
    duration = 0.15
    omega = math.sqrt(stiffness / 0.5)
    servo = pw.Motor(stiffness=stiffness, damping=2.0 * ratio * omega * 0.5)
    (angle,), _, _ = turned(engine, cranks(servo), duration, 0.0)
    lag = TURN * impulse_response(omega, ratio, duration)
    error = 1e-4 if isinstance(engine, ExudynJoints) else within(engine)
    assert angle == pytest.approx(TURN * duration - lag, abs=error * TURN)


def test_steps_of_bodies_and_joints_resolve_a_stiff_servo():
    """The longest step is a tenth of the period; a hundredth has a phase error of 4e-3."""
    omega, ratio, duration = 628.0, 0.1, 0.02
    servo = pw.Motor(stiffness=0.5 * omega**2, damping=2.0 * ratio * omega * 0.5)
    engine = ExudynJoints(free_step=1e-3)
    (angle,), _, _ = turned(engine, cranks(servo), duration, 0.0)
    lag = TURN * impulse_response(omega, ratio, duration)
    assert angle == pytest.approx(TURN * duration - lag, abs=1e-2 * TURN / omega)


@in_every_engine
def test_a_servo_saturates_at_the_torque_limit(engine: Engine):
    servo = pw.Motor(stiffness=1e3, damping=1e3)
    duration = 0.05
    (angle,), (speed,), _ = turned(engine, cranks(servo, limit=3.0), duration, 0.0)
    assert speed == pytest.approx(3.0 / 0.5 * duration, rel=within(engine))
    assert angle == pytest.approx(3.0 * duration**2, rel=within(engine))


@in_every_engine
def test_a_servo_follows_the_leader_not_the_time(engine: Engine):
    """A free crank at 1.5 times its nominal speed, and a servo that starts at 1.5 times, too."""
    linkage = cranks(pw.Motor(0), pw.Motor(stiffness=1e3, damping=1.0))
    speed = 1.5 * TURN
    angles, speeds, run = turned(engine, linkage, 0.3, speed, speed)
    assert run.time == pytest.approx(0.2, rel=within(engine))
    assert angles == pytest.approx([0.3 * TURN] * 2, rel=within(engine))
    assert speeds == pytest.approx([speed] * 2, rel=within(engine))


def brake(time: float, speed: float) -> float:
    return -2.0 * speed


@in_every_engine
def test_a_user_law_of_a_torque(engine: Engine):
    """A brake J w' = -2 w takes the speed away in proportion to the angle."""
    _, (speed,), run = turned(engine, cranks(pw.Motor(law=brake)), 0.1, TURN)
    exact = TURN * (1.0 - 0.1 * 2.0 / 0.5)
    assert speed == pytest.approx(exact, rel=within(engine))
    assert energy_residual(run) < 1e-3


def pressed(engine: Engine, turns: float, motor: pw.Motor | None = LINE) -> Run:
    """Run the press from the top, until its crank has turned."""
    return blanked(engine, upright_press(motor), turns)


PRESS_ENGINES = pytest.mark.parametrize(
    "engine",
    [
        InHouse(integration_tolerance=1e-10),
        slow(ExudynJoints()),
    ],
    ids=("dae", "exudyn-joints"),
)


@PRESS_ENGINES
def test_a_press_with_a_flywheel(engine: Engine):
    """M2: speed after half a second, time of the first turn, account of a stroke."""
    half = pressed(engine, HALF_A_SECOND)
    assert half.time == pytest.approx(0.5, rel=within(engine))
    assert half.end.velocity[2] == pytest.approx(6.27656366811, rel=within(engine))
    turn = pressed(engine, 1.0)
    assert turn.time == pytest.approx(1.0020207682972, rel=within(engine))
    assert float(turn.diagnostics["load_work_J"]) == pytest.approx(-137.5, rel=1e-8)
    assert energy_residual(turn) < 10.0 * within(engine)


def test_a_press_starts_at_its_settled_speed():
    """Mean torque 137.5 J / 2 pi; the turns behind the first last equally long."""
    scene = pw.Scene(upright_press(LINE), process=SHEET, cycles=3)
    start = start_of(scene)
    settled = 1.0 - 0.08 * 137.5 / TURN / 480.0
    assert start.velocity[2] / TURN == pytest.approx(settled, abs=1e-8)
    engine = InHouse(integration_tolerance=1e-10).for_cycle(1.0)
    run = engine.simulate(scene.linkage(), start, Plan(1.0, 3))
    first, second, third = run.recorder.each_cycle("duration")
    assert first == pytest.approx(1.0 / settled, rel=3e-3)
    assert third == pytest.approx(second, rel=1e-5)


STALLED_AT, STALLED_IN = 243.2832512595, 0.4600432550  # degrees and mm in the work


@PRESS_ENGINES
def test_a_motor_without_a_flywheel_stalls_in_the_work(engine: Engine):
    """Its slip grows beyond breakdown; angle and depth are those of the second simulator."""
    motor = pw.Motor(20.0, slip=0.08, breakdown=2.75, ratio=24)
    scene = pw.Scene(upright_press(motor), process=SHEET, cycles=1)
    run = from_the_top(engine, scene, 1.0)
    assert run.status == "failed"
    words = run.message.partition("the motor stalls at an angle of ")[2].split()
    assert float(words[0]) == pytest.approx(STALLED_AT, abs=0.1)
    depth = float(run.message.partition(" mm in the work")[0].split()[-1])
    assert depth == pytest.approx(STALLED_IN, abs=2e-3)


def work_of(joules: float) -> pw.Moment:
    """A moment against a crank, between 90 and 270 degrees."""
    half = 0.5 * math.pi
    mean = 2.0 * joules / math.pi
    table = [(half, 0.0), (2.0 * half, -mean), (3.0 * half, 0.0)]
    return pw.Moment("crank 0", OverPosition(table))


@in_every_engine
@pytest.mark.parametrize(
    ("inertia", "joules", "rates"),
    [
        # Schuler 1000 kN: 5,600 J at 55 a minute need 15,556 J for a drop of 20 %.
        (2.0 * 15_555.56 / (55.0 * TURN / 60.0) ** 2, 5600.0, (55.0, 44.0)),
        # A text-book flywheel of 6.5 t, radius of gyration 1.8 m: 120 +- 1 a minute.
        (6500.0 * 1.8**2, 56e3, (121.010328, 118.989672)),
    ],
    ids=("Schuler", "text-book"),
)
def test_flywheels_give_the_work(engine: Engine, inertia, joules, rates):
    before, after = (rate * TURN / 60.0 for rate in rates)
    motor = pw.Motor(0, inertia=inertia - 0.5)
    linkage = cranks(motor).changed(loads=[work_of(joules)])
    _, (speed,), run = turned(engine, linkage, 0.9, before)
    assert speed == pytest.approx(after, rel=1e-6)
    assert float(run.diagnostics["load_work_J"]) == pytest.approx(-joules, rel=1e-6)


def test_a_large_flywheel_approaches_the_prescribed_speed():
    engine = InHouse(integration_tolerance=1e-10)
    late = []
    for inertia in (25.0, 250.0):
        motor = pw.Motor(20.0, breakdown=None, ratio=24, inertia=inertia)
        late.append(pressed(engine, 0.6, motor).time - 0.6)
    assert late[0] / late[1] == pytest.approx(10.0, rel=0.05)
    assert abs(late[1]) < 1e-4
