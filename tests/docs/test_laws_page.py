"""The user laws of the page on laws run, and their numbers are settings."""

import re
from pathlib import Path

import numpy as np
import pytest

import presswear as pw
from presswear.scene.settings import changed

PAGE = Path(__file__).parents[2] / "docs/how-to/laws.md"
BLOCKS = re.findall(r"```python\n(.*?)```", PAGE.read_text(), re.DOTALL)
FUNCTIONS = re.findall(r"^def (\w+)\((\w+)", "\n".join(BLOCKS), re.MULTILINE)
LAWS = [law for law in FUNCTIONS if not law[0].endswith("_rate")]
KINDS = {"penetration": "normal_law"}
KINDS |= dict.fromkeys(("sliding", "normal"), "friction_law")


@pytest.fixture
def file(tmp_path):
    path = tmp_path / "laws.py"
    path.write_text("\n".join(BLOCKS))
    return path


def test_laws_are_found():
    kinds = {KINDS.get(first, "wear_law") for _, first in LAWS}
    assert kinds == {"normal_law", "friction_law", "wear_law"}


@pytest.mark.parametrize(("name", "first"), LAWS)
def test_a_law_of_the_page_is_sound(name, first, file):
    key = KINDS.get(first, "wear_law")
    settings = {"contact": "radial"} if key == "normal_law" else {}
    base = pw.scenes.slider_crank(friction=0.1)
    changed(base, {**settings, key: f"{file}:{name}"}).check_user_laws()


def test_a_wear_law_of_the_page_wears(file):
    """New surfaces wear 30 times as fast. The ratio falls as they run in."""
    settings = {"cycles": 4, "replicates": 1, "wear_updates": 1, "engine": "dae"}
    settings |= {"cycles_per_update": 1e3, "wear_maps": "raw"}
    depths = []
    for law in ({}, {"wear_law": f"{file}:running_in"}):
        scene = pw.scenes.slider_crank(**settings, **law)
        result = pw.run(scene, jobs=1)
        depths.append(result.stages[0].joints["B"].wear("bearing"))
    archard, running_in = depths
    assert 1.0 < running_in.max() / archard.max() < 30.5
    is_worn = archard > 0.1 * archard.max()
    assert np.all(running_in[is_worn] > archard[is_worn])
