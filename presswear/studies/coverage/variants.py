"""Independent campaigns of the paper's scene, and many long ones that they are held against.

They differ in their seed alone.  The truth is the mean of long campaigns of a single start, as
many cycles in each as the paper has: what follows a wear in one jump depends on the cycles that
its map is of, and has a meaning for that many.
"""

from dataclasses import replace

from presswear.scene.bearing import CONVENTIONS
from presswear.scene.catalog import wear_times
from presswear.scene.scene import Scene
from presswear.studies.plan import Change, Study, Variant, unchanged

CAMPAIGNS = 60
WEARS = {"paper": 2, "refined": 2}
"""Wears by conventions."""
TRUTH = "truth"
TRUTHS = 40
"""Long campaigns of each conventions."""


def make(change: Change = unchanged) -> Study:
    """The study ``coverage``, from the paper's scene with a change."""
    scene = wear_times()
    base = change(replace(scene, name="coverage", engine="dae", purpose="wear"))
    variants = []
    for name, conventions in CONVENTIONS.items():
        own = replace(
            base, conventions=conventions, wear_updates=min(base.wear_updates, WEARS[name])
        )
        variants += [
            Variant(f"{name}-{TRUTH}-{k}", f"{name}, {TRUTH} {k}", longest(own, k))
            for k in range(1, TRUTHS + 1)
        ]
        variants += [
            Variant(f"{name}-{seed}", f"{name}, campaign {seed}", replace(own, seed=seed))
            for seed in range(1, CAMPAIGNS + 1)
        ]
    return Study(
        "coverage",
        "Do the intervals hold?",
        "Of independent campaigns of one scene, how many give intervals that hold the mean of many "
        "long ones?",
        tuple(variants),
    )


def longest(scene: Scene, number: int) -> Scene:
    """One of the campaigns that are taken for the truth."""
    return replace(scene, replicates=1, cycles=scene.max_cycles, seed=CAMPAIGNS + number)
