"""Kinds of mechanisms of a scene: those made of a few quantities, and linkages."""

from typing import Any, cast, get_args

from presswear.linkage.link_drive import LinkDrive
from presswear.linkage.linkage import Linkage, linkage_from
from presswear.linkage.mechanisms import FourBar, SixBar, SliderCrank, TwoPoint
from presswear.linkage.press import Press
from presswear.tools.choices import Choice
from presswear.tools.serialize import make

Parametric = Press | SliderCrank | FourBar | SixBar | TwoPoint | LinkDrive
AnyMechanism = Parametric | Linkage
MECHANISMS: dict[str, type[Parametric]] = {
    mechanism.kind: mechanism for mechanism in get_args(Parametric)
}
"""Classes of the mechanisms that are made of a few quantities, by kind."""


def mechanism_from(data: Any) -> AnyMechanism:
    """Return a mechanism from its kind, or from plain data with a kind."""
    data = {"kind": data} if isinstance(data, str) else data
    kind = data.get("kind")
    Choice((*MECHANISMS, Linkage.kind)).check("kind of mechanism", kind)
    if kind == Linkage.kind:
        return linkage_from(data, "mechanism")
    return cast(AnyMechanism, make("mechanism", MECHANISMS[kind], data))
