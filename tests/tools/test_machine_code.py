"""Machine code of a kernel does not depend on what was compiled before it."""

import math
import re
from collections.abc import Callable
from functools import partial
from typing import Any

import pytest

from presswear.tools.compile import Kernel, compiled, inlined

CALLERS: dict[str, Callable[..., Any]] = {
    "exact": partial(Kernel, fastmath=False),
    "inlined": inlined,
    "compiled": compiled,
}


def _caller(kind: Callable[..., Any], leaf: Any) -> Any:
    """Return a new kernel that calls another."""

    @kind
    def caller(x: float, y: float) -> float:
        return leaf(x, y) + leaf(y, x * y)

    return caller


def _leaf() -> Any:
    """Return a new kernel with sums of products of its own and in a function of numba."""

    @compiled
    def leaf(x: float, y: float) -> float:
        return x * y - 0.3 * y + math.hypot(x, y) + max(x * x, y - x * y)

    return leaf


def _machine_code(kernel: Any) -> str:
    """Return the code for two numbers, its symbols numbered in their order."""
    kernel(0.1, 0.7)
    (code,) = kernel.from_python.overloads.values()
    symbols: dict[str, str] = {}

    def number(symbol: re.Match[str]) -> str:
        return symbols.setdefault(symbol[0], f"symbol {len(symbols)}")

    text = re.sub(r"_ZN[\w.$]*", number, code.library.get_asm_str())
    return re.sub(r"missing Environment: .*|\.size.*", "", text)


@pytest.mark.parametrize("kind", CALLERS)
@pytest.mark.parametrize("earlier", CALLERS)
def test_earlier_callers_do_not_change_the_machine_code(earlier, kind):
    expected = _machine_code(_caller(CALLERS[kind], _leaf()))
    leaf = _leaf()
    _machine_code(_caller(CALLERS[earlier], leaf))
    kernel = _caller(CALLERS[kind], leaf)
    assert _machine_code(kernel) == expected


def test_callees_have_no_machine_code_but_within_their_callers():
    leaf = _leaf()
    caller = _caller(compiled, leaf)
    assert _machine_code(caller)
    (code,) = leaf._from_kernels.overloads.values()
    assert not code.library.get_pointer_to_function(code.fndesc.llvm_func_name)
    # From Python it is compiled apart, with equal results.
    x = 0.1
    y = 0.7
    assert caller(x, y) == leaf(x, y) + leaf(y, x * y)
    assert caller.py_func(x, y) == pytest.approx(caller(x, y), rel=1e-15)
