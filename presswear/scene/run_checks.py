"""Checks before a run that take longer than the checks of single settings."""

from collections.abc import Sequence

import numpy as np

from presswear.engines.settings import ExudynTree
from presswear.linkage.bodies import Body
from presswear.linkage.clearance_joint import Bushing
from presswear.linkage.linkage import Linkage
from presswear.linkage.topology import branches_of
from presswear.physics.ideal import IdealMotion
from presswear.tools.errors import InputError

# Ratio of masses beyond which accelerations of the light body are round-off of the forces
MAX_MASS_RATIO = 1e6


def check_masses(bodies: Sequence[Body]) -> None:
    """Raise InputError if the masses of two bodies differ too much."""
    light = min(bodies, key=lambda body: body.mass)
    heavy = max(bodies, key=lambda body: body.mass)
    if heavy.mass > MAX_MASS_RATIO * light.mass:
        raise InputError(
            f"mass of {heavy.name} = {heavy.mass:g} kg, mass of {light.name} = "
            f"{light.mass:g} kg: allowed is a ratio of up to {MAX_MASS_RATIO:g}"
        )


def check_springs(linkage: Linkage, ideal: IdealMotion) -> None:
    """Raise InputError if a spring does not fit the linkage at the start of its ideal motion."""
    if linkage.springs:
        from presswear.physics.interactions import spring  # slow import

        spring.check_springs(linkage, ideal.at(np.zeros(1)).position[0])


def check_torque_limits(
    loaded: Linkage, ideal: IdealMotion, bushings: Sequence[Bushing]
) -> None:
    """Raise InputError if a drive without a motor needs more torque than its limit."""
    without_motor = [drive for drive in loaded.drives if drive.motor is None]
    if any(drive.torque_limit is not None for drive in without_motor):
        from presswear.physics.inverse_dynamics import check_drives  # slow import

        check_drives(loaded, ideal, bushings)


def check_settled_speed(
    loaded: Linkage, ideal: IdealMotion, bushings: Sequence[Bushing]
) -> None:
    """Raise InputError if the motor of the leader cannot turn the linkage under its loads."""
    if loaded.leader is not None:
        from presswear.physics.settled_speed import settled_rate  # slow import

        settled_rate(loaded, ideal, bushings)


def check_open_tree(linkage: Linkage, engines: Sequence[str]) -> None:
    """Raise InputError if a linkage has free loops, which exudyn-tree cannot run.

    ``engines`` are the names of all engines.
    """
    branches = branches_of(linkage)
    if isinstance(branches, str):  # the reason
        allowed = ", ".join(name for name in engines if name != ExudynTree.word)
        raise InputError(
            f"engine = {ExudynTree.word!r}: it needs a linkage without free loops, but "
            f"{branches}; allowed is one of {allowed}"
        )
