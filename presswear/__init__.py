"""Dynamics and wear of linkages with clearance in their joints, in Exudyn.

>>> import presswear as pw
>>> result = pw.run(pw.scenes.wear_times(clearance="0.6 mm", cycles=5), "results/first")
>>> print(result)

The public names are listed in ``__init__.pyi``; each is imported when it is first used.
"""

# Further imports would delay the command line, which then prints a traceback at Ctrl-C.
from importlib import import_module

_PACKAGES = {
    "scenes": "presswear.scene.catalog",
    "statistics": "presswear.recording.statistics",
}
with open(f"{__file__}i", encoding="utf-8") as _stub:
    _WORDS = [line.split() for line in _stub if line.startswith("from ")]
_MODULES = {words[3]: words[1] for words in _WORDS if words[4:5] == ["as"]}

__all__ = ["scenes", *_MODULES]


def __getattr__(name: str) -> object:
    if name in _PACKAGES:
        return import_module(_PACKAGES[name])
    if name == "__version__":
        return import_module("importlib.metadata").version("presswear")
    if name not in _MODULES:
        hint = import_module("presswear.tools.errors").remedy(name, __all__)
        raise AttributeError(f"module 'presswear' has no attribute {name!r}{hint}")
    value = getattr(import_module(_MODULES[name]), name)
    if hasattr(value, "__dataclass_fields__"):
        document = import_module("presswear.tools.serialize").documented
        document(value, value() if name == "Scene" else None)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return list(__all__)
