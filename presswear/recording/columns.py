"""Recorded numbers, each declared once: series, numbers of each cycle, sections.

Recorder, statistics, stored stages and tables read these lists; ``observe`` fills the
columns.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from presswear.tools.errors import unknown


class Column(NamedTuple):
    """A recorded number."""

    name: str
    unit: str
    text: str
    exported: str = ""  # name in tables, if it differs from ``name``
    # label and unit of the mean over cycles in the report; no label: no mean
    mean_label: str = ""
    mean_unit: str = ""

    @property
    def table_name(self) -> str:
        """Name in tables."""
        return self.exported or self.name


def names_of(columns: tuple[Column, ...]) -> tuple[str, ...]:
    """Return the names of columns."""
    return tuple(column.name for column in columns)


def index_of(kind: str, name: str, names: tuple[str, ...]) -> int:
    """Return the index of a name that a user has written; ``kind`` is for the message.

    Raises
    ------
    InputError
        If the name is unknown. The message has the most similar name.
    """
    if name not in names:
        raise unknown(kind, name, names)
    return names.index(name)


def with_mean(columns: tuple[Column, ...]) -> tuple[Column, ...]:
    """Return the columns whose mean over cycles is in the statistics and in the report."""
    return tuple(column for column in columns if column.mean_label)


# Series of the output point, then of each joint
SERIES = (
    Column("time", "s", "since the start of the run"),
    Column("displacement", "m", "of the output point from its start"),
    Column("velocity", "m/s", "of the output point"),
    Column("acceleration", "m/s^2", "of the output point"),
)
TIME, DISPLACEMENT, VELOCITY, ACCELERATION = range(len(SERIES))
JOINT_SERIES = (
    Column("eccentricity_x", "m", "pin centre minus bearing centre, to the right"),
    Column("eccentricity_y", "m", "pin centre minus bearing centre, upwards"),
    Column("penetration", "m", "of the pin into the bearing, negative while open"),
    Column("normal", "N", "normal force, 0 while open", "normal_force"),
    Column(
        "tangential",
        "N",
        "friction, with the sign of the contact model",
        "tangential_force",
    ),
    Column("sliding", "m/s", "tangential speed at the contact"),
)
ECCENTRICITY_X, ECCENTRICITY_Y, PENETRATION, NORMAL, TANGENTIAL, SLIDING = range(
    len(JOINT_SERIES)
)
# Arrays of a joint in a stored stage, and the series that they hold
JOINT_ARRAYS = {
    "eccentricity": ("eccentricity_x", "eccentricity_y"),
    "penetration": ("penetration",),
    "force": ("normal", "tangential"),
    "sliding": ("sliding",),
}

# Numbers of each cycle: of the output point and the energies, then of each joint and
# each drive
CYCLE = (
    Column("displacement_max", "m", "greatest displacement of the output point"),
    Column("velocity_min", "m/s", "smallest velocity of the output point"),
    Column("velocity_max", "m/s", "largest velocity of the output point"),
    Column("acceleration_max", "m/s^2", "largest absolute acceleration of the output"),
    Column("steps", "1", "accepted steps", mean_label="accepted steps"),
    Column("contact_made", "J", "energy created by normal laws"),
    Column("bottom_height", "m", "lowest position of the output point"),
    Column("bottom_time", "s", "nominal time of the lowest position"),
    Column("drive_work", "J", "work of the drives"),
    Column(
        "stored_energy_change", "J", "change of kinetic, potential and elastic energy"
    ),
)
(
    DISPLACEMENT_MAX,
    VELOCITY_MIN,
    VELOCITY_MAX,
    ACCELERATION_MAX,
    STEPS,
    CONTACT_MADE,
    BOTTOM_HEIGHT,
    BOTTOM_TIME,
    DRIVE_WORK,
    STORED_ENERGY_CHANGE,
) = range(len(CYCLE))
JOINT_CYCLE = (
    Column("force_max", "N", "greatest normal force"),
    Column("load_distance", "N m", "integral of normal force times sliding speed"),
    Column("contacts", "1", "contacts that have ended"),
    Column("eccentricity_x", "m", "at the end of the cycle, to the right"),
    Column("eccentricity_y", "m", "at the end of the cycle, upwards"),
    Column(
        "closed_time",
        "s",
        "time in which the pin touches its bearing",
        mean_label="time in contact",
        mean_unit="ms",
    ),
    Column(
        "sliding_distance",
        "m",
        "over which the pin slides while it touches its bearing",
        mean_label="sliding distance in contact",
        mean_unit="mm",
    ),
)
(
    FORCE_MAX,
    LOAD_DISTANCE,
    CONTACTS,
    END_X,
    END_Y,
    CLOSED_TIME,
    SLIDING_DISTANCE,
) = range(len(JOINT_CYCLE))
# Numbers of a joint in the last accepted state, for integrals over the next step
LAST = np.dtype(
    [
        ("sliding", np.float64),  # m/s
        ("film_loss", np.float64),  # power, W
    ]
)
# Integrals are over time; peaks have their signs
DRIVE_CYCLE = (
    Column("torque_integral", "N m s", "integral of the torque"),
    Column("torque_square_integral", "N^2 m^2 s", "integral of the squared torque"),
    Column("power_square_integral", "W^2 s", "integral of the squared power"),
    Column("work_given", "J", "work of the drive on the linkage"),
    Column("work_returned", "J", "work of the linkage on the drive"),
    Column("torque_peak", "N m", "torque with the largest absolute value"),
    Column("power_peak", "W", "power with the largest absolute value"),
)
TORQUE, TORQUE_SQUARE, POWER_SQUARE, GIVEN, RETURNED, TORQUE_PEAK, POWER_PEAK = range(
    len(DRIVE_CYCLE)
)
CYCLE_COUNT, JOINT_CYCLE_COUNT, DRIVE_CYCLE_COUNT = map(
    len, (CYCLE, JOINT_CYCLE, DRIVE_CYCLE)
)
# Numbers of each cycle of a linkage with a motor, behind those of the joints; see
# ``nominal_time``
LEADER_CYCLE = (
    Column("duration", "s", "of the cycle"),
    Column("leader_speed_mean", "rad/s", "mean speed of the first motor, in its sense"),
    Column("leader_speed_min", "rad/s", "smallest speed of the first motor"),
    Column("leader_speed_max", "rad/s", "largest speed of the first motor"),
)
DURATION, LEADER_SPEED_MEAN, LEADER_SPEED_MIN, LEADER_SPEED_MAX = range(
    len(LEADER_CYCLE)
)
LEADER_CYCLE_COUNT = len(LEADER_CYCLE)
# Numbers of each cycle of a joint with an oil film in the run, behind those of the
# leader
FILM_CYCLE = (
    Column(
        "least_film",
        "m",
        "least thickness of the oil film",
        mean_label="least oil film",
        mean_unit="µm",
    ),
    Column(
        "film_loss",
        "J",
        "energy that the oil and the asperities take",
        mean_label="loss in the oil film",
        mean_unit="J",
    ),
)
LEAST_FILM, FILM_LOSS = range(len(FILM_CYCLE))
FILM_CYCLE_COUNT = len(FILM_CYCLE)
# Last series of a linkage with a motor
LEADER_SERIES = (
    Column("nominal_time", "s", "at which the ideal motion has the leader's angle"),
    Column("nominal_rate", "1", "speed of the first motor over its nominal speed"),
)
LEADER_SERIES_COUNT = len(LEADER_SERIES)
SERIES_COUNT = len(SERIES)
JOINT_SERIES_COUNT = len(JOINT_SERIES)

# Columns of a Poincare section: of the output point, then of each joint; see
# ``observe.OUTPUT`` and ``contact.CONTACT``
SECTION_NAMES = ("place", "velocity")
SECTION_JOINT_NAMES = (
    "eccentricity_x",
    "eccentricity_y",
    "velocity_x",
    "velocity_y",
    "normal",
)


def cycle_quantities(
    joints: Sequence[str],
    drives: Sequence[str],
    has_leader: bool = False,
    films: Sequence[str] = (),
) -> dict[str, Column]:
    """Return the numbers in a cycle's row by name, such as ``A.force_max``, in their order."""
    quantities = {column.name: column for column in CYCLE}
    for joint in joints:
        quantities |= {f"{joint}.{column.name}": column for column in JOINT_CYCLE}
    if has_leader:
        quantities |= {column.name: column for column in LEADER_CYCLE}
    for joint in films:
        quantities |= {f"{joint}.{column.name}": column for column in FILM_CYCLE}
    for drive in drives:
        quantities |= {f"{drive}.{column.name}": column for column in DRIVE_CYCLE}
    return quantities


def cycle_columns(
    joints: int, drives: int, has_leader: bool = False, films: int = 0
) -> int:
    """Return the number of columns in a cycle's row."""
    first = first_film_column(joints, has_leader) + FILM_CYCLE_COUNT * films
    return first + DRIVE_CYCLE_COUNT * drives


def first_leader_column(joints: int) -> int:
    """Return the first column of LEADER_CYCLE in a cycle's row."""
    return CYCLE_COUNT + JOINT_CYCLE_COUNT * joints


def first_film_column(joints: int, has_leader: bool) -> int:
    """Return the first column of FILM_CYCLE in a cycle's row."""
    return first_leader_column(joints) + LEADER_CYCLE_COUNT * has_leader


def cycle_column(name: str, joint: int | None = None) -> int:
    """Return the column of a number of the linkage, or of a joint, in a cycle's row."""
    if joint is None:
        return index_of("quantity of a cycle", name, names_of(CYCLE))
    index = index_of("quantity of a joint's cycle", name, names_of(JOINT_CYCLE))
    return CYCLE_COUNT + JOINT_CYCLE_COUNT * joint + index


def series_column(name: str, joint: int | None = None) -> int:
    """Return the column of a series of the linkage, or of a joint, in a row of all series."""
    if joint is None:
        return names_of(SERIES).index(name)
    index = names_of(JOINT_SERIES).index(name)
    return SERIES_COUNT + JOINT_SERIES_COUNT * joint + index
