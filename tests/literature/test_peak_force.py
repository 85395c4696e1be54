"""Peak force of a contact between accepted steps: closed form, far shorter steps."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

import presswear as pw
from presswear.campaign.replicates import start_of
from presswear.engines.base import Plan, Run
from presswear.engines.settings import Engine
from presswear.physics.touchdown import CONTACT_COLUMNS
from presswear.recording.film import FILM_JOINT
from presswear.scene.conventions import CONVENTIONS
from presswear.validation.benchmark_problems import GAP
from presswear.validation.cases import finished
from presswear.validation.reference_problems import REDUCED_MASS, Impact

PEAK_FORCE = CONTACT_COLUMNS.index("peak_force")
STEPS = CONTACT_COLUMNS.index("steps")
DURATION = 5e-3  # of the run of an impact, s; the bodies have separated long before
DURATION_IN_PRESS = 0.0175  # s; both joints have contacts


def simulated(
    impact: Impact, engine: Engine, law: pw.linkage.NormalLaw | None = None
) -> Run:
    """Run one free impact; guides along its line make the linkage an open tree."""
    joint = impact.linkage.clearances[0]
    joint = replace(joint, normal=law or joint.normal)
    guides = []
    if not isinstance(engine, pw.engines.ExudynJoints):
        for body in impact.linkage.bodies:
            guides.append(pw.Guide(f"guide of {body.name}", body.name, 0.0, 0.0, 0.0))
    linkage = replace(impact.linkage, joints=tuple(guides), clearances=(joint,))
    start = impact.start
    start.position[3] = impact.clearance - GAP  # x of the second body
    run = finished(engine.simulate(linkage, start, Plan(DURATION, 1)))
    assert len(run.recorder.stored_contacts(0)) == 1
    return run


def peaks(run: Run) -> list[float]:
    """Peak force of the contact in each place where a run stores it, N."""
    recorder = run.recorder
    return [
        float(recorder.stored_contacts(0)[0, PEAK_FORCE]),
        float(recorder.records.counters["peak_force"][0]),
        float(recorder.film.joints[..., FILM_JOINT.index("peak")].max()),
        float(recorder.each_cycle("force_max", 0)[0]),
    ]


def closed_form(impact: Impact) -> float:
    """Greatest force K delta^n (1 + chi u) of an impact, u the rate over the closing speed, N.

    delta^(n + 1) = (n + 1) m v^2 / K times the integral of u / (1 + chi u) from u to 1.
    """
    chi = impact.damping
    n = 1.5
    scale = (n + 1.0) * REDUCED_MASS * impact.speed**2 / impact.stiffness

    def negative_force(u: float) -> float:
        if chi > 0.0:
            logarithm = math.log((1.0 + chi) / (1.0 + chi * u))
            integral = (1.0 - u) / chi - logarithm / chi**2
        else:
            integral = 0.5 * (1.0 - u * u)
        depth = (scale * integral) ** (1.0 / (n + 1.0))
        return -impact.stiffness * depth**n * (1.0 + chi * u)

    # The force is greatest at u near 0, just after the deepest place at strong damping.
    minimum = minimize_scalar(
        negative_force, bounds=(-0.2, 0.99), method="bounded", options={"xatol": 1e-9}
    )
    return -float(minimum.fun)


# Engines and the bounds of their relative errors. At these tolerances a contact gets the
# fewest steps, some 21; the trapezoidal rule is of order 2.
ENGINES: list[tuple[Engine, float]] = [
    (pw.engines.InHouse("dop853", 1e-6), 2e-5),
    (pw.engines.ExudynTree(1e-6, 1e-3), 2e-5),
    (pw.engines.ExudynJoints(60, 10, free_step=2e-5, newton=1e-10), 2.5e-4),
]


@pytest.mark.parametrize(
    ("law", "nominal"), [("lankarani-nikravesh", 1.0), ("flores", 0.5)]
)
@pytest.mark.parametrize(
    ("engine", "bound"), ENGINES, ids=lambda value: getattr(value, "word", "")
)
def test_peak_of_impact_is_exact(engine: Engine, bound, law, nominal):
    impact = Impact(nominal, law=law, speed=0.31)
    run = simulated(impact, engine)
    stored, *copies = peaks(run)
    assert stored == pytest.approx(closed_form(impact), rel=bound)
    assert copies == [stored] * 3
    assert stored >= run.recorder.series("normal", 0).max()


@pytest.mark.parametrize(
    "engine", [engine for engine, _ in ENGINES], ids=lambda engine: engine.word
)
@pytest.mark.parametrize("damping_ratio", [0.1, 2.0])
def test_a_force_that_begins_with_a_jump_has_no_other_peak(
    damping_ratio, engine: Engine
):
    """Spring and damper: with twice the critical damping the force is greatest at touchdown."""
    stiffness = 1e7
    impact = Impact(1.0, speed=0.31)
    damper = 2.0 * damping_ratio * math.sqrt(stiffness * REDUCED_MASS)

    # x = v (exp(r t) - exp(s t)) / (r - s) with the roots of m r^2 + d r + k = 0
    first, second = np.roots([REDUCED_MASS, damper, stiffness]).astype(complex)
    time = np.linspace(0.0, math.pi * math.sqrt(REDUCED_MASS / stiffness), 20001)
    squares = second**2 * np.exp(second * time) - first**2 * np.exp(first * time)
    forces = REDUCED_MASS * impact.speed * squares / (first - second)
    exact = float(forces.real.max())
    run = simulated(
        impact, engine, pw.linkage.NormalLaw(stiffness, 1.0, viscosity=damper)
    )
    stored = peaks(run)[0]
    assert run.recorder.series("normal", 0).max() <= stored
    # A force that falls from touchdown on has its peak in the first accepted state.
    assert stored == pytest.approx(exact, rel=3e-4 if damping_ratio < 1.0 else 3e-2)
    assert stored <= exact * (1.0 + 3e-4)


@pytest.mark.parametrize("conventions", [None, *CONVENTIONS])
def test_peaks_in_the_press_do_not_depend_on_the_step(conventions):
    """Round surfaces, worn ones and worn ones on a foundation, against steps of 0.2 us at most."""
    scene = pw.scenes.wear_times()
    worn = {}
    if conventions is not None:
        scene = replace(scene, conventions=CONVENTIONS[conventions])
        angle = (np.arange(90) + 0.5) * math.radians(4.0)
        bearing = pw.linkage.Surface(2e-5 * np.exp(-(((angle - 1.5) / 0.3) ** 2)))
        worn = {"A": (bearing, pw.linkage.Surface(1e-5 * (1.0 + np.cos(3.0 * angle))))}
    linkage = scene.linkage(worn)
    start = start_of(scene)
    plan = Plan(DURATION_IN_PRESS, 1)
    fine = pw.engines.InHouse("dop853", 1e-12, free_step=2e-7).simulate(
        linkage, start, plan
    )
    reference = [fine.recorder.stored_contacts(k)[:3] for k in range(2)]
    assert min(map(len, reference)) > 0
    for tolerance in (1e-12, 1e-9):
        run = pw.engines.InHouse("dop853", tolerance).simulate(linkage, start, plan)
        for k, exact in enumerate(reference):
            contacts = run.recorder.stored_contacts(k)[: len(exact)]
            assert contacts[:, STEPS].max() < 0.2 * exact[:, STEPS].max()
            np.testing.assert_allclose(
                contacts[:, PEAK_FORCE], exact[:, PEAK_FORCE], rtol=2e-5
            )
