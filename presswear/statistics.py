"""Numbers of a stage, ready for ``result.json``.

Peaks of a whole run are one draw of a chaotic motion; beside them stand means over cycles
and the intervals of ``sampling``.
"""

from dataclasses import asdict
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswear.linkage import ClearanceJoint, Linkage
from presswear.observe import CYCLE_FIXED, CYCLE_JOINT, Account
from presswear.sampling import Interval, estimate, half_width, peak_of, resampled
from presswear.surface import bin_centres
from presswear.wear import worn_volume

Array = NDArray[np.float64]


def ends(interval: Interval, factor: float = 1.0) -> list[float] | None:
    """Both ends of an interval in another unit; None where it has none."""
    if interval.low is None or interval.high is None:
        return None
    return [factor * interval.low, factor * interval.high]


def joint_statistics(
    joint: ClearanceJoint, k: int, account: Account, added: Array, maps: Array
) -> dict[str, Any]:
    """Numbers of one clearance joint.

    Parameters
    ----------
    added : ndarray, shape (2, m)
        Depth of one wear, bearing and pin, m.
    maps : ndarray, shape (n, 2, m)
        The same by batches of cycles, of which it is the mean; none: no intervals.
    """
    rows = np.array(account.cycles)
    first = len(CYCLE_FIXED) + len(CYCLE_JOINT) * k
    force, dose = rows[:, first], rows[:, first + 1]
    tally = account.book.tally[k]
    contacts = int(tally["contacts"])
    numbers: dict[str, Any] = {
        "force_max_N": float(force.max()),
        "force_max_per_cycle_N": asdict(estimate(force)),
        "contacts": contacts,
        "contacts_per_cycle": asdict(estimate(np.diff(rows[:, first + 2], prepend=0.0))),
        "unresolved_contacts": int(tally["unresolved"]),
        "fewest_steps_in_a_contact": int(tally["fewest_steps"]) if contacts else None,
        "part_of_time_in_contact": float(tally["closed_time"]) / account.last_time,
        "dose_per_cycle_Nm": asdict(estimate(dose)),
        "wear_volume_m3": worn_volume(joint, added),
        "wear_volume_half_width_m3": half_width(np.array([worn_volume(joint, m) for m in maps])),
        "wear_map_error": float(account.maps.errors()[k]),
    }
    sides: dict[str, list[int]] = {"bearing": [0], "pin": [1]}
    if joint.map_frame == "fixed":
        sides["both"] = [0, 1]
    degrees = np.degrees(bin_centres(added.shape[1]))
    for name, some in sides.items():
        depth = added[some].sum(axis=0)
        numbers[f"wear_depth_max_{name}_m"] = float(depth.max())
        numbers[f"wear_depth_max_{name}_deg"] = float(degrees[int(depth.argmax())])
        if len(maps):
            own = maps[:, some].sum(axis=1)
            draws = resampled(own, np.ones(len(own)))
            peak = peak_of(own.mean(axis=0), draws, len(own))
            numbers[f"wear_depth_max_{name}_interval_m"] = ends(peak.depth)
            numbers[f"wear_depth_max_{name}_interval_deg"] = ends(peak.angle, np.degrees(1.0))
    return numbers


def stage_statistics(
    linkage: Linkage, account: Account, added: Array, maps: Array
) -> dict[str, Any]:
    """Numbers of one stage.

    Parameters
    ----------
    added : ndarray, shape (joints, 2, m)
    maps : ndarray, shape (n, joints, 2, m)
        As for ``joint_statistics``.
    """
    rows = np.array(account.cycles)
    if rows.size == 0:
        return {"cycles": 0}
    displacement, slowest, fastest, acceleration = rows[:, :4].T
    return {
        "cycles": len(rows),
        "slider": {
            "displacement_max_m": float(displacement.max()),
            "velocity_min_m_s": float(slowest.min()),
            "velocity_max_m_s": float(fastest.max()),
            "acceleration_max_m_s2": float(acceleration.max()),
            "displacement_max_per_cycle_m": asdict(estimate(displacement)),
            "velocity_max_per_cycle_m_s": asdict(estimate(fastest)),
            "acceleration_max_per_cycle_m_s2": asdict(estimate(acceleration)),
        },
        "joints": {
            joint.name: joint_statistics(joint, k, account, added[k], maps[:, k])
            for k, joint in enumerate(linkage.clearances)
        },
    }
