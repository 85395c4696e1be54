"""Oil films against published tables of finite journal bearings."""

import math

import numpy as np
import pytest

import presswear as pw
from presswear.results.oil_film import dry_contact, oil_films, sommerfeld, thickness
from presswear.scene.bearing import Bearing

# Sommerfeld numbers of DIN 31652 (finite width, 180 degrees of film), by width over
# diameter and relative eccentricity
TABLE = {
    1.0: {0.5: 0.8903, 0.9: 8.4352, 0.99: 107.79},
    0.5: {0.5: 0.3124, 0.9: 5.0881, 0.99: 93.79},
    0.25: {0.5: 0.0888, 0.9: 2.1595, 0.99: 70.04},
}
BUSH = Bearing(clearance=5e-5, bearing_radius=0.045, width=0.08, viscosity=0.1)


@pytest.mark.parametrize("ratio", TABLE)
def test_sommerfeld_numbers_are_those_of_tables(ratio: float) -> None:
    eccentricity, numbers = map(np.array, zip(*TABLE[ratio].items(), strict=True))
    assert sommerfeld(eccentricity, ratio) == pytest.approx(numbers, rel=0.07)


def test_film_carries_its_force() -> None:
    force, speed = np.array([2440.0, 225e3, 1.0]), np.array([6.28, 2.0, 300.0])
    gap = thickness(BUSH, force, speed) / BUSH.clearance
    number = sommerfeld(1.0 - gap, 0.08 / 0.09)
    carried = number * BUSH.width * 0.09 * 0.1 * speed / (5e-5 / 0.045) ** 2
    assert carried == pytest.approx(force, rel=1e-6)
    assert thickness(BUSH, np.array([1.0]), np.zeros(1)) == 0.0
    assert thickness(BUSH, np.zeros(1), np.ones(1)) == pytest.approx(BUSH.clearance)


def test_thick_oil_carries_more_than_thin_oil_and_none_carries_in_a_wide_clearance() -> (
    None
):
    def oiled(clearance: str, viscosity: str) -> pw.Scene:
        return pw.scenes.slider_crank(clearance=clearance, viscosity=viscosity)

    thin, thick = (oiled("20 um", f"{n} Pa s") for n in (1e-5, 1e3))
    (dry,), (full,) = oil_films(thin).values(), oil_films(thick).values()
    assert dry.full_share < full.full_share
    assert full.full_share > 0.9
    assert oil_films(pw.scenes.slider_crank()) == {}
    assert list(oil_films(oiled("50 um", "0.1 Pa s"))) == [
        "B"
    ]  # 5 per mille of the bore
    assert oil_films(oiled("51 um", "0.1 Pa s")) == {}


def test_roughness_of_a_film_is_that_of_both_surfaces() -> None:
    """Variances of the heights of two equally rough surfaces add up."""
    scene = pw.scenes.slider_crank(
        clearance="20 um", viscosity="0.1 Pa s", roughness="0.4 um"
    )
    (film,) = oil_films(scene).values()
    assert film.roughness == pytest.approx(math.hypot(0.4e-6, 0.4e-6), rel=1e-12)


def test_effective_speed_of_a_pin_under_a_force_of_constant_direction() -> None:
    """Then it is the sum of the rates of pin and bearing, here of a hanging weight on a crank."""
    weight = pw.assemble(
        bodies=[
            pw.Bar("crank", length=0.1, mass=1e-6),
            pw.Bar("rod", length=0.1, mass=1e-6),
        ],
        joints=[
            pw.Pin("O", (0.0, 0.0), "crank.tail"),
            pw.Pin("A", "crank.head", "rod.tail"),
        ],
        drives=[pw.Drive("crank", speed=5.0), pw.Drive("rod", speed=10.0)],
        loads=[pw.Force("rod.tail", -math.pi / 2.0, 100.0)],
        output="rod.tail",
    )
    scene = pw.Scene(weight, bearings={"A": BUSH})
    film = oil_films(scene)["A"]
    assert film.force == pytest.approx(np.full(film.force.size, 100.0), rel=1e-3)
    assert film.speed == pytest.approx(np.full(film.speed.size, 15.0), rel=1e-3)


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({}, "No viscosity is specified"),
        (
            {"clearance": "20 um", "viscosity": "0.1 Pa s"},
            "With 0.1 Pa s the film is at least",
        ),
        (
            {"clearance": "1 mm", "viscosity": "0.1 Pa s"},
            "too wide for a film: the contact is",
        ),
        (
            {"clearance": "20 um", "viscosity": "0.1 Pa s"},
            "Steady rotation, no squeeze: a lower bound of the film.",
        ),
    ],
)
def test_sentences_say_where_dry_contact_holds(
    values: dict[str, str], words: str
) -> None:
    (sentence,) = dry_contact(pw.scenes.slider_crank(**values))
    assert words in sentence
    assert (
        "at the greatest force." not in sentence
    )  # a steady film does not say what carries there
