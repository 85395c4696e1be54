"""Scenes as older versions stored them, made today's: nothing that they left open is guessed.

What a version did not ask for it did in one way; that way is written down here, and not
taken from today's defaults, which may change.  Whoever adds a field to a scene adds what
results from before it mean.
"""

from collections.abc import Mapping
from typing import Any

_NUMERICS = {
    "steps_per_contact",
    "steps_sustained",
    "free_steps",
    "integrator",
    "integration_tolerance",
    "equal_step",
    "projection",
}
"""What was the scene's own before there was an open tree."""

COMPLETE = 3
"""First schema whose scenes say everything."""
_ADDED: dict[str, Any] = {
    "statuses": {},
    "drive_torque": "off",
    "starts": 1,
    # Every wear was one jump.
    "extrapolation": "single",
    "depth_step": 0.005,
}
_ADDED_CONVENTIONS = {"contact": "radial"}
_ADDED_NUMERICS = {
    "tree_tolerance": 1e-8,
    "integrator": "dop853",
    "integration_tolerance": 1e-9,
    "equal_step": 1e-5,
    "projection": "off",
}


def migrated(scene: Any, schema: int) -> Any:
    """A stored scene with everything that a scene has today; what is no scene stays as it is.

    Parameters
    ----------
    scene : object
        As ``Scene.as_dict`` of some version gave it.
    schema : int
        Of the document that holds it: in 1, the mechanism was a press.
    """
    if not isinstance(scene, Mapping) or schema >= COMPLETE:
        return scene
    plain = dict(scene)
    if schema == 1 and isinstance(plain.get("press"), Mapping):
        plain["mechanism"] = {"kind": "press", **plain.pop("press")}
    if "numerics" not in plain and "free_steps" in plain:
        numerics = {name: plain.pop(name) for name in _NUMERICS & plain.keys()}
        plain["numerics"] = {**_ADDED_NUMERICS, **numerics}
        # There was no open tree, and torques were always stored.
        plain["drive_torque"] = "on"
        if plain.get("engine") == "exudyn":
            plain["engine"] = "exudyn-joints"
    if isinstance(plain.get("conventions"), Mapping):
        plain["conventions"] = {**_ADDED_CONVENTIONS, **plain["conventions"]}
    return {**_ADDED, **plain}
