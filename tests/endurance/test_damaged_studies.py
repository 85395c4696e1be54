"""Stored studies that were damaged or made to deceive."""

import json
import random
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from endurance.forgery import NO_LEAVES, leaves
from endurance.subject import answered
from presswear.cli.studies import check_study
from presswear.results.provenance import provenance
from presswear.studies.plan import FILE, load_study, unchanged
from presswear.studies.runaway.variants import make as runaway
from presswear.tools.documents import plain
from presswear.tools.errors import InputError


@pytest.fixture(scope="module")
def document() -> dict[str, Any]:
    found = plain({**runaway(unchanged).as_dict(), "provenance": provenance()})
    assert isinstance(found, dict)
    return found


def _stored(folder: Path, document: object) -> Path:
    folder.mkdir(exist_ok=True)
    (folder / FILE).write_text(json.dumps(document))
    return folder


def test_a_study_is_read_back_as_it_was(tmp_path: Path, document: dict[str, Any]) -> None:
    study = load_study(_stored(tmp_path / "a", document))
    assert study == runaway(unchanged)
    check_study(study, tmp_path)


@pytest.mark.parametrize("seed", range(30))
def test_no_leaf_of_another_kind_is_read(
    tmp_path: Path, document: dict[str, Any], seed: int
) -> None:
    draw = random.Random(seed)
    altered = json.loads(json.dumps(document))
    owner, key = draw.choice(list(leaves(altered)))
    owner[key] = draw.choice(NO_LEAVES)
    found = answered(["report", str(_stored(tmp_path, altered))])
    assert found.is_refusal, f"{key} = {owner[key]!r}: {found.problem}"


Edit = Callable[[dict[str, Any]], object]


@pytest.mark.parametrize(
    ("edit", "says"),
    [
        (lambda d: d.update(schema=True), "schema True"),
        (lambda d: d.update(schema=5), "schema 5; this version reads 4"),
        (lambda d: d["variants"][0].update(key="../../elsewhere"), "cannot name a variant's"),
        (lambda d: d["variants"][0].update(key=d["variants"][1]["key"]), "cannot name"),
        (lambda d: d["variants"][0].update(key=""), "cannot name"),
        (lambda d: d.update(variants=[]), "cannot name"),
        (
            lambda d: d.update(name="sabotage"),
            "the study 'sabotage'; known are paper, runaway, coverage",
        ),
        (lambda d: d["variants"].pop(), "with other variants than this version's"),
    ],
)
def test_what_is_wrong_with_a_study_is_said(
    tmp_path: Path, document: dict[str, Any], edit: Edit, says: str
) -> None:
    altered = json.loads(json.dumps(document))
    edit(altered)
    folder = _stored(tmp_path / "a", altered)
    with pytest.raises(InputError, match=says):
        check_study(load_study(folder), folder)
