"""Stored results that are damaged, of another version or made to deceive are refused by name."""

import json
from pathlib import Path
from typing import Any

import pytest

from presswear.campaign.campaign import run
from presswear.results.folder import FILE, SCHEMA, provenance, read_stored
from presswear.results.result import load
from presswear.scene.catalog import wear_times
from presswear.tools.errors import InputError


@pytest.fixture(scope="module")
def document(tmp_path_factory: pytest.TempPathFactory) -> str:
    """Document of a run of two stages, as if it had failed and left a checkpoint."""
    # On a foundation contacts make no energy, which would end the run.
    scene = wear_times(speed=60.0, conventions="refined", engine="dae", cycles=5, wear_updates=1)
    path = tmp_path_factory.mktemp("result") / "run"
    run(scene, path)
    document = json.loads((path / FILE).read_text())
    finding = {"kind": "wear", "what": "a", "time_s": 1.0, "joint": "", "remedy": ""}
    document["stages"][1]["finding"] = finding
    checkpoint = {"file": "checkpoint-2.npz", "digest": 64 * "0", "words": "stage 1", "index": 1}
    document["checkpoint"] = checkpoint
    document["provenance"]["resumed"] = [{"started": "now", "machine": "this"}]
    return json.dumps(document)


def test_a_document_is_read_and_written_unchanged(document: str, tmp_path: Path) -> None:
    (tmp_path / FILE).write_text(document)
    read_stored(tmp_path).write(tmp_path)
    assert json.loads((tmp_path / FILE).read_text()) == json.loads(document)


@pytest.mark.parametrize(
    ("place", "value", "says"),
    [
        ("stages 0 statistics cycles", "five", "statistics.cycles: Expected `int`, got `str`"),
        ("stages 0 statistics joints A peak_force", True, "joints.*Expected `float`, got `bool`"),
        ("stages 0 wear_steps 0 factor", None, "wear_steps.*factor: Expected `float`"),
        ("stages 1 finding kind", 3, "finding.kind: Expected `str`"),
        ("stages 1", {}, r"stages\[1\]: Object missing required field `index`"),
        ("stages 1 index", 2, r"the stages \[0, 2\] and 'files' differ: film-1\.npz, film-2\.npz"),
        ("files ../x", "", r"'files' differ: \.\./x"),
        ("files", {}, r"'files' differ: film-0\.npz"),
        ("checkpoint file", "../x", r"checkpoint.file: Invalid enum value '\.\./x'"),
        ("status", "fine", "status: Invalid enum value 'fine'"),
        ("provenance packages", [], "provenance.packages: Expected `object`, got `array`"),
        ("scene", 3, "scene: Expected `object`, got `int`"),
        ("schema", 9, f"has schema 9; this version reads {SCHEMA}"),
    ],
)
def test_a_wrong_part_is_named(
    document: str, tmp_path: Path, place: str, value: object, says: str
) -> None:
    changed = json.loads(document)
    owner: Any = changed
    *keys, last = place.split()
    for key in keys:
        owner = owner[int(key) if isinstance(owner, list) else key]
    owner[int(last) if isinstance(owner, list) else last] = value
    (tmp_path / FILE).write_text(json.dumps(changed))
    with pytest.raises(InputError, match=f"{FILE}.*{says}"):
        read_stored(tmp_path)


NO_SCENE = json.dumps({"schema": SCHEMA, "scene": {"press": {}}, "provenance": provenance()})


@pytest.mark.parametrize(
    "text", ["", "[]", '{"schema": 99}', f'{{"schema": {SCHEMA}}}', "\x00\xff", NO_SCENE]
)
def test_a_folder_that_holds_no_result_is_refused(tmp_path: Path, text: str) -> None:
    (tmp_path / FILE).write_text(text, encoding="latin-1")
    with pytest.raises(InputError, match=FILE):
        load(tmp_path)
