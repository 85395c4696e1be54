"""Choice of Exudyn's compiled module: by default without range checks, with vector instructions.

A step of the open tree spends seven eighths of its time in the module. Its input is
checked before. The environment variable EXUDYN_MODULE=safe selects the module with
range checks, whose numbers differ in their last digits.
"""

import io
import os
import sys
from contextlib import redirect_stdout
from importlib import import_module
from typing import Any


def requested() -> str:
    """Return the requested module: ``fast`` or ``safe``."""
    word = os.environ.get("EXUDYN_MODULE", "").strip().lower() or "fast"
    return "fast" if word == "fast" else "safe"


def exudyn_module() -> Any:
    """Return Exudyn, imported as requested unless it is imported already.

    Exudyn falls back on the safe module where the processor lacks the instructions.
    """
    if "exudyn" not in sys.modules:
        vars(sys)["exudynFast"] = requested() == "fast"
    with redirect_stdout(io.StringIO()):  # which would tell the choice on every start
        return import_module("exudyn")
