"""Public names of ``presswear.engines``."""

from presswear.engines.base import Start as Start
from presswear.engines.settings import ExudynJoints as ExudynJoints
from presswear.engines.settings import ExudynTree as ExudynTree
from presswear.engines.settings import InHouse as InHouse
from presswear.recording.observer import Observer as Observer
from presswear.recording.observer import Progress as Progress

__all__: list[str]
