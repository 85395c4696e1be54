"""Results altered by somebody made to deceive: damaged or strange, but their checksums fit.

What is tried so are the checkers behind the checksum.
"""

import hashlib
import io
import json
import os
import pickle
import struct
import warnings
import zipfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from operator import setitem
from pathlib import Path
from random import Random
from typing import Any

import numpy as np

FILE = "result.json"
MARK = "executed"
"""Folder that is made where something in a file is executed."""
BOMB = 2**31
"""Bytes that a small file promises to unpack to."""
NO_LEAVES: tuple[Any, ...] = (True, False, [], {}, 10**400, -(10**400), float("nan"), float("inf"))
"""What can stand nowhere in the place of a number or a text."""
_DEPTH = 100_000
"""Brackets inside each other, far beyond what a parser follows."""


def digest(data: bytes) -> bytes:
    """SHA-256 in hexadecimal."""
    return hashlib.sha256(data).hexdigest().encode()


@contextmanager
def document_of(folder: Path) -> Iterator[dict[str, Any]]:
    """What a result says of itself, to be altered."""
    document = json.loads((folder / FILE).read_text())
    yield document
    (folder / FILE).write_text(json.dumps(document, indent=1))


def replace_file(folder: Path, name: str, data: bytes) -> None:
    """Put another file into a result, and have that say that it should be so."""
    (folder / name).write_bytes(data)
    with document_of(folder) as document:
        document["files"][name] = digest(data).decode()


@contextmanager
def arrays_of(folder: Path, name: str) -> Iterator[dict[str, Any]]:
    """Arrays of a stage by name, to be altered to whatever numpy can store."""
    with np.load(folder / name) as stored:
        arrays = dict(stored)
    yield arrays
    packed = io.BytesIO()
    np.savez_compressed(packed, **arrays)
    replace_file(folder, name, packed.getvalue())


def leaves(owner: Any) -> Iterator[tuple[Any, Any]]:
    """Every place of a number, text or null: what holds it, and its key there."""
    items = owner.items() if isinstance(owner, dict) else enumerate(owner)
    for key, value in items:
        if isinstance(value, dict | list):
            yield from leaves(value)
        else:
            yield owner, key


def altered_document(draw: Random, folder: Path) -> None:
    """A document with a part of no kind that fits, missing, strange, or at odds with others."""
    with document_of(folder) as document:
        scene, stages, own = document["scene"], document["stages"], document["schema"]
        places = [(part, key) for part, key in leaves(document) if part is not document["files"]]
        leaf, name = draw.choice(places)
        # Anything goes into the origins, and nothing must.
        inner = [part for key, part in scene.items() if key != "origins"]
        parts = [scene, *(part for part in inner if isinstance(part, dict))]
        whole = draw.choice([document, draw.choice(stages), *filter(None, parts)])
        strange = draw.choice(("colour", "__class__", "self", "\n", ""))
        schemas = (0, -1, own + 1, own - 1, True, False, float(own), 1.0, f"{own}", None, 10**30)
        indices = (-1, 7, 10**9, "0", "../stage-0", "0/../../x", 0.0, 1.0, True, None, [0], "\0")
        # Those that can be done in many ways are more often done.
        edits: tuple[Callable[[], object], ...] = (
            *(lambda: setitem(leaf, name, draw.choice(NO_LEAVES)),) * 6,
            *(lambda: whole.pop(draw.choice(sorted(whole))),) * 6,
            *(lambda: setitem(draw.choice(parts), strange, 1),) * 3,
            *(lambda: document.update(schema=draw.choice((*schemas, [own], {"4": own}))),) * 3,
            *(lambda: draw.choice(stages).update(index=draw.choice(indices)),) * 3,
            lambda: document.update(engine="exudyn-joints"),
            lambda: document.update(conventions={}),
            lambda: scene.update(wear_updates=0),
            lambda: scene.update(joints="A"),
            lambda: scene["bearings"].update(angles=90),
            lambda: scene["bearings"].update(clearance=0.02),
            lambda: scene["mechanism"].update(kind="slider-crank"),
            lambda: scene["mechanism"].update(length_3=0.05),
            lambda: stages.append(stages[0]),
            stages.reverse,
        )
        draw.choice(edits)()


def no_document(draw: Random, folder: Path) -> None:
    """Something that is no document: cut, twice named, too deep, no text."""
    text = (folder / FILE).read_bytes()
    texts = (
        *(b"", b"[]", b"null", b"\x00\xff", "{}".encode("utf-16")),
        text[: draw.randrange(1, len(text) - 1)],
        text.replace(b'"schema"', b'"schema": 8, "schema"', 1),
        b'{"schema": 8, "stages": ' + b"[" * _DEPTH,
        b'{"schema": ' + b"9" * 5000 + b"}",
        b"!!python/object/apply:os.system ['touch executed']",
    )
    (folder / FILE).write_bytes(draw.choice(texts))


class _Payload:
    """What a pickle would execute."""

    def __reduce__(self) -> tuple[Any, ...]:
        return os.mkdir, (MARK,)


def _stage(draw: Random) -> str:
    return f"stage-{draw.randrange(2)}.npz"


def executable_array(draw: Random, folder: Path) -> None:
    """An array that is code, for whoever would run it."""
    with arrays_of(folder, _stage(draw)) as arrays:
        arrays[draw.choice(("time", "extra"))] = np.array([_Payload()], dtype=object)


def altered_array(draw: Random, folder: Path) -> None:
    """An array that is missing, misshapen, of another kind or holds what no motion has."""
    always = ("time", "slider", "angle", "A_eccentricity", "C_force", "A_depth_pin", "C_sliding")
    name = draw.choice(always)
    kinds: tuple[Any, ...] = ("U8", "S8", "complex128", "datetime64[s]", "bool", [("a", "f8")])
    with arrays_of(folder, _stage(draw)) as arrays:
        values = arrays[name]
        broken = values.copy()
        broken[draw.randrange(len(values))] = draw.choice((np.nan, np.inf, -np.inf))
        edits: tuple[Callable[[], object], ...] = (
            *(lambda: setitem(arrays, name, np.zeros(values.shape, draw.choice(kinds))),) * 4,
            lambda: setitem(arrays, name, values[:-1]),
            lambda: setitem(arrays, name, values[np.newaxis]),
            lambda: setitem(arrays, name, broken),
            lambda: arrays.update(time=arrays["time"][::-1]),
            lambda: arrays.update(A_wear_bearing=arrays["A_wear_bearing"] - 1.0),
            lambda: arrays.pop(name),
        )
        draw.choice(edits)()


def _added(archive: bytes, name: str, data: bytes) -> bytes:
    """An archive with one more file in it."""
    buffer = io.BytesIO(archive)
    with (
        warnings.catch_warnings(action="ignore"),  # of a name that is there twice
        zipfile.ZipFile(buffer, "a", zipfile.ZIP_DEFLATED) as opened,
    ):
        opened.writestr(name, data)
    return buffer.getvalue()


def _bomb() -> bytes:
    """A small archive that says it unpacks to BOMB bytes."""
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("time.npy", b"\0" * 1000)
        archive.filelist[0].file_size = BOMB
    return buffer.getvalue()


def altered_file(draw: Random, folder: Path) -> None:
    """A stage's file that is missing, cut, flipped in a bit, a bomb, code, or with false sizes."""
    name = _stage(draw)
    data = (folder / name).read_bytes()
    shapes = ("(10000000000000,)", "(-1, -1)", "(2**62,)", "(1e3,)", "('a',)", "(", "(" * 200, "()")
    header = f"{{'descr': '<f8', 'fortran_order': False, 'shape': {draw.choice(shapes)}, }}\n"
    none = draw.choice(("__import__('os').mkdir('executed')\n", "x" * 60_000, ""))
    text = draw.choice((header, header, none)).encode()
    array = b"\x93NUMPY\x01\x00" + struct.pack("<H", len(text)) + text + b"\0" * 16
    # Behind the first header and far before the directory at the end.
    place = draw.randrange(1000, len(data) // 2)
    flipped = bytes([data[place] ^ (1 << draw.randrange(8))])
    files = (
        *(_added(data, "extra.npy", array),) * 6,
        data[: draw.randrange(len(data))],
        data[:place] + flipped + data[place + 1 :],
        draw.choice((b"", b"PK\x03\x04", b"\x93NUMPY", data[4:])),
        _added(data, "time.npy", b""),
        _bomb(),
        pickle.dumps(_Payload()),
        None,
    )
    file = draw.choice(files)
    if file is None:
        (folder / name).unlink()
    else:
        replace_file(folder, name, file)


ALTERATIONS: tuple[Callable[[Random, Path], None], ...] = (
    *(altered_document,) * 6,
    *(no_document, altered_array, altered_array, executable_array, altered_file, altered_file),
)
"""What alters a copy of a result folder so that it must be refused."""
