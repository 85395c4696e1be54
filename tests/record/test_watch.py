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


def sound() -> Condition:
    """A run that stands at its start, as it should."""
    ledger = Ledger(0.5, 5.0, 0.3, 0.05, 0.15)
    return Condition(0.0, ledger, START.position.copy(), START.velocity.copy(), "finer steps", MET)


Change = Callable[[Recorder, Condition], Condition]


def energies(**changed: float) -> Change:
    return lambda observed, now: replace(now, ledger=replace(now.ledger, **changed))


def tallied(**changed: object) -> Change:
    def change(observed: Recorder, now: Condition) -> Condition:
        for name, values in changed.items():
            observed.book.tally[name] = values
        return now

    return change


def state(level: str, place: int, value: float) -> Change:
    def change(observed: Recorder, now: Condition) -> Condition:
        getattr(now, level)[place] += value
        return now

    return change


def examined(change: Change) -> Finding | None:
    observed = Recorder.of(LINKAGE, START.position, 1, SCENE.mechanism.period)
    return examine(LINKAGE, observed, change(observed, sound()))


def coarse(unresolved: int) -> Change:
    return tallied(contacts=(5, 20), unresolved=(5, unresolved), fewest_steps=3)


DEEP = 1.01 * LINKAGE.clearances[1].pin_radius
SLIDER = 3 * LINKAGE.index("slider 6") + 1


@pytest.mark.parametrize(
    ("change", "kind", "joint", "says"),
    [
        *((state("velocity", 4, value), "state", "", "") for value in (np.nan, np.inf, -np.inf)),
        *(
            (energies(drive_work=work), "energy", "", "limit 0.015 J, 0.3 % of the energy")
            for work in (0.5151, 0.4849)
        ),
        *(
            (
                energies(contact_loss=taken - made, made=made, friction_loss=0.0, drive_work=work),
                *("energy", "", f"the contacts made {made:g} J, limit {limit:g} J: damping and"),
            )
            for taken, made, limit, work in ((0.2, 0.21, 0.2, 0.29), (0.0, 0.006, 0.005, 0.294))
        ),
        (coarse(11), "steps", "C", "11 of 20 had too few, the least 3"),
        (tallied(deepest=(0.0, DEEP)), "penetration", "C", ""),
        (state("position", SLIDER, 9e-6), "constraints", "E", "limit 8e-06"),
    ],
)
def test_what_makes_numbers_worthless_is_found(
    change: Change, kind: str, joint: str, says: str
) -> None:
    found = examined(change)
    assert found is not None
    assert (found.kind, found.joint) == (kind, joint)
    assert found.remedy
    assert "\n" not in found.words
    assert says in found.words


@pytest.mark.parametrize(
    "change",
    [
        energies(),
        energies(drive_work=0.5149),
        energies(contact_loss=0.01, made=0.19, friction_loss=0.0, drive_work=0.31),
        # Without drives energy is not judged.
        energies(drive_work=9.0, drive_exchange=0.0),
        coarse(10),
    ],
)
def test_a_sound_run_is_let_go_on(change: Change) -> None:
    assert examined(change) is None


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
        assert [path.name for path in out.glob("figures/*.png")] == ["mechanism.png"]
