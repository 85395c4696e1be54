"""Limits and accuracy of the service life of a scene."""

from presswear.campaign.cycles_of_life import fewest_cycles
from presswear.campaign.service_life import FIRST_WEAR, LifeProblem
from presswear.linkage.wear_law import WEAR_PARAMETERS
from presswear.scene.options import Life
from presswear.scene.scene import Scene
from presswear.tools.user_function import UserFunction


def problem_of(scene: Scene, life: Life) -> LifeProblem:
    """Return limits and accuracy of a service life of a scene.

    The first cycles wear as much whatever the wear coefficients are, so that the
    surfaces follow one another alike, and a life is inversely proportional to the
    coefficients.
    """
    coefficient = max(_new_coefficient(scene, name) for name in scene.wearing_joints)
    guides = [guide.name for guide in scene.worn_guides]
    return LifeProblem(
        scene.life_limits,
        life.services(scene.loose_pins, guides),
        life.at_most,
        scene.tolerance,
        life.max_cycles,
        FIRST_WEAR / coefficient,
    )


def _new_coefficient(scene: Scene, name: str) -> float:
    """Return the larger wear coefficient of new and worn surfaces of a joint, 1/Pa."""
    pair = scene.bearing(name).materials
    law = scene.bearing(name).wear_law
    coefficient = pair.wear_coefficient
    if name not in scene.loose_pins or not isinstance(law, UserFunction):
        return coefficient * max(pair.running_in, 1.0)
    new = 0.0, 0.0, pair.pressure_reference, coefficient
    state = dict(zip(WEAR_PARAMETERS, new, strict=True))
    return max(law.evaluate(f"{name}.wear_law", WEAR_PARAMETERS, state), coefficient)


def fewest_cycles_of(scene: Scene) -> float:
    """Return the cycles of all replicates that a life takes at least, before anything has run."""
    life = scene.life
    assert life is not None
    clearances = {name: scene.bearing(name).clearance for name in scene.wearing_joints}
    return scene.replicate_count * fewest_cycles(problem_of(scene, life), clearances)
