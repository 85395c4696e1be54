"""Engines: a linkage and a start in, a Run out."""

from collections.abc import Callable
from typing import Any

from presswear.engines.base import Plan, Run, Start
from presswear.linkage import Linkage

Engine = Callable[[Linkage, Start, Any, Plan], Run]
"""Called with the engine's own kind of accuracy."""


def engine_named(name: str) -> Engine:
    """The engine of a name; ``exudyn`` takes the fittest of Exudyn's.

    Imported when asked for, so that no command pays for an engine it does not use.
    """
    if name == "dae":
        from presswear.engines.dae.engine import simulate as in_house

        return in_house
    from presswear.engines.exudyn_joints import simulate as with_joints

    return {"exudyn": with_joints, "exudyn-joints": with_joints}[name]
