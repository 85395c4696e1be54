"""Scenes that press on something: from Python, files and settings, and what is refused."""

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from closed_form import press_motion
from scipy.optimize import brentq

import presswear as pw
from presswear.linkage.loads import Force, OverPosition
from presswear.scene.files import scene_from
from presswear.scene.settings import changed, settings_of
from presswear.tools.errors import InputError

IDEAL = pw.scenes.ideal()
SLIDER_CRANK = replace(pw.scenes.slider_crank(), joints="none", cycles=1)
FILE = 'mechanism = "press"\n[process]\nkind = "drawing"\nforce = "0.2 kN"\ncushion = "15 N"\n'


def test_one_process_from_python_settings_and_files(tmp_path: Path) -> None:
    drawing = pw.Drawing(force=200.0, cushion=15.0)
    scene = replace(IDEAL, process=drawing)
    texts = {"process": "drawing", "process.force": "0.2kN", "process.cushion": "15N"}
    assert changed(IDEAL, texts).process == drawing
    file = tmp_path / "own.toml"
    file.write_text(FILE)
    assert scene_from(file).process == drawing
    assert pw.Scene.from_dict(scene.as_dict()) == scene
    origins = {"process": "set by the user"}
    assert changed(scene, {"process": "none"}) == replace(IDEAL, origins=origins)
    # The same kind keeps its values; another kind has its defaults.
    assert changed(scene, {"process.peak": "0.5"}).process == replace(drawing, peak=0.5)
    assert changed(scene, {"process": "coining"}).process == pw.Coining()


def test_keys_of_a_process_state_their_origin() -> None:
    scene = changed(IDEAL, {"process": "blanking", "process.stiffness": "3kN/mm"})
    texts = {setting.key: setting.described() for setting in settings_of(scene)}
    assert texts["process"].startswith("blanking  (none | blanking | drawing | coining)")
    assert texts["process.stiffness"].startswith("3e+06 N/m  (1 to 1e+12 N/m; set by the user)")
    assert "; chosen)" in texts["process.force"]
    plain = [setting.key for setting in settings_of(IDEAL) if setting.key.startswith("process")]
    assert plain == ["process"]


def lowest() -> float:
    """Lowest place of the slider in closed form, where its velocity is zero, m."""

    def slider(time: float) -> tuple[float, float]:
        motion = press_motion(pw.Press(), np.array([time]))
        place, velocity, _ = motion.output(pw.Press().linkage())[0]
        return float(place), float(velocity)

    return slider(brentq(lambda time: slider(time)[1], 0.04, 0.08, xtol=1e-15))[0]


@pytest.mark.parametrize("run_up", [0, 2])
def test_work_lies_over_the_lowest_place_or_under_the_highest(run_up: int) -> None:
    press = replace(IDEAL, mechanism=replace(IDEAL.mechanism, run_up=run_up))
    scene = replace(press, process=pw.Blanking())
    (load,) = scene.linkage().live_loads
    assert isinstance(load, Force)
    assert isinstance(load.law, OverPosition)
    assert scene.bottom == pytest.approx(lowest(), abs=1e-14)
    assert load.law.zero == pytest.approx(scene.bottom + 5e-3, abs=1e-15)
    # Dead centres of a slider-crank: rod plus and less crank.  Up is away from the work.
    scene = replace(SLIDER_CRANK, process=pw.Coining(bottom="highest", height=1e-3))
    assert scene.bottom == pytest.approx(-0.17, abs=1e-15)
    assert scene.stroke == pytest.approx(0.1, abs=1e-15)
    (load,) = scene.linkage().live_loads
    assert isinstance(load, Force)
    assert isinstance(load.law, OverPosition)
    assert load.law.zero == pytest.approx(-0.169, abs=1e-15)
    assert abs(load.direction) == pytest.approx(math.pi, abs=1e-15)


def limited(torque: float, **values: Any) -> pw.Scene:
    """The ideal press with a limit to its drives, N m."""
    return replace(IDEAL, mechanism=pw.Press(torque_limit=torque), process=pw.Coining(**values))


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (
            lambda: replace(IDEAL, process=pw.Blanking(height=0.2)),
            r"process\.height = 0\.2 m: over the lowest place of the slider allowed is 0\.00055 m, "
            r"to work it through, to below 0\.10704\d m",
        ),
        (
            lambda: replace(SLIDER_CRANK, process=pw.Drawing(height=7e-3, bottom="highest")),
            r"over the highest place of the slider allowed is 0\.008 m, .* below 0\.1 m",
        ),
        (
            lambda: limited(5.0, stiffness=1e8),
            r"torque_limit of crank \d = 5 N m: the ideal motion needs \S+ N m, \S+ ms into",
        ),
        (lambda: limited(0.01), r"torque_limit of crank \d = 0\.01 N m: the ideal motion needs"),
    ],
)
def test_a_process_out_of_reach_is_refused(make: Any, message: str) -> None:
    with pytest.raises(InputError, match=message) as refusal:
        make().check()
    assert len(str(refusal.value).splitlines()) == 1
