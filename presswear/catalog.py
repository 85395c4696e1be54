"""The named scenes."""

import math

from presswear.errors import InputError
from presswear.press import Press
from presswear.scene import Bearings, Scene


def ideal() -> Scene:
    """The press with every joint closed."""
    return Scene(
        name="ideal",
        title="The press without clearance, against the closed form",
        joints="none",
        wears=0,
        cycles=2,
    )


def wear_times() -> Scene:
    """Section 5.3.1 and 5.4.1: no wear, first wear, second wear."""
    return Scene(
        name="wear-times",
        title="Clearance at A and C, worn twice (paper, sections 5.3.1 and 5.4.1)",
        press=Press(speed=3.5 * math.pi),
        bearings=Bearings(clearance=0.8e-3, friction=0.02),
        wears=2,
    )


SCENES = {scene().name: scene for scene in (ideal, wear_times)}


def scene_named(name: str) -> Scene:
    """A named scene; InputError lists the names."""
    if name not in SCENES:
        raise InputError(f"unknown scene {name!r}; known are {', '.join(SCENES)}")
    return SCENES[name]()
