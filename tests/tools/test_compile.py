"""Compiled kernels: lazy compilation, cache, bound arguments."""

import gc
import multiprocessing
import os
import pickle
import shutil
import signal
import stat
import subprocess
import sys
from collections import namedtuple
from functools import partial
from pathlib import Path
from threading import Thread
from typing import Any, NamedTuple, cast

import numpy as np
import pytest
from llvmlite.binding import get_host_cpu_features
from numba.core import event
from numpy.typing import NDArray

import presswear
from presswear.physics.friction_and_normal import (
    liu_force,
    ramp_friction,
    threlfall_friction,
)
from presswear.tools.arrays import Array
from presswear.tools.compile import (
    Kernel,
    address_of,
    all_finite,
    call,
    compiled,
    copy_to,
    lazily_compiled,
    on_compiling,
    specialised,
)
from presswear.tools.errors import RunFailed
from presswear.tools.files import lock
from presswear.tools.kernel_cache import KernelCache, _entry_digest
from presswear.tools.packing import PackedArguments, bind, pack_arguments, unpack


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


def test_signal_waits_until_the_compiler_has_ended() -> None:
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


def test_garbage_collection_resumes_after_an_error() -> None:
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


def test_lazy_kernel_is_compiled_at_its_first_call() -> None:
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


def test_interrupt_in_a_kernel_that_calls_a_lazy_one_is_no_crash() -> None:
    command = [sys.executable, "-c", INTERRUPTED]
    ended = subprocess.run(command, capture_output=True, text=True, check=False)
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


def test_a_lazy_kernel_that_cannot_be_compiled_is_an_error(tmp_path: Path) -> None:
    """Of all its callers; the program goes on."""
    script = tmp_path / "wrong.py"
    script.write_text(WRONG)
    ended = subprocess.run(
        [sys.executable, script], capture_output=True, text=True, check=True
    )
    line = (
        "RuntimeError __main__.rare cannot be compiled; the reason is in the log 0.0\n"
    )
    assert ended.stdout == line * 2
    assert "return x.no_attribute" in ended.stderr
    assert "Unknown attribute 'no_attribute'" in ended.stderr


def test_compiling_is_reported_and_loading_is_not() -> None:
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


ONES = np.ones(2)


def _compiles(function: Any = all_finite) -> bool:
    """Call a kernel as a new process does; return whether it was compiled."""
    reports: list[int] = []
    with on_compiling(lambda: reports.append(1)):
        Kernel(function.py_func)(ONES, ONES)
    return bool(reports)


@pytest.fixture
def stored(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return the folder of a cache that holds one kernel."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    assert _compiles()
    assert not _compiles()
    return tmp_path / "presswear" / "kernels"


FILES = """
from presswear.physics.contact import note_foundation
kernel = note_foundation.from_python
print(kernel._cache.files((), kernel.targetctx)[0].name)
"""


def test_a_stored_kernel_is_found_by_every_process() -> None:
    """Sets, such as ``fastmath`` of ``vectorised``, have another order in each process."""
    names = {
        subprocess.run(
            [sys.executable, "-c", FILES],
            env={**os.environ, "PYTHONHASHSEED": seed},
            capture_output=True,
            text=True,
            check=True,
        ).stdout
        for seed in ("1", "2", "3")
    }
    assert len(names) == 1


@pytest.mark.parametrize(
    "damage", ["empty", "cut", "garbage", "bit of code", "bit of digest"]
)
def test_damaged_code_is_compiled_again(stored: Path, damage: str) -> None:
    (file,) = stored.iterdir()
    content = bytearray(file.read_bytes())
    if damage == "cut":
        del content[len(content) // 2 :]
    elif damage.startswith("bit"):
        content[len(content) // 2 if damage == "bit of code" else 5] ^= 4
    else:
        content[:] = b"" if damage == "empty" else b"garbage" * 5000
    file.write_bytes(content)
    assert _compiles()
    assert not _compiles()
    assert [file] == list(stored.iterdir())


def _plant(file: Path) -> Path:
    """Write an entry that a program accepts and that leaves a file where it is executed."""
    marker = file.parent.parent / "executed"

    class Planted:
        def __reduce__(self) -> Any:
            return Path.touch, (marker,)

    content = pickle.dumps(Planted())
    file.write_bytes(_entry_digest(file, content) + content)
    return marker


def test_what_stands_in_the_cache_is_executed(stored: Path) -> None:
    """Otherwise the tests below would show nothing."""
    (file,) = stored.iterdir()
    marker = _plant(file)
    assert _compiles()
    assert marker.exists()


def _replace(place: str, folder: Path, file: Path) -> None:
    """Let others write a folder or a file, or put something else in its place."""
    path = folder if "folder" in place else file
    if "group" in place:
        path.chmod(path.stat().st_mode | stat.S_IWGRP)
    elif "all" in place:
        path.chmod(0o1777)
    elif "another" in place:
        os.chown(path, 65534, 65534)
    elif "link" in place:
        path.rename(folder.parent / "elsewhere")
        path.symlink_to(folder.parent / "elsewhere")
    else:
        path.unlink()
        os.mkfifo(path)


PLACES = (
    "folder that a group can write",
    "folder that all can write",
    "folder of another user",
    "file that a group can write",
    "file that all can write",
    "file of another user",
    "link to a folder",
    "link to a file",
    "pipe",
)


@pytest.mark.parametrize("place", PLACES)
def test_nothing_is_executed_that_others_may_have_written(
    stored: Path, place: str, caplog: pytest.LogCaptureFixture
) -> None:
    if "another" in place and os.geteuid():
        pytest.skip("needs the rights of root")
    (file,) = stored.iterdir()
    marker = _plant(file)
    _replace(place, stored, file)
    assert _compiles()
    assert not marker.exists()
    is_folder = "folder" in place
    assert _compiles() == is_folder  # a file is replaced
    assert not marker.exists()
    assert [f"{stored}: kernels are compiled in memory" in caplog.text] == [is_folder]
    assert len(caplog.records) == is_folder


def test_cache_belongs_to_the_user_alone(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, request: pytest.FixtureRequest
) -> None:
    request.addfinalizer(partial(os.umask, os.umask(0o002)))
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    assert _compiles()
    assert not _compiles()
    (file,) = (tmp_path / "presswear" / "kernels").iterdir()
    assert [stat.S_IMODE(one.stat().st_mode) for one in (file.parent, file)] == [
        0o700,
        0o644,
    ]


def test_entry_of_another_kernel_is_not_used(stored: Path) -> None:
    kernels = ramp_friction, threlfall_friction
    arguments = 5e-4, 100.0, 0.1, 1e-4, 1e-3
    forces = [Kernel(cast(Kernel, one).py_func)(*arguments) for one in kernels]
    ramp, threlfall = sorted(
        stored.iterdir(), key=lambda file: file.stat().st_mtime_ns
    )[-2:]
    shutil.copy(threlfall, ramp)
    again = [Kernel(cast(Kernel, one).py_func)(*arguments) for one in kernels]
    assert again == forces
    assert forces[0] != forces[1]


def test_error_while_an_entry_is_read_means_compile(
    stored: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for error in (KeyError("x"), MemoryError(), RecursionError(), ValueError("x")):

        def fails(*_: object, raised: Exception = error) -> None:
            raise raised

        with monkeypatch.context() as patch:
            patch.setattr("presswear.tools.kernel_cache.pickle.loads", fails)
            assert _compiles()


@pytest.mark.parametrize("part", ["CompileResult._reduce", "CompileResult._rebuild"])
def test_kernels_are_compiled_without_private_parts_of_numba(
    stored: Path,
    monkeypatch: pytest.MonkeyPatch,
    caplog: pytest.LogCaptureFixture,
    part: str,
) -> None:
    monkeypatch.delattr(f"numba.core.compiler.{part}")
    for file in stored.iterdir():
        file.unlink()
    assert _compiles()
    assert _compiles()
    count = len([one for one in caplog.records if "numba" in one.message])
    assert count == (part == "CompileResult._reduce")


def test_oldest_files_are_removed(
    stored: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("presswear.tools.kernel_cache._MAX_FILES", 2)
    left = stored / "left by a process that was killed"
    left.touch()
    os.utime(left, (1.0, 1.0))
    assert _compiles(copy_to)
    assert len(list(stored.iterdir())) == 2
    assert not left.exists()
    assert not _compiles()


@pytest.mark.parametrize("is_killed", [False, True])
def test_code_that_another_process_compiles_is_awaited(
    stored: Path, is_killed: bool
) -> None:
    (file,) = stored.iterdir()
    code = file.read_bytes()
    file.unlink()
    kernel = Kernel(cast(Kernel, all_finite).py_func)
    with file.with_suffix(".lock").open("w") as other:
        assert not lock(other)
        waiting = Thread(target=kernel, args=(ONES, ONES))
        waiting.start()
        waiting.join(0.5)
        assert waiting.is_alive()
        if not is_killed:
            file.write_bytes(code)
    waiting.join()
    assert sum(kernel.from_python.stats.cache_hits.values()) == (not is_killed)
    assert list(stored.iterdir()) == [file]


@pytest.mark.parametrize("parent", [None, "a process"])
def test_process_that_stands_still_while_it_compiles_is_not_awaited(
    stored: Path,
    monkeypatch: pytest.MonkeyPatch,
    caplog: pytest.LogCaptureFixture,
    parent: str | None,
) -> None:
    """A worker says so as well: its parent compiles other kernels."""
    monkeypatch.setattr(multiprocessing, "parent_process", lambda: parent)
    holder = f"process {123 if parent else 122}"  # a warning is given once
    (file,) = stored.iterdir()
    file.unlink()
    monkeypatch.setattr(KernelCache, "patience", 1.0)
    kernel = Kernel(cast(Kernel, all_finite).py_func)
    with file.with_suffix(".lock").open("w") as other:
        assert not lock(other)
        other.write(holder)
        other.flush()
        waiting = Thread(target=kernel, args=(ONES, ONES))
        waiting.start()
        for _ in range(10):  # it goes on
            waiting.join(0.2)
            os.utime(other.fileno())
        assert waiting.is_alive()
        waiting.join(60.0)
        assert not waiting.is_alive()
        assert [one.message.split(" (")[0] for one in caplog.records] == [
            f"{holder} compiles kernels and stands still"
        ]
        assert file.with_suffix(".lock").exists()  # of the other process
    assert not _compiles()


def test_compiling_shows_signs_of_life(
    stored: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Each function that a kernel calls touches its lock."""
    touched: list[object] = []
    monkeypatch.setattr("os.utime", lambda *of: touched.append(of))
    (file,) = stored.iterdir()
    file.unlink()
    assert _compiles()
    assert touched


def test_kernels_run_where_nothing_can_be_stored(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "presswear").touch()
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    assert _compiles()
    assert _compiles()


def test_named_tuples_may_have_equal_names(
    stored: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    named: Any = namedtuple
    copy = cast(Kernel, copy_to).py_func
    first, second, third = (named("Pair", "x y", module=__name__) for _ in range(3))
    module: Any = sys.modules[__name__]
    for pair in (first, second, third):
        with monkeypatch.context() as patch:
            if (
                pair is not second
            ):  # it is stored by value, the others by the name in this module
                patch.setattr(module, "Pair", pair, raising=False)
            call: Any = specialised(Kernel(copy), ONES, pair(3.0, 4.0))
            call(target := np.zeros(2), pair(3.0, 4.0))
            assert target.tolist() == [3.0, 4.0]
    assert len(list(stored.iterdir())) == 2


@compiled
def _liu_force_at(address: int) -> float:
    return call(address, (1e-5, 0.0, 0.1, 1e9, 1.5, 0.0, 1e-4))


def test_code_that_is_called_by_address_is_stored_apart(stored: Path) -> None:
    for _ in range(2):
        kernel = Kernel(cast(Kernel, liu_force).py_func)
        expected = kernel(1e-5, 0.0, 0.1, 1e9, 1.5, 0.0, 1e-4)
        assert _liu_force_at(address_of(kernel, 7)) == expected
    assert len(list(stored.iterdir())) == 3


@pytest.fixture
def package(tmp_path: Path) -> Path:
    """Return a copy of the package in another environment."""
    return shutil.copytree(
        Path(presswear.__file__).parent, tmp_path / "site" / "presswear"
    )


PROGRAM = """
import numpy
from presswear.tools import compile
with compile.on_compiling(lambda: print("compiles", end=" ")):
    print(compile.all_finite(numpy.ones(2), numpy.ones(2)), compile.__file__)
"""


def _printed(package: Path, **variables: str) -> str:
    """Return what a program prints that calls a kernel of a package."""
    run = partial(
        subprocess.run, capture_output=True, text=True, check=True, cwd=package.parent
    )
    # Python keeps bytecode by size and second of a file, and the tests write one twice
    # in a second.
    variables |= {"PYTHONPATH": str(package.parent), "PYTHONDONTWRITEBYTECODE": "1"}
    environment = {**os.environ, **variables}
    printed: str = run([sys.executable, "-c", PROGRAM], env=environment).stdout
    return printed.replace(str(package), "").strip()


def test_environments_with_equal_kernels_share_them(
    stored: Path, package: Path
) -> None:
    assert _printed(package) == "True /tools/compile.py"
    file = package / "tools" / "compile.py"
    source = file.read_text()
    file.write_text(
        source.replace("Return whether two arrays", "Check that two arrays") + "# end"
    )
    assert _printed(package) == "True /tools/compile.py"
    file.write_text(source.replace("return total == 0.0", "return total == 1.0"))
    assert _printed(package) == "compiles compiles False /tools/compile.py"
    file.write_text(source)
    assert _printed(package) == "True /tools/compile.py"
    assert len(list(stored.iterdir())) == 2


@pytest.mark.skipif(not get_host_cpu_features().get("avx2"), reason="needs AVX2")
def test_kernels_of_a_wheel_are_used(stored: Path, package: Path) -> None:
    shutil.rmtree(stored)
    target = {
        "NUMBA_CPU_NAME": "x86-64-v3",
        "NUMBA_CPU_FEATURES": "",
    }  # as in .ci/wheel
    assert _printed(package, **target) == "compiles compiles True /tools/compile.py"
    stored.rename(package / "kernels")
    assert _printed(package) == "True /tools/compile.py"
    assert not stored.exists()


@pytest.mark.skipif(not get_host_cpu_features().get("avx2"), reason="needs AVX2")
@pytest.mark.parametrize("mode", [0o755, 0o775])
def test_kernels_of_a_wheel_are_as_safe_as_its_source(
    stored: Path, package: Path, mode: int
) -> None:
    """Site-packages of a group: who can write kernels there can write the program, too."""
    shutil.rmtree(stored)
    target = {
        "NUMBA_CPU_NAME": "x86-64-v3",
        "NUMBA_CPU_FEATURES": "",
    }  # as in .ci/wheel
    _printed(package, **target)
    stored.rename(package / "kernels")
    for item in (package / "kernels", *(package / "kernels").iterdir()):
        item.chmod(0o775)
    package.chmod(mode)
    assert _printed(package).startswith("compiles") == (mode == 0o755)


def test_bounds_of_arrays_are_checked_with_a_warm_cache(
    stored: Path, package: Path
) -> None:
    assert _printed(package) == "True /tools/compile.py"
    assert _printed(package, NUMBA_BOUNDSCHECK="1").startswith("compiles")
    assert _printed(package, NUMBA_OPT="1").startswith("compiles")
    assert _printed(package) == "True /tools/compile.py"


BEYOND = """
import numpy
from presswear.tools.compile import address_of, call, compiled, lazily_compiled
from presswear.tools.user_function import UserFunction, compile_function

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
RunFailed {0}:8: element
    return numbers[i]
index is out of bounds
RunFailed {0}:12: rare_element
    return numbers[int(x)]
index is out of bounds
InputError user law fails: law, line 4, law: "return TABLE[int(x)]": index is out of bounds
"""


def test_index_errors_in_kernels_are_found_on_request(tmp_path: Path) -> None:
    file = tmp_path / "beyond.py"
    file.write_text(BEYOND)
    for value, found in (("0", ""), ("1", BEYOND_PLACES.format(file))):
        environment = {**os.environ, "NUMBA_BOUNDSCHECK": value}
        ran = subprocess.run(
            [sys.executable, file],
            env=environment,
            capture_output=True,
            text=True,
            check=True,
        )
        assert ran.stdout == found


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
def test_first_start_compiles_few_kernels_and_second_none(
    tmp_path: Path, engine: str, most: int
) -> None:
    environment = {**os.environ, "XDG_CACHE_HOME": str(tmp_path)}
    for fewest, limit in ((20, most), (-1, 0)):
        command = [sys.executable, "-c", COUNTED % engine]
        ran = subprocess.run(
            command, env=environment, capture_output=True, text=True, check=True
        )
        kernels, unused = map(int, ran.stdout.split())
        assert fewest < kernels <= limit
        assert unused == 0


class Spring(NamedTuple):
    """A named tuple within another."""

    stiffness: float
    is_loose: bool
    lengths: Array


class Springs(NamedTuple):
    """Parts of all types."""

    number: int
    nothing: None
    spring: Spring
    pair: tuple[float, Array]


@compiled
def _spring_force(spring: Spring, i: int) -> float:
    return 0.0 if spring.is_loose else spring.stiffness * spring.lengths[i]


@compiled
def _sum_springs(packed: PackedArguments, x: float) -> float:
    springs, rest = unpack(packed)
    first, others = springs.pair
    total = x + first + others[0] + rest
    if springs.nothing is None:
        for i in range(springs.number):
            total += _spring_force(springs.spring, i)
    return total


@pytest.mark.parametrize("is_loose", [False, True])
def test_kernels_read_the_parts_of_stored_tuples(is_loose: bool) -> None:
    spring = Spring(2.0, is_loose, np.array([[1.0, 9.0], [3.0, 9.0], [5.0, 9.0]])[:, 0])
    springs = Springs(2, None, spring, (0.25, np.full(1, 0.5)))
    total = bind(_sum_springs, pack_arguments(springs, 100.0))
    assert total(10.0) == 110.75 + (0.0 if is_loose else 8.0)
    spring.lengths[1] = 4.0
    assert total(10.0) == 110.75 + (0.0 if is_loose else 10.0)


def test_a_callee_is_compiled_once_for_all_literal_numbers() -> None:
    @compiled
    def scaled(x: float, count: int, is_half: bool) -> float:
        return x * count * (0.5 if is_half else 1.0)

    @compiled
    def caller(x: float, count: int) -> float:
        return scaled(x, 2, True) + scaled(x, 3, False) + scaled(x, count, count > 1)

    assert caller(1.0, 4) == 6.0
    kernel: Any = scaled
    assert len(kernel._from_kernels.overloads) == 1


@compiled
def _gather(packed: PackedArguments, x: float) -> float:
    """Add up the arguments, and store the sum."""
    (pairs, rows, _nothing, single), out = unpack(packed)
    total = x
    for i in range(single.shape[0]):
        total += single[i]
        if pairs[i].calls:
            total += pairs[i].factor
        for j in range(rows.shape[1]):
            total += rows[i, j]
    out[0] = total
    return total


@pytest.mark.parametrize("count", [0, 1, 3])
def test_bound_arguments_are_read_may_change_and_stay_alive(count: int) -> None:
    random = np.random.default_rng(count)
    pairs = np.zeros(count, PAIR)
    single = random.random(count)
    rows = random.random((count, 2))
    pairs["calls"] = random.random(count) < 0.5
    pairs["factor"] = random.random(count)
    out = np.zeros(1)
    call = bind(_gather, pack_arguments((pairs, rows, None, single), out))
    expected = single.sum() + rows.sum() + pairs["factor"][pairs["calls"] > 0].sum()
    assert call(0.5) == pytest.approx(0.5 + expected, abs=1e-12)
    single += 1.0
    del single, rows, pairs
    gc.collect()
    others = [
        np.full(2, 1e9) for _ in range(1000)
    ]  # would take the place of what is freed
    assert call(0.0) == out[0] == pytest.approx(expected + count, abs=1e-12)
    assert len(others) == 1000


@compiled
def _exchange(numbers: Array, pairs: Any) -> float:
    last = numbers[-1]
    numbers[-1] = 2.0 * numbers[0]
    numbers[0] = last
    numbers[1] = pairs[1].calls
    return pairs[1].factor + numbers[2]


@pytest.mark.parametrize("step", [1, 2])
def test_elements_at_constant_places(step: int) -> None:
    numbers = np.arange(4.0 * step)[::step]
    pairs = np.zeros(2 * step, PAIR)[::step]
    pairs["calls"][1] = 7
    pairs["factor"][1] = 0.5
    assert _exchange(numbers, pairs) == 2.0 * step + 0.5
    assert numbers.tolist() == [3.0 * step, 7.0, 2.0 * step, 0.0]
