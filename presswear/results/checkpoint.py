"""The checkpoint of a campaign: one file, written whole, that knows whether it still is.

An ordinary ``.npz`` of arrays, without pickle, with a document in JSON as one of them.
The comment that a zip archive ends with is the SHA-256 of all that stands before it.
"""

import io
import json
import struct
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from presswear.tools.errors import InputError
from presswear.tools.files import arrays_in, digest, read_checked, write_bytes
from presswear.tools.snapshot import Snapshot

FILE = "checkpoint.npz"
_DOCUMENT = "document"
_COMMENT = 64
"""Length of a digest in hexadecimal."""


def sealed(arrays: Snapshot) -> bytes:
    """Arrays by name as an archive that ends with its own digest."""
    packed = io.BytesIO()
    np.savez(packed, **arrays)  # type: ignore[arg-type]
    # The last two bytes of an archive are the length of its comment.
    data = packed.getvalue()[:-2] + struct.pack("<H", _COMMENT)
    return data + digest(data).encode()


def write_checkpoint(path: Path, document: Mapping[str, Any], arrays: Snapshot) -> None:
    """Write a document and arrays into the folder ``path``; the last ones stay until then."""
    text = np.frombuffer(json.dumps(document).encode(), dtype=np.uint8)
    write_bytes(path / FILE, sealed({**arrays, _DOCUMENT: text}))


def read_checkpoint(path: Path) -> tuple[dict[str, Any], Snapshot]:
    """What ``write_checkpoint`` wrote; InputError names a file that is cut off or altered."""
    file = path / FILE
    data = read_checked(file, None)
    if digest(data[:-_COMMENT]).encode() != data[-_COMMENT:]:
        raise InputError(
            f"{file} is cut off or altered: its checksum does not fit; "
            "restore it, or remove it to begin the run anew"
        )
    arrays = arrays_in(data, file)
    document = json.loads(arrays.pop(_DOCUMENT).tobytes())
    return document, arrays
