"""Tables of a report, whose rows are in ``templates/tables.toml``.

A table has a column per record or a line per record. A record holds the values of a
column or of a line.
"""

import tomllib
from collections.abc import Iterable, Sequence
from dataclasses import replace
from functools import lru_cache
from importlib.resources import files
from typing import Any

from presswear.analysis.contact_modes import MODES
from presswear.linkage.drives import linear_bodies
from presswear.linkage.guide_corner import WALLS
from presswear.linkage.surface import SIDES
from presswear.physics import statics
from presswear.recording.columns import CYCLE, FILM_CYCLE, JOINT_CYCLE, with_mean
from presswear.recording.soundness import ENERGY_BOUND, RESIDUAL
from presswear.results.frame_load import ALLOWED_REVERSE
from presswear.results.guide_tilt import ALLOWED_TILT, LEAST_ALLOWED_TILT, STATES
from presswear.results.motor_load import ALLOWED_DROP, RECOVERED
from presswear.results.result import Result
from presswear.results.strokes import PHASES, SNAP_THROUGH_S
from presswear.scene.scene import Scene
from presswear.show import page
from presswear.show.figures.style import TEMPLATES, maps_turn
from presswear.show.page import Row, Table
from presswear.show.words import in_words_of

Record = dict[str, Any]
_TABLES = TEMPLATES.from_string(
    (files(__package__) / "templates/tables.toml").read_text("utf-8")
)
HARMONICS = (1, 2, 3)  # orders of the crank whose amplitudes are listed
# Values of ``tables.toml`` that are the same for every result
_CONSTANTS: Record = {
    "states": STATES,
    "walls": WALLS,
    "allowed_tilt": f"{1e6 * LEAST_ALLOWED_TILT:.0f} to {1e6 * ALLOWED_TILT:.0f}",
    "allowed_reverse": ALLOWED_REVERSE,
    "allowed_drop": ALLOWED_DROP,
    "recovered": RECOVERED,
    "statics": statics,
    "phases": PHASES,
    "snap_through_s": SNAP_THROUGH_S,
    "energy_bound": ENERGY_BOUND,
    "residual": RESIDUAL,
    "orders": HARMONICS,
    "modes": MODES,
    "means": with_mean(CYCLE),
    "joint_means": with_mean((*JOINT_CYCLE, *FILM_CYCLE)),
}


def filled_tables(result: Result, **names: Any) -> Record:
    """Return ``tables.toml`` filled with the names of a result, and with ``names``."""
    scene = result.scene
    linkage = scene.linkage()
    # Maps that are fixed in space have one angle for both surfaces.
    sides = {"both": "bearing + pin"}
    if maps_turn(result):
        sides = {side: side for side in SIDES}
    content = {
        **_CONSTANTS,
        **_names_of_parts(scene),
        "sides": sides,
        "leader": linkage.leader,
        "pull": statics.pull_of(linkage),
    }
    return _parsed(_TABLES.render(content | names))


def _names_of_parts(scene: Scene) -> Record:
    """Return a scene and the names of its joints, drives, frames and guides."""
    mechanism = scene.mechanism.linkage()  # with ideal joints
    linkage = scene.linkage()  # with the bearings of the scene
    motors = []
    for drive in mechanism.drives:
        if drive.motor is not None and drive.motor.has_slip:
            motors.append(drive.body)
    return {
        "scene": scene,
        "linkage": mechanism,
        "joints": scene.loose_pins,
        "dry_joints": scene.dry_pins,
        "drives": [drive.body for drive in mechanism.drives],
        "linear": linear_bodies(mechanism.drives),
        "frames": [guide.name for guide in linkage.elastic_guides],
        "elastic_pins": [pin.name for pin in linkage.elastic_pins],
        "guides": [guide.name for guide in scene.loose_guides],
        "wall_bins": {
            corner.guide.name: corner.wall.bin_length
            for corner in linkage.corners
            if corner.wall is not None
        },
        "motors": motors,
    }


_parsed = lru_cache(maxsize=8)(tomllib.loads)


def result_table(
    name: str,
    result: Result,
    records: Sequence[Record],
    numeric: bool = True,
    **names: Any,
) -> Table | None:
    """Return a table of ``tables.toml`` with a column per record."""
    content = filled_tables(result, **names)
    rows = {}
    for heading, lines in content[name].items():
        rows[heading] = [_in_words(result, Row(*row)) for row in lines]
    columns = [record["name"] for record in records]
    corner = in_words_of(result.scene, content["corners"].get(name, ""))
    return page.column_table(corner, columns, records, rows, numeric)


def _in_words(result: Result, row: Row) -> Row:
    """Return a row with label and meaning in the words of the linkage."""
    label = in_words_of(result.scene, row.label)
    return replace(row, label=label, meaning=in_words_of(result.scene, row.meaning))


def line_table(
    name: str,
    result: Result,
    records: Iterable[Any],
    numeric: bool = False,
    **names: str,
) -> Table:
    """Return a table of ``tables.toml`` with a line per record."""
    columns = [Row(*row) for row in filled_tables(result, **names)["columns"][name]]
    lines = []
    for record in records:
        lines.append(tuple(column.text(record) for column in columns))
    heads = [column.head for column in columns]
    return page.plain_table(heads, lines, numeric)
