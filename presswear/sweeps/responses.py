"""Responses: numbers of a result that a sweep stores, by name.

``A.force_max`` is a number of joint A in the last stage, ``A.force_max@0`` in the
unworn stage. `RESPONSES` defines all responses. They include the mean of each recorded
number that has a mean.
"""

import inspect
import math
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal, NamedTuple

from presswear.recording.columns import CYCLE, FILM_CYCLE, JOINT_CYCLE, with_mean
from presswear.recording.columns import Column as CycleColumn
from presswear.recording.statistics import STARTUP_CYCLES, Estimate
from presswear.results.frame_load import frame_loads
from presswear.results.guide_tilt import guide_tilts
from presswear.results.motor_load import motor_loads
from presswear.results.result import Result
from presswear.scene.options import LIFE_QUANTITIES
from presswear.scene.scene import Scene
from presswear.sweeps import response_readers as read
from presswear.sweeps.parameters import Column
from presswear.sweeps.response_readers import Place, Reader, Response
from presswear.tools.errors import InputError, unknown
from presswear.tools.files import digest

User = Callable[[Result], float]

OF_WORN = ("depth", "wear_volume")

Needed = Literal[
    "", "life", "motor", "elastic frame", "guide with clearance", "oil film"
]


class Definition(NamedTuple):
    """Definition of a response."""

    unit: str
    text: str
    read: Reader  # returns None if the result has no such number
    scope: Literal["joint", "stage", "result"] = "stage"
    optional: bool = False  # computed only if requested, because it takes long
    in_table: bool = True  # reported without a request, too
    needs: Needed = ""  # what a scene, or a joint, must have


def _means(
    scope: Literal["joint", "stage"],
    columns: tuple[CycleColumn, ...],
    needs: Needed = "",
) -> dict[str, Definition]:
    """Return the means of recorded numbers as responses by name."""
    return {
        column.name: Definition(
            column.unit.removeprefix("1"),
            f"{column.mean_label}, mean over cycles",
            read.mean_of(column.name),
            scope,
            in_table=False,
            needs=needs,
        )
        for column in with_mean(columns)
    }


def _meaning(name: str) -> tuple[str, str]:
    """Return unit and text of a quantity that a service life follows, too."""
    return LIFE_QUANTITIES[name].unit, LIFE_QUANTITIES[name].text


RESPONSES = {
    "force_max": Definition(
        *_meaning("force_max"), read.at_path("stored.peak_force_per_cycle"), "joint"
    ),
    "depth": Definition(*_meaning("depth"), read.depth, "joint"),
    "wear_volume": Definition(*_meaning("wear_volume"), read.worn_volume_of, "joint"),
    "wear_rate": Definition(
        "m^3", "volume that bearing and pin lose in a stroke", read.wear_rate, "joint"
    ),
    "contacts": Definition(
        "", "contacts in a cycle", read.at_path("stored.contacts_per_cycle"), "joint"
    ),
    # With its sign, in contrast to the limits of a life
    "bdc_error": Definition(
        "m",
        "error of the height of bottom dead centre, mean; negative is deeper",
        read.at_path("statistics.bdc.error"),
    ),
    "bdc_drift": Definition(
        "m",
        "change of the mean height of bottom dead centre; negative is deeper",
        read.bdc_drift,
    ),
    "repeatability": Definition(
        *_meaning("repeatability"),
        read.at_path("statistics.bdc.standard_deviation"),
    ),
    "total_clearance": Definition(
        *_meaning("total_clearance"), read.clearance, optional=True
    ),
    "drive_work": Definition(
        "J",
        "work of all drives in a cycle, less the change of stored energy",
        read.at_path("statistics.drive_work_per_cycle"),
    ),
    "strokes_per_minute": Definition(
        "",
        "strokes a minute that the motor reaches",
        read.stroke_rate,
        needs="motor",
    ),
    "speed_drop": Definition(
        "",
        "drop of the motor's speed by the work, part of the speed",
        read.speed_drop,
        needs="motor",
    ),
    "motor_rms": Definition(
        "",
        "rms over rated torque of the motor, the greatest",
        read.greatest_of(motor_loads, "rms_fraction"),
        needs="motor",
    ),
    "slip_loss": Definition(
        "J",
        "slip loss of the motor in a cycle, the greatest",
        read.greatest_of(motor_loads, "slip_loss"),
        needs="motor",
    ),
    "frame_stretch": Definition(
        "m",
        "stretch of the frame at its greatest force in the work",
        read.greatest_of(frame_loads, "stretch"),
        needs="elastic frame",
    ),
    "reverse_force": Definition(
        "",
        "reverse force of the frame over its greatest force",
        read.greatest_of(frame_loads, "reverse_fraction"),
        needs="elastic frame",
    ),
    "slide_tilt": Definition(
        "",
        "tilt of the slide, rad: at the fracture, else at the touch, else at the bottom",
        read.greatest_of(guide_tilts, "working"),
        needs="guide with clearance",
    ),
    "slide_tilt_max": Definition(
        "",
        "greatest tilt of the slide in a stroke, rad",
        read.greatest_of(guide_tilts, "greatest"),
        needs="guide with clearance",
    ),
    "corner_force": Definition(
        "N",
        "greatest normal force of a corner of the slide in a cycle",
        read.greatest_of(guide_tilts, "corner_force"),
        needs="guide with clearance",
    ),
    "wall_wear": Definition(
        "m",
        "depth that a stroke wears off the deepest place of a wall",
        read.wall_wear,
        needs="guide with clearance",
    ),
    "settled": Definition(
        "",
        "share of the runs that came to rest on a regular motion",
        read.settled_share,
    ),
    "life": Definition(
        "",
        "strokes until the first limit is exceeded",
        read.service_life,
        "result",
        needs="life",
    ),
    **_means("joint", JOINT_CYCLE),
    **_means("joint", FILM_CYCLE, needs="oil film"),
    **_means("stage", CYCLE),
}


@dataclass(frozen=True)
class Requested:
    """Responses that a sweep reports."""

    columns: tuple[Column, ...]
    # names of responses that are computed only if requested
    optional: tuple[str, ...] = ()
    functions: tuple[Any, ...] = ()  # responses that are user functions
    extra: str = ""  # digest of the responses that a row stores besides the usual ones


def available(scene: Scene) -> dict[str, Definition]:
    """Return all responses of a scene by name, those of joints first."""
    linkage = scene.linkage()
    has: dict[Needed, bool] = {
        "": True,
        "life": scene.life is not None,
        "motor": linkage.leader is not None,
        "elastic frame": bool(linkage.elastic_guides),
        "guide with clearance": bool(scene.loose_guides),
    }
    oiled = [joint.name for joint in linkage.oiled_joints]
    responses: dict[str, Definition] = {}
    for name, definition in RESPONSES.items():
        if definition.scope == "joint":
            joints = oiled if definition.needs == "oil film" else scene.loose_pins
            responses |= {f"{joint}.{name}": definition for joint in joints}
        elif has[definition.needs]:
            responses[name] = definition
    return responses


def request(scene: Scene, responses: Sequence[str | User] = ()) -> Requested:
    """Return the requested responses; without a request, those of the table of the last stage.

    A response is a name, or a function of a result that returns a number. `InputError`
    if a name, a joint or a stage is unknown, or a response is repeated.
    """
    offered = available(scene)
    in_table = [
        name
        for name, definition in offered.items()
        if definition.in_table and not definition.optional and not _is_zero(scene, name)
    ]
    columns = []
    optional = []
    functions = []
    for response in responses or in_table:
        if isinstance(response, str):
            name, column = _named_response(response, scene, offered)
            columns.append(column)
            if offered[name].optional and name not in optional:
                optional.append(name)
        else:
            summary = (inspect.getdoc(response) or "").partition("\n")[0]
            columns.append(Column(response.__name__, "", summary))
            functions.append(response)
    for name, count in Counter(column.key for column in columns).items():
        if count > 1:
            raise InputError(f"response {name} is repeated")
    extra = digest_of(optional, functions)
    return Requested(tuple(columns), tuple(optional), tuple(functions), extra)


def _named_response(
    text: str, scene: Scene, offered: Mapping[str, Definition]
) -> tuple[str, Column]:
    """Return the name and the column of a response NAME or NAME@STAGE."""
    name, _, stage = text.strip().partition("@")
    if name not in offered:
        raise unknown("response", name, offered)
    definition = offered[name]
    key = name
    if "@" in text:
        _check_stage(text, stage, definition, scene)
        key = f"{name}@{int(stage)}"
    if _is_zero(scene, name):
        raise InputError(
            f"response {name} is 0 without a wear update: request "
            f"{name.rpartition('.')[0]}.wear_rate, the volume that a stroke wears, "
            "or set wear_updates = 1 with cycles_per_update"
        )
    return name, Column(key, definition.unit, definition.text)


def _is_zero(scene: Scene, name: str) -> bool:
    """Return whether a response is the wear of surfaces that stay new."""
    is_of_worn = name.rpartition(".")[2] in OF_WORN
    return is_of_worn and scene.wear_updates == 0 and not scene.surfaces


def _check_stage(text: str, stage: str, definition: Definition, scene: Scene) -> None:
    """Raise InputError unless a stage of a requested response exists."""
    is_number = stage.isascii() and stage.isdigit()
    if definition.scope == "result" or not is_number:
        raise InputError(
            f"response {text}: expected NAME or NAME@STAGE, with a stage from 0"
        )
    if int(stage) > scene.wear_updates:
        allowed = f"0 to wear_updates = {scene.wear_updates}"
        raise InputError(f"response {text}: the stage must be {allowed}")


def freedom_of(scene: Scene, key: str) -> float:
    """Return the degrees of freedom of the interval of a response.

    They are infinite if the scene does not determine them. The samples are replicates on
    worn surfaces and in a wear update in steps, and settled cycles otherwise.
    """
    name, at, stage = key.partition("@")
    quantity = name.rpartition(".")[2]
    number = int(stage) if at else scene.wear_updates
    is_sum = quantity in ("depth", "wear_volume")
    is_wear = is_sum or quantity == "wear_rate"
    # The wear until a stage comes from the stages before it.
    source = number - 1 if is_sum else number
    is_worn = source > 0 and quantity != "repeatability"
    if quantity == "life" or is_worn or (is_wear and scene.wears_in_steps):
        return scene.replicate_count - 1.0 if scene.replicate_count > 1 else math.inf
    if scene.cycles is None:
        return math.inf
    return max(scene.replicate_count * (scene.cycles - STARTUP_CYCLES) - 1.0, 1.0)


def digest_of(optional: Sequence[str], functions: Sequence[User]) -> str:
    """Return the digest of the responses that a row stores besides the usual ones."""
    sources = sorted(optional)
    for function in functions:  # its text identifies its values
        try:
            sources.append(f"{function.__qualname__} {inspect.getsource(function)}")
        except (OSError, TypeError):
            sources.append(f"{function.__module__}.{function.__qualname__}")
    return digest("\n".join(sources).encode()) if sources else ""


def responses_of(result: Result, requested: Requested) -> dict[str, Response]:
    """Return the usual and the requested responses by key, except user functions.

    Each response of a stage has a key NAME@STAGE. The last stage also has the key NAME.
    """
    values: dict[str, Estimate | Response | None] = {}
    stages = [(stage, stage.joints) for stage in result.stages]
    for name, response in RESPONSES.items():
        if response.scope == "result":
            values[name] = response.read(Place(result))
            continue
        if response.optional and name not in requested.optional:
            continue
        for stage, joints in stages:
            if response.scope == "stage":
                values[f"{name}@{stage.index}"] = response.read(Place(result, stage))
                continue
            for pin in result.scene.loose_pins:
                place = Place(result, stage, joints[pin])
                values[f"{pin}.{name}@{stage.index}"] = response.read(place)
    last = f"@{result.stages[-1].index}"
    of_last = {key: value for key, value in values.items() if key.endswith(last)}
    for key, value in of_last.items():
        values[key.removesuffix(last)] = value
    responses = {}
    for key, value in values.items():
        if isinstance(value, Estimate):
            responses[key] = Response(value.mean, value.half_width)
        elif value is not None:
            responses[key] = value
    return responses


def user_responses(result: Result, functions: Sequence[User]) -> dict[str, Response]:
    """Return the responses that are user functions by their names."""
    values = {}
    for user in functions:
        number = user(result)
        if isinstance(number, bool) or not isinstance(number, int | float):
            raise InputError(f"response {user.__name__} = {number!r}: must be a number")
        values[user.__name__] = Response(float(number))
    return values
