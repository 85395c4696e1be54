"""Exudyn with an open tree in minimal coordinates, explicit and error-controlled.

It applies to linkages in which clearance joints cut every loop that can move. Exudyn
computes the inertia of the tree and integrates (DOPRI5). It calls a Python user
function for the forces of all contacts, weights and moving hinges; these are the
written equations of the linkage (``physics.equations``), which read Exudyn's live
state. The state of contact changes only between accepted steps, and steps end at
touchdowns and separations.
"""

import time as clock
from array import array
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from presswear.engines.base import Plan, Start, described, listed
from presswear.engines.driver import Simulation
from presswear.engines.exudyn import Solver, StuckError, add, settings_of
from presswear.engines.exudyn_tree.kernels import (
    PACE,
    STAGES,
    TreeSystem,
    accept_tree_step,
    fill_start,
    stage_forces,
    stage_states,
)
from presswear.engines.exudyn_tree.model import add_tree
from presswear.engines.settings import FINEST, ExudynTree
from presswear.linkage.linkage import Linkage
from presswear.linkage.topology import branches_of, prescribed_of
from presswear.physics.equations.function import Model, model_of, written
from presswear.physics.equations.layout import initial_states
from presswear.physics.equations.writer import Equations, write_equations
from presswear.physics.ledger import Ledger, stored_energy
from presswear.physics.prescribed import begin_motion
from presswear.recording.observe import step_observer
from presswear.recording.recorder import Recorder
from presswear.recording.recorder_state import RecorderState
from presswear.recording.soundness import Finding
from presswear.tools.arrays import Array
from presswear.tools.errors import InputError
from presswear.tools.exudyn import exudyn_module
from presswear.tools.packing import bind, pack_arguments

exu = exudyn_module()

SHORTEST_STEP = 1e-13  # s; Exudyn shortens steps no further
FIRST_STEP = 1e-7  # s; length of the first step of a run
# Largest number of calls for forces without an accepted step: a thousand repeated steps of
# seven stages. Thirty repetitions reach the shortest step, which Exudyn would repeat
# without end.
MOST_CALLS = 7000


def prepare(
    linkage: Linkage, start: Start, settings: ExudynTree, plan: Plan, recorder: Recorder
) -> Simulation:
    """Build the tree in the initial state; see ``Simulation``.

    Raises
    ------
    InputError
        If the linkage is not an open tree.
    """
    branches = branches_of(linkage)
    if isinstance(branches, str):
        raise InputError(
            f"engine exudyn-tree needs a linkage without free loops: {branches}"
        )
    tree = _Tree(linkage, start, settings, plan, recorder)
    return Simulation(
        advance=tree.advance,
        state=tree.motion,
        ledger=tree.ledger,
        update_contacts=tree.update_contacts,
        arrays=tree.arrays(),
        sums=tree.solver.sums,
        diagnostics=tree.diagnostics,
        remedy=tree.solver.remedy,
        close=tree.container.Reset,
    )


class _Tree:
    """Linkage as a kinematic tree of Exudyn, with the functions that Exudyn calls.

    They read Exudyn's live state instead of the copies that are their arguments.
    """

    def __init__(
        self,
        linkage: Linkage,
        start: Start,
        settings: ExudynTree,
        plan: Plan,
        recorder: Recorder,
    ) -> None:
        # Compiling, or loading what was compiled, is part of building the model.
        began = clock.perf_counter()
        self.linkage = linkage
        self.settings = settings
        self.records = recorder.records
        packed = self.records.packed
        joints = len(self.records.contacts)
        equations = write_equations(linkage, packed, with_forces=True)
        assert isinstance(equations, Equations)
        self.chain = equations.chain
        states = initial_states(equations.states, start.position)
        self._build_system(start, states)
        self.model = model_of(
            linkage, equations, packed, np.zeros(joints), self.records.contacts
        )
        begin_motion(self.model.prescribed, 0.0, start.position)
        live = self._live_arrays()
        # Arrays of the state from which a solve continues, by their names in Exudyn
        self.initial_state = {"ODE2Coordinates": live.x, "ODE2Coordinates_t": live.u}
        if states.size:
            self.initial_state["ODE1Coordinates"] = live.states
        self.tree = _tree_system(equations, self.model, live, self.records)
        self.tree.pace["longest"] = settings.longest(plan.cycle)
        self.tree.pace["parts"] = settings.impact_steps
        self.tree.start[:] = live.x, live.u
        self.tree.start_states[:] = states
        accept = self._bind_kernels()
        self.solver = self._prepare_solver(plan, recorder, accept)
        self._fill_start(0.0)
        # Pins that are closed in the initial state store energy.
        self.records.memory["energy"] = self.records.contacts["energy"]
        self.stored_before = self._stored()
        self.built = clock.perf_counter() - began

    def _bind_kernels(self) -> Callable[[float], float]:
        """Bind the kernels to this tree; return that of accepted steps."""
        packed_run = pack_arguments(self.tree, self.records)
        self._stage = bind(stage_forces, packed_run)
        self._fill_start = bind(fill_start, packed_run)
        if self.state_rates.size:
            packed_rates = pack_arguments(self.tree, self.state_rates)
            self._states = bind(stage_states, packed_rates)
        return bind(accept_tree_step, packed_run)

    def _build_system(self, start: Start, states: Array) -> None:
        """Build and assemble Exudyn's system, with the initial states of interactions, m."""
        # Exudyn reads the numbers one by one, which is faster from an array of Python's
        # standard library than from numpy.
        self.force = array("d", bytes(8 * self.chain.size))
        self.state_rates = np.zeros(states.size)
        self.container = exu.SystemContainer()
        self.system = self.container.AddSystem()
        add_tree(self.system, self.chain, start, self.stage_forces)
        if states.size:
            _add_states(self.system, states, self.stage_states)
        self.system.Assemble()

    def _live_arrays(self) -> "_LiveArrays":
        """Return the arrays that Exudyn and the kernels share."""
        data = self.system.systemData
        states = np.zeros(0)
        if self.state_rates.size:
            states = data.GetODE1Coordinates(copy=False)
        return _LiveArrays(
            x=data.GetODE2Coordinates(copy=False),
            u=data.GetODE2Coordinates_t(copy=False),
            u_t=data.GetODE2Coordinates_tt(copy=False),
            states=states,
            force=np.frombuffer(self.force),
        )

    def _prepare_solver(
        self, plan: Plan, recorder: Recorder, accept: Callable[[float], float]
    ) -> Solver:
        """Return Exudyn's solver, which calls ``accept``, the kernel of accepted steps."""
        longest = self.settings.longest(plan.cycle)
        solver = Solver(
            recorder,
            plan,
            accept,
            exu.DynamicSolverType.DOPRI5,
            _solver_settings(self.settings, longest),
            longest,
            _remedy(self.settings),
            {"sent_back": "rejectedAutomaticStepSizeSteps"},
        )
        solver.sums["proposed"] = FIRST_STEP
        solver.install(self.system)
        return solver

    def stage_forces(self, system: Any, t: float, item: int, q: Any, q_t: Any) -> Any:
        """Return the forces on the coordinates in a stage."""
        try:
            if self._stage(t) > MOST_CALLS:
                raise StuckError
        except BaseException as error:
            self.solver.error = error
            raise
        return self.force

    def stage_states(self, system: Any, t: float, item: int, z: Any) -> Array:
        """Return the rates of the states of interactions in a stage."""
        try:
            self._states(t)
        except BaseException as error:
            self.solver.error = error
            raise
        return self.state_rates

    def advance(self, end: float) -> Finding | None:
        """Integrate up to a time, s."""
        return self.solver.run(self.system, self.initial_state, end)

    def motion(self) -> tuple[float, Array, Array]:
        """Return time, s, coordinates and rates of all bodies.

        If the last step has failed, they are those before the step.
        """
        if not np.isfinite([self.tree.q, self.tree.v]).all():
            self._fill_start(self.solver.time)
        return self.solver.time, self.tree.q.copy(), self.tree.v.copy()

    def update_contacts(self) -> None:
        """Fill the contacts of the present state."""
        self._fill_start(self.solver.time)

    def ledger(self) -> Ledger:
        """Return the energies since the run began."""
        return Ledger.of(self.records.energies, self._stored() - self.stored_before)

    def _stored(self) -> float:
        """Return the stored energy, J."""
        records = self.records
        q = self.tree.q
        v = self.tree.v
        elastic = records.memory["energy"]
        return stored_energy(self.linkage, records.packed, elastic, q, v)

    def arrays(self) -> dict[str, Array]:
        """Return the live arrays that hold the state between two cycles."""
        names = ("expected", "pace", "start", "start_states")
        return {
            **self.initial_state,
            **{name: getattr(self.tree, name) for name in names},
            "state": self.model.bodies,
            "prescribed": self.model.prescribed.work,
        }

    def diagnostics(self) -> dict[str, float | int | str]:
        """Return texts on the model and on its solver, counts and times."""
        (pace,) = self.tree.pace
        sums = self.solver.sums
        names = listed([link.body.name for link in self.chain.free])
        model = f"open tree of {self.chain.size} coordinates ({names})"
        return {
            "model": described(self.linkage, model, prescribed_of(self.linkage)),
            "solver": f"Exudyn DOPRI5 at tolerance {self.settings.tolerance:g}, "
            "steps end on touches and separations",
            "steps": int(sums["steps"]),
            "steps_sent_back": int(sums["sent_back"]),
            "evaluations": int(pace["evaluations"]),
            "events": int(pace["events"]),
            "deepest_touch_m": float(pace["deepest_touch"]),
            "wall_build_s": self.built,
            "wall_solve_s": sums["wall"],
        }


def _add_states(system: Any, initial: Array, rates: Callable[..., Any]) -> None:
    """Add the states of interactions to a system, with their initial values and rates.

    In each stage Exudyn calls for these rates before the forces, and once more in each
    step.
    """
    node = add(
        system,
        "Node",
        "GenericODE1",
        referenceCoordinates=[0.0] * initial.size,
        initialCoordinates=initial.tolist(),
        numberOfODE1Coordinates=initial.size,
    )
    add(system, "Object", "GenericODE1", nodeNumbers=[node], rhsUserFunction=rates)


class _LiveArrays(NamedTuple):
    """Arrays that Exudyn and the kernels share, so that nothing is copied in a stage."""

    x: Array  # coordinates, (coordinates,)
    u: Array  # rates of the coordinates
    u_t: Array  # accelerations
    states: Array  # states of interactions, m, (states,)
    force: Array  # forces on the coordinates, which a stage returns to Exudyn


def _tree_system(
    equations: Equations, model: Model, live: _LiveArrays, records: RecorderState
) -> TreeSystem:
    """Pack a tree for the kernels."""
    layout = equations.layout
    width = layout.size + layout.coordinates  # with the forces on the coordinates
    pace = np.zeros(1, PACE)
    pace["shortest"] = SHORTEST_STEP
    pace["reach"] = pace["limit"] = FIRST_STEP
    return TreeSystem(
        written(equations, model),
        observer=step_observer(records, *model.bodies[:3]),
        **live._asdict(),
        expected=model.onset,
        pace=pace,
        q=model.bodies[0],
        v=model.bodies[1],
        a=model.bodies[2],
        y=np.zeros(layout.size),
        stages=np.zeros((STAGES, width)),
        out=np.zeros(width),
        start=np.zeros((2, layout.coordinates)),
        start_states=np.zeros(len(equations.states)),
        layout=layout,
    )


def _remedy(settings: ExudynTree) -> str:
    """Return advice for a run with steps that are too long."""
    finer = settings.tolerance / 10.0
    if finer < FINEST:
        return "engine = dae may help"
    return f"set a smaller tree_tolerance, for example {finer:.3g}"


def _solver_settings(accuracy: ExudynTree, longest: float) -> Any:
    """Return Exudyn's settings for a tolerance and a longest step, s."""
    settings = settings_of(longest, SHORTEST_STEP)
    integration = settings.timeIntegration
    integration.automaticStepSize = True
    integration.stepSizeMaxIncrease = 1e9  # growth is limited by next_tree_step
    # Only an absolute tolerance is used: Exudyn computes the relative one from the state
    # with its sign, so that it can be negative.
    integration.absoluteTolerance = accuracy.tolerance
    integration.relativeTolerance = 0.0
    # The seventh stage of DOPRI5 already is the acceleration at the end of the step.
    integration.explicit.computeEndOfStepAccelerations = False
    integration.explicit.computeMassMatrixInversePerBody = False
    return settings
