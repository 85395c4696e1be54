"""Checkpoints: all that is needed to go on with a campaign, as a document and arrays."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswear.campaign.chains import LifeState
from presswear.campaign.crossing import Block
from presswear.campaign.ensemble import NOTHING, Ensemble, Partial
from presswear.campaign.growth import Growth
from presswear.campaign.life import Pass
from presswear.campaign.segment import Reached, Task, restored, stored
from presswear.results.stage import WearStep
from presswear.scene.scene import Scene
from presswear.tools.arrays import State, named, part

Array = NDArray[np.float64]
Document = Mapping[str, Any]


@dataclass(frozen=True)
class Checkpoint:
    """The state of a campaign between two cycles.

    Attributes
    ----------
    index : int
        Of the stage at hand.
    worn : ndarray, shape (runs, joints, 2, m)
        Depth of the surfaces that each of its runs is on, m.
    ran : Ensemble or None
        Its runs, where they are finished and the wear after them is being applied.
    growth : Growth or None
        The last pass over that wear.
    partial : Partial
        The runs at hand: of the stage, or of the next pass.
    forecast : dict
        How far the campaign is (``Forecast.numbers``).
    life : LifeState or None
        Where its life stands; known once a stage has begun.
    """

    index: int = 0
    worn: Array = field(default_factory=lambda: np.zeros(0))
    ran: Ensemble | None = None
    growth: Growth | None = None
    partial: Partial = NOTHING
    forecast: Mapping[str, float | None] = field(default_factory=dict)
    life: LifeState | None = None

    def words(self) -> str:
        """Up to where everything is kept, in words."""
        if self.life is not None and self.life.partial.reached:
            ran = self.life.passes[-1].blocks if self.life.passes else ()
            strokes = ran[-1].strokes if ran else 0.0
            return f"pass {self.life.place[0]} over the life, {strokes:.3g} strokes"
        finished = sum(own.cycles for own in self.partial.reached if own is not None)
        where = f"stage {self.index}"
        if self.ran is not None:
            where += ", the wear after it"
        return f"{where}, cycle {finished}"

    def stored(self) -> tuple[dict[str, Any], dict[str, Any]]:
        """Give it as a document that JSON can hold, and arrays."""
        arrays: dict[str, Any] = {"worn": self.worn}
        document: dict[str, Any] = {
            "index": self.index,
            "forecast": dict(self.forecast),
            "partial": _partial("partial", self.partial, arrays),
        }
        if self.life is not None:
            document["life"] = _life(self.life, arrays)
        if self.ran is not None:
            runs = [
                stored(f"ran/{k}", Reached.of(run), arrays) for k, run in enumerate(self.ran.runs)
            ]
            errors = dict(self.ran.step_errors)
            document["ran"] = {"runs": runs, "wall": self.ran.wall, "step_errors": errors}
        if self.growth is not None:
            growth = self.growth
            arrays |= {"growth/worn": growth.worn, "growth/added": growth.added}
            if growth.coarser is not None:
                arrays["growth/coarser"] = growth.coarser
            document["growth"] = [asdict(step) for step in growth.steps]
        return document, arrays

    @staticmethod
    def restored(scene: Scene, document: Document, arrays: State) -> "Checkpoint":
        """Read what ``stored`` gave, for the same scene."""
        worn = arrays["worn"]
        ran = growth = None
        if "ran" in document:
            runs = tuple(
                restored(f"ran/{k}", own, arrays).run(scene, Task(1), worn[k])
                for k, own in enumerate(document["ran"]["runs"])
            )
            told, linkage = document["ran"], scene.linkage()
            errors = told["step_errors"]
            ran = Ensemble(linkage, worn, runs, scene.draws, told["wall"], errors)
        if "growth" in document:
            growth = Growth(
                arrays["growth/worn"],
                arrays["growth/added"],
                tuple(WearStep(**step) for step in document["growth"]),
                arrays.get("growth/coarser"),
            )
        partial = _read_partial("partial", document["partial"], arrays)
        life = _read_life(document["life"], arrays) if "life" in document else None
        forecast = document["forecast"]
        return Checkpoint(document["index"], worn, ran, growth, partial, forecast, life)


def _partial(prefix: str, partial: Partial, arrays: dict[str, Any]) -> dict[str, Any]:
    """An ensemble of which some has run as a document; its arrays are added to those given."""
    return {
        "reached": [
            None if own is None else stored(f"{prefix}/{k}", own, arrays)
            for k, own in enumerate(partial.reached)
        ],
        "until": list(partial.until),
        "wall": partial.wall,
    }


def _read_partial(prefix: str, told: Document, arrays: State) -> Partial:
    """What ``_partial`` gave."""
    reached = tuple(
        None if own is None else restored(f"{prefix}/{k}", own, arrays)
        for k, own in enumerate(told["reached"])
    )
    return Partial(reached, tuple(told["until"]), told["wall"])


_PLAIN = ("strokes", "cycles", "span", "rate", "gone", "wall_s")
"""Fields of a block that are no arrays."""


def _life(state: LifeState, arrays: dict[str, Any]) -> dict[str, Any]:
    """A life as a document; its arrays are added to those given."""
    for p, own in enumerate(state.passes):
        for k, block in enumerate(own.blocks):
            arrays |= {f"life/{p}/{k}/{key}": getattr(block, key) for key in ("worn", "taken")}
            arrays |= named(f"life/{p}/{k}/levels", block.levels)
            arrays |= named(f"life/{p}/{k}/samples", block.samples)
    return {
        "passes": [
            {
                "change": own.change,
                "block": own.block,
                "blocks": [{key: getattr(one, key) for key in _PLAIN} for one in own.blocks],
            }
            for own in state.passes
        ],
        "place": list(state.place),
        "partial": _partial("living", state.partial, arrays),
    }


def _read_life(told: Document, arrays: State) -> LifeState:
    """What ``_life`` gave."""

    def block(place: str, plain: Document) -> Block:
        levels, samples = (dict(part(arrays, f"{place}/{key}")) for key in ("levels", "samples"))
        worn, taken = (arrays[f"{place}/{key}"] for key in ("worn", "taken"))
        return Block(**plain, levels=levels, samples=samples, worn=worn, taken=taken)

    passes = tuple(
        Pass(
            own["change"],
            own["block"],
            tuple(block(f"life/{p}/{k}", plain) for k, plain in enumerate(own["blocks"])),
        )
        for p, own in enumerate(told["passes"])
    )
    place = told["place"][0], told["place"][1]
    return LifeState(passes, place, _read_partial("living", told["partial"], arrays))
