"""Results altered by somebody made to deceive: damaged or strange, but their checksums fit.

What is tried so are the checkers behind the checksum.
"""

import hashlib
import io
import json
import os
import pickle
import re
import struct
import warnings
import zipfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
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
_DIGEST = re.compile(rb'"digest": "[0-9a-f]{64}"')


def digest(data: bytes) -> bytes:
    """SHA-256 in hexadecimal."""
    return hashlib.sha256(data).hexdigest().encode()


def sealed(text: bytes) -> bytes:
    """The text of a document with the digest that it should have."""
    blank = _DIGEST.sub(b'"digest": "%s"' % (64 * b"0"), text)
    return _DIGEST.sub(b'"digest": "%s"' % digest(blank), blank)


@contextmanager
def document_of(folder: Path) -> Iterator[dict[str, Any]]:
    """What a result says of itself, to be altered; it is sealed then."""
    document = json.loads((folder / FILE).read_text())
    yield document
    (folder / FILE).write_bytes(sealed(json.dumps(document, indent=1).encode()))


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


def _stage(draw: Random) -> str:
    return f"stage-{draw.randrange(2)}.npz"


def no_leaf(draw: Random, folder: Path) -> None:
    """A number or text that is of no kind that fits."""
    with document_of(folder) as document:
        checksums = document["files"]
        places = [(own, key) for own, key in leaves(document) if own is not checksums]
        owner, key = draw.choice([place for place in places if place[1] != "digest"])
        owner[key] = draw.choice(NO_LEAVES)


def missing_part(draw: Random, folder: Path) -> None:
    """A part of the document or of its scene that is not there."""
    with document_of(folder) as document:
        scene = document["scene"]
        parts = [value for key, value in scene.items() if key != "statuses"]
        owners = [scene, *(part for part in parts if isinstance(part, dict))]
        owner = draw.choice([document, draw.choice(document["stages"]), *owners])
        del owner[draw.choice(sorted(owner.keys() - {"digest"}))]


def strange_part(draw: Random, folder: Path) -> None:
    """A part that no version has ever known inside the scene."""
    with document_of(folder) as document:
        scene = document["scene"]
        parts = [scene, *(scene[name] for name in ("bearings", "numerics", "mechanism"))]
        draw.choice(parts)[draw.choice(("colour", "__class__", "self", "\n", ""))] = 1


def other_schema(draw: Random, folder: Path) -> None:
    """A version that is newer, none, or equal to one for Python but not for us."""
    with document_of(folder) as document:
        own = document["schema"]
        values = (0, -1, own + 1, own - 1, True, False, float(own), 1.0, f"{own}", None, 10**30)
        document["schema"] = draw.choice((*values, [own], {f"{own}": own}))


def another_stage(draw: Random, folder: Path) -> None:
    """A stage of another number, or one that leads out of the folder."""
    values = (-1, 7, 10**9, "0", "../stage-0", "0/../../x", 0.0, 1.0, True, None, [0], "\0")
    with document_of(folder) as document:
        draw.choice(document["stages"])["index"] = draw.choice(values)


def contradiction(draw: Random, folder: Path) -> None:
    """Parts that do not fit each other."""
    with document_of(folder) as document:
        scene, stages = document["scene"], document["stages"]
        edits: tuple[Callable[[], object], ...] = (
            lambda: document.update(engine="exudyn-joints"),
            lambda: document.update(conventions={}),
            lambda: scene.update(wears=0),
            lambda: scene.update(joints="A"),
            lambda: scene["bearings"].update(angles=90),
            stages.reverse,
            lambda: stages.append(stages[0]),
            lambda: scene["bearings"].update(clearance=0.02),
            lambda: scene["mechanism"].update(kind="slider-crank"),
            lambda: scene["mechanism"].update(length_3=0.05),
        )
        draw.choice(edits)()


def no_document(draw: Random, folder: Path) -> None:
    """Something that is no document: cut, twice named, too deep, no text."""
    text = (folder / FILE).read_bytes()
    whole = (b"", b"[]", b"null", b"\x00\xff", "{}".encode("utf-16"))
    texts = (
        *whole,
        text[: draw.randrange(1, len(text) - 1)],
        text.replace(b'"schema"', b'"schema": 4, "schema"', 1),
        b'{"schema": 4, "stages": ' + b"[" * _DEPTH,
        b'{"schema": ' + b"9" * 5000 + b"}",
        b"!!python/object/apply:os.system ['touch executed']",
    )
    (folder / FILE).write_bytes(sealed(draw.choice(texts)))


def altered_array(draw: Random, folder: Path) -> None:
    """An array that is missing, misshapen or holds what no motion has."""
    always = ("time", "slider", "angle", "A_eccentricity", "C_force", "A_depth_pin", "C_sliding")
    name = draw.choice(always)
    with arrays_of(folder, _stage(draw)) as arrays:
        values = arrays.pop(name)
        broken = values.copy()
        broken[draw.randrange(len(values))] = draw.choice((np.nan, np.inf, -np.inf))
        changed: tuple[dict[str, Any], ...] = (
            {},
            {name: values[:-1]},
            {name: values[np.newaxis]},
            {name: broken},
            {name: values, "time": arrays.get("time", values)[::-1]},
            {name: values, "A_wear_bearing": arrays["A_wear_bearing"] - 1.0},
        )
        arrays.update(draw.choice(changed))


class _Payload:
    """What a pickle would execute."""

    def __reduce__(self) -> tuple[Any, ...]:
        return os.mkdir, (MARK,)


def executable_array(draw: Random, folder: Path) -> None:
    """An array that is code, for whoever would run it."""
    with arrays_of(folder, _stage(draw)) as arrays:
        arrays[draw.choice(("time", "extra"))] = np.array([_Payload()], dtype=object)


def other_kind(draw: Random, folder: Path) -> None:
    """An array of texts, complex numbers, times or records."""
    kinds: tuple[Any, ...] = ("U8", "S8", "complex128", "datetime64[s]", "bool", [("a", "f8")])
    with arrays_of(folder, _stage(draw)) as arrays:
        arrays["time"] = np.zeros(arrays["time"].size, draw.choice(kinds))


def _added(archive: bytes, name: str, data: bytes) -> bytes:
    """An archive with one more file in it."""
    buffer = io.BytesIO(archive)
    with (
        warnings.catch_warnings(action="ignore"),  # of a name that is there twice
        zipfile.ZipFile(buffer, "a", zipfile.ZIP_DEFLATED) as opened,
    ):
        opened.writestr(name, data)
    return buffer.getvalue()


def false_header(draw: Random, folder: Path) -> None:
    """An array whose header promises more than there is, or is no header."""
    shapes = ("(10000000000000,)", "(-1, -1)", "(2**62,)", "(1e3,)", "('a',)", "(", "(" * 200, "()")
    shape = draw.choice(shapes)
    header = f"{{'descr': '<f8', 'fortran_order': False, 'shape': {shape}, }}\n"
    others = (header, "__import__('os').mkdir('executed')\n", "x" * 60_000, "")
    text = draw.choice((header, *others)).encode()
    array = b"\x93NUMPY\x01\x00" + struct.pack("<H", len(text)) + text + b"\0" * 16
    name = _stage(draw)
    replace_file(folder, name, _added((folder / name).read_bytes(), "extra.npy", array))


def no_archive(draw: Random, folder: Path) -> None:
    """A stage's file that is cut, flipped in a bit of its arrays, a bomb, code or none."""
    name = _stage(draw)
    data = (folder / name).read_bytes()
    # Behind the first header and far before the directory at the end.
    place = draw.randrange(1000, len(data) // 2)
    flipped = bytes([data[place] ^ (1 << draw.randrange(8))])
    files = (
        data[: draw.randrange(len(data))],
        data[:place] + flipped + data[place + 1 :],
        draw.choice((b"", b"PK\x03\x04", b"\x93NUMPY", data[4:])),
        _added(data, "time.npy", b""),
        bomb(),
        pickle.dumps(_Payload()),
    )
    replace_file(folder, name, draw.choice(files))


def bomb() -> bytes:
    """A small archive that says it unpacks to BOMB bytes."""
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("time.npy", b"\0" * 1000)
        archive.filelist[0].file_size = BOMB
    return buffer.getvalue()


def no_file(draw: Random, folder: Path) -> None:
    """A stage's file that is missing."""
    (folder / _stage(draw)).unlink()


ALTERATIONS: tuple[Callable[[Random, Path], None], ...] = (
    *(no_leaf, missing_part, strange_part, other_schema, another_stage, contradiction),
    *(no_document, altered_array, executable_array, other_kind, false_header, no_archive, no_file),
)
"""What alters a copy of a result folder so that it must be refused."""
