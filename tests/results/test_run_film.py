"""Oil films that acted in a run: the numbers of the report are those of the run."""

import math
from pathlib import Path

import numpy as np
import pytest

import presswear as pw
from presswear.results.run_film import run_films
from presswear.show.figures import drawings
from presswear.show.key_numbers import key_numbers
from presswear.show.report import render_report
from presswear.tools.numbers import quantity_text

SCENARIOS = Path(__file__).parents[2] / "scenarios"


@pytest.fixture(scope="module")
def oiled():
    press = pw.scene_from(SCENARIOS / "press-250kN.toml")
    rigid = {"motor": "none", "servo": "none", "frame_stiffness": "none"}
    oil = {"viscosity": "0.02 Pa s", "film": "run"}
    values = {**rigid, **oil, "replicates": 1, "cycles": 3}
    return pw.run(pw.changed(press, values))


def test_least_film_of_a_run_is_near_that_under_ideal_forces(oiled):
    """An independent orbit under the forces of rigid links has 5.4 and 2.3 um.

    The elastic contact takes part of the way of the pin.
    """
    films = run_films(oiled.scene, oiled.stages[0])
    least = [1e6 * float(film.thickness.min()) for film in films.values()]
    assert least == pytest.approx([5.4, 2.3], rel=0.12)
    assert all(film.time_shares == (1.0, 0.0, 0.0) for film in films.values())
    for name, film in films.items():
        both = math.hypot(*2 * [oiled.scene.bearing(name).roughness])
        assert film.roughness == pytest.approx(both, rel=1e-12)


def test_films_of_each_cycle_are_those_of_series_and_ledger(oiled):
    (stage,) = oiled.stages
    lost = 0.0
    for name, film in run_films(oiled.scene, stage).items():
        joint = stage.joints[name]
        least, losses = map(joint.each_cycle, ("least_film", "film_loss"))
        assert least[-1] == pytest.approx(film.thickness.min(), rel=1e-3)
        assert losses[-1] == pytest.approx(film.loss * 1.0, rel=0.02)
        assert joint.statistics.means["least_film"].mean == least[-1]
        lost += losses.sum()
    ledger = sum(
        float(stage.diagnostics[key] or 0.0)
        for key in ("contact_loss_J", "friction_loss_J")
    )
    assert lost == pytest.approx(ledger, rel=1e-3)


def test_loss_of_a_film_beside_a_motor_is_by_the_clock():
    """The motor makes 59 of 60 strokes a minute, and turns slower in the work."""
    press = pw.scene_from(SCENARIOS / "press-250kN.toml")
    oil = {"viscosity": "0.1 Pa s", "film": "run", "frame_stiffness": "none"}
    light = {"motor.inertia": "0.05 kg m^2", "motor.torque": "25 N m"}
    result = pw.run(pw.changed(press, {**oil, **light, "replicates": 1, "cycles": 3}))
    (stage,) = result.stages
    seconds = stage.each_cycle("duration")[-1]
    for name, film in run_films(result.scene, stage).items():
        loss = stage.joints[name].each_cycle("film_loss")[-1]
        assert film.loss * seconds == pytest.approx(loss, rel=0.01)


def test_asperities_far_below_the_film_do_not_wear():
    """Their load distance is 1e-45 N m, of which 1e46 strokes would wear something."""
    oil = {"clearance": "30 um", "viscosity": "0.1 Pa s", "film": "run"}
    result = pw.run(pw.scenes.slider_crank(**oil, joints="B", cycles=3))
    (stage,) = result.stages
    assert stage.joints["B"].statistics.is_unworn
    assert stage.cycles_per_update == 1.0
    assert not any("Wear per" in number.name for number in key_numbers(result))
    (film,) = run_films(result.scene, stage).values()
    (least,) = (
        number for number in key_numbers(result) if number.name == "Least oil film"
    )
    assert least.value == quantity_text(film.thickness.min(), "m")
    # Contacts of asperities neither begin nor end: they have no modes and no wear map.
    names = [drawing.file for drawing in drawings(result)]
    assert "oil.png" in names
    assert not {"modes.png", "impacts.png", "wear-depth.png"} & {*names}
    assert "while the oil film is that between rigid ones" in str(result)


def test_the_working_zone_stands_beside_the_film_of_a_cycle(oiled):
    panels = np.array(oiled.plot("oil")).reshape(2, 3)
    for (full, zone, _), film in zip(
        panels, run_films(oiled.scene, oiled.stages[0]).values(), strict=True
    ):
        assert full.get_xlim() == (0.0, 360.0)
        x, y = zone.lines[0].get_data()
        inside = np.asarray(x) < zone.get_xlim()[1]
        thickness = np.interp(np.asarray(x)[inside], film.angle, film.thickness)
        assert np.asarray(y)[inside] == pytest.approx(1e6 * thickness)
        # The film is least in the work.
        assert np.asarray(y)[inside].min() == pytest.approx(1e6 * film.thickness.min())


def test_report_states_the_film_of_the_run(oiled):
    report = render_report(oiled)
    assert "Joint C: the oil film acts in the run" in report
