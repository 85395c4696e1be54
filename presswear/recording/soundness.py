"""Soundness checks after each cycle: findings that make the numbers of a run useless.

A run ends if a limit is exceeded. Each limit is far above the values of a sound run.
"""

import math
from dataclasses import dataclass, replace
from typing import Literal, NamedTuple

import numpy as np

from presswear.linkage.linkage import Linkage
from presswear.linkage.load_laws import OverPosition
from presswear.linkage.loads import Force
from presswear.linkage.point_position import point_position
from presswear.linkage.process import PROCESSES
from presswear.physics.constraints import Constraints
from presswear.physics.equations.body_forces import BodyForces
from presswear.physics.ideal import ideal_motion
from presswear.physics.ledger import Ledger, remedy_for_created_energy
from presswear.physics.packed import mass_of, pack
from presswear.physics.packed_loads import pack_loads
from presswear.recording.nominal_time import STALLED
from presswear.recording.recorder import Recorder
from presswear.tools.arrays import Array

Kind = Literal[
    "state", "energy", "steps", "constraints", "penetration", "wear", "motor"
]

# Largest residual of the energy balance, over the energy exchanged by the drives
RESIDUAL = 3e-3
# Residual at the tolerances of a trajectory, over the energy exchanged: the report
# compares with it
ENERGY_BOUND = 1e-6
# Largest residual over the energy dissipated by damping and friction: the error of wear
# is about as large.
RESIDUAL_DISSIPATED = 1e-2
# Residual that is always allowed, over the energy exchanged. It is 1e-7 in an accurate
# run, and 2e-5 with the longest steps.
MIN_RESIDUAL = 1e-4
# Least energy exchanged, over the kinetic energy: the drives may exchange very little
MIN_EXCHANGED = 1e-3
# Largest energy created by contacts over the energy dissipated: above it the contacts
# drive the linkage
MAX_CREATED = 1.0
MIN_CREATED = 1e-3  # created energy that is always allowed, over the energy exchanged
# Largest share of contacts with fewer than LEAST_STEPS steps. Grazing contacts are a few
# per cent.
UNRESOLVED = 0.5
MIN_CONTACTS = 20  # contacts of a joint from which on this share is checked
DRIFT = 0.01  # largest error of a constraint, m or rad, over the smallest clearance
MIN_DRIFT = 1e-7  # error of a constraint that is always allowed, m or rad
DRIFT_IDEAL = 1e-4  # largest error of a constraint without clearances, m or rad
START_CYCLES = 20  # nominal cycles in which a starting motor must turn
BACKWARDS = 0.25  # largest rotation backwards of a starting motor, in cycles
STALL_STEPS = 1000  # number of steps between checks of the progress in time
# Least mean step, s, and over the period of a cycle. In a clearance of 1 nm it is far
# longer.
STALL = 1e-12


@dataclass(frozen=True)
class Finding:
    """Reason that ends a run; its fields are the names in ``result.json``."""

    kind: Kind
    what: str  # text with values and limits
    time_s: float  # since the start of the run
    joint: str  # "" if the cause is not one joint
    remedy: str  # changes that may help

    @property
    def words(self) -> str:
        """Text in one line."""
        where = f"joint {self.joint}: " if self.joint else ""
        remedy = f"; {self.remedy}" if self.remedy else ""
        # A finding on a wear update has no time in the run.
        when = "" if self.kind == "wear" else f" (t = {self.time_s:.6g} s)"
        return f"{where}{self.what}{when}{remedy}"


@dataclass
class Progress:
    """Check of the progress in time of a run, which ends if the time does not advance."""

    cycle: float  # period of a cycle, s
    steps: int = 0  # number of steps at the last check
    time: float = 0.0  # at the last check, s

    def judge(self, steps: int, time: float) -> Finding | None:
        """Return a finding if the last thousand steps or more did not advance the time, s."""
        new_steps = steps - self.steps
        advanced = time - self.time
        if new_steps < STALL_STEPS:
            return None
        self.steps = steps
        self.time = time
        if advanced > new_steps * STALL * max(self.cycle, 1.0):
            return None
        what = (
            f"the time stands still: {new_steps} steps advanced it by {advanced:.3g} s"
        )
        remedy = "a law of force without a jump, or a larger tolerance, may help"
        return Finding("state", what, time, "", remedy)


def check_motor(recorder: Recorder, time: float) -> Finding | None:
    """Return a finding if the motor of the leader has stalled, or does not start."""
    nominal = recorder.records.nominal[0]
    cycle = float(recorder.records.output["period"][0])
    more = "a motor with more torque"
    remedy = f"{more}, or with a larger inertia, may help"
    if math.isfinite(nominal["stall"]):
        angle = math.degrees(nominal["start"] + nominal["speed"] * nominal["stall"])
        what = (
            f"the motor stalls at an angle of {angle % 360.0:.1f} degrees of its crank"
        )
        what += f": its speed falls below {100.0 * STALLED:g} % of the nominal speed"
        return Finding("motor", what, time, "", remedy)
    remedy = f"{more}, or an initial speed, may help"
    if nominal["now"] < -BACKWARDS * cycle:
        what = "the motor turns backwards from its start, because the load is larger"
        return Finding("motor", what, time, "", remedy)
    if nominal["idle"] > START_CYCLES * cycle:
        angle = math.degrees(nominal["start"] + nominal["speed"] * nominal["furthest"])
        what = (
            f"the motor does not start: in {nominal['idle']:.6g} s its crank has not turned "
            f"beyond an angle of {angle % 360.0:.1f} degrees"
        )
        return Finding("motor", what, time, "", remedy)
    return None


@dataclass(frozen=True)
class Condition:
    """Condition of a run after a cycle."""

    time: float  # s
    ledger: Ledger  # energies since the start of the run
    position: Array  # (3 bodies,)
    velocity: Array
    remedy: str  # setting that makes the steps of the engine finer
    constraints: Constraints | None = None  # to be checked for drift


def examine(linkage: Linkage, recorder: Recorder, now: Condition) -> Finding | None:
    """Return the first finding after a cycle, or None."""
    if not (np.isfinite(now.position).all() and np.isfinite(now.velocity).all()):
        return Finding(
            "state", "the state is no longer finite", now.time, "", now.remedy
        )
    return (
        _check_contacts(linkage, recorder, now)
        or _check_energy(linkage, recorder, now)
        or _check_constraints(linkage, now)
    )


def _check_contacts(
    linkage: Linkage, recorder: Recorder, now: Condition
) -> Finding | None:
    """Check penetration and steps of the contacts of each joint."""
    pairs = list(zip(linkage.clearances, recorder.records.counters, strict=True))
    for joint, counters in pairs:
        deepest = float(counters["deepest"])
        limit = joint.pin_radius
        if deepest > limit:
            what = (
                f"the penetration of {deepest:.3g} m exceeds the radius of the pin, "
                f"{limit:.3g} m"
            )
            remedy = f"a stiffer joint, a lower speed, or {now.remedy}"
            return Finding("penetration", what, now.time, joint.name, remedy)
    for joint, counters in pairs:
        contacts = int(counters["contacts"])
        coarse = int(counters["unresolved"])
        if contacts >= MIN_CONTACTS and coarse > UNRESOLVED * contacts:
            what = (
                f"the steps are too long for the contacts: {coarse} of {contacts} had too few, "
                f"the least {int(counters['fewest_steps'])}"
            )
            return Finding("steps", what, now.time, joint.name, now.remedy)
    return None


def _check_energy(
    linkage: Linkage, recorder: Recorder, now: Condition
) -> Finding | None:
    ledger = now.ledger
    if ledger.drive_exchange <= 0.0:
        return None
    kinetic = 0.5 * float(mass_of(linkage) @ now.velocity**2)
    # If a weight falls from rest, the drives exchange nothing: the dissipated energy is
    # used instead.
    exchange = max(ledger.drive_exchange, ledger.dissipated, MIN_EXCHANGED * kinetic)
    heat = ledger.dissipated
    limit = min(
        RESIDUAL * exchange, max(RESIDUAL_DISSIPATED * heat, MIN_RESIDUAL * exchange)
    )
    if abs(ledger.residual) > limit:
        what = (
            f"the energy balance has a residual of {ledger.residual:.3g} J, limit {limit:.3g} J: "
            f"the drives exchanged {exchange:.3g} J, damping and friction dissipated {heat:.3g} J"
        )
        return Finding("energy", what, now.time, "", now.remedy)
    limit = max(MAX_CREATED * heat, MIN_CREATED * exchange)
    if ledger.created > limit:
        what = (
            f"the contacts created {ledger.created:.3g} J, limit {limit:.3g} J: damping and "
            f"friction dissipated {heat:.3g} J"
        )
        remedy = remedy_for_created_energy(recorder.records.packed, now.remedy)
        return Finding("energy", what, now.time, "", remedy)
    return None


def _check_constraints(linkage: Linkage, now: Condition) -> Finding | None:
    constraints = now.constraints
    if constraints is None or constraints.rows == 0:
        return None
    error = np.abs(constraints.evaluate(now.time, now.position, now.velocity)[0])
    worst = int(error.argmax())
    clearance = min((joint.clearance for joint in linkage.clearances), default=math.inf)
    limit = max(DRIFT * clearance, MIN_DRIFT) if clearance < math.inf else DRIFT_IDEAL
    if error[worst] <= limit:
        return None
    what = (
        f"the joint has drifted apart by {error[worst]:.3g} m or rad, limit {limit:.3g}"
    )
    remedy = "engine = dae with projection = on prevents it"
    return Finding("constraints", what, now.time, constraints.names[worst], remedy)


# Times after a state at which forces are evaluated, s
_AFTER = (0.0, *np.geomspace(1e-15, 1e-2, 53))
# Largest of these times whose value is also a change of all coordinates and rates, in
# both directions, m, rad, m/s or rad/s
_BESIDE = 1e-6


def with_cause(
    finding: Finding, linkage: Linkage, recorder: Recorder, q: Array, v: Array
) -> Finding:
    """Return a finding with its cause.

    For a motor that stalls in the work the cause is the depth in the work. For a state
    that is not finite, it is an element whose force is not finite. The forces are
    evaluated at the last finite state and close to it, along the motion and in both
    directions of all coordinates and rates. If no such element is found, it is the
    viscous damping of joints. The finding does not change if there is no cause of these
    kinds, or no finite state.
    """
    if finding.kind == "motor":
        what = f"{finding.what}{_depth_in_work(linkage, recorder)}"
        return replace(finding, what=what)
    if finding.kind != "state" or not (np.isfinite(q).all() and np.isfinite(v).all()):
        return finding
    ones = np.ones_like(q)
    elements = _elements(linkage, recorder)
    for h in _AFTER:
        for direction in (v, ones, -ones) if h <= _BESIDE else (v,):
            state = finding.time_s + h, q + h * direction, v + h * direction
            for element in elements:
                if not element.has_force(*state):
                    what = f"the force of {element.name} is not finite"
                    remedy = "its law must give a number everywhere"
                    return replace(finding, what=what, remedy=remedy)
    damped = [
        joint.name for joint in linkage.clearances if joint.normal.viscosity > 0.0
    ]
    if damped and not finding.joint:
        # The damper limits the steps at any tolerance.
        return replace(
            finding, remedy=f"less viscous_damping at {', '.join(damped)} may help"
        )
    return finding


def _depth_in_work(linkage: Linkage, recorder: Recorder) -> str:
    """Return the depth in the work at which a motor has stalled, by the ideal motion, or ""."""
    stall = float(recorder.records.nominal["stall"][0])
    if not math.isfinite(stall):
        return ""
    motion = ideal_motion(linkage.ideal, linkage.period).at(np.array([stall]))
    position = motion.position[0].tolist()
    forces = (load for load in linkage.loads_with_law if isinstance(load, Force))
    for load in forces:
        if load.name not in PROCESSES or not isinstance(load.law, OverPosition):
            continue
        x, y = point_position(linkage, load.attachment, position)
        along = x * math.cos(load.direction) + y * math.sin(load.direction)
        depth = load.law.zero - along
        if 0.0 < depth < -load.law.table[0][0]:
            return f", {1e3 * depth:.3g} mm in the work"
    return ""


class _Element(NamedTuple):
    """Spring, load or joint, with its forces."""

    name: str
    forces: BodyForces
    joint: int | None = None  # number among the contacts

    def has_force(self, t: float, q: Array, v: Array) -> bool:
        """Return whether its force is finite in a state."""
        force = self.forces(t, q, v)
        if self.joint is None:
            return bool(np.isfinite(force).all())
        contact = self.forces.contacts[self.joint]
        return math.isfinite(contact["normal"]) and math.isfinite(contact["tangential"])


def _elements(linkage: Linkage, recorder: Recorder) -> list[_Element]:
    """Return all springs, loads with a law and joints in their present state."""
    records = recorder.records
    without = replace(linkage, springs=(), loads=(), clearances=())
    elements = []
    for spring in linkage.springs:
        with_spring = replace(without, springs=(spring,))
        forces = BodyForces(with_spring, pack(with_spring))
        elements.append(_Element(f"spring {spring.name}", forces))
    for k, load in enumerate(linkage.loads_with_law):
        with_load = replace(without, loads=(load,))
        loads = records.packed.loads
        packed_load = loads._replace(
            records=loads.records[k : k + 1], modes=loads.modes[k : k + 1]
        )
        name = getattr(load, "name", "") or f"on {load.body}"
        packed = pack(with_load)._replace(loads=packed_load)
        forces = BodyForces(with_load, packed)
        elements.append(_Element(f"{type(load).__name__.lower()} {name}", forces))
    joints = replace(without, clearances=linkage.clearances)
    forces = BodyForces(
        joints, records.packed._replace(loads=pack_loads(joints)), records.onset
    )
    for k, joint in enumerate(linkage.clearances):
        elements.append(_Element(f"joint {joint.name}", forces, k))
    return elements
