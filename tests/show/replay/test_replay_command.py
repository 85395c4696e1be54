"""``presswear replay``: stills, films, and windows."""
# mypy: disable-error-code="union-attr,operator,index,arg-type"

import shutil
import subprocess
import sys
import time

import lines
import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image

import presswear as pw
from presswear.__main__ import main

REPLAY = [sys.executable, "-m", "presswear", "replay"]
needs_xdotool = pytest.mark.skipif(
    shutil.which("xdotool") is None, reason="xdotool is missing"
)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    path = tmp_path_factory.mktemp("replay") / "short"
    pw.run(pw.scenes.wear_times(cycles=2, wear_updates=1, engine="dae"), path)
    return path


@pytest.fixture
def display(monkeypatch):
    """Virtual display for this process and its children."""
    if shutil.which("Xvfb") is None:
        pytest.skip("Xvfb is missing")
    monkeypatch.delenv("DISPLAY", raising=False)
    with lines.display():
        yield


def test_stills_and_a_film(folder, tmp_path, command):
    """Stills show a time with or without unit, or two stages; a film shows part of a cycle."""

    def still(options: str) -> NDArray[np.uint8]:
        file = tmp_path / "one.png"
        command(f"replay {folder} {options} --still {file} --size 480x320")
        with Image.open(file) as image:
            return np.array(image)

    first, same, later = (
        still(f"--stage 1 --at {at}") for at in ("0.3", "300ms", "0.31s")
    )
    assert first.shape == (320, 480, 3)
    assert np.array_equal(first, same)
    assert not np.array_equal(first, later)
    for compare in ("1", f"{folder}:1"):
        amber = (still(f"--stage 0 --compare {compare}") == (230, 159, 0)).all(axis=2)
        assert min(amber[:, :240].sum(), amber[:, 240:].sum()) > 100
    file = tmp_path / "film.gif"
    options = "--from 0.1 --to 0.2 --slow 10 --rate 5 --size 240x160"
    command(f"replay {folder} --movie {file} {options}")
    with Image.open(file) as film:
        assert getattr(film, "n_frames", 1) == 5


BAD_INPUT = """
--stage 2 --still x.png: has stages 0 to 1
--still x.png --at 99s: allowed is 0 to 1.1
--still x.png --at 1kg: unknown unit 'kg'
--still x.png --life: has no life
--still x.png --life --stage 1: --life
--still x.gif: must end in .png
--movie x.png: must end in .mp4 or .gif
--movie x.mp4: .mp4 needs ffmpeg; install it or write a .gif
--movie x.gif --at 0.1s: --at
--movie x.gif --still x.png: --still
--movie x.gif --from 0.2 --to 0.1: --to
--still no/x.png: no folder
--still x.png --compare nothing: no such folder
"""


def test_bad_input_is_refused_in_one_line(folder, tmp_path, monkeypatch, command):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(shutil, "which", lambda name: None)
    for case in BAD_INPUT.strip().splitlines():
        options, _, message = case.partition(": ")
        assert message in command(f"replay {folder} {options}", 2)
        assert list(tmp_path.iterdir()) == []


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="displays of Linux")
@pytest.mark.parametrize("name", ["", ":987"])
def test_without_a_display_one_line_names_alternatives(
    folder, name, monkeypatch, capfd
):
    monkeypatch.setenv("DISPLAY", name)
    monkeypatch.chdir(folder)
    assert main(["replay", "."]) == 1
    shown = capfd.readouterr().err
    assert shown.count("\n") == 1
    assert all(word in shown for word in ("no window can", "--movie", "--still"))


@needs_xdotool
def test_a_key_ends_a_window_that_plays(folder, display):
    window = subprocess.Popen([*REPLAY, str(folder)], stderr=subprocess.PIPE)
    press(window, "space", "Right", "Up", "q")
    assert window.wait(30) == 0
    assert window.stderr.read() == b""


def press(process: "subprocess.Popen[bytes]", *keys: str) -> None:
    """Wait for the window of a process and press keys in it."""
    search = ["xdotool", "search", "--name", "."]
    for _ in range(300):
        windows = subprocess.run(search, capture_output=True, check=False)
        if windows.stdout.strip() or process.poll() is not None:
            break
        time.sleep(0.1)
    assert process.poll() is None
    time.sleep(1.5)
    for key in ("mousemove 480 400", *(f"key {key}" for key in keys)):
        subprocess.run(["xdotool", *key.split()], check=True)
        time.sleep(0.3)
