"""A mechanism as data: bodies, joints, drives, loads, laws, surfaces, and the named mechanisms."""

from presswear.tools.lazy_names import attach_stub

__getattr__, __dir__, __all__ = attach_stub(__name__, __file__)
