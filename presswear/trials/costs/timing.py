"""Wall times of runs, interleaved so that a slow minute of the machine hits all alike.

Only the solve is timed (``wall_solve_s``): compiling, loading and building are not.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from statistics import median

from presswear.campaign.starts import start_of
from presswear.engines.base import Plan, Run, Start
from presswear.engines.settings import Engine, ExudynJoints, ExudynTree
from presswear.linkage.elements import Linkage
from presswear.linkage.surface import Surface
from presswear.physics.tree import Tree, tree_of
from presswear.scene.scene import Scene
from presswear.tools.errors import RunFailed

Progress = Callable[[str, float], None]
"""Told what is being run and which part of it is done, 0 .. 1."""

Worn = dict[str, tuple[Surface, Surface]]

WARM_UP_PART = 0.05
"""Part of a run's time that is run beforehand and thrown away."""


@dataclass(frozen=True)
class Case:
    """A run to be timed."""

    name: str
    linkage: Linkage
    start: Start
    accuracy: Engine
    plan: Plan

    def run(self) -> Run:
        """Run it once; RunFailed if it fails."""
        run = self.accuracy.simulate(self.linkage, self.start, self.plan)
        if run.status == "failed":
            raise RunFailed(f"{self.name}: {run.message}")
        return run

    def warm_up(self) -> None:
        """Compile, load and touch everything that a timed run needs."""
        short = replace(self.plan, cycle=WARM_UP_PART * self.plan.cycle, cycles=1)
        replace(self, plan=short).run()


@dataclass(frozen=True)
class Timing:
    """Repeated runs of one case, which all took the same steps.

    Attributes
    ----------
    name, model : str
    simulated : float
        s.
    steps, sent_back : int
        Accepted steps, and further ones that were repeated with a shorter length.
    walls : tuple of float
        Wall times of the solve, s.
    """

    name: str
    model: str
    simulated: float
    steps: int
    sent_back: int
    walls: tuple[float, ...]

    @property
    def attempts(self) -> int:
        """Steps tried."""
        return self.steps + self.sent_back

    @property
    def wall(self) -> float:
        """Median wall time, s."""
        return median(self.walls)

    @property
    def per_second(self) -> float:
        """Wall time per simulated second, s/s."""
        return self.wall / self.simulated

    @property
    def per_step(self) -> float:
        """Wall time per attempted step, s."""
        return self.wall / self.attempts

    @property
    def step_spread(self) -> tuple[float, float]:
        """Least and greatest wall time per attempted step, s."""
        return min(self.walls) / self.attempts, max(self.walls) / self.attempts

    @property
    def steps_per_second(self) -> float:
        """Attempted steps per simulated second, 1/s."""
        return self.attempts / self.simulated


def plan_of(period: float, cycles: float, torques: bool = False) -> Plan:
    """All recorded: so many whole cycles, or a part of one below 1."""
    if cycles < 1.0:
        return Plan(cycles * period, 1, 1, torques=torques)
    return Plan(period, int(cycles), int(cycles), torques=torques)


def case_of(name: str, scene: Scene, cycles: float, worn: Worn | None = None) -> Case:
    """A scene as a case, on unworn or worn surfaces."""
    plan = plan_of(scene.mechanism.period, cycles, scene.drive_torque == "on")
    return Case(
        name, scene.linkage(worn), start_of(scene), scene.solver.over(scene.mechanism.period), plan
    )


def model_of(linkage: Linkage, accuracy: Engine) -> str:
    """Which model solves a linkage: its coordinates, and constraints where it has any."""
    if isinstance(accuracy, ExudynTree):
        tree = tree_of(linkage)
        count = len(tree.links) if isinstance(tree, Tree) else 0
        return f"tree {count}"
    bodies, hinges, drives = len(linkage.bodies), len(linkage.revolutes), len(linkage.drives)
    word = "dae"
    if isinstance(accuracy, ExudynJoints):
        from presswear.engines.exudyn_joints.model import left_out

        # With a crank its hinge and its drive are left out.
        omitted = len(left_out(linkage))
        bodies, hinges, drives = bodies - omitted, hinges - omitted, drives - omitted
        word = "joints"
    constraints = 2 * hinges + 2 * len(linkage.guides) + drives
    return f"{word} {3 * bodies} + {constraints}"


def time_cases(cases: Sequence[Case], repeats: int, progress: Progress) -> tuple[Timing, ...]:
    """Run all cases in turn, as often as asked.

    Raises
    ------
    RunFailed
        Where a run fails, or a repeat takes other steps than the first.
    """
    walls: list[list[float]] = [[] for _ in cases]
    taken: list[tuple[float, int, int]] = []
    for repeat in range(repeats):
        for i, case in enumerate(cases):
            progress(case.name, (repeat * len(cases) + i) / (repeats * len(cases)))
            run = case.run()
            steps = int(run.diagnostics["steps"]), int(run.diagnostics["steps_sent_back"])
            if repeat == 0:
                taken.append((run.time, *steps))
            elif taken[i] != (run.time, *steps):
                raise RunFailed(f"{case.name}: a repeated run took other steps")
            walls[i].append(float(run.diagnostics["wall_solve_s"]))
    return tuple(
        Timing(case.name, model_of(case.linkage, case.accuracy), *numbers, tuple(spent))
        for case, numbers, spent in zip(cases, taken, walls, strict=True)
    )
