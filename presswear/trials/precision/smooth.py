"""Smooth work: the ideal mechanism against its closed form, and Andrews' squeezer.

Nothing touches, so that the order of each integrator is seen.
"""

import numpy as np
from numpy.typing import NDArray

from presswear.engines.base import Plan, Run, Start
from presswear.engines.settings import InHouse
from presswear.linkage.elements import Linkage
from presswear.physics.constraints import constraints_of
from presswear.scene.ideal import ideal_slider
from presswear.scene.scene import Numerics, Scene
from presswear.trials.precision.extent import Extent
from presswear.trials.precision.measure import Errors, Task, Values, check_finite
from presswear.trials.precision.methods import smooth_ladder
from presswear.trials.verify import references

Array = NDArray[np.float64]

CYCLES = 1.25
"""Of the ideal mechanism: over whole cycles errors of a periodic motion cancel."""
HELD = ("position constraints", "velocity constraints")
"""|Phi| and |dPhi/dt|: m and m/s, of driven angles rad and rad/s."""
ROUND_OFF = {
    "slider position": 5e-14,
    "slider velocity": 1e-12,
    "position constraints": 1e-12,
    "velocity constraints": 1e-11,
}
"""What double precision leaves where times are summed over 1e5 steps."""


def constraint_errors(linkage: Linkage, run: Run) -> dict[str, float]:
    """Greatest |Phi| and |dPhi/dt| of the state at the end of a run."""
    constraints = constraints_of(linkage)
    phi, phi_t, _, _ = constraints.evaluate(run.time, run.end.position, run.end.velocity)
    return {HELD[0]: float(np.abs(phi).max()), HELD[1]: float(np.abs(phi_t).max())}


def ideal_mechanism(scene: Scene, extent: Extent) -> Task:
    """The scene's mechanism with every joint closed."""
    linkage, period = scene.mechanism.linkage(), scene.mechanism.period
    motion = scene.mechanism.ideal_motion(np.zeros(1))
    duration = CYCLES * period

    def assess(run: Run) -> tuple[Errors, Values]:
        rows = run.recorder.rows
        exact = ideal_slider(scene, rows[:, 0])
        apart = np.abs(rows[:, 1:3] - exact[:, :2]).max(axis=0)
        slider = {"slider position": float(apart[0]), "slider velocity": float(apart[1])}
        return slider | constraint_errors(linkage, run), {}

    return Task(
        key="ideal",
        title=f"Smooth work: the ideal {scene.mechanism.kind.replace('-', ' ')}",
        words=f"{linkage.name}, every joint closed, {CYCLES:g} cycles ({duration:.4g} s): the "
        "slider's greatest error on the way, the constraints' at the end. Scenes limit steps of "
        "dae to a 500th of a cycle; here the tolerance alone chooses them. The open tree needs "
        "open joints and has no part in it.",
        linkage=linkage,
        start=Start(motion.position[0], motion.velocity[0]),
        plan=Plan(duration, 1, 1, torques=False),
        methods=smooth_ladder(extent.rungs, duration, scene.numerics, period),
        quantities={
            "slider position": "m",
            "slider velocity": "m/s",
            "position constraints": "m, rad",
            "velocity constraints": "m/s, rad/s",
        },
        reference="the closed form; known is what round-off leaves of it after 1e5 steps",
        reference_errors=ROUND_OFF,
        assess=assess,
    )


TIGHT = InHouse(integration_tolerance=1e-13)
"""What the printed values of Andrews' squeezer are held against."""


def andrews_error(run: Run) -> dict[str, float]:
    """Greatest error of the angles, rad, and of their rates, rad/s, against the printed ones."""
    angles = references.andrews_angles(run.end.position) - np.array(references.ANDREWS_ANGLES)
    rates = references.andrews_angles(run.end.velocity) - np.array(references.ANDREWS_RATES)
    return {"angles": float(np.abs(angles).max()), "rates": float(np.abs(rates).max())}


def andrews(extent: Extent) -> Task:
    """Andrews' squeezer against the values of the IVP test set.

    Raises
    ------
    RunFailed
        Where the run fails that tells how well those are known.
    """
    linkage, start = references.andrews(), references.andrews_start()
    plan = Plan(references.ANDREWS_DURATION, 1, 1, torques=False)
    tight = TIGHT.simulate(linkage, start, plan)
    check_finite(tight)
    numerics = Numerics()
    return Task(
        key="andrews",
        title="Smooth work: Andrews' squeezer",
        words=f"Seven bodies, ten pins, {references.ANDREWS_DURATION:g} s from rest (IVP test "
        "set): greatest error of the seven angles and of their rates at the end. Steps of dae "
        "are chosen by the tolerance alone.",
        linkage=linkage,
        start=start,
        plan=plan,
        methods=smooth_ladder(extent.rungs, references.ANDREWS_DURATION, numerics, None),
        quantities={
            "angles": "rad",
            "rates": "rad/s",
            "position constraints": "m",
            "velocity constraints": "m/s",
        },
        reference="the printed values of the IVP test set (PSIDE); their own error is their "
        f"distance from DOP853 at tolerance {TIGHT.integration_tolerance:g}",
        reference_errors=andrews_error(tight) | {name: ROUND_OFF[name] for name in HELD},
        assess=lambda run: (andrews_error(run) | constraint_errors(linkage, run), {}),
    )
