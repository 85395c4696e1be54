"""Statistics of a run over its cycles.

Beyond some twenty impacts the motion is chaotic and the peak of one run is one
draw.  Each cycle is taken as one sample; intervals are Student's 95 % intervals of
the mean over cycles.  Neighbouring cycles are taken as independent, which the
first start-up cycle is not: it is left out where there are enough others.
"""

import math
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.stats import t as student

from presswear.linkage import ClearanceJoint, Linkage
from presswear.observe import CYCLE_FIXED, CYCLE_JOINT, Account
from presswear.surface import bin_centres
from presswear.wear import worn_volume

Array = NDArray[np.float64]

STARTUP_CYCLES = 1
"""Cycles left out of means over cycles, where at least three others remain."""


@dataclass(frozen=True)
class Estimate:
    """Mean over cycles with the half width of its 95 % interval (None: too few cycles)."""

    mean: float
    half_width: float | None
    cycles: int


def estimate(samples: Array) -> Estimate:
    """Mean and interval of one number per cycle, shape (cycles,)."""
    if samples.size >= STARTUP_CYCLES + 3:
        samples = samples[STARTUP_CYCLES:]
    count = samples.size
    if count < 2:
        return Estimate(float(samples.mean()) if count else math.nan, None, count)
    spread = float(samples.std(ddof=1)) / math.sqrt(count)
    return Estimate(float(samples.mean()), float(student.ppf(0.975, count - 1)) * spread, count)


def map_errors(account: Account) -> Array:
    """Standard error of each joint's wear map as part of its rms, shape (joints,).

    The variance between cycles in each bin, over the number of cycles; infinite
    before the second cycle.
    """
    count = len(account.cycles)
    joints = account.depth_sum.shape[0]
    if count < 2:
        return np.full(joints, math.inf)
    mean = account.depth_sum / count
    variance = np.maximum(account.depth_square_sum / count - mean**2, 0.0) / (count - 1)
    size = np.sum(mean**2, axis=(1, 2))
    noise = np.sum(variance, axis=(1, 2))
    return np.where(size > 0.0, np.sqrt(noise / np.where(size > 0.0, size, 1.0)), 0.0)


def joint_statistics(
    joint: ClearanceJoint, k: int, account: Account, added: Array
) -> dict[str, Any]:
    """Numbers of one clearance joint.

    Parameters
    ----------
    added : ndarray, shape (2, m)
        Depth of one wear, bearing and pin, m.
    """
    rows = np.array(account.cycles)
    first = len(CYCLE_FIXED) + len(CYCLE_JOINT) * k
    force, dose = rows[:, first], rows[:, first + 1]
    tally = account.book.tally[k]
    contacts = int(tally["contacts"])
    both = added.sum(axis=0) if joint.map_frame == "fixed" else None
    degrees = np.degrees(bin_centres(added.shape[1]))
    numbers: dict[str, Any] = {
        "force_max_N": float(force.max()),
        "force_max_per_cycle_N": asdict(estimate(force)),
        "contacts": contacts,
        "unresolved_contacts": int(tally["unresolved"]),
        "fewest_steps_in_a_contact": int(tally["fewest_steps"]) if contacts else None,
        "part_of_time_in_contact": float(tally["closed_time"]) / account.last_time,
        "dose_per_cycle_Nm": asdict(estimate(dose)),
        "wear_volume_m3": worn_volume(joint, added),
        "wear_map_error": float(map_errors(account)[k]),
    }
    for name, depth in (("bearing", added[0]), ("pin", added[1]), ("both", both)):
        if depth is not None:
            numbers[f"wear_depth_max_{name}_m"] = float(depth.max())
            numbers[f"wear_depth_max_{name}_deg"] = float(degrees[int(depth.argmax())])
    return numbers


def stage_statistics(linkage: Linkage, account: Account, added: Array) -> dict[str, Any]:
    """Numbers of one stage, ready for ``result.json``.

    Parameters
    ----------
    added : ndarray, shape (joints, 2, m)
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
            joint.name: joint_statistics(joint, k, account, added[k])
            for k, joint in enumerate(linkage.clearances)
        },
    }
