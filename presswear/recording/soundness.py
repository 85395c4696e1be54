"""Soundness checks after each cycle: findings that make the numbers of a run worthless.

Each limit lies far beyond the values of a sound run, so that a run ends where one is
exceeded.
"""

import math
from dataclasses import dataclass, replace
from typing import Literal, NamedTuple

import numpy as np

from presswear.linkage.linkage import Linkage, place_of
from presswear.linkage.loads import PROCESSES, Force, OverPosition
from presswear.physics.constraints import Constraints
from presswear.physics.equations.body_forces import BodyForces
from presswear.physics.ideal import ideal_motion
from presswear.physics.ledger import Ledger, made_remedy
from presswear.physics.packed import mass_of, pack
from presswear.recording.nominal_time import STALLED
from presswear.recording.recorder import Recorder
from presswear.tools.arrays import Array

Kind = Literal[
    "state", "energy", "steps", "constraints", "penetration", "wear", "motor"
]

# residual of the energy balance over the energy that the drives exchanged
RESIDUAL = 3e-3
# of the energy exchanged, at the tolerances of a trajectory: the report compares with it
ENERGY_BOUND = 1e-6
# Of the heat of damping and friction: wear is no more accurate than that.
RESIDUAL_DISSIPATED = 1e-2
# of the energy exchanged: 1e-7 for a trajectory, 2e-5 at the coarsest steps
MIN_RESIDUAL = 1e-4
# of the kinetic energy: at an instant hardly any energy is exchanged
MIN_EXCHANGED = 1e-3
MADE = 1.0  # created over dissipated energy: beyond it the contacts drive the linkage
MIN_MADE = 1e-3  # of the energy exchanged
# Contacts of fewer than LEAST_STEPS steps; grazing contacts are a few in a hundred.
UNRESOLVED = 0.5
MIN_CONTACTS = 20  # of a joint, before these are judged
DRIFT = 0.01  # error of a constraint, m or rad, of the smallest clearance
MIN_DRIFT = 1e-7  # m or rad, which harms no linkage
DRIFT_IDEAL = 1e-4  # m, without clearance
# Nominal cycles in which a motor that starts must turn on
START_CYCLES = 20
BACKWARDS = 0.25  # of a cycle, by which it may turn back
STALL_STEPS = 1000  # after which the progress of a run is judged
# Least mean step, s, and as a part of a cycle; in a clearance of 1 nm it is far longer
STALL = 1e-12


@dataclass(frozen=True)
class Finding:
    """Reason that ends a run; its fields are the names in ``result.json``."""

    kind: Kind
    what: str  # text with values and limits
    time_s: float  # since the start of the run
    joint: str  # nothing if no single joint is the cause
    remedy: str  # changes that may help

    @property
    def words(self) -> str:
        """Text in one line."""
        where = f"joint {self.joint}: " if self.joint else ""
        remedy = f"; {self.remedy}" if self.remedy else ""
        # Wear that a wear update would remove is not of a time within the run.
        when = "" if self.kind == "wear" else f" (t = {self.time_s:.6g} s)"
        return f"{where}{self.what}{when}{remedy}"


@dataclass
class Progress:
    """Progress of a run, which ends where time stands still."""

    cycle: float  # s
    steps: int = 0  # at the last judgement
    time: float = 0.0  # s

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
    """Return a finding if the motor that leads a run has stalled, or does not start."""
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
    constraints: Constraints | None = None  # that may drift


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
    # If a weight falls from rest, all energy exchanged is what its fall turns into
    # heat.
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
    limit = max(MADE * heat, MIN_MADE * exchange)
    if ledger.made > limit:
        what = (
            f"the contacts created {ledger.made:.3g} J, limit {limit:.3g} J: damping and friction "
            f"dissipated {heat:.3g} J"
        )
        remedy = made_remedy(recorder.records.packed, now.remedy)
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


# Times after a state, s, at which forces are evaluated. Those up to the second limit
# are also the distances of positions and speeds to both sides of it, m, rad, m/s or
# rad/s.
_AFTER = (0.0, *np.geomspace(1e-15, 1e-2, 53))
_BESIDE = 1e-6


def with_cause(
    finding: Finding, linkage: Linkage, recorder: Recorder, q: Array, v: Array
) -> Finding:
    """Return a finding with its cause.

    A motor that stalls in the work does so at a depth. A state that is not finite has
    an element whose force is not.
    The forces are evaluated at the last finite state and close to it: along the motion
    and, for what depends on the speed, to both sides of it. Without such an element
    viscous damping of joints is the cause. Without both, or without a finite state, the
    finding stays.
    """
    if finding.kind == "motor":
        what = f"{finding.what}{_depth_in_work(linkage, recorder)}"
        return replace(finding, what=what)
    if finding.kind != "state" or not (np.isfinite(q).all() and np.isfinite(v).all()):
        return finding
    one = np.ones_like(q)
    elements = _elements(linkage, recorder)
    for h in _AFTER:
        for way in (v, one, -one) if h <= _BESIDE else (v,):
            state = finding.time_s + h, q + h * way, v + h * way
            for element in elements:
                if not element.has_force(*state):
                    what = f"the force of {element.name} is not finite"
                    remedy = "its law must give a number everywhere"
                    return replace(finding, what=what, remedy=remedy)
    damped = [
        joint.name for joint in linkage.clearances if joint.normal.viscosity > 0.0
    ]
    if damped and not finding.joint:
        # The steps follow the damper, whatever their tolerance.
        return replace(
            finding, remedy=f"less viscous_damping at {', '.join(damped)} may help"
        )
    return finding


def _depth_in_work(linkage: Linkage, recorder: Recorder) -> str:
    """Return how deep a stalled motor is in the work, from the ideal motion; else nothing."""
    stall = float(recorder.records.nominal["stall"][0])
    if not math.isfinite(stall):
        return ""
    motion = ideal_motion(linkage.ideal, linkage.period).at(np.array([stall]))
    position = motion.position[0].tolist()
    forces = (load for load in linkage.live_loads if isinstance(load, Force))
    for load in forces:
        if load.name not in PROCESSES or not isinstance(load.law, OverPosition):
            continue
        x, y = place_of(linkage, load.attachment, position)
        along = x * math.cos(load.direction) + y * math.sin(load.direction)
        depth = load.law.zero - along
        if 0.0 < depth < -load.law.table[0][0]:
            return f", {1e3 * depth:.3g} mm in the work"
    return ""


class _Element(NamedTuple):
    """A spring, a load or a joint, with its forces."""

    name: str
    forces: BodyForces
    joint: int | None = None  # place among the contacts

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
    bare = replace(linkage, springs=(), loads=(), clearances=())
    elements = []
    for spring in linkage.springs:
        alone = replace(bare, springs=(spring,))
        elements.append(
            _Element(f"spring {spring.name}", BodyForces(alone, pack(alone)))
        )
    for k, load in enumerate(linkage.live_loads):
        alone = replace(bare, loads=(load,))
        loads = records.packed.loads
        assert loads is not None
        part = loads._replace(
            records=loads.records[k : k + 1], modes=loads.modes[k : k + 1]
        )
        name = getattr(load, "name", "") or f"on {load.body}"
        forces = BodyForces(alone, pack(alone)._replace(loads=part))
        elements.append(_Element(f"{type(load).__name__.lower()} {name}", forces))
    joints = replace(bare, clearances=linkage.clearances)
    forces = BodyForces(joints, records.packed._replace(loads=None), records.onset)
    for k, joint in enumerate(linkage.clearances):
        elements.append(_Element(f"joint {joint.name}", forces, k))
    return elements
