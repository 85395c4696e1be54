"""How machine code is put together: kernels that kernels call are optimised where they are used.

Numba optimises every function for itself and turns it into machine code, with all that it calls,
before it does the same once more with whatever calls it.  Of a hundred small functions that call
each other that is most of the time, for code that nobody ever runs.  Here a part of a kernel is
kept as it was written, and all parts are linked and optimised once, in the kernel that Python
calls.  The numbers stay what they are: nothing here is allowed to change one.
"""

from typing import Any

from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import CompilerBase, DefaultPassBuilder
from numba.core.compiler_machinery import LoweringPass, register_pass
from numba.core.typed_passes import NativeLowering

_Library: Any = JITCodeLibrary  # numba's type hints leave out what is used here
_Compiler: Any = CompilerBase
_Pass: Any = LoweringPass


class _Linked(_Library):
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
        self._raise_if_finalized()
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
        super().finalize()

    def _optimize_final_module(self) -> None:
        passes, builder = self._codegen._module_pass_manager()
        passes.run(self._final_module, builder)


@register_pass(mutates_CFG=False, analysis_only=False)
class _Known(_Pass):
    """Makes a part known to its callers, though it has no address."""

    _name = "presswear_known"

    def __init__(self) -> None:
        _Pass.__init__(self)

    def run_pass(self, state: Any) -> bool:
        lowered = state["cr"]
        name = [].copy  # a dispatcher asks for any builtin function of its own
        state.targetctx.insert_user_function(name, lowered.fndesc, [state.library])
        state["cr"] = lowered._replace(cfunc=name)
        return True


class PartCompiler(_Compiler):
    """Compiles a kernel for kernels."""

    def define_pipelines(self) -> list[Any]:
        state = self.state
        state.flags.no_compile = True
        state.library = _Part(state.targetctx.codegen(), state.func_id.func_qualname)
        passes = DefaultPassBuilder.define_nopython_pipeline(state)
        passes.add_pass_after(_Known, NativeLowering)
        passes.finalize()
        return [passes]


class WholeCompiler(_Compiler):
    """Compiles a kernel for Python, or for calls by its address."""

    def define_pipelines(self) -> list[Any]:
        state = self.state
        state.library = _Whole(state.targetctx.codegen(), state.func_id.func_qualname)
        state.library.enable_object_caching()
        return [DefaultPassBuilder.define_nopython_pipeline(state)]
