"""Clip without a simulation: the ideal press with rods shifted so that pins are eccentric."""

from typing import Any

import numpy as np

from presswear.linkage.surface import Surface, bin_centres
from presswear.recording.film import FILM_JOINT, Film
from presswear.scene.catalog import scene_named
from presswear.show.replay.clip import Chapter, Clip

FRAMES = 101


def synthetic_clip(
    title: str = "title", max_depth: float = 3e-5, max_force: float = 200.0
) -> Clip:
    """Return one cycle of the press with clearance at A and C and worn surfaces."""
    scene = scene_named("wear-times")
    angle = bin_centres(360)
    bearing, pin = (
        Surface(max_depth * np.exp(-((angle - middle) ** 2) / width))
        for middle, width in ((1.5, 0.1), (4.0, 0.2))
    )
    linkage = scene.linkage(dict.fromkeys("AC", (bearing, pin)))
    period = scene.mechanism.period
    motion = scene.ideal.at(np.linspace(0.0, period, FRAMES))
    position = motion.position.copy()
    angle = 2.0 * np.pi * motion.time / period
    for body in ("rod 3", "rod 5"):
        first = 3 * linkage.index(body)
        position[:, first] += 7.9e-4 * np.cos(3.0 * angle)
        position[:, first + 1] += 7.9e-4 * np.sin(3.0 * angle)
    joints = np.zeros((FRAMES, 2, len(FILM_JOINT)))
    joints[::2, :, 0] = max_force * np.abs(np.cos(angle[::2, None]))
    joints[:, :, 1] = 0.1 * joints[:, :, 0]
    joints[:, :, 2] = np.cos(angle)[:, None]
    joints[:, :, 3] = np.sin(angle)[:, None]
    joints[:, :, 5] = 1.5 * joints[:, :, 0]
    return Clip(
        title=title,
        chapters=(Chapter("first wear", linkage),),
        period=period,
        max_depth=dict.fromkeys("AC", max_depth),
        max_force=dict.fromkeys("AC", max_force),
        film=Film(motion.time, position, joints),
    )


class Hungry:
    """Clip for which there is no memory."""

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)
        raise MemoryError
