"""Compilers for kernels, and for functions that only kernels call.

Numba optimises each function in full, together with all functions that it calls, and
makes machine code of it. A callee needs the simple passes only and no machine code,
because its callers contain it. Two more things save compilation time: passes for
features that kernels do not use are left out, and the type of a sum or product of
numbers is determined once, not at each place.
"""

import operator
from collections.abc import Iterator
from contextlib import contextmanager
from importlib import import_module
from pathlib import Path
from typing import Any

from numba.core import typed_passes as typed
from numba.core import types
from numba.core import untyped_passes as untyped
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import Compiler
from numba.core.compiler_machinery import PassManager
from numba.core.registry import cpu_target
from numba.extending import lower_builtin

from presswear.tools.files import digest
from presswear.tools.processes import signals_held

_FILES = (
    Path(__file__),
    *map(Path(__file__).with_name, ("packing.py", "constant_places.py")),
)
# Digest of the files of the compiler, on which the machine code depends
COMPILER = digest(b"".join(file.read_bytes() for file in _FILES))

# Passes of numba without those for closures, ``with``, generators and array expressions
_PASSES = (
    untyped.TranslateByteCode,
    untyped.FixupArgs,
    untyped.IRProcessing,
    untyped.RewriteSemanticConstants,
    untyped.DeadBranchPrune,
    untyped.GenericRewrites,
    untyped.ReconstructSSA,
    untyped.DeadBranchPrune,
    typed.NopythonTypeInference,
    typed.PreLowerStripPhis,
    typed.AnnotateTypes,
    typed.NativeLowering,
    typed.NoPythonBackend,
)
# Words in the frame of ``_compile_core``. Python stores the frames of calls in pieces of
# 16 kB. Nested compilations cross the end of a piece 70 000 times, and allocate and free
# memory each time, which takes a seventh of the whole time. The large frame makes Python
# allocate a piece of 2 MB, which has room for the frames of all nested calls.
_FRAME = 140_000

_OPERATORS: set[Any] = {bool, max, min, *filter(callable, vars(operator).values())}
_NUMBERS = types.Number, types.Boolean, types.Literal
_signatures: dict[Any, Any] = {}  # signatures of operators between numbers


# Numba looks for this function at each use of an array. Without it numba loads all its
# modules.
lower_builtin("__array__", types.Array)(
    lambda context, builder, signature, arrays: arrays[0]
)


@contextmanager
def _types_determined_once() -> Iterator[None]:
    """Determine the type of each operator between numbers once."""
    typing = cpu_target.typing_context
    find = typing.resolve_function_type

    def resolve(function: Any, arguments: Any, named: Any) -> Any:
        is_operator = getattr(function, "typing_key", None) in _OPERATORS
        if not (
            is_operator
            and all(isinstance(argument, _NUMBERS) for argument in arguments)
        ):
            return find(function, arguments, named)
        key = function, arguments
        if key not in _signatures:
            _signatures[key] = find(*key, named)
        return _signatures[key]

    typing.resolve_function_type = resolve
    try:
        yield
    finally:
        del typing.resolve_function_type


class KernelCompiler(Compiler):
    """Compiler of kernels with all that they call.

    Signals are delayed during a compilation, because an interrupted compilation in LLVM
    ends the process with a fault.
    """

    def __init__(self, *arguments: Any) -> None:
        with signals_held():
            super().__init__(*arguments)

    def define_pipelines(self) -> Any:
        """Return the passes; numba calls this before the first one."""
        manager = PassManager("kernel")
        for compiler_pass in _PASSES:
            manager.add_pass(compiler_pass, compiler_pass.__name__)
        manager.finalize()
        return [manager]

    def _compile_core(self) -> Any:
        # Slow to import, and needed only if something is compiled
        import_module("presswear.tools.constant_places")
        with signals_held(), _types_determined_once():
            return super()._compile_core()

    _compile_core.__code__ = _compile_core.__code__.replace(co_stacksize=_FRAME)


class _CalleeLibrary(JITCodeLibrary):
    """Code of a callee: simple passes, no machine code."""

    def _optimize_final_module(self) -> None:
        manager, builder = self._codegen._module_pass_manager(
            cost="cheap",
            opt=self._codegen._opt_level,
            loop_vectorize=False,
            slp_vectorize=False,
        )
        manager.run(self._final_module, builder)

    def _finalize_final_module(self) -> None:
        self._finalized = True


class CalleeCompiler(KernelCompiler):
    """Compiler whose code is optimised in part, for callers that optimise it in full."""

    def define_pipelines(self) -> Any:
        """Return the passes; numba calls this before the first one."""
        codegen = self.state.targetctx.codegen()
        self.state.library = _CalleeLibrary(codegen, self.state.func_id.func_qualname)
        self.state.flags.no_compile = True
        return super().define_pipelines()

    def _compile_core(self) -> Any:
        code = Compiler._compile_core(self)
        # Numba finds the callee by its function for Python. There is none, and any new
        # built-in function serves.
        key = [code].append
        code.library._ensure_finalized()
        code.target_context.insert_user_function(key, code.fndesc, [code.library])
        return code._replace(entry_point=key)
