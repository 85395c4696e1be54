"""A mistake in a kernel is reported by file, line, statement and reason."""

# mypy: ignore-errors
# ruff: noqa: F821
import inspect
import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from python_process import python

from presswear.__main__ import main
from presswear.campaign import runs
from presswear.physics.equations.function import function_of
from presswear.tools.compile import compiled, entry_of, inlined, specialised
from presswear.tools.errors import KernelError, RunFailed

PAIR = np.dtype([("factor", np.float64), ("calls", np.int64)])


@compiled
def product(x, y):
    return x * y


def unknown_name(x):
    y = 2.0 * x
    return y + factr * x  # wrong


def unknown_field(pairs):
    total = pairs[0].factor
    return total + pairs[0].facto  # wrong


def unknown_function(x):
    y = 2.0 * x
    return math.sqr(y)  # wrong


def too_few_arguments(x):
    y = 2.0 * x
    return y + product(x)  # wrong


def wrong_type(x):
    pair = (x, x)
    return pair + x  # wrong


def two_results(x):
    if x > 0.0:
        return (x, x)
    return x  # wrong


def too_many_indices(numbers):
    total = numbers[0]
    return total + numbers[0, 1]  # wrong


def allocates(x):
    y = 2.0 * x
    return y + np.zeros(3)[0]  # wrong


def opens_a_file(x):
    with open("name") as file:  # wrong
        file.write("text")
    return x


MISTAKES: list[tuple[Callable[..., Any], Any, str]] = [
    (unknown_name, 1.0, "name 'factr' is not defined"),
    (unknown_field, np.zeros(1, PAIR), "no field 'facto'"),
    (unknown_function, 1.0, "module 'math' has no attribute 'sqr'"),
    (too_few_arguments, 1.0, "missing a required argument: 'y'"),
    (
        wrong_type,
        1.0,
        "add is not defined for the types (UniTuple(float64 x 2), float64)",
    ),
    (two_results, 1.0, "return type"),
    (
        too_many_indices,
        np.zeros(3),
        "getitem is not defined for the types (array(float64, 1d",
    ),
    (allocates, 1.0, "kernels cannot allocate memory"),
    (opens_a_file, 1.0, "construct is not supported"),
]


def place_of(mistake: Callable[..., Any]) -> tuple[str, str]:
    """Return place and statement of the wrong line."""
    lines, first = inspect.getsourcelines(mistake)
    (line,) = [k for k, line in enumerate(lines) if "# wrong" in line]
    return f"{__file__}:{first + line}: {mistake.__name__} ", lines[line].strip()


@pytest.mark.parametrize(("mistake", "argument", "reason"), MISTAKES)
@pytest.mark.parametrize(
    "way", ["called", "specialised", "in a callee", "in an inlined callee"]
)
def test_a_mistake_is_shown_with_its_line(mistake, argument, reason, way):
    kernel = inlined(mistake) if "inlined" in way else compiled(mistake)

    @compiled
    def middle(x):
        return kernel(x)

    @compiled
    def outer(x):
        return 2.0 * middle(x)

    called = outer if "callee" in way else kernel
    with pytest.raises(RunFailed) as failed:
        specialised(called, argument) if way == "specialised" else called(argument)
    place, statement = place_of(mistake)
    lines = str(failed.value).splitlines()
    assert lines[0].startswith(place)
    assert lines[1].strip() == statement
    assert reason in lines[2]
    assert len(lines) == 3


def test_a_mistake_in_written_equations_is_shown_with_its_line():
    text = "def equations(model, t, y, out, level):\n    angle = y[0]\n    out[0] = angel\n"
    with pytest.raises(RunFailed) as failed:
        entry_of(function_of(text), 1, 0.0, np.zeros(2), np.zeros(2), 1)
    place, statement, reason = str(failed.value).splitlines()
    assert place.startswith("<equations ")
    assert ">:3: equations" in place
    assert statement.strip() == "out[0] = angel"
    assert "'angel' is not defined" in reason


PLAIN = """
import numpy as np
from presswear.tools.compile import copy_to
from presswear.tools.compile_errors import short_errors

with short_errors:
    copy_to(np.zeros(3), np.zeros(1))
"""


def test_a_mistake_in_plain_python_is_shown_with_its_line():
    ran = python("-c", PLAIN, env={"NUMBA_DISABLE_JIT": "1"})
    place, statement, reason = ran.stderr.splitlines()[-3:]
    assert "KernelError: " in place
    assert place.endswith(": copy_to")
    assert statement == "    target[i] = source[i]"
    assert reason.startswith("IndexError: index 1 is out of bounds")


def test_a_mistake_in_a_kernel_has_three_lines_in_the_terminal(
    monkeypatch,
    capsys,
    tmp_path,
):
    def broken(*arguments: Any) -> None:
        raise KernelError("wear.py:106: deposit\n    depth = y\nno name 'y'")

    monkeypatch.setattr(runs, "run_into", broken)
    command = ["run", "wear-times", "--jobs", "1", "--out", f"{tmp_path / 'run'}"]
    assert main(command) == 1
    shown = capsys.readouterr().err.splitlines()
    assert shown == ["presswear: wear.py:106: deposit", "    depth = y", "no name 'y'"]


def test_errors_of_a_kernel_that_runs_are_left_as_they_are():
    with pytest.raises(TypeError, match="too many"):
        product(1.0, 2.0, 3.0)
