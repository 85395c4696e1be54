"""Questions that take more than one run; each is imported when it is asked."""

from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

from presswear.tools.checked import checked

if TYPE_CHECKING:
    from presswear.studies.plan import Change, Study

STUDIES = {
    "paper": "Study: every number and figure of the paper, with errors",
    "runaway": "Study: does the second wear run away? One reading changed at a time",
    "coverage": "Study: do the intervals hold? 60 campaigns beside many long ones",
}
"""Names and titles of the studies, which run several scenes each."""
OF_A_SCENE = ("lives",)
"""Studies of any scene, made by a command of their own."""


def make_study(name: str, change: "Change") -> "Study":
    """A named study, its scenes begun from changed ones; InputError lists the names."""
    from presswear.studies.plan import unchanged
    from presswear.tools.errors import unknown

    if name not in STUDIES:
        raise unknown("study", name, STUDIES)
    make = import_module(f"presswear.studies.{name}.variants").make
    found: Study = make(change)
    if change is not unchanged:
        _check_labels(make(unchanged), found)
    return found


def _check_labels(plain: "Study", found: "Study") -> None:
    """InputError where a change touches what the variants of a study differ in and are named by."""
    from presswear.scene.settings import differences
    from presswear.tools.errors import InputError

    scenes = [variant.scene.modelled() for variant in plain.variants]
    varied = {key for scene in scenes for key, *_ in differences(scenes[0], scene)}
    for scene, variant in zip(scenes, found.variants, strict=True):
        for key, own, given in differences(scene, variant.scene.modelled()):
            if key in varied:
                raise InputError(
                    f"{key} = {given}: the study {plain.name} varies it itself and names its "
                    f"variants by it ({variant.label} has {own}); run a scene of your own"
                )


@checked
def study(name: str, **settings: Any) -> "Study":
    """A named study, its scenes changed by settings as those of ``presswear.scenes`` are."""
    from presswear.scene.settings import changed

    return make_study(name, lambda scene: changed(scene, settings))


@checked
def write_report(study: "Study", folder: str | Path) -> tuple[str, Path]:
    """Write the report of a study that ran into its folder; gives its answer and its path."""
    from presswear.studies.plan import Study
    from presswear.tools.errors import InputError, shown

    if not isinstance(study, Study):
        raise InputError(f"study = {shown(study)}: a Study is expected")
    module = import_module(f"presswear.studies.{study.name}.report")
    found: tuple[str, Path] = module.write_report(study, Path(folder))
    return found
