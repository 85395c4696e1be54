"""Independent campaigns of the paper's scene, and a long one that they are held against.

Campaigns differ in their seed alone.  The long one has none of their starts among its own.
"""

from dataclasses import replace

from presswear.campaign.study import Change, Study, Variant, unchanged
from presswear.scene.catalog import wear_times
from presswear.scene.scene import CONVENTIONS, Scene

CAMPAIGNS = 60
WEARS = {"paper": 2, "refined": 2}
"""Wears by conventions."""
TRUTH = "truth"
TRUTH_STARTS, TRUTH_CYCLES = 40, 200


def make(change: Change = unchanged) -> Study:
    """The study ``coverage``, from the paper's scene with a change."""
    scene = wear_times()
    # Chaotic motion is judged by its statistics: finer steps do not move them.
    numerics = scene.numerics.having(
        tree_tolerance=1e-6, integrator="dopri5", integration_tolerance=1e-7
    )
    base = change(replace(scene, name="coverage", engine="dae", numerics=numerics))
    variants = []
    for name, conventions in CONVENTIONS.items():
        own = replace(base, conventions=conventions, wears=min(base.wears, WEARS[name]))
        variants.append(Variant(f"{name}-{TRUTH}", f"{name}, {TRUTH}", longest(own)))
        variants += [
            Variant(f"{name}-{seed}", f"{name}, campaign {seed}", replace(own, seed=seed))
            for seed in range(1, CAMPAIGNS + 1)
        ]
    return Study(
        "coverage",
        "Do the intervals hold?",
        "Of independent campaigns of one scene, how many give intervals that hold what a campaign "
        "with a hundred times the cycles gives?",
        tuple(variants),
    )


def longest(scene: Scene) -> Scene:
    """The campaign that is taken for the truth."""
    return replace(scene, starts=TRUTH_STARTS, cycles=TRUTH_CYCLES, seed=0)
