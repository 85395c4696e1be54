"""The named scenes."""

import math
from dataclasses import replace

from presswear.errors import InputError
from presswear.press import Press
from presswear.scene import CONVENTIONS, Bearings, Scene
from presswear.slider_crank import LITERATURE, SliderCrank


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
        mechanism=Press(speed=3.5 * math.pi),
        bearings=Bearings(clearance=0.8e-3, friction=0.02),
        wears=2,
    )


def clearance_a() -> Scene:
    """As ``wear_times``, unworn, with one joint open."""
    return replace(
        wear_times(),
        name="clearance-a",
        title="The press with clearance at A alone",
        joints="A",
        wears=0,
        cycles=5,
    )


def clearance_c() -> Scene:
    """As ``clearance_a``, at the other joint."""
    return replace(
        clearance_a(),
        name="clearance-c",
        title="The press with clearance at C alone",
        joints="C",
    )


def slider_crank() -> Scene:
    """A slider-crank with clearance between rod and slider, as Flores studied it.

    The literature takes the stiffness with R_i - R_j: the ``refined`` conventions.
    """
    known = ("bearing_radius", "clearance", "youngs_modulus", "poisson_ratio", "restitution")
    return Scene(
        name="slider-crank",
        title="A slider-crank with clearance between rod and slider",
        mechanism=SliderCrank(),
        bearings=Bearings(
            clearance=0.5e-3, bearing_radius=0.010, youngs_modulus=207e9, friction=0.0
        ),
        conventions=CONVENTIONS["refined"],
        joints="B",
        wears=0,
        cycles=10,
        statuses=dict.fromkeys((*known, "exponent"), LITERATURE)
        | dict.fromkeys(("friction", "lower_speed", "upper_speed", "bearing_share"), "assumed")
        | dict.fromkeys(("wears", "most_cycles", "represented_cycles"), "chosen"),
    )


SCENES = {
    scene().name: scene for scene in (ideal, wear_times, clearance_a, clearance_c, slider_crank)
}


STUDIES = {
    "runaway": "Study: does the second wear run away? One reading changed at a time",
}
"""Names and titles of the studies, which run several scenes each."""


def scene_named(name: str) -> Scene:
    """A named scene; InputError lists the names."""
    if name not in SCENES:
        if name in STUDIES:
            raise InputError(f"{name!r} is a study of several scenes; presswear run {name}")
        raise InputError(f"unknown scene {name!r}; known are {', '.join((*SCENES, *STUDIES))}")
    return SCENES[name]()
