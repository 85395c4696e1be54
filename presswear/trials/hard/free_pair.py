"""Two free bodies, spinning and worn, that keep their energy and their momentum."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from presswear.engines.base import Start
from presswear.engines.settings import InHouse
from presswear.linkage.elements import Attachment, Body, ClearanceJoint, Linkage
from presswear.linkage.laws import NormalLaw
from presswear.linkage.surface import Surface, bin_centres
from presswear.physics.packed import mass_of
from presswear.trials.hard.case import ran
from presswear.trials.runs import guarded
from presswear.trials.verify.references import free_bodies

Array = NDArray[np.float64]

CLEARANCE = 0.8e-3  # m
BINS = 360


def worn_pair() -> tuple[Linkage, Start]:
    """A ring and a shaft in it, worn to a half of the clearance and not alike, both spinning.

    Mass centres lie off the centres of hole and pin, so that spin and path exchange energy
    through couples, too.  The whole does not move away: its momentum is zero.
    """
    angle = bin_centres(BINS)
    joint = ClearanceJoint(
        "J",
        Attachment("ring", 0.01, -0.005),
        Attachment("shaft", -0.004, 0.006),
        bearing_radius=0.015,
        clearance=CLEARANCE,
        width=0.02,
        normal=NormalLaw(1.25e10),
        map_frame="body",
        contact="foundation",
        bearing_surface=Surface(
            4e-4 * np.exp(-(((angle - 1.5) / 0.4) ** 2)) + 1e-4 * (1.0 + np.sin(3.0 * angle))
        ),
        pin_surface=Surface(
            2e-4 * np.exp(-(((angle - 4.0) / 0.25) ** 2)) + 5e-5 * (1.0 + np.cos(5.0 * angle))
        ),
    )
    bodies = Body("ring", 0.3, 4e-4), Body("shaft", 0.1, 1e-4)
    position = np.array([-0.01, 0.005, 0.0, 0.004, -0.006, 0.0])
    velocity = np.array([-0.1, 0.05, 9.0, 0.3, -0.15, -14.0])
    return free_bodies("worn pair", bodies, (joint,), "shaft"), Start(position, velocity)


def angular_momentum(linkage: Linkage, state: Start) -> float:
    """Angular momentum of a state about the origin, kg m^2/s."""
    m = mass_of(linkage)
    q, v = state.position.reshape(-1, 3), state.velocity.reshape(-1, 3)
    p = m.reshape(-1, 3) * v
    return float(np.sum(q[:, 0] * p[:, 1] - q[:, 1] * p[:, 0] + p[:, 2]))


def spin_scale(linkage: Linkage, state: Start) -> float:
    """Sum of the sizes of the bodies' own angular momenta, kg m^2/s."""
    p = (mass_of(linkage) * state.velocity).reshape(-1, 3)
    return float(np.abs(p[:, 2]).sum())


def kinetic_energy(linkage: Linkage, state: Start) -> float:
    """Kinetic energy of a state, J."""
    return 0.5 * float(np.sum(mass_of(linkage) * state.velocity**2))


@dataclass(frozen=True)
class Kept:
    """Changes over a run, and its contacts.

    Attributes
    ----------
    contacts : int
    energy : float
        Change of kinetic and elastic energy, part of the kinetic energy at the start.
    momentum : float
        Change of angular momentum, part of ``spin_scale``.
    """

    contacts: int
    energy: float
    momentum: float


def kept(tolerance: float, duration: float) -> Kept:
    """Run the pair for a time, s, in ``dae``, and see what it keeps."""
    linkage, start = worn_pair()
    run = ran(linkage, start, InHouse(integration_tolerance=tolerance), guarded(duration))
    before = kinetic_energy(linkage, start)
    elastic = float(run.recorder.book.memory["energy"].sum())
    change = kinetic_energy(linkage, run.end) + elastic - before
    turned = angular_momentum(linkage, run.end) - angular_momentum(linkage, start)
    return Kept(
        contacts=int(run.recorder.book.tally["contacts"].sum()),
        energy=change / before,
        momentum=turned / spin_scale(linkage, start),
    )
