"""Signatures of the Python reference: parameters with short names of their types."""

import inspect
import re
from typing import Any, get_type_hints

from sphinx.application import Sphinx
from sphinx.util.typing import stringify_annotation

_DESCRIBED = ("class", "exception", "function", "method")


def signature_of(
    app: Sphinx, what: str, name: str, obj: Any, *_: Any
) -> tuple[str, str] | None:
    """Return parameters and result of a class or a function as texts; None for others."""
    if what not in _DESCRIBED:
        return None
    try:
        signature = inspect.signature(obj)
    except (TypeError, ValueError):
        return None
    hints = _hints_of(obj)
    parts = [
        _text_of(parameter, hints.get(parameter.name, parameter.annotation))
        for parameter in signature.parameters.values()
        if parameter.name != "self"
    ]
    result = hints.get("return", signature.return_annotation)
    has_result = not inspect.isclass(obj) and result not in (
        signature.empty,
        type(None),
    )
    return f"({', '.join(parts)})", _short(result) if has_result else ""


def _hints_of(obj: Any) -> dict[str, Any]:
    """Return the types of parameters; none where one is imported for type checks only."""
    has_init = inspect.isclass(obj) and inspect.isfunction(obj.__init__)
    try:
        return get_type_hints(obj.__init__ if has_init else obj)
    except (NameError, TypeError):
        return {}


def _text_of(parameter: inspect.Parameter, hint: Any) -> str:
    """Return a parameter with its type and its default; ``...`` for a long one."""
    text = str(parameter.replace(annotation=parameter.empty, default=parameter.empty))
    if hint is not parameter.empty:
        text += f": {_short(hint)}"
    default = parameter.default
    if default is parameter.empty:
        return text
    is_short = isinstance(default, str | int | float | type(None) | tuple)
    shown = f"{default:.6g}" if isinstance(default, float) else repr(default)
    return f"{text} = {shown if is_short else '...'}"


def _short(hint: Any) -> str:
    """Return a type without the names of its modules."""
    return re.sub(r"(\w+\.)+(?=\w)", "", stringify_annotation(hint))
