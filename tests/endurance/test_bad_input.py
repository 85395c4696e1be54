"""Bad command lines, drawn at random: refused in one line, before anything runs or is written."""

from multiprocessing.process import BaseProcess
from pathlib import Path

import pytest

from endurance.bad_lines import FAMILIES, FILE, FOLDER, NOT_UNITS_OF, bad_line
from endurance.subject import PATIENCE, Ran, answered, end, start_process
from endurance.trial import SEED, Trial
from presswear.engines.settings import ExudynJoints, ExudynTree, InHouse
from presswear.scene.catalog import slider_crank, wear_times
from presswear.scene.settings import settings_of


def refuse(trial: Trial, here: Path, count: int, seed: int, in_processes: int) -> None:
    """Give so many bad lines in a new folder, some of them to processes of their own as well."""
    trial.title = "bad command lines refused with one line and exit code 2"
    trial.note = f"{len(FAMILIES)} kinds, {in_processes} in processes of their own"
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
        trial.add(f"case {place} of seed {seed}: {line!r:.300}: {wrong[0]}" if wrong else "")


@pytest.fixture
def nothing_runs(monkeypatch: pytest.MonkeyPatch) -> None:

    def stop(*arguments: object, **options: object) -> None:
        raise Ran

    for engine in (ExudynTree, ExudynJoints, InHouse):
        monkeypatch.setattr(engine, "simulate", stop)
    monkeypatch.setattr(BaseProcess, "start", stop)


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    folder = tmp_path / "here"
    folder.mkdir()
    monkeypatch.chdir(folder)
    return folder


@pytest.mark.usefixtures("nothing_runs")
def test_bad_input_is_refused_in_one_line(here: Path) -> None:
    trial = Trial()
    refuse(trial, here, 500, seed=1, in_processes=2)
    assert trial.passed, trial.first_miss


@pytest.mark.endurance
@pytest.mark.usefixtures("nothing_runs")
def test_much_bad_input(trial: Trial, here: Path, is_quick: bool) -> None:
    count, in_processes = (300, 5) if is_quick else (5000, 24)
    refuse(trial, here, count, SEED, in_processes)
    assert trial.passed, trial.first_miss


def test_lines_can_be_drawn_for_every_unit_of_a_setting() -> None:
    for scene in (wear_times(), slider_crank()):
        units = {setting.meaning.unit for setting in settings_of(scene)}
        assert units <= set(NOT_UNITS_OF)
