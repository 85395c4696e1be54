"""Where results may go: said before anything is computed, not when they are to be written."""

import os
import tempfile
from pathlib import Path

from presswear.tools.errors import InputError

LONGEST_NAME = 255
"""Bytes of a name in common file systems."""


def check_name(path: Path) -> None:
    """InputError unless a file or folder can have this name, and it can be shown."""
    text = os.fspath(path)
    if not text.isprintable():
        raise InputError(f"{text!r}: a name of printable characters is expected")
    if any(len(part.encode()) > LONGEST_NAME for part in path.parts):
        raise InputError(f"{text}: names of at most {LONGEST_NAME} bytes are expected")


def check_new_folder(path: Path) -> None:
    """InputError unless a folder of this name is empty, or can be made and written into."""
    check_name(path)
    text = os.fspath(path)
    try:
        if path.is_symlink() and not path.exists():
            raise InputError(f"--out {text}: it is a link that leads nowhere")
        if path.exists() and (not path.is_dir() or any(path.iterdir())):
            raise InputError(f"--out {text}: it exists and is not empty; name a new folder")
        there = path
        while not there.exists():
            there = there.parent
        if not there.is_dir():
            raise InputError(f"--out {text}: {there} is no folder")
        # Permissions do not tell for every kind of file system: trying does.
        os.rmdir(tempfile.mkdtemp(dir=there))
    except OSError as error:
        raise InputError(f"--out {text}: nothing can be written there: {error.strerror}") from None
