"""The study ``lives``: the life of a scene, and of scenes that differ from it in one thing."""

import re
from collections.abc import Mapping

from presswear.scene.changes import title_of
from presswear.scene.scene import Scene
from presswear.scene.settings import changed
from presswear.studies.plan import Study, Variant
from presswear.tools.errors import InputError

PLAIN = "plain"
"""Key of the scene that the others are compared with."""


def make(scene: Scene, others: Mapping[str, Mapping[str, str]]) -> Study:
    """The study of a scene with a life.

    Parameters
    ----------
    others : mapping of str to mapping
        What differs in each of the others, in words, and the settings that make it so.

    Raises
    ------
    InputError
        For settings that do not fit the scene, or change nothing.
    """
    variants = [Variant(PLAIN, "as it is", scene)]
    for number, (label, settings) in enumerate(others.items(), 1):
        other = changed(scene, settings)
        if other.modelled() == scene.modelled():
            raise InputError(f"{label}: it changes nothing, and there is nothing to compare")
        word = re.sub(r"[^A-Za-z0-9.+=,_-]+", "-", label).strip("-")
        variants.append(Variant(f"{number}-{word}", label, other))
    return Study(
        "lives",
        f"Lives: {title_of(scene)}",
        "How much longer or shorter does it live with one thing changed?",
        tuple(variants),
    )
