"""A four-bar linkage, the example to begin with."""

from presswear.linkage.elements import Bar, Pin
from presswear.linkage.linkage import Linkage
from presswear.linkage.motions import Drive

FOUR_BAR = Linkage(
    bodies=[
        Bar("crank", length=0.05, mass=0.3),
        Bar("coupler", length=0.20, mass=0.5),
        Bar("rocker", length=0.12, mass=0.4),
    ],
    joints=[
        Pin("O", (0.0, 0.0), "crank.tail"),
        Pin("A", "crank.head", "coupler.tail"),
        Pin("B", "coupler.head", "rocker.head"),
        Pin("P", (0.18, 0.0), "rocker.tail"),
    ],
    drives=[Drive("crank", speed=30.0)],
    guess={"coupler": 0.6, "rocker": 1.4},
    watch="rocker.head",
    name="four-bar",
)
"""Chosen dimensions; the crank turns all around."""
