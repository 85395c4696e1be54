"""Public names of ``presswear.results``."""

from presswear.results.bottom_dead_centre import rise as rise
from presswear.results.joint_result import JointResult as JointResult
from presswear.results.life_from_readings import remaining_life as remaining_life
from presswear.results.readings import Reading as Reading
from presswear.results.readings import read_readings as read_readings
from presswear.results.result import read_surfaces as read_surfaces
from presswear.results.stage import StageResult as StageResult

__all__: list[str]
