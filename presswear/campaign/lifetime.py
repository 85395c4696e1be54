"""The life of a scene: run by its chains, and told as results keep it."""

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from presswear.campaign.chains import LifeState, SceneChains
from presswear.campaign.crossing import Blocks, chains_of, curve, sampling_error
from presswear.campaign.ensemble import Runner
from presswear.campaign.life import Known, Pass, Problem, known_by, live
from presswear.campaign.phases import phases_of
from presswear.recording.statistics import half_width, quantile
from presswear.results.life import Ended, LifeResult, LimitResult, PassResult
from presswear.scene.options import Life, Limit
from presswear.scene.scene import Scene

Array = NDArray[np.float64]


def problem_of(scene: Scene) -> Problem:
    """What a scene asks of its life."""
    own = _life(scene)
    return Problem(
        own.limits(scene.clearance_joints),
        own.services(scene.clearance_joints),
        own.at_most,
        scene.tolerance,
        own.max_cycles,
    )


def _life(scene: Scene) -> Life:
    assert scene.life is not None, "only a scene with limits has a life"
    return scene.life


def run_life(
    runner: Runner, begun: Array, state: LifeState, keep: Callable[[LifeState], None]
) -> tuple[tuple[Pass, ...], LifeResult]:
    """Run the life of a scene, or go on with it; gives its passes as well.

    Parameters
    ----------
    begun : ndarray, shape (starts, joints, 2, m)
        Depth of the surfaces that every start begins on, m.
    keep : callable
        Told now and then where it stands.

    Raises
    ------
    InputError
        Where a limit is exceeded when new.
    RunFailed
        Where a run fails before anything is known.
    """
    problem = problem_of(runner.scene)
    names = tuple(limit.name for limit in problem.limits)
    chains = SceneChains(runner, begun, names, state, keep)
    passes = live(problem, chains, state.passes, chains.keep_passes)
    chains.finish()
    return passes, told_of(runner.scene, problem, passes)


def told_of(scene: Scene, problem: Problem, passes: tuple[Pass, ...]) -> LifeResult:
    """A life as results keep it."""
    blocks = passes[-1].blocks
    known, end = known_by(problem, passes), blocks[-1]
    ended: Ended = "limit"
    message = ""
    if math.isinf(known.strokes):
        if end.gone:
            ended, message = "worn", end.gone
        elif end.strokes >= problem.at_most:
            ended, message = "at_most", f"no limit is passed within {problem.at_most:.4g} strokes"
        else:
            ended = "cycles"
            message = f"no limit is passed within {_cycles(blocks)} cycles of all starts"
    # A life is inversely proportional to the wear coefficients, all of them high or low together.
    worst = max(scene.bearing(name).materials.wear_scatter for name in scene.clearance_joints)
    scatter = quantile(math.inf) * math.sqrt(math.log1p(worst**2))
    return LifeResult(
        ended,
        message,
        min(known.strokes, end.strokes),
        _finite(known.sampling),
        _finite(known.step),
        scatter,
        tuple(_limit(problem, passes, limit, known) for limit in problem.limits),
        tuple(
            PassResult(
                own.change,
                _cycles(own.blocks),
                _finite(known_by(problem, [own]).strokes),
                _finite(sampling_error(own.blocks, problem.limits)),
            )
            for own in passes
        ),
        tuple(phase for name in scene.clearance_joints for phase in phases_of(blocks, name)),
        tuple(
            f"{own.words} after {own.strokes:.4g} strokes" for own in problem.services[: end.span]
        ),
        curves_of(blocks),
    )


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None


def _cycles(blocks: Blocks) -> int:
    return chains_of(blocks) * sum(block.cycles for block in blocks)


def _limit(problem: Problem, passes: tuple[Pass, ...], limit: Limit, life: Known) -> LimitResult:
    blocks = passes[-1].blocks
    known = known_by(problem, passes, [limit])
    if known.strokes == life.strokes:
        # The first: a coarser pass that another limit ended tells of it too.
        known = life
    last, half = (float(own[-1]) for own in band(blocks, limit.key))
    return LimitResult(
        limit.key,
        limit.unit,
        limit.value,
        _finite(known.strokes),
        _finite(known.sampling),
        _finite(known.step),
        last,
        half,
    )


def band(blocks: Blocks, key: str) -> tuple[Array, Array]:
    """A followed number at the ends of blocks, and its half width, each of shape (blocks,).

    The half width is that of the jackknife over the chains.
    """
    value, n = curve(blocks, key), chains_of(blocks)
    if n < 2:
        return value, np.zeros_like(value)
    without = np.array([curve(blocks, key, np.delete(np.arange(n), k)) for k in range(n)])
    pseudo = n * value - (n - 1) * without
    return value, np.array([half_width(own) for own in pseudo.T])


def curves_of(blocks: Blocks) -> dict[str, Array]:
    """Every followed number over strokes, with its band; see ``LifeResult.curves``."""
    found = {"strokes": np.array([block.strokes for block in blocks])}
    for key in (*blocks[0].levels, *blocks[0].samples):
        value, half = band(blocks, key)
        found[key] = np.column_stack([value, value - half, value + half])
    return found
