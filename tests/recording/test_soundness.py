"""Soundness checks: whatever makes numbers worthless ends a run and is named."""
# mypy: disable-error-code="union-attr,operator,index,arg-type"

import json
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from hard_impacts import twins

from presswear.__main__ import main
from presswear.campaign.replicates import start_of
from presswear.engines.base import Plan, recorder_of
from presswear.engines.settings import ExudynJoints, ExudynTree, InHouse
from presswear.linkage.normal_law import KELVIN_VOIGT
from presswear.linkage.surface import Surface
from presswear.physics.constraints import constraints_of
from presswear.physics.ledger import (
    Ledger,
    created_energy_message,
    remedy_for_created_energy,
)
from presswear.recording import soundness
from presswear.recording.recorder import Recorder
from presswear.recording.soundness import (
    Condition,
    Finding,
    Progress,
    examine,
    with_cause,
)
from presswear.results.result import load
from presswear.scene.catalog import scene_named
from presswear.scene.settings import changed
from presswear.show.figures import drawings
from presswear.show.report import render_report

SCENE = scene_named("wear-times")
LINKAGE = SCENE.linkage()
START = start_of(SCENE, 0)


Change = Callable[[Recorder, Condition], Condition]


def energies(**values: float) -> Change:
    return lambda recorder, now: replace(now, ledger=replace(now.ledger, **values))


def counters(**values: object) -> Change:
    def change(recorder: Recorder, now: Condition) -> Condition:
        for name, value in values.items():
            recorder.records.counters[name] = value
        return now

    return change


def state(level: str, place: int, value: float) -> Change:
    def change(recorder: Recorder, now: Condition) -> Condition:
        getattr(now, level)[place] += value
        return now

    return change


def examined(change: Change) -> Finding | None:
    """Examine a sound run at its start, with a change."""
    recorder = recorder_of(LINKAGE, START, Plan(SCENE.mechanism.period, 1, 1))
    ledger = Ledger(0.5, 5.0, 0.3, 0.05, 0.15)
    position = START.position.copy()
    velocity = START.velocity.copy()
    now = Condition(
        0.0, ledger, position, velocity, "finer steps", constraints_of(LINKAGE)
    )
    return examine(LINKAGE, recorder, change(recorder, now))


def coarse(unresolved: int) -> Change:
    return counters(contacts=(5, 20), unresolved=(5, unresolved), fewest_steps=3)


DEEP = 1.01 * LINKAGE.clearances[1].pin_radius
SLIDER = 3 * LINKAGE.index("slider 6") + 1


@pytest.mark.parametrize(
    ("change", "kind", "joint", "says"),
    [
        *(
            (state("velocity", 4, value), "state", "", "")
            for value in (np.nan, np.inf, -np.inf)
        ),
        *(
            (
                energies(drive_work=work),
                "energy",
                "",
                "limit 0.002 J: the drives exchanged 5 J",
            )
            for work in (0.5021, 0.4979)
        ),
        *(
            (
                energies(
                    contact_loss=taken - created,
                    created=created,
                    friction_loss=0.0,
                    drive_work=work,
                ),
                "energy",
                "",
                f"the contacts created {created:g} J, limit {limit:g} J: damping and",
            )
            for taken, created, limit, work in (
                (0.2, 0.21, 0.2, 0.29),
                (0.0, 0.006, 0.005, 0.294),
            )
        ),
        # Where nothing is lost or all of it, the exchange decides: 1e-4 and 3e-3 of it.
        (
            energies(friction_loss=-0.05, drive_work=0.3006),
            "energy",
            "",
            "limit 0.0005 J",
        ),
        (
            energies(friction_loss=4.95, drive_work=5.3151),
            "energy",
            "",
            "limit 0.015 J",
        ),
        (coarse(11), "steps", "C", "11 of 20 had too few, the least 3"),
        (counters(deepest=(0.0, DEEP)), "penetration", "C", ""),
        (
            state("position", SLIDER, 9e-6),
            "constraints",
            "E",
            "limit 8e-06 (t = 0 s); engine = dae with projection = on prevents it",
        ),
    ],
)
def test_worthless_numbers_are_found(change, kind, joint, says):
    finding = examined(change)
    assert (finding.kind, finding.joint) == (kind, joint)
    assert finding.remedy
    assert "\n" not in finding.words
    assert says in finding.words


def test_sound_runs_continue():
    for change in (
        energies(),
        energies(drive_work=0.5019),
        energies(contact_loss=0.01, created=0.19, friction_loss=0.0, drive_work=0.31),
        # Without drives the energy is not checked.
        energies(drive_work=9.0, drive_exchange=0.0),
        coarse(10),
    ):
        assert examined(change) is None


@pytest.mark.parametrize(
    ("depth", "contact", "is_steep"),
    [(0.0, "radial", False), (1e-4, "radial", True), (1e-4, "foundation", False)],
)
def test_steep_radial_surfaces_are_named(depth, contact, is_steep):
    scene = changed(SCENE, {"contact": contact})
    notched = Surface(np.where(np.arange(360) % 30 == 0, depth, 0.0))
    linkage = scene.linkage(dict.fromkeys("AC", (notched, Surface())))
    packed = recorder_of(
        linkage, START, Plan(scene.mechanism.period, 1, 1)
    ).records.packed
    what = created_energy_message(packed, -1.5, 2.0)
    assert ("worn surfaces are too steep" in what) == is_steep
    assert "the steps are too coarse" in what
    remedy = remedy_for_created_energy(
        packed, "a smaller integration_tolerance may help"
    )
    assert ("contact = foundation" in remedy) == is_steep
    assert "a smaller integration_tolerance may help" in remedy


CASES = {
    "state": ("0.0217", "", ["integrator=rk4-paper"]),
    "steps": ("0.571", "A", ["integrator=rk4", "equal_step=5e-5s"]),
    "penetration": (
        "0.05",
        "A",
        ["youngs_modulus=1GPa", "clearance=0.2mm", "exponent=2.5", "speed=40pi rad/s"],
    ),
    "energy": ("", "", ["integration_tolerance=1e-3", "cycles_per_update=2e8"]),
    "wear": ("", "A", ["cycles_per_update=1e11"]),
}


@pytest.mark.parametrize("kind", CASES)
def test_run_ends_with_time_joint_and_remedy(kind, tmp_path, capsys):
    time, joint, settings = CASES[kind]
    out = tmp_path / kind
    options = f"--engine dae --cycles 1 --wear-updates 1 --no-report --out {out}"
    given = [word for setting in settings for word in ("--set", setting)]
    assert main(["run", "wear-times", *options.split(), *given]) == 1
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
    result = load(out)
    assert render_report(result).count("Failed") >= 1
    if len(result.stages) == 1 and kind != "wear":  # nothing sound to be drawn
        assert [drawing.file for drawing in drawings(result)] == ["mechanism.png"]


@pytest.mark.parametrize(
    ("steps", "advanced", "cycle", "is_stalled"),
    [
        (999, 0.0, 0.2, False),  # too few to be judged
        (1000, 3e-11, 0.2, True),
        (1000, 2e-9, 0.2, False),
        (1000, 2e-9, 3600.0, True),
    ],
)
def test_a_run_ends_where_time_stands_still(steps, advanced, cycle, is_stalled):
    progress = Progress(cycle)
    assert progress.judge(5000, 1.0) is None
    finding = progress.judge(5000 + steps, 1.0 + advanced)
    assert (finding is not None) == is_stalled
    if finding is not None:
        assert finding.words.startswith(
            f"the time stands still: {steps} steps advanced it by"
        )


@pytest.mark.parametrize(
    "engine", [InHouse(), ExudynTree(), ExudynJoints(50, 10, free_step=1e-6)]
)
def test_every_engine_ends_a_run_whose_time_stands_still(engine, monkeypatch):
    monkeypatch.setattr(soundness, "STALL", 1.0)  # no run advances by a second a step
    run = engine.simulate(*twins(), Plan(1.0, 1, recorded_cycles=1))
    assert run.status == "failed"
    assert run.message.startswith("the time stands still")


@pytest.mark.parametrize(
    ("damping", "expected"), [(1e8, "less viscous_damping at C"), (0.0, "x")]
)
def test_steps_that_vanish_by_viscous_damping_do_not_advise_a_tolerance(
    damping, expected
):
    """No tolerance makes the steps of a damper longer: D / m of the press is up to 4e9 1/s."""
    settings = {"normal_law": KELVIN_VOIGT, "C.viscous_damping": damping}
    linkage = changed(SCENE, settings).linkage()
    recorder = recorder_of(linkage, START, Plan(SCENE.mechanism.period, 1, 1))
    finding = Finding("state", "the step vanished", 0.0, "", "x")
    q = START.position
    v = START.velocity
    assert with_cause(finding, linkage, recorder, q, v).remedy.startswith(expected)
    at_joint = replace(finding, joint="E")  # a singular position, whatever the damping
    assert with_cause(at_joint, linkage, recorder, q, v).remedy == "x"
