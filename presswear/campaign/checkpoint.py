"""Checkpoints: all that is needed to go on with a campaign, as a document and arrays."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import Any

from presswear.campaign.amplification import Growth, Worn
from presswear.campaign.ensemble import NOTHING, Ensemble, Partial, empty_recorder
from presswear.engines.base import Run, Start
from presswear.linkage.elements import Linkage
from presswear.linkage.surface import Surface
from presswear.record.soundness import Finding
from presswear.results.stage import WearStep
from presswear.scene.scene import Scene
from presswear.tools.arrays import State, named, part

Document = Mapping[str, Any]


@dataclass(frozen=True)
class Checkpoint:
    """The state of a campaign between two cycles.

    Attributes
    ----------
    index : int
        Of the stage at hand.
    worn : mapping
        Surfaces that it runs on.
    ran : Ensemble or None
        Its runs, where they are finished and the wear after them is being applied.
    growth : Growth or None
        That wear as far as it has been applied.
    partial : Partial
        The runs at hand: of the stage, or of the next step of the wear.
    forecast : dict
        How far the campaign is (``Forecast.numbers``).
    """

    index: int = 0
    worn: Worn = field(default_factory=dict)
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
        if self.growth is not None:
            where += f", step {len(self.growth.steps) + 1} of the wear after it"
        return f"{where}, cycle {finished}"

    def stored(self) -> tuple[dict[str, Any], dict[str, Any]]:
        """Give it as a document that JSON can hold, and arrays."""
        arrays: dict[str, Any] = _surfaces("worn", self.worn)
        document: dict[str, Any] = {
            "index": self.index,
            "worn": list(self.worn),
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
            arrays |= {"growth/added": growth.added, **_surfaces("growth/worn", growth.worn)}
            document["growth"] = {
                "worn": list(growth.worn),
                "steps": [asdict(step) for step in growth.steps],
                "remaining": growth.remaining,
            }
        return document, arrays

    @staticmethod
    def restored(scene: Scene, document: Document, arrays: State) -> "Checkpoint":
        """Read what ``stored`` gave, for the same scene."""
        worn = _restored_surfaces("worn", document["worn"], arrays)
        linkage = scene.linkage(worn)
        ran = growth = None
        if "ran" in document:
            runs = _restored_runs("ran", document["ran"]["runs"], arrays, scene, linkage)
            ran = Ensemble(linkage, runs, document["ran"]["wall"])
        if "growth" in document:
            told = document["growth"]
            growth = Growth(
                _restored_surfaces("growth/worn", told["worn"], arrays),
                arrays["growth/added"],
                tuple(WearStep(**step) for step in told["steps"]),
                told["remaining"],
            )
            linkage = scene.linkage(growth.worn)
        at_hand = document["partial"]
        partial = Partial(
            _restored_runs("partial", at_hand["runs"], arrays, scene, linkage),
            part(arrays, "state") or None,
            at_hand["wall"],
        )
        return Checkpoint(document["index"], worn, ran, growth, partial, document["forecast"])


def _surfaces(prefix: str, worn: Worn) -> dict[str, Any]:
    return {
        f"{prefix}/{joint}/{side}": surface.depth
        for joint, pair in worn.items()
        for side, surface in zip(("bearing", "pin"), pair, strict=True)
    }


def _restored_surfaces(prefix: str, joints: list[str], arrays: State) -> Worn:
    return {
        joint: (
            Surface(arrays[f"{prefix}/{joint}/bearing"]),
            Surface(arrays[f"{prefix}/{joint}/pin"]),
        )
        for joint in joints
    }


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
    prefix: str, runs: list[dict[str, Any]], arrays: State, scene: Scene, linkage: Linkage
) -> tuple[Run, ...]:
    found = []
    for k, told in enumerate(runs):
        own = part(arrays, f"{prefix}/{k}")
        recorder = empty_recorder(scene, linkage, k)
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
