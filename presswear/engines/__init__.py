"""Engines: a linkage and a start in, a Run out."""

from collections.abc import Callable

from presswear.engines.base import Accuracy, Plan, Run, Start
from presswear.linkage import Linkage

Engine = Callable[[Linkage, Start, Accuracy, Plan], Run]


def engine_named(name: str) -> Engine:
    """The engine of a name; ``exudyn`` takes the fittest of Exudyn's.

    Imported when asked for, so that no command pays for an engine it does not use.
    """
    from presswear.engines.exudyn_joints import simulate

    return {"exudyn": simulate, "exudyn-joints": simulate}[name]
