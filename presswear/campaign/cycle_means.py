"""Means over the cycles of a stage, from the recorders of its replicates."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from presswear.recording.columns import Column, with_mean
from presswear.recording.recorder import Recorder
from presswear.recording.statistics import Estimate, after_startup, pooled
from presswear.tools.arrays import Array

Recorders = Sequence[Recorder]


@dataclass(frozen=True)
class CycleMeans:
    """Means over cycles with their intervals."""

    recorders: Recorders  # of runs whose cycles are samples
    # of runs that are single samples, because each has different surfaces; see ``pooled``
    alone: Recorders = ()
    # False: replicates settle on different motions, or surfaces are rough, so that the
    # interval of a peak is not valid
    has_peak_intervals: bool = True

    def pooled(self, values: Callable[[Recorder], Array]) -> Estimate:
        """Return the mean of values of each cycle with its interval."""
        runs = [values(run) for run in self.recorders]
        single_samples = [values(run) for run in self.alone]
        mean, _ = pooled(runs, single_samples)
        return mean

    def mean(self, name: str, joint: int | None = None) -> Estimate:
        """Return the mean of a recorded number with its interval."""
        return self.pooled(lambda run: run.each_cycle(name, joint))

    def peak(self, name: str, joint: int | None = None) -> Estimate:
        """Return the mean of a number that depends on the motion, such as a peak."""
        mean = self.mean(name, joint)
        return mean if self.has_peak_intervals else mean.without_interval

    def declared(
        self, columns: tuple[Column, ...], joint: int | None = None
    ) -> dict[str, Estimate]:
        """Return the means of the columns that declare a mean, by name."""
        names = [column.name for column in with_mean(columns)]
        return {name: self.peak(name, joint) for name in names}

    def largest(self, name: str, joint: int | None = None, sign: float = 1.0) -> float:
        """Return the largest value of a number times ``sign`` after the start-up."""
        runs = [after_startup(run.each_cycle(name, joint)) for run in self.recorders]
        return max(float((sign * values).max()) for values in runs)

    @property
    def cycle_time(self) -> float:
        """Mean duration of a cycle, s; with a motor the durations differ."""
        first = self.recorders[0]
        if first.has_leader:
            return self.mean("duration").mean
        return float(first.records.output["period"][0])

    @property
    def drive_work(self) -> Estimate:
        """Mean drive work of a cycle, J.

        The samples are the drive work minus the change of stored energy. Their mean over
        many cycles is that of the drive work. They scatter less, because energy that is
        stored at the end of a cycle is returned in the next one.
        """
        return self.pooled(
            lambda run: (
                run.each_cycle("drive_work") - run.each_cycle("stored_energy_change")
            )
        )
