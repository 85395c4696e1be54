"""Wall times of runs, interleaved so that a slow minute of the machine hits all alike.

Only the solve is timed (``wall_solve_s``): compiling, loading and building are not.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from statistics import median
from typing import ClassVar

from presswear.engines.base import Plan, Run, Start
from presswear.engines.settings import Engine, ExudynJoints, ExudynTree
from presswear.linkage.linkage import Linkage
from presswear.linkage.topology import bodies_of, joints_of
from presswear.physics.tree import Tree, tree_of
from presswear.tools.errors import RunFailed
from presswear.validation.runs import Told, finished


@dataclass(frozen=True)
class TimedRun:
    """A run to be timed."""

    name: str
    linkage: Linkage
    start: Start
    engine: Engine
    plan: Plan

    def run(self) -> Run:
        """Run it once; RunFailed if it fails."""
        return finished(self.engine.simulate(self.linkage, self.start, self.plan), self.name)


@dataclass(frozen=True)
class Timing:
    """Repeated runs that all took the same steps.

    Attributes
    ----------
    simulated : float
        Simulated time, s.
    steps, sent_back : int
        Accepted steps, and further ones that were repeated with a shorter length.
    evaluations : int or None
        Evaluations of the accelerations, where the engine counts them.
    walls : tuple of float
        Wall times of the solve, s.
    """

    DERIVED: ClassVar = ("wall", "per_second", "per_step")

    name: str
    model: str
    simulated: float
    steps: int
    sent_back: int
    evaluations: int | None
    walls: tuple[float, ...]

    @property
    def attempts(self) -> int:
        """Number of steps tried."""
        return self.steps + self.sent_back

    @property
    def wall(self) -> float:
        """Median wall time, s."""
        return median(self.walls)

    @property
    def ends(self) -> tuple[float, float]:
        """Least and greatest wall time, s."""
        return min(self.walls), max(self.walls)

    @property
    def per_second(self) -> float:
        """Wall time per simulated second, s/s."""
        return self.wall / self.simulated

    @property
    def per_step(self) -> float:
        """Wall time per attempted step, s."""
        return self.wall / max(self.attempts, 1)


def model_of(linkage: Linkage, engine: Engine) -> str:
    """Name the model that solves a linkage: its coordinates, and constraints where it has any."""
    if isinstance(engine, ExudynTree):
        tree = tree_of(linkage)
        return f"tree {tree.size if isinstance(tree, Tree) else 0}"
    omitted, word = frozenset[str](), "dae"
    if isinstance(engine, ExudynJoints):
        from presswear.engines.exudyn_joints.model import left_out

        omitted, word = left_out(linkage), "joints"
    joints = sum(not bodies_of(joint) <= omitted for joint in joints_of(linkage))
    drives = sum(drive.body not in omitted for drive in linkage.drives)
    return f"{word} {3 * (len(linkage.bodies) - len(omitted))} + {2 * joints + drives}"


def time_runs(runs: Sequence[TimedRun], repeats: int, told: Told) -> tuple[Timing, ...]:
    """Run all in turn, as often as asked.

    RunFailed where a run fails, or a repeat takes other steps than the first.
    """
    found: dict[int, Timing] = {}
    for repeat in range(repeats):
        for i, timed in enumerate(runs):
            told(timed.name, (repeat * len(runs) + i) / (repeats * len(runs)))
            run = timed.run()
            evaluations = run.diagnostics.get("evaluations")
            now = Timing(
                timed.name,
                model_of(timed.linkage, timed.engine),
                run.time,
                int(run.diagnostics["steps"]),
                int(run.diagnostics["steps_sent_back"]),
                None if evaluations is None else int(evaluations),
                (float(run.diagnostics["wall_solve_s"]),),
            )
            before = found.setdefault(i, replace(now, walls=()))
            if replace(now, walls=before.walls) != before:
                raise RunFailed(f"{timed.name}: a repeated run took other steps")
            found[i] = replace(now, walls=(*before.walls, *now.walls))
    return tuple(found.values())
