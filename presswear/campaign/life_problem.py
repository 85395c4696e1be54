"""Limits and accuracy of the service life of a scene."""

from presswear.campaign.cycles_of_life import fewest_cycles
from presswear.campaign.service_life import FIRST_WEAR, LifeProblem
from presswear.scene.options import Life
from presswear.scene.scene import Scene


def problem_of(scene: Scene, life: Life) -> LifeProblem:
    """Return limits and accuracy of a service life of a scene.

    The first cycles wear as much whatever the wear coefficients are, so that the
    surfaces follow one another alike, and a life is inversely proportional to the
    coefficients.
    """
    pairs = [scene.bearing(name).materials for name in scene.wearing_joints]
    coefficient = max(
        pair.wear_coefficient * max(pair.running_in, 1.0) for pair in pairs
    )
    limits = scene.life_limits
    services = life.services(
        scene.loose_pins, [guide.name for guide in scene.worn_guides]
    )
    accuracy = life.at_most, scene.tolerance, life.max_cycles
    return LifeProblem(limits, services, *accuracy, FIRST_WEAR / coefficient)


def fewest_cycles_of(scene: Scene) -> float:
    """Return the cycles of all replicates that a life takes at least, before anything has run."""
    life = scene.life
    joints = scene.wearing_joints
    assert life is not None
    clearances = {name: scene.bearing(name).clearance for name in joints}
    return scene.replicate_count * fewest_cycles(problem_of(scene, life), clearances)
