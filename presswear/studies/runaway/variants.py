"""Does the second wear run away?  The paper's scene under one changed reading at a time.

The paper's second wear is a thousand times deeper than its first.  Each variant changes
one thing that could do that: the reading of contact and wear, the size of the
extrapolation, the angles of the maps, the step of the integration.
"""

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace

from presswear.campaign.study import Change, Study, Variant, unchanged
from presswear.results.result import Result
from presswear.scene.catalog import wear_times
from presswear.scene.scene import CONVENTIONS, Scene
from presswear.scene.settings import changed

RUNAWAY = 10.0
"""A second wear that adds so many times the depth of the first has run away."""
CYCLES = 5
"""Cycles of each run: of wear maps and totals, some per cent to a few tens of per cent."""
PRINTED = (1.221e-6, 1.178e-3)
"""The paper's deepest wear at A after the first and the second wear, m; the first may have
lost a factor of ten in print."""


def make(change: Change = unchanged) -> Study:
    """The study ``runaway``, from the paper's scene with a change."""
    # What a second wear would add in one jump is known once the first one has been run on.
    paper = change(replace(wear_times(), name="runaway", cycles=CYCLES, wears=1))
    refined = replace(paper, conventions=CONVENTIONS["refined"])

    def of(base: Scene, **settings: str) -> Scene:
        scene = changed(base, settings)
        return replace(scene, wears=2) if scene.wears_in_steps else scene

    varied = [
        Variant("paper", "paper, as printed", paper),
        Variant("foundation", "paper, contact on a foundation", of(paper, contact="foundation")),
        Variant("turning", "paper, maps turn with the bodies", of(paper, map_frame="body")),
        Variant("sliding", "paper, slip is true sliding", of(paper, slip="sliding")),
        Variant("steps", "paper, wear in steps", of(paper, extrapolation="steps")),
    ]
    arc = {"footprint": "arc", "extrapolation": "single"}
    varied += [
        Variant("arc", "paper, wear over the arc", of(paper, **arc)),
        Variant(
            "arc-foundation",
            "paper, arc, contact on a foundation",
            of(paper, **arc, contact="foundation"),
        ),
        Variant(
            "arc-steps", "paper, arc, wear in steps", of(paper, footprint="arc", depth_step="0.02")
        ),
    ]
    once = replace(of(paper, **arc), cycles=1)
    varied.append(Variant("arc-once", "paper, arc, multiplied from one cycle", once))
    varied += [
        Variant(f"angles-{n}", f"paper, {n} angles", of(paper, angles=str(n)))
        for n in (90, 180, 720, 1440)
    ]
    in_house = {"engine": "dae", "integrator": "rk4"}
    varied += [
        Variant("refined", "refined, wear in steps", of(refined)),
        Variant("refined-single", "refined, one jump", of(refined, extrapolation="single")),
        Variant("coarse", "paper, RK4 at 5e-5 s", of(paper, **in_house, equal_step="5e-5 s")),
        Variant(
            "paper-step",
            "paper, RK4 at its 1e-4 s",
            of(paper, engine="dae", integrator="rk4-paper"),
        ),
    ]
    return Study(
        "runaway",
        "Does the second wear run away? The paper's scene, one reading changed at a time",
        "The paper's second wear at joint A is 1.178 mm deep, a thousand times its first and more "
        "than the clearance of 0.8 mm. Does the physics do that, or the discretisation?",
        tuple(varied),
    )


@dataclass(frozen=True)
class Outcome:
    """What a variant says of the two wears.

    Attributes
    ----------
    first, second : dict
        Deepest depth that a wear adds to either surface by joint, m; nan where it was not
        reached.
    force : tuple of float
        Mean over cycles of the peak force at the first joint in each stage, N.
    residual : float
        Largest energy that does not add up, part of the energy exchanged.
    failure : str
        Why it did not finish, or nothing.
    """

    variant: Variant
    first: dict[str, float]
    second: dict[str, float]
    force: tuple[float, ...]
    residual: float
    failure: str

    @property
    def growth(self) -> float:
        """Second wear over first at the joint where that is greatest."""
        ratios = [self.second[j] / self.first[j] for j in self.first if self.first[j] > 0.0]
        return max((r for r in ratios if math.isfinite(r)), default=math.nan)

    @property
    def deepest(self) -> float:
        """Deepest depth that one wear added anywhere, m."""
        depths = [*self.first.values(), *self.second.values()]
        return max((d for d in depths if math.isfinite(d)), default=math.nan)

    @property
    def runs_away(self) -> bool | None:
        """Whether the second wear ran away; None where it cannot be told."""
        return None if math.isnan(self.growth) else self.growth > RUNAWAY


def outcome_of(variant: Variant, result: Result | None) -> Outcome:
    """Read a variant's two wears from its result."""
    joints = variant.scene.clearance_joints
    nothing = dict.fromkeys(joints, math.nan)
    if result is None:
        return Outcome(variant, nothing, nothing, (), math.nan, "it stopped in the first stage")
    stages = [stage for stage in result.stages if not stage.failed]
    wears = [
        {
            joint: max(float(stage.joints[joint].wear(side).max()) for side in ("bearing", "pin"))
            for joint in joints
        }
        for stage in stages[:2]
    ]
    wears += [nothing] * (2 - len(wears))
    residual = max(
        (
            abs(stage.statistics["energy_residual_J"]) / stage.statistics["energy_exchanged_J"]
            for stage in stages
        ),
        default=math.nan,
    )
    force = tuple(
        float(stage.statistics["joints"][joints[0]]["force_max_per_cycle_N"]["mean"])
        for stage in stages
    )
    failure = result.message if result.status == "failed" else ""
    return Outcome(variant, wears[0], wears[1], force, residual, failure)


def answer(outcomes: Iterable[Outcome], clearance: float) -> str:
    """The study's answer in a few plain sentences."""
    told = list(outcomes)
    finished = [o for o in told if o.runs_away is not None]
    away = [o for o in finished if o.runs_away]
    stopped = [o for o in told if o.failure]
    if not finished:
        return "No variant reached its second wear: nothing can be said."
    parts = []
    calm = [o for o in finished if not o.runs_away]
    if calm:
        deepest = max(o.deepest for o in calm)
        parts.append(
            f"Under {len(calm)} of {len(finished)} readings that can be computed the second wear "
            f"does not run away: it adds {min(o.growth for o in calm):.2g} to "
            f"{max(o.growth for o in calm):.2g} times the depth of the first; no wear is deeper "
            f"than {1e6 * deepest:.0f} µm, {100.0 * deepest / clearance:.1f} % of the clearance."
        )
    if away:
        names = "; ".join(
            f"{o.variant.label} ({1e6 * o.deepest:.0f} µm, {o.growth:.0f} times the first)"
            for o in away
        )
        parts.append(f"It does run away under: {names}.")
    if stopped:
        names = "; ".join(o.variant.label for o in stopped)
        parts.append(f"Not to be computed at all: {names}.")
    parts.append(f"The paper prints {1e6 * PRINTED[0]:.3g} µm and then {1e6 * PRINTED[1]:.0f} µm.")
    return " ".join(parts)
