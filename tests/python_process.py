"""Python in a process that shares nothing with the tests."""

import os
import subprocess
import sys
from typing import Any


def python(
    *words: object, env: dict[str, str] | None = None, **options: Any
) -> "subprocess.CompletedProcess[str]":
    """Run Python with arguments and with variables of the environment; capture its output."""
    command = [sys.executable, *map(str, words)]
    options = {"capture_output": True, "text": True, "check": False} | options
    return subprocess.run(command, env=os.environ | (env or {}), **options)
