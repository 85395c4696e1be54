"""A scene as a function of its parameters, for optimizers and studies of other programs."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from presswear.results.provenance import program_digest
from presswear.scene.scene import Scene
from presswear.scene.settings import changed
from presswear.sweeps.measures import Asked, Own, at_last, measures_asked
from presswear.sweeps.work import SceneJob
from presswear.tools.errors import RunFailed

_EXUDYN = ("computationIndex", "functionData")
"""Keys that Exudyn's studies put beside the parameters: a count, and what all runs share."""


@dataclass(frozen=True)
class Function:
    """Measures of a scene over a dictionary of settings; pickled it goes to other processes.

    Attributes
    ----------
    scene : Scene
    asked : Asked
    is_one : bool
        True where one measure was asked for by itself, and a number is given in place of a list.
    otherwise : float or None
        Given for a run that fails; None: RunFailed.
    """

    scene: Scene
    asked: Asked
    is_one: bool
    otherwise: float | None

    def __call__(self, parameters: Mapping[str, Any]) -> float | list[float]:
        """Run the scene with settings changed: text with units, or numbers, SI.

        ``functionData``, as Exudyn hands it over, holds further settings.
        """
        shared, own = parameters.get(_EXUDYN[1], {}), dict(parameters)
        for key in _EXUDYN:
            own.pop(key, None)
        job = SceneJob(changed(self.scene, shared | own), self.asked, None, program_digest())
        outcome = job(lambda done, word="", rows=None: None)
        if outcome.reason:
            if self.otherwise is None:
                raise RunFailed(outcome.reason)
            found = [self.otherwise] * len(self.asked.keys)
        else:
            keys = [at_last(key, outcome.stages) for key in self.asked.keys]
            found = [
                outcome.values[key].value if key in outcome.values else math.nan for key in keys
            ]
        return found[0] if self.is_one else found


def function_of(
    scene: Scene,
    measures: str | Own | Sequence[str | Own],
    otherwise: float | None = None,
) -> Function:
    """A function from a dictionary of settings to what a run of the scene measures.

    Exudyn's ``ParameterVariation``, ``GeneticOptimization`` and ``ComputeSensitivities`` take it
    as it is, with ``useMultiProcessing`` too.

    Parameters
    ----------
    measures : str, callable, or sequence of these
        As of ``presswear.sweep``; one by itself gives a number, several a list.
    otherwise : float or None
        Value of a run that fails, such as 1e9 for an optimizer; None: RunFailed.
    """
    if isinstance(measures, str) or callable(measures):
        return Function(scene, measures_asked(scene, [measures]), True, otherwise)
    return Function(scene, measures_asked(scene, list(measures)), False, otherwise)
