"""Contacts whose penetration is too deep for a contact law of small contacts."""

import math
from collections.abc import Callable, Mapping, Sequence
from typing import get_args

from presswear.linkage.normal_law import Elasticity, NormalLaw
from presswear.physics.friction_and_normal import elastic_of, normal_record
from presswear.results.rigid_joints import ideal_forces
from presswear.results.stage import StageResult
from presswear.scene.pin_joints import elastic_law, normal_stiffness
from presswear.scene.scene import Scene
from presswear.tools.compile import Records
from presswear.tools.numbers import quantity_text, readable
from presswear.tools.user_function import UserFunction

# Largest penetration of a small contact over the clearance. At this penetration K delta^1.5
# is 6 % above the force of the foundation, and the arc of contact is 49 degrees.
SMALL_CONTACT = 0.1
# Ratio of a peak force to that of rigid joints up to which the load prescribes the peak:
# runs with the three elastic laws then have peaks within 4 %.
PRESCRIBED = 1.1
LAW_WORDS = {
    "power": "K delta^1.5",
    "liu": "Liu's law",
    "foundation": "an elastic foundation",
}


def penetrations(scene: Scene, stages: Sequence[StageResult]) -> dict[str, float]:
    """Return the largest recorded penetration of each joint over its clearance."""
    ratios = {}
    for name in scene.loose_pins:
        deepest = 0.0
        for stage in stages:
            penetration = stage.arrays.get(f"{name}_penetration")
            if penetration is not None and not stage.failed:
                deepest = max(deepest, float(penetration.max(initial=0.0)))
        ratios[name] = deepest / scene.bearing(name).clearance
    return ratios


def forces_by_law(
    scene: Scene, joint: str, force: float, prescribed: float = 0.0
) -> dict[str, float]:
    """Return the peak force of an impact with each elastic law, N, at equal energy.

    The energy is that of an impact whose peak with the law of the scene is ``force``, N,
    between round surfaces. The impact begins in equilibrium with ``prescribed``, a force
    of the load, N; the energy is the elastic energy that is added, minus the work of
    this force. Empty for a user law, and for an exponent other than 1.5, which the laws
    of conforming pins do not have.
    """
    bearing = scene.bearing(joint)
    conventions = scene.conventions
    if isinstance(bearing.normal_law, UserFunction) or bearing.exponent != 1.5:
        return {}
    records = {}
    for law in get_args(Elasticity):
        stiffness = normal_stiffness(bearing, law, conventions.stiffness)
        records[law] = normal_record(
            NormalLaw(stiffness, elasticity=law), bearing.clearance
        )
    used = records[elastic_law(bearing, conventions.contact)]
    prescribed = min(prescribed, force)
    energy = _impact_energy(used, _depth_at_force(used, force), prescribed)
    forces = {}
    for law, record in records.items():
        depth = _depth_of_impact(record, prescribed, energy)
        forces[law] = elastic_of(record, depth)[0]
    return forces


def has_deep_law(scene: Scene, joint: str) -> bool:
    """Return whether a joint has the foundation with the stiffness of deep contacts."""
    conventions = scene.conventions
    return (
        conventions.contact == "foundation"
        and conventions.stiffness == "conforming"
        and scene.bearing(joint).contact_stiffness is None
    )


def ideal_force(scene: Scene, joint: str) -> float:
    """Return the peak force of a joint with rigid joints, N; 0 for loads not trusted."""
    if scene.has_untrusted_loads:
        return 0.0
    return float(abs(ideal_forces(scene)[1][joint]).max())


def _impact_energy(law: Records, depth: float, force: float) -> float:
    """Return the energy of an impact that reaches a penetration, m, against a load ``force``, J.

    It is the elastic energy that is added from the equilibrium with the force, N, minus
    the work of the force.
    """
    start = _depth_at_force(law, force)
    _, energy_at_start = elastic_of(law, start)
    _, energy = elastic_of(law, depth)
    return energy - energy_at_start - force * (depth - start)


def _depth_at_force(law: Records, force: float) -> float:
    """Return the penetration, m, with an elastic force, N."""
    return _least_depth(law, 0.0, lambda depth: elastic_of(law, depth)[0] < force)


def _depth_of_impact(law: Records, force: float, energy: float) -> float:
    """Return the penetration, m, of an impact with an energy, J; see ``_impact_energy``."""
    start = _depth_at_force(law, force)
    if energy <= 0.0:
        return start
    return _least_depth(
        law, start, lambda depth: _impact_energy(law, depth, force) < energy
    )


def _least_depth(
    law: Records, start: float, is_below: Callable[[float], bool]
) -> float:
    """Return the least penetration from ``start`` on, m, at which ``is_below`` is false.

    Bisection goes on to the last bit.
    """
    low = start
    high = start + float(law["clearance"])
    while is_below(high):
        low = high
        high = 2.0 * high
    middle = 0.5 * (low + high)
    while low < middle < high:
        if is_below(middle):
            low = middle
        else:
            high = middle
        middle = 0.5 * (low + high)
    return high


def deep_contacts(scene: Scene, stages: Sequence[StageResult]) -> list[str]:
    """Return sentences on joints whose penetration is too large for a stiffness of small contacts.

    A foundation with ``stiffness = conforming`` is valid for deep contacts.

    At an angle x from the line of centres the surfaces overlap by e cos(x) - c, with
    the eccentricity e and the clearance c. The cosine of half the arc of contact is
    c / (c + penetration). Oiled joints share a sentence, and dry joints another one.
    """
    oiled = []
    dry = {}
    for name, ratio in penetrations(scene, stages).items():
        if ratio <= SMALL_CONTACT:
            continue
        if scene.bearing(name).has_film:
            oiled.append(f"{name} by {_depth(scene, name, ratio)}")
        elif not has_deep_law(scene, name):
            dry[name] = ratio
    sentences = []
    if oiled:
        sentences.append(
            f"Pin and bearing deform at joint {' and joint '.join(oiled)}, while the oil film is "
            "that between rigid ones: a real film is wider, and its least thickness greater."
        )
    if dry:
        sentences.append(_dry_contacts(scene, stages, dry))
    return sentences


def _dry_contacts(
    scene: Scene, stages: Sequence[StageResult], deep: Mapping[str, float]
) -> str:
    """Return sentences on deep contacts without a film, from their relative penetrations."""
    contacts = []
    for name, ratio in deep.items():
        arc = math.degrees(2.0 * math.acos(1.0 / (1.0 + ratio)))
        depth = _depth(scene, name, ratio)
        contacts.append(f"{name} by {depth}, over {arc:.0f} degrees")
    places = " and joint ".join(contacts)
    text = (
        f"Contacts are deep: pins penetrate their bearings at joint {places}. The stiffness is "
        "that of small contacts; here bottom dead centre under load may be wrong, forces less so."
    )
    last = next(stage for stage in reversed(stages) if not stage.failed)
    peaks = []
    for name in deep:
        if name not in last.statistics.joints:
            continue
        force = last.statistics.joints[name].peak_force_per_cycle.mean
        if force > PRESCRIBED * ideal_force(scene, name):
            peaks.append(_forces_by_law_text(scene, name, force))
    peaks = list(filter(None, peaks))
    if peaks:
        text += " The peak force of an impact of the same elastic energy is, at joint "
        text += f"{'; at joint '.join(peaks)}."
    words = "stiffness = conforming"
    if scene.conventions.contact == "radial":
        words += " with contact = foundation"
    return f"{text} Use {words}, which is for deep contacts, or a measured contact_stiffness."


def _depth(scene: Scene, joint: str, ratio: float) -> str:
    """Return a penetration in micrometres and relative to the clearance."""
    deepest = readable(1e6 * ratio * scene.bearing(joint).clearance)
    return f"{deepest} µm, {readable(ratio)} times the clearance"


def _forces_by_law_text(scene: Scene, joint: str, force: float) -> str:
    """Return the peak force of a joint by each elastic law, that of the run first.

    Empty if the laws cannot be compared; see ``forces_by_law``.
    """
    forces = forces_by_law(scene, joint, force)
    if not forces:
        return ""
    used = elastic_law(scene.bearing(joint), scene.conventions.contact)
    order = [used, *(law for law in forces if law != used)]
    texts = [f"{quantity_text(forces[law], 'N')} by {LAW_WORDS[law]}" for law in order]
    texts[0] += " (as in this run)"
    return f"{joint}, {', '.join(texts)}"
