"""A film that nobody computed: the ideal press, its rods shifted so that pins lie off centre."""

import numpy as np

from presswear.linkage.surface import Surface, bin_centres
from presswear.recording.film import FILM_JOINT, Film
from presswear.scene.catalog import scene_named
from presswear.show.replay.reel import Reel

FRAMES = 101


def made_up_reel(title: str = "made up", deepest: float = 3e-5, largest: float = 200.0) -> Reel:
    """One cycle of the press with clearance at A and C, both surfaces worn."""
    scene = scene_named("wear-times")
    angle = bin_centres(360)
    bearing, pin = (
        Surface(deepest * np.exp(-((angle - middle) ** 2) / width))
        for middle, width in ((1.5, 0.1), (4.0, 0.2))
    )
    linkage = scene.linkage(dict.fromkeys("AC", (bearing, pin)))
    period = scene.mechanism.period
    motion = scene.ideal.at(np.linspace(0.0, period, FRAMES))
    position = motion.position.copy()
    turn = 2.0 * np.pi * motion.time / period
    for body in ("rod 3", "rod 5"):
        first = 3 * linkage.index(body)
        position[:, first] += 7.9e-4 * np.cos(3.0 * turn)
        position[:, first + 1] += 7.9e-4 * np.sin(3.0 * turn)
    joints = np.zeros((FRAMES, 2, len(FILM_JOINT)))
    joints[::2, :, 0] = largest * np.abs(np.cos(turn[::2, None]))
    joints[:, :, 1] = 0.1 * joints[:, :, 0]
    joints[:, :, 2], joints[:, :, 3] = np.cos(turn)[:, None], np.sin(turn)[:, None]
    joints[:, :, 5] = 1.5 * joints[:, :, 0]
    return Reel(
        title=title,
        stage="first wear",
        linkage=linkage,
        period=period,
        deepest=dict.fromkeys("AC", deepest),
        largest=dict.fromkeys("AC", largest),
        motion=position,
        film=Film(motion.time, position, joints),
    )
