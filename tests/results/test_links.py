"""Links in a result, a sweep or a study do not lead what is written out of its folder."""

import shutil
from pathlib import Path

import pytest

from presswear.__main__ import main

RESULT, SWEEP = "ideal", "clearances"


@pytest.fixture(scope="module")
def stored(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with a result and a sweep."""
    folder = tmp_path_factory.mktemp("stored")
    assert main(["run", "ideal", "--engine", "dae", "--out", str(folder / RESULT)]) == 0
    short = "--set engine=dae --set cycles=1 --set wear_updates=0"
    line = f"sweep slider-crank --vary clearance=0.2mm --response B.force_max {short}"
    assert main([*line.split(), "--out", str(folder / SWEEP)]) == 0
    return folder


@pytest.mark.parametrize(
    ("kind", "link", "line"),
    [
        (RESULT, "figures", "report {folder}"),
        (RESULT, "report.html.part", "report {folder}"),
        (RESULT, "lock", "run {kind} --resume --out {folder}"),
        (SWEEP, "table.csv.part", "report {folder}"),
        (SWEEP, "rows", "sweep slider-crank --resume --out {folder}"),
        (SWEEP, "runs", "sweep slider-crank --resume --out {folder}"),
    ],
)
def test_a_link_is_refused_in_one_line(
    stored: Path,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    kind: str,
    link: str,
    line: str,
) -> None:
    folder, outside = tmp_path / "copy", tmp_path / "outside"
    shutil.copytree(stored / kind, folder)
    outside.mkdir()
    (outside / "file").write_text("nothing may be written here\n")
    if (folder / link).is_dir():
        shutil.rmtree(folder / link)
    (folder / link).symlink_to(outside / ("file" if "." in link or link == "lock" else ""))
    capsys.readouterr()
    assert main(line.format(folder=folder, kind=kind).split()) == 2
    message = capsys.readouterr().err
    assert len(message.splitlines()) == 1
    assert f"{folder / link}: this is a link" in message
    assert [path.name for path in outside.iterdir()] == ["file"]
    assert (outside / "file").read_text() == "nothing may be written here\n"


def test_a_link_in_place_of_a_file_is_replaced(stored: Path, tmp_path: Path) -> None:
    folder, outside = tmp_path / "copy", tmp_path / "outside.html"
    shutil.copytree(stored / RESULT, folder)
    outside.write_text("nothing may be written here\n")
    (folder / "report.html").unlink(missing_ok=True)
    (folder / "report.html").symlink_to(outside)
    assert main(["report", str(folder)]) == 0
    assert outside.read_text() == "nothing may be written here\n"
    assert not (folder / "report.html").is_symlink()
