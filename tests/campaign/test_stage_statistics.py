"""Statistics of a stage from the rows of its cycles."""

from collections.abc import Callable
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from refusals import refused

import presswear as pw
from presswear.engines.base import Plan
from presswear.recording.statistics import after_startup, pooled


@pytest.mark.parametrize("engine", ["dae", "exudyn-tree"])
def test_drive_work_less_stored_energy_is_the_loss(engine):
    """The balance of energy over a run, and over the cycles that are samples."""
    settings: dict[str, Any] = {
        "engine": engine,
        "purpose": "trajectory",
        "wear_updates": 0,
    }
    scene = pw.Scene(pw.FourBar(), **settings, replicates=1, cycles=8)
    stage = pw.run(scene).stages[0]
    work, stored = map(stage.each_cycle, ("drive_work", "stored_energy_change"))
    energy = {
        name: float(value or 0.0)
        for name, value in stage.diagnostics.items()
        if name[-2:] == "_J"
    }
    assert work.sum() == pytest.approx(energy["drive_work_J"], abs=1e-12)
    assert stored.sum() == pytest.approx(energy["stored_energy_change_J"], abs=1e-12)
    # The error of the integration; its sign is not stored, because several runs would
    # cancel.
    missed = (
        (work - stored).sum() - energy["contact_loss_J"] - energy["friction_loss_J"]
    )
    assert abs(missed) == pytest.approx(abs(energy["energy_residual_J"]), abs=1e-12)
    assert abs(missed) < 1e-6 * energy["drive_exchange_J"]
    estimate = stage.statistics.drive_work_per_cycle
    assert estimate == pooled([work - stored])[0]
    # Four times narrower: the energy that goes back and forth is most of the scatter.
    narrow, wide = (np.ptp(after_startup(rows)) for rows in (work - stored, work))
    assert 4.0 * narrow < wide


def test_closed_time_of_a_cycle_is_that_of_its_contacts():
    """Contacts that lie in whole cycles, from touchdown to separation, in closed form."""
    scene = pw.Scene(
        pw.FourBar(), engine="dae", wear_updates=0, replicates=1, cycles=12
    )
    (stage,) = pw.run(scene).stages
    joint = stage.joints["B"]
    period = scene.mechanism.period
    # The last contact of the record has not ended, and is not in the list.
    edges = scene.run_up + period * np.arange(Plan.recorded_cycles)
    begin = joint.contact("touchdown")
    end = joint.contact("separation")
    for k, (low, high) in enumerate(pairwise(edges)):
        inside = np.clip(end, low, high) - np.clip(begin, low, high)
        assert joint.each_cycle("closed_time")[k] == pytest.approx(
            inside.sum(), rel=1e-9
        )
    statistics = stage.statistics.joints["B"]
    closed = joint.each_cycle("closed_time")
    assert statistics.means["closed_time"] == pooled([closed])[0]
    assert statistics.contact_time_fraction == pytest.approx(
        after_startup(closed).mean() / period
    )
    slid = joint.each_cycle("sliding_distance")
    assert statistics.means["sliding_distance"] == pooled([slid])[0]
    # Load distance over sliding distance is a mean normal force.
    force = joint.each_cycle("load_distance") / slid
    assert np.all((force > 0.0) & (force < joint.each_cycle("force_max")))
    steps = stage.each_cycle("steps")
    assert stage.statistics.means["steps"] == pooled([steps])[0]
    misspelt: dict[str, Callable[[], Any]] = {
        "quantity of a cycle 'step'": lambda: stage.each_cycle("step"),
        "quantity of a joint's cycle 'contact'": lambda: joint.each_cycle("contact"),
        "quantity of a contact 'touch'": lambda: joint.contact("touch"),
        "side of a joint 'pins'": lambda: joint.depth("pins"),
    }
    for message, call in misspelt.items():
        with refused(f"unknown {message}; did you mean"):
            call()
