"""A stored study of precision that was damaged: refused in one line."""

import json
import random
from pathlib import Path
from typing import Any

import pytest
from endurance.forgery import NO_LEAVES, leaves

from precision.made_up_precision import precision
from presswear.__main__ import main
from presswear.tools.errors import InputError
from presswear.validation.precision.diagram import Diagram
from presswear.validation.precision.growth import Parting
from presswear.validation.precision.store import FILE, load, store
from presswear.validation.timing import Timing


@pytest.fixture(scope="module")
def document(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    folder = tmp_path_factory.mktemp("precision")
    store(precision(), folder)
    found = json.loads((folder / FILE).read_text())
    assert isinstance(found, dict)
    return found


def _read(owner: Any) -> Any:
    """The document without what is written for other programs and not read back."""
    if isinstance(owner, dict):
        derived = [
            *Diagram.DERIVED,
            *Parting.DERIVED,
            *(Timing.DERIVED if "walls" in owner else ()),
        ]
        return {key: _read(value) for key, value in owner.items() if key not in derived}
    return [_read(value) for value in owner] if isinstance(owner, list) else owner


@pytest.mark.parametrize("seed", range(40))
def test_no_leaf_of_another_kind_is_read(
    tmp_path: Path,
    document: dict[str, Any],
    seed: int,
    capsys: pytest.CaptureFixture[str],
) -> None:
    draw = random.Random(seed)
    altered = json.loads(json.dumps(_read(document)))
    # A truth is no number, but in its place another one is.
    places = [(o, key) for o, key in leaves(altered) if not isinstance(o[key], bool)]
    owner, key = draw.choice(places)
    owner[key] = draw.choice(NO_LEAVES)
    assert main(["report", str(_written(tmp_path, altered))]) == 2, f"{key} = {owner[key]!r}"
    told = capsys.readouterr()
    assert told.err.startswith("presswear: ")
    assert (told.out, told.err.count("\n")) == ("", 1)


def test_parts_that_are_missing_are_refused(tmp_path: Path, document: dict[str, Any]) -> None:
    assert load(_written(tmp_path, _read(document))) == precision()
    for key in document:
        altered = {name: value for name, value in document.items() if name != key}
        with pytest.raises(InputError, match=FILE):
            load(_written(tmp_path, altered))
    for part, name in (("chaos", "points"), ("wear", "points")):
        altered = document | {part: document[part] | {name: []}}
        with pytest.raises(InputError, match="a part of the study is empty"):
            load(_written(tmp_path, altered))


def _written(folder: Path, document: object) -> Path:
    (folder / FILE).write_text(json.dumps(document))
    return folder
