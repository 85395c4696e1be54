"""The film of a run: where every body was, and what the joints bore, a few hundred times a cycle.

Enough to show a run again, too coarse to compute from.  Its size does not grow with the
number of cycles beyond the first ``FILM_CYCLES``.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from presswear.tools.compile import Records, compiled

Array = NDArray[np.float64]

FRAMES_PER_CYCLE = 500
"""Frames of a cycle: one each 0.72 degrees of the crank."""
FILM_CYCLES = 20
"""Cycles of which a film is kept."""
FILM_JOINT = ("normal", "tangential", "direction_x", "direction_y", "penetration", "peak")
"""Columns of a frame for each joint: its forces, N, the direction in which the pin presses,
penetration, m, and greatest normal force since the frame before, N."""
FILM_JOINT_COUNT = len(FILM_JOINT)
_PEAK = FILM_JOINT.index("peak")

SHUTTER = np.dtype(
    [
        ("frames", np.int64),  # kept
        ("interval", np.float64),  # s
        ("next", np.float64),  # time from which the next frame is due, s
    ]
)
"""Where the film stands."""


def empty_film(bodies: int, joints: int) -> Array:
    """Room for every frame that is kept, and one more, the frame being taken."""
    frames = FILM_CYCLES * FRAMES_PER_CYCLE + 1
    return np.zeros((frames, columns_of(bodies, joints)))


def columns_of(bodies: int, joints: int) -> int:
    """Numbers in a frame."""
    return 1 + 3 * bodies + FILM_JOINT_COUNT * joints


def shutter_of(cycle: float) -> Records:
    """A shutter that opens ``FRAMES_PER_CYCLE`` times a cycle, s."""
    shutter = np.zeros(1, SHUTTER)
    shutter["interval"] = cycle / FRAMES_PER_CYCLE
    return shutter


@compiled
def take_frame(
    film: Array, shutters: Records, contacts: Records, memory: Records, t: float, q: Array
) -> None:
    """Take a frame of an accepted state where one is due; peaks count between frames as well."""
    shutter = shutters[0]
    frame = film[shutter.frames]
    first = 1 + q.size
    for k in range(contacts.shape[0]):
        peak = first + FILM_JOINT_COUNT * k + _PEAK
        frame[peak] = max(frame[peak], contacts[k].normal, memory[k].step_peak)
    if t < shutter.next:
        return
    frame[0] = t
    for i in range(q.size):
        frame[1 + i] = q[i]
    for k in range(contacts.shape[0]):
        contact = contacts[k]
        base = first + FILM_JOINT_COUNT * k
        frame[base] = contact.normal
        frame[base + 1] = contact.tangential
        frame[base + 2] = contact.normal_x
        frame[base + 3] = contact.normal_y
        frame[base + 4] = contact.penetration
    while shutter.next <= t:
        shutter.next += shutter.interval
    if shutter.frames < film.shape[0] - 1:
        shutter.frames += 1
        return
    for k in range(contacts.shape[0]):  # the row is taken again
        frame[first + FILM_JOINT_COUNT * k + _PEAK] = 0.0


@dataclass(frozen=True)
class Film:
    """Frames of a run.

    Attributes
    ----------
    time : ndarray, shape (n,)
        s.
    position : ndarray, shape (n, 3 bodies)
        Mass centre, m, and angle, rad, of each body in the order of the linkage.
    joints : ndarray, shape (n, joints, 6)
        Columns FILM_JOINT.
    """

    time: Array
    position: Array
    joints: Array

    @staticmethod
    def of(rows: Array, joints: int) -> "Film":
        """Frames from rows as ``empty_film`` has them."""
        first = rows.shape[1] - FILM_JOINT_COUNT * joints
        own = rows[:, first:].reshape(len(rows), joints, FILM_JOINT_COUNT)
        return Film(rows[:, 0], rows[:, 1:first], own)

    def arrays(self, names: Sequence[str]) -> dict[str, Array]:
        """As it is stored: ``time``, ``position`` and ``J_COLUMN`` for joints of given names."""
        found = {"time": self.time, "position": self.position}
        for k, name in enumerate(names):
            for column, word in enumerate(FILM_JOINT):
                found[f"{name}_{word}"] = self.joints[:, k, column]
        return found

    @staticmethod
    def from_arrays(stored: Mapping[str, Array], bodies: int, names: Sequence[str]) -> "Film":
        """The film that ``arrays`` stored; KeyError or ValueError where it is none."""
        time, position = stored["time"], stored["position"]
        if time.ndim != 1 or len(time) < 1 or position.shape != (len(time), 3 * bodies):
            raise ValueError(f"frames of shape {time.shape} and {position.shape}")
        joints = np.zeros((len(time), len(names), FILM_JOINT_COUNT))
        for k, name in enumerate(names):
            for column, word in enumerate(FILM_JOINT):
                joints[:, k, column] = stored[f"{name}_{word}"]
        found = Film(time, position, joints)
        if not all(np.isfinite(part).all() for part in (time, position, joints)):
            raise ValueError("a value is not finite")
        return found
