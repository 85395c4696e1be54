"""Means over the cycles of a stage, from the recorders of its replicates.

``recorders`` are those of runs whose cycles are samples. ``alone`` are those of runs that
are single samples, because each has different surfaces; see ``pooled``.
"""

from collections.abc import Callable, Sequence

from presswear.recording.columns import Column, with_mean
from presswear.recording.recorder import Recorder
from presswear.recording.statistics import Estimate, after_startup, pooled
from presswear.tools.arrays import Array

Recorders = Sequence[Recorder]
Mean = Callable[[Recorders, Recorders, str, int | None], Estimate]


def mean_over_cycles(
    recorders: Recorders, alone: Recorders, name: str, joint: int | None = None
) -> Estimate:
    """Return the mean over cycles of a quantity with its interval; see ``pooled``."""
    return _pooled_mean(recorders, alone, lambda run: run.each_cycle(name, joint))


def _pooled_mean(
    recorders: Recorders, alone: Recorders, values: Callable[[Recorder], Array]
) -> Estimate:
    series = [values(run) for run in recorders]
    single_samples = [values(run) for run in alone]
    mean, _ = pooled(series, single_samples)
    return mean


def mean_without_interval(
    recorders: Recorders, alone: Recorders, name: str, joint: int | None = None
) -> Estimate:
    """Return the mean over cycles without an interval.

    An interval is not valid if replicates settle on different motions, and on rough
    surfaces.
    """
    return mean_over_cycles(recorders, alone, name, joint).without_interval


def declared_means(
    mean: Mean,
    recorders: Recorders,
    alone: Recorders,
    columns: tuple[Column, ...],
    joint: int | None = None,
) -> dict[str, Estimate]:
    """Return the means over cycles of the columns that declare a mean, by name."""
    return {
        column.name: mean(recorders, alone, column.name, joint)
        for column in with_mean(columns)
    }


def largest_value(
    recorders: Recorders, name: str, joint: int | None = None, sign: float = 1.0
) -> float:
    """Return the largest value of a quantity times ``sign`` after the start-up."""
    samples = (
        after_startup(recorder.each_cycle(name, joint)) for recorder in recorders
    )
    return max(float((sign * rows).max()) for rows in samples)


def mean_cycle_time(recorders: Recorders, alone: Recorders) -> float:
    """Return the mean duration of a cycle, s; with a motor the durations differ."""
    if recorders[0].has_leader:
        return mean_over_cycles(recorders, alone, "duration").mean
    return float(recorders[0].records.output["period"][0])


def mean_drive_work(recorders: Recorders, alone: Recorders) -> Estimate:
    """Return the mean drive work of a cycle, J.

    The samples are the drive work minus the change of stored energy. Their mean over many
    cycles is that of the drive work. They scatter less, because energy that is stored at
    the end of a cycle is returned in the next one.
    """

    def used_energy(run: Recorder) -> Array:
        return run.each_cycle("drive_work") - run.each_cycle("stored_energy_change")

    return _pooled_mean(recorders, alone, used_energy)
