"""Writes a small example of each schema of results into a new folder; see README.md."""

import sys
from pathlib import Path

from presswear.campaign.single import run_scene
from presswear.record import film
from presswear.results.result import SCHEMA as RESULT
from presswear.scene.catalog import slider_crank
from presswear.scene.settings import changed
from presswear.studies.lives.variants import make
from presswear.studies.plan import SCHEMA as STUDY
from presswear.studies.rows import run_study
from presswear.sweeps.sweep import SCHEMA as SWEEP
from presswear.sweeps.sweep import sweep

SMALL = {
    "engine": "dae",
    "cycles": "2",
    "starts": "2",
    "wears": "1",
    "angles": "36",
    "rows_per_cycle": "100",
    "recorded_cycles": "1",
    "speed": "5rad/s",
    "restitution": "0.1",
}


def write(folder: Path) -> None:
    """Run a scene, a study of two lives, and a sweep of two points."""
    film.FRAMES_PER_CYCLE = 20
    scene = changed(slider_crank(), SMALL)
    run_scene(scene, folder / f"result-{RESULT}", jobs=1)
    lived = {"life": "limits", "life.until": "depth > 50 um", "life.most_cycles": "200"}
    lasting = changed(scene, {**lived, "wears": "1", "conventions": "refined"})
    study = make(lasting, {"clearance=0.3mm": {"clearance": "0.3mm"}})
    run_study(study, folder / f"study-{STUDY}", 1, resume=False)
    swept = folder / f"sweep-{SWEEP}"
    sweep(scene, {"clearance": "0.3mm,0.4mm"}, swept, ["B.force_max"], jobs=1)
    for records in folder.glob("*/records"):
        # Named after the machine.
        (own,) = records.iterdir()
        own.rename(own.with_name("machine-1-00000000"))


if __name__ == "__main__":
    write(Path(sys.argv[1]))
