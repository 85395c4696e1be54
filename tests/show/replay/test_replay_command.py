"""``presswear replay`` as its user meets it."""

import os
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import lines
import numpy as np
import pytest
from PIL import Image

import presswear as pw
from presswear.__main__ import main
from presswear.show.replay.reel import reel_of
from presswear.show.replay.window import missing_display

REPLAY = [sys.executable, "-m", "presswear", "replay"]
needs_xdotool = pytest.mark.skipif(shutil.which("xdotool") is None, reason="xdotool is missing")
NO_DISPLAY = {key: value for key, value in os.environ.items() if key != "DISPLAY"}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run of two cycles and one wear."""
    path = tmp_path_factory.mktemp("replay") / "short"
    options = ["--cycles", "2", "--wear-updates", "1", "--engine", "dae", "--out", str(path)]
    assert main(["run", "wear-times", *options]) == 0
    return path


@pytest.fixture
def display(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """A display that nobody looks at, for this process and those that it starts."""
    if shutil.which("Xvfb") is None:
        pytest.skip("Xvfb is missing")
    monkeypatch.delenv("DISPLAY", raising=False)
    with lines.display():
        assert missing_display() == ""
        yield


def refused(capsys: pytest.CaptureFixture[str], *arguments: str) -> str:
    assert main(["replay", *arguments]) == 2
    said = capsys.readouterr().err
    assert said.count("\n") == 1
    return said


def test_the_title_tells_a_folder_that_is_not_named_after_its_scene(folder: Path) -> None:
    result = pw.load(folder)
    assert reel_of(result, 0).title == "short: wear-times, changed"
    assert reel_of(replace(result, path=folder / "wear-times"), 0).title == "wear-times, changed"


def test_a_still_shows_the_asked_time(folder: Path, tmp_path: Path) -> None:
    images = []
    for at in ("0.3", "300ms", "0.31s"):
        file = tmp_path / "one.png"
        options = ["--stage", "1", "--still", str(file), "--at", at, "--size", "480x320"]
        assert main(["replay", str(folder), *options]) == 0
        with Image.open(file) as image:
            images.append(np.array(image))
    assert images[0].shape == (320, 480, 3)
    assert np.array_equal(images[0], images[1])
    assert not np.array_equal(images[0], images[2])


def test_two_stages_side_by_side(folder: Path, tmp_path: Path) -> None:
    file = tmp_path / "two.png"
    for what in ("1", str(folder), f"{folder}:1"):
        given = ["--stage", "0", "--compare", what, "--still", str(file), "--size", "480x320"]
        assert main(["replay", str(folder), *given]) == 0
        with Image.open(file) as image:
            pixels = np.array(image)
        # A press on each side.
        amber = (pixels == (230, 159, 0)).all(axis=2)
        assert amber[:, :240].sum() > 100
        assert amber[:, 240:].sum() > 100


def test_a_film_of_part_of_a_cycle(folder: Path, tmp_path: Path) -> None:
    file = tmp_path / "film.gif"
    options = ["--from", "0.1", "--to", "0.2", "--slow", "10", "--rate", "5", "--size", "240x160"]
    assert main(["replay", str(folder), "--movie", str(file), *options]) == 0
    with Image.open(file) as film:
        assert getattr(film, "n_frames", 1) == 5


def test_what_cannot_be_shown_is_refused_in_one_line(
    folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    here = str(folder)
    png, gif = str(tmp_path / "x.png"), str(tmp_path / "x.gif")
    capsys.readouterr()
    assert "has stages 0 to 1" in refused(capsys, here, "--stage", "2", "--still", png)
    assert "has stages 0 to 1" in refused(capsys, here, "--stage", "-1", "--still", png)
    assert "allowed is 0 to 1.1" in refused(capsys, here, "--still", png, "--at", "99s")
    assert "unknown unit 'kg'" in refused(capsys, here, "--still", png, "--at", "1kg")
    assert "has no life" in refused(capsys, here, "--still", png, "--life")
    assert "give no --stage" in refused(capsys, here, "--still", png, "--life", "--stage", "1")
    assert "ends in .png" in refused(capsys, here, "--still", gif)
    assert "ends in .mp4 or .gif" in refused(capsys, here, "--movie", png)
    assert "--from and --to" in refused(capsys, here, "--movie", gif, "--at", "0.1s")
    assert "give one of them" in refused(capsys, here, "--movie", gif, "--still", png)
    assert "must be after" in refused(capsys, here, "--movie", gif, "--from", "0.2", "--to", "0.1")
    assert "160 to 4096" in refused(capsys, here, "--still", png, "--size", "10x10")
    assert "there is no folder" in refused(capsys, here, "--still", str(tmp_path / "no" / "x.png"))
    directory = folder.parent / "directory.png"
    directory.mkdir()
    assert "is a folder" in refused(capsys, here, "--still", str(directory))
    assert "no result folder" in refused(capsys, str(tmp_path), "--still", png)
    assert "there is no such folder" in refused(
        capsys, here, "--still", png, "--compare", str(tmp_path / "nothing")
    )
    assert list(tmp_path.iterdir()) == []


def test_a_run_without_a_film_is_refused_by_name(
    folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    copy = tmp_path / "old"
    shutil.copytree(folder, copy)
    (copy / "film-0.npz").unlink()
    said = refused(capsys, str(copy), "--stage", "0", "--still", str(tmp_path / "x.png"))
    assert "film-0.npz" in said


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="displays of Linux")
@pytest.mark.parametrize("name", [None, ":987"])
def test_without_a_display_a_line_names_what_works(folder: Path, name: str | None) -> None:
    environment = NO_DISPLAY if name is None else {**NO_DISPLAY, "DISPLAY": name}
    for command in ([*REPLAY, str(folder)], [*REPLAY[:3], "run", "wear-times", "--live"]):
        done = subprocess.run(
            command, env=environment, capture_output=True, text=True, timeout=60, cwd=folder
        )
        assert done.returncode == 1
        assert done.stderr.count("\n") == 1
        assert "no window can be opened here" in done.stderr
        assert "--movie" in done.stderr
        assert "--still" in done.stderr


@needs_xdotool
def test_a_window_plays_and_is_quit_by_a_key(folder: Path, display: None) -> None:
    window = subprocess.Popen([*REPLAY, str(folder)], stderr=subprocess.PIPE)
    press(window, "space", "Right", "Up", "q")
    assert window.wait(30) == 0
    assert window.stderr is not None
    assert window.stderr.read() == b""


def test_ctrl_c_closes_the_window(folder: Path, display: None) -> None:
    window = subprocess.Popen([*REPLAY, str(folder)], stderr=subprocess.DEVNULL)
    time.sleep(5.0)
    assert window.poll() is None
    window.send_signal(signal.SIGINT)
    assert window.wait(30) == 130


@needs_xdotool
def test_a_run_goes_on_when_its_window_is_closed(tmp_path: Path, display: None) -> None:
    options = ["--engine", "dae", "--cycles", "40", "--wear-updates", "0", "--live"]
    command = [*REPLAY[:3], "run", "wear-times", *options, "--out", str(tmp_path / "live")]
    run = subprocess.Popen(command, stdout=subprocess.DEVNULL)
    press(run, "q")
    assert run.wait(120) == 0
    assert (tmp_path / "live" / "result.json").exists()


def press(process: "subprocess.Popen[bytes]", *keys: str) -> None:
    """Wait for the window of a process and press keys in it."""
    for _ in range(300):
        found = subprocess.run(["xdotool", "search", "--name", "."], capture_output=True, text=True)
        if found.stdout.strip() or process.poll() is not None:
            break
        time.sleep(0.1)
    assert process.poll() is None
    time.sleep(1.5)
    for key in ("mousemove 480 400", *(f"key {key}" for key in keys)):
        subprocess.run(["xdotool", *key.split()], check=True)
        time.sleep(0.3)
