"""Public names; ``presswear`` loads each when it is first used."""

from presswear import engines as engines
from presswear import linkage as linkage
from presswear import results as results
from presswear import statics as statics
from presswear import statistics as statistics
from presswear.analysis.bifurcation import Diagram as Diagram
from presswear.analysis.bifurcation import load_diagram as load_diagram
from presswear.api import bifurcation as bifurcation
from presswear.api import run as run
from presswear.api import simulate as simulate
from presswear.campaign.runs import run_scenes as run_scenes
from presswear.linkage.bodies import Bar as Bar
from presswear.linkage.bodies import Body as Body
from presswear.linkage.drives import Drive as Drive
from presswear.linkage.drives import Follow as Follow
from presswear.linkage.drives import GearedDrive as GearedDrive
from presswear.linkage.drives import LinearDrive as LinearDrive
from presswear.linkage.joints import Guide as Guide
from presswear.linkage.joints import Pin as Pin
from presswear.linkage.link_drive import LinkDrive as LinkDrive
from presswear.linkage.linkage import assemble as assemble
from presswear.linkage.load_laws import Harmonics as Harmonics
from presswear.linkage.load_laws import OverPosition as OverPosition
from presswear.linkage.load_laws import OverTime as OverTime
from presswear.linkage.loads import Force as Force
from presswear.linkage.loads import Load as Load
from presswear.linkage.loads import Moment as Moment
from presswear.linkage.mechanisms import FourBar as FourBar
from presswear.linkage.mechanisms import SixBar as SixBar
from presswear.linkage.mechanisms import SliderCrank as SliderCrank
from presswear.linkage.mechanisms import TwoPoint as TwoPoint
from presswear.linkage.motion_pieces import Rise as Rise
from presswear.linkage.motor import Motor as Motor
from presswear.linkage.press import Press as Press
from presswear.linkage.process import Blanking as Blanking
from presswear.linkage.process import Coining as Coining
from presswear.linkage.process import Drawing as Drawing
from presswear.linkage.spring import Spring as Spring
from presswear.results.result import Result as Result
from presswear.results.result import load as load
from presswear.scene import catalog
from presswear.scene.bearing import Bearing as Bearing
from presswear.scene.conventions import Conventions as Conventions
from presswear.scene.files import scene_from as scene_from
from presswear.scene.options import Life as Life
from presswear.scene.options import Recording as Recording
from presswear.scene.scene import Scene as Scene
from presswear.scene.settings import changed as changed
from presswear.sweeps.sweep import Sweep as Sweep
from presswear.sweeps.sweep import function_of as function_of
from presswear.sweeps.sweep import load_sweep as load_sweep
from presswear.sweeps.sweep import sweep as sweep
from presswear.tools.errors import InputError as InputError
from presswear.tools.errors import RunFailed as RunFailed

__all__: list[str]
__version__: str
scenes = catalog
