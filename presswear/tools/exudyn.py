"""Choice of Exudyn's compiled module: by default without range checks, with vector instructions.

The engine ``exudyn-tree`` spends seven eighths of the time of a step in the module. The
program checks the input of the module beforehand. The environment variable EXUDYN_MODULE=safe
selects the module with range checks, whose numbers differ in their last digits.
"""

import io
import os
import sys
from contextlib import redirect_stdout
from importlib import import_module
from typing import Any


def requested_module() -> str:
    """Return the requested module: ``fast``, the default, or ``safe``."""
    name = os.environ.get("EXUDYN_MODULE", "").strip().lower()
    return "fast" if name in ("", "fast") else "safe"


def exudyn_module() -> Any:
    """Return Exudyn, imported as requested unless it is imported already.

    Exudyn falls back on the safe module where the processor lacks the instructions.
    """
    if "exudyn" not in sys.modules:
        # Exudyn reads ``sys.exudynFast`` when it is imported.
        vars(sys)["exudynFast"] = requested_module() == "fast"
    with redirect_stdout(io.StringIO()):  # Exudyn prints the choice at each start.
        return import_module("exudyn")
