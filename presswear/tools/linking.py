"""How machine code is put together: kernels that kernels call are optimised where they are used.

Numba optimises every function for itself and turns it into machine code, with all that it calls,
before it does the same once more with whatever calls it.  Of a hundred small functions that call
each other that is most of the time, for code that nobody ever runs.  Here a part of a kernel is
kept as it was written, and all parts are linked and optimised once, in the kernel that Python
calls.  The numbers stay what they are: nothing here is allowed to change one.
"""

import gc
import hashlib
from collections.abc import Iterator
from contextlib import contextmanager
from copy import copy
from functools import cache
from types import BuiltinFunctionType
from typing import Any

from numba.core import types
from numba.core.caching import FunctionCache
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import CompilerBase, DefaultPassBuilder
from numba.core.compiler_machinery import LoweringPass, register_pass
from numba.core.cpu import CPUContext
from numba.core.datamodel.packer import ArgPacker
from numba.core.typed_passes import (
    InlineOverloads,
    IRLegalization,
    NativeLowering,
    NopythonRewrites,
)
from numba.core.typing.context import Context
from numba.core.untyped_passes import (
    FindLiterallyCalls,
    InlineClosureLikes,
    InlineInlinables,
    LiteralUnroll,
    MakeFunctionToJitFunction,
    WithLifting,
)

_PASSES: Any = DefaultPassBuilder  # numba's type hints leave out what is used here
_REGISTER: Any = register_pass


class _Linked(JITCodeLibrary):
    """Code that takes its callees' with it, each once."""

    def _optimize_functions(self, module: Any) -> None:
        # All of it is optimised together.
        module.data_layout = self._codegen._data_layout

    def add_linking_library(self, library: Any) -> None:
        if library not in self._linking_libraries:
            self._linking_libraries.append(library)


class _Part(_Linked):
    """Code that waits to be linked."""

    def finalize(self) -> None:
        self._finalized = True


class _Whole(_Linked):
    """Code that is run, with all that it calls."""

    def finalize(self) -> None:
        found: list[Any] = []

        def visit(library: Any) -> None:
            if library not in found:
                for callee in library._linking_libraries if isinstance(library, _Linked) else ():
                    visit(callee)
                found.append(library)

        visit(self)
        # Callers first: what nobody has asked for yet would be left out.
        self._linking_libraries = found[-2::-1]
        finish: Any = super().finalize
        finish()

    def _optimize_final_module(self) -> None:
        codegen: Any = self._codegen
        made = codegen._module_pass_manager()
        # Numba 0.61 makes them ready to run, later ones with what built them.
        passes, *builder = made if isinstance(made, tuple) else (made,)
        passes.run(self._final_module, *builder)


@_REGISTER(mutates_CFG=False, analysis_only=False)
class _Known(LoweringPass):
    """Makes a part known to its callers, though it has no address."""

    _name = "presswear_known"

    def __init__(self) -> None:
        """It has no state."""

    def run_pass(self, state: Any) -> bool:
        lowered = state["cr"]
        name: Any = [].copy  # a dispatcher asks for any builtin function of its own
        state.targetctx.insert_user_function(name, lowered.fndesc, [state.library])
        state["cr"] = lowered._replace(cfunc=name)
        return True


class _InOnePiece:
    """Hands over an argument of a call as it is."""

    def __init__(self, model: Any) -> None:
        self.get_argument_type = model.get_value_type

    def as_argument(self, builder: Any, value: Any) -> Any:
        """What the caller hands over."""
        return value

    def from_argument(self, builder: Any, value: Any) -> Any:
        """What the callee makes of it."""
        return value


class _Models:
    """Numba's knowledge of how arguments are handed over, with named tuples in one piece.

    Numba takes them apart in each call, into the addresses, shapes and strides of all their arrays,
    and puts them together again in each callee.  The machine code becomes the same.
    """

    def __init__(self, models: Any) -> None:
        self._models = models

    def lookup(self, kind: Any) -> Any:
        """How an argument of a type is handed over."""
        model = self._models.lookup(kind)
        return _InOnePiece(model) if isinstance(kind, types.BaseNamedTuple) else model


class _Target(CPUContext):
    """Numba's knowledge of machine code, as kernels need it."""

    def get_arg_packer(self, given: Any) -> Any:
        """How the arguments of a call are handed over."""
        pack: Any = ArgPacker
        return pack(_Models(self.data_model_manager), given)

    def mangler(self, name: Any, types: Any, *, abi_tags: Any = (), uid: Any = None) -> Any:
        """The name of machine code.  With its types spelt out it has up to 16 000 letters."""
        digest = hashlib.sha256(" ".join(map(str, types)).encode()).hexdigest()[:16]
        named: Any = super().mangler
        return named(f"{name}.{digest}", (), abi_tags=abi_tags, uid=uid)

    def get_function(self, function: Any, signature: Any, _firstcall: bool = True) -> Any:
        """What generates a call.  Each access to an array asks for a conversion that it has not."""
        find: Any = super().get_function
        return find(function, signature, _firstcall and function != "__array__")


class _Typing(Context):
    """Numba's knowledge of types, asked once where it is asked for the same again and again."""

    def resolve_function_type(self, function: Any, given: Any, named: Any) -> Any:
        """The signature of a call.  Kernels ask thousands of times what adding two floats gives."""
        resolve: Any = super().resolve_function_type
        if named or not isinstance(function, types.Function | BuiltinFunctionType):
            return resolve(function, given, named)
        known = function, tuple(given)
        if known not in _RESOLVED:
            _RESOLVED[known] = resolve(function, given, named)
        return _RESOLVED[known]


_RESOLVED: dict[Any, Any] = {}

_NEEDLESS = (
    *(WithLifting, InlineClosureLikes, MakeFunctionToJitFunction, InlineOverloads),
    *(InlineInlinables, NopythonRewrites, FindLiterallyCalls, LiteralUnroll, IRLegalization),
)
"""Passes of numba that change no kernel: for closures, arrays as a whole, counted references and
the like."""


@cache
def _as(kind: Any, context: Any) -> Any:
    """A context of numba's as one of another kind that shares what it knows."""
    made = copy(context)
    made.__class__ = kind
    return made


@contextmanager
def _uncollected() -> Iterator[None]:
    """Leave garbage where it lies.  Most of what a compiler makes stays until its end."""
    was = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was:
            gc.enable()


class _Quick(CompilerBase):
    """Numba's compiler without what kernels do not need."""

    def __init__(self, typing: Any, target: Any, *given: Any) -> None:
        begin: Any = super().__init__
        begin(_as(_Typing, typing), _as(_Target, target), *given)

    def _passes(self, library: Any, after: Any = None) -> list[Any]:
        state = self.state
        state.library = library(state.targetctx.codegen(), state.func_id.func_qualname)
        passes = _PASSES.define_nopython_pipeline(state)
        passes.passes = [each for each in passes.passes if each[0] not in _NEEDLESS]
        if after is not None:
            passes.add_pass_after(after, NativeLowering)
        passes._finalized = False
        passes.finalize()
        return [passes]


class _Kept(FunctionCache):
    """Machine code on disk; to load it numba need not know how anything is compiled."""

    def load_overload(self, signature: Any, context: Any) -> Any:
        """Load the code for arguments of some types, if it is kept."""
        guarded: Any = self._guard_against_spurious_io_errors
        with guarded():
            load: Any = self._load_overload
            return load(signature, context)


def kept_code(function: Any) -> Any:
    """The code on disk of a function."""
    made: Any = _Kept
    return made(function)


class PartCompiler(_Quick):
    """Compiles a kernel for kernels."""

    def define_pipelines(self) -> list[Any]:
        """Tell numba how it is compiled."""
        self.state.flags.no_compile = True
        return self._passes(_Part, _Known)


class WholeCompiler(_Quick):
    """Compiles a kernel for Python, or for calls by its address."""

    def compile_extra(self, function: Any) -> Any:
        """Compile it with all its parts."""
        with _uncollected():
            compiled: Any = super().compile_extra
            return compiled(function)

    def define_pipelines(self) -> list[Any]:
        """Tell numba how it is compiled."""
        passes = self._passes(_Whole)
        self.state.library.enable_object_caching()
        return passes
