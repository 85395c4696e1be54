"""Cache of machine code: damage, rights, other processes, other environments, wheels."""

import multiprocessing
import os
import pickle
import shutil
import stat
import sys
from collections import namedtuple
from functools import partial
from pathlib import Path
from threading import Thread
from typing import Any, cast

import numpy as np
import pytest
from llvmlite.binding import get_host_cpu_features
from python_process import python

import presswear
from presswear.physics.friction_and_normal import (
    liu_force,
    ramp_friction,
    threlfall_friction,
)
from presswear.tools.compile import (
    Kernel,
    address_of,
    all_finite,
    call,
    compiled,
    copy_to,
    on_compiling,
    specialised,
)
from presswear.tools.files import lock
from presswear.tools.kernel_cache import KernelCache, _entry_digest

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


def test_a_stored_kernel_is_found_by_every_process():
    """Sets, such as ``fastmath`` of ``vectorised``, have another order in each process."""
    names = {
        python("-c", FILES, env={"PYTHONHASHSEED": seed}, check=True).stdout
        for seed in ("1", "2")
    }
    assert len(names) == 1


@pytest.mark.parametrize("damage", ["empty", "cut", "bit of code", "bit of digest"])
def test_damaged_code_is_compiled_again(stored, damage):
    (file,) = stored.iterdir()
    content = bytearray(file.read_bytes())
    if damage == "cut":
        del content[len(content) // 2 :]
    elif damage.startswith("bit"):
        content[len(content) // 2 if damage == "bit of code" else 5] ^= 4
    else:
        content[:] = b""
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


def test_what_stands_in_the_cache_is_executed(stored):
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
def test_nothing_is_executed_that_others_may_have_written(stored, place, caplog):
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


def test_cache_belongs_to_the_user_alone(tmp_path, monkeypatch, request):
    request.addfinalizer(partial(os.umask, os.umask(0o002)))
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    assert _compiles()
    assert not _compiles()
    (file,) = (tmp_path / "presswear" / "kernels").iterdir()
    assert [stat.S_IMODE(one.stat().st_mode) for one in (file.parent, file)] == [
        0o700,
        0o644,
    ]


def test_entry_of_another_kernel_is_not_used(stored):
    kernels = ramp_friction, threlfall_friction
    arguments = 5e-4, 100.0, 0.1, 1e-4, 1e-3
    forces = [Kernel(cast(Kernel, kernel).py_func)(*arguments) for kernel in kernels]
    ramp, threlfall = sorted(
        stored.iterdir(), key=lambda file: file.stat().st_mtime_ns
    )[-2:]
    shutil.copy(threlfall, ramp)
    again = [Kernel(cast(Kernel, kernel).py_func)(*arguments) for kernel in kernels]
    assert again == forces
    assert forces[0] != forces[1]


@pytest.mark.parametrize("part", ["CompileResult._reduce", "CompileResult._rebuild"])
def test_kernels_are_compiled_without_private_parts_of_numba(
    stored,
    monkeypatch,
    caplog,
    part,
):
    monkeypatch.delattr(f"numba.core.compiler.{part}")
    for file in stored.iterdir():
        file.unlink()
    assert _compiles()
    assert _compiles()
    count = len([record for record in caplog.records if "numba" in record.message])
    assert count == (part == "CompileResult._reduce")


def test_files_that_are_not_used_are_removed(stored, monkeypatch):
    monkeypatch.setattr("presswear.tools.kernel_cache._MAX_FILES", 2)
    (file,) = stored.iterdir()
    os.utime(file, (1.0, 1.0))
    left = stored / "left by a process that was killed"
    left.touch()
    os.utime(left, (2.0, 2.0))
    assert not _compiles()
    assert _compiles(copy_to)
    assert len(list(stored.iterdir())) == 2
    assert not left.exists()
    assert not _compiles()


@pytest.mark.parametrize("is_killed", [False, True])
def test_code_that_another_process_compiles_is_awaited(stored, is_killed):
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
    stored,
    monkeypatch,
    caplog,
    parent,
):
    """A worker says so as well: its parent compiles other kernels."""
    monkeypatch.setattr(multiprocessing, "parent_process", lambda: parent)
    holder = f"process {123 if parent else 122}"  # a warning is given once
    (file,) = stored.iterdir()
    file.unlink()
    monkeypatch.setattr(KernelCache, "patience", 0.4)
    kernel = Kernel(cast(Kernel, all_finite).py_func)
    with file.with_suffix(".lock").open("w") as other:
        assert not lock(other)
        other.write(holder)
        other.flush()
        waiting = Thread(target=kernel, args=(ONES, ONES))
        waiting.start()
        for _ in range(10):  # it goes on
            waiting.join(0.1)
            os.utime(other.fileno())
        assert waiting.is_alive()
        waiting.join(60.0)
        assert not waiting.is_alive()
        assert [record.message.split(" (")[0] for record in caplog.records] == [
            f"{holder} compiles kernels and stands still"
        ]
        assert file.with_suffix(".lock").exists()  # of the other process
    assert not _compiles()


def test_compiling_shows_signs_of_life(stored, monkeypatch):
    """Each function that a kernel calls touches its lock."""
    touched: list[object] = []
    monkeypatch.setattr("os.utime", lambda *of: touched.append(of))
    (file,) = stored.iterdir()
    file.unlink()
    assert _compiles()
    assert touched


def test_kernels_run_where_nothing_can_be_stored(tmp_path, monkeypatch):
    (tmp_path / "presswear").touch()
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    assert _compiles()
    assert _compiles()


def test_named_tuples_may_have_equal_names(stored, monkeypatch):
    named: Any = namedtuple
    copy = cast(Kernel, copy_to).py_func
    first, second, third = (named("Pair", "x y", module=__name__) for _ in range(3))
    module: Any = sys.modules[__name__]
    for pair in (first, second, third):
        with monkeypatch.context() as patch:
            # The second type is stored by value, the others by their name in this module.
            if pair is not second:
                patch.setattr(module, "Pair", pair, raising=False)
            call: Any = specialised(Kernel(copy), ONES, pair(3.0, 4.0))
            call(target := np.zeros(2), pair(3.0, 4.0))
            assert target.tolist() == [3.0, 4.0]
    assert len(list(stored.iterdir())) == 2


@compiled
def _liu_force_at(address: int) -> float:
    return call(address, (1e-5, 0.0, 0.1, 1e9, 1.5, 0.0, 1e-4))


def test_code_that_is_called_by_address_is_stored_apart(stored):
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
    # Python keeps bytecode by size and second of a file, and the tests write one twice
    # in a second.
    variables |= {"PYTHONPATH": str(package.parent), "PYTHONDONTWRITEBYTECODE": "1"}
    options: dict[str, Any] = {"cwd": package.parent, "check": True}
    printed = python("-c", PROGRAM, env=variables, **options).stdout
    return printed.replace(str(package), "").strip()


def test_environments_with_equal_kernels_share_them(stored, package):
    assert _printed(package) == "True /tools/compile.py"
    file = package / "tools" / "compile.py"
    source = file.read_text()
    file.write_text(
        source.replace("Return whether two arrays", "Check that two arrays") + "# end"
    )
    assert _printed(package) == "True /tools/compile.py"
    file.write_text(source.replace("return total == 0.0", "return total == 1.0"))
    assert _printed(package) == "compiles compiles False /tools/compile.py"
    assert len(list(stored.iterdir())) == 2


@pytest.mark.skipif(not get_host_cpu_features().get("avx2"), reason="needs AVX2")
def test_kernels_of_a_wheel_are_used(stored, package):
    """They are as safe as its source: of a group that can write the program, too."""
    shutil.rmtree(stored)
    # as in .ci/wheel
    target = {"NUMBA_CPU_NAME": "x86-64-v3", "NUMBA_CPU_FEATURES": ""}
    assert _printed(package, **target) == "compiles compiles True /tools/compile.py"
    stored.rename(package / "kernels")
    assert _printed(package) == "True /tools/compile.py"
    assert not stored.exists()
    for item in (package / "kernels", *(package / "kernels").iterdir()):
        item.chmod(0o775)
    package.chmod(0o775)
    assert _printed(package) == "True /tools/compile.py"
    package.chmod(0o755)
    assert _printed(package).startswith("compiles")


def test_bounds_of_arrays_are_checked_with_a_warm_cache(stored, package):
    assert _printed(package, NUMBA_BOUNDSCHECK="1").startswith("compiles")
    assert _printed(package, NUMBA_OPT="1").startswith("compiles")
