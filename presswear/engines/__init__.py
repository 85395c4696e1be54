"""Engines: a linkage and a start in, a Run out."""

from collections.abc import Callable
from typing import Any

from presswear.engines.base import AnyAccuracy, DaeAccuracy, Plan, Run, Start, TreeAccuracy
from presswear.linkage import Linkage

Engine = Callable[[Linkage, Start, Any, Plan], Run]
"""Called with the engine's own kind of accuracy."""


def engine_for(accuracy: AnyAccuracy) -> Engine:
    """The engine that an accuracy belongs to.

    Imported when asked for, so that no command pays for an engine it does not use.
    """
    if isinstance(accuracy, DaeAccuracy):
        from presswear.engines.dae.engine import simulate as in_house

        return in_house
    if isinstance(accuracy, TreeAccuracy):
        from presswear.engines.exudyn_tree import simulate as as_tree

        return as_tree
    from presswear.engines.exudyn_joints import simulate as with_joints

    return with_joints
