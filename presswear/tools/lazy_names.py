"""Public names of a package, each imported when it is first used."""

# Further imports would delay the command line, which then prints a traceback at Ctrl-C.
import sys
from importlib import import_module


def attach_stub(package: str, file: str) -> tuple[object, object, list[str]]:
    """Return ``__getattr__``, ``__dir__`` and ``__all__`` of a package with a stub.

    The lines ``from MODULE import NAME as NAME`` of ``__init__.pyi`` list the names, as
    in ``lazy_loader`` of Scientific Python (SPEC 1). Type checkers read the stub, too.

    Parameters
    ----------
    package : str
        ``__name__`` of the package.
    file : str
        ``__file__`` of the package.
    """
    modules = {}  # by name
    with open(f"{file}i", encoding="utf-8") as stub:
        for line in stub:
            words = line.split()
            if words[:1] == ["from"] and words[4:5] == ["as"]:
                modules[words[3]] = words[1]
    names = list(modules)
    submodules = [name for name in names if modules[name] == package]

    def hint_at(name: str) -> str:
        for submodule in submodules:
            if name in dir(import_module(f"{package}.{submodule}")):
                return f"; it is {package}.{submodule}.{name}"
        return str(import_module("presswear.tools.errors").remedy(name, names))

    def load(name: str) -> object:
        if name not in modules:
            hint = hint_at(name)
            raise AttributeError(f"module {package!r} has no attribute {name!r}{hint}")
        if name in submodules:
            return import_module(f"{package}.{name}")
        value = getattr(import_module(modules[name]), name)
        if hasattr(value, "__dataclass_fields__"):
            document = import_module("presswear.tools.serialize").documented
            document(value, value() if name == "Scene" else None)
        setattr(sys.modules[package], name, value)
        return value

    return load, lambda: list(names), names
