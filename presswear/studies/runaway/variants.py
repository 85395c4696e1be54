"""The paper's scene under one changed reading at a time.

The paper's second wear is a thousand times deeper than its first.  Each variant changes
one thing that could do that: the reading of contact and wear, the size of the
extrapolation, the angles of the maps, the step of the integration.  Then the surfaces of a
run as long as the paper's are run on once more, under each of the two contacts.
"""

from dataclasses import replace
from typing import get_args

from presswear.linkage.elements import SurfaceContact
from presswear.scene.bearing import CONVENTIONS
from presswear.scene.catalog import wear_times
from presswear.scene.settings import changed
from presswear.studies.plan import Change, Study, Variant, unchanged

RUNAWAY = 10.0
"""A second wear that adds so many times the depth of the first has run away."""
CYCLES = 5
"""Cycles of each start: of wear maps and totals, some per cent to a few tens of per cent."""
STARTS = 16
"""Each wears its own surfaces: a wear that runs away does so with a probability."""

LONGER = "longer"
"""Key of the run of 200 cycles, as the paper's, on whose surfaces both contacts run."""

_FOUNDATION = {"contact": "foundation"}
_ARC = {"wear_distribution": "arc", "extrapolation": "single"}
_READINGS: dict[str, tuple[str, str, dict[str, str]]] = {
    "paper": ("paper", "paper, as printed", {}),
    "foundation": ("paper", "paper, contact on a foundation", _FOUNDATION),
    "turning": ("paper", "paper, maps turn with the bodies", {"map_frame": "body"}),
    "sliding": ("paper", "paper, slip is true sliding", {"slip": "sliding"}),
    "steps": ("paper", "paper, wear in steps", {"extrapolation": "steps"}),
    "arc": ("paper", "paper, wear over the arc", _ARC),
    "arc-foundation": ("paper", "paper, arc, contact on a foundation", _ARC | _FOUNDATION),
    "arc-steps": ("paper", "paper, arc, wear in steps", {"wear_distribution": "arc"}),
    "arc-once": ("once", "paper, arc, multiplied from one cycle", _ARC),
    "arc-once-foundation": (
        "once",
        "paper, arc, one cycle, on a foundation",
        _ARC | _FOUNDATION,
    ),
    "arc-twice": ("twice", "paper, arc, multiplied from two cycles", _ARC),
    **{
        f"angles-{count}": ("paper", f"paper, {count} angles", {"angles": str(count)})
        for count in (60, 72, 90, 180, 720, 1440)
    },
    "refined": ("refined", "refined, wear in steps", {}),
    "refined-single": ("refined", "refined, one jump", {"extrapolation": "single"}),
    "coarse": (
        "paper",
        "paper, RK4 at 5e-5 s",
        {"engine": "dae", "integrator": "rk4", "equal_step": "5e-5 s"},
    ),
    "paper-step": (
        "paper",
        "paper, RK4 at its 1e-4 s",
        {"engine": "dae", "integrator": "rk4-paper"},
    ),
}
"""Scene to start from, label and changed settings by key."""


def make(change: Change = unchanged) -> Study:
    """The study ``runaway``, from the paper's scene with a change."""
    # What a second wear would add in one jump is known once the first one has been run on.
    paper = change(
        replace(wear_times(), name="runaway", cycles=CYCLES, replicates=STARTS, wear_updates=1)
    )
    bases = {
        "paper": paper,
        "once": replace(paper, cycles=1),
        "twice": replace(paper, cycles=2),
        "refined": replace(paper, conventions=CONVENTIONS["refined"]),
    }
    variants = []
    for key, (base, label, settings) in _READINGS.items():
        scene = changed(bases[base], settings)
        # In steps it needs the stage behind it.
        scene = replace(scene, wear_updates=2) if scene.wears_in_steps else scene
        variants.append(Variant(key, label, scene))
    # Fewer where somebody asks for less.
    cycles = max(200 * (paper.cycles or CYCLES) * paper.draws // (CYCLES * STARTS), 1)
    longer = replace(paper, cycles=cycles, replicates=1, wear_updates=2)
    variants.append(Variant(LONGER, f"paper, one start of {cycles} cycles", longer))
    for stage, wear in enumerate(("first", "second"), start=1):
        for contact in get_args(SurfaceContact):
            scene = replace(changed(paper, {"contact": contact}), wear_updates=0)
            label = f"after the {wear} wear, {contact}"
            variants.append(Variant(f"on-{stage}-{contact}", label, scene, f"{LONGER}:{stage}"))
    return Study(
        "runaway",
        "Does the second wear run away? The paper's scene, one reading changed at a time",
        "The paper's second wear at joint A is 1.178 mm deep, a thousand times its first and more "
        "than the clearance of 0.8 mm. Does the physics do that, or the discretisation?",
        tuple(variants),
    )
