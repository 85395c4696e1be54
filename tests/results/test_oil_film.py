"""Oil films of scenes: least film, shares of full and mixed film, sentences."""

import math
from pathlib import Path

import numpy as np
import pytest

import presswear as pw
from presswear.physics.mixed_lubrication import shear_moment
from presswear.physics.oil_film import film_force, film_of
from presswear.results.film_orbit import FilmOrbit
from presswear.results.oil_film import JointFilm, dry_contact, oil_films
from presswear.scene.bearing import Bearing
from presswear.tools.numbers import readable

SCENARIOS = Path(__file__).parents[2] / "scenarios"
BUSH = Bearing(clearance=5e-5, bearing_radius=0.045, width=0.08, viscosity=0.1)


def test_thick_oil_carries_more_than_thin_oil_and_none_carries_in_a_wide_clearance():
    def oiled(clearance: str, viscosity: str) -> pw.Scene:
        return pw.scenes.slider_crank(clearance=clearance, viscosity=viscosity)

    thin, thick = (oiled("20 um", f"{n} Pa s") for n in (1e-3, 1e3))
    (dry,) = oil_films(thin).values()
    (full,) = oil_films(thick).values()
    assert dry.full_share < full.full_share
    assert full.full_share > 0.9
    assert oil_films(pw.scenes.slider_crank()) == {}
    # 50 µm are 5 per mille of the bore, the widest clearance of a film.
    assert list(oil_films(oiled("50 um", "0.1 Pa s"))) == ["B"]
    assert oil_films(oiled("51 um", "0.1 Pa s")) == {}


def test_least_film_of_the_press_of_250_kn():
    """An independent computation has 20.0 and 12.1 um, and 5.4 and 2.3 um in thinner oil."""
    file = pw.scene_from(SCENARIOS / "press-250kN.toml")
    prescribed = {"motor": "none", "servo": "none", "frame_stiffness": "none"}
    press = pw.changed(file, prescribed)
    expected = {"0.1 Pa s": (20.0, 12.1), "0.02 Pa s": (5.4, 2.3)}
    for viscosity, films in expected.items():
        scene = pw.changed(press, {"viscosity": viscosity})
        least = [1e6 * film.thickness.min() for film in oil_films(scene).values()]
        assert least == pytest.approx(films, abs=0.05)
        for film in oil_films(scene).values():
            assert film.time_shares == (1.0, 0.0, 0.0)
            assert film.orbit.is_closed
        text = " ".join(dry_contact(scene))
        assert f"the least film of the cycle is {readable(least[0])} µm" in text


def test_shares_of_time_and_load():
    """A film of 4, 2 and 0.5 roughnesses for 120 degrees each, under forces 1, 2 and 5."""
    angle = np.linspace(0.0, 360.0, 3601)
    part = np.minimum(angle // 120.0, 2.0).astype(int)
    gap = np.array([0.04, 0.02, 0.005])[part]
    force = np.array([1.0, 2.0, 5.0])[part]
    orbit = FilmOrbit(gap, 1.0 - gap + 0.0j, True)
    film = JointFilm(angle, force, orbit, clearance=1e-4, roughness=1e-6)
    assert film.time_shares == pytest.approx((1 / 3, 1 / 3, 1 / 3), abs=1e-3)
    assert film.load_shares == pytest.approx((1 / 8, 2 / 8, 5 / 8), abs=1e-3)


def test_a_weight_on_a_turning_pin_has_the_film_of_steady_rotation():
    """Rates of pin and bearing add up: eps and attitude are those of 15 rad/s."""
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
        loads=[pw.Force("rod.tail", -math.pi / 2.0, 1e4)],
        output="rod.tail",
    )
    scene = pw.Scene(weight, bearings={"A": BUSH})
    film = oil_films(scene)["A"]
    assert film.force == pytest.approx(np.full(film.force.size, 1e4), rel=1e-3)
    oil = film_of(BUSH.width, BUSH.bearing_radius, BUSH.clearance, 0.1)
    for gap, place in zip(film.orbit.gap, film.orbit.place, strict=True):
        along, across = film_force(float(gap), 0.0, 15.0, oil)
        assert math.hypot(along, across) == pytest.approx(1e4, rel=2e-3)
        on_pin = (along + 1j * across) * place / abs(place)
        assert abs(on_pin - 1e4j) < 30.0
    # The bearing turns at 5 rad/s and the pin at 10.
    gap = float(film.orbit.gap[0])
    sizes = BUSH.width, BUSH.bearing_radius, BUSH.clearance
    _, across = film_force(gap, 0.0, 15.0, oil)
    couple = BUSH.clearance * (1.0 - gap) * across
    sheared = 5.0 * shear_moment(gap, 5.0, 0.1, sizes)
    assert film.loss == pytest.approx(0.5 * couple * 15.0 + sheared, rel=3e-3)


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({}, "No viscosity is specified"),
        (
            {"clearance": "20 um", "viscosity": "0.1 Pa s"},
            "With 0.1 Pa s the least film of the cycle is",
        ),
        (
            {"clearance": "1 mm", "viscosity": "0.1 Pa s"},
            "too wide for a film: the contact is",
        ),
    ],
)
def test_sentences_say_where_dry_contact_holds(values, words):
    (sentence,) = dry_contact(pw.scenes.slider_crank(**values))
    assert words in sentence


def test_a_wide_bearing_and_oil_without_a_film_are_named():
    wide = pw.scenes.slider_crank(clearance="20 um", viscosity="0.1 Pa s", width="6 cm")
    assert (
        "The width over the diameter is 3.00; the film is that of 1"
        in dry_contact(wide)[0]
    )
    thin = pw.scenes.slider_crank(clearance="20 um", viscosity="1e-3 Pa s")
    (sentence,) = dry_contact(thin)
    assert "contact of asperities for 4.0" in sentence
    assert "so that impacts and wear of dry contact are upper bounds." in sentence
