"""Clip without a simulation: the ideal press with rods shifted so that pins are eccentric."""

from typing import Any

import numpy as np

from presswear.linkage.surface import Surface, bin_centres
from presswear.recording.film import FILM_JOINT, Film
from presswear.scene.catalog import scene_named
from presswear.show.replay.clip import Chapter, Clip

FRAMES = 101
ECCENTRICITY = 7.9e-4  # of the pins, m; the clearance is 8e-4


def synthetic_clip(
    title: str = "title", max_depth: float = 3e-5, max_force: float = 200.0
) -> Clip:
    """Return one cycle of the press with clearance at A and C and worn surfaces."""
    scene = scene_named("wear-times")
    centres = bin_centres(360)
    bearing = Surface(max_depth * np.exp(-((centres - 1.5) ** 2) / 0.1))
    pin = Surface(max_depth * np.exp(-((centres - 4.0) ** 2) / 0.2))
    linkage = scene.linkage(dict.fromkeys("AC", (bearing, pin)))
    period = scene.mechanism.period
    motion = scene.ideal.at(np.linspace(0.0, period, FRAMES))
    position = motion.position.copy()
    angle = 2.0 * np.pi * motion.time / period
    for body in ("rod 3", "rod 5"):
        first = 3 * linkage.index(body)
        position[:, first] += ECCENTRICITY * np.cos(3.0 * angle)
        position[:, first + 1] += ECCENTRICITY * np.sin(3.0 * angle)
    normal = max_force * np.abs(np.cos(angle))
    normal[1::2] = 0.0  # the joints are open in every second frame
    columns = {
        "normal": normal,
        "tangential": 0.1 * normal,
        "direction_x": np.cos(angle),
        "direction_y": np.sin(angle),
        "peak": 1.5 * normal,
    }
    joints = np.zeros((FRAMES, 2, len(FILM_JOINT)))
    for name, values in columns.items():
        joints[:, :, FILM_JOINT.index(name)] = values[:, np.newaxis]
    return Clip(
        title=title,
        chapters=(Chapter("first wear", linkage),),
        period=period,
        max_depth=dict.fromkeys("AC", max_depth),
        max_force=dict.fromkeys("AC", max_force),
        film=Film(motion.time, position, joints),
    )


class WithoutMemory:
    """Clip whose every attribute raises ``MemoryError``."""

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)
        raise MemoryError
