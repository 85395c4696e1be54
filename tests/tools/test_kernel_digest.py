"""Digests of kernels change with what their machine code depends on, and with nothing else."""

from typing import Any

import pytest

from presswear.tools.kernel_digest import function_digest

TEXT = """
import math
from typing import NamedTuple
import numpy as np
from presswear.tools.compile import compiled, inlined, lazily_compiled
from presswear.tools.packing import unpack

FACTOR = 2.0
NODES = np.array([1.0, 2.0])

class Pair(NamedTuple):
    first: float
    second: float

@lazily_compiled(0.0, 0.0)
def rare(x):
    return 3.0 * x

@inlined
def leaf(x):
    return FACTOR * x

@compiled
def middle(x, y=1.0):
    '''Return a number.'''
    return leaf(x) + NODES[0] + rare(x) * y

@compiled
def unrelated(x):
    return 7.0 * x

@compiled
def outer(packed, x):
    # A comment
    (data,) = unpack(packed)
    return middle(x) + Pair(x, math.sin(x)).first
"""


def digest_of(text: str) -> str:
    names: dict[str, Any] = {"__name__": "text"}
    exec(compile(text, "text.py", "exec"), names)
    return function_digest(names["outer"].py_func)


@pytest.mark.parametrize(
    ("before", "after"),
    [
        ("return middle(x) +", "return middle(x) -"),
        ("return leaf(x)", "return 1.0 + leaf(x)"),
        ("return FACTOR * x", "return FACTOR + x"),
        ("@inlined", "@compiled"),
        ("FACTOR = 2.0", "FACTOR = 2.0000000001"),
        ("FACTOR = 2.0", "FACTOR = 2"),
        ("[1.0, 2.0]", "[1.0, 3.0]"),
        ("y=1.0", "y=2.0"),
        ("first: float\n    second: float", "second: float\n    first: float"),
        ("math.sin", "math.cos"),
        ("(data,) = unpack(packed)", "data = unpack(packed)"),
    ],
)
def test_a_change_of_code_changes_the_digest(before, after):
    assert before in TEXT
    assert digest_of(TEXT) != digest_of(TEXT.replace(before, after))


@pytest.mark.parametrize(
    ("before", "after"),
    [
        ("# A comment", "# Another\n    # comment"),
        ("Return a number", "Return one number"),
        ("return 7.0 * x", "return 8.0 * x"),
        ("return 3.0 * x", "return 4.0 * x"),  # called by its address
        ("def leaf(x)", "def leaf(x: float)"),
    ],
)
def test_other_changes_leave_the_digest(before, after):
    assert before in TEXT
    assert digest_of(TEXT) == digest_of(TEXT.replace(before, after))
