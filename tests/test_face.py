"""Public interface: every name, bad values of every part, and how a run ends for a script."""

import re
import tomllib
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
from public_names import PUBLIC
from python_process import python

import presswear as pw
from presswear.recording.recorder import Recorder

QUICK = {"engine": "dae", "integrator": "dopri5", "integration_tolerance": 1e-6}


@pytest.mark.parametrize("package", [pw, pw.engines, pw.linkage, pw.results])
def test_every_public_name_exists(package: ModuleType):
    assert len(dir(package)) >= 6
    for name in dir(package):
        assert getattr(package, name) is not None
    message = f"'{package.__name__}' has no attribute 'Sceen'"
    with pytest.raises(AttributeError, match=message):
        _ = getattr(package, "Sceen")  # noqa: B009 (type checkers refuse the attribute)


def test_a_name_of_a_part_is_found_there():
    """Five parts have names that a user may look for at the root."""
    for name, place in {"InHouse": "engines", "deflection": "statics"}.items():
        message = f"it is presswear.{place}.{name}$"
        with pytest.raises(AttributeError, match=message):
            getattr(pw, name)


def test_one_version_in_package_citation_and_changelog():
    root = Path(__file__).parents[1]
    version = tomllib.loads((root / "pyproject.toml").read_text())["project"]["version"]
    assert version == pw.__version__
    assert f"\nversion: {version}\n" in (root / "CITATION.cff").read_text()
    assert f"\n## {version}\n" in (root / "CHANGELOG.md").read_text()


@pytest.mark.parametrize(
    "program", ["import presswear", "main(['list'])", "main(['run', 'no'])"]
)
def test_a_program_without_a_run_loads_neither_numba_nor_exudyn(program):
    code = (
        f"import sys; from presswear.__main__ import main; {program}; "
        "sys.exit(bool({'numba', 'exudyn', 'scipy', 'matplotlib', 'msgspec'} & set(sys.modules)))"
    )
    assert python("-c", code).returncode == 0


class Stops(pw.engines.Observer):
    """Ends each run after two cycles."""

    def on_cycle(self, recorder: Recorder, state: object) -> bool:
        return len(recorder.cycles) == 2


@pytest.mark.parametrize("replicates", [1, 2])
def test_a_tracker_can_end_a_run(replicates):
    scene = pw.scenes.wear_times(
        wear_updates=0, cycles=9, replicates=replicates, **QUICK
    )
    result = pw.run(scene, observers=[Stops()], jobs=2)
    assert (result.stages[0].statistics.cycles, result.stages[0].status) == (
        2 * replicates,
        "enough",
    )


def test_a_run_goes_on_in_its_folder_and_is_read_when_it_is_finished(
    tmp_path,
):
    scene = pw.scenes.wear_times(wear_updates=1, cycles=2, **QUICK)

    class Breaks(pw.engines.Observer):
        def on_stage(self, stage: pw.results.StageResult) -> None:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        pw.run(scene, tmp_path / "run", observers=[Breaks()])
    assert pw.load(tmp_path / "run").status == "interrupted"
    result = pw.run(scene, tmp_path / "run")
    assert (result.status, len(result.stages)) == ("completed", 2)
    again = pw.run(scene, tmp_path / "run", observers=[Breaks()])
    assert str(again) == str(result)
    first, *joints, motion, _ = str(result.stages[1]).splitlines()
    assert first == "first wear: completed, 8 cycles"
    assert motion.startswith("motion: 2 strokes are too few")
    assert [line[:19] for line in joints] == [
        "A: mean peak force ",
        "C: mean peak force ",
    ]
    with pytest.raises(
        pw.InputError, match="another scene: cycles is 2 there and 3 here"
    ):
        pw.run(
            pw.scenes.wear_times(wear_updates=1, cycles=3, **QUICK), tmp_path / "run"
        )


def test_a_run_that_failed_raises_with_its_finding(tmp_path):
    scene = pw.scenes.wear_times(wear_updates=0, cycles=1)
    paper = pw.engines.InHouse(integrator="rk4-paper")
    with pytest.raises(pw.RunFailed, match="no longer finite") as failed:
        pw.run(scene, tmp_path / "run", engine=paper)
    assert failed.value.finding.kind == "state"
    assert failed.value.finding.time_s > 0.0
    with pytest.raises(pw.RunFailed):
        pw.run(scene, tmp_path / "run", engine=paper)
    result = pw.run(scene, tmp_path / "run", engine=paper, check=False)
    assert result.status == "failed"
    assert result.stages[0].failed
    assert "failed" in str(result)


@pytest.mark.parametrize(
    ("name", "argument", "answer"),
    [
        ("Bearing", "clearence", "; did you mean clearance?"),
        ("SliderCrank", "slidermass", "; did you mean slider_mass?"),
        ("assemble", "body", "; did you mean bodies?"),
        ("run", "job", "; did you mean jobs?"),
        # Symbols of the paper
        ("Bearing", "c_f", ": c_f is friction"),
        ("Bearing", "K_d", ": K_d is wear_coefficient of materials"),
        ("Bearing", "bins", ": bins is angles"),
        ("Guide", "c_f", "; known are"),
    ],
)
def test_a_wrong_argument_is_answered_with_the_right_one(name, argument, answer):
    message = re.escape(f"unknown argument of {name} '{argument}'{answer}")
    with pytest.raises(pw.InputError, match=message):
        PUBLIC[name](**{argument: 1})


def test_a_linkage_that_cannot_move_is_refused_before_the_run():
    slider = pw.assemble(
        bodies=[
            pw.Bar("crank", "50 mm", 1.0),
            pw.Bar("rod", "120 mm", 1.0),
            pw.Body("slider", 5.0, 1e-3),
        ],
        joints=[
            pw.Pin("O", (0.0, 0.0), "crank.tail"),
            pw.Pin("A", "crank.head", "rod.tail"),
            pw.Pin("B", "rod.head", "slider"),
        ],
        drives=[pw.Drive("crank", speed=60.0)],
    )
    scene = pw.Scene(slider, bearings={"B": pw.Bearing()}, cycles=1)
    message = (
        "hold 7; body slider can move freely, only one joint holds it; add joints, guides or "
        "drives that hold 2 more$"
    )
    with pytest.raises(pw.InputError, match=message) as refused:
        pw.run(scene)
    # An error from a worker process would have a cause, a second traceback.
    assert refused.value.__cause__ is None


def test_settings_of_an_engine_are_checked_like_any_other():
    with pytest.raises(
        pw.InputError, match=r"tree_tolerance = -1: allowed is 1e-13 to 0\.001"
    ):
        pw.run(
            pw.scenes.wear_times(), engine=pw.engines.ExudynTree(tree_tolerance=-1.0)
        )


def test_what_does_not_exist_is_answered_with_what_exists():
    with pytest.raises(
        AttributeError, match=r"unknown scene 'wear_time'; did you mean wear_times\?"
    ):
        pw.scenes.wear_time()
    with pytest.raises(
        AttributeError, match="unknown scene 'cup'; known are ideal, wear_times, "
    ):
        pw.scenes.cup()
    result = pw.run(pw.Scene(pw.FourBar(), wear_updates=0, cycles=1, engine="dae"))
    (stage,) = result.stages
    assert result.stages[-1] == stage
    assert isinstance(stage.joints["B"], pw.results.JointResult)
    joints: Any
    for joints in (stage.joints, stage.statistics.joints):
        with pytest.raises(
            pw.InputError, match="unknown joint with clearance 'X'; known are B"
        ):
            joints["X"]
    with pytest.raises(IndexError, match="there is no stage 1; it has 0"):
        result.stages[1]
