"""An oiled pin in a bearing on the frame: film, elastic contact and mass in series.

The numbers are those of an independent program (DOP853) for a film without contact.
"""

import cmath
import math
from dataclasses import replace

import numpy as np
import pytest
from marks import slow
from runs import energy_residual

import presswear as pw
from presswear.engines.base import Plan, Run, Start
from presswear.engines.settings import (
    Engine,
    ExudynJoints,
    ExudynTree,
    InHouse,
)
from presswear.linkage.bodies import Body
from presswear.linkage.clearance_joint import ClearanceJoint
from presswear.linkage.friction_law import FrictionLaw
from presswear.linkage.loads import Load
from presswear.linkage.normal_law import NormalLaw, damping_ratio
from presswear.linkage.oil import Oil
from presswear.linkage.points import GROUND, Attachment
from presswear.validation.cases import finished
from presswear.validation.reference_problems import free_bodies

CLEARANCE = 5e-5
STIFFNESS = 1e14  # N/m^1.5
DUTY = Oil(viscosity=0.1, roughness=0.42e-6, asperity_pressure=50e6)
IN_HOUSE = InHouse(integration_tolerance=1e-9)


def loaded(
    load: complex,
    spin: float,
    duration: float,
    inertia: float,
    start: complex = 0.0j,
    engine: Engine = IN_HOUSE,
    oil: Oil = DUTY,
) -> Run:
    """Run a pin of 20 kg from a place in its bearing, m, under a constant load, N."""
    ends = Attachment(GROUND, 0.0, 0.0), Attachment("pin", 0.0, 0.0)
    laws = NormalLaw(STIFFNESS), FrictionLaw()
    joint = ClearanceJoint("J", *ends, 0.045, CLEARANCE, 0.08, *laws, oil=oil)
    body = Body("pin", 20.0, inertia)
    force = Load("pin", x=load.real, y=load.imag)
    linkage = free_bodies("oiled pin", (body,), (joint,), "pin", loads=(force,))
    place = np.array([start.real, start.imag, 0.0])
    state = Start(place, np.array([0.0, 0.0, spin]))
    return finished(
        engine.simulate(linkage, state, Plan(duration, 1, recorded_cycles=1))
    )


def on_film(run: Run, load: complex) -> complex:
    """Return the eccentricity ratio of the film: the pin less its elastic deformation."""
    stretch = (abs(load) / STIFFNESS) ** (2.0 / 3.0) * load / abs(load)
    return (complex(*run.end.position[:2]) - stretch) / CLEARANCE


def test_steady_rotation():
    run = loaded(-2440.0j, 6.28, 15.0, 1e12)
    place = on_film(run, -2440.0j)
    assert abs(place) == pytest.approx(0.4917858209, abs=2e-8)
    ahead = math.degrees(cmath.phase(place / -1.0j))
    assert ahead == pytest.approx(58.0543735, abs=1e-5)


@pytest.mark.parametrize(
    "engine",
    [
        IN_HOUSE,
        ExudynTree(),
        slow(ExudynJoints()),
    ],
)
def test_squeeze(engine: Engine):
    run = loaded(20e3 + 0.0j, 0.0, 67.849038761e-3, 1e12, engine=engine)
    # The pin has mass: the load reaches the film a little later.
    assert abs(on_film(run, 20e3 + 0.0j)) == pytest.approx(0.5, abs=5e-6)


def test_pin_falls_through_oil_of_hardly_any_viscosity():
    """Through air the pin meets the bearing after sqrt(2 c m / F) with K delta^1.5."""
    fall = math.sqrt(2.0 * CLEARANCE * 20.0 / 1e3)
    energy = 1e3 * CLEARANCE
    peak = STIFFNESS * (2.5 * energy / STIFFNESS) ** 0.6
    thin = [replace(DUTY, viscosity=eta, roughness=4e-9) for eta in (1e-6, 1e-7)]
    runs = [loaded(1e3 + 0.0j, 0.0, 1.1 * fall, 1e12, oil=oil) for oil in thin]
    for run in runs:
        place = run.recorder.series("eccentricity_x", 0)
        touch = run.recorder.series("time")[np.argmax(place > 0.98 * CLEARANCE)]
        assert touch == pytest.approx(fall, rel=0.01)
    peaks = [float(run.recorder.records.counters["peak_force"][0]) for run in runs]
    assert peaks[0] > 0.3 * peak
    assert peaks[0] < 0.8 * peaks[1]
    assert peaks[1] < peak


def test_a_blow_through_thin_oil_has_the_restitution():
    """A load moves the pin across the clearance c, and it rebounds by e^2 c."""
    fall = math.sqrt(2.0 * CLEARANCE * 20.0 / 1e3)
    ratio = damping_ratio(0.8)
    thin = replace(DUTY, viscosity=1e-10, roughness=4e-9, damping_ratio=ratio)
    run = loaded(1e3 + 0.0j, 0.0, 2.6 * fall, 1e12, oil=thin)
    place = run.recorder.series("eccentricity_x", 0)
    deepest = int(np.argmax(place[:256]))  # in the first contact
    back = CLEARANCE - float(place[deepest:].min())
    assert back == pytest.approx(0.8**2 * CLEARANCE, rel=0.01)
    # Without damping the film follows the asperities at once: millions of steps.
    assert run.recorder.each_cycle("steps").sum() < 1000


def test_ledger_of_a_pin_that_oil_slows():
    damped = replace(DUTY, damping_ratio=0.07)
    run = loaded(-2440.0j, 6.28, 1.0, 2.0, oil=damped)
    lost = float(run.diagnostics["contact_loss_J"])
    sheared = float(run.diagnostics["friction_loss_J"])
    assert min(sheared, lost) > 0.0
    assert energy_residual(run) < 1e-7 * (lost + sheared)


@pytest.mark.parametrize(
    ("engine", "within"), [("exudyn-tree", 1e-4), ("exudyn-joints", 1e-3)]
)
def test_engines_agree_on_an_oiled_slider_crank(engine, within):
    oil = {"film": "run", "viscosity": "0.01 Pa s", "clearance": "50 um"}
    scene = pw.scenes.slider_crank(cycles=1, replicates=1, **oil)
    stages = [
        pw.run(pw.changed(scene, {"engine": name})).stages[0]
        for name in ("dae", engine)
    ]
    gaps = [
        5e-5 - float(np.hypot(*stage.joints["B"].eccentricity.T).max())
        for stage in stages
    ]
    assert gaps[1] == pytest.approx(gaps[0], rel=within)
    for key in ("contact_loss_J", "friction_loss_J"):
        lost = [float(stage.diagnostics[key] or 0.0) for stage in stages]
        assert lost[1] == pytest.approx(lost[0], rel=2.0 * within)
