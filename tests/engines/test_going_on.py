"""Every engine goes on from a snapshot as if it had never stopped, bit for bit."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pytest
from listeners import EndsAfter, Keeps
from marks import slow_in
from slotted import quick_return, sized

from presswear.campaign.replicates import RunSpec, start_of
from presswear.engines.base import Run
from presswear.recording.observer import Observer
from presswear.scene.bearing import Bearing
from presswear.scene.catalog import (
    clearance_c,
    press_hybrid,
    press_off_centre,
    slider_crank,
    wear_times,
)
from presswear.scene.scene import Scene
from presswear.scene.settings import changed
from presswear.tools.arrays import State, read_arrays, write_arrays

RECORDED = 2
FAST = {"speed": "60rad/s"}
RUBBING = {"B": Bearing(), "O": Bearing(clearance=0.0), "A": Bearing(clearance=0.0)}
OILED = {"film": "run", "viscosity": "0.01 Pa s", "clearance": "50 um"}
ON_FRAME = {"frame_mass": "2 kg", "frame_stiffness": "10 MN/m"}
SLOTTED = Scene(
    sized(quick_return(), "slot", 0.06, 0.04),
    joints="slot",
    bearings=Bearing(clearance=0.2e-3, restitution=0.3),
    wear_updates=0,
    replicates=1,
)
COARSE = {"steps_per_contact": "20", "steps_sustained": "5"}


@dataclass(frozen=True)
class Case:
    """A scene in an engine, for so many cycles."""

    scene: Scene
    cycles: int

    def run(self, resume: State | None, *observers: Observer) -> Run:
        scene = self.scene
        accuracy = self.scene.solver.for_cycle(self.scene.mechanism.period)
        plan = replace(
            RunSpec(self.cycles).plan(scene),
            recorded_cycles=RECORDED,
            sections=(0.25, 0.5),
            observers=observers,
            resume=resume,
        )
        return accuracy.simulate(scene.linkage(), start_of(scene), plan)


CASES = {
    "open tree": Case(wear_times(**FAST, engine="exudyn-tree"), 3),
    "open tree from a moving plate": Case(clearance_c(**FAST), 3),
    "open tree with a loose rod": Case(replace(slider_crank(), joints="AB"), 3),
    "in-house, order 8": Case(wear_times(**FAST, engine="dae"), 4),
    "in-house, equal steps": Case(
        wear_times(**FAST, engine="dae", integrator="rk4", equal_step="2us"),
        3,
    ),
    "bodies and joints, a crank left out": Case(
        wear_times(speed="120rad/s", engine="exudyn-joints", **COARSE),
        2,
    ),
    "bodies and joints, a plate left out": Case(
        clearance_c(speed="120rad/s", engine="exudyn-joints", **COARSE),
        2,
    ),
    "in-house, rigid joints that rub": Case(
        replace(slider_crank(), bearings=RUBBING), 3
    ),
    "bodies and joints, rigid joints that rub": Case(
        changed(
            replace(slider_crank(), bearings=RUBBING),
            {"engine": "exudyn-joints", **COARSE},
        ),
        2,
    ),
    "in-house, a slide that tilts": Case(press_off_centre(engine="dae"), 3),
    "open tree, a slide that tilts": Case(press_off_centre(engine="exudyn-tree"), 2),
    "bodies and joints, a slide that tilts": Case(
        press_off_centre(engine="exudyn-joints", **COARSE), 2
    ),
    **{
        f"a block in a moving slot, {engine}": Case(
            changed(SLOTTED, {"engine": engine, **COARSE}), 2
        )
        for engine in ("dae", "exudyn-tree", "exudyn-joints")
    },
    **{
        f"oiled pin, {engine}": Case(slider_crank(engine=engine, **OILED), 2)
        for engine in ("dae", "exudyn-tree", "exudyn-joints")
    },
    **{
        f"motor, servo and elastic frame, {engine}": Case(
            press_hybrid(engine=engine, **ON_FRAME),
            2,
        )
        for engine in ("dae", "exudyn-tree")
    },
    "bodies and joints": Case(slider_crank(engine="exudyn-joints", **COARSE), 2),
}


def told(run: Run) -> dict[str, Any]:
    """Everything of a run but wall times, ready to be compared bit for bit."""
    diagnostics = {
        key: value
        for key, value in run.diagnostics.items()
        if not key.startswith("wall_")
    }
    arrays = {
        **run.recorder.save(),
        "end position": run.end.position,
        "end velocity": run.end.velocity,
    }
    return {
        "words": (run.status, run.message, repr(run.time), repr(diagnostics)),
        **{name: (array.shape, array.tobytes()) for name, array in arrays.items()},
    }


# By default one engine goes on with each kind of state, and each engine with most.
LONG = {
    "bodies and joints, rigid joints that rub",
    "bodies and joints, a slide that tilts",
    "open tree, a slide that tilts",
    "a block in a moving slot, exudyn-joints",
    "a block in a moving slot, exudyn-tree",
    "oiled pin, exudyn-joints",
    "oiled pin, exudyn-tree",
    "motor, servo and elastic frame, exudyn-tree",
    "bodies and joints, a crank left out",
    "open tree from a moving plate",
    "bodies and joints",
}


@pytest.mark.parametrize(
    "name",
    slow_in(LONG, sorted(CASES)),
)
def test_a_run_goes_on_bit_for_bit_after_every_cycle(name, tmp_path):
    """From a file, as another process has it, or from the state that was kept in memory."""
    case = CASES[name]
    kept: list[State] = []
    stored: list[State] = []

    def keep(state: State) -> None:
        file = tmp_path / "state.npz"
        write_arrays(file, state, np.savez)
        stored.append(read_arrays(file))
        kept.append(state)

    whole = told(case.run(None, Keeps(keep)))
    assert len(kept) == case.cycles
    for in_memory, state in zip(kept, stored, strict=True):
        again = told(case.run(state))
        assert [key for key in whole if again[key] != whole[key]] == []
        for key, array in state.items():
            assert in_memory[key].tobytes() == array.tobytes(), key


def test_recorded_contacts_and_runs_that_are_enough():
    """Contacts are stored in recorded cycles only; a run that was enough is enough again."""
    case = CASES["in-house, order 8"]
    kept: list[State] = []
    observers = EndsAfter(3), Keeps(kept.append)
    runs = case.run(None, *observers), case.run(kept[-1], *observers)
    recorded = RECORDED * case.scene.mechanism.period
    for run in runs:
        assert run.status == "enough"
        assert len(run.recorder.cycles) == 3
        assert run.recorder.rows[-1, 0] <= recorded * (1.0 + 1e-12)
        for k in range(2):
            contacts = run.recorder.stored_contacts(k)
            assert 0 < len(contacts) < run.recorder.records.counters["contacts"][k]
            assert contacts[:, 1].max() <= recorded
