"""Checkpoint: the state of a campaign between two cycles, saved as named arrays."""

import json
from collections.abc import Mapping
from dataclasses import dataclass, field, fields, is_dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswear.campaign.ensemble import EnsembleState
from presswear.campaign.service_life import LifeState
from presswear.campaign.wear_update import WearUpdate
from presswear.tools.arrays import State

Array = NDArray[np.float64]

_DOCUMENT = "document"  # array that holds everything else as JSON


@dataclass(frozen=True)
class Checkpoint:
    """State of a campaign between two cycles.

    Attributes
    ----------
    index : int
        Index of the stage that runs.
    depth : ndarray, shape (runs, joints, 2, bins)
        Depth of the surfaces of its runs, m.
    stage : EnsembleState or None
        Its runs, if they are finished and the wear update after them is being applied.
    update : WearUpdate or None
        Last pass over that wear update.
    running : EnsembleState
        Unfinished runs: of the stage, or of the next pass.
    life : LifeState or None
        State of the service life, which comes before the stages.
    """

    index: int = 0
    depth: Array = field(default_factory=lambda: np.zeros(0))
    stage: EnsembleState | None = None
    update: WearUpdate | None = None
    running: EnsembleState = EnsembleState()
    life: LifeState | None = None

    @property
    def words(self) -> str:
        """Description of the last stored cycle."""
        if self.life is not None and self.life.running.runs:
            blocks = self.life.passes[-1].blocks if self.life.passes else ()
            strokes = blocks[-1].strokes if blocks else 0.0
            return f"pass {self.life.place[0]} over the life, {strokes:.3g} strokes"
        wear = "" if self.stage is None else ", the wear after it"
        return f"stage {self.index}{wear}, cycle {self.running.cycles}"

    def save(self) -> dict[str, NDArray[Any]]:
        """Return the checkpoint as named arrays of numbers."""
        arrays: dict[str, NDArray[Any]] = {}
        document = json.dumps(_split(self, "", arrays), default=lambda number: number.item())
        return arrays | {_DOCUMENT: np.frombuffer(document.encode(), np.uint8)}

    @staticmethod
    def load(arrays: State) -> "Checkpoint":
        """Return the checkpoint that ``save`` gave."""
        import msgspec  # slow to import

        document = json.loads(arrays[_DOCUMENT].tobytes())
        return msgspec.convert(_joined(document, arrays), Checkpoint)


def _split(value: Any, name: str, arrays: dict[str, NDArray[Any]]) -> Any:
    """Return plain data; arrays in it are moved to ``arrays`` and replaced by their names."""
    if isinstance(value, np.ndarray):
        arrays[name] = value
        return {"array": name}
    if is_dataclass(value):
        value = {item.name: getattr(value, item.name) for item in fields(value)}
    if isinstance(value, Mapping):
        return {key: _split(item, f"{name}/{key}", arrays) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_split(item, f"{name}/{k}", arrays) for k, item in enumerate(value)]
    return value


def _joined(value: Any, arrays: State) -> Any:
    if isinstance(value, dict):
        if value.keys() == {"array"}:
            return arrays[value["array"]]
        return {key: _joined(item, arrays) for key, item in value.items()}
    return [_joined(item, arrays) for item in value] if isinstance(value, list) else value
