"""Dynamics and wear of linkages with clearance in their joints, in Exudyn.

>>> import presswear as pw
>>> result = pw.run(pw.scenes.wear_times(clearance="0.6 mm", cycles=5), "results/first")
>>> print(result)

The public names are listed in ``__init__.pyi``; each is imported when it is first used.
"""

# Further imports would delay the command line, which then prints a traceback at Ctrl-C.
from importlib import import_module

from presswear.tools.lazy_names import attach_stub

_load, __dir__, __all__ = attach_stub(__name__, __file__)
__all__.insert(0, "scenes")


def __getattr__(name: str) -> object:
    if name == "scenes":
        return import_module("presswear.scene.catalog")
    if name == "__version__":
        return import_module("importlib.metadata").version("presswear")
    return _load(name)
