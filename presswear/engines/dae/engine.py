"""The in-house solver as an engine."""

import math
import time as clock

import numpy as np

from presswear.engines.base import Plan, Start, described, listed
from presswear.engines.dae.dynamics import load_work_place, state_size, system_of
from presswear.engines.dae.march import (
    BROKEN,
    RUNNING,
    STUCK,
    march_controlled,
    march_fixed,
    place_state,
)
from presswear.engines.dae.runge_kutta import CONTROL, Integration, Motion
from presswear.engines.dormand_prince import DOP853, DOPRI5
from presswear.engines.driver import Simulation
from presswear.engines.settings import InHouse
from presswear.linkage.linkage import Linkage, prescribed_of
from presswear.physics.constraints import Constraints, constraints_of
from presswear.physics.contact import CONTACT
from presswear.physics.equations.function import model_of
from presswear.physics.equations.integrals import DRIVE_INTEGRALS
from presswear.physics.equations.writer import Equations, write_body_forces, write_equations
from presswear.physics.forces import (
    CONTACT_LOSS,
    FRICTION_LOSS,
    JOINT_RATES,
    MADE,
    Ledger,
    made_energy,
    made_remedy,
    stored_energy,
)
from presswear.physics.prescribed import begin_motion
from presswear.recording.recorder import Recorder
from presswear.recording.soundness import Finding, Progress
from presswear.tools.arrays import Array
from presswear.tools.compile import bind
from presswear.tools.errors import InputError

# Advice that makes a run finer.
REMEDY = "a smaller integration_tolerance or equal_step, or integrator=dop853, may help"

RESOLVED_DIGITS = 8.0  # units in the last place of a coordinate that round-off may reach

_CHUNK = 2000  # steps between two looks at the clock and the keyboard


def check_start(constraints: Constraints, start: Start) -> None:
    """Refuse a start that violates or repeats a constraint, by the name of its joint.

    Positions must agree to 1e-6 m or rad and velocities to 1e-4 m/s or rad/s.
    """
    phi, phi_t, _, jacobian = constraints.evaluate(0.0, start.position, start.velocity)
    for kind, values, allowed in (("position", phi, 1e-6), ("velocity", phi_t, 1e-4)):
        worst = int(np.argmax(np.abs(values))) if values.size else 0
        if values.size and not abs(values[worst]) <= allowed:
            raise InputError(
                f"the start violates joint {constraints.names[worst]}: its {kind} is off by "
                f"{abs(values[worst]):.3g}, allowed is {allowed:g}"
            )
    if repeated := dependent_joint(jacobian, constraints.names, 1e-9):
        raise InputError(
            f"joint {repeated} repeats what the other joints already hold, or the position is "
            "singular: its constraint adds nothing"
        )


def dependent_joint(jacobian: Array, names: tuple[str, ...], least: float) -> str | None:
    """Return the first joint whose constraint adds less than ``least`` to those before it."""
    rows = jacobian / np.linalg.norm(jacobian, axis=1, keepdims=True)
    added = np.abs(np.diag(np.linalg.qr(rows.T).R))
    # Constraints beyond the number of coordinates add nothing.
    pairs = zip(names, [*added, 0.0], strict=False)
    return next((name for name, size in pairs if size < least), None)


def _problem(
    state: int, constraints: Constraints, rubs: bool, time: float, q: Array, v: Array
) -> Finding:
    """Return the finding on a march that ended in a status, with the joint near which it did.

    ``rubs``: a rigid joint has friction.
    """
    if state != STUCK:
        what = "the state is no longer finite"
        if rubs:
            what += (
                "; friction in rigid joints blocks motion where mu r exceeds the levers of forces"
            )
        return Finding("state", what, time, "", REMEDY)
    singular = dependent_joint(constraints.evaluate(time, q, v)[3], constraints.names, 1e-2)
    if singular:
        what, remedy = "the step vanished near a singular position", "other lengths of the links"
        return Finding("state", what, time, singular, remedy)
    remedy = "a larger integration_tolerance may help"
    return Finding("state", "the step vanished", time, "", remedy)


def resolution_of(linkage: Linkage, start: Start) -> float:
    """Return the distance, m, below which differences of coordinates are round-off.

    It grows with the distance of the linkage from the origin.
    """
    ends = [end for joint in linkage.revolutes for end in (joint.first, joint.second)]
    ends += [end for joint in linkage.clearances for end in (joint.bearing, joint.pin)]
    arm = max((math.hypot(end.x, end.y) for end in ends), default=0.0)
    farthest = float(np.abs(start.position.reshape(-1, 3)[:, :2]).max())
    return RESOLVED_DIGITS * float(np.finfo(float).eps) * (farthest + arm)


def prepare(
    linkage: Linkage, start: Start, settings: InHouse, plan: Plan, recorder: Recorder
) -> Simulation:
    """Pack a linkage in a start; see ``Simulation``."""
    began = clock.perf_counter()
    constraints = constraints_of(linkage)
    check_start(constraints, start)
    records = recorder.records
    packed, onset = records.packed, records.onset
    tree = None if settings.takes_all_coordinates else write_equations(linkage, packed)
    equations = tree if isinstance(tree, Equations) else write_body_forces(linkage, packed)
    contacts = np.zeros(len(packed.joints), CONTACT)
    model = model_of(linkage, equations, packed, onset, contacts)
    if isinstance(tree, Equations):
        begin_motion(model.prescribed, 0.0, start.position)
        system = system_of(packed, tree, model)
    else:
        baumgarte = settings.alpha, settings.beta
        system = system_of(packed, equations, model, constraints, *baumgarte)
    coordinates = equations.chain.coordinates(start.position, start.velocity)
    n, size = system.size, state_size(system)
    y = np.zeros(size)
    y[: 2 * n] = np.concatenate(coordinates)
    drives = y[2 * n : 2 * n + DRIVE_INTEGRALS]
    joints = y[2 * n + DRIVE_INTEGRALS : system.first_torque].reshape(-1, JOINT_RATES)
    motion = Motion(y, np.zeros(size), np.zeros((DOP853.b.size + 2, size)))
    control = np.zeros(1, CONTROL)
    is_fixed, tolerance = settings.has_equal_steps, settings.tolerance
    control["step"] = settings.step if is_fixed else 1e-6
    control["longest"] = settings.longest(plan.cycle)
    control["shortest"] = 1e-14
    control["resolution"] = resolution_of(linkage, start)
    control["parts"] = settings.impact_steps
    control["tolerance"] = tolerance
    control["projected"] = settings.projection == "on"
    tableau = DOPRI5 if settings.integrator == "dopri5" else DOP853
    if is_fixed:
        run = Integration(system, None, 4, records, control, motion, last=3)
        kernel = bind(march_fixed, run)
    else:
        run = Integration(system, tableau, None, records, control, motion, tableau.b.size)
        kernel = bind(march_controlled, run)

    def march(end: float, most: int) -> int:
        control["most"] = most
        return kernel(end)

    place = bind(place_state, run)
    march(0.0, 1)  # accounts for the start
    ready = clock.perf_counter()

    def state() -> tuple[float, Array, Array]:
        time = float(control["time"][0])
        place(time)
        return time, system.state[0].copy(), system.state[1].copy()

    def stored() -> float:
        return stored_energy(records.packed, records.memory["energy"], *state()[1:])

    energy_before = stored()
    sums = {"solve": 0.0}
    progress = Progress(plan.cycle)

    def look(status: int, wall: float) -> Finding | None:
        time = float(control["time"][0])
        sums["solve"] += wall
        plan.advanced(time, recorder)
        lost, exchange = float(joints[:, CONTACT_LOSS].sum()), float(drives[1])
        made = made_energy(records.packed, lost, exchange) if time > plan.settled else ""
        if made:
            return Finding("energy", made, time, "", made_remedy(records.packed, REMEDY))
        if status in (BROKEN, STUCK):
            return _problem(status, constraints, bool(linkage.rubbing_pins), *state())
        return progress.judge(int(control["steps"][0]), time)

    def advance(end: float) -> Finding | None:
        control["tolerance"] = tolerance
        status, finding = RUNNING, None
        while status == RUNNING and finding is None:
            began = clock.perf_counter()
            status = march(end, _CHUNK)
            finding = look(status, clock.perf_counter() - began)
        return finding

    def ledger() -> Ledger:
        contact, friction, made = joints.sum(axis=0)[[CONTACT_LOSS, FRICTION_LOSS, MADE]].tolist()
        load_work = float(y[load_work_place(system)]) if system.has_work else 0.0
        if records.packed.rubbing is not None:
            friction += float(y[-1])
        stored_change = stored() - energy_before
        work, exchange = drives.tolist()
        return Ledger(work, exchange, stored_change, contact, friction, made, load_work)

    def diagnostics() -> dict[str, float | int | str]:
        names = ("steps", "events", "evaluations")
        return {
            **_words(linkage, tree, constraints, settings),
            **{name: int(control[name][0]) for name in names},
            "steps_sent_back": int(control["rejected"][0]),
            "constraint_error_m": float(control["position_error"][0]),
            "constraint_velocity_error_m_s": float(control["velocity_error"][0]),
            "wall_compile_s": ready - began,
            "wall_solve_s": sums["solve"],
        }

    arrays = {"y": y, "slope": motion.slopes[0], "control": control}
    # Without closed loops nothing follows from the last motion.
    if isinstance(tree, Equations) and tree.chain.has_loops:
        arrays["prescribed"] = model.prescribed.work
    held = None if isinstance(tree, Equations) else constraints

    def worn() -> None:
        control["has_slope"] = False
        place(float(control["time"][0]))

    return Simulation(
        advance,
        state,
        ledger,
        worn,
        arrays,
        sums,
        diagnostics,
        REMEDY,
        constraints=held,
    )


def _words(
    linkage: Linkage, tree: Equations | str | None, constraints: Constraints, settings: InHouse
) -> dict[str, str]:
    """Return sentences on the model that was built and on its solver."""
    steps = f"RK4 at equal steps of {settings.step:g} s"
    if not settings.has_equal_steps:
        method = settings.integrator.upper()
        steps = f"{method} at tolerance {settings.tolerance:g}, touches located"
    if isinstance(tree, Equations):
        names = listed([link.body.name for link in tree.chain.free])
        words = f"open tree of {tree.chain.size} coordinates ({names})"
        model = described(linkage, words, prescribed_of(linkage))
        return {"model": model, "solver": f"in-house, {steps}"}
    words = f"{len(linkage.bodies)} bodies, {constraints.rows} constraints"
    solver = f"in-house, Lagrange multipliers, {steps}, Baumgarte {settings.alpha:g}"
    solver += f"/{settings.beta:g}{', projected' if settings.projection == 'on' else ''}"
    return {"model": described(linkage, words), "solver": solver}
