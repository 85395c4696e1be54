"""Exudyn with bodies and joints, implicit: any linkage.

Every body is an ``ObjectRigidBody2D``, every ideal joint an Exudyn constraint, and all
clearance joints, springs and loads with a law are one ``ObjectGenericODE2`` over the
nodes of their bodies: its Python user function returns the exact generalized forces on
all of them. (A connector between two markers cannot: it applies equal and opposite
moments, while pin and bearing have different radii.)  Bodies without freedom that have
only clearance joints to other bodies are left out: their motion is prescribed, and the
torques of their drives follow from the contact forces.

Contact state changes only between accepted steps, in ``PostStep``; the user
functions are pure.  The same call chooses the next step and writes it into the
running solver; ``PostNewton`` sends back a step that ran too far past a touchdown.
"""

import time as clock
from array import array
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswear.engines.base import Plan, Start, described
from presswear.engines.driver import Simulation
from presswear.engines.exudyn import Solver, add, settings_of
from presswear.engines.exudyn_joints.body_state import BodyState, Friction, refresh
from presswear.engines.exudyn_joints.interaction_states import STEP_START
from presswear.engines.exudyn_joints.kernels import (
    ACCEPTED,
    FORCES,
    SHORTER,
    START,
    Drives,
    begin_friction,
    run_task,
)
from presswear.engines.exudyn_joints.model import add_bodies, add_joints, left_out
from presswear.engines.settings import ExudynJoints
from presswear.linkage.linkage import Linkage
from presswear.linkage.load_laws import OverPosition
from presswear.linkage.points import GROUND
from presswear.linkage.topology import branches_of
from presswear.physics.constraints import constraints_of
from presswear.physics.contact import CONTACT
from presswear.physics.drive_motion import is_steady
from presswear.physics.equations.function import model_of, written
from presswear.physics.equations.layout import initial_states
from presswear.physics.equations.writer import write_body_forces
from presswear.physics.interactions.kinds import interactions_of
from presswear.physics.interactions.spring import spring_period
from presswear.physics.ledger import Ledger, stored_energy
from presswear.physics.packed import Packed
from presswear.physics.prescribed import begin_motion, pack_prescribed
from presswear.physics.step_length import STEPS
from presswear.recording.observe import step_observer
from presswear.recording.recorder import Recorder
from presswear.recording.recorder_state import RecorderState
from presswear.recording.soundness import Finding
from presswear.tools.arrays import Array
from presswear.tools.compile import specialised
from presswear.tools.exudyn import exudyn_module
from presswear.tools.packing import pack_arguments

exu = exudyn_module()

# Advice that makes a run finer
REMEDY = "more steps_per_contact, or engine = dae, may help"

# With friction in rigid joints
NEWTON_STEPS = 50  # largest number of iterations of a step
LEAST_NEWTON = 1e-10  # smallest tolerance of the iterations
SPRING_STEPS = 100  # fewest steps in the period of a body on its spring

# Names that Exudyn gives to coordinates, rates, accelerations and multipliers
_SOLVED = (
    "ODE2Coordinates",
    "ODE2Coordinates_t",
    "ODE2Coordinates_tt",
    "AECoordinates",
)


def body_state_of(
    linkage: Linkage,
    start: Start,
    omitted: frozenset[str],
    records: RecorderState,
    solved: Sequence[Any],
    friction: Friction,
) -> BodyState:
    """Return the coordinates of all bodies from Exudyn's live coordinates and derivatives."""
    prescribed = pack_prescribed(linkage, omitted)
    begin_motion(prescribed, 0.0, start.position)
    count = 3 * len(linkage.bodies)
    q, v, a = solved
    if omitted:
        q = np.array(start.position)
        v = np.array(start.velocity)
        a = np.zeros(count)
    forces = write_body_forces(linkage, records.packed)
    contacts = np.zeros(len(linkage.clearances), CONTACT)
    model = model_of(linkage, forces, records.packed, records.onset, contacts)
    solved_q, solved_v, solved_a = solved
    states = np.zeros((6, len(forces.states)))
    states[STEP_START] = initial_states(forces.states, start.position)
    return BodyState(
        solved_q=solved_q,
        solved_v=solved_v,
        solved_a=solved_a,
        solved_indices=_solved_indices(linkage, omitted),
        prescribed=prescribed,
        q=q,
        v=v,
        a=a,
        axes=np.zeros(count),
        forces=written(forces, model),
        observer=step_observer(records, q, v, a),
        model=model,
        y=np.zeros(forces.layout.size),
        rates=np.zeros(forces.layout.size),
        layout=forces.layout,
        scales=np.array([state.scale for state in forces.states]),
        state_joints=np.array([state.joint for state in forces.states], np.int64),
        states=states,
        friction=friction,
    )


def _solved_indices(linkage: Linkage, omitted: frozenset[str]) -> NDArray[np.int64]:
    """Return the indices of the solved coordinates among all, if some are omitted."""
    indices: list[int] = []
    for i, body in enumerate(linkage.bodies):
        if omitted and body.name not in omitted:
            indices += range(3 * i, 3 * i + 3)
    return np.array(indices, np.int64)


def _settings(accuracy: ExudynJoints, longest: float, rubs: bool) -> Any:
    """Return Exudyn's settings for a longest step, s, and for friction in rigid joints."""
    settings = settings_of(longest, 0.1 * accuracy.least_step)
    integration = settings.timeIntegration
    # Steps are chosen by accept_joint_step, so that Exudyn must not lengthen them.
    integration.adaptiveStepRecoverySteps = 2**30
    integration.newton.relativeTolerance = accuracy.newton
    integration.newton.absoluteTolerance = accuracy.newton
    integration.newton.modifiedNewtonContractivity = 0.01
    if rubs:
        # No Jacobian knows how friction depends on joint forces: convergence is linear,
        # and ends at the round-off of the joint forces.
        tolerance = max(accuracy.newton, LEAST_NEWTON)
        integration.newton.relativeTolerance = tolerance
        integration.newton.absoluteTolerance = tolerance
        integration.newton.maxIterations = NEWTON_STEPS
        integration.newton.maxModifiedNewtonIterations = NEWTON_STEPS
        integration.newton.maxModifiedNewtonRestartIterations = NEWTON_STEPS
    return settings


def _drives(
    system: Any,
    linkage: Linkage,
    objects: dict[str, int],
    multipliers: Any,
    mass: Array,
) -> Drives:
    """Return the sources of the drive torques, with the projection where it is needed."""
    number = system.systemData.GetObjectLTGAE
    names = [drive.name for drive in linkage.drives]
    rows = [number(objects[name])[0] if name in objects else -1 for name in names]
    modelled = [drive for drive in linkage.drives if drive.name in objects]
    are_steady = all(is_steady(linkage, drive) for drive in modelled)
    # After the short step to a bend in a load, accelerations would oscillate.
    bends = any(isinstance(load.law, OverPosition) for load in linkage.loads_with_law)
    turns = [not linkage.prescribes(drive) for drive in linkage.drives]
    return Drives(
        has_motor=np.array(turns, np.bool_),
        multiplier=np.array(rows, np.int64),
        multipliers=multipliers,
        force=np.zeros(3 * len(linkage.bodies)),
        constraints=constraints_of(linkage).system(mass),
        projects_states=bends or not are_steady,
    )


def prepare(
    linkage: Linkage,
    start: Start,
    settings: ExudynJoints,
    plan: Plan,
    recorder: Recorder,
) -> Simulation:
    """Build the bodies and joints in a start; see ``Simulation``."""
    model = _Joints(linkage, start, settings, plan, recorder)
    return Simulation(
        advance=model.advance,
        state=model.motion,
        ledger=model.ledger,
        update_contacts=model.update_contacts,
        arrays=model.arrays(),
        sums=model.solver.sums,
        diagnostics=model.diagnostics,
        remedy=REMEDY,
        constraints=constraints_of(linkage),
        close=model.container.Reset,
    )


class _Joints:
    """A linkage as bodies and joints of Exudyn, with the functions that Exudyn calls.

    They read its live state instead of the copies that it hands over.
    """

    def __init__(
        self,
        linkage: Linkage,
        start: Start,
        settings: ExudynJoints,
        plan: Plan,
        recorder: Recorder,
    ) -> None:
        # Compiling, or loading what was compiled, is part of building the model.
        began = clock.perf_counter()
        self.linkage = linkage
        self.records = recorder.records
        self.omitted = left_out(linkage)
        self.joined = _joined_bodies(linkage, self.records.packed, self.omitted)
        # Exudyn reads the numbers one by one, which is faster from an array of Python's
        # standard library than from numpy.
        self.force = array("d", bytes(8 * 3 * len(self.joined)))
        self.container = exu.SystemContainer()
        self.system = self.container.AddSystem()
        self.nodes, bodies = add_bodies(self.system, linkage, start, self.omitted)
        self.objects = add_joints(
            self.system, linkage, self.records.motions, self.omitted, self.nodes, bodies
        )
        if self.joined:
            self._add_connector()
        self.system.Assemble()
        data = self.system.systemData
        self.live = {name: getattr(data, f"Get{name}")(copy=False) for name in _SOLVED}
        *solved, multipliers = self.live.values()
        friction = self._friction(multipliers)
        body_state = body_state_of(
            linkage, start, self.omitted, self.records, solved, friction
        )
        self.body_state = body_state
        self.drives = _drives(
            self.system, linkage, self.objects, multipliers, self.records.packed.mass
        )
        self.solver = self._prepare_solver(settings, plan, recorder)
        self.update_contacts()
        if linkage.rubbing_pins:
            begin_friction(body_state, self.records.packed, self.drives, friction)
        self.energies = self.records.memory["energy"]
        # Pins that are closed in the initial state store energy.
        self.energies[:] = self.records.contacts["energy"]
        self.stored_before = self._stored()
        self.built = clock.perf_counter() - began

    def _add_connector(self) -> None:
        """Add the object whose user function returns the forces on its bodies."""
        numbers = [self.nodes[name] for name in self.joined]
        add(
            self.system,
            "Object",
            "GenericODE2",
            nodeNumbers=numbers,
            forceUserFunction=self.connector_forces,
        )

    def _friction(self, multipliers: Any) -> Friction:
        """Return the friction in rigid joints."""
        pins = self.linkage.rubbing_pins
        # places of the bodies of bearing and pin in the forces; -1 for others
        slots = []
        for joint in pins:
            for end in joint.ends:
                is_joined = end.body in self.joined
                slots.append(3 * self.joined.index(end.body) if is_joined else -1)
        number = self.system.systemData.GetObjectLTGAE
        rows = np.array(
            [number(self.objects[joint.name])[0] for joint in pins], np.int64
        )
        places = np.array(slots, np.int64).reshape(-1, 2)
        return Friction(self.records.packed.rubbing, rows, places, multipliers)

    def _prepare_solver(
        self, settings: ExudynJoints, plan: Plan, recorder: Recorder
    ) -> Solver:
        """Return Exudyn's solver, which calls the kernels of trial steps and accepted ones."""
        longest = min(
            settings.longest(plan.cycle), spring_period(self.linkage) / SPRING_STEPS
        )
        accept = self._bind_kernels(settings, longest)
        solver = Solver(
            recorder,
            plan,
            accept,
            exu.DynamicSolverType.TrapezoidalIndex2,
            _settings(settings, longest, rubs=bool(self.linkage.rubbing_pins)),
            longest,
            REMEDY,
            {"newton": "newtonStepsCount", "jacobians": "newtonJacobiCount"},
        )
        solver.install(self.system)
        if self.joined or recorder.has_leader:
            self.system.SetPostNewtonUserFunction(self.send_back)
        return solver

    def _bind_kernels(
        self, settings: ExudynJoints, longest: float
    ) -> Callable[[float], float]:
        """Bind the kernels to this model; return the kernel of accepted steps."""
        steps = np.zeros(1, STEPS)
        steps["free"] = longest
        steps["least"] = settings.least_step
        steps["per_contact"] = settings.steps_per_contact
        steps["sustained"] = settings.steps_sustained
        rows: list[int] = []  # coordinates of the bodies of the connector
        for name in self.joined:
            first = 3 * self.linkage.index(name)
            rows += range(first, first + 3)
        out = np.frombuffer(self.force) if self.joined else np.zeros(0)
        packed = pack_arguments(
            self.body_state,
            self.drives,
            self.records,
            steps,
            np.array(rows, np.int64),
            out,
        )
        run = specialised(run_task, packed, START, 0.0)
        self._fill = partial(run, packed, FORCES)
        self._place = partial(run, packed, START)
        self._shorter = partial(run, packed, SHORTER)
        return partial(run, packed, ACCEPTED)

    def connector_forces(self, system: Any, t: float, item: int, q: Any, v: Any) -> Any:
        """Return the forces on the bodies of the connector."""
        try:
            self._fill(t)
        except BaseException as error:
            self.solver.error = error
            raise
        return self.force

    def send_back(self, system: Any, t: float) -> list[float]:
        """Return whether a trial step is to be repeated, and with which step, s."""
        try:
            shorter_step = self._shorter(t)
        except BaseException as error:
            self.solver.error = error
            raise
        if shorter_step < 0.0:
            return [0.0, -1.0]
        self.solver.sums["sent_back"] += 1.0
        return [2.0, shorter_step]

    def advance(self, end: float) -> Finding | None:
        """Integrate up to a time, s."""
        # The initial accelerations of Exudyn are right for steady drives. Later cycles
        # continue with the accelerations at the end of the last cycle.
        compute = not self.drives.projects_states or self.solver.time == 0.0
        integration = self.solver.settings.timeIntegration
        integration.generalizedAlpha.computeInitialAccelerations = compute
        return self.solver.run(self.system, self.live, end)

    def motion(self) -> tuple[float, Array, Array]:
        """Return time, s, coordinates and rates of all bodies.

        After a failure they are those before the failed step.
        """
        body_state = self.body_state
        if not (np.isfinite(body_state.q).all() and np.isfinite(body_state.v).all()):
            for name in _SOLVED[:3]:
                get = getattr(self.system.systemData, f"Get{name}")
                self.live[name][:] = get(exu.ConfigurationType.StartOfStep)
            refresh(body_state, self.solver.time)
        return self.solver.time, np.array(body_state.q), np.array(body_state.v)

    def update_contacts(self) -> None:
        """Fill the contacts in the present state."""
        self._place(self.solver.time)

    def ledger(self) -> Ledger:
        """Return the energies since the run began."""
        return Ledger.of(self.records.energies, self._stored() - self.stored_before)

    def _stored(self) -> float:
        """Return the stored energy, J."""
        _, q, v = self.motion()
        return stored_energy(self.linkage, self.records.packed, self.energies, q, v)

    def arrays(self) -> dict[str, Array]:
        """Return the live arrays that hold the state between two cycles."""
        body_state = self.body_state
        arrays = dict(
            zip(("q", "v", "a", "multipliers"), self.live.values(), strict=True)
        )
        arrays |= {"force": self.drives.force, "states": body_state.states}
        if self.omitted:
            arrays |= {
                "all_q": body_state.q,
                "all_v": body_state.v,
                "all_a": body_state.a,
                "axes": body_state.axes,
            }
            arrays["prescribed"] = body_state.prescribed.work
        return {name: np.asarray(array) for name, array in arrays.items()}

    def diagnostics(self) -> dict[str, float | int | str]:
        """Return texts on the model and on its solver, counts and times."""
        sums = self.solver.sums
        model = f"{len(self.nodes)} bodies, {len(self.objects)} joints and drives"
        solver = "Exudyn trapezoidal index 2, step chosen by contact state"
        reason = branches_of(self.linkage)
        if isinstance(reason, str):
            solver = f"{solver}; no open tree, because {reason}"
        return {
            "model": described(self.linkage, model, self.omitted),
            "solver": solver,
            "steps": int(sums["steps"]),
            "steps_sent_back": int(sums["sent_back"]),
            "newton_iterations": int(sums["newton"]),
            "jacobians": int(sums["jacobians"]),
            "wall_build_s": self.built,
            "wall_solve_s": sums["wall"],
        }


def _joined_bodies(
    linkage: Linkage, packed: Packed, omitted: frozenset[str]
) -> list[str]:
    """Return the bodies of the connector: those on which interactions or rubbing pins act."""
    names: list[str] = []
    for interaction in interactions_of(linkage, packed):
        names += interaction.bodies
    for pin in linkage.rubbing_pins:
        names += [end.body for end in pin.ends]
    return [name for name in dict.fromkeys(names) if name not in {GROUND, *omitted}]
