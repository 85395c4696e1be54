"""Checks of a scene with a service life: its settings fit the life and each other."""

import math
from collections.abc import Mapping, Sequence

from presswear.linkage.clearance_joint import DEEPEST_WORDS, SurfaceContact
from presswear.linkage.oil import OILED_WEAR
from presswear.linkage.wear_law import ARCHARD
from presswear.scene.bearing import Bearing
from presswear.scene.conventions import Conventions
from presswear.scene.options import NEW_OVER_CLEARANCE, Life, Limit, Service
from presswear.scene.pin_joints import deepest_joint_wear
from presswear.tools.errors import InputError
from presswear.tools.quantities import written


def check_life(
    life: Life,
    limits: Sequence[Limit],
    pins: Mapping[str, Bearing],
    deepest_walls: Mapping[str, float],
    conventions: Conventions,
    wear_updates: int,
    replicates: int | None,
) -> None:
    """Raise InputError if a life cannot be computed for the joints that wear.

    ``pins`` has the bearings of the pin joints that wear. ``deepest_walls`` has the
    greatest wear depth for which the model holds, m, by guide that wears.
    """
    if not (pins or deepest_walls):
        raise InputError("life: no joint that wears has clearance")
    if wear_updates < 1:
        raise InputError(
            "wear_updates = 0 does not fit [life]: use 1 to 20, or switch the life off"
        )
    if replicates == 1:
        raise InputError("replicates = 1 does not fit [life]: use 2 to 100")
    if conventions.wear_distribution != "arc":
        reason = "the depth of 'bin' depends on the width of the bins"
        raise InputError(
            f"wear_distribution = 'bin' does not fit [life]: use 'arc', because {reason}"
        )
    services = life.services(tuple(pins), tuple(deepest_walls))
    if life.quick == "on":
        _check_quick_life(limits, services, pins, wear_updates)
    if limits:
        _check_reach(limits, pins, deepest_walls, conventions.contact)


def _check_quick_life(
    limits: Sequence[Limit],
    services: Sequence[Service],
    pins: Mapping[str, Bearing],
    wear_updates: int,
) -> None:
    """Raise InputError if a life cannot be computed from two wear rates."""
    faults = [
        f"until: {limit.key}: allowed are depth, wear_volume and tilt"
        for limit in limits
        if limit.name not in ("depth", "wear_volume", "tilt")
    ]
    faults += [f"{service.words}: allowed is no maintenance" for service in services]
    if wear_updates > 1:
        faults.append(f"wear_updates = {wear_updates}: allowed is 1")
    faults += [
        f"running_in = {bearing.materials.running_in:g}: allowed is 1"
        for bearing in pins.values()
        if bearing.materials.running_in != 1.0
    ]
    faults += [
        f"wear_law = {bearing.wear_law}: allowed is {ARCHARD}"
        for bearing in pins.values()
        if bearing.wear_law != ARCHARD
    ]
    if faults:
        raise InputError(f"{faults[0]} with life.quick = on")


def _check_reach(
    limits: Sequence[Limit],
    pins: Mapping[str, Bearing],
    deepest_walls: Mapping[str, float],
    contact: SurfaceContact,
) -> None:
    """Raise InputError if the model does not hold up to any of the limits."""
    for limit in limits:
        if limit.value < _greatest_value(limit, pins, deepest_walls, contact):
            return
    first = limits[0]
    greatest = _greatest_value(first, pins, deepest_walls, contact)
    if first.joint in pins:
        words = _deepest_words(pins[first.joint], contact)
    else:
        words = DEEPEST_WORDS.replace("bearing radii", "half widths of the slide")
    raise InputError(
        f"until = '{first.key} > {written(first.value, 'm')}': allowed is below "
        f"{written(greatest, 'm')}, {words}"
    )


def _greatest_value(
    limit: Limit,
    pins: Mapping[str, Bearing],
    deepest_walls: Mapping[str, float],
    contact: SurfaceContact,
) -> float:
    """Return the value of a limited quantity with the deepest wear allowed; inf if unknown."""
    if limit.name not in ("depth", *NEW_OVER_CLEARANCE):
        return math.inf
    if limit.joint in deepest_walls:
        return deepest_walls[limit.joint]
    bearing = pins[limit.joint]
    deepest = deepest_joint_wear(bearing, contact)
    if limit.name == "depth":
        return deepest
    return NEW_OVER_CLEARANCE[limit.name] * (bearing.clearance + 2.0 * deepest)


def _deepest_words(bearing: Bearing, contact: SurfaceContact) -> str:
    """Return a text on the deepest wear of a joint that is allowed."""
    if bearing.has_film:
        return f"with wear of {OILED_WEAR:g} clearances; film = report allows more"
    if contact == "foundation":
        return DEEPEST_WORDS
    return "with wear as deep as the clearance; contact = 'foundation' allows more"
