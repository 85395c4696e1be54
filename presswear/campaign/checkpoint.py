"""Checkpoints: all that is needed to go on with a campaign, as a document and arrays."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswear.campaign.ensemble import (
    NOTHING,
    Ensemble,
    Partial,
    Task,
    Wear,
    linkage_on,
    plan_of,
)
from presswear.campaign.growth import Growth, share_of
from presswear.campaign.starts import start_of
from presswear.engines.base import Run, Start, recorder_of
from presswear.record.soundness import Finding
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
        runs, state = self.partial.runs, self.partial.state
        finished = sum(len(run.recorder.cycles) for run in runs)
        if state is not None:
            finished += len(state["recorder/cycles"])
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
                "runs": [
                    _run(f"partial/{k}", run, arrays) for k, run in enumerate(self.partial.runs)
                ],
                "wall": self.partial.wall,
            },
        }
        if self.partial.state is not None:
            arrays |= named("state", self.partial.state)
        if self.ran is not None:
            runs = [_run(f"ran/{k}", run, arrays) for k, run in enumerate(self.ran.runs)]
            document["ran"] = {"runs": runs, "wall": self.ran.wall}
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
            runs = _restored_runs("ran", document["ran"]["runs"], arrays, scene, worn)
            ran = Ensemble(scene.linkage(), worn, runs, scene.draws, document["ran"]["wall"])
        if "growth" in document:
            growth = Growth(
                arrays["growth/worn"],
                arrays["growth/added"],
                tuple(WearStep(**step) for step in document["growth"]),
                arrays.get("growth/coarser"),
            )
        at_hand = document["partial"]
        # The runs of a pass need room for its wear, however much that takes.
        wear = share_of(scene.represented_cycles, 1) if ran else None
        partial = Partial(
            _restored_runs("partial", at_hand["runs"], arrays, scene, worn, wear),
            part(arrays, "state") or None,
            at_hand["wall"],
        )
        return Checkpoint(document["index"], worn, ran, growth, partial, document["forecast"])


def _run(prefix: str, run: Run, arrays: dict[str, Any]) -> dict[str, Any]:
    """A finished run as a document; its arrays are added to those given."""
    arrays |= named(f"{prefix}/recorder", run.recorder.state())
    arrays |= {f"{prefix}/q": run.end.position, f"{prefix}/v": run.end.velocity}
    return {
        "status": run.status,
        "finding": asdict(run.finding) if run.finding else None,
        "time": run.time,
        "diagnostics": run.diagnostics,
    }


def _restored_runs(
    prefix: str,
    runs: list[dict[str, Any]],
    arrays: State,
    scene: Scene,
    worn: Array,
    wear: Wear | None = None,
) -> tuple[Run, ...]:
    """Finished runs; ``wear`` is given where their surfaces wore meanwhile."""
    found = []
    for k, told in enumerate(runs):
        own = part(arrays, f"{prefix}/{k}")
        plan = plan_of(scene, Task(1, wear=wear))
        recorder = recorder_of(linkage_on(scene, worn[k]), start_of(scene), plan)
        recorder.restore(part(own, "recorder"))
        found.append(
            Run(
                told["status"],
                Finding(**told["finding"]) if told["finding"] else None,
                recorder,
                Start(own["q"], own["v"]),
                told["time"],
                told["diagnostics"],
            )
        )
    return tuple(found)
