"""Bad command lines, drawn at random: refused in one line, before anything runs or is written."""

from multiprocessing.process import BaseProcess
from pathlib import Path

import pytest

from endurance.bad_lines import FILE, FOLDER, NOT_UNITS_OF, bad_line
from endurance.subject import PATIENCE, SEED, Ran, Trial, answered, end, start_process
from presswear.engines.settings import ExudynJoints, ExudynTree, InHouse
from presswear.scene.catalog import slider_crank, wear_times
from presswear.scene.setting_list import settings_of


def refuse(trial: Trial, here: Path, count: int, seed: int, in_processes: int) -> None:
    """Give so many bad lines in a new folder, some of them to processes of their own as well."""
    (here / FILE).write_text("somebody's")
    (here / FOLDER).mkdir()
    (here / FOLDER / "precious").write_text("somebody's")
    every = count // in_processes
    for place in range(count):
        line = bad_line(place, seed)
        answers = [answered(line)]
        # The operating system passes no zero byte on.
        if place % every == 0 and not any("\0" in word for word in line):
            answers.append(end(start_process(*line), PATIENCE))
        wrong = [answer.problem for answer in answers if not answer.is_refusal]
        if list(here.iterdir()) or len(list((here / FOLDER).iterdir())) != 1:
            wrong.append("something was written")
        trial.add(
            f"case {place} of seed {seed}: {line!r:.300}: {wrong[0]}" if wrong else ""
        )
    trial.check()


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return a new working folder in which nothing runs."""

    def stop(*arguments: object, **options: object) -> None:
        raise Ran

    for engine in (ExudynTree, ExudynJoints, InHouse):
        monkeypatch.setattr(engine, "simulate", stop)
    monkeypatch.setattr(BaseProcess, "start", stop)
    folder = tmp_path / "here"
    folder.mkdir()
    monkeypatch.chdir(folder)
    return folder


def test_bad_input_is_refused_in_one_line(here: Path) -> None:
    refuse(Trial(), here, 500, seed=1, in_processes=2)


@pytest.mark.endurance
def test_much_bad_input(trial: Trial, here: Path, is_quick: bool) -> None:
    count, in_processes = (300, 5) if is_quick else (5000, 24)
    refuse(trial, here, count, SEED, in_processes)


def test_lines_can_be_drawn_for_every_unit_of_a_setting() -> None:
    for scene in (wear_times(), slider_crank()):
        units = {setting.meaning.unit for setting in settings_of(scene)}
        assert units <= set(NOT_UNITS_OF)
