"""What every engine takes and gives back."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from presswear.linkage.elements import Linkage
from presswear.record.recorder import Account
from presswear.record.soundness import Condition, Finding, examine
from presswear.tools.snapshot import Snapshot

Array = NDArray[np.float64]

Status = Literal["completed", "enough", "failed"]


@dataclass(frozen=True)
class Start:
    """Initial state: coordinates and rates of all bodies, each (3 bodies,), at t = 0."""

    position: Array
    velocity: Array


@dataclass(frozen=True)
class Plan:
    """How long to run and what to keep.

    Attributes
    ----------
    cycle : float
        Duration of one cycle, s.
    cycles : int
        Most cycles to run.
    recorded_cycles : int
        Cycles at the start whose series and episodes are kept.
    torques : bool
        Whether the series hold the torques of the drives.
    enough : callable
        Asked after each cycle; True ends the run.
    progress : callable
        Told the part of the most cycles that is done, 0 .. 1, many times a second.
    begun : callable
        Told the account that the run fills, before it begins.
    resume : Snapshot or None
        State to go on from, of a run with the same linkage, start, accuracy and plan.
    keep : callable or None
        Told the state after each cycle, from which another process can go on.
    """

    cycle: float
    cycles: int
    recorded_cycles: int = 5
    torques: bool = True
    enough: Callable[[Account], bool] = lambda account: False
    progress: Callable[[float], None] = lambda part: None
    begun: Callable[[Account], None] = lambda account: None
    resume: Snapshot | None = None
    keep: Callable[[Snapshot], None] | None = None


@dataclass(frozen=True)
class Run:
    """What one engine run gave.

    Attributes
    ----------
    status : {"completed", "enough", "failed"}
        ``enough``: ended by the plan's question before the most cycles.
    finding : Finding or None
        What ended a run that failed.
    account : Account
        Everything observed.
    end : Start
        State at the end.
    time : float
        Simulated time, s.
    reactions : dict
        Of each ideal joint at the end: force (x, y) of a revolute on its first body, N;
        normal force, N, and moment, N m, of a guide; torque of a drive, N m.
    diagnostics : dict
        Steps, Newton iterations, wall time by stage and the like.
    """

    status: Status
    finding: Finding | None
    account: Account
    end: Start
    time: float
    reactions: dict[str, tuple[float, ...]]
    diagnostics: dict[str, float | int | str] = field(default_factory=dict)

    @property
    def message(self) -> str:
        """What went wrong, in a line, or nothing."""
        return self.finding.words if self.finding else ""


def account_of(linkage: Linkage, start: Start, plan: Plan) -> Account:
    """The empty account of a run."""
    account = Account.of(
        linkage, start.position, plan.recorded_cycles, plan.cycle, torques=plan.torques
    )
    plan.begun(account)
    return account


def run_cycles(
    linkage: Linkage,
    account: Account,
    plan: Plan,
    advance: Callable[[float], Finding | None],
    condition: Callable[[], Condition],
    snapshot: Callable[[], Snapshot],
) -> tuple[Status, Finding | None]:
    """Run cycle by cycle; returns how it ended and what went wrong, if anything.

    Every cycle begins in the same way from the state that the last one left, whether this
    process computed that or read it: a run that was killed and goes on gives the same numbers.

    Parameters
    ----------
    advance : callable
        Integrates up to a time, s; returns what went wrong, if anything.
    condition : callable
        How the run stands after a cycle, which is examined.
    snapshot : callable
        The state of the whole run between two cycles.
    """
    while True:
        done = len(account.cycles)
        if done > 0:
            if plan.keep is not None:
                plan.keep(snapshot())
            if done >= plan.cycles:
                return "completed", None
            if plan.enough(account):
                return "enough", None
        finding = advance(plan.cycle * (done + 1)) or examine(linkage, account, condition())
        if finding:
            return "failed", finding
        account.end_cycle()
        if done + 1 == plan.recorded_cycles:
            account.stop_recording()


def described(linkage: Linkage, model: str) -> str:
    """What was modelled, in a sentence.

    Parameters
    ----------
    model : str
        The coordinates and joints that the engine solves for.
    """
    opened = ", ".join(joint.name for joint in linkage.clearances) or "none"
    friction = any(joint.friction.coefficient > 0.0 for joint in linkage.clearances)
    worn = any(
        surface.is_worn
        for joint in linkage.clearances
        for surface in (joint.bearing_surface, joint.pin_surface)
    )
    wear = any(joint.wear is not None for joint in linkage.clearances)
    if not linkage.clearances:
        return f"{model}; clearance: none"
    return (
        f"{model}; clearance: {opened}; friction {'on' if friction else 'off'}; "
        f"surfaces {'worn' if worn else 'round'}; wear account {'on' if wear else 'off'}"
    )


def listed(names: Iterable[str]) -> str:
    """Names in a sentence: ``a``, ``a and b``, ``a, b and c``."""
    *most, last = names
    return f"{', '.join(most)} and {last}" if most else last
