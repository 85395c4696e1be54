"""Dynamics and wear of linkages with clearance in their joints, in Exudyn.

>>> import presswear as pw
>>> result = pw.run(pw.scenes.wear_times(clearance="0.6 mm", cycles=5), "results/first")
>>> print(result)

Everything here is loaded when it is asked for.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import presswear.recording.statistics as statistics
    import presswear.scene.catalog as scenes
    from presswear.campaign.campaign import run as run
    from presswear.campaign.campaign import run_scenes as run_scenes
    from presswear.engines.settings import ExudynJoints as ExudynJoints
    from presswear.engines.settings import ExudynTree as ExudynTree
    from presswear.engines.settings import InHouse as InHouse
    from presswear.linkage.drives import Drive as Drive
    from presswear.linkage.drives import Dwell as Dwell
    from presswear.linkage.drives import Follow as Follow
    from presswear.linkage.drives import Forming as Forming
    from presswear.linkage.drives import Pendulum as Pendulum
    from presswear.linkage.drives import Rise as Rise
    from presswear.linkage.elements import Attachment as Attachment
    from presswear.linkage.elements import Bar as Bar
    from presswear.linkage.elements import Body as Body
    from presswear.linkage.elements import ClearanceJoint as ClearanceJoint
    from presswear.linkage.elements import Guide as Guide
    from presswear.linkage.elements import OutputPoint as OutputPoint
    from presswear.linkage.elements import Pin as Pin
    from presswear.linkage.elements import Revolute as Revolute
    from presswear.linkage.elements import WearLaw as WearLaw
    from presswear.linkage.laws import FrictionLaw as FrictionLaw
    from presswear.linkage.laws import Materials as Materials
    from presswear.linkage.laws import NormalLaw as NormalLaw
    from presswear.linkage.linkage import Linkage as Linkage
    from presswear.linkage.linkage import assemble as assemble
    from presswear.linkage.loads import Blanking as Blanking
    from presswear.linkage.loads import Coining as Coining
    from presswear.linkage.loads import Drawing as Drawing
    from presswear.linkage.loads import Force as Force
    from presswear.linkage.loads import Harmonics as Harmonics
    from presswear.linkage.loads import Load as Load
    from presswear.linkage.loads import Moment as Moment
    from presswear.linkage.loads import OverPosition as OverPosition
    from presswear.linkage.loads import OverTime as OverTime
    from presswear.linkage.loads import Spring as Spring
    from presswear.linkage.mechanisms import Press as Press
    from presswear.linkage.mechanisms import SliderCrank as SliderCrank
    from presswear.linkage.surface import Surface as Surface
    from presswear.physics.statics import deflection as deflection
    from presswear.physics.statics import total_clearance as total_clearance
    from presswear.recording.observer import Observer as Observer
    from presswear.recording.observer import Progress as Progress
    from presswear.recording.statistics import Estimate as Estimate
    from presswear.results.result import Result as Result
    from presswear.results.result import load as load
    from presswear.results.result import read_surfaces as read_surfaces
    from presswear.results.stage import JointResult as JointResult
    from presswear.results.stage import StageResult as StageResult
    from presswear.scene.bearing import Bearing as Bearing
    from presswear.scene.bearing import Conventions as Conventions
    from presswear.scene.options import Life as Life
    from presswear.scene.options import Recording as Recording
    from presswear.scene.scene import Scene as Scene
    from presswear.scene.settings import changed as changed
    from presswear.sweeps.sweep import Sweep as Sweep
    from presswear.sweeps.sweep import function_of as function_of
    from presswear.sweeps.sweep import sweep as sweep
    from presswear.tools.errors import InputError as InputError
    from presswear.tools.errors import RunFailed as RunFailed

    __version__: str

_ROOMS = {
    "campaign.campaign": ("run", "run_scenes"),
    "engines.settings": ("ExudynJoints", "ExudynTree", "InHouse"),
    "linkage.drives": ("Drive", "Dwell", "Follow", "Forming", "Pendulum", "Rise"),
    "linkage.elements": (
        "Attachment",
        "Bar",
        "Body",
        "ClearanceJoint",
        "Guide",
        "OutputPoint",
        "Pin",
        "Revolute",
        "WearLaw",
    ),
    "linkage.laws": ("FrictionLaw", "Materials", "NormalLaw"),
    "linkage.linkage": ("Linkage", "assemble"),
    "linkage.loads": (
        "Blanking",
        "Coining",
        "Drawing",
        "Force",
        "Harmonics",
        "Load",
        "Moment",
        "OverPosition",
        "OverTime",
        "Spring",
    ),
    "linkage.mechanisms": ("Press", "SliderCrank"),
    "linkage.surface": ("Surface",),
    "physics.statics": ("deflection", "total_clearance"),
    "recording.observer": ("Progress", "Observer"),
    "recording.statistics": ("Estimate",),
    "results.result": ("Result", "load", "read_surfaces"),
    "results.stage": ("JointResult", "StageResult"),
    "scene.bearing": ("Bearing", "Conventions"),
    "scene.options": ("Life", "Recording"),
    "scene.scene": ("Scene",),
    "scene.settings": ("changed",),
    "sweeps.sweep": ("Sweep", "function_of", "sweep"),
    "tools.errors": ("InputError", "RunFailed"),
}
_OWNERS = {name: room for room, names in _ROOMS.items() for name in names}

_MODULES = {"scenes": "scene.catalog", "statistics": "recording.statistics"}

__all__ = ["scenes", "statistics", *_OWNERS]


def __getattr__(name: str) -> Any:
    """Load what is asked for."""
    if name in _MODULES:
        return import_module(f"presswear.{_MODULES[name]}")
    if name == "__version__":
        return import_module("importlib.metadata").version("presswear")
    if name not in _OWNERS:
        raise AttributeError(f"module 'presswear' has no attribute {name!r}")
    return getattr(import_module(f"presswear.{_OWNERS[name]}"), name)


def __dir__() -> list[str]:
    """Names that can be asked for."""
    return list(__all__)
