"""Questions that take more than one run; each is imported when it is asked."""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from presswear.campaign.study import Study

STUDIES = {
    "paper": "Study: every number and figure of the paper, with errors",
    "runaway": "Study: does the second wear run away? One reading changed at a time",
}
"""Names and titles of the studies, which run several scenes each."""


def study(name: str, **settings: Any) -> "Study":
    """A named study, its scenes changed by settings as those of ``presswear.scenes`` are."""
    from presswear.scene.settings import changed
    from presswear.tools.errors import unknown

    if name not in STUDIES:
        raise unknown("study", name, STUDIES)
    found: Study = import_module(f"presswear.studies.{name}.variants").make(
        lambda scene: changed(scene, settings)
    )
    return found
