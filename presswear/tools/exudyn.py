"""Exudyn's compiled module: the one without range checks and with vector instructions.

A step of the open tree takes seven eighths of the time in it.  What is handed to Exudyn here is
checked before; the environment's EXUDYN_MODULE=safe takes the module with range checks, whose
numbers differ in their last digits.
"""

import io
import os
import sys
from contextlib import redirect_stdout
from importlib import import_module
from typing import Any


def wanted() -> str:
    """The module that is asked for: ``fast`` or ``safe``."""
    word = os.environ.get("EXUDYN_MODULE", "").strip().lower() or "fast"
    return "fast" if word == "fast" else "safe"


def exudyn_module() -> Any:
    """Exudyn, as it is loaded already or as it is wanted.

    It falls back on the safe module itself where the processor lacks the instructions.
    """
    if "exudyn" not in sys.modules:
        vars(sys)["exudynFast"] = wanted() == "fast"
    with redirect_stdout(io.StringIO()):  # which would tell the choice on every start
        return import_module("exudyn")
