"""Settings in groups, and the settings that a user changes first."""

from presswear.scene.bearing import NOT_COMMON
from presswear.scene.scene import Scene
from presswear.scene.setting_list import (
    Setting,
    applicable_settings_of,
    settings_in,
)

_WORK_TITLE = "Process and life"
_RUN_TITLE = "Run"
# Keys outside the mechanism, the process and the life that a user changes first
_FIRST = {
    "joints",
    "clearance",
    "bearing_radius",
    "width",
    "materials",
    "youngs_modulus",
    "wear_coefficient",
    "friction",
    "restitution",
    "viscosity",
    "pressure_limit",
    "pv_limit",
    "engine",
    "conventions",
    "wear_updates",
    "cycles",
    "cycles_per_update",
    "max_cycles",
    "replicates",
    "tolerance",
}


def settings_in_groups(scene: Scene, every: bool = False) -> dict[str, list[Setting]]:
    """Return the settings of a scene by the title of their group.

    They are those that a user changes first, or with ``every`` all of them.
    """
    owners = {
        "Mechanism": scene.mechanism,
        "Bearings": scene.bearings,
        "Conventions": scene.conventions,
        "Engines": scene.numerics,
        "Recording": scene.recording,
    }
    title_of = {}
    for title, owner in owners.items():
        for setting in settings_in(owner):
            title_of[setting.key] = title
    titles = ("Mechanism", "Bearings", _WORK_TITLE, _RUN_TITLE, *owners)
    groups: dict[str, list[Setting]] = {title: [] for title in titles}
    for setting in applicable_settings_of(scene):
        prefix, _, name = setting.key.rpartition(".")
        joint, _, _ = prefix.partition(".")
        if name not in _FIRST and joint in scene.bearing_joints:
            prefix = joint  # a number of the user law of a joint
        title = title_of.get(setting.key, _RUN_TITLE)
        is_first = title == "Mechanism" or setting.key in _FIRST
        if prefix in scene.bearing_joints:
            title = "Bearings"
            is_first = name in {*_FIRST, *NOT_COMMON}
        elif setting.key == "conventions":
            title = "Conventions"
        elif "process" in (prefix, name) or "life" in (prefix, name):
            title = _WORK_TITLE
            is_first = True
        if every or is_first:
            groups[title].append(setting)
    return {title: settings for title, settings in groups.items() if settings}
