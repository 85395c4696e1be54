"""The study as a whole: complete, stored and read back, and what the command line makes of it."""

import csv
import json
from pathlib import Path

import pytest

from precision.short_study import SHORT
from presswear.__main__ import main
from presswear.validation.precision.store import load, store
from presswear.validation.precision.study import FULL, QUICK, Precision
from presswear.validation.precision.tables import terminal_tables

KEYS = ["ideal", "andrews", "impact", "horizon"]


def test_every_diagram_is_there_with_the_papers_setting(found: Precision) -> None:
    assert [diagram.key for diagram in found.diagrams] == KEYS
    for diagram in found.diagrams:
        assert sum(point.method.is_paper for point in diagram.points) == 1
        assert any(point.method.is_default for point in diagram.points)
        names = {quantity.name for quantity in diagram.quantities}
        for point in diagram.points:
            assert bool(point.failure) == (point.timing is None)
            assert set(point.errors) == (set() if point.failure else names)
    assert min(QUICK.repeats, FULL.repeats) >= 5
    assert found.processor
    assert found.provenance["packages"]["exudyn"]


def test_progress_rises_to_its_end(found: Precision, told: list[tuple[str, float]]) -> None:
    parts = [part for _, part in told]
    assert parts == sorted(parts)
    assert 0.0 <= parts[0] < 0.01
    assert parts[-1] == 1.0
    sections = list(dict.fromkeys(name.partition(":")[0] for name, _ in told))
    assert sections == [*KEYS, "statistics", "wear", "done"]


def test_what_is_stored_is_read_back_equal(found: Precision, tmp_path: Path) -> None:
    store(found, tmp_path / "out")
    assert load(tmp_path / "out") == found

    def refuse(word: str) -> None:
        raise AssertionError(word)

    text = (tmp_path / "out" / "precision.json").read_text()
    assert json.loads(text, parse_constant=refuse)["horizon"] == SHORT.longest
    for diagram in found.diagrams:
        with (tmp_path / "out" / f"precision-{diagram.key}.csv").open() as file:
            rows = list(csv.DictReader(file))
        assert len(rows) == len(diagram.points)
        for row, point in zip(rows, diagram.points, strict=True):
            assert row["family"] == point.method.family
            assert float(row["value"]) == point.method.value
            assert row["failure"] == point.failure
            assert row["is_paper"] == str(point.method.is_paper).lower()
            if point.timing is not None:
                assert float(row["wall median (s)"]) == point.timing.wall
                assert int(row["steps"]) == point.timing.steps
            for quantity in diagram.quantities:
                text = row[quantity.error]
                assert (float(text) if text else None) == point.errors.get(quantity.name)


def test_the_printed_tables_are_complete(found: Precision) -> None:
    for table, diagram in zip(terminal_tables(found), found.diagrams, strict=True):
        assert len(table.rows) == len(diagram.points) + len(diagram.families)
        for row in table.rows:
            assert len(row) == len(table.texts) + len(table.numbers)
    press = terminal_tables(found)[-1]
    failed = [row for row in press.rows if "do not add up" in row[0]]
    # RK4 at the paper's step, and at a fifth of it, where 2 % of the losses are missing.
    assert [row[0].split(":")[0].split() for row in failed] == [
        ["step", "0.0001", "+"],
        ["step", "2e-05"],
    ]
    assert any("order 2.0" in row[0] for row in terminal_tables(found)[0].rows)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (None, "holds no study"),
        ("{", "cannot be read"),
        ('{"schema": 7}', "has schema 7"),
        ('{"schema": 4}', "study.scene is missing"),
    ],
)
def test_a_broken_study_is_one_clear_line(tmp_path: Path, text: str | None, words: str) -> None:
    if text is not None:
        (tmp_path / "precision.json").write_text(text)
    with pytest.raises(ValueError, match=words):
        load(tmp_path)


def test_a_folder_that_holds_something_is_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "mine.txt").write_text("mine")
    assert main(["precision", "--out", str(tmp_path)]) == 2
    assert "not empty" in capsys.readouterr().err
