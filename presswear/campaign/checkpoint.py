"""Checkpoint: state of a campaign between two cycles."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswear.campaign.ensemble import EnsembleState
from presswear.campaign.quick_life import WearRates
from presswear.campaign.wear_histories import LifeState
from presswear.campaign.wear_update import WearUpdate
from presswear.tools.arrays import Array, State
from presswear.tools.numbers import large

_DOCUMENT = "document"  # array of a checkpoint that holds everything but its arrays


@dataclass(frozen=True)
class Checkpoint:
    """State of a campaign between two cycles, saved as named arrays."""

    index: int = 0  # number of the present stage
    # worn depth of the surfaces in the present stage, m
    depth: Array = field(default_factory=lambda: np.zeros(0))
    # finished runs of the present stage, during the wear update after it
    stage: EnsembleState | None = None
    update: WearUpdate | None = None  # last refinement of this wear update
    # unfinished runs of the stage or of a refinement
    running: EnsembleState = EnsembleState()
    # state of the service life, which comes before the stages
    life: LifeState | None = None
    new: WearRates | None = None  # wear rates of the new surfaces, in a quick life

    @property
    def words(self) -> str:
        """Description of the last stored cycle."""
        if self.life is not None and self.life.running.runs:
            strokes = 0.0
            if self.life.refinements and self.life.refinements[-1].blocks:
                strokes = self.life.refinements[-1].blocks[-1].strokes
            number = self.life.place[0]
            return (
                f"refinement {number} of the life, {large(strokes, digits=2)} strokes"
            )
        wear = "" if self.stage is None else ", the wear after it"
        return f"stage {self.index}{wear}, cycle {self.running.cycles}"

    def save(self) -> State:
        """Return the arrays of the checkpoint by number, and the rest as a document."""
        import msgspec  # slow to import

        arrays: dict[str, NDArray[Any]] = {}

        def number_of(value: Any) -> Any:
            if isinstance(value, np.generic):
                return value.item()
            arrays[f"{len(arrays)}"] = value
            return len(arrays) - 1

        document = msgspec.msgpack.encode(self, enc_hook=number_of)
        return arrays | {_DOCUMENT: np.frombuffer(document, np.uint8)}

    @staticmethod
    def load(arrays: State) -> "Checkpoint":
        """Return the checkpoint that ``save`` gave."""
        import msgspec  # slow to import

        document = arrays[_DOCUMENT].tobytes()
        return msgspec.msgpack.decode(
            document, type=Checkpoint, dec_hook=lambda kind, number: arrays[f"{number}"]
        )
