"""The watch on every run: what makes its numbers worthless, when, where, and what may help.

Each limit lies far beyond what a sound run shows and before what would be nonsense, so
that a run ends where one is passed.
"""

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from presswear.linkage.linkage import Linkage
from presswear.physics.constraints import Constraints
from presswear.physics.energy import Ledger, made_remedy
from presswear.physics.packed import mass_of
from presswear.recording.recorder import Recorder

Array = NDArray[np.float64]

Kind = Literal["state", "energy", "steps", "constraints", "penetration", "wear"]

RESIDUAL = 3e-3
"""Energy that does not add up, part of what the drives exchanged, at most."""
RESIDUAL_LOST = 1e-2
"""The same, part of what damping and friction turned into heat: wear is no better known than that.
A pin that vibrates under load passes energy to and fro, up to a hundred times what is lost."""
RESIDUAL_LEAST = 1e-4
"""Part of the energy exchanged that may be missing in any case: below 1e-7 at the tolerances of a
trajectory, 2e-5 at the coarsest steps that bodies and joints may take, some 1e-5 for wear."""
UNEXCHANGED = 1e-3
"""Part of the kinetic energy that counts as exchanged at least: in a moment hardly any is."""
MADE = 1.0
"""Energy that the normal law made, part of what damping and friction turned into heat: beyond
all of it the contacts drive the linkage."""
MADE_LEAST = 1e-3
"""Part of the energy exchanged that may be made in any case."""
UNRESOLVED = 0.5
"""Contacts of fewer than LEAST_STEPS steps, part of all: grazing touches are a few in a hundred."""
FEWEST_CONTACTS = 20
"""Contacts of a joint before that is judged."""
DRIFT = 0.01
"""Error of a constraint, m or rad, part of the smallest clearance."""
DRIFT_LEAST = 1e-7
"""Error that harms no linkage, however small its clearance, m or rad."""
DRIFT_IDEAL = 1e-4
"""The same where there is no clearance, m."""


@dataclass(frozen=True)
class Finding:
    """Something that ends a run; its fields are the names in ``result.json``.

    Attributes
    ----------
    kind : Kind
    what : str
        With values and limits.
    time_s : float
        Since the run began, s.
    joint : str
        Where, or nothing where no single joint can be blamed.
    remedy : str
        What may help.
    """

    kind: Kind
    what: str
    time_s: float
    joint: str
    remedy: str

    @property
    def words(self) -> str:
        """In a line."""
        where = f"joint {self.joint}: " if self.joint else ""
        remedy = f"; {self.remedy}" if self.remedy else ""
        return f"{where}{self.what} (t = {self.time_s:.6g} s){remedy}"


@dataclass(frozen=True)
class Condition:
    """How a run stands after a cycle.

    Attributes
    ----------
    time : float
        s.
    ledger : Ledger
        Energies since the run began.
    position, velocity : ndarray, shape (3 bodies,)
    remedy : str
        What makes the steps of this engine finer.
    constraints : Constraints or None
        What may drift; None where the coordinates leave no room for it.
    """

    time: float
    ledger: Ledger
    position: Array
    velocity: Array
    remedy: str
    constraints: Constraints | None = None


def examine(linkage: Linkage, recorder: Recorder, now: Condition) -> Finding | None:
    """The first thing that makes a run worthless after a cycle, if any."""
    return (
        _state(now)
        or _penetration(linkage, recorder, now)
        or _steps(linkage, recorder, now)
        or _energy(linkage, recorder, now)
        or _constraints(linkage, now)
    )


def _state(now: Condition) -> Finding | None:
    if np.isfinite(now.position).all() and np.isfinite(now.velocity).all():
        return None
    return Finding("state", "the state is no longer finite", now.time, "", now.remedy)


def _penetration(linkage: Linkage, recorder: Recorder, now: Condition) -> Finding | None:
    for joint, tally in zip(linkage.clearances, recorder.book.tally, strict=True):
        deepest, limit = float(tally["deepest"]), joint.pin_radius
        if deepest > limit:
            what = (
                f"the pin sank {deepest:.3g} m into its bearing, more than its own radius of "
                f"{limit:.3g} m"
            )
            remedy = f"a stiffer joint, a lower speed, or {now.remedy}"
            return Finding("penetration", what, now.time, joint.name, remedy)
    return None


def _steps(linkage: Linkage, recorder: Recorder, now: Condition) -> Finding | None:
    for joint, tally in zip(linkage.clearances, recorder.book.tally, strict=True):
        contacts, coarse = int(tally["contacts"]), int(tally["unresolved"])
        if contacts >= FEWEST_CONTACTS and coarse > UNRESOLVED * contacts:
            what = (
                f"the steps are too long for the contacts: {coarse} of {contacts} had too few, "
                f"the least {int(tally['fewest_steps'])}"
            )
            return Finding("steps", what, now.time, joint.name, now.remedy)
    return None


def _energy(linkage: Linkage, recorder: Recorder, now: Condition) -> Finding | None:
    residual, made = now.ledger.residual, now.ledger.made
    if now.ledger.drive_exchange <= 0.0:
        return None
    kinetic = 0.5 * float(mass_of(linkage) @ now.velocity**2)
    # Where a weight falls from rest, what its fall turns into heat is all that is exchanged.
    exchange = max(now.ledger.drive_exchange, now.ledger.dissipated, UNEXCHANGED * kinetic)
    lost = now.ledger.dissipated
    limit = min(RESIDUAL * exchange, max(RESIDUAL_LOST * lost, RESIDUAL_LEAST * exchange))
    if abs(residual) > limit:
        what = (
            f"{residual:.3g} J do not add up, limit {limit:.3g} J: the drives exchanged "
            f"{exchange:.3g} J, damping and friction took {lost:.3g} J"
        )
        return Finding("energy", what, now.time, "", now.remedy)
    limit = max(MADE * now.ledger.dissipated, MADE_LEAST * exchange)
    if made > limit:
        what = (
            f"the contacts made {made:.3g} J, limit {limit:.3g} J: damping and friction took "
            f"{now.ledger.dissipated:.3g} J"
        )
        remedy = made_remedy(recorder.book.packed, now.remedy)
        return Finding("energy", what, now.time, "", remedy)
    return None


def _constraints(linkage: Linkage, now: Condition) -> Finding | None:
    constraints = now.constraints
    if constraints is None or constraints.rows == 0:
        return None
    error = np.abs(constraints.evaluate(now.time, now.position, now.velocity)[0])
    worst = int(error.argmax())
    clearance = min((joint.clearance for joint in linkage.clearances), default=math.inf)
    limit = max(DRIFT * clearance, DRIFT_LEAST) if clearance < math.inf else DRIFT_IDEAL
    if error[worst] <= limit:
        return None
    what = f"the joint has drifted apart by {error[worst]:.3g} m or rad, limit {limit:.3g}"
    return Finding("constraints", what, now.time, constraints.names[worst], now.remedy)
