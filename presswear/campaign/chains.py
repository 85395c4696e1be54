"""The starts of a scene as chains of a life: they run on, and their surfaces wear meanwhile."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from presswear.campaign.crossing import Block, Blocks
from presswear.campaign.ensemble import NOTHING, Partial, Runner
from presswear.campaign.followed import levels, samples
from presswear.campaign.growth import FIRST_PASS, Growth, by_side, largest_change, share_of
from presswear.campaign.life import FEWEST_CYCLES, LEAST_BLOCK, Pass, Step
from presswear.campaign.segment import Task, worn_out
from presswear.linkage.elements import ClearanceJoint
from presswear.recording.statistics import STARTUP_CYCLES
from presswear.results.stage import WearStep
from presswear.scene.options import Service
from presswear.tools.errors import RunFailed

Array = NDArray[np.float64]

_MOST_CYCLES = 1_000_000
"""Of a chain in one span: none comes so far."""
_SPANS = 64
"""Spans in a pass at most, so that no two of them begin alike."""


@dataclass(frozen=True)
class LifeState:
    """Where a life stands.

    Attributes
    ----------
    passes : tuple of Pass
        The last perhaps in part.
    place : tuple of int
        Pass and span of the runs at hand.
    partial : Partial
        Those runs, from the beginning of the span.
    """

    passes: tuple[Pass, ...] = ()
    place: tuple[int, int] = (0, 0)
    partial: Partial = NOTHING


@dataclass
class SceneChains:
    """The starts of a scene.

    Attributes
    ----------
    runner : Runner
    begun : ndarray, shape (starts, joints, 2, m)
        Depth of the surfaces that they begin on, m.
    asked : tuple of str
        Numbers that limits are on.
    state : LifeState
    keep : callable
        Told now and then where the life stands.
    """

    runner: Runner
    begun: Array
    asked: tuple[str, ...]
    state: LifeState = field(default_factory=LifeState)
    keep: Callable[[LifeState], None] = lambda state: None

    def go(self, number: int, before: Blocks, step: Step) -> Block:
        """Go on by a step; see ``Chains``."""
        scene, span = self.runner.scene, before[-1].span if before else 0
        own = [block for block in before if block.span == span]
        first = _first_of(own, self.begun)
        ran = sum(block.cycles for block in own)
        until = STARTUP_CYCLES + ran + step.cycles
        partial = self.state.partial
        if self.state.place != (number, span):
            self.finish()
            partial = Partial((None,) * scene.draws)
        partial = replace(partial, until=(until,) * scene.draws)
        self.state = replace(self.state, place=(number, span), partial=partial)
        strokes, wall = before[-1].strokes if before else 0.0, partial.wall
        task = Task(
            _MOST_CYCLES,
            wear=share_of(step.share, 1, step.extra),
            number=number + _SPANS * span,
            word=f"life, pass {number}, {strokes:.3g} strokes",
        )

        self.runner.forecast.expect(_left(before, number) + scene.wear_updates * FIRST_PASS)

        def keep(partial: Partial) -> None:
            self.state = replace(self.state, partial=partial)
            self.keep(self.state)

        result = self.runner.run(first, task, partial, keep)
        if result.failure:
            if not before:
                raise RunFailed(result.failure, result.finding)
            return replace(before[-1], cycles=0, gone=result.failure)
        joints = result.linkage.clearances
        earlier = own[-1].worn if own else first
        worn = np.array([recorder.worn for recorder in result.recorders])
        gone = [worn_out(joints, one) for one in worn]
        # A start whose surfaces are gone ends before the others: all are taken to where it did.
        ran_before = until - step.cycles
        counts = np.array([len(recorder.cycles) - ran_before for recorder in result.recorders])
        cycles = int(counts.min())
        part = (cycles / counts)[:, np.newaxis, np.newaxis, np.newaxis]
        worn = np.where(part < 1.0, earlier + part * (worn - earlier), worn)
        rows = np.array(
            [recorder.cycles[ran_before : ran_before + cycles] for recorder in result.recorders]
        )
        represented = step.share * cycles
        taken = (worn - earlier).mean(axis=0) / represented
        return Block(
            strokes + represented,
            cycles,
            span,
            levels(scene, worn, self.asked),
            samples(scene, rows),
            largest_change(joints, taken),
            taken,
            worn,
            next((f"{found[0]}: {found[1]}" for found in gone if found), ""),
            result.wall - wall,
        )

    def keep_passes(self, passes: tuple[Pass, ...]) -> None:
        """Tell of passes that have come further."""
        self.state = replace(self.state, passes=passes)
        self.keep(self.state)

    def finish(self) -> None:
        """Count the cycles of the span at hand as run."""
        ran = sum(own.cycles for own in self.state.partial.reached if own is not None)
        self.runner.forecast.done += ran / self.runner.scene.draws
        self.state = replace(self.state, partial=NOTHING)

    def serve(self, number: int, before: Blocks, service: Service) -> Block:
        """See to a bush; see ``Chains``."""
        last, joints = before[-1], self.runner.scene.linkage().clearances
        worn = last.worn.copy()
        k = [joint.name for joint in joints].index(service.joint)
        bush = worn[:, k, 0, : joints[k].bins]
        bush[...] = np.roll(bush, joints[k].bins // 2, axis=1) if service.is_turned else 0.0
        own = levels(self.runner.scene, worn, self.asked)
        return replace(last, cycles=0, span=last.span + 1, levels=own, rate=0.0, worn=worn)


def _left(before: Blocks, number: int) -> float:
    """Cycles of each start that seem to be left of the passes."""
    ran = sum(block.cycles for block in before)
    return max(FEWEST_CYCLES - ran, LEAST_BLOCK) + (2 * FEWEST_CYCLES if number == 1 else 0)


def _first_of(own: Blocks, begun: Array) -> Array:
    """Surfaces that a span begins on: those that a bush was seen to on, or the scene's."""
    return own[0].worn if own and not own[0].cycles else begun


@dataclass(frozen=True)
class _Worn:
    """Surfaces of every start over strokes, linear between the ends of blocks.

    Where a bush was seen to, they are those behind that.
    """

    strokes: Array
    depth: Array
    lost: Array

    @staticmethod
    def of(own: Pass, begun: Array) -> "_Worn":
        depth = [begun, *(block.worn for block in own.blocks)]
        # What a bush had lost that was made new is lost all the same.
        each = [
            (after - before) * (block.cycles > 0)
            for before, after, block in zip(depth, depth[1:], own.blocks, strict=False)
        ]
        lost = np.cumsum([np.zeros_like(begun), *each], axis=0)
        strokes = np.array([0.0, *(block.strokes for block in own.blocks)])
        return _Worn(strokes, np.array(depth), lost)

    def at(self, strokes: float, values: Array) -> Array:
        """Values at the ends of blocks, after some strokes."""
        ends = self.strokes
        k = int(np.searchsorted(ends, strokes, side="right"))
        if k == len(ends):
            return np.asarray(values[-1])
        part = (strokes - ends[k - 1]) / (ends[k] - ends[k - 1])
        return np.asarray(values[k - 1] + part * (values[k] - values[k - 1]))

    def added(self, since: float, until: float) -> Array:
        """Depth lost between two numbers of strokes, m."""
        return self.at(until, self.lost) - self.at(since, self.lost)


def growth_between(
    passes: Sequence[Pass],
    joints: Sequence[ClearanceJoint],
    begun: Array,
    since: float,
    until: float,
) -> Growth:
    """The wear between two numbers of strokes, as the last pass left it."""
    last, *others = reversed(passes)
    own = _Worn.of(last, begun)
    coarser = None
    if others and others[0].blocks[-1].strokes >= until:
        coarser = _Worn.of(others[0], begun).added(since, until)
    steps, at = [], since
    for block in last.blocks:
        end = min(block.strokes, until)
        if end <= at:
            continue
        there, cycles = own.at(end, own.depth), block.cycles * len(begun)
        steps.append(
            WearStep(
                cycles_per_update=end - at,
                cycles=cycles,
                factor=(end - at) * len(begun) / cycles,
                clearance_change=largest_change(
                    joints, own.added(at, end).mean(axis=0) / block.cycles
                ),
                max_depth=by_side(joints, there.max(axis=3).mean(axis=0)),
                peak_force={
                    joint.name: float(block.samples[f"{joint.name}.force_max"].mean())
                    for joint in joints
                },
                wall_s=block.wall_s,
            )
        )
        at = end
    return Growth(own.at(until, own.depth), own.added(since, until), tuple(steps), coarser)
