"""Results of a run: writing, resuming, reading and export."""

from presswear.tools.lazy_names import attach_stub

__getattr__, __dir__, __all__ = attach_stub(__name__, __file__)
