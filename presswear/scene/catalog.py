"""The named scenes."""

import math
from dataclasses import replace

from presswear.linkage.press import Press
from presswear.linkage.slider_crank import LITERATURE, SliderCrank
from presswear.scene.scene import CONVENTIONS, Bearings, Scene
from presswear.tools.errors import InputError


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


def friction() -> Scene:
    """Section 5.3.2 and 5.4.2: the lower of two friction coefficients."""
    return replace(
        wear_times(),
        name="friction",
        title="Friction 0.05 at 6 pi rad/s (paper, 5.3.2 and 5.4.2)",
        mechanism=Press(speed=6.0 * math.pi),
        bearings=Bearings(clearance=0.6e-3, friction=0.05),
        wears=1,
    )


def friction_high() -> Scene:
    """As ``friction``, with the higher coefficient."""
    return replace(
        friction(),
        name="friction-0.1",
        title="Friction 0.1, else as friction",
        bearings=Bearings(clearance=0.6e-3, friction=0.1),
    )


def speed() -> Scene:
    """Section 5.3.3 and 5.4.3: the lower of two speeds."""
    return replace(
        wear_times(),
        name="speed",
        title="Cranks at 4 pi rad/s (paper, 5.3.3 and 5.4.3)",
        mechanism=Press(speed=4.0 * math.pi),
        bearings=Bearings(clearance=0.8e-3, friction=0.03),
        wears=1,
    )


def speed_high() -> Scene:
    """As ``speed``, with the higher speed."""
    return replace(
        speed(),
        name="speed-8pi",
        title="Cranks at 8 pi rad/s, else as speed",
        mechanism=Press(speed=8.0 * math.pi),
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
    scene().name: scene
    for scene in (
        ideal,
        wear_times,
        friction,
        friction_high,
        speed,
        speed_high,
        clearance_a,
        clearance_c,
        slider_crank,
    )
}


STUDIES = {
    "paper": "Study: every number and figure of the paper, with errors",
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
