"""Engines: a linkage, a start and a plan in, a run out."""

from presswear.tools.lazy_names import attach_stub

__getattr__, __dir__, __all__ = attach_stub(__name__, __file__)
