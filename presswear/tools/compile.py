"""Just-in-time compilation by numba, and a cache of machine code for all environments of a user.

A damaged file in the cache of numba ends every program that reads it, and an edit in
``friction_and_normal.py`` leaves the compiled callers in ``contact.py`` unchanged. This
package therefore stores each kernel in a file whose name is a digest of all that the
machine code depends on (``kernel_digest``), and whose content is checked before use.

User laws and kernels that few scenes need are called by the address of their machine
code, so that their callers are not compiled again for them.
"""

import ctypes
import gc
import os
import threading
from _thread import interrupt_main
from collections.abc import Callable
from contextlib import AbstractContextManager
from functools import cache, cached_property, partial, update_wrapper
from pathlib import Path
from typing import Any, TypeVar, cast

import numba
import numpy as np
from llvmlite import binding, ir
from numba.core import cgutils, config, event, types, typing
from numba.extending import lower_builtin

from presswear.tools.arrays import Array
from presswear.tools.compile_errors import short_errors
from presswear.tools.intrinsic import intrinsic_with
from presswear.tools.kernel_cache import KernelCache
from presswear.tools.kernel_compiler import COMPILER, CalleeCompiler, KernelCompiler
from presswear.tools.kernel_digest import function_digest, options_text
from presswear.tools.processes import signals_held

F = TypeVar("F", bound=Callable[..., Any])
# structured array; kernels read ``records[k].name``, a type checker cannot
Records = Any


def floats(*names: str) -> list[tuple[str, type]]:
    """Return fields of a record for floating-point numbers."""
    return [(name, np.float64) for name in names]


_PACKAGE = Path(__file__).parents[1]
# A callee is compiled once. It inherits an option that is missing here from its first
# caller: the last digits then depend on which callers were loaded from the cache.
# "contract" means a product and a sum with one rounding, which takes 9 % less time.
_OPTIONS = {
    "error_model": "numpy",
    "_nrt": False,
    "fastmath": {"contract"},
    "forceinline": False,
}


class _Listener(event.Listener):
    """Call functions at the start and at the end of a compilation, its callees included."""

    def __init__(self, start: Callable[[], object], end: Callable[[], object]) -> None:
        self._start = start
        self._end = end
        self._depth = 0  # number of nested compilations

    def on_start(self, event: Any) -> None:
        if self._depth == 0:
            self._start()
        self._depth += 1

    def on_end(self, event: Any) -> None:
        self._depth -= 1
        if self._depth == 0:
            self._end()


# Garbage collection is off while numba compiles, because nearly all objects stay alive.
event.register("numba:compile", _Listener(gc.disable, gc.enable))


def on_compiling(report: Callable[[], object]) -> AbstractContextManager[Any]:
    """Report the start and the end of every compilation within the context."""
    listener: Any = event.install_listener("numba:compile", _Listener(report, report))
    return cast(AbstractContextManager[Any], listener)


class Kernel:
    """Compiled function; its machine code is made or loaded at the first call.

    A function that was written at run time has the ``file`` in which its names are
    defined.
    """

    is_inside_callers = True  # the machine code of its callers contains its own

    def __init__(
        self, function: Callable[..., Any], file: str = "", **options: Any
    ) -> None:
        update_wrapper(self, function)
        self.py_func = function
        self.options = {**_OPTIONS, **options}
        self._name = f"{function.__module__}.{function.__qualname__}"
        source = file or function.__code__.co_filename
        self._is_stored = (
            source.startswith(f"{_PACKAGE}{os.sep}") and not function.__closure__
        )

    def dispatcher(self, **wrappers: bool) -> Any:
        """Return the function compiled by numba and stored, with all that it calls."""
        options = {**self.options, **wrappers}
        decorator = numba.njit(**options, pipeline_class=KernelCompiler)
        # The first dispatcher creates the compiler of LLVM, which no signal may interrupt.
        with signals_held():
            dispatcher = decorator(self.py_func)
        if self._is_stored:
            code = function_digest(self.py_func)
            text = options_text(options)
            dispatcher._cache = KernelCache(self._name, text, code, COMPILER)
        return dispatcher

    @cached_property
    def from_python(self) -> Any:
        """Dispatcher for calls from Python."""
        return self.dispatcher(no_cfunc_wrapper=True)

    @cached_property
    def _numba_type_(self) -> Any:
        options = {**self.options, "no_cpython_wrapper": True, "no_cfunc_wrapper": True}
        compiler = numba.njit(**options, pipeline_class=CalleeCompiler)
        callee = compiler(self.py_func)
        self._from_kernels = callee  # the type of numba does not keep it alive
        template = callee.get_call_template

        def template_for_numbers(arguments: Any, named: Any) -> Any:
            return template(tuple(map(types.unliteral, arguments)), named)

        # Numba would compile the callee once for each literal number.
        callee.get_call_template = template_for_numbers
        return callee._numba_type_

    def __call__(self, *arguments: Any) -> Any:
        """Call the compiled function; with NUMBA_DISABLE_JIT=1 the function in plain Python."""
        if config.DISABLE_JIT:
            return self.py_func(*map(readable, arguments))
        with short_errors:
            return self.from_python(*arguments)


def _decorator(**options: Any) -> Callable[[F], F]:
    return cast(Callable[[F], F], partial(Kernel, **options))


# Kernels do not allocate, and the compiler refuses one that does: the reference
# counting of numba would take half of their time. A kernel of every evaluation is
# inlined, because to pass its arrays takes as long as its work.
compiled = _decorator()
inlined = _decorator(forceinline=True)
# Sums in any order, which the compiler needs to add several terms at a time. The terms
# are finite.
vectorised = _decorator(
    forceinline=True, fastmath={"contract", "reassoc", "nsz", "nnan"}
)


_FAILED = 2**64 - 1  # replaces the address of a kernel that cannot be compiled


class _LazyKernel(Kernel):
    """Kernel that is called by its address and compiled at the first call.

    Callers load the address from a variable. If it is zero, they call a function that
    compiles the kernel.
    """

    is_inside_callers = False

    def __init__(
        self, function: Callable[..., Any], result: Any, parameters: tuple[Any, ...]
    ) -> None:
        super().__init__(function)
        self._parameters = parameters
        self._address = ctypes.c_void_p()
        self._callback = ctypes.CFUNCTYPE(ctypes.c_void_p)(self._compile)
        binding.add_symbol(f"{self._name}.address", ctypes.addressof(self._address))
        callback = ctypes.cast(self._callback, ctypes.c_void_p).value
        binding.add_symbol(f"{self._name}.compile", callback)
        signature = typing.signature(result, *parameters)
        lower_builtin(self, *parameters)(self.generate_call)
        template = typing.make_concrete_template(self._name, self, [signature])
        self._numba_type_ = types.Function(template)

    def _compile(self) -> int | None:
        """Compile or load the kernel and return its address, or _FAILED.

        An interrupt returns None; kernels then call this function again.
        """
        try:
            with short_errors:
                self.from_python.compile(self._parameters)
            code = self.from_python.overloads[self._parameters]
            name = code.fndesc.llvm_func_name
            self._address.value = code.library.get_pointer_to_function(name)
        except KeyboardInterrupt:
            threading.Timer(0.0, interrupt_main).start()
        # Machine code calls this and cannot pass on any error of the compiler.
        except Exception as error:
            short_errors.lazy_failure = error
            return _FAILED
        return self._address.value

    def generate_call(
        self, context: Any, builder: Any, signature: Any, arguments: Any
    ) -> Any:
        """Write a call: load the address, get it from ``_compile`` if it is 0, and call it.

        While ``_compile`` returns 0, after an interrupt, it is called again.
        """
        convention = context.call_conv
        result = signature.return_type
        pointer = convention.get_function_type(result, signature.args).as_pointer()
        compile_first = cgutils.get_or_insert_function(
            builder.module, ir.FunctionType(pointer, ()), f"{self._name}.compile"
        )
        name = f"{self._name}.address"
        variable = builder.module.globals.get(name)
        if variable is None:
            variable = ir.GlobalVariable(builder.module, pointer, name)
        stored = builder.load(variable)
        before = builder.block
        missing = builder.append_basic_block()
        ready = builder.append_basic_block()
        branch = builder.cbranch(cgutils.is_null(builder, stored), missing, ready)
        branch.set_weights([1, 99])  # the kernel is missing at the first call only
        builder.position_at_end(missing)
        kernel = builder.call(compile_first, ())
        failed = builder.inttoptr(ir.IntType(64)(_FAILED), pointer)
        with builder.if_then(builder.icmp_unsigned("==", kernel, failed), likely=False):
            message = f"{self._name} cannot be compiled"  # see ``lazy_failure``
            convention.return_user_exc(builder, RuntimeError, (message,))
        compiled_now = builder.block
        builder.cbranch(cgutils.is_null(builder, kernel), missing, ready)
        builder.position_at_end(ready)
        address = builder.phi(pointer)
        address.add_incoming(stored, before)
        address.add_incoming(kernel, compiled_now)
        status, value = convention.call_function(
            builder, address, result, signature.args, arguments
        )
        with cgutils.if_unlikely(builder, status.is_error):
            convention.return_status_propagate(builder, status)
        return value


def lazily_compiled(result: Any, *parameters: Any) -> Callable[[F], F]:
    """Compile a kernel that few scenes need apart from its callers.

    Result and parameters are described by a structured dtype for a record, the number
    of axes of an array of numbers, 0 for a number, or else an example value. The result
    None stands for no result.
    """

    def numba_type(example: Any) -> Any:
        if isinstance(example, np.dtype):
            return numba.from_dtype(example)
        if type(example) is not int:
            return numba.typeof(example)
        if example == 0:
            return types.float64
        # "A": a slice of a larger array may have gaps.
        return types.Array(types.float64, example, "A")

    kinds = tuple(map(numba_type, parameters))
    decorator = partial(_LazyKernel, result=numba_type(result), parameters=kinds)
    return cast(Callable[[F], F], decorator)


def specialised(kernel: F, *arguments: Any) -> F:
    """Return the compiled function for these types, which numba would look up in each call.

    Raises
    ------
    RunFailed
        If the kernel cannot be compiled for them; with file, line and reason.
    """
    if config.DISABLE_JIT:
        return kernel
    dispatcher = cast(Kernel, kernel).from_python
    kinds = tuple(map(numba.typeof, arguments))
    with short_errors:
        dispatcher.compile(kinds)
    return cast(F, dispatcher.overloads[kinds].entry_point)


def _in_python(entry: int, arguments: tuple[Any, ...]) -> Any:
    return _entries[entry](*arguments)


def _calling(result: Any, arguments: Any) -> Any:
    """Return signature and code of a call of a kernel by its entry.

    An error in the kernel ends its caller, too, so that Python raises it. A function
    with the interface of C would print it and go on.
    """
    signature = result(types.int64, arguments)
    kinds = arguments.types

    def generate(context: Any, builder: Any, _: Any, values: Any) -> Any:
        convention = context.call_conv
        pointer = convention.get_function_type(result, kinds).as_pointer()
        function = builder.inttoptr(values[0], pointer)
        parts = cgutils.unpack_tuple(builder, values[1], len(kinds))
        status, value = convention.call_function(
            builder, function, result, kinds, parts
        )
        with cgutils.if_unlikely(builder, status.is_error):
            convention.return_status_propagate(builder, status)
        return context.get_dummy_value() if result is types.none else value

    return signature, generate


@intrinsic_with(_in_python)
def _call(typing: Any, entry: Any, arguments: Any) -> Any:
    numbers = types.UniTuple(types.float64, len(arguments))
    return _calling(types.float64, numbers)


@intrinsic_with(_in_python)
def _call_entry(typing: Any, entry: Any, arguments: Any) -> Any:
    return _calling(types.none, arguments)


# In a kernel: call a function of numbers by its address, with a tuple of its arguments.
call = cast(Callable[[int, tuple[float, ...]], float], _call)
# In a kernel: call a kernel without result by its entry, with a tuple of arguments of
# its types.
call_entry = cast(Callable[[int, tuple[Any, ...]], None], _call_entry)


def entry_of(kernel: Callable[..., Any], *arguments: Any) -> int:
    """Return the entry of a kernel for ``call_entry``, compiled for arguments of these types.

    The address of packed arguments may be passed as a number.
    """
    if config.DISABLE_JIT:
        entry = id(kernel)
    else:
        dispatcher = cast(Kernel, kernel).from_python
        kinds = tuple(map(numba.typeof, arguments))
        with short_errors:
            dispatcher.compile(kinds)
        entry = _address_of(dispatcher.overloads[kinds])
    _entries[entry] = kernel
    return entry


_called: list[Any] = []  # machine code that is called by address must stay in memory
# kernels that plain Python calls by their entry
_entries: dict[int, Callable[..., Any]] = {}


@cache
def address_of(kernel: Callable[..., float], count: int) -> int:
    """Return the address of a compiled function of ``count`` numbers, for ``call``."""
    dispatcher: Any = kernel.dispatcher() if isinstance(kernel, Kernel) else kernel
    if config.DISABLE_JIT:
        address = id(kernel)
    else:
        numbers = (types.float64,) * count
        dispatcher.compile(numbers)
        address = _address_of(dispatcher.overloads[numbers])
    _entries[address] = kernel
    return address


def _address_of(code: Any) -> int:
    """Return the address of machine code with the interface of numba; keep it in memory."""
    _called.append(code)
    return int(code.library.get_pointer_to_function(code.fndesc.llvm_func_name))


@compiled
def copy_to(target: Array, source: Array) -> None:
    """Copy numbers; ``target[:] = source`` would allocate in case the two overlap."""
    for i in range(target.shape[0]):
        target[i] = source[i]


@compiled
def all_finite(first: Array, second: Array) -> bool:
    """Return whether two arrays of equal length contain no infinity and no NaN."""
    total = 0.0
    for i in range(first.shape[0]):
        # Infinity minus infinity is NaN, and so is NaN minus NaN.
        total += first[i] - first[i] + (second[i] - second[i])
    return total == 0.0


def readable(arguments: Any) -> Any:
    """Return arguments whose records have attributes, as they have in kernels."""
    if isinstance(arguments, tuple):
        parts = map(readable, arguments)
        is_named = hasattr(arguments, "_fields")
        return type(arguments)(*parts) if is_named else tuple(parts)
    if isinstance(arguments, np.void) and not isinstance(arguments, np.record):
        return arguments.view((np.record, arguments.dtype))
    if isinstance(arguments, np.ndarray) and arguments.dtype.names:
        return arguments.view(np.recarray)
    return arguments
