"""Where results may go."""

from pathlib import Path

import pytest

from presswear.tools.errors import InputError
from presswear.tools.folders import check_name, check_new_folder


def test_a_new_and_an_empty_folder_are_fine_and_left_alone(tmp_path: Path) -> None:
    (tmp_path / "empty").mkdir()
    for name in ("empty", "new", "a/b/c", "ü µ"):
        check_new_folder(tmp_path / name)
    assert [path.name for path in tmp_path.iterdir()] == ["empty"]
    assert not any((tmp_path / "empty").iterdir())


@pytest.mark.parametrize(
    ("name", "says"),
    [
        ("full", "not empty"),
        ("file", "not empty"),
        ("file/below", "is no folder"),
        ("dangling", "leads nowhere"),
        ("a\0b", "printable"),
        ("a\nb", "printable"),
        ("\udcff", "printable"),
        ("n" * 256, "255 bytes"),
        ("ü" * 128, "255 bytes"),
        ("/proc/none/x", "nothing can be written there"),
    ],
)
def test_what_cannot_be_a_result_folder_is_refused(tmp_path: Path, name: str, says: str) -> None:
    (tmp_path / "file").write_text("somebody's")
    (tmp_path / "full").mkdir()
    (tmp_path / "full" / "file").write_text("somebody's")
    (tmp_path / "dangling").symlink_to(tmp_path / "nowhere")
    before = sorted(tmp_path.rglob("*"))
    with pytest.raises(InputError, match=says):
        check_new_folder(tmp_path / name)
    assert sorted(tmp_path.rglob("*")) == before


def test_a_path_may_be_long_its_names_may_not() -> None:
    check_name(Path("/".join(["n" * 255] * 20)))
    with pytest.raises(InputError, match="255 bytes"):
        check_name(Path("a/" + "n" * 256 + "/b"))
