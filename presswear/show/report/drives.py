"""Table of the report on the drives: torque, power and energy beside those of ideal joints."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from presswear.recording.soundness import RESIDUAL
from presswear.recording.statistics import Estimate
from presswear.results.drives import (
    ENERGY_BOUND,
    DriveDuty,
    drives_of,
    energy_of,
    ideal_drives,
)
from presswear.results.result import Result
from presswear.show.figures.style import stage_names
from presswear.show.report.parts import Rows, Table, column_table
from presswear.tools.numbers import given, readable, with_interval


@dataclass(frozen=True)
class _Column:
    """A stage, or the ideal motion."""

    duties: Mapping[str, DriveDuty]
    drives: Estimate | float | None
    residual: float | None = None


def drives(result: Result) -> Table | None:
    """What the overview leaves of each drive, with clearance and without; None if not stored.

    None too where ideal torques would execute source code stored in the result.
    """
    if result.scene.has_untrusted_loads:
        return None
    scene, heads, columns = result.scene, [], []
    for name, stage in zip(stage_names(result, result.stages), result.stages, strict=True):
        found, energy = drives_of(scene, stage), energy_of(scene, stage)
        if not found:
            continue
        told = {body: own.duty for body, own in found.items()}
        heads.append(name)
        if energy is None:
            columns.append(_Column(told, None))
        else:
            columns.append(_Column(told, energy.drives_J, energy.residual_part))
    if not columns:
        return None
    ideal = ideal_drives(scene)
    columns.append(_Column(ideal, sum(own.work_J for own in ideal.values())))
    unbalanced = (
        "part of the energy exchanged that is missing (at the tolerances of a trajectory below "
        f"{given(ENERGY_BOUND)}, of wear some {given(10.0 * ENERGY_BOUND)}; beyond "
        f"{given(RESIDUAL)} a run is ended)"
    )
    groups = {f"Drive of {body}": _rows(body) for body in ideal}
    groups["A part, which is a cycle"] = {
        "net work of all drives (J)": lambda own: _energy(own.drives),
        unbalanced: lambda own: readable(own.residual, 2),
    }
    return column_table("drives", [*heads, "ideal joints"], columns, groups)


def _rows(body: str) -> Rows[_Column]:
    def number(own: Callable[[DriveDuty], float]) -> Callable[[_Column], str]:
        return lambda column: readable(own(column.duties[body]))

    return {
        "torque, mean (N m)": number(lambda own: own.torque.mean),
        "power, mean (W)": number(lambda own: own.power.mean),
        "power, rms (W)": number(lambda own: own.power.rms),
        "power, largest (W)": number(lambda own: own.power.peak),
        "share of rms torque (%)": number(lambda own: 100.0 * own.share.rms_torque),
        "share of peak power (%)": number(lambda own: 100.0 * own.share.peak_power),
        "share of energy given (%)": number(lambda own: 100.0 * own.share.energy),
    }


def _energy(told: Estimate | float | None) -> str:
    if isinstance(told, Estimate):
        return with_interval(told.mean, told.half_width)
    return readable(told, 4)
