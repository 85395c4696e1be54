"""Random bad command lines are refused in one line, before anything runs or is written."""

from multiprocessing.process import BaseProcess
from pathlib import Path

import pytest

from endurance.bad_lines import FILE, FOLDER, NOT_UNITS_OF, bad_line
from endurance.subject import PATIENCE, SEED, Ran, Trial, answered, end, start_process
from presswear.engines.settings import ExudynJoints, ExudynTree, InHouse
from presswear.scene.catalog import slider_crank, wear_times
from presswear.scene.setting_list import settings_of


def refuse(trial: Trial, here: Path, count: int, seed: int, in_processes: int) -> None:
    """Run ``count`` bad lines in a new folder, and some of them in a new process, too."""
    (here / FILE).write_text("somebody's")
    (here / FOLDER).mkdir()
    (here / FOLDER / "precious").write_text("somebody's")
    between_processes = count // in_processes
    for number in range(count):
        line = bad_line(number, seed)
        answers = [answered(line)]
        # The operating system passes on no zero byte.
        has_zero_byte = any("\0" in word for word in line)
        if number % between_processes == 0 and not has_zero_byte:
            answers.append(end(start_process(*line), PATIENCE))
        faults = [answer.problem for answer in answers if not answer.is_refusal]
        if list(here.iterdir()) or len(list((here / FOLDER).iterdir())) != 1:
            faults.append("something was written")
        case = f"case {number} of seed {seed}: {line!r:.300}"
        trial.add(f"{case}: {faults[0]}" if faults else "")
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


def test_bad_input_is_refused_in_one_line(here):
    refuse(Trial(), here, 500, seed=1, in_processes=2)


@pytest.mark.endurance
def test_much_bad_input(trial: Trial, here, is_quick):
    count, in_processes = (300, 5) if is_quick else (5000, 24)
    refuse(trial, here, count, SEED, in_processes)


def test_lines_can_be_drawn_for_every_unit_of_a_setting():
    for scene in (wear_times(), slider_crank()):
        units = {setting.meaning.unit for setting in settings_of(scene)}
        assert units <= set(NOT_UNITS_OF)
