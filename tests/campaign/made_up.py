"""Chains of a made-up problem, whose law and noise are known."""

import math
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from presswear.campaign.service_life import BlockPlan, Blocks, LoadBlock
from presswear.scene.options import Service

Array = NDArray[np.float64]

CLEARANCE = 1e-3


@dataclass
class MadeUp:
    """Chains that wear by dh/dN = rate(1 + fresh exp(-h/bedded)), with noise in every cycle.

    Bottom dead centre drifts by half the depth and scatters from stroke to stroke.
    """

    seed: int
    rate: float = 1e-11
    fresh: float = 3.0
    bedded: float = 1e-5
    noise: float = 0.5
    scatter: float = 5e-6
    replicates: int = 8
    begun: float = 0.0
    _depth: Array = field(default_factory=lambda: np.zeros(0))

    def set(self, depth: Array) -> None:
        """Go on from some depths, shape (starts,), m."""
        self._depth = depth

    def life_until(self, depth: float) -> float:
        """Strokes until a depth: the integral of dh / (rate (1 + fresh exp(-h/bedded)))."""
        bedded, fresh = self.bedded, self.fresh
        top = math.log((math.exp(depth / bedded) + fresh) / (1.0 + fresh))
        return bedded * top / self.rate

    def advance(self, number: int, before: Blocks, step: BlockPlan) -> LoadBlock:
        """Go on by a step."""
        if not before:
            self._depth = np.full(self.replicates, self.begun)
        draw = np.random.default_rng([self.seed, number, len(before)])
        begun, seen = self._depth.copy(), []
        for _ in range(step.cycles):
            law = self.rate * (1.0 + self.fresh * np.exp(-self._depth / self.bedded))
            size = math.sqrt(math.log1p(self.noise**2))
            factor = draw.lognormal(-0.5 * size**2, size, self.replicates)
            seen.append(0.5 * self._depth + draw.normal(0.0, self.scatter, self.replicates))
            self._depth = self._depth + step.share * law * factor + float(np.mean(step.extra))
        strokes = (before[-1].strokes if before else 0.0) + step.cycles * step.share
        gained = float((self._depth - begun).mean()) / (step.cycles * step.share)
        return self._block(strokes, step.cycles, before, np.mean(seen, axis=0), gained)

    def maintain(self, number: int, before: Blocks, service: Service) -> LoadBlock:
        """Make the bush new, or turn it by half, where it has lost nothing."""
        self._depth = np.zeros(self.replicates)
        block = self._block(before[-1].strokes, 0, before, np.zeros(self.replicates), 0.0)
        return replace(block, interval=before[-1].interval + 1, samples={}, rate=0.0)

    def _block(
        self, strokes: float, cycles: int, before: Blocks, place: Array, gained: float
    ) -> LoadBlock:
        interval = before[-1].interval if before else 0
        levels, samples = {"A.depth": self._depth.copy()}, {"bdc_drift": place}
        taken = np.full((1, 1, 1), gained)
        return LoadBlock(strokes, cycles, interval, levels, samples, gained / CLEARANCE, taken)
