"""One impact: restitution, contact time and depth of each method.

A shaft meets its ring in the middle, with nothing else around: restitution, contact time
and deepest penetration have closed forms or a quadrature.  Both bodies slide on guides
along the line of impact, which changes nothing and makes the linkage an open tree.
"""

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import quad
from scipy.interpolate import BPoly
from scipy.optimize import brentq

from presswear.engines.base import Plan, Run, Start
from presswear.linkage.elements import Guide
from presswear.linkage.laws import delivered_restitution
from presswear.linkage.linkage import Linkage
from presswear.scene.scene import Scene
from presswear.tools.errors import RunFailed
from presswear.validation.precision.diagram import Diagram, Numbers, Quantity, Task
from presswear.validation.precision.methods import Rungs, contact_methods
from presswear.validation.runs import contacts_of
from presswear.validation.verify.references import Impact

Array = NDArray[np.float64]

NOMINAL = 0.9
"""Restitution put into Lankarani and Nikravesh's law; it delivers 0.9131766778."""
GAP = 1e-5
"""Flight before the touchdown, m."""
CONTACTS = 2.2
"""Time after the touchdown, durations of the impact without damping."""
IMPACT = Impact(NOMINAL)
_RING, _SHAFT = (body.mass for body in IMPACT.linkage.bodies)
REDUCED_MASS = _RING * _SHAFT / (_RING + _SHAFT)
"""kg."""


def contact_time(
    mass: float, speed: float, stiffness: float, exponent: float, damping: float
) -> tuple[float, float]:
    """Duration of a free impact with F = K delta^n (1 + chi delta_dot / v), and its error, s.

    With u = delta_dot / v the motion has an integral, G(u) = K delta^(n+1) / ((n+1) m v^2),
    so that the time is the integral of m v du / (K delta(u)^n (1 + chi u)) from u = -e' to 1.
    At both ends delta vanishes; a power of the distance from the end takes the singularity.

    Parameters
    ----------
    damping : float
        chi, above 0.
    """
    chi, n = damping, exponent
    restitution = delivered_restitution(chi)
    unit = (n + 1.0) * mass * speed**2 / stiffness

    def slowness(reached: float, u: float) -> float:
        depth = (unit * reached) ** (1.0 / (n + 1.0))
        return mass * speed / (stiffness * depth**n * (1.0 + chi * u))

    # delta^n goes with the distance from an end to the power n / (n + 1): over s, that
    # distance to the power 1 / (n + 1), both integrands are smooth.
    def loading(s: float) -> float:
        d = s ** (n + 1.0)
        reached = d / chi + math.log1p(-chi * d / (1.0 + chi)) / chi**2
        return slowness(reached, 1.0 - d) * (n + 1.0) * s**n

    def unloading(s: float) -> float:
        d = s ** (n + 1.0)
        reached = -d / chi + math.log1p(chi * d / (1.0 - chi * restitution)) / chi**2
        return slowness(reached, d - restitution) * (n + 1.0) * s**n

    parts = (
        quad(loading, 0.0, 1.0, epsabs=0.0, epsrel=1e-13),
        quad(unloading, 0.0, restitution ** (1.0 / (n + 1.0)), epsabs=0.0, epsrel=1e-13),
    )
    return sum(part[0] for part in parts), sum(part[1] for part in parts)


def guided() -> tuple[Linkage, Start]:
    """The impact of ``IMPACT`` on guides, and its start a little before the touchdown."""
    linkage = IMPACT.linkage
    guides = tuple(
        Guide(f"guide of {body.name}", body.name, 0.0, 0.0, 0.0) for body in linkage.bodies
    )
    start = IMPACT.start
    start.position[3] = IMPACT.clearance - GAP
    return replace(linkage, joints=guides), start


def deepest(run: Run) -> float:
    """Greatest penetration of a run, m, between the recorded rows too.

    The top of the quintic through penetration, rate and acceleration of the rows on both sides:
    a cubic's error is larger than that of the better methods.
    """
    series = run.recorder.series
    time, velocity = series("time"), series("velocity")
    depth, force = series("penetration", 0), series("normal", 0)
    # The momentum of ring and shaft is the shaft's at the start.
    rate = velocity - _SHAFT * (IMPACT.speed - velocity) / _RING
    turns = np.flatnonzero((rate[:-1] > 0.0) & (rate[1:] <= 0.0) & (force[:-1] > 0.0))
    if not turns.size:
        return float(depth.max())
    pair = slice(turns[0], turns[0] + 2)
    ends = np.column_stack([depth[pair], rate[pair], -force[pair] / REDUCED_MASS])
    return float(BPoly.from_derivatives(time[pair], ends)(turning(time[pair], ends)))


def turning(time: Array, ends: Array) -> float:
    """Time of the top of the quintic through value, slope and bend at two times, s."""
    slope = BPoly.from_derivatives(time, ends).derivative()
    low, high = float(time[0]), float(time[1])
    return low if slope(high) >= 0.0 else float(brentq(slope, low, high, xtol=1e-18))


def single(scene: Scene, rungs: Rungs) -> Task:
    """One impact for every method; numerics and the period that steps go by are the scene's."""
    linkage, start = guided()
    speed = IMPACT.speed
    law = linkage.clearances[0].normal
    lasts, doubt = contact_time(REDUCED_MASS, speed, law.stiffness, law.exponent, law.damping)
    restitution, depth = delivered_restitution(law.damping), IMPACT.deepest
    exact = {
        "delivered restitution": restitution,
        "contact time": lasts,
        "deepest penetration": depth,
    }
    kinetic = 0.5 * _SHAFT * speed**2
    duration = GAP / speed + CONTACTS * IMPACT.elastic_duration

    def assess(run: Run) -> tuple[Numbers, Numbers]:
        contacts = contacts_of(run)
        count = contacts["touchdown"].size
        if count != 1:
            raise RunFailed(f"{count} contacts began and ended, where there is one")
        # Behind the contact nothing acts: its end follows from where the pin is now.
        gap = run.end.position[3] - run.end.position[0] - IMPACT.clearance
        rate = run.end.velocity[3] - run.end.velocity[0]
        if not (gap < 0.0 and rate < 0.0):
            raise RunFailed("still in contact, or through the bearing")
        found = {
            "delivered restitution": -float(contacts["release_speed"][0]) / speed,
            "contact time": run.time - gap / rate - float(contacts["touchdown"][0]),
            "deepest penetration": deepest(run),
        }
        errors = {name: abs(found[name] - value) for name, value in exact.items()}
        errors["energy residual"] = abs(float(run.diagnostics["energy_residual_J"])) / kinetic
        values = {
            "steps in the contact": float(contacts["steps"][0]),
            "restitution": found["delivered restitution"],
            "contact time (s)": found["contact time"],
            "deepest penetration (m)": found["deepest penetration"],
        }
        return errors, values

    diagram = Diagram(
        key="impact",
        title="One impact",
        task=f"A free shaft of {_SHAFT:g} kg meets its ring of {_RING:g} kg at {speed:g} m/s, "
        f"K = {law.stiffness:.3g} N/m^1.5, nominal restitution {NOMINAL:g}, {duration:.3g} s. The "
        f"law delivers {restitution:.10g}; the contact lasts {lasts:.10g} s and is {depth:.10g} m "
        "deep. The energy residual is a part of the kinetic energy.",
        quantities=(
            Quantity("delivered restitution", "", 1e-14),
            Quantity("contact time", "s", max(doubt, 1e-14 * lasts)),
            Quantity("deepest penetration", "m", 1e-14 * depth),
            Quantity("energy residual", ""),
        ),
        reference="closed forms of restitution and penetration, a quadrature of the contact time",
    )
    plan, period = Plan(duration, 1, 1, torques=False), scene.mechanism.period
    methods = contact_methods(rungs, scene.numerics, period, duration, tree=True)
    return Task(diagram, linkage, start, plan, methods, assess)
