"""The press in MuJoCo and Drake, with their own trees and integrators and the same contact law.

Both get the contact forces from the kernel written by hand as generalized forces,
because neither has a pin with clearance. Crank 7 is so heavy that no force slows it.
Install with ``pip install mujoco drake``.
"""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from by_hand.equations import OPEN
from evaluation import Outcome, evaluate, measured

from presswear.tools.arrays import Array
from presswear.tools.compile import Records, compiled, specialised

HEAVY = 1e9  # kg m^2, inertia of a crank that no force slows
# Bodies in the order of their coordinates, each relative to its parent
JOINTS = ("crank 7", "plate 4", "rod 3", "slider 6", "rod 5")


@compiled
def relative_forces(
    press: Records,
    t: float,
    q: Array,
    v: Array,
    onset: Array,
    work: Array,
    gaps: Array,
    out: Array,
) -> None:
    """Fill the generalized forces on the relative coordinates of a tree; ``work`` is (20,).

    They are the angles of crank 7, plate 4 and rod 3, each relative to its parent, the
    height of slider 6 and the angle of rod 5.
    """
    y = work[:8]
    y[0] = q[0] + q[1]
    y[1] = q[0] + q[1] + q[2]
    y[2] = q[3]
    y[3] = q[4]
    y[4] = v[0] + v[1]
    y[5] = v[0] + v[1] + v[2]
    y[6] = v[3]
    y[7] = v[4]
    evaluate(press, t, y, onset, work[8:], gaps)
    force = work[16:]
    out[0] = 0.0
    out[1] = force[0] + force[1]
    out[2] = force[1]
    out[3] = force[2]
    out[4] = force[3]


@compiled
def land(onset: Array, before: Array, now: Array) -> bool:
    """Update the closing speeds after a step; return whether any changed.

    Penetrations and their rates at both ends of the step have the shape (2, 2);
    ``before`` becomes ``now``.
    """
    changed = False
    for k in range(2):
        depth = before[k, 0]
        rate = before[k, 1]
        if (now[k, 0] > 0.0) != (onset[k] >= 0.0):
            changed = True
            onset[k] = OPEN
            if now[k, 0] > 0.0:
                part = depth / (depth - now[k, 0])
                onset[k] = math.sqrt(
                    max(rate**2 + part * (now[k, 1] ** 2 - rate**2), 0.0)
                )
        before[k, 0], before[k, 1] = now[k, 0], now[k, 1]
    return changed


class _Contacts:
    """Generalized forces on JOINTS, and the closing speeds stored between steps."""

    def __init__(self, press: Records, start: Array):
        y = start
        p = press[0]
        self.q = np.array([p["start_7"], y[0] - p["start_7"], y[1] - y[0], y[2], y[3]])
        self.v = np.array([p["speed"], y[4] - p["speed"], y[5] - y[4], y[6], y[7]])
        self.onset = np.full(2, OPEN)
        self.gaps = np.zeros((2, 2, 2))
        self._fixed = (self.onset, np.zeros(20), self.gaps[1], np.zeros(5))
        self._press = press
        self._kernel = specialised(
            relative_forces, press, 0.0, self.q, self.v, *self._fixed
        )

    def forces(self, t: float, q: Array, v: Array) -> Array:
        self._kernel(self._press, t, q, v, *self._fixed)
        return self._fixed[-1]

    def accept(self, t: float, q: Array, v: Array) -> Array:
        """Update the closing speeds after a step to ``t``, s; return the state."""
        self._kernel(self._press, t, q, v, *self._fixed)
        land(self.onset, self.gaps[0], self.gaps[1])
        return self._fixed[1][:8].copy()


def _bodies(
    press: Records,
) -> dict[str, tuple[str, float, float, float, float, float, float]]:
    """Return the parent of each body, its hinge, m, mass centre, m, mass and inertia."""
    p = press[0]
    plate = p["plate_inertia"] - p["mass_3"] * (p["b_x"] ** 2 + p["b_y"] ** 2)
    plate -= p["mass_4"] * (p["centre_x"] ** 2 + p["centre_y"] ** 2)
    half_3 = 0.5 * p["length_3"]
    half_5 = 0.5 * p["length_5"]
    rod_3 = p["rod_3_inertia"] - p["mass_3"] * half_3**2
    rod_5 = p["rod_5_inertia"] - p["mass_5"] * half_5**2
    centre = (p["centre_x"], p["centre_y"])
    corner = (p["b_x"], p["b_y"])
    return {
        "crank 7": ("", 0.0, 0.0, 0.0, 0.0, 1.0, HEAVY),
        "plate 4": ("crank 7", p["length_7"], 0.0, *centre, p["mass_4"], plate),
        "rod 3": ("plate 4", *corner, half_3, 0.0, p["mass_3"], rod_3),
        "slider 6": ("", p["o2_x"], 0.0, 0.0, 0.0, p["mass_6"], 1.0),
        "rod 5": ("slider 6", 0.0, 0.0, half_5, 0.0, p["mass_5"], rod_5),
    }


def mujoco(
    press: Records, start: Array, end: float, step: float, longest: float
) -> Outcome:
    """Run MuJoCo's RK4 at equal steps, s; ``longest`` is ignored."""
    import mujoco as mj

    def element(name: str) -> str:
        _, x, y, cx, cy, mass, inertia = bodies[name]
        kind = 'slide" axis="0 1 0' if name == "slider 6" else 'hinge" axis="0 0 1'
        inner = "".join(element(child) for child in JOINTS if bodies[child][0] == name)
        return (
            f'<body pos="{x!r} {y!r} 0"><joint type="{kind}"/><inertial pos="{cx!r} {cy!r} 0" '
            f'mass="{mass!r}" diaginertia="{inertia!r} {inertia!r} {inertia!r}"/>{inner}</body>'
        )

    bodies = {
        name: (parent, *map(float, rest))
        for name, (parent, *rest) in _bodies(press).items()
    }
    count = round(end / step)
    model = mj.MjModel.from_xml_string(
        f'<mujoco><compiler angle="radian"/><option integrator="RK4" timestep="{end / count!r}" '
        f'gravity="0 {-float(press[0]["gravity"])!r} 0"><flag contact="disable"/></option>'
        f"<worldbody>{''.join(element(root) for root in JOINTS if not bodies[root][0])}</worldbody>"
        "</mujoco>"
    )
    data = mj.MjData(model)
    contacts = _Contacts(press, start)
    data.qpos[:] = contacts.q
    data.qvel[:] = contacts.v
    q = data.qpos
    v = data.qvel
    passive = data.qfrc_passive

    def push(model: Any, data: Any) -> None:
        passive[:] = contacts.forces(data.time, q, v)

    def run() -> Array:
        state = contacts.accept(0.0, q, v)
        for _ in range(count):
            mj.mj_step(model, data)
            state = contacts.accept(data.time, q, v)
        return state

    mj.set_mjcb_passive(push)
    try:
        return measured(run)
    finally:
        mj.set_mjcb_passive(None)


def drake(
    press: Records, start: Array, end: float, tolerance: float, longest: float
) -> Outcome:
    """Run Drake's RK3, error-controlled, with a target accuracy and a longest step, s."""
    from pydrake.math import RigidTransform
    from pydrake.multibody.plant import MultibodyPlant
    from pydrake.multibody.tree import (
        FixedOffsetFrame,
        PrismaticJoint,
        RevoluteJoint,
        RotationalInertia,
        SpatialInertia,
    )
    from pydrake.systems.analysis import ResetIntegratorFromFlags, Simulator
    from pydrake.systems.framework import DiagramBuilder, LeafSystem

    contacts = _Contacts(press, start)
    builder = DiagramBuilder()
    plant = builder.AddSystem(MultibodyPlant(0.0))
    plant.mutable_gravity_field().set_gravity_vector([0.0, -press[0]["gravity"], 0.0])
    links = {"": plant.world_body()}
    for name, (parent, x, y, cx, cy, mass, inertia) in _bodies(press).items():
        centre = np.array([cx, cy, 0.0])
        turning = RotationalInertia(inertia, inertia, inertia)
        spatial = SpatialInertia.MakeFromCentralInertia(mass, centre, turning)
        links[name] = plant.AddRigidBody(name, spatial)
        place = RigidTransform([x, y, 0.0])
        before = links[parent].body_frame()
        frame = plant.AddFrame(FixedOffsetFrame(f"hinge of {name}", before, place))
        kind = RevoluteJoint
        axis = [0.0, 0.0, 1.0]
        if name == "slider 6":
            kind = PrismaticJoint
            axis = [0.0, 1.0, 0.0]
        plant.AddJoint(kind(name, frame, links[name].body_frame(), axis))
    plant.Finalize()
    order = [plant.GetJointByName(name).velocity_start() for name in JOINTS]
    forces = np.zeros(5)
    state = np.zeros(10)

    class Pushes(LeafSystem):  # type: ignore[misc]  # Drake may not be installed: its class is unknown
        def __init__(self) -> None:
            super().__init__()
            self.state = self.DeclareVectorInputPort("state", 10)
            self.DeclareVectorOutputPort("forces", 5, self.calc)

        def calc(self, context: Any, output: Any) -> None:
            state[:] = self.state.Eval(context)
            pushed = contacts.forces(
                context.get_time(), state[:5][order], state[5:][order]
            )
            forces[order] = pushed
            output.SetFromVector(forces)

    pushes = builder.AddSystem(Pushes())
    builder.Connect(plant.get_state_output_port(), pushes.get_input_port())
    builder.Connect(
        pushes.get_output_port(), plant.get_applied_generalized_force_input_port()
    )
    simulator = Simulator(builder.Build())
    integrator = ResetIntegratorFromFlags(simulator, "runge_kutta3", longest)
    integrator.set_target_accuracy(tolerance)
    root = simulator.get_mutable_context()
    context_of_plant = plant.GetMyMutableContextFromRoot(root)
    for values, put in (
        (contacts.q, plant.SetPositions),
        (contacts.v, plant.SetVelocities),
    ):
        ordered = np.zeros(5)
        ordered[order] = values
        put(context_of_plant, ordered)

    def accept(context: Any) -> Array:
        state[:] = context.get_continuous_state_vector().CopyToVector()
        return contacts.accept(context.get_time(), state[:5][order], state[5:][order])

    def monitor(context: Any) -> None:
        accept(context)

    simulator.set_monitor(monitor)
    simulator.Initialize()

    def run() -> Array:
        simulator.AdvanceTo(end)
        return accept(root)

    return measured(run)


# name, function and whether its steps are equal, by package
SIMULATORS: dict[str, tuple[str, Callable[..., Outcome], bool]] = {
    "mujoco": ("MuJoCo, RK4", mujoco, True),
    "pydrake": ("Drake, RK3", drake, False),
}
