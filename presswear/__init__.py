"""Dynamics and wear of linkages with clearance in their joints, in Exudyn.

>>> import presswear as pw
>>> result = pw.run(pw.scenes.wear_times(clearance="0.6 mm", cycles=5), "results/first")
>>> print(result)

The public names are listed in ``__init__.pyi``; each is imported when it is first used.
"""

import re
from importlib import import_module
from pathlib import Path
from typing import Any

_PACKAGES = {"scenes": "presswear.scene.catalog", "statistics": "presswear.recording.statistics"}
_STUB = Path(__file__).with_suffix(".pyi").read_text(encoding="utf-8")
_MODULES = {
    name: module for module, name in re.findall(r"^from (\S+) import (\w+) as", _STUB, re.MULTILINE)
}

__all__ = ["scenes", *_MODULES]


def __getattr__(name: str) -> Any:
    if name in _PACKAGES:
        return import_module(_PACKAGES[name])
    if name == "__version__":
        return import_module("importlib.metadata").version("presswear")
    if name not in _MODULES:
        hint = import_module("presswear.tools.errors").nearest(name, __all__)
        raise AttributeError(f"module 'presswear' has no attribute {name!r}{hint}")
    value = getattr(import_module(_MODULES[name]), name)
    if hasattr(value, "__dataclass_fields__"):
        document = import_module("presswear.tools.serialize").documented
        document(value, value() if name == "Scene" else None)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return list(__all__)
