"""The watch on runs: each thing that makes numbers worthless ends a run and is named."""

import json
from collections.abc import Callable
from dataclasses import asdict, replace
from pathlib import Path

import numpy as np
import pytest

from presswear.__main__ import main
from presswear.campaign.starts import start_of
from presswear.physics.constraints import constraints_of
from presswear.physics.energy import Ledger
from presswear.record.recorder import Recorder
from presswear.record.soundness import Condition, Finding, examine
from presswear.scene.catalog import scene_named

SCENE = scene_named("wear-times")
LINKAGE = SCENE.linkage()
START = start_of(SCENE, 0)
MET = constraints_of(LINKAGE)


def recorder() -> Recorder:
    return Recorder.of(LINKAGE, START.position, 1, SCENE.mechanism.period)


def sound() -> Condition:
    """A run that stands at its start, as it should."""
    ledger = Ledger(0.5, 5.0, 0.3, 0.05, 0.15)
    return Condition(0.0, ledger, START.position.copy(), START.velocity.copy(), "finer steps", MET)


def unbalanced(**energies: float) -> Condition:
    return replace(sound(), ledger=replace(sound().ledger, **energies))


def test_a_sound_run_is_let_go_on() -> None:
    assert examine(LINKAGE, recorder(), sound()) is None


def broken(change: Callable[[Recorder, Condition], Condition]) -> Finding:
    observed = recorder()
    found = examine(LINKAGE, observed, change(observed, sound()))
    assert found is not None
    assert found.remedy
    assert found.words.count("\n") == 0
    return found


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
def test_a_state_that_is_no_number(value: float) -> None:
    def change(observed: Recorder, now: Condition) -> Condition:
        now.velocity[4] = value
        return now

    assert broken(change).kind == "state"


@pytest.mark.parametrize(("work", "ends"), [(0.5149, False), (0.5151, True), (0.4849, True)])
def test_energy_that_does_not_add_up(work: float, ends: bool) -> None:
    found = examine(LINKAGE, recorder(), unbalanced(drive_work=work))
    assert (found is not None) == ends
    if found:
        assert found.kind == "energy"
        assert "limit 0.015 J, 0.3 % of the energy exchanged" in found.words


@pytest.mark.parametrize(
    ("taken", "made", "ends"), [(0.2, 0.19, False), (0.2, 0.21, True), (0.0, 0.006, True)]
)
def test_contacts_that_make_more_energy_than_they_take(
    taken: float, made: float, ends: bool
) -> None:
    """The balance holds: the drives are driven."""
    ledger = Ledger(taken - made + 0.3, 5.0, 0.3, taken - made, 0.0, made)
    found = examine(LINKAGE, recorder(), replace(sound(), ledger=ledger))
    assert (found is not None) == ends
    if found:
        assert found.kind == "energy"
        limit = max(taken, 0.005)
        assert f"the contacts made {made:g} J, limit {limit:g} J: damping and" in found.words


def test_without_drives_energy_is_not_judged() -> None:
    assert examine(LINKAGE, recorder(), unbalanced(drive_work=9.0, drive_exchange=0.0)) is None


@pytest.mark.parametrize(("coarse", "ends"), [(10, False), (11, True)])
def test_steps_too_long_for_the_contacts(coarse: int, ends: bool) -> None:
    observed = recorder()
    tally = observed.book.tally
    tally["contacts"], tally["unresolved"] = (5, 20), (5, coarse)
    tally["fewest_steps"] = 3
    found = examine(LINKAGE, observed, sound())
    assert (found is not None) == ends
    if found:
        assert (found.kind, found.joint) == ("steps", "C")
        assert "11 of 20 had too few, the least 3" in found.words


def test_a_pin_that_sinks_in() -> None:
    def change(observed: Recorder, now: Condition) -> Condition:
        observed.book.tally["deepest"][1] = 1.01 * LINKAGE.clearances[1].pin_radius
        return now

    found = broken(change)
    assert (found.kind, found.joint) == ("penetration", "C")


def test_a_joint_that_drifts_apart() -> None:
    def change(observed: Recorder, now: Condition) -> Condition:
        now.position[3 * LINKAGE.index("slider 6") + 1] += 9e-6
        return now

    found = broken(change)
    assert (found.kind, found.joint) == ("constraints", "E")
    assert "limit 8e-06" in found.words


def test_a_finding_is_kept_as_data() -> None:
    found = Finding("steps", "too few", 0.25, "A", "shorter steps")
    assert Finding(**json.loads(json.dumps(asdict(found)))) == found
    assert found.words == "joint A: too few (t = 0.25 s); shorter steps"


CASES = {
    "state": ("0.0217", "", ["integrator=rk4-paper"]),
    "steps": ("0.571", "A", ["integrator=rk4", "equal_step=5e-5s"]),
    "penetration": (
        "0.05",
        "A",
        ["youngs_modulus=1GPa", "clearance=0.2mm", "exponent=2.5", "speed=40pi rad/s"],
    ),
    "energy": ("", "", ["integration_tolerance=1e-3", "represented_cycles=2e8"]),
    "wear": ("", "A", ["represented_cycles=1e11"]),
}


@pytest.mark.parametrize("kind", CASES)
def test_a_real_run_ends_with_time_joint_and_remedy(
    kind: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    time, joint, settings = CASES[kind]
    out = tmp_path / kind
    options = ["--engine", "dae", "--cycles", "1", "--wears", "1", "--out", str(out)]
    given = [word for setting in settings for word in ("--set", setting)]
    assert main(["run", "wear-times", *options, *given]) == 1
    said = capsys.readouterr().err
    document = json.loads((out / "result.json").read_text())
    finding = document["stages"][-1]["finding"]
    assert document["status"] == "failed"
    assert finding["kind"] == kind
    assert finding["joint"] == joint
    assert finding["remedy"]
    assert said.count("\n") == 1
    for part in (finding["what"], finding["remedy"], time):
        assert part in said
        assert part in document["message"]
    assert (out / "report.html").read_text().count("Failed") >= 1
    if len(document["stages"]) == 1 and kind != "wear":  # nothing sound to be drawn
        assert not list(out.glob("figures/*.png"))
