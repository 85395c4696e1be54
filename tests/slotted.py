"""Linkages with a guide on a moving body, shared by tests."""

import math
from dataclasses import replace
from functools import partial

from presswear.linkage.bodies import Bar, Body
from presswear.linkage.drives import Drive, GearedDrive, LinearDrive
from presswear.linkage.joints import Guide, Pin, Revolute
from presswear.linkage.linkage import Linkage, assemble
from presswear.linkage.motor import Motor
from presswear.scene.bearing import Bearing
from presswear.scene.scene import Scene

SPEED = 10.0 * math.pi  # of the crank, rad/s
RADIUS, HEIGHT = 0.1, 0.3  # of the crank and of its pivot above that of the rocker, m
YOKE_MASS = 2.0
BEARING = Bearing(clearance=0.5e-3, friction=0.05, bearing_radius=0.02)
loose_scene = partial(Scene, bearings=BEARING, wear_updates=0)


def sized(
    linkage: Linkage, slot: str, length: float | None, width: float | None
) -> Linkage:
    """Return a linkage whose block in a slot has a length and a width, m."""

    def joint(one: Revolute | Guide) -> Revolute | Guide:
        if isinstance(one, Guide) and one.name == slot:
            return replace(one, length=length, width=width)
        return one

    return linkage.changed(joints=[*map(joint, linkage.joints)])


def quick_return(speed: float = SPEED) -> Linkage:
    """Return a crank whose block slides in a slotted rocker below it (Whitworth)."""
    return assemble(
        bodies=[
            Bar("crank", RADIUS, 1.0),
            Body("block", 0.5, 1e-3),
            Body("rocker", 2.0, 0.1, {"pivot": (-0.2, 0.0), "end": (0.3, 0.0)}),
        ],
        joints=[
            Pin("O2", (0.0, HEIGHT), "crank.tail"),
            Pin("A", "crank.head", "block"),
            Pin("O4", (0.0, 0.0), "rocker.pivot"),
            Guide("slot", "block", on="rocker"),
        ],
        drives=[Drive("crank", speed)],
        output="rocker.end",
        guess={"rocker": math.radians(60.0)},
        gravity=0.0,
        name="quick return",
    )


def skew_quick_return() -> Linkage:
    """Return one whose slot lies beside the pivot, oblique, with the block turned in it."""
    linkage = quick_return()
    slot = Guide(
        "slot", "block", x=0.01, y=-0.02, direction=0.05, angle=0.3, on="rocker"
    )
    return linkage.changed(joints=[*linkage.revolutes, slot], gravity=9.81)


def shaper() -> Linkage:
    """Return a skew quick return whose rocker moves a ram."""
    linkage = skew_quick_return()
    joints = [
        Pin("B", "rocker.end", "link.tail"),
        Pin("C", "link.head", "ram"),
        Guide("ways", "ram", y=0.55),
    ]
    return linkage.changed(
        bodies=[*linkage.bodies, Bar("link", 0.35, 0.4), Body("ram", 3.0)],
        joints=[*linkage.joints, *joints],
        guess={"rocker": math.radians(60.0), "link": 0.2},
        output="ram",
        name="shaper",
    )


def scotch_yoke(speed: float = SPEED) -> Linkage:
    """Return a yoke whose upright slot a block on a crank moves to and fro."""
    return assemble(
        bodies=[Bar("crank", RADIUS, 1.0), Body("block", 0.5), Body("yoke", YOKE_MASS)],
        joints=[
            Pin("O", (0.0, 0.0), "crank.tail"),
            Pin("A", "crank.head", "block"),
            Guide("ways", "yoke"),
            Guide("slot", "block", direction=0.5 * math.pi, on="yoke"),
        ],
        drives=[Drive("crank", speed)],
        output="yoke",
        gravity=0.0,
        name="Scotch yoke",
    )


def swinging_block() -> Linkage:
    """Return a slider-crank whose rod slides through a block that swings on the frame."""
    return assemble(
        bodies=[
            Bar("crank", RADIUS, 1.0),
            Body("block", 0.5, 1e-3),
            Bar("rod", 0.6, 1.0),
        ],
        joints=[
            Pin("O", (0.0, 0.0), "crank.tail"),
            Pin("A", "crank.head", "rod.tail"),
            Pin("P", (0.4, 0.0), "block"),
            Guide("bore", "rod", on="block"),
        ],
        drives=[Drive("crank", SPEED)],
        output="rod.head",
        gravity=0.0,
        name="swinging block",
    )


def slotted_crank() -> Linkage:
    """Return a driven crank whose oblique slot moves a block on a rocker."""
    return assemble(
        bodies=[
            Bar("crank", 0.3, 1.0),
            Body("block", 0.5, 1e-3),
            Bar("rocker", 0.4, 1.0),
        ],
        joints=[
            Pin("O", (0.0, 0.0), "crank.tail"),
            Pin("A", "block", "rocker.head"),
            Pin("Q", (0.1, 0.0), "rocker.tail"),
            Guide("slot", "block", y=0.01, direction=0.2, angle=0.2, on="crank"),
        ],
        drives=[Drive("crank", SPEED, 0.5)],
        output="rocker.head",
        guess={"rocker": math.radians(50.0)},
        name="slotted crank",
    )


def driven_rod() -> Linkage:
    """Return a rod driven to and fro in a swinging block, which moves a crank and a ram."""
    return assemble(
        bodies=[
            Bar("crank", RADIUS, 1.0),
            Body("block", 0.5, 1e-3),
            Bar("rod", 0.6, 1.0),
            Bar("link", 0.4, 0.5),
            Body("ram", 1.0),
        ],
        joints=[
            Pin("P", (0.4, 0.05), "block"),
            Pin("O", (0.0, 0.0), "crank.tail"),
            Pin("A", "crank.head", "rod.tail"),
            Pin("B", "rod.head", "link.tail"),
            Pin("C", "link.head", "ram"),
            Guide("bore", "rod", y=0.01, direction=0.2, angle=0.2, on="block"),
            Guide("ways", "ram", y=0.03),
        ],
        drives=[Drive("rod", angle=0.1, harmonics=[(0.0, 0.1)], frequency=SPEED)],
        output="ram",
        guess={"crank": math.radians(120.0), "link": 0.0},
        name="driven rod",
    )


def cylinder(angle: float = 0.4) -> Linkage:
    """Return a slide that a cylinder moves along an oblique guide, with a rod and a rocker.

    A link on the rocker moves a second slide.
    """
    along = math.cos(angle), math.sin(angle)
    return assemble(
        bodies=[
            Body("piston", 3.0),
            Bar("rod", 0.4, 1.0),
            Body(
                "rocker",
                2.0,
                0.05,
                {"P": (-0.2, 0.0), "B": (0.1, 0.0), "C": (0.2, 0.1)},
            ),
            Bar("link", 0.5, 0.8),
            Body("ram", 4.0),
        ],
        joints=[
            Guide("bore", "piston", x=0.05, y=-0.02, direction=angle, angle=0.1),
            Pin("A", "piston", "rod.tail"),
            Pin("B", "rod.head", "rocker.B"),
            Pin("P", (0.6 * along[0] + 0.2, 0.6 * along[1] - 0.25), "rocker.P"),
            Pin("C", "rocker.C", "link.tail"),
            Pin("D", "link.head", "ram"),
            Guide("ways", "ram", y=0.3),
        ],
        drives=[
            LinearDrive(
                "piston",
                along="bore",
                position=0.1,
                frequency=SPEED,
                harmonics=[(0.01, 0.04), (0.0, 0.004)],
            )
        ],
        output="ram",
        guess={"rod": 0.4, "rocker": 1.9, "link": 0.2},
        name="cylinder",
    )


def with_wheel(linkage: Linkage, *drives: Drive | GearedDrive | LinearDrive) -> Linkage:
    """Return a linkage with a wheel on the frame, and with other drives."""
    return linkage.changed(
        bodies=[*linkage.bodies, Body("wheel", 5.0, 0.2)],
        joints=[*linkage.joints, Pin("W", (2.0, 0.0), "wheel")],
        drives=drives,
    )


BOOM, BASE = 0.4, 0.6  # from the pivot of a boom to its pins with the cylinder, m
ROD, BARREL = 0.25, 0.05  # of the eye of a piston and of the point of its bore, m
OFFSET = 0.03  # of the mass centre of a barrel beside its bore, m
STROKE = 0.08  # amplitude of the piston, m


def boom(output: str = "boom.tip", is_reversed: bool = False) -> Linkage:
    """Return a boom that a cylinder between it and the frame swings.

    The distance of both pins of the cylinder is BARREL + ROD + the distance of the piston
    along its bore. With ``is_reversed`` the bore is on the piston, whose rod carries it.
    """
    barrel = Body("barrel", 6.0, 0.1, {"eye": (-0.02, -OFFSET)})
    piston = Body("piston", 3.0, 0.03, {"eye": (ROD, 0.0)})
    bore = Guide("bore", "piston", x=BARREL - 0.02, y=-OFFSET, on="barrel")
    position = 0.15
    if is_reversed:
        # The mass centre of the barrel at BARREL - 0.02 before that of the piston
        bore = Guide(
            "bore", "barrel", x=0.02 - BARREL, y=OFFSET, on="piston", direction=math.pi
        )
    name = "barrel" if is_reversed else "piston"
    return assemble(
        bodies=[
            barrel,
            piston,
            Body(
                "boom",
                20.0,
                1.5,
                {"O": (-0.3, 0.0), "A": (BOOM - 0.3, 0.0), "tip": (0.5, 0.1)},
            ),
        ],
        joints=[
            Pin("P", (BASE, 0.0), "barrel.eye"),
            Pin("O", (0.0, 0.0), "boom.O"),
            Pin("A", "piston.eye", "boom.A"),
            bore,
        ],
        drives=[
            LinearDrive(
                name,
                along="bore",
                position=position,
                frequency=SPEED,
                harmonics=[(0.0, STROKE)],
            )
        ],
        output=output,
        guess={"boom": 1.0, "barrel": 2.2, "piston": 2.2},
        name="boom",
    )


def boom_press(is_reversed: bool = False) -> Linkage:
    """Return a boom that moves a slide by a link."""
    linkage = boom(is_reversed=is_reversed)
    joints = [
        Pin("B", "boom.tip", "link.tail"),
        Pin("C", "link.head", "ram"),
        Guide("ways", "ram", x=0.5, direction=0.5 * math.pi),
    ]
    return linkage.changed(
        bodies=[*linkage.bodies, Bar("link", 0.4, 2.0), Body("ram", 10.0)],
        joints=[*linkage.joints, *joints],
        guess=dict(linkage.guess) | {"link": 0.5 * math.pi},
        output="ram",
        name="boom press",
    )


def table(first: float = 0.2, second: float = 1.9) -> Linkage:
    """Return a table on two guides, one on the other, each with a cylinder, and a pendulum."""
    return assemble(
        bodies=[Body("saddle", 40.0), Body("table", 25.0), Bar("arm", 0.2, 1.0)],
        joints=[
            Guide("x", "saddle", x=0.1, y=-0.2, direction=first, angle=0.3),
            Guide(
                "y", "table", x=0.02, y=0.05, direction=second, angle=0.1, on="saddle"
            ),
            Pin("E", "table", "arm.tail"),
        ],
        drives=[
            LinearDrive("saddle", along="x", frequency=SPEED, harmonics=[(0.0, 0.06)]),
            LinearDrive(
                "table",
                along="y",
                position=0.1,
                frequency=SPEED,
                harmonics=[(0.01, 0.02), (0.0, 0.01)],
            ),
            Drive("arm", 2.0 * SPEED),
        ],
        output="table",
        name="table",
    )


def slider_crank_with_sleeve() -> Linkage:
    """Return a slider-crank, a sleeve driven along its rod, and a pendulum on the sleeve."""
    return assemble(
        bodies=[
            Bar("crank", RADIUS, 1.0),
            Bar("rod", 0.5, 2.0),
            Body("slider", 3.0),
            Body("sleeve", 1.0, 0.01),
            Bar("arm", 0.2, 1.0),
        ],
        joints=[
            Pin("O", (0.0, 0.0), "crank.tail"),
            Pin("A", "crank.head", "rod.tail"),
            Pin("B", "rod.head", "slider"),
            Guide("ways", "slider"),
            Guide("bore", "rod", on="sleeve"),
            Pin("E", "sleeve", "arm.tail"),
        ],
        drives=[
            Drive("crank", SPEED),
            LinearDrive(
                "rod",
                along="bore",
                position=0.05,
                frequency=SPEED,
                harmonics=[(0.0, 0.03)],
            ),
            Drive("arm", 2.0 * SPEED),
        ],
        output="slider",
        name="slider-crank with a sleeve",
    )


def geared_five_bar(
    ratio: float = -1.0, motor: Motor | None = None, output: str = "left.head"
) -> Linkage:
    """Return two geared cranks whose rods meet in a pin, which moves a slide by a link."""
    return assemble(
        bodies=[
            Bar("driver", RADIUS, 1.0),
            Bar("follower", RADIUS, 1.5),
            Bar("left", 0.4, 0.8),
            Bar("right", 0.4, 0.9),
            Bar("link", 0.3, 0.5),
            Body("slide", 4.0),
        ],
        joints=[
            Pin("O1", (-0.2, 0.0), "driver.tail"),
            Pin("O2", (0.2, 0.0), "follower.tail"),
            Pin("A", "driver.head", "left.tail"),
            Pin("B", "follower.head", "right.tail"),
            Pin("C", "left.head", "right.head"),
            Pin("D", "left.head", "link.tail"),
            Pin("E", "link.head", "slide"),
            Guide("ways", "slide", direction=0.5 * math.pi),
        ],
        drives=[
            Drive("driver", SPEED, 0.3, motor=motor),
            GearedDrive("follower", leader="driver", ratio=ratio, angle=math.pi - 0.3),
        ],
        output=output,
        guess={"left": 1.2, "right": 2.0, "link": 1.5},
        name="geared five-bar",
    )
