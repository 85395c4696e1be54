"""Statistics of cycles: means, wear maps and their 95 % intervals."""

from presswear.recording.statistics import *  # noqa: F403
from presswear.recording.statistics import __all__ as __all__
