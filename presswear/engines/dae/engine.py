"""The in-house solver as an engine."""

import math
import time as clock

import numpy as np

from presswear.engines.base import Plan, Start, described, listed
from presswear.engines.dae.accepted_step import place_state
from presswear.engines.dae.dynamics import system_of
from presswear.engines.dae.march import (
    BROKEN,
    RUNNING,
    STUCK,
    march_controlled,
    march_fixed,
)
from presswear.engines.dae.runge_kutta import CONTROL, Integration, Motion
from presswear.engines.driver import Simulation
from presswear.engines.settings import InHouse
from presswear.linkage.linkage import Linkage
from presswear.linkage.topology import prescribed_of
from presswear.physics.constraints import Constraints, constraints_of
from presswear.physics.contact import CONTACT
from presswear.physics.dormand_prince import DOP853, DOPRI5
from presswear.physics.equations.function import model_of
from presswear.physics.equations.layout import (
    CONTACT_LOSS,
    DRIVE_EXCHANGE,
    initial_states,
)
from presswear.physics.equations.writer import (
    Equations,
    write_body_forces,
    write_equations,
)
from presswear.physics.ledger import (
    Ledger,
    created_energy_message,
    remedy_for_created_energy,
    stored_energy,
)
from presswear.physics.prescribed import begin_motion
from presswear.recording.observe import step_observer
from presswear.recording.recorder import Recorder
from presswear.recording.soundness import Finding, Progress, check_motor
from presswear.tools.arrays import Array
from presswear.tools.compile import Records
from presswear.tools.errors import InputError
from presswear.tools.packing import bind, pack_arguments

# Advice for a run with steps that are too long
REMEDY = "a smaller integration_tolerance or equal_step, or integrator=dop853, may help"

# Largest violation of the constraints by a start: m or rad, m/s or rad/s
POSITION_TOL = 1e-6
VELOCITY_TOL = 1e-4
# Part of a unit row that is orthogonal to the rows before it, below which the row
# depends on them; and below which it nearly does, at a singular position
DEPENDENT = 1e-9
NEARLY_DEPENDENT = 1e-2

# Round-off of a coordinate, in units of its last binary place
RESOLVED_DIGITS = 8.0

_CHUNK = 2000  # steps of a kernel call, between which progress and Ctrl-C are handled


def check_start(constraints: Constraints, start: Start) -> None:
    """Check that a start satisfies the constraints, and that none of them is redundant.

    Raises
    ------
    InputError
        With the name of the joint whose constraint is violated or redundant.
    """
    phi, phi_t, _, jacobian = constraints.evaluate(0.0, start.position, start.velocity)
    for kind, values, allowed in (
        ("position", phi, POSITION_TOL),
        ("velocity", phi_t, VELOCITY_TOL),
    ):
        worst = int(np.argmax(np.abs(values))) if values.size else 0
        if values.size and not abs(values[worst]) <= allowed:
            raise InputError(
                f"the start violates joint {constraints.names[worst]}: its {kind} is off by "
                f"{abs(values[worst]):.3g}, allowed is {allowed:g}"
            )
    if repeated := dependent_joint(jacobian, constraints.names, DEPENDENT):
        raise InputError(
            f"joint {repeated} repeats what the other joints already hold, or the position is "
            "singular: its constraint adds nothing"
        )


def dependent_joint(
    jacobian: Array, names: tuple[str, ...], least: float
) -> str | None:
    """Return the first joint with a constraint that depends on the constraints before it.

    It depends on them if the part of its unit row that is orthogonal to the rows before
    is shorter than ``least``.
    """
    rows = jacobian / np.linalg.norm(jacobian, axis=1, keepdims=True)
    norms = np.abs(np.diag(np.linalg.qr(rows.T).R))
    # Constraints beyond the number of coordinates add nothing.
    pairs = zip(names, [*norms, 0.0], strict=False)
    return next((name for name, size in pairs if size < least), None)


def _problem(
    status: int,
    constraints: Constraints,
    has_friction: bool,
    time: float,
    q: Array,
    v: Array,
) -> Finding:
    """Return the finding for an integration that has failed.

    A joint near a singular position is named. ``has_friction`` is true if a rigid joint
    has friction.
    """
    if status != STUCK:
        message = "the state is no longer finite"
        if has_friction:
            message += (
                "; friction in rigid joints blocks motion where mu r exceeds "
                "the levers of forces"
            )
        return Finding("state", message, time, "", REMEDY)
    jacobian = constraints.evaluate(time, q, v)[3]
    singular = dependent_joint(jacobian, constraints.names, NEARLY_DEPENDENT)
    if singular:
        message = "the step vanished near a singular position"
        remedy = "other lengths of the links"
        return Finding("state", message, time, singular, remedy)
    remedy = "a larger integration_tolerance may help"
    return Finding("state", "the step vanished", time, "", remedy)


def resolution_of(linkage: Linkage, start: Start) -> float:
    """Return the distance, m, below which differences of coordinates are round-off.

    It grows with the distance of the linkage from the origin.
    """
    ends = []
    for revolute in linkage.revolutes:
        ends += [revolute.first, revolute.second]
    for clearance in linkage.clearances:
        ends += [clearance.bearing, clearance.pin]
    arm = max((math.hypot(end.x, end.y) for end in ends), default=0.0)
    farthest = float(np.abs(start.position.reshape(-1, 3)[:, :2]).max())
    return RESOLVED_DIGITS * float(np.finfo(float).eps) * (farthest + arm)


def prepare(
    linkage: Linkage, start: Start, settings: InHouse, plan: Plan, recorder: Recorder
) -> Simulation:
    """Build the solver of a linkage in its initial state; see ``Simulation``."""
    solver = _Solver(linkage, start, settings, plan, recorder)
    return Simulation(
        advance=solver.advance,
        state=solver.motion,
        ledger=solver.ledger,
        update_contacts=solver.place_on_new_surfaces,
        arrays=solver.arrays(),
        sums=solver.sums,
        diagnostics=solver.diagnostics,
        remedy=REMEDY,
        constraints=None if solver.is_tree else solver.constraints,
    )


class _Solver:
    """Equations of a linkage with their state, and the kernels that integrate them."""

    def __init__(
        self,
        linkage: Linkage,
        start: Start,
        settings: InHouse,
        plan: Plan,
        recorder: Recorder,
    ) -> None:
        # Compiling, or loading what was compiled, is part of building the model.
        began = clock.perf_counter()
        self.linkage = linkage
        self.settings = settings
        self.plan = plan
        self.recorder = recorder
        self.records = recorder.records
        packed = self.records.packed
        self.constraints = constraints_of(linkage)
        check_start(self.constraints, start)
        self._write_equations()
        contacts = np.zeros(len(packed.joints), CONTACT)
        self.model = model_of(
            linkage, self.equations, packed, self.records.onset, contacts
        )
        if self.is_tree:
            begin_motion(self.model.prescribed, 0.0, start.position)
        self.y = self._state_vector(start)
        layout = self.equations.layout
        self.energies = self.y[layout.first_energy : layout.first_wear_integral]
        slopes = np.zeros((DOP853.b.size + 2, layout.size))
        self.steps = Motion(self.y, np.zeros(layout.size), slopes)
        self.control = self._control(resolution_of(linkage, start))
        self._bind_kernels()
        self.sums = {"solve": 0.0}
        self.progress = Progress(plan.cycle)
        self._march(0.0, 1)  # records the initial state
        self.stored_before = self._stored()
        self.built = clock.perf_counter() - began

    def _write_equations(self) -> None:
        """Write the equations of the open tree, or the forces on all bodies."""
        packed = self.records.packed
        tree: Equations | str = "all coordinates are requested"
        if not self.settings.takes_all_coordinates:
            # a reason if it cannot be written
            tree = write_equations(self.linkage, packed)
        self.is_tree = not isinstance(tree, str)
        if isinstance(tree, str):
            self.equations = write_body_forces(self.linkage, packed)
        else:
            self.equations = tree

    def _state_vector(self, start: Start) -> Array:
        """Return coordinates, rates and states of interactions at the start, integrals zero."""
        layout = self.equations.layout
        coordinates = self.equations.chain.coordinates(start.position, start.velocity)
        y = np.zeros(layout.size)
        y[: layout.first_state] = np.concatenate(coordinates)
        states = initial_states(self.equations.states, start.position)
        y[layout.first_state : layout.first_energy] = states
        return y

    def _control(self, resolution: float) -> Records:
        """Return the state of the integration; ``resolution`` is that of the coordinates, m."""
        settings = self.settings
        control = np.zeros(1, CONTROL)
        control["step"] = settings.step if settings.has_equal_steps else 1e-6
        control["longest"] = settings.longest(self.plan.cycle)
        control["shortest"] = 1e-14
        control["resolution"] = resolution
        control["parts"] = settings.impact_steps
        control["tolerance"] = settings.tolerance
        control["projected"] = settings.projection == "on"
        return control

    def _bind_kernels(self) -> None:
        """Bind the kernels of the integration method to this system."""
        settings = self.settings
        packed = self.records.packed
        stabilized = (
            () if self.is_tree else (self.constraints, settings.alpha, settings.beta)
        )
        system = system_of(packed, self.equations, self.model, *stabilized)
        observer = step_observer(self.records, *self.model.bodies[:3])
        state = self.records, observer, self.control, self.steps
        if settings.has_equal_steps:
            run = Integration(system, None, 4, *state, last=3)
        else:
            tableau = DOPRI5 if settings.integrator == "dopri5" else DOP853
            run = Integration(system, tableau, None, *state, last=tableau.b.size)
        packed_run = pack_arguments(run)
        march = march_fixed if settings.has_equal_steps else march_controlled
        self._kernel = bind(march, packed_run)
        self._place = bind(place_state, packed_run)

    @property
    def time(self) -> float:
        """Time reached, s."""
        return float(self.control["time"][0])

    def _march(self, end: float, most: int) -> int:
        """Make at most ``most`` steps towards a time, s; return the status."""
        self.control["most"] = most
        return self._kernel(end)

    def advance(self, end: float) -> Finding | None:
        """Integrate up to a time, s."""
        # A run that is resumed may have another tolerance.
        self.control["tolerance"] = self.settings.tolerance
        status = RUNNING
        finding = None
        while status == RUNNING and finding is None:
            began = clock.perf_counter()
            status = self._march(end, _CHUNK)
            self.sums["solve"] += clock.perf_counter() - began
            finding = self._examine(status)
        return finding

    def _examine(self, status: int) -> Finding | None:
        """Report the progress; return what went wrong in the last steps, if anything."""
        packed = self.records.packed
        time = self.time
        self.plan.advanced(self.recorder)
        is_settled = self.recorder.nominal_time > self.plan.settled
        loss = float(self.energies[CONTACT_LOSS])
        exchange = float(self.energies[DRIVE_EXCHANGE])
        message = created_energy_message(packed, loss, exchange) if is_settled else ""
        if message:
            return Finding(
                "energy", message, time, "", remedy_for_created_energy(packed, REMEDY)
            )
        if status in (BROKEN, STUCK):
            has_friction = bool(self.linkage.rubbing_pins)
            return _problem(status, self.constraints, has_friction, *self.motion())
        stalled = check_motor(self.recorder, time)
        return stalled or self.progress.judge(int(self.control["steps"][0]), time)

    def motion(self) -> tuple[float, Array, Array]:
        """Return time, s, coordinates and rates of all bodies."""
        self._place(self.time)
        q, v = self.model.bodies[:2]
        return self.time, q.copy(), v.copy()

    def place_on_new_surfaces(self) -> None:
        """Fill the contacts of the present state on changed surfaces.

        The stored slopes are those of the old surfaces and become invalid.
        """
        self.control["has_slope"] = False
        self._place(self.time)

    def ledger(self) -> Ledger:
        """Return the energies since the run began."""
        return Ledger.of(self.energies, self._stored() - self.stored_before)

    def _stored(self) -> float:
        records = self.records
        _, q, v = self.motion()
        return stored_energy(
            self.linkage, records.packed, records.memory["energy"], q, v
        )

    def arrays(self) -> dict[str, Array]:
        """Return the live arrays that hold the state between two cycles."""
        arrays = {"y": self.y, "slope": self.steps.slopes[0], "control": self.control}
        # Newton's method in closed loops starts from the last position.
        if self.equations.chain.has_loops:
            arrays["prescribed"] = self.model.prescribed.work
        return arrays

    def diagnostics(self) -> dict[str, float | int | str]:
        """Return sentences on the model and on its solver, counts and times."""
        control = self.control[0]
        return {
            **self._descriptions(),
            "steps": int(control["steps"]),
            "events": int(control["events"]),
            "evaluations": int(control["evaluations"]),
            "steps_sent_back": int(control["rejected"]),
            "constraint_error_m": float(control["position_error"]),
            "constraint_velocity_error_m_s": float(control["velocity_error"]),
            "wall_compile_s": self.built,
            "wall_solve_s": self.sums["solve"],
        }

    def _descriptions(self) -> dict[str, str]:
        """Return sentences on the model that was built and on its solver."""
        settings = self.settings
        linkage = self.linkage
        steps = f"RK4 at equal steps of {settings.step:g} s"
        if not settings.has_equal_steps:
            method = settings.integrator.upper()
            steps = f"{method} at tolerance {settings.tolerance:g}, touchdowns located"
        if self.is_tree:
            chain = self.equations.chain
            names = listed([link.body.name for link in chain.free])
            words = f"open tree of {chain.size} coordinates ({names})"
            model = described(linkage, words, prescribed_of(linkage))
            return {"model": model, "solver": f"in-house, {steps}"}
        words = f"{len(linkage.bodies)} bodies, {self.constraints.rows} constraints"
        factors = f"{settings.alpha:g}/{settings.beta:g}"
        solver = f"in-house, Lagrange multipliers, {steps}, Baumgarte {factors}"
        if settings.projection == "on":
            solver += ", projected"
        return {"model": described(linkage, words), "solver": solver}
