"""Just-in-time compilation with a cache that is never half stale.

Numba keys a cached function by its own source file only: a kernel edited in
``laws.py`` would leave the compiled callers in ``contact.py`` untouched.  All
compiled code of this package therefore lives in a cache folder named after a
digest of every source file that holds kernels; any edit starts a new folder.

What differs from scene to scene, a law of one's own above all, is called by the address of its
machine code: kernels do not know it when they are compiled, so that no two laws ever share
compiled code.  What few scenes need is called by address as well, and compiled when it is.
"""

import ctypes
import hashlib
import inspect
import os
import tempfile
import threading
import time as clock
from _thread import interrupt_main
from collections.abc import Callable
from contextlib import AbstractContextManager
from functools import cache, cached_property, update_wrapper
from importlib import import_module
from pathlib import Path
from typing import Any, TypeVar, cast

import numba
import numpy as np
from llvmlite import binding, ir
from numba import config
from numba.core import cgutils, event, types, typing
from numba.core.errors import NumbaError
from numba.extending import intrinsic, lower_builtin
from numpy.typing import NDArray

from presswear.tools.errors import InputError
from presswear.tools.linking import PartCompiler, WholeCompiler, kept_code
from presswear.tools.own import OwnFunction

Array = NDArray[np.float64]
F = TypeVar("F", bound=Callable[..., Any])

Records = Any
"""A structured numpy array whose elements the kernels read as ``records[k].name``.

Numba knows their fields, a type checker does not.
"""

_NUMBA: Any = numba  # their type hints leave out what is used here
_CGUTILS: Any = cgutils
_TYPES: Any = types
_TYPING: Any = typing
_EVENT: Any = event
_COMPILING = "numba:compile"
_LOWER: Any = lower_builtin
_PACKAGE = Path(__file__).resolve().parents[1]


def _source_digest() -> str:
    """Digest of every module of the package that compiles something."""
    digest = hashlib.sha256(numba.__version__.encode())
    for path in sorted(_PACKAGE.rglob("*.py")):
        source = path.read_bytes()
        if b"compiled import" in source or path.name in ("compiled.py", "linking.py"):
            digest.update(path.relative_to(_PACKAGE).as_posix().encode())
            digest.update(source)
    return digest.hexdigest()[:16]


@cache
def _cache_is_usable() -> bool:
    """Point numba at the folder of this source; False where none can be written."""
    base = os.environ.get("XDG_CACHE_HOME") or os.path.join(Path.home(), ".cache")
    folder = Path(base) / "presswear" / _source_digest()
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            pass
    except OSError:
        return False
    vars(config)["CACHE_DIR"] = str(folder)
    return True


_OPTIONS = {"error_model": "numpy", "_nrt": False, "no_cfunc_wrapper": True}


class Kernel:
    """A compiled function: a part of those kernels that call it, a whole where Python does."""

    def __init__(
        self, function: Callable[..., Any], is_inlined: bool = False, is_fused: bool = False
    ) -> None:
        update_wrapper(self, function)
        self.py_func, self._is_inlined = function, is_inlined
        self._options = {**_OPTIONS, "fastmath": {"contract"}} if is_fused else _OPTIONS

    @cached_property
    def whole(self) -> Any:
        """What Python calls."""
        made = _NUMBA.njit(pipeline_class=WholeCompiler, **self._options)(self.py_func)
        if _of_package(self.py_func) and _cache_is_usable():
            made._cache = kept_code(self.py_func)
        return made

    @cached_property
    def _part(self) -> Any:
        """What kernels call."""
        part = _NUMBA.njit(
            pipeline_class=PartCompiler,
            no_cpython_wrapper=True,
            forceinline=self._is_inlined,
            **self._options,
        )
        return part(self.py_func)

    def __call__(self, *arguments: Any) -> Any:
        """Run it, compiled or loaded if need be."""
        return self.whole(*arguments)

    @property
    def _numba_type_(self) -> Any:
        return self._part._numba_type_


def compiled(function: F) -> F:
    """Compile a kernel (numba, nopython).

    No kernel allocates: every array belongs to its caller.  Numba's reference counting
    is therefore switched off; it took half of the time of these small functions.  A
    kernel that does allocate is refused by the compiler.

    Kernels of this package keep their compiled code between processes; a kernel
    defined elsewhere is outside the digest and is compiled anew each time.
    """
    return cast(F, Kernel(function))


def inlined(function: F) -> F:
    """Compile a kernel that becomes part of each that calls it, however large.

    For the few that every evaluation runs through: to hand over some dozens of arrays takes as
    long as what they compute.
    """
    return cast(F, Kernel(function, is_inlined=True))


def fused(function: F) -> F:
    """Compile a kernel in which a product and a sum may be one operation, which rounds once.

    For long sums that nobody compares digit by digit; it takes a quarter of their time.
    """
    return cast(F, Kernel(function, is_fused=True))


def fused_inlined(function: F) -> F:
    """Compile a kernel as both ``fused`` and ``inlined`` do."""
    return cast(F, Kernel(function, is_inlined=True, is_fused=True))


def _of_package(function: Callable[..., Any]) -> bool:
    return _PACKAGE in Path(function.__code__.co_filename).resolve().parents


class _Apart(Kernel):
    """A kernel that others call by its address, and that is compiled when one does.

    Its callers know the name of a place in memory that holds the address, or nothing yet, and of
    a function that finds it.
    """

    def __init__(self, function: Callable[..., Any], result: Any, given: tuple[Any, ...]) -> None:
        super().__init__(function)
        self._given = given
        self._place = ctypes.c_void_p()
        self._find = ctypes.CFUNCTYPE(ctypes.c_void_p)(self._found)
        self._name = f"{function.__module__}.{function.__qualname__}"
        binding.add_symbol(f"{self._name}.address", ctypes.addressof(self._place))
        binding.add_symbol(f"{self._name}.find", ctypes.cast(self._find, ctypes.c_void_p).value)
        signature = _TYPING.signature(result, *given)
        template = _TYPING.make_concrete_template(self._name, self, [signature])
        self._type = types.Function(template)
        _LOWER(self, *given)(self._generate)

    def _found(self) -> int | None:
        """Compile it, or load it; called by kernels, which nothing may interrupt."""
        while self._place.value is None:
            try:
                self.whole.compile(self._given)
                code = self.whole.overloads[self._given]
                self._place.value = code.library.get_pointer_to_function(code.fndesc.llvm_func_name)
            except KeyboardInterrupt:
                threading.Timer(0.0, interrupt_main).start()
        return self._place.value

    def _generate(self, context: Any, builder: Any, signature: Any, given: Any) -> Any:
        """Call it from a kernel that is being compiled."""
        convention, result = context.call_conv, signature.return_type
        kind = convention.get_function_type(result, signature.args).as_pointer()
        find = ir.FunctionType(kind, ())
        place = _CGUTILS.get_or_insert_function(builder.module, find, f"{self._name}.find")
        held = _global(builder.module, kind, f"{self._name}.address")
        known = builder.load(held)
        before = builder.block
        with builder.if_then(_CGUTILS.is_null(builder, known), likely=False):
            found = builder.call(place, ())
            inside = builder.block
        address = builder.phi(kind)
        address.add_incoming(known, before)
        address.add_incoming(found, inside)
        # No kernel raises.
        _, value = convention.call_function(builder, address, result, signature.args, given)
        return value

    @property
    def _numba_type_(self) -> Any:
        return self._type


def _global(module: Any, kind: Any, name: str) -> Any:
    """A variable of another module."""
    found = module.globals.get(name)
    return ir.GlobalVariable(module, kind, name) if found is None else found


def apart(result: Any, *given: Any) -> Callable[[F], F]:
    """Compile a kernel that few scenes need apart from those that call it; see ``compiled``.

    Parameters
    ----------
    result
        Type of its result, as below; None for none.
    given
        Types of its parameters: a structured dtype for a record of it, the number of axes of an
        array of numbers, 0 for a number, else a value of that type.
    """
    kinds = tuple(map(_numba_type, given))

    def made(function: F) -> F:
        return cast(F, _Apart(function, _numba_type(result), kinds))

    return made


def _numba_type(given: Any) -> Any:
    if isinstance(given, np.dtype):
        return _NUMBA.from_dtype(given)
    if type(given) is int:
        # What is cut from a larger array may have gaps.
        return _TYPES.Array(_TYPES.float64, given, "A") if given else _TYPES.float64
    return _NUMBA.typeof(given)


def specialised(kernel: F, *arguments: Any) -> F:
    """The compiled function for arguments of these types, compiled or loaded if need be.

    Numba's dispatcher looks up the types of all arguments in every call; with a dozen
    records and arrays that takes longer than a small kernel itself.  This is for
    functions that a solver calls a million times with the same arrays.
    """
    dispatcher = cast(Kernel, kernel).whole
    types = tuple(_NUMBA.typeof(argument) for argument in arguments)
    dispatcher.compile(types)
    return cast(F, dispatcher.overloads[types].entry_point)


def _calling(typing: Any, address: Any, arguments: Any) -> Any:
    """Call a function of numbers that gives a number by its address, with a tuple of them."""

    def generate(context: Any, builder: Any, signature: Any, given: Any) -> Any:
        count = len(signature.args[1])
        double = ir.DoubleType()
        kind = ir.FunctionType(double, [double] * count)
        function = builder.inttoptr(given[0], kind.as_pointer())
        return builder.call(function, _CGUTILS.unpack_tuple(builder, given[1], count))

    return types.float64(types.int64, arguments), generate


call = cast(Callable[[int, tuple[float, ...]], float], intrinsic(_calling))


def _spacing(typing: Any, rows: Any, columns: Any) -> Any:
    """An array of numbers on the stack of the kernel that asks for it."""
    kind = _TYPES.Array(_TYPES.float64, 2, "C")
    shape = rows.literal_value, columns.literal_value

    def generate(context: Any, builder: Any, signature: Any, given: Any) -> Any:
        double = ir.DoubleType()
        space = _CGUTILS.alloca_once(builder, double, size=shape[0] * shape[1])
        size = context.get_abi_sizeof(double)
        sizes = (*shape, shape[1] * size, size, size)
        rows, columns, row, item, width = (context.get_constant(types.intp, n) for n in sizes)
        # It is no part of what runs compiled code.
        populate: Any = import_module("numba.np.arrayobj").populate_array
        made = context.make_array(kind)(context, builder)
        populate(made, space, (rows, columns), (row, item), width, meminfo=None)
        return made._getvalue()

    return kind(rows, columns), generate


working_space = cast(
    Callable[[int, int], Array], _NUMBA.extending.intrinsic(prefer_literal=True)(_spacing)
)
"""An array of so many rows and columns, both constants, that lasts while a kernel runs."""


_KEPT: dict[Any, Any] = {}
"""Machine code that is called by its address, so that it stays."""


def address_of(kernel: Callable[..., float], count: int) -> int:
    """Address of a compiled function of so many numbers, for ``call``."""
    if kernel not in _KEPT:
        function = getattr(kernel, "py_func", kernel)
        _KEPT[kernel] = _NUMBA.cfunc(
            types.float64(*(types.float64,) * count),
            cache=function.__closure__ is None and _of_package(function) and _cache_is_usable(),
            error_model="numpy",
            _nrt=False,
        )(function)
    return int(_KEPT[kernel].address)


class _Listener(event.Listener):
    """Hands on that functions are compiled; those that one calls are compiled within it."""

    def __init__(self, told: Callable[[float], None]) -> None:
        self._told, self._depth, self._began = told, 0, 0.0

    def on_start(self, event: Any) -> None:
        """Hear that it begins."""
        if self._depth == 0:
            self._began = clock.perf_counter()
            self._told(0.0)
        self._depth += 1

    def on_end(self, event: Any) -> None:
        """Hear that it is done."""
        self._depth -= 1
        if self._depth == 0:
            self._told(clock.perf_counter() - self._began)


def told_of_compiling(told: Callable[[float], None]) -> AbstractContextManager[Any]:
    """While this lasts, tell where something is compiled here: 0, then the time it took, s."""
    return cast(AbstractContextManager[Any], _EVENT.install_listener(_COMPILING, _Listener(told)))


@cache
def own_kernel(own: OwnFunction, known: tuple[str, ...]) -> Callable[..., float]:
    """Compile a function of one's own as a function of all known parameters, in their order.

    Raises
    ------
    InputError
        Naming the function, where it is none that can be compiled.
    """
    compiler = _NUMBA.njit(error_model="numpy", _nrt=False)
    space = own.space()
    # Helpers beside it are compiled with it.
    for name, value in space.items():
        if inspect.isfunction(value):
            space[name] = compiler(value)
    asked = ", ".join(own.parameters(own.name, known))
    text = f"def kernel({', '.join(known)}):\n    return float({own.name}({asked}))"
    exec(text, space)
    kernel = compiler(space["kernel"])
    try:
        kernel.compile((types.float64,) * len(known))
    except NumbaError as error:
        why = next((line for line in f"{error}".splitlines()[1:] if line.strip()), f"{error}")
        raise InputError(f"{own.name} cannot be compiled: {why.strip()}") from None
    return cast(Callable[..., float], kernel)


@compiled
def copy_to(target: Array, source: Array) -> None:
    """Copy numbers; ``target[:] = source`` would allocate in case the two overlap."""
    for i in range(target.shape[0]):
        target[i] = source[i]


@compiled
def all_finite(one: Array, other: Array) -> bool:
    """True where both arrays, as long as each other, hold no infinity and no NaN."""
    total = 0.0
    for i in range(one.shape[0]):
        total += one[i] - one[i] + (other[i] - other[i])
    return total == 0.0
