"""Lives of made-up problems, whose law and noise are known."""

import math
from dataclasses import dataclass, field

import numpy as np
import pytest
from numpy.typing import NDArray

from presswear.campaign.crossing import Block, Blocks
from presswear.campaign.life import Known, Pass, Problem, Step, known_by, live
from presswear.scene.life import Limit, Service

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
    starts: int = 8
    _depth: Array = field(default_factory=lambda: np.zeros(0))

    def life_until(self, depth: float) -> float:
        """Strokes until a depth: the integral of dh / (rate (1 + fresh exp(-h/bedded)))."""
        bedded, fresh = self.bedded, self.fresh
        top = math.log((math.exp(depth / bedded) + fresh) / (1.0 + fresh))
        return bedded * top / self.rate

    def go(self, number: int, before: Blocks, step: Step) -> Block:
        """Go on by a step."""
        if not before:
            self._depth = np.zeros(self.starts)
        draw = np.random.default_rng([self.seed, number, len(before)])
        begun, seen = self._depth.copy(), []
        for _ in range(step.cycles):
            law = self.rate * (1.0 + self.fresh * np.exp(-self._depth / self.bedded))
            size = math.sqrt(math.log1p(self.noise**2))
            factor = draw.lognormal(-0.5 * size**2, size, self.starts)
            seen.append(0.5 * self._depth + draw.normal(0.0, self.scatter, self.starts))
            self._depth = self._depth + step.share * law * factor
        strokes = (before[-1].strokes if before else 0.0) + step.cycles * step.share
        gained = float((self._depth - begun).mean()) / (step.cycles * step.share)
        return self._block(strokes, step.cycles, before, np.mean(seen, axis=0), gained)

    def serve(self, number: int, before: Blocks, service: Service) -> Block:
        """Make the bush new, or turn it by half, where it has lost nothing."""
        self._depth = np.zeros(self.starts)
        block = self._block(before[-1].strokes, 0, before, np.zeros(self.starts), 0.0)
        return Block(block.strokes, 0, before[-1].span + 1, block.levels, {}, 0.0)

    def _block(
        self, strokes: float, cycles: int, before: Blocks, place: Array, gained: float
    ) -> Block:
        span = before[-1].span if before else 0
        levels, samples = {"A.depth": self._depth.copy()}, {"bdc_drift": place}
        return Block(strokes, cycles, span, levels, samples, gained / CLEARANCE)


DEPTH = Limit("depth", "A", 5e-5)
DRIFT = Limit("bdc_drift", "", 2.5e-5)


def problem(*limits: Limit, tolerance: float = 0.1, **changed: object) -> Problem:
    """A problem with limits."""
    asked = {"services": (), "at_most": 1e12, "most_cycles": 10_000, **changed}
    return Problem(limits, tolerance=tolerance, **asked)  # type: ignore[arg-type]


def known(asked: Problem, chains: MadeUp) -> tuple[Known, tuple[Pass, ...]]:
    """The life and the passes over it."""
    passes = live(asked, chains)
    return known_by(asked, passes), passes


def is_held(truth: float, found: Known) -> bool:
    """True where the interval of a life holds the truth."""
    return abs(math.log(found.strokes / truth)) <= found.error


@pytest.mark.parametrize(
    ("limit", "noise"), [(DEPTH, 0.5), (DEPTH, 1.5), (DRIFT, 0.5)], ids=["depth", "wild", "drift"]
)
def test_intervals_hold(limit: Limit, noise: float) -> None:
    """Of 100 made-up problems at least 90 intervals hold the life."""
    held, errors = 0, []
    for seed in range(100):
        draw = np.random.default_rng(seed)
        own = MadeUp(
            seed,
            rate=10.0 ** draw.uniform(-13, -9),
            fresh=draw.uniform(0.0, 10.0),
            bedded=10.0 ** draw.uniform(-5.5, -4.5),
            noise=noise,
        )
        found, _ = known(problem(limit), own)
        held += is_held(own.life_until(5e-5), found)
        errors.append(found.error)
    assert held >= 90
    assert np.median(errors) < 0.1
