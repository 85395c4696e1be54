"""Compiler for functions that only other compiled functions call.

Numba optimises each function in full, together with all that it calls, and again in each of its
callers, and makes machine code of it. A callee needs the simple passes only, and no machine code:
its callers contain it.
"""

from pathlib import Path
from typing import Any

from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import Compiler

from presswear.tools.files import digest

COMPILER = digest(Path(__file__).read_bytes())  # part of what machine code depends on


class _CalleeLibrary(JITCodeLibrary):
    def _optimize_final_module(self) -> None:
        manager, builder = self._codegen._module_pass_manager(
            cost="cheap", opt=self._codegen._opt_level, loop_vectorize=False, slp_vectorize=False
        )
        manager.run(self._final_module, builder)

    def _finalize_final_module(self) -> None:
        self._finalized = True


class CalleeCompiler(Compiler):
    """Compiler whose code is optimised in part, for callers that optimise it in full."""

    def define_pipelines(self) -> Any:
        """Return the passes; numba calls this before the first one."""
        codegen = self.state.targetctx.codegen()
        self.state.library = _CalleeLibrary(codegen, self.state.func_id.func_qualname)
        self.state.flags.no_compile = True
        return super().define_pipelines()

    def _compile_core(self) -> Any:
        code = super()._compile_core()
        # In place of the function for Python: any built-in function of its own, which numba finds
        # the callee by
        key = [code].append
        code.library._ensure_finalized()
        code.target_context.insert_user_function(key, code.fndesc, [code.library])
        return code._replace(entry_point=key)
