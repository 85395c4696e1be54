"""Trials of stored results: a file that is damaged, of another version or made to deceive.

Each is refused in one line by every command that reads it, and nothing in it is executed.
"""

import json
import os
import pickle
import random
import shutil
import struct
import warnings
import zipfile
from collections.abc import Callable, Iterator
from dataclasses import replace
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswear.campaign.study import run_variant
from presswear.results.folder import INTERVAL
from presswear.scene.catalog import wear_times
from presswear.trials.endure.inputs import answered, elsewhere
from presswear.trials.endure.trial import Trial

Alteration = Callable[[random.Random, Path], None]
"""Alters a copy of a result folder so that it must be refused."""

BOMB = 2**31
"""Bytes that a small file promises to unpack to."""
_DEPTH = 100_000
"""Brackets inside each other, far beyond what a parser follows."""
NO_LEAVES: tuple[Any, ...] = (True, False, [], {}, 10**400, -(10**400), float("nan"), float("inf"))
"""What can stand nowhere in the place of a number or a text."""
_FILLED_IN = {
    *("statuses", "drive_torque", "starts", "extrapolation", "depth_step", "contact"),
    "finding",
}
"""Parts of a scene, and of a stage, that older results lack, and that are known without them."""
_WITHOUT_CHECKSUMS = 2
"""The last schema that had none."""
_MARK = "executed"


def _edited(folder: Path, edit: Callable[[dict[str, Any]], None]) -> None:
    file = folder / "result.json"
    document = json.loads(file.read_text())
    edit(document)
    file.write_text(json.dumps(document))


def save_arrays(file: Path, arrays: dict[str, Any]) -> None:
    """Write arrays by name, whatever they hold: as somebody else's program would."""
    np.savez_compressed(file, **arrays)


def leaves(owner: Any) -> Iterator[tuple[Any, Any]]:
    """Every place of a number, text or null: what holds it, and its key there."""
    items = owner.items() if isinstance(owner, dict) else enumerate(owner)
    for key, value in items:
        if isinstance(value, dict | list):
            yield from leaves(value)
        else:
            yield owner, key


def _stages(draw: random.Random, folder: Path) -> Path:
    return draw.choice(sorted(folder.glob("stage-*.npz")))


def no_leaf(draw: random.Random, folder: Path) -> None:
    """A number or text that is of no kind that fits."""

    def edit(document: dict[str, Any]) -> None:
        owner, key = draw.choice(list(leaves(document)))
        owner[key] = draw.choice(NO_LEAVES)

    _edited(folder, edit)


def missing_part(draw: random.Random, folder: Path) -> None:
    """A part of the document or of its scene that is not there."""

    def edit(document: dict[str, Any]) -> None:
        scene = document["scene"]
        parts = [scene, *(value for value in scene.values() if isinstance(value, dict))]
        parts.remove(scene["statuses"])
        owner = draw.choice([document, draw.choice(document["stages"]), *parts])
        free = {*_FILLED_IN, "wear_steps", "conventions" if owner is document else ""}
        del owner[draw.choice(sorted(owner.keys() - free))]

    _edited(folder, edit)


def strange_part(draw: random.Random, folder: Path) -> None:
    """A part that no version has ever known inside the scene."""

    def edit(document: dict[str, Any]) -> None:
        scene = document["scene"]
        parts = [scene, *(scene[name] for name in ("bearings", "numerics", "mechanism"))]
        draw.choice(parts)[draw.choice(("colour", "__class__", "self", "\n", ""))] = 1

    _edited(folder, edit)


def other_schema(draw: random.Random, folder: Path) -> None:
    """A version that is newer, none, or equal to one for Python but not for us."""
    values: tuple[Any, ...] = (0, -1, 99, True, False, 2.0, 1.0, "2", None, [2], {"2": 2}, 10**30)
    value = draw.choice(values)
    _edited(folder, lambda document: document.update(schema=value))


def another_stage(draw: random.Random, folder: Path) -> None:
    """A stage of another number, or one that leads out of the folder."""
    values = (-1, 7, 10**9, "0", "../stage-0", "0/../../x", 0.0, True, None, [0], "\0")

    def edit(document: dict[str, Any]) -> None:
        draw.choice(document["stages"])["index"] = draw.choice(values)
        if document["stages"][0]["index"] is True:
            document["stages"][0]["index"] = "1"

    _edited(folder, edit)


def contradiction(draw: random.Random, folder: Path) -> None:
    """Parts that do not fit each other."""
    edits: tuple[Callable[[dict[str, Any]], Any], ...] = (
        lambda document: document.update(engine="exudyn-joints"),
        lambda document: document["scene"].update(wears=0),
        lambda document: document["scene"].update(joints="A"),
        lambda document: document["scene"]["bearings"].update(angles=90),
        lambda document: document["stages"].reverse(),
        lambda document: document["stages"].append(document["stages"][0]),
        lambda document: document["scene"]["bearings"].update(clearance=0.02),
        lambda document: document["scene"]["mechanism"].update(kind="slider-crank"),
        lambda document: document["scene"]["mechanism"].update(length_3=0.05),
    )
    _edited(folder, draw.choice(edits))


def no_document(draw: random.Random, folder: Path) -> None:
    """Something that is no document: cut, twice named, too deep, no text."""
    file = folder / "result.json"
    text = file.read_bytes()
    texts = (
        b"",
        b"[]",
        b"null",
        b"\x00\xff",
        text[: draw.randrange(1, len(text) - 1)],
        text.replace(b'"schema"', b'"schema": 2, "schema"', 1),
        b'{"schema": 2, "stages": ' + b"[" * _DEPTH,
        b'{"schema": ' + b"9" * 5000 + b"}",
        b"!!python/object/apply:os.system ['touch executed']",
        "{}".encode("utf-16"),
    )
    file.write_bytes(draw.choice(texts))


def arrays_of(file: Path) -> dict[str, NDArray[Any]]:
    """The arrays of a stage, to be altered."""
    with np.load(file) as stored:
        return dict(stored)


def altered_array(draw: random.Random, folder: Path) -> None:
    """An array that is missing, misshapen or holds what no motion has."""
    file = _stages(draw, folder)
    arrays = arrays_of(file)
    always = ("time", "slider", "angle", "A_eccentricity", "C_force", "A_depth_pin", "C_sliding")
    name = draw.choice(always)
    kind = draw.randrange(6)
    values = arrays[name]
    if kind == 0:
        del arrays[name]
    elif kind == 1:
        arrays[name] = values[:-1]
    elif kind == 2:
        arrays[name] = values[np.newaxis]
    elif kind == 3:
        values[draw.randrange(len(values))] = draw.choice((np.nan, np.inf, -np.inf))
    elif kind == 4:
        arrays["time"] = arrays["time"][::-1]
    else:
        arrays["A_wear_bearing"] = arrays["A_wear_bearing"] - 1.0
    save_arrays(file, arrays)


class _Payload:
    """What a pickle would execute."""

    def __reduce__(self) -> tuple[Any, ...]:
        return os.mkdir, (_MARK,)


def executable_array(draw: random.Random, folder: Path) -> None:
    """An array that is code, for whoever would run it."""
    file = _stages(draw, folder)
    arrays = arrays_of(file)
    arrays[draw.choice(("time", "extra"))] = np.array([_Payload()], dtype=object)
    save_arrays(file, arrays)
    if draw.random() < 0.3:
        file.write_bytes(pickle.dumps(_Payload()))


def other_kind(draw: random.Random, folder: Path) -> None:
    """An array of texts, complex numbers, times or records."""
    file = _stages(draw, folder)
    arrays = arrays_of(file)
    kinds: tuple[Any, ...] = ("U8", "S8", "complex128", "datetime64[s]", "bool", [("a", "f8")])
    arrays["time"] = np.zeros(arrays["time"].size, draw.choice(kinds))
    save_arrays(file, arrays)


def _npy(header: str, body: bytes) -> bytes:
    """A file in numpy's format with any header."""
    text = header.encode()
    return b"\x93NUMPY\x01\x00" + struct.pack("<H", len(text)) + text + body


def false_header(draw: random.Random, folder: Path) -> None:
    """An array whose header promises more than there is, or is no header."""
    file = _stages(draw, folder)
    shapes = ("(10000000000000,)", "(-1, -1)", "(2**62,)", "(1e3,)", "('a',)", "(", "(" * 200, "()")
    shape = draw.choice(shapes)
    header = f"{{'descr': '<f8', 'fortran_order': False, 'shape': {shape}, }}\n"
    headers = (header, "__import__('os').mkdir('executed')\n", "x" * 60_000, "")
    with zipfile.ZipFile(file, "a") as archive:
        archive.writestr("extra.npy", _npy(draw.choice((header, *headers)), b"\0" * 16))


def no_archive(draw: random.Random, folder: Path) -> None:
    """A stage's file that is missing, cut, flipped in a bit of its arrays, a bomb or none."""
    file = _stages(draw, folder)
    data = file.read_bytes()
    kind = draw.randrange(6)
    if kind == 0:
        file.unlink()
    elif kind == 1:
        file.write_bytes(data[: draw.randrange(len(data))])
    elif kind == 2:
        # Behind the first header and far before the directory at the end.
        place = draw.randrange(1000, len(data) // 2)
        flipped = bytes([data[place] ^ (1 << draw.randrange(8))])
        file.write_bytes(data[:place] + flipped + data[place + 1 :])
    elif kind == 3:
        file.write_bytes(draw.choice((b"", b"PK\x03\x04", b"\x93NUMPY", data[4:])))
    elif kind == 4:
        with (
            warnings.catch_warnings(action="ignore"),
            zipfile.ZipFile(file, "a", zipfile.ZIP_DEFLATED) as archive,
        ):
            archive.writestr("time.npy", _npy("{}", b""))
    else:
        file.write_bytes(bomb())


def bomb() -> bytes:
    """A small archive that says it unpacks to BOMB bytes."""
    buffer = BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("time.npy", b"\0" * 1000)
        archive.filelist[0].file_size = BOMB
    return buffer.getvalue()


ALTERATIONS: tuple[Alteration, ...] = (
    no_leaf,
    missing_part,
    strange_part,
    other_schema,
    another_stage,
    contradiction,
    no_document,
    altered_array,
    executable_array,
    other_kind,
    false_header,
    no_archive,
)


def sound_result(folder: Path) -> None:
    """A result to be altered: a cycle, a wear, a cycle, in the in-house solver.

    As a version without checksums wrote it: with them, every alteration is found at once.
    """
    scene = replace(wear_times(), engine="dae", cycles=1, wears=1)
    run_variant(folder, scene, INTERVAL, lambda part, word: None)

    def unseal(document: dict[str, Any]) -> None:
        for key in ("digest", "files"):
            del document[key]
        document["schema"] = _WITHOUT_CHECKSUMS

    _edited(folder, unseal)


def readers(folder: Path, table: Path) -> tuple[list[str], ...]:
    """The commands that read a result folder, ``table`` being one to compare with."""
    return (
        ["report", str(folder)],
        ["export", str(folder), "new.csv"],
        ["crosscheck", str(folder), "--against", str(table)],
    )


def altered_results(
    count: int, seed: int, progress: Callable[[float], None] = lambda part: None
) -> Trial:
    """Altered copies of a result, refused by the commands that read it, in turn."""
    survived = 0
    first = ""
    with elsewhere() as here:
        sound, copy, table = here / "sound", here / "copy", here / "table.csv"
        sound_result(sound)
        assert answered(["export", str(sound), str(table)]).code == 0
        commands = readers(copy, table)
        for place in range(count):
            draw = random.Random(f"{seed} {place}")
            alter = ALTERATIONS[place % len(ALTERATIONS)]
            shutil.rmtree(copy, ignore_errors=True)
            shutil.copytree(sound, copy)
            alter(draw, copy)
            before = sorted(path.name for path in (*copy.iterdir(), *here.iterdir()))
            found = answered(commands[place // len(ALTERATIONS) % len(commands)])
            wrong = "" if found.is_refusal else found.problem
            if sorted(path.name for path in (*copy.iterdir(), *here.iterdir())) != before:
                wrong = wrong or "something was written"
            survived += not wrong
            if wrong and not first:
                first = f"{alter.__name__}, case {place} of seed {seed}: {wrong}; "
            progress((place + 1) / count)
    return Trial(
        "altered results without checksums refused with one line and exit code 2",
        count,
        survived,
        f"{first}{len(ALTERATIONS)} kinds, read by {len(commands)} commands; nothing executed",
    )
