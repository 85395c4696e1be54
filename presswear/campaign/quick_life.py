"""Quick life: strokes up to a limit by the wear rates of the new and the once worn surfaces.

Two short stages run. The wear update between them takes off half of what the first
limit allows. Nothing shows the error of so coarse a step.
"""

import math
from dataclasses import dataclass

import numpy as np

from presswear.campaign.life_estimate import finite, scatter_of
from presswear.campaign.limited_wear import LimitedWear, limited_wear
from presswear.linkage.guide_corner import GuideCorner
from presswear.linkage.joints import Guide
from presswear.linkage.surface import SIDES
from presswear.physics.wall_wear import tilt_between
from presswear.recording.statistics import Estimate
from presswear.recording.statistics.estimate import weighted_sum
from presswear.results.life import QUICK, LifeResult, LimitResult, WearRate
from presswear.results.stage import StageResult
from presswear.scene.options import Limit
from presswear.scene.scene import Scene
from presswear.tools.arrays import Array
from presswear.tools.numbers import large, readable

# Surfaces
NEW = "new"
WORN = "worn once"


@dataclass(frozen=True)
class WearRates:
    """Wear of some strokes on the surfaces of a stage."""

    strokes: float
    # by ``JOINT.depth``, m, ``JOINT.wear_volume``, m^3, and ``GUIDE.tilt``, rad
    wear: dict[str, Estimate]

    def depth_text(self, joint: str) -> str:
        """Return the depth of a joint in a million strokes, um, as a text."""
        rate = self.wear[f"{joint}.depth"].mean / self.strokes
        return readable(1e12 * rate, 2)

    def of_joints(
        self, surfaces: str, since: float, until: float
    ) -> tuple[WearRate, ...]:
        """Return the wear rate of each joint from one number of strokes to another."""
        rates = []
        for key, wear in self.wear.items():
            joint, _, quantity = key.partition(".")
            if quantity == "wear_volume":
                rate = wear.scaled(1.0 / self.strokes)
                ends = surfaces, since, until
                rates.append(WearRate(joint, *ends, rate.mean, rate.half_width or 0.0))
        return tuple(rates)


def rates_of(scene: Scene, stage: StageResult) -> WearRates:
    """Return the wear of the update after a stage."""
    wear = {}
    for name in scene.loose_pins:
        joint = stage.joints[name]
        depths = (joint.statistics.wear_peaks[side].depth for side in SIDES)
        wear[f"{name}.depth"] = max(depths, key=lambda depth: depth.mean)
        wear[f"{name}.wear_volume"] = joint.statistics.wear_volume
    for guide in scene.worn_guides:
        wear |= _wear_of_walls(guide, stage)
    return WearRates(stage.cycles_per_update, wear)


def _wear_of_walls(guide: Guide, stage: StageResult) -> dict[str, Estimate]:
    """Return the wear of both walls of a guide by the update after a stage."""
    length, _ = guide.size
    walls = stage.statistics.walls[guide.name].values()
    strokes = stage.cycles_per_update
    depths = [wall.depth_per_cycle.scaled(strokes) for wall in walls]
    volumes = [wall.volume_per_cycle.scaled(strokes) for wall in walls]
    return {
        f"{guide.name}.depth": max(depths, key=lambda depth: depth.mean),
        f"{guide.name}.wear_volume": weighted_sum(volumes, (1.0, 1.0)),
        f"{guide.name}.tilt": weighted_sum(depths, (1.0 / length,) * 2),
    }


def quick_life(scene: Scene, new: WearRates, stage: StageResult) -> LifeResult:
    """Return the life by the rates of the new surfaces and of those of the last stage."""
    worn = rates_of(scene, stage)
    limits = [_limit(scene, limit, new, worn, stage) for limit in scene.life_limits]
    reached = [limit for limit in limits if limit.strokes is not None]
    first = min(reached, key=lambda limit: limit.strokes or 0.0, default=None)
    strokes = new.strokes if first is None else first.strokes or 0.0
    depths = []
    for name in scene.wearing_joints:
        rates = [surfaces.depth_text(name) for surfaces in (new, worn)]
        depths.append(f"{name} {' and '.join(rates)}")
    message = (
        f"without an interval: wear rates of the new surfaces for {large(new.strokes, digits=2)} "
        "strokes, then of the surfaces worn once (deepest place, µm in 10⁶ strokes: "
        f"{', '.join(depths)})"
    )
    wear_rates = new.of_joints(NEW, 0.0, new.strokes)
    wear_rates += worn.of_joints(WORN, new.strokes, max(strokes, new.strokes))
    return LifeResult(
        QUICK,
        message,
        strokes,
        sampling=first.sampling if first else None,
        step=None,
        scatter=scatter_of(scene),
        limits=tuple(limits),
        refinements=(),
        wear_rates=wear_rates,
    )


def _limit(
    scene: Scene, limit: Limit, new: WearRates, worn: WearRates, stage: StageResult
) -> LimitResult:
    """Return the strokes up to a limit, with the scatter of both rates and no error of steps."""
    wear = limited_wear(scene.linkage(), limit)
    depth, depth_rate = _depth_and_rate(wear, worn, stage)
    value = wear.numbers(depth)
    rate = wear.numbers(depth_rate)
    level = float(value.max())
    strokes = math.inf
    if level >= wear.bound:
        strokes = new.strokes * wear.bound / level
    elif np.any(rate > 0.0):
        wears = rate > 0.0
        remaining = (wear.bound - value)[wears] / rate[wears]
        strokes = new.strokes + float(remaining.min())
    share_of_new = min(new.strokes / strokes, 1.0)
    sampling = math.hypot(
        share_of_new * _relative_half_width(new, limit),
        (1.0 - share_of_new) * _relative_half_width(worn, limit),
    )
    if limit.name == "tilt" and isinstance(wear.joint, GuideCorner):
        level = tilt_between(wear.joint, depth)
    return LimitResult(
        key=limit.key,
        unit=limit.unit,
        value=limit.value,
        strokes=finite(strokes),
        sampling=finite(sampling) if math.isfinite(strokes) else None,
        step=None,
        last=level,
        last_half_width=new.wear[limit.key].half_width,
    )


def _depth_and_rate(
    wear: LimitedWear, worn: WearRates, stage: StageResult
) -> tuple[Array, Array]:
    """Return depths of both surfaces, m, and the depth that a stroke adds, m, each (2, bins)."""
    if isinstance(wear.joint, GuideCorner):
        guide = wear.limit.joint
        return stage.wall_depth(guide)[1], stage.wall_wear(guide)[1]
    arrays = stage.joints[wear.limit.joint]
    depth = np.stack([arrays.depth(side) for side in SIDES])
    return depth, np.stack([arrays.wear(side) for side in SIDES]) / worn.strokes


def _relative_half_width(rates: WearRates, limit: Limit) -> float:
    """Return the half width of a wear over the wear; infinite if it is unknown."""
    wear = rates.wear[limit.key]
    if wear.half_width is None or wear.mean <= 0.0:
        return math.inf
    return wear.half_width / wear.mean
