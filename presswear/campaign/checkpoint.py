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

    index: int = 0  # number of the stage that runs
    # depth of the surfaces of its runs, m
    depth: Array = field(default_factory=lambda: np.zeros(0))
    stage: EnsembleState | None = None  # its finished runs, while they wear
    update: WearUpdate | None = None  # last refinement of the wear update after it
    # unfinished runs of the stage or of a refinement
    running: EnsembleState = EnsembleState()
    # state of the service life, which comes before the stages
    life: LifeState | None = None
    new: WearRates | None = None  # wear rates of the new surfaces, in a quick life

    @property
    def words(self) -> str:
        """Description of the last stored cycle."""
        if self.life is not None and self.life.running.runs:
            blocks = self.life.refinements[-1].blocks if self.life.refinements else ()
            strokes = blocks[-1].strokes if blocks else 0.0
            number = self.life.place[0]
            return (
                f"refinement {number} of the life, {large(strokes, digits=2)} strokes"
            )
        wear = "" if self.stage is None else ", the wear after it"
        return f"stage {self.index}{wear}, cycle {self.running.cycles}"

    def save(self) -> State:
        """Return the arrays in it by number, and everything else as a document."""
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
