"""Film of a run: positions of all bodies and joint forces, a few hundred frames per cycle.

It is fine enough to replay a run, and too coarse to compute from.  Its size does not
grow after the first ``FILM_CYCLES`` cycles.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from presswear.tools.arrays import Array
from presswear.tools.compile import Records, compiled, copy_to

FRAMES_PER_CYCLE = 500  # one every 0.72 degrees of the crank
FILM_CYCLES = 20  # number of cycles that are kept
# Columns of a frame for each joint: its forces, N, the direction in which the pin
# presses, penetration, m, and greatest normal force since the previous frame, N
FILM_JOINT = (
    "normal",
    "tangential",
    "direction_x",
    "direction_y",
    "penetration",
    "peak",
)
FILM_JOINT_COUNT = len(FILM_JOINT)
_NORMAL, _TANGENTIAL, _DIRECTION_X, _DIRECTION_Y, _PENETRATION, _PEAK = range(6)

# Number of stored frames, interval between frames, and time of the next frame, s
FRAME_SAMPLER = np.dtype(
    [("frames", np.int64), ("interval", np.float64), ("next", np.float64)]
)


def empty_film(bodies: int, joints: int, cycle: float) -> tuple[Array, Records]:
    """Return the rows of all frames, and the sampler for a cycle, s.

    A row has the time, the positions of all bodies, and FILM_JOINT of all joints. The last
    row is the frame that is being sampled.
    """
    rows = FILM_CYCLES * FRAMES_PER_CYCLE + 1
    columns = 1 + 3 * bodies + FILM_JOINT_COUNT * joints
    sampler = np.zeros(1, FRAME_SAMPLER)
    sampler["interval"] = cycle / FRAMES_PER_CYCLE
    return np.zeros((rows, columns)), sampler


@compiled
def take_frame(
    film: Array,
    samplers: Records,
    contacts: Records,
    memory: Records,
    t: float,
    q: Array,
) -> None:
    """Note the peaks of a step in the present frame, and complete the frame if it is due."""
    sampler = samplers[0]
    frame = film[sampler.frames]
    for k in range(contacts.shape[0]):
        peak = 1 + q.size + FILM_JOINT_COUNT * k + _PEAK
        frame[peak] = max(frame[peak], contacts[k].normal, memory[k].step_peak)
    if t >= sampler.next:
        complete_frame(film, samplers, contacts, t, q)


@compiled
def complete_frame(
    film: Array, samplers: Records, contacts: Records, t: float, q: Array
) -> None:
    """Fill the present frame from an accepted state and begin the next."""
    sampler = samplers[0]
    frame = film[sampler.frames]
    frame[0] = t
    copy_to(frame[1 : 1 + q.size], q)
    for k in range(contacts.shape[0]):
        contact = contacts[k]
        joint = frame[1 + q.size + FILM_JOINT_COUNT * k :]
        joint[_NORMAL] = contact.normal
        joint[_TANGENTIAL] = contact.tangential
        joint[_DIRECTION_X] = contact.normal_x
        joint[_DIRECTION_Y] = contact.normal_y
        joint[_PENETRATION] = contact.penetration
    while sampler.next <= t:
        sampler.next += sampler.interval
    if sampler.frames < film.shape[0] - 1:
        sampler.frames += 1
        return
    for k in range(contacts.shape[0]):  # the row is sampled again
        frame[1 + q.size + FILM_JOINT_COUNT * k + _PEAK] = 0.0


@dataclass(frozen=True)
class Film:
    """Frames of a run."""

    time: Array  # (n,), s
    # (n, 3 bodies): mass centre, m, and angle, rad, in the order of the linkage
    position: Array
    joints: Array  # (n, joints, 6), columns FILM_JOINT

    @staticmethod
    def of(rows: Array, joints: int) -> "Film":
        """Return frames from rows of ``empty_film``."""
        first = rows.shape[1] - FILM_JOINT_COUNT * joints
        columns = rows[:, first:].reshape(len(rows), joints, FILM_JOINT_COUNT)
        return Film(rows[:, 0], rows[:, 1:first], columns)

    def arrays(self, names: Sequence[str]) -> dict[str, Array]:
        """Return the stored arrays: ``time``, ``position`` and ``J_COLUMN`` of each joint J."""
        arrays = {"time": self.time, "position": self.position}
        for k, name in enumerate(names):
            for column, word in enumerate(FILM_JOINT):
                arrays[f"{name}_{word}"] = self.joints[:, k, column]
        return arrays

    @staticmethod
    def from_arrays(
        stored: Mapping[str, Array], bodies: int, names: Sequence[str]
    ) -> "Film":
        """Return the film of stored arrays; KeyError or ValueError if they are no film."""
        time = stored["time"]
        position = stored["position"]
        if time.ndim != 1 or len(time) < 1 or position.shape != (len(time), 3 * bodies):
            raise ValueError(f"frames of shape {time.shape} and {position.shape}")
        joints = np.zeros((len(time), len(names), FILM_JOINT_COUNT))
        for k, name in enumerate(names):
            for column, word in enumerate(FILM_JOINT):
                joints[:, k, column] = stored[f"{name}_{word}"]
        if not all(np.isfinite(array).all() for array in (time, position, joints)):
            raise ValueError("a value is not finite")
        return Film(time, position, joints)
