"""Smooth work: the ideal mechanism against its closed form, and Andrews' squeezer.

Nothing meets, so that the order of each integrator is seen.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from presswear.engines.base import Plan, Run, Start
from presswear.engines.settings import InHouse
from presswear.linkage.linkage import Linkage
from presswear.physics.constraints import constraints_of
from presswear.physics.following import followed
from presswear.scene.numerics import Numerics
from presswear.scene.scene import Scene
from presswear.validation.precision.diagram import Diagram, Numbers, Quantity, Task, check_finite
from presswear.validation.precision.methods import Rungs, smooth_methods
from presswear.validation.verify import references

Array = NDArray[np.float64]

CYCLES = 1.25
"""Cycles of the ideal mechanism: over whole ones errors of a periodic motion cancel."""
SLIDER = (Quantity("slider position", "m", 5e-14), Quantity("slider velocity", "m/s", 1e-12))
HELD = (
    Quantity("position constraints", "m, rad", 1e-12),
    Quantity("velocity constraints", "m/s, rad/s", 1e-11),
)
"""|Phi| and |dPhi/dt|; of driven angles rad and rad/s.

Errors that are known are those that double precision leaves where times are summed over 1e5
steps.
"""


def constraint_errors(linkage: Linkage, run: Run) -> dict[str, float]:
    """Greatest |Phi| and |dPhi/dt| of the state at the end of a run."""
    constraints = constraints_of(linkage)
    phi, phi_t, _, _ = constraints.evaluate(run.time, run.end.position, run.end.velocity)
    return {own.name: float(np.abs(x).max()) for own, x in zip(HELD, (phi, phi_t), strict=True)}


def ideal_mechanism(scene: Scene, rungs: Rungs) -> Task:
    """The scene's mechanism with every joint closed."""
    linkage, period = followed(scene.mechanism.linkage()), scene.mechanism.period
    motion = scene.ideal.at(np.zeros(1))
    duration = CYCLES * period

    def assess(run: Run) -> tuple[Numbers, Numbers]:
        series = run.recorder.series
        exact = scene.ideal_slider(series("time"))
        found = np.column_stack([series("displacement"), series("velocity")])
        errors = np.abs(found - exact[:, :2]).max(axis=0).tolist()
        slider = {own.name: error for own, error in zip(SLIDER, errors, strict=True)}
        return slider | constraint_errors(linkage, run), {}

    diagram = Diagram(
        key="ideal",
        title=f"Smooth work: the ideal {scene.mechanism.kind.replace('-', ' ')}",
        task=f"{linkage.name}, every joint closed, {CYCLES:g} cycles ({duration:.4g} s): the "
        "slider's greatest error on the way, the constraints' at the end. Scenes limit steps of "
        "dae to a 500th of a cycle; here the tolerance alone chooses them. The open tree needs "
        "open joints and has no part in it.",
        quantities=(*SLIDER, *HELD),
        reference="the closed form; known is what round-off leaves of it after 1e5 steps",
    )
    start, plan = Start(motion.position[0], motion.velocity[0]), Plan(duration, 1, 1, torques=False)
    methods = smooth_methods(rungs, duration, scene.numerics, period)
    return Task(diagram, linkage, start, plan, methods, assess)


TIGHT = InHouse(integration_tolerance=1e-13)
"""The engine that the printed values of Andrews' squeezer are held against."""


def andrews_error(run: Run) -> dict[str, float]:
    """Greatest error of the angles, rad, and of their rates, rad/s, against the printed ones."""
    angles = references.andrews_angles(run.end.position) - np.array(references.ANDREWS_ANGLES)
    rates = references.andrews_angles(run.end.velocity) - np.array(references.ANDREWS_RATES)
    return {"angles": float(np.abs(angles).max()), "rates": float(np.abs(rates).max())}


def andrews(rungs: Rungs) -> Task:
    """Andrews' squeezer against the values of the IVP test set.

    RunFailed where the run fails that tells how well those are known.
    """
    linkage, start = references.andrews(), references.andrews_start()
    duration = references.ANDREWS_DURATION
    plan = Plan(duration, 1, 1, torques=False)
    known = andrews_error(check_finite(TIGHT.simulate(linkage, start, plan)))
    diagram = Diagram(
        key="andrews",
        title="Smooth work: Andrews' squeezer",
        task=f"Seven bodies, ten pins, {duration:g} s from rest (IVP test "
        "set): greatest error of the seven angles and of their rates at the end. Steps of dae "
        "are chosen by the tolerance alone.",
        quantities=(
            Quantity("angles", "rad", known["angles"]),
            Quantity("rates", "rad/s", known["rates"]),
            *(replace(own, unit=unit) for own, unit in zip(HELD, ("m", "m/s"), strict=True)),
        ),
        reference="the printed values of the IVP test set (PSIDE); their own error is their "
        f"distance from DOP853 at tolerance {TIGHT.integration_tolerance:g}",
    )

    def assess(run: Run) -> tuple[Numbers, Numbers]:
        return andrews_error(run) | constraint_errors(linkage, run), {}

    methods = smooth_methods(rungs, duration, Numerics(), None)
    return Task(diagram, linkage, start, plan, methods, assess)
