"""Compiled kernels: signals, lazy compilation, errors in kernels, counts of compilations."""

import gc
import signal
from typing import Any

import numpy as np
import pytest
from numba.core import event
from numpy.typing import NDArray
from python_process import python

from presswear.tools.arrays import Array
from presswear.tools.compile import (
    compiled,
    lazily_compiled,
    on_compiling,
    specialised,
)
from presswear.tools.errors import RunFailed


@compiled
def _leaf(x: float) -> float:
    return x * x + 1.0


class _InterruptsCallees(event.Listener):  # type: ignore[misc]
    """Sends SIGINT when a callee is compiled, and notes which compilations end."""

    def __init__(self) -> None:
        self.compiling: list[str] = []
        self.compiled: list[str] = []

    def on_start(self, event: Any) -> None:
        self.compiling.append(event.data["dispatcher"].py_func.__name__)
        if len(self.compiling) == 2:
            signal.raise_signal(signal.SIGINT)

    def on_end(self, event: Any) -> None:
        name = self.compiling.pop()
        if event._exc_details is None:
            self.compiled.append(name)


def test_signal_waits_until_the_compiler_has_ended():
    @compiled
    def leaf(x: float) -> float:
        return x * x + 2.0

    @compiled
    def caller(x: float) -> float:
        return leaf(x) + 1.0

    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        with (
            event.install_listener("numba:compile", _InterruptsCallees()) as listener,
            pytest.raises(KeyboardInterrupt),
        ):
            caller(1.0)
    finally:
        signal.signal(signal.SIGINT, before)
    assert listener.compiled == ["leaf"]
    assert caller(1.0) == 4.0


def test_garbage_collection_resumes_after_an_error():
    @compiled
    def nonsense(x: float) -> float:
        return _leaf(x).no_attribute  # type: ignore[attr-defined]  # wrong on purpose

    with pytest.raises(RunFailed):
        nonsense(1.0)
    assert gc.isenabled()


PAIR = np.dtype([("factor", np.float64), ("calls", np.int64)])


@lazily_compiled((0.0, 0), PAIR, 1, 0)
def _rare_kernel(pair: Any, numbers: Array, x: float) -> tuple[float, int]:
    pair.calls += 1
    return pair.factor * x + numbers[numbers.shape[0] - 1], numbers.shape[0]


_rare: Any = _rare_kernel


@compiled
def _seldom(pairs: NDArray[np.void], numbers: Array, x: float) -> float:
    total = 0.0
    for k in range(pairs.shape[0]):
        if x > 0.0:
            value, count = _rare(pairs[k], numbers[:, k], x)
            total += value * count
    return total


def test_lazy_kernel_is_compiled_at_its_first_call():
    pairs = np.zeros(2, PAIR)
    numbers = np.arange(6.0).reshape(3, 2)
    pairs["factor"] = 10.0, 100.0
    assert _seldom(pairs, numbers, -1.0) == 0.0
    assert not _rare.from_python.overloads
    # Columns have gaps, whole arrays none.
    assert _seldom(pairs, numbers, 2.0) == 3.0 * (20.0 + 4.0) + 3.0 * (200.0 + 5.0)
    assert len(_rare.from_python.overloads) == 1
    assert pairs["calls"].tolist() == [1, 1]


INTERRUPTED = """
import ctypes
from presswear.tools.compile import compiled, lazily_compiled
from presswear.tools.processes import is_stopped, stoppable
interrupt = getattr(ctypes.CDLL(None), "raise")
interrupt.argtypes, interrupt.restype = [ctypes.c_int], ctypes.c_int
@lazily_compiled(0, 0)
def half(x):
    return 0.5 * x
@compiled
def caller(x):
    interrupt(2)  # SIGINT; Python handles it before the first line that it executes
    return half(x)
with stoppable():
    print(caller(3.0), is_stopped())
"""


def test_interrupt_in_a_kernel_that_calls_a_lazy_one_is_no_crash():
    ended = python("-c", INTERRUPTED)
    assert (ended.returncode, ended.stdout) == (0, "1.5 True\n"), ended.stderr


WRONG = """
import numpy
from presswear.tools.compile import call_entry, compiled, entry_of, lazily_compiled
@lazily_compiled(0, 0)
def rare(x):
    return x.no_attribute
@compiled
def middle(x, out):
    out[0] = 2.0 * rare(x)
@compiled
def direct(x, out):
    middle(x, out)
    out[0] = -1.0
@compiled
def by_entry(entry, x, out):
    call_entry(entry, (x, out))
    out[0] = -1.0
out = numpy.zeros(1)
entry = entry_of(middle, 1.0, out)
for call in (lambda: direct(1.0, out), lambda: by_entry(entry, 1.0, out)):
    try:
        call()
    except RuntimeError as error:
        print(type(error).__name__, error, out[0])
"""
WRONG_PLACE = """\
KernelError {0}:6: rare cannot be compiled
    return x.no_attribute
Unknown attribute 'no_attribute' of type float64 0.0
"""


def test_a_lazy_kernel_that_cannot_be_compiled_is_an_error(tmp_path):
    """Of all its callers; the program goes on."""
    script = tmp_path / "wrong.py"
    script.write_text(WRONG)
    ended = python(script)
    assert ended.stdout == WRONG_PLACE.format(script) * 2
    assert ended.stderr == ""


def test_compiling_is_reported_and_loading_is_not():
    @compiled
    def half(x: float) -> float:
        return 0.5 * _leaf(x)

    reports: list[int] = []
    with on_compiling(lambda: reports.append(1)):
        assert half(1.0) == 1.0
        assert half(3.0) == 5.0
    assert len(reports) == 2  # its start and its end
    specialised(half, 1)
    assert len(reports) == 2


BEYOND = """
import numpy
from presswear.tools.compile import address_of, call, compiled, lazily_compiled
from presswear.tools.compiled_law import compile_function
from presswear.tools.user_function import UserFunction

@compiled
def element(numbers, i):
    return numbers[i]

@lazily_compiled(0, 1, 0)
def rare_element(numbers, x):
    return numbers[int(x)]

@compiled
def outer(numbers, i):
    return element(numbers, i)

@compiled
def outer_of_rare(numbers, i):
    return rare_element(numbers, float(i))

@compiled
def law_at(address, x):
    return call(address, (x,))

TEXT = "import numpy\\nTABLE = numpy.ones(3)\\ndef law(x):\\n    return TABLE[int(x)]\\n"
law = compile_function(UserFunction("law", TEXT).trusted(), ("x",))
address = address_of(law, 1)
for kernel, of in (outer, numpy.ones(3)), (outer_of_rare, numpy.ones(3)), (law_at, address):
    try:
        kernel(of, 10)
    except Exception as error:
        print(type(error).__name__, error)
"""
BEYOND_PLACES = """\
KernelError {0}:9: element
    return numbers[i]
index is out of bounds
KernelError {0}:13: rare_element
    return numbers[int(x)]
index is out of bounds
InputError user law fails: law, line 4, law: "return TABLE[int(x)]": index is out of bounds
"""


def test_index_errors_in_kernels_are_found_on_request(tmp_path):
    file = tmp_path / "beyond.py"
    file.write_text(BEYOND)
    ran = python(file, env={"NUMBA_BOUNDSCHECK": "1"}, check=True)
    assert ran.stdout == BEYOND_PLACES.format(file)


COUNTED = """
from numba.core import event
import presswear as pw
from presswear.physics.contact import (note_foundation)
from presswear.physics.wear import (deposit_over_arc)

class Count(event.Listener):
    compiled = 0
    def on_start(self, event): Count.compiled += 1
    def on_end(self, event): pass

event.register("numba:compile", Count())
pw.run(pw.scenes.wear_times(cycles=1, wear_updates=0), engine="%s")
lazy = note_foundation, deposit_over_arc
print(Count.compiled, sum(len(kernel.from_python.overloads) for kernel in lazy))
"""


@pytest.mark.slow
@pytest.mark.parametrize(
    ("engine", "most"), [("exudyn-tree", 95), ("dae", 95), ("exudyn-joints", 122)]
)
def test_first_start_compiles_few_kernels_and_second_none(tmp_path, engine, most):
    environment = {"XDG_CACHE_HOME": f"{tmp_path}"}
    for fewest, limit in ((20, most), (-1, 0)):
        ran = python("-c", COUNTED % engine, env=environment, check=True)
        kernels, unused = map(int, ran.stdout.split())
        assert fewest < kernels <= limit
        assert unused == 0


def test_a_callee_is_compiled_once_for_all_literal_numbers():
    @compiled
    def scaled(x: float, count: int, is_half: bool) -> float:
        return x * count * (0.5 if is_half else 1.0)

    @compiled
    def caller(x: float, count: int) -> float:
        return scaled(x, 2, True) + scaled(x, 3, False) + scaled(x, count, count > 1)

    assert caller(1.0, 4) == 6.0
    kernel: Any = scaled
    assert len(kernel._from_kernels.overloads) == 1
