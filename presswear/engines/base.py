"""The start, the plan and the outcome of a run, the same for every engine."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from presswear.linkage.linkage import Linkage
from presswear.linkage.loads import Force
from presswear.physics.energy import SETTLED
from presswear.physics.loads import place_loads
from presswear.recording.observe import ROWS_AT_LEAST
from presswear.recording.observer import Observer
from presswear.recording.recorder import Recorder
from presswear.recording.soundness import Finding
from presswear.tools.arrays import State

Array = NDArray[np.float64]

Status = Literal["completed", "enough", "failed"]


@dataclass(frozen=True)
class Start:
    """Initial state: coordinates and rates of all bodies, each (3 bodies,), at t = 0."""

    position: Array
    velocity: Array


@dataclass(frozen=True)
class Plan:
    """Duration of a run and the results to store."""

    cycle: float  # duration, s
    cycles: int  # at most
    recorded_cycles: int = 5  # at the start, whose series and single contacts are stored
    rows_per_cycle: int = ROWS_AT_LEAST  # of a series, at least
    # Parts of each cycle at which its state is stored and a step ends, rising, above 0 up to 1
    sections: tuple[float, ...] = ()
    torques: bool = True  # whether the series hold the torques of the drives
    observers: tuple[Observer, ...] = ()  # notified after each cycle; each can end the run
    # Called many times a second with the completed fraction, 0 to 1, and the recorder
    report: Callable[[float, Recorder], object] = lambda part, recorder: None
    # Returns the depth, m, that the surfaces lose after a cycle, from the number of cycles and the
    # depth that the last one added, both of shape (joints, 2, m); None: the surfaces stay.
    wear: Callable[[int, Array], Array] | None = None
    resume: State | None = None  # of a run with the same linkage, start, engine and plan
    run_up: float = 0.0  # time before the first cycle, s; it is in the series, and in no cycle
    stroke: tuple[float, float] | None = None  # see ``Recorder.of``

    @property
    def duration(self) -> float:
        """Time of the most cycles, s."""
        return self.run_up + self.cycle * self.cycles

    @property
    def settled(self) -> float:
        """Time from which the energies of a run are judged, s."""
        return self.run_up + SETTLED * self.cycle

    def advanced(self, time: float, recorder: Recorder) -> None:
        """Report the time reached, s."""
        self.report(min(time / self.duration, 1.0), recorder)


@dataclass(frozen=True)
class Run:
    """The outcome of one run of an engine."""

    status: Status  # enough: ended by an observer before the most cycles
    finding: Finding | None  # what ended a run that failed
    recorder: Recorder
    end: Start
    time: float  # simulated, s
    # Steps, Newton iterations, wall time by stage and the like
    diagnostics: dict[str, float | int | str] = field(default_factory=dict)

    @property
    def message(self) -> str:
        """A line on what went wrong, or nothing."""
        return self.finding.words if self.finding else ""


def recorder_of(linkage: Linkage, start: Start, plan: Plan) -> Recorder:
    """The empty recorder of a run, the modes of its loads those of the start."""
    recorder = Recorder.of(
        linkage,
        start.position,
        plan.recorded_cycles,
        plan.cycle,
        torques=plan.torques,
        wearing=plan.wear is not None,
        run_up=plan.run_up,
        stroke=plan.stroke,
        rows_per_cycle=plan.rows_per_cycle,
        sections=len(plan.sections),
    )
    loads = recorder.records.packed.loads
    if loads is not None:
        place_loads(loads, start.position, start.velocity)
    return recorder


def described(linkage: Linkage, model: str, prescribed: Iterable[str] = ()) -> str:
    """A sentence on the model that was built.

    Parameters
    ----------
    model : str
        The coordinates and joints that the engine solves for.
    prescribed : iterable of str
        Bodies whose motion is prescribed, which it does not solve for.
    """
    names = sorted(prescribed)
    if names:
        model = f"{model}, {listed(names)} prescribed"
    named = [load.name for load in linkage.live_loads if isinstance(load, Force) and load.name]
    if named:
        model = f"{model}; forces: {', '.join(named)}"
    joints = linkage.clearances
    if not joints:
        return f"{model}; clearance: none"
    friction = any(joint.friction.coefficient > 0.0 for joint in joints)
    worn = any(joint.bearing_surface.is_worn or joint.pin_surface.is_worn for joint in joints)
    wear = any(joint.wear is not None for joint in joints)
    return (
        f"{model}; clearance: {', '.join(joint.name for joint in joints)}; "
        f"friction {'on' if friction else 'off'}; "
        f"surfaces {'worn' if worn else 'round'}; wear account {'on' if wear else 'off'}"
    )


def listed(names: Iterable[str]) -> str:
    """Names in a sentence: ``a``, ``a and b``, ``a, b and c``."""
    *most, last = names
    return f"{', '.join(most)} and {last}" if most else last
