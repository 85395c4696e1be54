"""Wall times of runs, interleaved so that a slow minute of the machine affects all runs alike.

Only the solution is timed; compiling, loading and building the model are not.
"""

import csv
import io
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from statistics import median

from presswear.engines.base import Plan, Run, Start
from presswear.engines.settings import Engine
from presswear.linkage.linkage import Linkage
from presswear.tools.errors import RunFailed
from presswear.tools.files import write_bytes
from presswear.validation.cases import Progress, finished


@dataclass(frozen=True)
class TimedRun:
    """Run to be timed."""

    name: str
    linkage: Linkage
    start: Start
    engine: Engine
    plan: Plan

    def run(self) -> Run:
        """Run once; RunFailed if the run fails."""
        return finished(self.engine.simulate(self.linkage, self.start, self.plan), self.name)


@dataclass(frozen=True)
class Timing:
    """Repeated runs with equal steps."""

    model: str  # coordinates and joints that the engine solves for
    simulated: float  # simulated time, s
    steps: int
    rejected: int  # steps that were repeated with a shorter length
    evaluations: int | None  # of the accelerations, if the engine counts them
    walls: tuple[float, ...]  # wall times of the solution, s

    @property
    def wall(self) -> float:
        """Least wall time, s: other programs only make runs longer."""
        return min(self.walls)

    @property
    def per_second(self) -> float:
        """Wall time per simulated second, s/s."""
        return self.wall / self.simulated

    @property
    def per_step(self) -> float:
        """Wall time per attempted step, s."""
        return self.wall / max(self.steps + self.rejected, 1)

    def columns(self) -> dict[str, object]:
        """Return the columns of a table."""
        walls = {"wall_s": self.wall, "wall_median_s": median(self.walls)}
        counts = {"steps": self.steps, "rejected_steps": self.rejected}
        return {**counts, "evaluations": self.evaluations, **walls, "wall_max_s": max(self.walls)}


def time_runs(runs: Sequence[TimedRun], repeats: int, report: Progress) -> list[Timing]:
    """Run all in turn, ``repeats`` times.

    `RunFailed` if a run fails, or if a repeat takes other steps than the first run.
    """
    timings: list[Timing] = []
    for repeat in range(repeats):
        for i, timed in enumerate(runs):
            report(timed.name, (repeat * len(runs) + i) / (repeats * len(runs)))
            run = timed.run()
            numbers, evaluations = run.diagnostics, run.diagnostics.get("evaluations")
            timing = Timing(
                str(numbers["model"]).partition(";")[0],
                run.time,
                int(numbers["steps"]),
                int(numbers["steps_sent_back"]),
                None if evaluations is None else int(evaluations),
                (float(numbers["wall_solve_s"]),),
            )
            if repeat == 0:
                timings.append(timing)
                continue
            first = timings[i]
            if replace(timing, walls=first.walls) != first:
                raise RunFailed(f"{timed.name}: a repeated run took other steps")
            timings[i] = replace(first, walls=(*first.walls, *timing.walls))
    return timings


def write_csv(rows: Sequence[Mapping[str, object]], file: Path) -> None:
    """Write a table; the columns are those of all rows."""
    text = io.StringIO()
    writer = csv.DictWriter(text, {name: None for row in rows for name in row})
    writer.writeheader()
    writer.writerows(rows)
    write_bytes(file, text.getvalue().encode())
