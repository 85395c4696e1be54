"""Every public function and class, called with arguments of wrong types."""

import contextlib
import inspect
import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any, get_type_hints

import numpy as np
import pytest
from numpy.typing import NDArray
from public_names import PUBLIC

import presswear as pw

WRONG: list[Any] = [
    None,
    "text",
    [],
    [1],
    {},
    {"a": 1},
    math.nan,
    10**400,
    object(),
    int,
    True,
    -1,
    (1, 2),
    {1: 2},
    np.zeros(3),
]
NAMES = [name for name, one in PUBLIC.items() if callable(one)]
RUNS = "run", "run_scenes", "sweep"  # these are called with arguments that start no run
# what the program gives to scripts, and errors that they raise
MADE_BY_PROGRAM = (
    "Diagram",
    "InputError",
    "JointResult",
    "Progress",
    "RunFailed",
    "StageResult",
)
STATISTICS = [
    name
    for name in pw.statistics.__all__
    if inspect.isfunction(getattr(pw.statistics, name))
]


def right_arguments() -> dict[str, dict[str, Any]]:
    """Return right arguments for the needed parameters of public functions and classes."""
    first = pw.linkage.Attachment("crank", 0.025, 0.0)
    second = pw.linkage.Attachment("rod", -0.075, 0.0)
    bodies = [
        pw.Bar("crank", length=0.05, mass=0.3),
        pw.Bar("rod", length=0.15, mass=0.4),
        pw.Body("slider", mass=0.5, inertia=1e-3),
    ]
    parts: dict[str, Any] = {
        "bodies": bodies,
        "joints": [
            pw.Pin("O", (0.0, 0.0), "crank.tail"),
            pw.Pin("A", "crank.head", "rod.tail"),
            pw.Pin("B", "rod.head", "slider.centre"),
            pw.Guide("G", "slider"),
        ],
        "drives": [pw.Drive("crank", speed=30.0)],
        "guess": {"rod": 0.0},
        "output": "slider.centre",
    }
    linkage = pw.assemble(**parts)
    pins = {"name": "A", "first": first, "second": second}
    laws = {
        "normal": pw.linkage.NormalLaw(1e10),
        "friction": pw.linkage.FrictionLaw(0.1),
        "wear": pw.linkage.WearLaw(1.2e-15),
    }
    radii = {"bearing_radius": 0.01, "clearance": 1e-4, "width": 0.02}
    joint = {"name": "A", "bearing": first, "pin": second, **radii, **laws}
    table = [(0.0, 0.0), (1.0, 0.01), (3.0, 0.02), (5.0, 0.01)]
    ends = {"first": (0.3, 0.0), "second": "slider.centre"}
    count = 3 * len(linkage.bodies)
    return {
        "simulate": {"linkage": linkage, "duration": 1e-3},
        "Start": {"position": np.zeros(count), "velocity": np.zeros(count)},
        "Estimate": {"mean": 1.0},
        "changed": {"scene": pw.Scene(), "settings": {}},
        "function_of": {"scene": pw.Scene(), "responses": "A.force_max"},
        "assemble": parts,
        "Linkage": {one: getattr(linkage, one) for one in parts if one != "guess"},
        "deflection": {"linkage": linkage, "force": 10.0},
        "total_clearance": {"linkage": linkage},
        "Attachment": {"body": "crank", "x": 0.0, "y": 0.0},
        "Bar": {"name": "crank", "length": 0.05, "mass": 0.3},
        "Body": {"name": "slider", "mass": 0.5},
        "ClearanceJoint": joint,
        "Revolute": pins,
        "Pin": {"name": "A", "first": "crank.head", "second": "rod.tail"},
        "Guide": {"name": "G", "body": "slider"},
        "OutputPoint": {"body": "slider"},
        "Drive": {"body": "crank"},
        "Follow": {"point": "slider.centre", "table": table},
        "Rise": {"start": 0.0, "end": 2.0, "by": 1.0},
        "Spring": {"name": "s", **ends, "stiffness": 100.0, "length": 0.1},
        "Load": {"body": "slider"},
        "Force": {"point": "slider.centre", "direction": 0.0, "law": 1.0},
        "Moment": {"body": "rod", "law": 1.0},
        "OverTime": {"table": table},
        "OverPosition": {"table": table},
        "Reading": {"joint": "A", "strokes": 1.0, "quantity": "depth", "value": 1e-6},
    }


RIGHT = right_arguments()


def calls_of(name: str) -> list[tuple[bool, dict[str, Any]]]:
    """Return arguments of calls that are wrong in one argument, and whether none is right.

    Nothing public has a parameter for an object of any kind.

    Without an entry in ``RIGHT`` those that are needed are wrong, too.
    """
    right = RIGHT.get(name, {})
    calls = []
    for parameter in inspect.signature(PUBLIC[name]).parameters.values():
        if parameter.kind in (parameter.VAR_POSITIONAL, parameter.VAR_KEYWORD):
            continue
        for value in WRONG:
            arguments = {**right, parameter.name: value}
            for other in inspect.signature(PUBLIC[name]).parameters.values():
                if other.default is other.empty:
                    arguments.setdefault(other.name, value)
            # Settings of a friction law are a class of that law, in a higher layer.
            may_be_right = (name, parameter.name) == ("FrictionLaw", "settings")
            calls.append((type(value) is object and not may_be_right, arguments))
    return calls


@pytest.mark.parametrize("name", NAMES)
def test_a_wrong_argument_is_named(name, tmp_path, monkeypatch):
    """A call is right, or raises InputError; never the error of something inside."""
    monkeypatch.chdir(tmp_path)
    for is_wrong, arguments in calls_of(name):
        try:
            PUBLIC[name](**arguments)
        except pw.InputError:
            continue
        assert name not in RUNS or not arguments.get("scenes"), arguments
        assert not is_wrong or name in (*MADE_BY_PROGRAM, *RUNS), arguments


ARRAY = NDArray[np.float64]
RIGHT_OF: dict[Any, Any] = {
    float: 1.0,
    int: 4,
    pw.statistics.Estimate: pw.statistics.Estimate(1.0),
    ARRAY: np.ones(4),
    ARRAY | float: np.ones(4),
    ARRAY | None: None,
    tuple[ARRAY, ARRAY] | None: None,
    NDArray[np.int64]: np.ones(4, np.int64),
    Sequence[ARRAY]: [np.ones(4), np.ones(4)],
    Sequence[int]: [8],
    Sequence[pw.statistics.MapBatches]: [pw.statistics.MapBatches((1, 2, 8))],
}


@pytest.mark.parametrize("name", STATISTICS)
@pytest.mark.filterwarnings("ignore::RuntimeWarning")
def test_statistics_name_a_wrong_argument(name):
    function = getattr(pw.statistics, name)
    kinds = get_type_hints(function)
    kinds.pop("return")
    right = {key: RIGHT_OF[kind] for key, kind in kinds.items()}
    for key in kinds:
        for value in WRONG:
            with contextlib.suppress(pw.InputError):
                function(**{**right, key: value})
        with pytest.raises(pw.InputError, match=f"^{key} = "):
            function(**{**right, key: object()})


def test_statistics_take_lists_of_numbers():
    samples = [1.0, 2.0, 4.0, 3.0]
    half = pw.statistics.half_width(samples)  # type: ignore[arg-type]
    assert half == pw.statistics.half_width(np.array(samples))
    runs = [samples, samples[::-1]]
    mean, _ = pw.statistics.pooled(runs)  # type: ignore[arg-type]
    assert mean == pw.statistics.pooled([np.array(run) for run in runs])[0]
    with pytest.raises(pw.InputError, match="samples = 'abc': an array or a list"):
        pw.statistics.half_width("abc")  # type: ignore[arg-type]
    with pytest.raises(pw.InputError, match=r"smoothed: .*widths of shape \(1,\)"):
        pw.statistics.smoothed(np.ones((1, 2, 8)), [1.0], [8])  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("name", "arguments", "message"),
    [
        ("Estimate", {"mean": "x"}, "mean = 'x': a finite number is expected"),
        ("Start", {"position": "x", "velocity": "y"}, "position = 'x': an array or a"),
        ("InHouse", {"integrator": "rk"}, "integrator = 'rk': "),
        ("InHouse", {"free_step": -1.0}, "free_step = -1: must be above 0"),
        ("ExudynTree", {"impact_steps": 0}, "impact_steps = 0: must be above 0"),
        ("run", {"scene": pw.Scene(), "interval": -1.0}, "interval = -1: must be at"),
        (
            "simulate",
            {
                **RIGHT["simulate"],
                "start": pw.engines.Start(np.full(9, math.nan), np.zeros(9)),
            },
            "position of the start: all numbers must be finite",
        ),
    ],
)
def test_a_wrong_value_is_named(name, arguments, message):
    with pytest.raises(pw.InputError, match=message):
        PUBLIC[name](**arguments)


def test_an_unknown_friction_law_is_named():
    linkage = pw.Scene().linkage()
    law = pw.linkage.FrictionLaw(0.1, name="rampp")
    joints = tuple(replace(one, friction=law) for one in linkage.clearances)
    with pytest.raises(pw.InputError, match="did you mean ramp"):
        pw.simulate(replace(linkage, clearances=joints), duration=1e-3)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"jobs": "2"}, "jobs = '2': a whole number or None is expected"),
        ({"jobs": 10**6}, "jobs = 1000000: must be at most 10000"),
        ({"engine": {}}, "engine = {}: "),
        ({"engine": "daee"}, "did you mean dae"),
        ({"observers": [1]}, r"observers = \[1\]: a list is expected"),
        ({"folder": 3}, "folder = 3: "),
        ({"scene": {}}, "scene = {}: a Scene is expected"),
    ],
)
def test_run_names_the_wrong_argument(arguments, message):
    with pytest.raises(pw.InputError, match=message):
        pw.run(**{"scene": pw.scenes.ideal(), **arguments})


@pytest.mark.parametrize(
    "name", ["vary", "responses", "ranges", "on", "shard", "limits", "jobs"]
)
def test_sweep_names_the_wrong_argument(name, tmp_path):
    for value in (1.5, object(), int, -1):
        arguments: dict[str, Any] = {
            "vary": {"speed": "1:2:2 rad/s"},
            "folder": tmp_path / "sweep",
        }
        arguments[name] = value
        with pytest.raises(pw.InputError, match=f"^{name} = "):
            pw.sweep(pw.scenes.ideal(), **arguments)


def test_a_reading_is_taken_with_units_and_refused_by_name():
    reading = pw.results.Reading("B", "1e6", "depth", "12 um", "2 um")  # type: ignore[arg-type]
    assert (reading.strokes, reading.error) == (1e6, 2e-6)
    assert reading.value == pytest.approx(12e-6, rel=1e-15)
    with pytest.raises(pw.InputError, match="strokes of B = -1: allowed is 0 to"):
        pw.results.Reading("B", -1.0, "depth", 1e-5)


def test_the_settings_of_a_function_of_a_scene_are_a_mapping():
    peak = pw.function_of(pw.Scene(), "A.force_max")
    with pytest.raises(pw.InputError, match="parameters = None: a mapping is expected"):
        peak(None)  # type: ignore[arg-type]


def test_surfaces_of_a_linkage_are_pairs_of_surfaces():
    for worn in (3, {"A": 3}, {"A": (None, None)}):
        with pytest.raises(pw.InputError, match=r"worn = .*a mapping is expected"):
            pw.Scene().linkage(worn)  # type: ignore[arg-type]


def test_a_number_of_5000_digits_is_refused(tmp_path):
    file = tmp_path / "a.toml"
    file.write_text(f'[mechanism]\nkind = "press"\nspeed = {"1" * 5000}\n')
    with pytest.raises(pw.InputError, match=r"a\.toml.*4300"):
        pw.scene_from(file)
    with pytest.raises(pw.InputError, match="clearance = "):
        pw.Bearing(clearance=10**5000)
