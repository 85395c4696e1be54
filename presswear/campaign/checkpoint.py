"""Checkpoints: all that is needed to go on with a campaign, as a document and arrays."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswear.campaign.ensemble import NOTHING, Ensemble, Partial
from presswear.campaign.growth import Growth
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
    """

    index: int = 0
    worn: Array = field(default_factory=lambda: np.zeros(0))
    ran: Ensemble | None = None
    growth: Growth | None = None
    partial: Partial = NOTHING
    forecast: Mapping[str, float | None] = field(default_factory=dict)

    def words(self) -> str:
        """Up to where everything is kept, in words."""
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
            "partial": {
                "reached": [
                    None if own is None else stored(f"partial/{k}", own, arrays)
                    for k, own in enumerate(self.partial.reached)
                ],
                "until": list(self.partial.until),
                "wall": self.partial.wall,
            },
        }
        if self.ran is not None:
            runs = [
                stored(f"ran/{k}", Reached.of(run), arrays) for k, run in enumerate(self.ran.runs)
            ]
            errors = dict(self.ran.step_errors)
            document["ran"] = {"runs": runs, "wall": self.ran.wall, "step_errors": errors}
            arrays |= named("deviations", self.ran.deviations)
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
            told, far = document["ran"], part(arrays, "deviations")
            linkage, errors = scene.linkage(), told["step_errors"]
            ran = Ensemble(linkage, worn, runs, scene.draws, told["wall"], errors, far)
        if "growth" in document:
            growth = Growth(
                arrays["growth/worn"],
                arrays["growth/added"],
                tuple(WearStep(**step) for step in document["growth"]),
                arrays.get("growth/coarser"),
            )
        at_hand = document["partial"]
        reached = tuple(
            None if own is None else restored(f"partial/{k}", own, arrays)
            for k, own in enumerate(at_hand["reached"])
        )
        partial = Partial(reached, tuple(at_hand["until"]), at_hand["wall"])
        return Checkpoint(document["index"], worn, ran, growth, partial, document["forecast"])
