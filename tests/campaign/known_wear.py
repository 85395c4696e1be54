"""Problem of a service life whose wear law and noise are known."""
# mypy: disable-error-code="union-attr,operator"

import math
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from presswear.campaign.life_estimate import LifeEstimate, estimate_life
from presswear.campaign.refinement import LoadBlock, Refinement, Refinements
from presswear.campaign.service_life import (
    BlockPlan,
    LifeProblem,
    run_refinements,
)
from presswear.scene.options import Limit, Service
from presswear.tools.arrays import Array

CLEARANCE = 1e-3
DEPTH = Limit("depth", "A", 5e-5)
DRIFT = Limit("bdc_drift", "", 2.5e-5)


Levels = dict[str, Array]


def load_block(
    strokes: float, cycles: int, levels: Levels, rate: float = 0.0, **settings: Any
) -> LoadBlock:
    """Return a block of the first service interval in which a stroke wears a depth, m."""
    more: dict[str, Any] = {
        "interval": 0,
        "samples": {},
        "removed": np.full((1, 1, 1), rate),
    }
    more |= settings
    return LoadBlock(strokes, cycles, levels=levels, rate=rate / CLEARANCE, **more)


@dataclass
class KnownWear:
    """Histories that wear by dh/dN = rate (1 + fresh exp(-h/bedded)), with noise in every cycle.

    Bottom dead centre drifts by half the depth and scatters from stroke to stroke.
    """

    seed: int
    rate: float = 1e-11
    fresh: float = 3.0
    bedded: float = 1e-5
    noise: float = 0.5
    scatter: float = 5e-6
    initial: float = 0.0
    depth: Array = field(default_factory=lambda: np.zeros(8))

    def life_until(self, depth: float) -> float:
        """Return the strokes until a depth: the integral of dh/(dh/dN)."""
        top = math.log(
            (math.exp(depth / self.bedded) + self.fresh) / (1.0 + self.fresh)
        )
        return self.bedded * top / self.rate

    def __call__(
        self,
        refinements: Refinements,
        plan: BlockPlan | Service,
    ) -> LoadBlock:
        before = refinements[-1].blocks
        if isinstance(plan, Service):
            self.depth = np.zeros(8)
            levels = {"A.depth": self.depth}
            interval = before[-1].interval + 1
            return replace(
                before[-1], cycles=0, interval=interval, levels=levels, rate=0.0
            )
        if not before:
            self.depth = np.full(8, self.initial)
        draw = np.random.default_rng([self.seed, len(refinements), len(before)])
        start = self.depth
        bottoms = []
        for _ in range(plan.cycles):
            law = self.rate * (1.0 + self.fresh * np.exp(-self.depth / self.bedded))
            size = math.sqrt(math.log1p(self.noise**2))
            factor = draw.lognormal(-0.5 * size**2, size, 8)
            bottoms.append(0.5 * self.depth + draw.normal(0.0, self.scatter, 8))
            self.depth = (
                self.depth + plan.share * law * factor + float(np.mean(plan.extra))
            )
        strokes = (before[-1].strokes if before else 0.0) + plan.cycles * plan.share
        rate = float((self.depth - start).mean()) / (plan.cycles * plan.share)
        more: dict[str, Any] = {"interval": before[-1].interval if before else 0}
        more["samples"] = {"bdc_drift": np.mean(bottoms, axis=0)}
        return load_block(strokes, plan.cycles, {"A.depth": self.depth}, rate, **more)


def problem(*limits: Limit, **settings: Any) -> LifeProblem:
    common: dict[str, Any] = {"services": (), "at_most": 1e12, "tolerance": 0.1}
    return LifeProblem(limits, **{"max_cycles": 10_000} | common | settings)


def life_of(
    problem: LifeProblem, wear: KnownWear
) -> tuple[LifeEstimate, tuple[Refinement, ...]]:
    refinements = run_refinements(problem, wear)
    return estimate_life(refinements, problem.limits), refinements


def evenly_worn(cycles: int, strokes: float, **rates: float) -> Refinement:
    """Return a refinement of two histories that wear evenly and differ by a hundredth."""
    blocks = []
    for k in range(cycles + 1):
        depth = strokes * k / cycles * np.array([0.99, 1.01])
        levels = {f"{joint}.depth": rate * depth for joint, rate in rates.items()}
        levels |= {
            f"{joint}.wear_volume": 1e-6 * rate * depth for joint, rate in rates.items()
        }
        removed = np.full((len(rates), 2, 8), 1e-12)
        now = strokes * k / cycles
        blocks.append(
            load_block(now, int(k > 0), levels, 1e-9 * CLEARANCE, removed=removed)
        )
    return Refinement(1.0 / cycles, 1, tuple(blocks))
