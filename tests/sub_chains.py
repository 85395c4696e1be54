"""Linkages of which a part has no freedom once a joint is open."""

from presswear.linkage.bodies import Bar, Body
from presswear.linkage.drives import Drive
from presswear.linkage.joints import Guide, Pin
from presswear.linkage.linkage import assemble


def bars(**sizes: tuple[float, float]) -> list[Body]:
    """Return bars of a length, m, and a mass, kg, by name."""
    return [Bar(name, *size) for name, size in sizes.items()]


PUMP = assemble(
    bodies=bars(
        crank=(0.04, 0.3),
        rod=(0.15, 0.4),
        slider=(0.1, 0.5),
        link=(0.12, 0.2),
        rocker=(0.1, 0.3),
    ),
    joints=[
        Pin("O", (0.0, 0.0), "crank.tail"),
        Pin("A", "crank.head", "rod.tail"),
        Pin("B", "rod.head", "slider.centre"),
        Guide("guide", "slider", 0.0, 0.01, direction=0.2, angle=0.9),
        Pin("C", "slider.head", "link.tail"),
        Pin("D", "link.head", "rocker.head"),
        Pin("P", (0.2, -0.1), "rocker.tail"),
    ],
    drives=[Drive("crank", 20.0, 0.4, harmonics=[(0.1, 0.2), (0.0, -0.05)])],
    guess={"rod": 0.1, "link": -1.0, "rocker": 1.6},
    name="slider-crank with a rocker",
)
"""A driven slider whose angle is not that of its guide moves a rocker; the drive is uneven."""
STEPHENSON = assemble(
    bodies=bars(
        crank=(0.04, 0.3),
        coupler=(0.16, 0.4),
        left=(0.14, 0.3),
        right=(0.12, 0.3),
        tie=(0.10, 0.2),
    ),
    joints=[
        Pin("O", (0.0, 0.0), "crank.tail"),
        Pin("A", "crank.head", "coupler.centre"),
        Pin("B", "coupler.head", "right.head"),
        Pin("P", (0.12, -0.1), "right.tail"),
        Pin("C", "coupler.tail", "left.head"),
        Pin("D", "left.tail", "tie.head"),
        Pin("Q", (-0.1, -0.14), "tie.tail"),
    ],
    drives=[Drive("crank", 15.0)],
    guess={"coupler": 0.0, "left": 1.4, "right": 1.6, "tie": 0.5},
    name="Stephenson's six-bar",
)
"""Four bodies behind the crank move only together: no two of them close alone."""
FORE = Drive("fore", 0.0, 1.2, frequency=30.0, harmonics=[(0.1, 0.3)])
ARM = assemble(
    bodies=bars(
        upper=(0.05, 0.3), fore=(0.06, 0.4), link=(0.16, 0.2), rocker=(0.15, 0.3)
    ),
    joints=[
        Pin("O", (0.0, 0.0), "upper.tail"),
        Pin("E", "fore.tail", "upper.head"),
        Pin("W", "fore.head", "link.tail"),
        Pin("K", "link.head", "rocker.head"),
        Pin("P", (0.2, 0.0), "rocker.tail"),
    ],
    drives=[FORE, Drive("upper", 30.0, 0.2)],
    guess={"link": 0.5, "rocker": 1.6},
    name="arm",
)
"""The forearm is driven too, and hangs from the upper arm."""
